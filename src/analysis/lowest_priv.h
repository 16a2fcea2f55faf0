/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_LOWEST_PRIV_H
#define ANALYSIS_LOWEST_PRIV_H

#include "analysis/lowest.h"

/* Work arrays of the tree method. */
struct mt_lowest_operation {
    const mt_tree *tree;
    bool told;     /* progress is reported */
    double *v;     /* motion of all bodies */
    double *f;     /* work */
    double *r;     /* [n_rigid] */
    double *along; /* [n_rigid] rigid-body motion that follows x */
    double *left;  /* [n_rigid] work */
    double *m_yr;  /* n_x x n_rigid */
    double *m_rr;  /* its Cholesky factor */
    mt_arena *scratch;
};

/* r[n_rigid] := M_rr^-1 r. */
void mt_lowest_solve_free(const struct mt_lowest_operation *o);

#endif
