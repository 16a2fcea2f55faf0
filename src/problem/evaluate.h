/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_EVALUATE_H
#define PROBLEM_EVALUATE_H

#include "problem/workspace.h"

/*
 * Lays out the rows of c within its bounds with a mode placement below[n_bands of the problem]
 * (NULL: none) and cuts[n_cuts] (drive_positions.h), which must outlive c: those of bands,
 * after all others, where there is a placement, and those of limits. w: set to c afterwards;
 * NULL while the problem is compiled. Fails: MT_E_INPUT where a goal cannot be evaluated over
 * tolerances, MT_E_MEMORY, numerical failures.
 */
mt_status mt_subproblem_lay_out(mt_subproblem *c, const int *below, int n_cuts,
                                const struct mt_cut *cuts, mt_workspace *w, mt_arena *mem,
                                mt_err *err);
/* `from` with a mode placement: mt_subproblem_copy and mt_subproblem_lay_out. */
mt_status mt_subproblem_in_placement(const mt_subproblem *from, const int *below, int n_cuts,
                                     const struct mt_cut *cuts, mt_workspace *w, mt_arena *mem,
                                     mt_subproblem *out, mt_err *err);
/* Reports progress: a design, verified over tolerances and drive positions where required,
 * meets all goals with the value f of the first objective. */
void mt_workspace_judged(const mt_workspace *w, double f);
/* The present stage of the subproblem as a search problem (arrays belong to the subproblem),
 * for mt_workspace_solve. */
mt_nlp mt_workspace_nlp(mt_workspace *w);
/* Callback of the search problem; context is the workspace. Fails: MT_E_INTERRUPTED, and as its
 * parts. */
mt_status mt_workspace_eval(void *context, const double *t, bool with_gradient,
                            mt_nlp_values *out, mt_err *err);
/* The same without counting the evaluation, for callers that count themselves or use
 * mt_workspace_solve. */
mt_status mt_workspace_eval_uncounted(void *context, const double *t, bool with_gradient,
                                      mt_nlp_values *out, mt_err *err);
/* Counts n evaluations of w's subproblem, with their modal solutions. */
void mt_workspace_note_designs(const mt_workspace *w, long n);
/* mt_nlp_solve of an nlp whose callback does not count; counts its evaluations
 * (base/work_counters.h). */
mt_status mt_workspace_solve(const mt_workspace *w, const mt_nlp *nlp,
                             const mt_nlp_options *opt, mt_arena *mem, mt_nlp_result *out,
                             mt_err *err);
/* First half of an evaluation: parameters and expressions at t. mt_configuration_solve follows
 * for each configuration. */
mt_status mt_workspace_place(mt_workspace *w, const double *t, bool with_gradient, mt_err *err);
mt_status mt_configuration_solve(mt_workspace *w, mt_configuration_work *view,
                                 bool with_gradient, mt_err *err);

#endif
