/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_REACH_H
#define PROVE_REACH_H

#include "prove/certify.h"

/* The verdict whether limit `limit` of c alone can be met in the box, and the range of its
 * mode's frequency. The range encloses all reachable frequencies; where the enclosure is loose
 * (an input in K and M) it is wider, and branch and bound decides the verdict. A mode that does
 * not exist is IMPOSSIBLE with range NaN. */
typedef struct mt_certify_reach {
    mt_verdict verdict;
    double low_hz;
    double high_hz;
    long boxes;
} mt_certify_reach;
mt_status mt_certify_reach_of(const mt_certify *c, int limit, mt_arena *scratch,
                              mt_certify_reach *out, mt_err *err);
/* *out is true where any limit of c alone is out of reach over the whole box, by these ranges
 * without branch and bound. True is proven. Cost: two eigensolves per view with limits. Fails:
 * MT_E_MEMORY, numerical failures of LAPACK. */
mt_status mt_certify_out_of_reach(const mt_certify *c, mt_arena *scratch, bool *out,
                                  mt_err *err);

#endif
