/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "limit": an expression of parameters; q = its value. */
#include "problem/goal.h"

static mt_status value(mt_problem *p, const mt_demand *d, int pos, double *q, double *slope,
                       mt_err *err)
{
    (void)pos;
    (void)err;
    *q = p->value[d->node];
    for (int k = 0; k < p->n && slope != NULL; k++) {
        slope[k] = mt_problem_stretch(p, k) * p->grad[((ptrdiff_t)d->node * p->n) + k];
    }
    return MT_OK;
}

const mt_goal_ops mt_goal_limit = {
    .quantity = MT_QUANTITY_EXPRESSION, .value = value, .equals = "equal to"};
