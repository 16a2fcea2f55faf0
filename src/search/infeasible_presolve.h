/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_INFEASIBLE_PRESOLVE_H
#define SEARCH_INFEASIBLE_PRESOLVE_H

#include "problem/subproblem.h"

typedef struct mt_infeasible_presolve_question {
    const mt_subproblem *c;
    int but;      /* a requirement left out; -1: none */
    bool bands;   /* include the bands of the subproblem */
    bool counted; /* count its multiplications in the answer's work */
    double most;  /* work of branch and bound; 0: a small default */
    /* boxes of branch and bound where those gave the proof; NULL: not wanted */
    long *boxes;
} mt_infeasible_presolve_question;

/**
 * *out: proven that no design within the bounds of a subproblem meets its limits, targets and
 * bands; a cheap test before a search of thousands of evaluations. Method: frequencies at the
 * soft and the stiff corner of its enclosures (two eigensolves for each configuration with
 * limits), then a few boxes of branch and bound. False proves nothing (a box that cannot be
 * enclosed, no proof requested). Tolerances of variables are ignored: the nominal design meets
 * the limits. Fails: MT_E_MEMORY, numerical failures of LAPACK.
 */
mt_status mt_infeasible_presolve(const mt_infeasible_presolve_question *q, mt_arena *mem,
                                 bool *out, mt_err *err);

#endif
