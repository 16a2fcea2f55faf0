/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_REACH_H
#define PROVE_REACH_H

#include "prove/certify.h"

/* Of limit `limit` of c alone: whether it can be met in the box, and what its mode's frequency
 * can be there. The range encloses all that can be reached; where the enclosure is loose (an
 * input in K and M) it is wider than what is reached, and branch and bound decides the verdict.
 * A mode that does not exist is IMPOSSIBLE, its range NaN. */
typedef struct mt_certify_reach {
    mt_verdict verdict;
    double low_hz;
    double high_hz;
    long boxes;
} mt_certify_reach;
mt_status mt_certify_reach_of(const mt_certify *c, int limit, mt_arena *scratch,
                              mt_certify_reach *out, mt_err *err);
/* *out: whether any limit of c alone is out of reach of its whole box, by such ranges without
 * branch and bound. True is proven. Cost: two eigensolves for each view that has limits. Fails:
 * MT_E_MEMORY, numerical failures of LAPACK. */
mt_status mt_certify_out_of_reach(const mt_certify *c, mt_arena *scratch, bool *out,
                                  mt_err *err);

#endif
