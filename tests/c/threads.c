/* argv[1] simulators of one model, each in a thread of its own: all must end with the same bits. */
#define _POSIX_C_SOURCE 200809L
#include "common.h"
#include <pthread.h>
#include <string.h>

enum { MOST = 256, STEPS = 20 };
static stickslip_model *model;
static stickslip_model_info info;
static double *results[MOST];

static void *run(void *result) {
    double *values = (double *)result;
    stickslip_simulator *sim;
    stickslip_state *state;
    must(stickslip_new(model, &sim), "new");
    must(stickslip_init(sim, 0.0), "init");
    must(stickslip_state_new(sim, &state), "state_new");
    for (int n = 0; n < STEPS; n++) {
        const double loads[2] = {0.1, 0.01 * n};
        must(stickslip_save_state(sim, state), "save");
        must(stickslip_do_step(sim, n * 0.02, 0.02), "trial");
        must(stickslip_restore_state(sim, state), "restore");
        must(stickslip_set_inputs(sim, loads, 2), "set_inputs");
        must(stickslip_do_step(sim, n * 0.02, 0.02), "do_step");
    }
    check(stickslip_do_step(sim, -1.0, 0.02) == STICKSLIP_STEP, "a refused step");
    must(stickslip_get_outputs(sim, values, info.outputs), "get_outputs");
    stickslip_state_free(state);
    stickslip_free(sim);
    return NULL;
}

int main(int argc, char **argv) {
    const int count = argc > 1 ? atoi(argv[1]) : 64;
    check(count > 0 && count <= MOST, "a number of threads");
    must(stickslip_model_compile(PAD, &model), "compile");
    must(stickslip_model_get_info(model, &info), "info");
    pthread_t threads[MOST];
    for (int i = 0; i < count; i++) {
        results[i] = (double *)room(info.outputs, sizeof(double));
        check(pthread_create(&threads[i], NULL, run, results[i]) == 0, "a thread");
    }
    for (int i = 0; i < count; i++) check(pthread_join(threads[i], NULL) == 0, "the end of a thread");
    for (int i = 0; i < count; i++) {
        check(memcmp(results[i], results[0], info.outputs * sizeof(double)) == 0, "the same bits in every thread");
        if (i > 0) free(results[i]);
    }
    free(results[0]);
    stickslip_model_free(model);
    printf("%d simulators, the same bits\n", count);
    return 0;
}
