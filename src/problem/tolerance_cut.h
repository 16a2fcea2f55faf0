/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_TOLERANCE_CUT_H
#define PROBLEM_TOLERANCE_CUT_H

#include "nlp/merit.h"
#include "problem/tolerance.h"

/*
 * A design over its own tolerances, where the corners that a search holds are samples
 * (tolerance.h): where something within them is worse, that point is one more corner. In the
 * same proportion it lies within the tolerances of every design, and all have to keep it: a
 * cutting plane of the search.
 */
typedef struct mt_tolerance_cut {
    int view;        /* whose corner it is; -1: of a limit, that of */
    int requirement; /* this */
    bool may[MT_TOLERANCE_SIDES];
    const double *factor; /* [n] */
} mt_tolerance_cut;

/* Grown by who judges. */
typedef struct mt_tolerance_cuts {
    int n;
    int room;
    mt_tolerance_cut *items;
    /* of the last design judged */
    int added;
    mt_missed missed; /* by the worst within its tolerances, of what is held at samples alone */
    double band_margin; /* least of the bands; HUGE_VAL: none is held so */
    long solutions;     /* modal, beside its evaluation */
} mt_tolerance_cuts;

/* Whether anything that the case holds is judged at samples. */
bool mt_tolerance_is_sampled(const mt_subproblem *c);
/*
 * Judge the design at t[c->n_t], and add what is worse there than the corners of the case and
 * the cuts so far: cuts->added of them; lists in mem. w: set to the case. Where the corner that
 * its slopes name misses a row, that is enough to go on with; what meets a goal there is judged
 * over all of its tolerances, but for views whose limits are far from there. Cost: an analysis
 * for each mode that is limited, then as mt_tolerance_ranges. Fails: MT_E_MEMORY,
 * MT_E_INTERNAL, MT_E_INTERRUPTED, as an evaluation.
 */
mt_status mt_tolerance_verify(mt_workspace *w, const double *t, mt_arena *mem,
                              mt_tolerance_cuts *cuts, mt_err *err);
/* The same of the design that w was evaluated at, whose rows at samples become those of the
 * worst within: v->in is lowered. Nothing where nothing is sampled. */
mt_status mt_tolerance_lower(mt_workspace *w, mt_nlp_values *v, mt_arena *mem,
                             mt_tolerance_cuts *cuts, mt_err *err);
/* The corners of a case with the cuts beside them, for mt_subproblem_lay_out of a copy of it
 * (as its `robust`), in mem. Fails: MT_E_MEMORY. */
mt_status mt_tolerance_add_cuts(const mt_subproblem *c, const mt_tolerance_cuts *cuts,
                                mt_arena *mem, mt_problem_tolerance_box **out, mt_err *err);

#endif
