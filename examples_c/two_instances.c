/* Two pads of one compiled model under different loads. They share the model, which is saved, loaded and freed before they
 * step; neither sees the other: each ends exactly where it ends alone. */
#include "common.h"

enum { STEPS = 50 };

static double pull_of(int which) { return which == 0 ? 0.05 : 0.15; }

static void step(stickslip_simulator *sim, int which, int n) {
    const double loads[2] = {0.1, pull_of(which)};
    must(stickslip_set_inputs(sim, loads, 2), "set_inputs");
    must(stickslip_do_step(sim, n * 0.02, 0.02), "do_step");
}

static double slip_at_end(const stickslip_simulator *sim, uint32_t port, size_t nodes) {
    double *slip = (double *)room(nodes, sizeof *slip);
    must(stickslip_get(sim, port, slip, nodes), "get");
    double last = slip[nodes - 1];
    free(slip);
    return last;
}

int main(void) {
    stickslip_model *compiled, *model;
    must(stickslip_model_compile(PAD, &compiled), "compile");
    size_t length;
    must(stickslip_model_save(compiled, NULL, 0, &length), "size of the model");
    uint8_t *bytes = (uint8_t *)room(length, 1);
    must(stickslip_model_save(compiled, bytes, length, &length), "save");
    must(stickslip_model_load(bytes, length, &model), "load");
    stickslip_model_free(compiled);
    free(bytes);

    stickslip_model_info info;
    must(stickslip_model_get_info(model, &info), "info");
    stickslip_port slip;
    must(stickslip_model_find_port(model, "contact.slip", &slip), "contact.slip");
    const uint32_t port = slip.reference;

    stickslip_simulator *both[2], *alone[2];
    for (int i = 0; i < 2; i++) {
        must(stickslip_new(model, &both[i]), "new");
        must(stickslip_new(model, &alone[i]), "new");
        must(stickslip_init(both[i], 0.0), "init");
        must(stickslip_init(alone[i], 0.0), "init");
    }
    stickslip_model_free(model); /* the simulators keep what they need */

    for (int n = 0; n < STEPS; n++)
        for (int i = 0; i < 2; i++) step(both[i], i, n);
    for (int i = 0; i < 2; i++)
        for (int n = 0; n < STEPS; n++) step(alone[i], i, n);

    for (int i = 0; i < 2; i++) {
        const double together = slip_at_end(both[i], port, info.contact_nodes);
        printf("pulled by %.2f Pa the free end slips %.9f m\n", pull_of(i), together);
        check(together == slip_at_end(alone[i], port, info.contact_nodes), "a simulator is not disturbed by another");
    }
    check(slip_at_end(both[0], port, info.contact_nodes) < slip_at_end(both[1], port, info.contact_nodes),
          "the harder pull slips further");
    for (int i = 0; i < 2; i++) {
        stickslip_free(both[i]);
        stickslip_free(alone[i]);
    }
    return 0;
}
