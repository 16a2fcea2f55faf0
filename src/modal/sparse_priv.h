/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_SPARSE_PRIV_H
#define MODAL_SPARSE_PRIV_H

#include <float.h>

#include "modal/sparse.h"

/* Right-hand sides that are solved for at a time: ten modes and two to tell where they end. */
enum { MT_SPARSE_COLUMNS = 12 };

/* H = K + s M + A^T Gamma A of a sparse problem, factored, and what is solved with it. */
typedef struct mt_sparse {
    const mt_sparse_problem *p;
    double shift;
    double *gamma;    /* [rows of A] */
    double stiffer;   /* one of STIFFER */
    bool outweigh;    /* that of G in each state that they hold, not of all in units */
    double stiffest;  /* that times the largest stiffness */
    mt_rows by_state; /* of A: by state, (row, value) */
    mt_lower k;       /* K + A^T Gamma A, with places for M */
    mt_lower m;
    mt_factor factor; /* of H, or of what was counted last: one has room */
    bool holds;       /* of H */
    double least;     /* of the factor of H */
    int freedoms;     /* states less independent rows of A */
    bool refined;     /* products are refined */
    bool sound;       /* the last steps of a solution were small parts of it */
    double *x, *w;    /* [n] */
    double *f, *r;    /* n x MT_SPARSE_COLUMNS: right-hand sides, what is left of them */
    double *s;        /* as r: the step */
    double *mu;       /* rows of A x MT_SPARSE_COLUMNS */
    double *gap;      /* the same: A x + A dx */
    mt_arena *mem;
} mt_sparse;

/* Everything but values of the factor, of one that is zeroed but for p, mem, stiffer and
 * outweigh. */
mt_status mt_sparse_prepare(mt_sparse *s, mt_err *err);
/* H with this shift; *sound: positive, and it solves. */
mt_status mt_sparse_factor(mt_sparse *s, double shift, bool *sound, mt_err *err);
/* That of the shift again where something else was factored since. */
mt_status mt_sparse_hold(mt_sparse *s, mt_err *err);
/* X, s->mu with (K + s M) X + A^T mu = F, A X = 0, n x count, at most MT_SPARSE_COLUMNS, each
 * column to a part `close` of its energy, or as close as rounding lets it come. F is not s->r.
 */
mt_status mt_sparse_solve(mt_sparse *s, int count, const double *f, double close, double *x,
                          mt_err *err);
/* The factor of K + part A^T Gamma A + c M, which then is not H. */
mt_status mt_sparse_inertia(mt_sparse *s, double part, double c, int *negative, double *least,
                            mt_err *err);
/* y := M x. */
void mt_sparse_metric(void *context, const double *x, double *y);
/* y -= K x, strain by strain. */
void mt_sparse_subtract(const mt_sparse *s, const double *x, double *y);
/* A sum of squares at x, and of the squares of its strains' roundings. */
double mt_sparse_energy(const mt_squares *of, const double *x, double *noise);
/* Rounding of x^T G x, of G's own errors, too. */
double mt_sparse_load_noise(const mt_sparse *s, const double *x);
/* How many stiffnesses of constraints there are to try, and try i of them, to be prepared. */
int mt_sparse_tries(const mt_sparse_problem *p);
mt_sparse mt_sparse_try(const mt_sparse_problem *p, int i, mt_arena *mem);
/* s->freedoms: states less independent rows of A. The factor then is not H. */
mt_status mt_sparse_freedoms(mt_sparse *s, mt_err *err);

/* Below this part of what it is the rest of, the sign of a pivot is by chance. */
static const double MT_SPARSE_CERTAIN = 64.0 * DBL_EPSILON;
/* Of mt_sparse_solve: as close as rounding lets it come. */
static const double MT_SPARSE_SOLVED = 1e-16;

#endif
