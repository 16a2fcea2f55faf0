/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_SPARSE_PRIV_H
#define MODAL_SPARSE_PRIV_H

#include <float.h>

#include "modal/sparse.h"

/* Right-hand sides per solve: ten modes and two beyond the last. */
enum { MT_SPARSE_COLUMNS = 12 };

/* H = K + s M + A^T Gamma A of a sparse problem, factored, and work arrays of its solves. */
typedef struct mt_sparse {
    const mt_sparse_problem *p;
    double shift;
    double *gamma;    /* [rows of A] */
    double stiffer;   /* a factor of STIFFER */
    bool outweigh;    /* gamma outweighs G in each constrained state */
    double stiffest;  /* `stiffer` times the largest stiffness */
    mt_rows by_state; /* transpose of A: by state, (row, value) */
    mt_lower k;       /* K + A^T Gamma A, with places for M */
    mt_lower m;
    mt_factor factor; /* of H, or of the last matrix counted: there is room for one */
    bool holds;       /* `factor` is that of H */
    double least;     /* of the factor of H */
    int freedoms;     /* states less independent rows of A */
    bool refined;     /* products are refined iteratively */
    bool sound;       /* the last steps of a solution were small relative to it */
    double *x, *w;    /* [n] */
    double *f, *r;    /* n x MT_SPARSE_COLUMNS: right-hand sides, residuals */
    double *s;        /* as r: the step */
    double *mu;       /* rows of A x MT_SPARSE_COLUMNS */
    double *gap;      /* the same: A x + A dx */
    mt_arena *mem;
} mt_sparse;

/* Prepare everything but the values of the factor; s is zeroed except for p, mem, stiffer and
 * outweigh. */
mt_status mt_sparse_prepare(mt_sparse *s, mt_err *err);
/* Factor H with this shift; *sound: positive definite, and its solutions are accurate. */
mt_status mt_sparse_factor(mt_sparse *s, double shift, bool *sound, mt_err *err);
/* Factor H with its shift again if another matrix was factored since. */
mt_status mt_sparse_hold(mt_sparse *s, mt_err *err);
/* X, s->mu with (K + s M) X + A^T mu = F, A X = 0, n x count, at most MT_SPARSE_COLUMNS
 * columns, each to a fraction `close` of its energy, or as accurately as rounding allows. F
 * must not be s->r. */
mt_status mt_sparse_solve(mt_sparse *s, int count, const double *f, double close, double *x,
                          mt_err *err);
/* Factor K + part A^T Gamma A + c M; `factor` is then not that of H. */
mt_status mt_sparse_inertia(mt_sparse *s, double part, double c, int *negative, double *least,
                            mt_err *err);
/* y := M x. */
void mt_sparse_metric(void *context, const double *x, double *y);
/* y -= K x, strain by strain. */
void mt_sparse_subtract(const mt_sparse *s, const double *x, double *y);
/* A sum of squares at x, and of the squares of its strains' roundings. */
double mt_sparse_energy(const mt_squares *of, const double *x, double *noise);
/* Rounding of x^T G x, including errors of G. */
double mt_sparse_load_noise(const mt_sparse *s, const double *x);
/* Number of constraint stiffnesses to try, and try i of them, ready to be prepared. */
int mt_sparse_tries(const mt_sparse_problem *p);
mt_sparse mt_sparse_try(const mt_sparse_problem *p, int i, mt_arena *mem);
/* Set s->freedoms: states less independent rows of A. `factor` is then not that of H. */
mt_status mt_sparse_freedoms(mt_sparse *s, mt_err *err);

/* Below this part of the terms whose difference it is, the sign of a pivot is uncertain. */
static const double MT_SPARSE_CERTAIN = 64.0 * DBL_EPSILON;
/* `close` of mt_sparse_solve: to rounding. */
static const double MT_SPARSE_SOLVED = 1e-16;

#endif
