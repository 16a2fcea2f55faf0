/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_DAMPING_PRIV_H
#define ANALYSIS_DAMPING_PRIV_H

#include "analysis/damping.h"

/* What the files damping*.c know of the damping at the last solve (a->damping); in damping_mem.
 * mt_analysis_damping makes it. */
struct mt_damping_work {
    int n;
    int r;          /* modes; 0 without ratios */
    double *zeta;   /* [r] */
    mt_node *ratio; /* [r] its node; MT_NO_NODE: 0 */
    double *omega;  /* [r] of those that have a ratio; else 0 */
    double *f;      /* [r] 2 zeta omega */
    double *n_phi;  /* n x r: M Phi */
    double *c;      /* n x n */
    double *h;      /* n x n; NULL: 0 */
    bool solved;    /* there are complex modes */
    mt_damped_modes damped;
};

#endif
