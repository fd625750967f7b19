/* An elastic block pressed on a table: one step of the paper's example, and where its contact slips. */
#include <stdio.h>
#include <stickslip.h>

int main(void) {
    const char *scene = "{\"schema_version\": 1, \"name\": \"block\", \"clamped\": [\"left\"], \"time\": {\"step\": 0.03125},"
        "\"mesh\": {\"kind\": \"rectangle\", \"size\": [1.0, 0.5], \"cells\": [8, 4]},"
        "\"material\": {\"viscosity\": {\"law\": \"isotropic\", \"mu1\": 0.05, \"mu2\": 0.1}, \"elasticity\":"
        "  {\"law\": \"isotropic\", \"young\": 1.0, \"poisson\": 0.3, \"convention\": \"kazmi2014\"}},"
        "\"contact\": {\"part\": \"bottom\", \"friction\": {\"law\": \"tresca\", \"bound\": 0.002}},"
        "\"loads\": [{\"name\": \"press\", \"kind\": \"traction\", \"part\": \"top\", \"direction\": [0, 1]}]}";
    stickslip_model *model = NULL;
    stickslip_simulator *sim = NULL;
    stickslip_port rate = {0};
    double press = -0.3, rates[8] = {0}; /* 8 contact nodes */
    int failed = stickslip_model_compile(scene, &model) || stickslip_model_find_port(model, "contact.slip_rate", &rate)
        || stickslip_new(model, &sim) || stickslip_init(sim, 0.0) || stickslip_set_inputs(sim, &press, 1)
        || stickslip_do_step(sim, 0.0, 0.03125) || stickslip_get(sim, rate.reference, rates, 8);
    char why[256] = "";
    if (failed) stickslip_last_error(why, sizeof why);
    printf("slip rate at the free end: %g %s %s\n", rates[7], rate.unit ? rate.unit : "", why);
    stickslip_free(sim);
    stickslip_model_free(model);
    return failed || !(rates[7] > 0.0);
}
