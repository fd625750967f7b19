/* What the examples share: the scene of a brake pad, and what to do about an error. */
#ifndef EXAMPLES_COMMON_H
#define EXAMPLES_COMMON_H

#include <stickslip.h>
#include <stdio.h>
#include <stdlib.h>

/* A pad of 1 m x 0.5 m clamped on its left, in contact with a rail at the bottom. `press` acts downwards on its top
 * (and squeezes it along the rail), `pull` along the rail on its right end, where `tip` is observed. */
static const char *const PAD =
    "{\"schema_version\": 1, \"name\": \"pad\","
    " \"mesh\": {\"kind\": \"rectangle\", \"size\": [1.0, 0.5], \"cells\": [16, 8]},"
    " \"material\": {\"viscosity\": {\"law\": \"isotropic\", \"mu1\": 0.05, \"mu2\": 0.1},"
    "   \"elasticity\": {\"law\": \"isotropic\", \"young\": 1.0, \"poisson\": 0.3, \"convention\": \"plane_strain\"}},"
    " \"clamped\": [\"left\"],"
    " \"contact\": {\"part\": \"bottom\","
    "   \"friction\": {\"law\": \"exponential\", \"a\": 0.02, \"b\": 0.01, \"alpha\": 5.0}},"
    " \"loads\": [{\"name\": \"press\", \"kind\": \"traction\", \"part\": \"top\", \"direction\": [0, -1]},"
    "   {\"name\": \"pull\", \"kind\": \"traction\", \"part\": \"right\", \"direction\": [1, 0]}],"
    " \"probes\": [{\"name\": \"tip\", \"at\": [1.0, 0.25]}],"
    " \"time\": {\"scheme\": \"tr_bdf2\", \"step\": 0.02},"
    " \"fidelity\": {\"model\": \"reduced\", \"friction_tolerance\": 1e-12},"
    " \"history\": {\"capacity\": 16}}";

/* Ends the program with the library's own words when a call failed. */
static inline void must(int32_t code, const char *what) {
    if (code < 0) {
        char why[512];
        stickslip_last_error(why, sizeof why);
        fprintf(stderr, "%s: %s: %s\n", what, stickslip_code_name(code), why);
        exit(1);
    }
}

/* Ends the program when an answer is not what it must be. */
static inline void check(int is_right, const char *what) {
    if (!is_right) {
        fprintf(stderr, "wrong answer: %s\n", what);
        exit(1);
    }
}

/* Place of the first value of an output in the array of stickslip_get_outputs. */
static inline size_t place_of(const stickslip_model *model, const char *name) {
    stickslip_port port;
    must(stickslip_model_find_port(model, name, &port), name);
    return port.offset;
}

/* Memory, or the end of the program. */
static inline void *room(size_t count, size_t size) {
    void *memory = calloc(count, size);
    if (memory == NULL) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    return memory;
}

#endif
