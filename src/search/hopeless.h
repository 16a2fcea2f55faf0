/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_HOPELESS_H
#define SEARCH_HOPELESS_H

#include "problem/case.h"

typedef struct mt_hopeless_question {
    const mt_case *c;
    int but;      /* a demand that is left out; -1: none */
    bool bands;   /* those of the case are asked about, too */
    bool counted; /* its multiplications are noted in what the answer spent */
} mt_hopeless_question;

/**
 * Whether no design within the bounds of a case meets its limits, targets and bands, as far as
 * little work can say, before a search of thousands is paid for: the frequencies at the soft
 * and the stiff corner of its enclosures (two eigensolves for each configuration with limits),
 * then some boxes of branch and bound. True is proven; false says nothing (a box that cannot be
 * enclosed, no proof asked for). Tolerances of variables are left out: a design meets the
 * limits itself. Fails: MT_E_MEMORY, numerical failures of LAPACK.
 */
mt_status mt_hopeless(const mt_hopeless_question *q, mt_arena *mem, bool *out, mt_err *err);

#endif
