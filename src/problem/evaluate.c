/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One evaluation: parameters, expressions, the modes of every view, every requirement, the
 * objective and those that are held. */

#include "problem/evaluate.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/run.h"
#include "nlp/merit.h"
#include "problem/avoidance.h"
#include "problem/drive_positions.h"
#include "problem/forced_response.h"
#include "problem/objective.h"
#include "problem/subproblem.h"
#include "problem/tolerance.h"
#include "problem/tolerance_cut.h"
#include "problem/workspace.h"

/* Evaluations between two lines of progress: a tenth of a second or so for a small
 * mechanism. */
enum { PROGRESS_EVERY = 500, PROGRESS_TEXT = 80 };

#define OPS(id, name) &mt_rows_##name,
static const mt_row_ops *const OPERATIONS[] = {MT_ROW_KIND_LIST(OPS)};

mt_status mt_subproblem_lay_out(mt_subproblem *c, const int *below, int n_cuts,
                                const mt_cut *cuts, mt_workspace *w, mt_arena *mem, mt_err *err)
{
    const mt_problem *const p = c->p;
    const mt_row_layout l = {.c = c,
                             .below = below,
                             .n_cuts = n_cuts,
                             .cuts = cuts,
                             .known = c->tolerance_box,
                             .mem = mem};
    c->tolerance_box = NULL;
    c->n_t = p->n;
    c->n_views = p->n_views;
    c->views = p->views;
    c->n_requirements = p->n_requirements;
    c->requirements = p->requirements;
    c->rows = (mt_row_table){.next_of = NULL};
    for (int k = 0; k < MT_ROW_KINDS; k++) {
        const int first = c->rows.in.n;
        c->rows.of_kind[k].first = first;
        MT_TRY(OPERATIONS[k]->lay_out != NULL ? OPERATIONS[k]->lay_out(&l, err) : MT_OK);
        c->rows.of_kind[k].n = c->rows.in.n - first;
    }
    mt_row_block *const blocks[] = {&c->rows.res, &c->rows.eq, &c->rows.in, &c->rows.next};
    for (size_t k = 0; k < MT_COUNT(blocks); k++) {
        MT_TRY(mt_rows_finish(blocks[k], 0, mem, err));
    }
    return w != NULL ? mt_workspace_use(w, c, err) : MT_OK;
}

/* Fills the rows of all kinds. */
static mt_status eval_rows(mt_workspace *w, bool with_gradient, mt_nlp_values *out, mt_err *err)
{
    for (int k = 0; k < MT_ROW_KINDS; k++) {
        MT_TRY(OPERATIONS[k]->eval != NULL ? OPERATIONS[k]->eval(w, with_gradient, out, err)
                                           : MT_OK);
    }
    return MT_OK;
}

mt_status mt_subproblem_in_placement(const mt_subproblem *from, const int *below, int n_cuts,
                                     const mt_cut *cuts, mt_workspace *w, mt_arena *mem,
                                     mt_subproblem *out, mt_err *err)
{
    MT_TRY(mt_subproblem_copy(from, mem, out, err));
    return mt_subproblem_lay_out(out, below, n_cuts, cuts, w, mem, err);
}

mt_nlp mt_workspace_nlp(mt_workspace *w)
{
    const mt_subproblem *const c = w->c;
    const mt_nlp nlp = {.n = c->n_t,
                        .lower = c->lower_t,
                        .upper = c->upper_t,
                        .hint = c->hint,
                        .origin = c->origin_t,
                        .change_weight = c->change_weight,
                        .n_res = mt_subproblem_rows_res(c),
                        .n_eq = c->rows.eq.n,
                        .n_in = c->rows.in.n,
                        .eq_tol = c->rows.eq.tol,
                        .in_tol = c->rows.in.tol,
                        .n_next = c->rows.next.n,
                        .next_of = c->rows.next_of,
                        .eval = mt_workspace_eval_uncounted,
                        .context = w,
                        .task_path = w->task_path};
    return nlp;
}

mt_status mt_workspace_place(mt_workspace *w, const double *t, bool with_gradient, mt_err *err)
{
    const mt_problem *const p = w->p;
    memmove(w->t, t, (size_t)w->c->n_t * sizeof *t);
    w->worst = -HUGE_VAL;
    mt_subproblem_x(w->c, t, w->x);
    if (!with_gradient) {
        return mt_program_eval(&p->program, w->x, w->value, NULL, err);
    }
    mt_node bad = MT_NO_NODE;
    mt_err own = {0};
    const mt_status rc = mt_program_gradient(&p->program, w->x, w->value, w->grad, &bad, &own);
    /* a published quantity may have no slope, as a change has none at the original design:
     * nobody needs it */
    return rc == MT_OK || (rc == MT_E_DOMAIN && bad >= p->n_searched)
               ? MT_OK
               : mt_fail(err, rc, "%s", own.text);
}

mt_status mt_configuration_solve(mt_workspace *w, mt_configuration_work *view,
                                 bool with_gradient, mt_err *err)
{
    const mt_analysis_options opt = mt_configuration_queries(w, view, with_gradient);
    view->tracked = false;
    view->solved = false;
    mt_forced_response_close(view);
    MT_TRY(mt_err_in(err, mt_analysis_solve(view->analysis, w->x, &opt, err),
                     "configuration \"%s\"", mt_analysis_configuration(view->analysis)));
    view->solved = true;
    return MT_OK;
}

static void say_progress(const mt_workspace *w)
{
    if (w->progress != NULL && w->evaluations % PROGRESS_EVERY == 0) {
        char text[PROGRESS_TEXT];
        (void)mt_snprintf(text, sizeof text, "searching: more than %ld designs evaluated",
                          w->evaluations);
        w->progress(w->progress_context, text);
    }
}

/* True where a feasible value is verified later over tolerances or positions of a drive, and
 * may still fail. */
static bool judged_later(const mt_workspace *w)
{
    return mt_drive_positions_any(w->p) || mt_tolerance_is_sampled(w->c);
}

/* True where progress of feasible designs is reported and the value can be. */
static bool is_wanted(const mt_workspace *w)
{
    const mt_subproblem *const c = w->c;
    return mt_progress_seeks(w->p->run->progress) && c->n_stages > 0 &&
           c->stages[0].ops->value != NULL;
}

static void report_found(const mt_workspace *w, double f)
{
    const mt_objective_stage *const objective_stage = &w->c->stages[0];
    mt_progress_found(w->p->run->progress, mt_objective_kind_of(objective_stage->type)->name, f,
                      mt_objective_stage_shown(objective_stage, f));
}

void mt_workspace_judged(const mt_workspace *w, double f)
{
    if (is_wanted(w) && judged_later(w)) {
        report_found(w, f);
    }
}

static void say_found(const mt_workspace *w, const mt_nlp_values *v)
{
    const mt_subproblem *const c = w->c;
    mt_progress_evaluated(w->p->run->progress);
    mt_progress_solved(w->p->run->progress, mt_subproblem_solutions(c));
    if (!is_wanted(w) || judged_later(w)) {
        return;
    }
    const mt_missed missed = mt_subproblem_missed(c, v);
    if (mt_is_met(missed.violation, 1.0)) {
        report_found(w, mt_objective_stage_value(w, 0, NULL));
    }
}

void mt_workspace_note_designs(const mt_workspace *w, long n)
{
    mt_work_counters *const spent = w->p->run->work;
    mt_work_counters_note(spent, MT_WORK_DESIGNS, n);
    mt_work_counters_note(spent, MT_WORK_MODAL, n * mt_subproblem_solutions(w->c));
}

mt_status mt_workspace_eval(void *context, const double *t, bool with_gradient,
                            mt_nlp_values *out, mt_err *err)
{
    const mt_workspace *const w = context;
    mt_workspace_note_designs(w, 1);
    return mt_workspace_eval_uncounted(context, t, with_gradient, out, err);
}

mt_status mt_workspace_solve(const mt_workspace *w, const mt_nlp *nlp,
                             const mt_nlp_options *opt, mt_arena *mem, mt_nlp_result *out,
                             mt_err *err)
{
    const mt_status rc = mt_nlp_solve(nlp, opt, mem, out, err);
    mt_workspace_note_designs(w, out->evals);
    return rc;
}

mt_status mt_workspace_eval_uncounted(void *context, const double *t, bool with_gradient,
                                      mt_nlp_values *out, mt_err *err)
{
    mt_workspace *const w = context;
    const mt_problem *const p = w->p;
    MT_TRY(mt_interrupt_check(p->run->interrupt, err));
    w->evaluations++;
    say_progress(w);
    MT_TRY(mt_workspace_place(w, t, with_gradient, err));
    for (int i = 0; i < w->c->n_views; i++) {
        MT_TRY(mt_configuration_solve(w, &w->views[i], with_gradient, err));
    }
    MT_TRY(mt_tolerance_solve(w, with_gradient, err));
    MT_TRY(eval_rows(w, with_gradient, out, err));
    if (mt_subproblem_rows_res(w->c) > 0) {
        const size_t n_res = (size_t)w->c->rows.res.n;
        memcpy(out->r, w->r, n_res * sizeof *w->r);
        if (with_gradient) {
            memcpy(out->dr, w->dr, n_res * (size_t)p->n * sizeof *w->dr);
        }
    }
    out->f = mt_objective_stage_value(w, w->c->stage, with_gradient ? out->df : NULL);
    say_found(w, out);
    return MT_OK;
}
