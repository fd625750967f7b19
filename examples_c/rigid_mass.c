/* A rigid mass m is bolted to the top of a pad that rubs on a moving table: implicit coupling through a driven part,
 *
 *     m v' = P(t) - f,   x' = v        (backward Euler; P a push, f the force needed to drive the part)
 *
 * in both causalities: the mass gives the pad its velocity, or its displacement, and takes the force. Both ends of the bolt must
 * agree at the end of every step, which Newton's method finds with the derivative of the force; every trial is rolled back. The
 * motion is the same, to rounding, and the power that goes into the pad is what it stores and dissipates. */
#include "common.h"
#include <math.h>
#include <string.h>

enum { STEPS = 80, MOST = 20 };
static const double H = 0.02, MASS = 0.5, TOLERANCE = 1e-12;

static const char *const BOLTED =
    "{\"schema_version\": 1, \"name\": \"bolted\","
    " \"mesh\": {\"kind\": \"rectangle\", \"size\": [1.0, 0.5], \"cells\": [16, 8]},"
    " \"material\": {\"viscosity\": {\"law\": \"isotropic\", \"mu1\": 0.05, \"mu2\": 0.1},"
    "   \"elasticity\": {\"law\": \"isotropic\", \"young\": 1.0, \"poisson\": 0.3, \"convention\": \"plane_strain\"}},"
    " \"driven\": [{\"part\": \"top\", \"input\": \"%s\", \"directions\": {\"slide\": [1, 0], \"lift\": [0, 1]}}],"
    " \"contact\": {\"part\": \"bottom\","
    "   \"friction\": {\"law\": \"exponential\", \"a\": 0.2, \"b\": 0.1, \"alpha\": 2.0},"
    "   \"foundation\": [{\"kind\": \"sliding\", \"name\": \"table\", \"direction\": [1, 0], \"start\": 0.1}]},"
    " \"time\": {\"scheme\": \"backward_euler\", \"step\": 0.02, \"inputs\": \"hold\"},"
    " \"fidelity\": {\"model\": \"reduced\", \"friction_tolerance\": 1e-13}}";

static double push(double t) { return 0.3 * sin(3.0 * t); }

/* Couples for STEPS steps; the positions of the mass go to x. Most trials that a step took. */
static int run(const char *causality, double *x) {
    char scene[2048];
    stickslip_model *model = NULL;
    stickslip_simulator *sim = NULL;
    stickslip_state *before = NULL;
    stickslip_model_info info;
    const int is_velocity = strcmp(causality, "velocity") == 0;
    double position = 0.0, velocity = 0.0, stored = 0.0;
    int n, most = 0;

    sprintf(scene, BOLTED, causality);
    must(stickslip_model_compile(scene, &model), "compile");
    must(stickslip_model_get_info(model, &info), "info");
    const size_t force = place_of(model, "slide.force");
    double *values = (double *)room(info.outputs, sizeof(double));
    double *tangent = (double *)room(info.outputs, sizeof(double));
    must(stickslip_new(model, &sim), "new");
    must(stickslip_init(sim, 0.0), "init");
    must(stickslip_state_new(sim, &before), "state_new");
    for (n = 0; n < STEPS; ++n) {
        const double time = n * H;
        const double seed[3] = {0.0, 1.0, 0.0};
        double v = velocity;
        int trial = 0;
        must(stickslip_save_state(sim, before), "save");
        for (;;) {
            /* in the order of the ports, directions of a part by their names: lift, slide, table */
            const double inputs[3] = {0.0, is_velocity ? v : position + H * v, 0.1};
            double residual, slope;
            if (trial > 0) must(stickslip_restore_state(sim, before), "restore");
            must(stickslip_set_inputs(sim, inputs, 3), "set_inputs");
            must(stickslip_do_step(sim, time, H), "do_step");
            must(stickslip_get_outputs(sim, values, info.outputs), "get_outputs");
            residual = MASS * (v - velocity) / H - push(time + H) + values[force];
            ++trial;
            if (fabs(residual) < TOLERANCE || trial == MOST) break;
            must(stickslip_directional_derivative(sim, seed, 3, tangent, info.outputs), "derivative");
            /* of the force by v: a displacement grows with it by H */
            slope = MASS / H + tangent[force] * (is_velocity ? 1.0 : H);
            v -= residual / slope;
        }
        check(trial < MOST, "the two sides of the bolt agree");
        if (trial > most) most = trial;
        velocity = v;
        position += H * v;
        x[n] = position;
        check(fabs(values[place_of(model, "slide.displacement")] - position) < 1e-12, "the part moves with the mass");
    }
    stored = values[place_of(model, "energy.elastic")] + values[place_of(model, "energy.viscous_dissipation")] +
             values[place_of(model, "energy.friction_dissipation")];
    check(stored > 1e-4, "the pad takes power");
    check(fabs(values[place_of(model, "energy.balance_error")]) < 0.05 * stored, "the power balance is closed");
    stickslip_state_free(before);
    stickslip_free(sim);
    stickslip_model_free(model);
    free(values);
    free(tangent);
    return most;
}

int main(void) {
    double by_velocity[STEPS], by_displacement[STEPS], largest = 0.0, difference = 0.0;
    int n;
    const int first = run("velocity", by_velocity), second = run("displacement", by_displacement);
    for (n = 0; n < STEPS; ++n) {
        largest = fmax(largest, fabs(by_velocity[n]));
        difference = fmax(difference, fabs(by_velocity[n] - by_displacement[n]));
    }
    check(largest > 0.01, "the mass moves");
    check(difference < 1e-10, "both causalities give one motion");
    printf("the mass moves by up to %.6f m; velocity and displacement as input differ by %.1e m;\n", largest, difference);
    printf("at most %d and %d trials in a step\n", first, second);
    return 0;
}
