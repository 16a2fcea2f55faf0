/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_SPARSE_PRIV_H
#define MODAL_SPARSE_PRIV_H

#include "modal/sparse.h"

/* H = K + s M + A^T Gamma A of a sparse problem, factored, and what is solved with it. */
typedef struct mt_sparse {
    const mt_sparse_problem *p;
    double shift;
    double *gamma;      /* [rows of A] */
    double stiffer;     /* one of STIFFER */
    bool outweigh;      /* that of G in each state that they hold, not of all in units */
    double stiffest;    /* that times the largest stiffness */
    mt_rows columns[3]; /* of K's, M's and A's rows: by state, (row, value) */
    mt_lower h;         /* pattern of all, values of what is factored */
    double *k;          /* values in that pattern: K + A^T Gamma A */
    double *m;
    mt_factor held;            /* H */
    mt_factor count;           /* of counts */
    int freedoms;              /* states less independent rows of A */
    bool refined;              /* products are refined */
    bool sound;                /* the last step of a solution was a small part of it */
    double *x, *f, *r, *s, *w; /* [n] */
    double *mu;                /* [rows of A] */
    double *gap;               /* A x + A dx */
    mt_arena *mem;
} mt_sparse;

/* Everything but values of the factor, of one that is zeroed but for p, mem, stiffer and
 * outweigh. */
mt_status mt_sparse_prepare(mt_sparse *s, mt_err *err);
/* H with this shift; *sound: positive, and it solves. */
mt_status mt_sparse_factor(mt_sparse *s, double shift, bool *sound, mt_err *err);
/* x, s->mu with (K + s M) x + A^T mu = f, A x = 0, to a part `close` of its energy, or as close
 * as rounding lets it come. */
mt_status mt_sparse_solve(mt_sparse *s, const double *f, double close, double *x, mt_err *err);
/* y := M x. */
void mt_sparse_metric(void *context, const double *x, double *y);
/* Values of K + A^T Gamma A + c M into the pattern. */
void mt_sparse_combine(const mt_sparse *s, double c);
/* s->freedoms: states less independent rows of A. */
mt_status mt_sparse_freedoms(mt_sparse *s, mt_err *err);

/* Of mt_sparse_solve: as close as rounding lets it come. */
static const double MT_SPARSE_SOLVED = 1e-16;

#endif
