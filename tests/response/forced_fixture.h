/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forced problems made of matrices, and all ways to their responses. */
#ifndef FORCED_FIXTURE_H
#define FORCED_FIXTURE_H

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "response/poles.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { FORCED_MOST = 12 };

/* Matrices of up to FORCED_MOST freedoms; what is NULL in f is not there. */
typedef struct forced {
    mt_forced f;
    double k[FORCED_MOST * FORCED_MOST];
    double m[FORCED_MOST * FORCED_MOST];
    double c[FORCED_MOST * FORCED_MOST];
    double h[FORCED_MOST * FORCED_MOST];
    double b[FORCED_MOST * FORCED_MOST];
    double s[FORCED_MOST * FORCED_MOST];
    mt_arena mem;
    mt_mass_factor mass;
    mt_modes modes;
    mt_transfer direct;
    mt_basis basis;
    mt_err err;
} forced;

/* Every freedom an input and an output: displacements by forces. */
static inline void forced_all(forced *p, int n)
{
    memset(p, 0, sizeof *p);
    p->f = (mt_forced){.n = n, .k = p->k, .m = p->m, .n_in = n, .n_out = n};
    for (int i = 0; i < n; i++) {
        p->b[i + (i * n)] = 1.0;
        p->s[i + (i * n)] = 1.0;
    }
    p->f.b[0] = p->b;
    p->f.s[0] = p->s;
}

/* a += value e e^T, e between freedoms i and j (-1: the ground). */
static inline void forced_between(double *a, int n, int i, int j, double value)
{
    const int end[2] = {i, j};
    for (int r = 0; r < 2; r++) {
        for (int c = 0; c < 2; c++) {
            if (end[r] >= 0 && end[c] >= 0) {
                a[end[r] + (end[c] * n)] += r == c ? value : -value;
            }
        }
    }
}

/* A random problem: a tree of springs with bracing, some of them dampers or lossy. */
static inline void forced_random(mt_random *r, forced *p, int n, bool grounded)
{
    forced_all(p, n);
    for (int i = 0; i < n; i++) {
        const int to = i == 0 ? -1 : mt_random_int(r, i);
        const double k = pow(10.0, mt_random_in(r, 2.0, 5.0));
        p->m[i + (i * n)] = pow(10.0, mt_random_in(r, -1.0, 1.0));
        if (i > 0 || grounded) {
            forced_between(p->k, n, i, to, k);
            forced_between(p->h, n, i, to, mt_random_in(r, 0.0, 0.1) * k);
            forced_between(p->c, n, i, mt_random_int(r, n), mt_random_in(r, 0.0, 5.0));
        }
    }
    for (int i = 0; i < n * n; i++) { /* other inputs and outputs than the freedoms */
        p->b[i] += mt_random_in(r, -0.5, 0.5);
    }
    memcpy(p->s, p->b, sizeof p->s);
    p->f.c = mt_random_int(r, 3) > 0 ? p->c : NULL;
    p->f.h = mt_random_int(r, 3) > 0 ? p->h : NULL;
}

/* Both ways, with `keep` modes (0: all). */
static inline bool forced_make(mt_test *t, forced *p, int keep)
{
    mt_status rc = mt_arena_init(&p->mem, 0, &p->err);
    const int n = p->f.n;
    rc = rc == MT_OK ? mt_modal_factor_mass(n, p->m, &p->mem, &p->mass, &p->err) : rc;
    rc = rc == MT_OK ? mt_modal_solve(p->k, &p->mass, NULL, NULL, &p->mem, &p->modes, &p->err)
                     : rc;
    const mt_basis_problem problem = {
        .f = &p->f, .mass = &p->mass, .modes = &p->modes, .keep = keep};
    rc = rc == MT_OK ? mt_basis_make(&problem, &p->mem, &p->basis, &p->err) : rc;
    rc = rc == MT_OK ? mt_transfer_direct(&p->f, &p->mem, &p->direct, &p->err) : rc;
    if (!CHECK(t, rc == MT_OK)) {
        (void)fprintf(stderr, "%s\n", p->err.text);
    }
    return rc == MT_OK;
}

static inline mt_sample forced_sample(forced *p, mt_arena *mem)
{
    const size_t size = (size_t)p->f.n_in * (size_t)p->f.n_out;
    return (mt_sample){.h = mt_arena_alloc(mem, size, sizeof(double complex)),
                       .dh = mt_arena_alloc(mem, size, sizeof(double complex)),
                       .error = mt_arena_f64(mem, size, 1)};
}

#endif
