/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "misfit": f = 1/2 |r|^2 of the weighted goals' residuals, df/dt = dr^T r. */
#include "problem/objective.h"

static double value(const mt_problem *p, const mt_aim *a, double *gradient)
{
    (void)a;
    for (int i = 0; i < p->n && gradient != NULL; i++) {
        gradient[i] = mt_dot(p->n_res, p->dr + ((ptrdiff_t)i * p->n_res), p->r);
    }
    return 0.5 * mt_dot(p->n_res, p->r, p->r);
}

const mt_objective_ops mt_objective_misfit = {.value = value};
