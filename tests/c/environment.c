/* The floating-point environment of the host: traps do not fire in the library, rounding mode and flushing to zero do not
 * change its results, and all of it, sticky flags included, is as it was after every call. */
#define _GNU_SOURCE
#include <stickslip.h>

#include <fenv.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#define STEPS 40
#define LONGEST 4096

static const char *where = "";

#define CHECK(holds) ((holds) ? (void)0 : fail(#holds, __LINE__))

static void fail(const char *what, int line) {
    char why[512];
    stickslip_last_error(why, sizeof why);
    fprintf(stderr, "line %d, %s: not %s (last error: %s)\n", line, where, what, why);
    exit(1);
}

static void on_trap(int number) {
    (void)number;
    static const char text[] = "SIGFPE in ";
    ssize_t ignored = write(2, text, sizeof text - 1);
    ignored = write(2, where, strlen(where));
    (void)ignored;
    _exit(3);
}

/* What the host has set: control bits, and the exceptions that it has seen. */
struct environment {
    int rounding, traps, flags;
    unsigned control;
};

static struct environment environment(void) {
    struct environment found = {fegetround(), fegetexcept(), fetestexcept(FE_ALL_EXCEPT), 0};
#if defined(__x86_64__)
    found.control = _mm_getcsr();
#endif
    return found;
}

static struct environment before;

static void begin(const char *call) {
    where = call;
    before = environment();
}

static void end(int32_t code) {
    struct environment after = environment();
    CHECK(code >= 0);
    CHECK(after.rounding == before.rounding && after.traps == before.traps);
    CHECK(after.flags == before.flags && after.control == before.control);
}

#define CALL(name, arguments) (begin(#name), end(name arguments))

/* Numbers here are exact, so that the host itself raises nothing. Compiles, steps, reads, differentiates, saves and loads; all results go to `results`, their number is returned. */
static size_t run(const char *scene, double *results) {
    stickslip_model *compiled, *model;
    stickslip_simulator *sim, *copy;
    stickslip_state *state;
    stickslip_model_info info;
    static unsigned char bytes[1 << 20], saved[1 << 20];
    size_t length = 0, count = 0;
    CALL(stickslip_model_compile, (scene, &compiled));
    CALL(stickslip_model_save, (compiled, bytes, sizeof bytes, &length));
    CALL(stickslip_model_load, (bytes, length, &model));
    CALL(stickslip_model_get_info, (model, &info));
    CHECK(info.outputs <= LONGEST && info.inputs == 1);
    CALL(stickslip_new, (model, &sim));
    CALL(stickslip_state_new, (sim, &state));
    CALL(stickslip_init, (sim, 0.0));
    for (int n = 0; n < STEPS; n++) {
        double load = -0.3125 + 0.015625 * n, seed = 1.0, derivative[LONGEST];
        CALL(stickslip_save_state, (sim, state));
        CALL(stickslip_set_inputs, (sim, &load, 1));
        CALL(stickslip_do_step, (sim, n * 0.03125, 0.03125));
        CALL(stickslip_directional_derivative, (sim, &seed, 1, derivative, info.outputs));
        CALL(stickslip_restore_state, (sim, state));
        CALL(stickslip_do_step, (sim, n * 0.03125, 0.03125));
        CALL(stickslip_get_outputs, (sim, results + count, info.outputs));
        count += info.outputs;
        memcpy(results + count, derivative, info.outputs * sizeof *derivative);
        count += info.outputs;
    }
    CALL(stickslip_serialize, (sim, saved, sizeof saved, &length));
    CALL(stickslip_clone, (sim, &copy));
    CALL(stickslip_deserialize, (copy, saved, length));
    CALL(stickslip_get_outputs, (copy, results + count, info.outputs));
    count += info.outputs;
    /* a refused call gives the environment back too */
    begin("a refused step");
    CHECK(stickslip_do_step(sim, -1.0, 0.1) == STICKSLIP_STEP);
    end(0);
    stickslip_free(copy);
    stickslip_free(sim);
    stickslip_state_free(state);
    stickslip_model_free(model);
    stickslip_model_free(compiled);
    return count;
}

int main(void) {
    static double expected[2 * LONGEST * (STEPS + 1)], found[2 * LONGEST * (STEPS + 1)];
    static const char *const models[] = {"reduced", "condensed"};
    for (size_t m = 0; m < 2; m++) {
        char scene[2048];
        snprintf(scene, sizeof scene,
                 "{\"schema_version\": 1, \"name\": \"x\","
                 " \"mesh\": {\"kind\": \"rectangle\", \"size\": [1.0, 0.5], \"cells\": [16, 8]},"
                 " \"material\": {\"viscosity\": {\"law\": \"isotropic\", \"mu1\": 0.05, \"mu2\": 0.1},"
                 "   \"elasticity\": {\"law\": \"isotropic\", \"young\": 1.0, \"poisson\": 0.3, \"convention\": \"kazmi2014\"}},"
                 " \"clamped\": [\"left\"],"
                 " \"contact\": {\"part\": \"bottom\","
                 "   \"friction\": {\"law\": \"exponential\", \"a\": 0.003, \"b\": 0.001, \"alpha\": 100.0}},"
                 " \"loads\": [{\"name\": \"press\", \"kind\": \"traction\", \"part\": \"top\", \"direction\": [0, 1],"
                 "   \"start\": -0.3}],"
                 " \"time\": {\"step\": 0.03125}, \"fidelity\": {\"model\": \"%s\"}}",
                 models[m]);
        size_t count = run(scene, expected);
        signal(SIGFPE, on_trap);
        for (int kind = 0; kind < 5; kind++) {
            fenv_t old;
            CHECK(fegetenv(&old) == 0);
            feclearexcept(FE_ALL_EXCEPT);
            if (kind == 0) feenableexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW);
            if (kind == 1) fesetround(FE_UPWARD);
            if (kind == 2) feraiseexcept(FE_OVERFLOW | FE_DIVBYZERO);
#if defined(__x86_64__)
            if (kind == 3) _mm_setcsr(_mm_getcsr() | 0x8040); /* flush to zero, subnormal numbers are zero */
#endif
            if (kind == 4) feenableexcept(FE_ALL_EXCEPT);
            size_t again = run(scene, found);
            where = "the test";
            CHECK(fesetenv(&old) == 0);
            CHECK(again == count);
            CHECK(memcmp(expected, found, count * sizeof *found) == 0);
        }
        signal(SIGFPE, SIG_DFL);
    }
    return 0;
}
