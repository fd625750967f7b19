/* Steps the scene in the file argv[1] argv[2] times by argv[3] s and prints the bits of all outputs after every step. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <stickslip.h>

static void must(int32_t code) {
    if (code != STICKSLIP_OK) {
        char why[512];
        stickslip_last_error(why, sizeof why);
        fprintf(stderr, "%s: %s\n", stickslip_code_name(code), why);
        exit(1);
    }
}

int main(int argc, char **argv) {
    if (argc != 4) return 2;
    FILE *file = fopen(argv[1], "rb");
    static char text[65536];
    if (file == NULL) return 2;
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    const int steps = atoi(argv[2]);
    const double k = strtod(argv[3], NULL);
    stickslip_model *model;
    stickslip_model_info info;
    stickslip_simulator *sim;
    must(stickslip_model_compile(text, &model));
    must(stickslip_model_get_info(model, &info));
    must(stickslip_new(model, &sim));
    must(stickslip_init(sim, 0.0));
    double *values = (double *)malloc(info.outputs * sizeof *values);
    for (int n = 0; n < steps; n++) {
        double time;
        must(stickslip_get_time(sim, &time));
        must(stickslip_do_step(sim, time, k));
        must(stickslip_get_outputs(sim, values, info.outputs));
        for (size_t i = 0; i < info.outputs; i++) {
            uint64_t bits;
            memcpy(&bits, &values[i], sizeof bits);
            printf("%016" PRIx64 "\n", bits);
        }
    }
    free(values);
    stickslip_free(sim);
    stickslip_model_free(model);
    return 0;
}
