/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_INFEASIBLE_PRESOLVE_H
#define SEARCH_INFEASIBLE_PRESOLVE_H

#include "problem/subproblem.h"

typedef struct mt_infeasible_presolve_question {
    const mt_subproblem *c;
    int but;      /* a requirement that is left out; -1: none */
    bool bands;   /* those of the case are asked about, too */
    bool counted; /* its multiplications are noted in what the answer spent */
    double most;  /* work of branch and bound; 0: a little */
    /* of branch and bound where it proves it, as it is where that need not be asked; NULL */
    long *boxes;
} mt_infeasible_presolve_question;

/**
 * Whether no design within the bounds of a case meets its limits, targets and bands, as far as
 * little work can say, before a search of thousands is paid for: the frequencies at the soft
 * and the stiff corner of its enclosures (two eigensolves for each configuration with limits),
 * then some boxes of branch and bound. True is proven; false says nothing (a box that cannot be
 * enclosed, no proof asked for). Tolerances of variables are left out: a design meets the
 * limits itself. Fails: MT_E_MEMORY, numerical failures of LAPACK.
 */
mt_status mt_infeasible_presolve(const mt_infeasible_presolve_question *q, mt_arena *mem,
                                 bool *out, mt_err *err);

#endif
