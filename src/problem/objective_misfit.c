/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "misfit": f = 1/2 |r|^2 of the weighted goals' residuals, df/dt = dr^T r. */
#include "problem/objective.h"

static double evaluate_misfit(const mt_workspace *w, const mt_objective_stage *a,
                              double *gradient)
{
    (void)a;
    for (int i = 0; i < w->p->n && gradient != NULL; i++) {
        gradient[i] = mt_dot(w->c->rows.res.n, w->dr + ((ptrdiff_t)i * w->c->rows.res.n), w->r);
    }
    return 0.5 * mt_dot(w->c->rows.res.n, w->r, w->r);
}

const mt_objective_ops mt_objective_misfit = {.value = evaluate_misfit};
