/* A controller that presses a pad so that half of it sticks: the top of the pad is shaken along a table and pressed on it, both by
 * its displacement, and friction follows the pressure. Once per period the controller presses harder where too little of the
 * contact stuck all the time, and less where too much did. Under a friction bound that pressure does not change it would run
 * away. */
#include "common.h"
#include <math.h>

enum { PERIODS = 40, STEPS = 40 };
static const double H = 0.05, WANTED = 0.5, GAIN = 0.0008, SHAKE = 0.02, TWO_PI = 6.283185307179586;

static const char *const PRESSED =
    "{\"schema_version\": 1, \"name\": \"pressed\","
    " \"mesh\": {\"kind\": \"rectangle\", \"size\": [1.0, 0.25], \"cells\": [32, 8]},"
    " \"material\": {\"viscosity\": {\"law\": \"isotropic\", \"mu1\": 0.02, \"mu2\": 0.05},"
    "   \"elasticity\": {\"law\": \"isotropic\", \"young\": 1.0, \"poisson\": 0.3, \"convention\": \"plane_strain\"}},"
    " \"driven\": [{\"part\": \"top\", \"input\": \"displacement\", \"directions\": {\"press\": [0, -1], \"shake\": [1, 0]}}],"
    " \"contact\": {\"part\": \"bottom\", \"condition\": {\"kind\": \"unilateral\"},"
    "   \"friction\": {\"law\": \"coulomb\", \"coefficient\": 0.4}},"
    " \"time\": {\"step\": 0.05}, \"fidelity\": {\"model\": \"reduced\"}}";

int main(void) {
    stickslip_model *model = NULL;
    stickslip_simulator *sim = NULL;
    stickslip_model_info info;
    double press = 0.01, time = 0.0, first = -1.0, least = 0.0;
    int period, i;

    must(stickslip_model_compile(PRESSED, &model), "compile");
    must(stickslip_model_get_info(model, &info), "info");
    const size_t stick = place_of(model, "contact.stick_fraction"), normal = place_of(model, "contact.normal_force");
    double *values = (double *)room(info.outputs, sizeof(double));
    must(stickslip_new(model, &sim), "new");
    must(stickslip_init(sim, 0.0), "init");
    printf("period   pressed by (m)   normal force (N)   sticks throughout\n");
    for (period = 0; period < PERIODS; ++period) {
        least = 1.0;
        for (i = 1; i <= STEPS; ++i) {
            const double inputs[2] = {press, SHAKE * sin(TWO_PI * i / STEPS)};
            must(stickslip_set_inputs(sim, inputs, 2), "set_inputs");
            must(stickslip_do_step(sim, time, H), "do_step");
            must(stickslip_get_outputs(sim, values, info.outputs), "get_outputs");
            time += H;
            least = fmin(least, values[stick]);
        }
        if (first < 0.0) first = least;
        if (period % 8 == 0 || period == PERIODS - 1)
            printf("%6d %16.5f %18.4f %19.2f\n", period, press, values[normal], least);
        press = fmax(press + GAIN * (WANTED - least), 0.0);
    }
    check(fabs(first - WANTED) > 0.2, "there is something to control");
    check(fabs(least - WANTED) <= 0.05, "half of the contact sticks");
    stickslip_free(sim);
    stickslip_model_free(model);
    free(values);
    return 0;
}
