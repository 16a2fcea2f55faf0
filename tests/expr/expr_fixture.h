/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the tests of expressions share: the parameters x, y, z and k_1, and one expression as a
 * program. */
#ifndef EXPR_FIXTURE_H
#define EXPR_FIXTURE_H

#include <stdint.h>
#include <string.h>

#include "expr/program.h"

enum { N_PARAMS = 4 };
static const char *const param_names[N_PARAMS] = {"x", "y", "z", "k_1"};

/* splitmix64: the same numbers everywhere */
static inline uint64_t next(uint64_t *state)
{
    *state += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = *state;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

/* uniform in [0, 1) */
static inline double uniform(uint64_t *state)
{
    return (double)(next(state) >> 11) * 0x1p-53;
}

static inline int find_param(const void *context, const char *name, size_t length)
{
    (void)context;
    for (int i = 0; i < N_PARAMS; i++) {
        if (strlen(param_names[i]) == length && memcmp(param_names[i], name, length) == 0) {
            return i;
        }
    }
    return -1;
}

static inline mt_status parse_text(const char *text, mt_arena *mem, mt_expr *e, mt_err *err)
{
    const mt_expr_scope scope = {
        .lookup = find_param, .names = param_names, .n_names = N_PARAMS};
    return mt_expr_parse(text, &scope, mem, e, err);
}

enum { ADDR = 77 }; /* the address that the fixture's programs carry */

typedef struct fixture {
    mt_arena mem;
    mt_program p;
    mt_node root;
    double *value;
    double *grad;
    double *lo;
    double *hi;
    double *dlo;
    double *dhi;
} fixture;

static inline bool fixture_buffers(fixture *f)
{
    const size_t n = (size_t)f->p.count;
    f->value = mt_arena_f64(&f->mem, n, 1);
    f->lo = mt_arena_f64(&f->mem, n, 1);
    f->hi = mt_arena_f64(&f->mem, n, 1);
    f->grad = mt_arena_f64(&f->mem, n, N_PARAMS);
    f->dlo = mt_arena_f64(&f->mem, n, N_PARAMS);
    f->dhi = mt_arena_f64(&f->mem, n, N_PARAMS);
    return f->value != NULL && f->lo != NULL && f->hi != NULL && f->grad != NULL &&
           f->dlo != NULL && f->dhi != NULL;
}

/* The text as a finished program of the four parameters; false: err says why. */
static inline bool fixture_init(fixture *f, const char *text, mt_err *err)
{
    *f = (fixture){.root = MT_NO_NODE};
    mt_expr e;
    if (mt_arena_init(&f->mem, 0, err) != MT_OK ||
        parse_text(text, &f->mem, &e, err) != MT_OK ||
        mt_program_init(&f->p, N_PARAMS, &f->mem, err) != MT_OK) {
        return false;
    }
    mt_node inputs[N_PARAMS];
    for (int i = 0; i < N_PARAMS; i++) {
        inputs[i] = mt_program_input(&f->p, i, ADDR);
    }
    f->root = mt_program_expr(&f->p, &e, inputs, ADDR);
    return mt_program_finish(&f->p, err) == MT_OK && fixture_buffers(f);
}

/* The root's row of an array of rows of N_PARAMS: its derivatives. */
static inline const double *root_row(const fixture *f, const double *rows)
{
    return rows + (ptrdiff_t)f->root * N_PARAMS;
}

static inline void fixture_free(fixture *f)
{
    mt_arena_free(&f->mem);
}

#endif
