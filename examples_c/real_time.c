/* A fixed-rate loop: one step of 1 ms of simulated time per millisecond of the clock, for a second (or as many steps as the
 * command line says). Prints the distribution of the step times; checks that the typical step leaves most of the
 * millisecond to the rest of the loop. */
#define _POSIX_C_SOURCE 200809L
#include "common.h"
#include <math.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv) {
    const int steps = argc > 1 ? atoi(argv[1]) : 1000;
    check(steps > 0, "a positive number of steps");
    const double period = 1e-3;
    stickslip_model *model;
    stickslip_simulator *sim;
    stickslip_port rate;
    double fastest = 0.0;
    must(stickslip_model_compile(PAD, &model), "compile");
    must(stickslip_model_find_port(model, "contact.max_slip_rate", &rate), "max_slip_rate");
    must(stickslip_new(model, &sim), "new");
    must(stickslip_init(sim, 0.0), "init");
    /* the first step of a size factors; done before the clock runs, and rolled back */
    stickslip_state *start;
    must(stickslip_state_new(sim, &start), "state_new");
    must(stickslip_save_state(sim, start), "save");
    must(stickslip_do_step(sim, 0.0, period), "warm up");
    must(stickslip_restore_state(sim, start), "restore");
    stickslip_state_free(start);

    double *cost = (double *)room((size_t)steps, sizeof *cost);
    int late = 0;
    double deadline = now();
    for (int n = 0; n < steps; n++) {
        deadline += period;
        const double begin = now();
        const double loads[2] = {0.1, 0.06 * sin(6.28 * n * period)};
        double largest;
        must(stickslip_set_inputs(sim, loads, 2), "set_inputs");
        must(stickslip_do_step(sim, n * period, period), "do_step");
        must(stickslip_get(sim, rate.reference, &largest, 1), "get");
        fastest = fmax(fastest, largest);
        const double end = now();
        cost[n] = end - begin;
        if (end > deadline) {
            late++;
            deadline = end;
        } else {
            const struct timespec rest = {0, (long)((deadline - end) * 1e9)};
            nanosleep(&rest, NULL);
        }
    }
    qsort(cost, (size_t)steps, sizeof *cost, ascending);
    printf("step times of %d: median %.1f us, 90%% %.1f us, 99%% %.1f us, longest %.1f us; %d late\n", steps,
           1e6 * cost[steps / 2], 1e6 * cost[(int)(0.9 * steps)], 1e6 * cost[(int)(0.99 * steps)], 1e6 * cost[steps - 1], late);
    check(fastest > 0.0, "the pad slips");
    /* an instrumented run (a sanitizer, valgrind) names its own limit */
    const char *limit = getenv("STEP_LIMIT_SECONDS");
    check(cost[steps / 2] < (limit ? atof(limit) : 0.5 * period), "the median step takes less than half a period");
    free(cost);
    stickslip_free(sim);
    stickslip_model_free(model);
    return 0;
}
