/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_DAMPING_PRIV_H
#define ANALYSIS_DAMPING_PRIV_H

#include "analysis/damping.h"

/* Damping at the last solve (a->damping), shared by the files damping*.c; in damping_mem. Made
 * by mt_analysis_damping. */
struct mt_damping_work {
    int n;
    int r;          /* modes; 0 without ratios */
    double *zeta;   /* [r] */
    mt_node *ratio; /* [r] node of zeta; MT_NO_NODE: 0 */
    double *omega;  /* [r] of modes with a ratio; otherwise 0 */
    double *f;      /* [r] 2 zeta omega */
    double *n_phi;  /* n x r: M Phi */
    double *c;      /* n x n */
    double *h;      /* n x n; NULL: 0 */
    bool solved;    /* `damped` is valid */
    mt_damped_modes damped;
};

#endif
