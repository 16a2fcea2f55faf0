/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TESTS_NLP_PROBLEM_H
#define TESTS_NLP_PROBLEM_H

/* Closed-form problems for the search engine: their rows at a point, and what is found. */
#include <math.h>
#include <string.h>

#include "mt_test.h"
#include "nlp/nlp.h"

enum { N_MOST = 48, M_MOST = 48 };

typedef struct nlp_case nlp_case;

/* Objective, rows and all their slopes at t, where nothing can fail. */
typedef void (*nlp_rows)(const nlp_case *c, const double *t, mt_nlp_values *out);

struct nlp_case {
    mt_nlp nlp;
    nlp_rows rows;
    double lower[N_MOST];
    double upper[N_MOST];
    double origin[N_MOST];
    double eq_tol[M_MOST];
    double in_tol[M_MOST];
    double target[M_MOST]; /* whatever the rows want */
    _Atomic long calls;    /* of all workers */
    mt_arena mem;
    mt_nlp_result result;
};

static inline mt_status case_eval(void *context, const double *t, bool with_gradient,
                                  mt_nlp_values *out, mt_err *err)
{
    nlp_case *const c = context;
    (void)with_gradient;
    (void)err;
    c->calls++;
    c->rows(c, t, out);
    return MT_OK;
}

/* c zeroed or used before; n variables between lower and upper, origin 0; tolerances 1e-6.
 * What may fail has rows NULL, and its own nlp.eval. */
static inline void case_begin(nlp_case *c, int n, nlp_rows rows, double lower, double upper)
{
    mt_arena_free(&c->mem);
    memset(c, 0, sizeof *c);
    for (int j = 0; j < N_MOST; j++) {
        c->lower[j] = lower;
        c->upper[j] = upper;
    }
    for (int i = 0; i < M_MOST; i++) {
        c->eq_tol[i] = 1e-6;
        c->in_tol[i] = 1e-6;
    }
    c->nlp = (mt_nlp){.n = n,
                      .lower = c->lower,
                      .upper = c->upper,
                      .origin = c->origin,
                      .eq_tol = c->eq_tol,
                      .in_tol = c->in_tol,
                      .eval = case_eval,
                      .context = c};
    c->rows = rows;
}

/* opt NULL: the default options. */
static inline mt_status case_solve(nlp_case *c, const mt_nlp_options *opt)
{
    const mt_nlp_options usual = mt_nlp_options_default();
    mt_err err = {MT_OK, ""};
    mt_arena_free(&c->mem);
    const mt_status rc = mt_arena_init(&c->mem, 0, NULL);
    return rc == MT_OK
               ? mt_nlp_solve(&c->nlp, opt != NULL ? opt : &usual, &c->mem, &c->result, &err)
               : rc;
}

/* Equal to the bit. */
static inline bool same_bytes(const void *a, const void *b, size_t n)
{
    return memcmp(a, b, n) == 0;
}

/* f = 1/2 sum (t - origin)^2 */
static inline void change(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    out->f = 0;
    for (int j = 0; j < c->nlp.n; j++) {
        const double d = t[j] - c->origin[j];
        out->f += 0.5 * d * d;
        out->df[j] = d;
    }
}

#endif
