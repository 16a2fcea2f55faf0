/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An expression of parameters: f = its value. */
#include "problem/objective.h"

static mt_status compile_expression_objective(mt_problem *p, mt_objective_stage *a,
                                              const mt_node *nodes, mt_err *err)
{
    (void)err;
    a->node =
        mt_program_expr(&p->program, &a->objective->expression, nodes, a->objective->addr);
    return MT_OK; /* the program tells when it is finished */
}

static double evaluate_expression_objective(const mt_workspace *w, const mt_objective_stage *a,
                                            double *gradient)
{
    for (int i = 0; i < w->p->n && gradient != NULL; i++) {
        gradient[i] = mt_workspace_dx_dt(w, i) * w->grad[((ptrdiff_t)a->node * w->p->n) + i];
    }
    return w->value[a->node];
}

static double least(const mt_problem *p, const mt_objective_stage *a, const double *lo,
                    const double *hi, double *low, double *high)
{
    mt_program_interval(&p->program, lo, hi, low, high);
    return low[a->node];
}

static const char *expression_price(const mt_price *q, mt_arena *mem)
{
    return mt_arena_printf(mem, "the objective by %.3g", q->df);
}

const mt_objective_ops mt_objective_expression = {.compile = compile_expression_objective,
                                                  .value = evaluate_expression_objective,
                                                  .least = least,
                                                  .price = expression_price};
