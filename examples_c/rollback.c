/* Implicit coupling: a mass m on a spring k and a damper c hangs on the right end of the pad through the spring
 *
 *     force on the pad      F = s (x - u),   u the mean displacement of the pulled face
 *     m x'' + c x' = P(t) - F                (backward Euler; P a constant push)
 *
 * Both sides must agree at the end of every step: find F with F = s (x(F) - u(F)). The connecting spring is stiff, so taking
 * F from the last step would be unstable. Solved twice: by the fixed point with Aitken's relaxation, and by Newton with
 * the derivative du/dF from stickslip_directional_derivative. Every trial step is rolled back. */
#include "common.h"
#include <math.h>

enum { STEPS = 60, MOST = 200 };
static const double H = 0.02, MASS = 0.05, DAMPER = 0.2, SPRING = 4.0, PUSH = 0.08, AREA = 0.5, TOLERANCE = 1e-12;

typedef struct { double x, v; } Mass;

static Mass advance(Mass at, double force) {
    Mass next;
    next.v = (MASS * at.v + H * (PUSH - force)) / (MASS + H * DAMPER);
    next.x = at.x + H * next.v;
    return next;
}

typedef struct {
    stickslip_simulator *sim;
    stickslip_state *before;
    size_t outputs, displacement;
    double *values, *tangent;
} Pad;

/* A trial step under the force F; the mean displacement of the pulled face. */
static double trial(Pad *pad, double time, double force) {
    const double loads[2] = {0.02, force / AREA};
    must(stickslip_restore_state(pad->sim, pad->before), "restore");
    must(stickslip_set_inputs(pad->sim, loads, 2), "set_inputs");
    must(stickslip_do_step(pad->sim, time, H), "do_step");
    must(stickslip_get_outputs(pad->sim, pad->values, pad->outputs), "get_outputs");
    return pad->values[pad->displacement];
}

/* d displacement / d F of the last trial. */
static double slope(Pad *pad) {
    const double seed[2] = {0.0, 1.0 / AREA};
    must(stickslip_directional_derivative(pad->sim, seed, 2, pad->tangent, pad->outputs), "derivative");
    return pad->tangent[pad->displacement];
}

/* Couples for STEPS steps; the total number of trials. */
static int run(const stickslip_model *model, int is_newton, double *x, double *u) {
    stickslip_model_info info;
    must(stickslip_model_get_info(model, &info), "info");
    Pad pad;
    pad.outputs = info.outputs;
    pad.displacement = place_of(model, "pull.displacement");
    pad.values = (double *)room(info.outputs, sizeof(double));
    pad.tangent = (double *)room(info.outputs, sizeof(double));
    must(stickslip_new(model, &pad.sim), "new");
    must(stickslip_init(pad.sim, 0.0), "init");
    must(stickslip_state_new(pad.sim, &pad.before), "state_new");
    const double dx = -H * H / (MASS + H * DAMPER); /* d x / d F */
    Mass mass = {0.0, 0.0};
    double force = 0.0;
    int trials = 0;
    for (int n = 0; n < STEPS; n++) {
        const double time = n * H;
        must(stickslip_save_state(pad.sim, pad.before), "save");
        double relaxation = 0.1, last = 0.0, residual = 1.0;
        Mass next = mass;
        for (int i = 0; fabs(residual) > TOLERANCE; i++) {
            check(i < MOST, "the coupling converges");
            const double displacement = trial(&pad, time, force);
            trials++;
            next = advance(mass, force);
            residual = SPRING * (next.x - displacement) - force;
            *u = displacement;
            if (fabs(residual) <= TOLERANCE) break;
            if (is_newton) {
                force -= residual / (SPRING * (dx - slope(&pad)) - 1.0);
            } else {
                if (i > 0 && residual != last) relaxation = -relaxation * last / (residual - last);
                last = residual;
                force += relaxation * residual;
            }
        }
        mass = next;
    }
    *x = mass.x;
    stickslip_state_free(pad.before);
    stickslip_free(pad.sim);
    free(pad.values);
    free(pad.tangent);
    return trials;
}

int main(void) {
    stickslip_model *model;
    must(stickslip_model_compile(PAD, &model), "compile");
    double x[2], u[2];
    const int fixed_point = run(model, 0, &x[0], &u[0]);
    const int newton = run(model, 1, &x[1], &u[1]);
    stickslip_model_free(model);
    printf("fixed point %.2f, Newton %.2f trial steps per step; mass at %.9f m, pad at %.9f m\n",
           (double)fixed_point / STEPS, (double)newton / STEPS, x[1], u[1]);
    check(fabs(x[0] - x[1]) < 1e-9 && fabs(u[0] - u[1]) < 1e-9, "both find the same motion");
    check(newton < fixed_point, "the derivative saves trial steps");
    return 0;
}
