/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_PROOF_H
#define SEARCH_PROOF_H

#include "problem/workspace.h"
#include "prove/certify.h"

/*
 * A subproblem as a question for proofs: an enclosure of every configuration, its bands, the
 * limits and targets of its frequency goals, and the limits on expressions. Goals that no proof
 * covers (shapes, MAC, modes by name) are left out, so that "impossible" remains true.
 */
typedef struct mt_proof {
    mt_certify question;
    mt_enclosure **views;   /* [n_views] owned */
    mt_certify_band *bands; /* with margin, in the order of the problem's avoidance goals */
    mt_certify_band *bases; /* without margin */
    mt_certify_limit *limits;
    int *limit_requirement; /* [n_limits] index of the requirement */
    mt_certify_bound *bounds;
    double *lower; /* [n] parameter values */
    double *upper;
    /* every goal but weighted ones is included: "possible" is then true as well */
    bool covers;
    char reason[MT_REASON_SIZE]; /* why no proof is possible; empty: possible */
    bool possible;
    double left;                    /* remaining budget, in multiplications */
    struct mt_work_counters *spent; /* counters of its work; may be NULL */
} mt_proof;

/* shapes[n] in mem: variables that shape the geometry of a configuration and are not fixed by
 * the subproblem; *count: their number. Fails: MT_E_MEMORY. */
mt_status mt_proof_shaping(const mt_subproblem *c, mt_arena *mem, bool **shapes, int *count,
                           mt_err *err);
/* Results in mem, except the enclosures, which mt_proof_free releases. `possible` false, with
 * the reason, is a success. */
mt_status mt_proof_init(mt_proof *proof, const mt_subproblem *c, mt_arena *mem, mt_err *err);
/* mt_certify_assignments of the question with at most `most` of the remaining budget, which all
 * queries of one proof share. Without any one box is examined. */
mt_status mt_proof_query(mt_proof *proof, double most, mt_arena *mem, mt_certify_search *out,
                         mt_err *err);
/* Accepts a zeroed proof. */
void mt_proof_free(mt_proof *proof);
/* Restrict variables with a catalogue to its values instead of the interval it spans. Arrays in
 * mem. */
mt_status mt_proof_use_catalogues(mt_proof *proof, const mt_problem *p, mt_arena *mem,
                                  mt_err *err);

/* proof_cap.c: the first objective as a cap for proofs; `known` false where it has no bounds (a
 * misfit, a clearance). p must outlive it. */
typedef struct mt_proof_cap {
    const mt_problem *p;
    bool known;
    double *low; /* work */
    double *high;
    mt_certify_cap cap; /* `below` is set by the caller */
} mt_proof_cap;
mt_status mt_proof_cap_init(mt_proof_cap *c, const mt_problem *p, mt_arena *mem, mt_err *err);

#endif
