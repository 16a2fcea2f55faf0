/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One evaluation: parameters, expressions, the modes of every view, every demand, the objective
 * and those that are held. */
#include <string.h>

#include "base/format.h"
#include "base/interrupt.h"
#include "problem/problem.h"
#include "problem/robust.h"

/* Evaluations between two lines of progress: a tenth of a second or so for a small
 * mechanism. */
enum { PROGRESS_EVERY = 500, PROGRESS_TEXT = 80 };

mt_status mt_problem_place(mt_problem *p, const double *t, bool with_gradient, mt_err *err)
{
    memmove(p->t, t, (size_t)p->n_t * sizeof *t);
    mt_problem_x(p, t, p->x);
    if (!with_gradient) {
        return mt_program_eval(&p->program, p->x, p->value, NULL, err);
    }
    mt_node bad = MT_NO_NODE;
    mt_err own = {0};
    const mt_status rc = mt_program_gradient(&p->program, p->x, p->value, p->grad, &bad, &own);
    /* a published quantity may have no slope, as a change has none at the original design:
     * nobody needs it */
    return rc == MT_OK || (rc == MT_E_DOMAIN && bad >= p->n_searched)
               ? MT_OK
               : mt_fail(err, rc, "%s", own.text);
}

mt_status mt_view_solve(mt_problem *p, mt_view *view, bool with_gradient, mt_err *err)
{
    const mt_analysis_options opt = {.gradient = with_gradient,
                                     .vectors = with_gradient || view->needs_vectors,
                                     .accuracy = true,
                                     .check = false};
    view->tracked = false;
    view->solved = false;
    MT_TRY(mt_err_in(err, mt_analysis_solve(view->analysis, p->x, &opt, err),
                     "configuration \"%s\"", mt_analysis_configuration(view->analysis)));
    view->solved = true;
    return MT_OK;
}

static void say_progress(const mt_problem *p)
{
    if (p->progress != NULL && p->evaluations % PROGRESS_EVERY == 0) {
        char text[PROGRESS_TEXT];
        (void)mt_snprintf(text, sizeof text, "searching: more than %ld designs evaluated",
                          p->evaluations);
        p->progress(p->progress_context, text);
    }
}

mt_status mt_problem_eval(void *context, const double *t, bool with_gradient,
                          mt_nlp_values *out, mt_err *err)
{
    mt_problem *const p = context;
    MT_TRY(mt_interrupt_check(p->study->model->interrupt, err));
    p->evaluations++;
    say_progress(p);
    MT_TRY(mt_problem_place(p, t, with_gradient, err));
    for (int i = 0; i < p->n_views; i++) {
        MT_TRY(mt_view_solve(p, &p->views[i], with_gradient, err));
    }
    MT_TRY(mt_robust_solve(p, with_gradient, err));
    for (int i = 0; i < p->n_demands; i++) {
        MT_TRY(mt_err_in(err, mt_demand_eval(p, &p->demands[i], with_gradient, out, NULL, err),
                         "/goals/%d", p->demands[i].goal_index));
    }
    MT_TRY(mt_clear_eval(p, t, with_gradient, out, err));
    MT_TRY(mt_robust_rows(p, t, with_gradient, out, err));
    MT_TRY(mt_next_eval(p, with_gradient, out, err));
    if (mt_objective_is(p->aims[p->stage].type, MT_RESIDUALS)) {
        memcpy(out->r, p->r, (size_t)p->n_res * sizeof *p->r);
        if (with_gradient) {
            memcpy(out->dr, p->dr, (size_t)p->n_res * (size_t)p->n * sizeof *p->dr);
        }
    }
    out->f = mt_aim_value(p, p->stage, with_gradient ? out->df : NULL);
    mt_aim_hold_rows(p, with_gradient, out);
    return MT_OK;
}
