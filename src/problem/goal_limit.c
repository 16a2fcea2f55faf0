/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "limit": an expression of parameters; q = its value. */
#include "problem/goal.h"

static mt_status evaluate_limit(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                double *slope, mt_err *err)
{
    (void)pos;
    (void)err;
    *q = w->value[d->node];
    for (int k = 0; k < w->p->n && slope != NULL; k++) {
        slope[k] = mt_workspace_dx_dt(w, k) * w->grad[((ptrdiff_t)d->node * w->p->n) + k];
    }
    return MT_OK;
}

const mt_goal_ops mt_goal_limit = {
    .quantity = MT_QUANTITY_EXPRESSION, .value = evaluate_limit, .equals = "equal to"};
