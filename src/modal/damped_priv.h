/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_DAMPED_PRIV_H
#define MODAL_DAMPED_PRIV_H

#include "modal/modal_priv.h"

#include <complex.h>

/* Matrices of damped.c. r modes with mass, z directions without, of which zd are damped and zu
 * are not. */
typedef struct mt_damped_parts {
    const mt_damped_problem *p;
    mt_arena *mem;
    int n;
    int r;
    int z;
    int zd;
    int zu;
    double *y; /* n x r, rigid-body modes turned so that their damping is diagonal */
    double *t; /* n x z: the directions without mass, its first zu columns the undamped ones */
    double *b; /* n x zd: columns of y for unit b_D, including the static response of U */
    double *omega; /* [r] signed: S Omega */
    double *caa;   /* r x r */
    double *cda;   /* zd x r */
    double *mu;    /* [zd] */
    double *kd;    /* zd x zd */
    int *x_of;     /* [r] state of x; -1: none */
    int *v_of;     /* [r] state of v; -1: none */
    int order;     /* states */
    double tol;    /* 16 n eps */
} mt_damped_parts;

/* out := A^T B C, A n x ra, C n x rc, B symmetric n x n. */
mt_status mt_damped_sandwich(const mt_damped_parts *s, const double *b, int ra, const double *a,
                             int rc, const double *c, double *out, mt_err *err);
/* Kind of a root s = re + i im, im >= 0, with rounding error `noise`. */
mt_damped_kind mt_damped_kind_of(double re, double im, double noise);
/* Divide a shape by its largest entry. */
void mt_damped_scale(int n, double *y_re, double *y_im);
/* Allocate the results. */
mt_status mt_damped_claim(mt_damped_modes *out, int n, int count, mt_arena *mem, mt_err *err);
/* Roots and shapes with structural damping (damped_structural.c). */
mt_status mt_damped_structural(const mt_damped_parts *s, mt_damped_modes *out, mt_err *err);

#endif
