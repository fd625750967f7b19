/* A brake: an actuator ramps the pressing load up in half a second while the rail drags the pad; the master reads
 * tangential stress and slip, writes one CSV row per step to brake.csv (or the file named on the command line), and at the
 * end looks at the recorded past of the node at the free end. */
#include "common.h"
#include <math.h>

enum { STEPS = 50 };
static const double H = 0.02;

int main(int argc, char **argv) {
    const char *path = argc > 1 ? argv[1] : "brake.csv";
    stickslip_model *model;
    stickslip_model_info info;
    stickslip_simulator *sim;
    must(stickslip_model_compile(PAD, &model), "compile");
    must(stickslip_model_get_info(model, &info), "info");
    must(stickslip_new(model, &sim), "new");
    must(stickslip_init(sim, 0.0), "init");
    const size_t stress = place_of(model, "contact.tangential_stress"), slip = place_of(model, "contact.slip");
    const size_t work = place_of(model, "energy.external_work"), friction = place_of(model, "energy.friction_dissipation");
    const size_t end = info.contact_nodes - 1;
    double *values = (double *)room(info.outputs, sizeof *values);

    FILE *csv = fopen(path, "w");
    check(csv != NULL, "the CSV can be written");
    fprintf(csv, "time,press,tangential_stress,slip\n");
    for (int n = 0; n < STEPS; n++) {
        const double time = (n + 1) * H;
        const double loads[2] = {0.1 * fmin(time / 0.5, 1.0), 0.05};
        must(stickslip_set_inputs(sim, loads, 2), "set_inputs");
        must(stickslip_do_step(sim, n * H, H), "do_step");
        must(stickslip_get_outputs(sim, values, info.outputs), "get_outputs");
        fprintf(csv, "%.17g,%.17g,%.17g,%.17g\n", time, loads[0], values[stress + end], values[slip + end]);
        check(fabs(values[stress + end]) <= 0.02 * (1.0 + 1e-9), "the stress is within the static bound");
    }
    check(fclose(csv) == 0, "the CSV is complete");

    size_t rows;
    must(stickslip_slip_history(sim, end, NULL, NULL, NULL, NULL, 0, &rows), "rows");
    double *times = (double *)room(rows, sizeof *times), *slips = (double *)room(rows, sizeof *slips);
    must(stickslip_slip_history(sim, end, times, NULL, slips, NULL, rows, &rows), "slip_history");
    printf("%zu rows of history from %.2f s to %.2f s; slip %.6f m\n", rows, times[0], times[rows - 1], slips[rows - 1]);
    check(rows == info.history, "the history is full");
    check(slips[rows - 1] == values[slip + end], "the history ends with the present");
    printf("work of the loads %.3e J, of it into friction %.3e J\n", values[work], values[friction]);
    check(values[friction] > 0.0 && values[friction] < values[work], "friction takes a part of the work");
    free(times);
    free(slips);
    free(values);
    stickslip_free(sim);
    stickslip_model_free(model);
    return 0;
}
