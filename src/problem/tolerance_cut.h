/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_TOLERANCE_CUT_H
#define PROBLEM_TOLERANCE_CUT_H

#include "nlp/merit.h"
#include "problem/tolerance.h"

/*
 * Verification of a design over its own tolerances where the corners in the search are samples
 * (tolerance.h). A point worse than the corners becomes a further corner: in the same
 * proportion it is within the tolerances of every design, so all designs must satisfy it. It is
 * a cutting plane of the search.
 */
typedef struct mt_tolerance_cut {
    int view;        /* configuration of the corner; -1: of the limit of */
    int requirement; /* this requirement */
    bool may[MT_TOLERANCE_SIDES];
    const double *factor; /* [n] */
} mt_tolerance_cut;

/* List of cuts, extended by verification. */
typedef struct mt_tolerance_cuts {
    int n;
    int room;
    mt_tolerance_cut *items;
    /* the search has no other sampled corners than these, except those of targets' ranges */
    bool alone;
    /* of the last design verified */
    int added;
    /* violations at the worst points within its tolerances, of sampled limits only */
    mt_missed missed;
    double band_margin; /* least margin of the bands; HUGE_VAL: none is sampled */
    long solutions;     /* modal solutions besides its evaluation */
} mt_tolerance_cuts;

/*
 * Verifies the design t[c->n_t] and adds points worse than the subproblem's corners and the
 * cuts so far: cuts->added of them; lists in mem. w: set to the subproblem. Where the corner by
 * the slopes violates a row, that is enough to continue the search; a goal that holds there is
 * verified over all of its tolerances, except in configurations far from their limits. Cost: an
 * analysis for each limited mode, then as mt_tolerance_ranges. Fails: MT_E_MEMORY,
 * MT_E_INTERNAL, MT_E_INTERRUPTED, as an evaluation.
 */
mt_status mt_tolerance_verify(mt_workspace *w, const double *t, mt_arena *mem,
                              mt_tolerance_cuts *cuts, mt_err *err);
/* The same at the corners by the slopes alone, for a design from which the search continues in
 * any case. Cost: an analysis for each limited mode. */
mt_status mt_tolerance_verify_by_slopes(mt_workspace *w, const double *t, mt_arena *mem,
                                        mt_tolerance_cuts *cuts, mt_err *err);
/* mt_tolerance_verify for the design that w was evaluated at; lowers its sampled rows v->in to
 * those of the worst points. No effect where nothing is sampled. */
mt_status mt_tolerance_lower(mt_workspace *w, mt_nlp_values *v, mt_arena *mem,
                             mt_tolerance_cuts *cuts, mt_err *err);
/* *out: corners of a subproblem and the cuts, or the cuts alone, in mem, as the tolerance_box
 * of a copy of it before mt_subproblem_lay_out. Fails: MT_E_MEMORY. */
mt_status mt_tolerance_add_cuts(const mt_subproblem *c, const mt_tolerance_cuts *cuts,
                                mt_arena *mem, mt_problem_tolerance_box **out, mt_err *err);

#endif
