/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Any bytes as an expression of four parameters, two of which vary: it is refused with a
 * message, or parsed, built and evaluated, and then its value lies in its enclosure over a box
 * around the point.
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "common/fuzz.h"
#include "expr/interpolant.h"
#include "expr/interval.h"
#include "expr/program.h"

enum { N_PARAMS = 4 };
static const char *const names[N_PARAMS] = {"x", "y", "z", "k_1"};

static int find(const void *context, const char *name, size_t length)
{
    (void)context;
    for (int i = 0; i < N_PARAMS; i++) {
        if (strlen(names[i]) == length && memcmp(names[i], name, length) == 0) {
            return i;
        }
    }
    return -1;
}

static void requirement_enclosed(const mt_program *p, mt_arena *mem)
{
    static const double at[N_PARAMS] = {0.75, -2.0, 3.0, 1e3};
    static const double lower[N_PARAMS] = {0.5, -2.0, 2.0, 999.0};
    static const double upper[N_PARAMS] = {1.0, 2.0, 3.0, 1001.0};
    const size_t n = (size_t)p->count;
    double *const value = mt_arena_f64(mem, n, 3);
    double *const grad = mt_arena_f64(mem, n * N_PARAMS, 3);
    if (value == NULL || grad == NULL) {
        abort();
    }
    double *const lo = value + n;
    double *const dlo = grad + n * N_PARAMS;
    mt_program_interval_gradient(p, lower, upper, lo, lo + n, dlo, dlo + n * N_PARAMS);
    mt_node bad = p->count;
    mt_err err;
    if (mt_program_gradient(p, at, value, grad, &bad, &err) != MT_OK) {
        DEMAND(err.text[0] != '\0' && bad >= 0 && bad < p->count);
        return;
    }
    for (size_t i = 0; i < n; i++) {
        DEMAND(lo[i] <= value[i] && value[i] <= lo[n + i]);
    }
    for (size_t i = 0; i < n * N_PARAMS; i++) {
        DEMAND(dlo[i] <= grad[i] && grad[i] <= dlo[n * N_PARAMS + i]);
    }
}

static void use(const mt_expr *e, mt_arena *mem)
{
    mt_program p;
    DEMAND(e->length > 0 && e->length <= MT_EXPR_MAX_CODE);
    DEMAND(mt_program_init(&p, N_PARAMS, mem, NULL) == MT_OK);
    mt_node inputs[N_PARAMS];
    for (int i = 0; i < N_PARAMS; i++) {
        inputs[i] = i < 2 ? mt_program_input(&p, i, i) : mt_program_const(&p, 3.0 + i);
    }
    const mt_node root = mt_program_expr(&p, e, inputs, N_PARAMS);
    DEMAND(root >= 0);
    if (p.undecided) { /* a condition of an if() on an input */
        DEMAND(mt_program_finish(&p, NULL) == MT_E_INPUT);
        return;
    }
    DEMAND(mt_program_finish(&p, NULL) == MT_OK);
    double value = 0.0;
    if (mt_expr_is_constant(e, &value)) {
        DEMAND(mt_program_is_constant(&p, root));
    }
    requirement_enclosed(&p, mem);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *const text = malloc(size + 1); /* exact size: reading past the end is seen */
    mt_arena mem;
    DEMAND(text != NULL && mt_arena_init(&mem, 0, NULL) == MT_OK);
    if (size > 0) {
        memcpy(text, data, size);
    }
    text[size] = '\0';
    mt_expr e;
    mt_err err = {.code = MT_OK};
    static const double x[] = {-1, 0, 2};
    static const double y[] = {3, 1, 1};
    mt_interpolant curve;
    DEMAND(mt_interpolant_init(&curve, "c", 3, x, y, &mem, NULL) == MT_OK);
    const mt_expr_scope scope = {
        .lookup = find, .names = names, .n_names = N_PARAMS, .curves = &curve, .n_curves = 1};
    const mt_status rc = mt_expr_parse(text, &scope, &mem, &e, &err);
    if (rc == MT_OK) {
        use(&e, &mem);
    } else {
        DEMAND(rc == MT_E_INPUT && err.text[0] != '\0');
    }
    mt_arena_free(&mem);
    free(text);
    return 0;
}
