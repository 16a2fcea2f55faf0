/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_PROOF_H
#define SEARCH_PROOF_H

#include "problem/workspace.h"
#include "prove/certify.h"

/*
 * A case of a problem as a question for certificates: an enclosure of every view, the bands of
 * its clears, the limits and targets of its frequency goals, the limits on expressions. Goals
 * that no certificate covers (shapes, MAC, modes by name) are left out, which keeps every
 * "impossible" true.
 */
typedef struct mt_proof {
    mt_certify question;
    mt_enclosure **views;   /* [n_views] owned */
    mt_certify_band *bands; /* with margin; those of problem->clears in their order */
    mt_certify_band *bases; /* without */
    mt_certify_limit *limits;
    int *limit_requirement; /* [n_limits] which requirement */
    mt_certify_bound *bounds;
    double *lower; /* [n] parameter values */
    double *upper;
    /* every goal but weighted ones is in the question: what it says is possible is */
    bool covers;
    char reason[MT_REASON_SIZE]; /* why there is no certificate; empty: there can be */
    bool possible;
    double left;                    /* of its budget, in multiplications */
    struct mt_work_counters *spent; /* where its work is noted; NULL */
} mt_proof;

/* shapes[n] in mem: which variables shape the geometry of any view, and are not held by the
 * case; how many. Fails: MT_E_MEMORY. */
mt_status mt_proof_shaping(const mt_subproblem *c, mt_arena *mem, bool **shapes, int *count,
                           mt_err *err);
/* Results in mem but the enclosures, which mt_proof_free gives back. `possible` false, with the
 * reason, is a success. */
mt_status mt_proof_init(mt_proof *proof, const mt_subproblem *c, mt_arena *mem, mt_err *err);
/* mt_certify_assignments of the question with `most` of what is left of the budget at most: all
 * that is asked of one proof has it together. Where nothing is left one box is looked at. */
mt_status mt_proof_query(mt_proof *proof, double most, mt_arena *mem, mt_certify_search *out,
                         mt_err *err);
/* Accepts a zeroed proof. */
void mt_proof_free(mt_proof *proof);
/* Variables with a catalogue take values of it only, instead of all between its ends. Arrays in
 * mem. */
mt_status mt_proof_use_catalogues(mt_proof *proof, const mt_problem *p, mt_arena *mem,
                                  mt_err *err);

/* proof_cap.c: the first objective as a cap for certificates. Where it is not known (a misfit,
 * a clearance) there is none. p must outlive it. */
typedef struct mt_proof_cap {
    const mt_problem *p;
    bool known;
    double *low; /* work */
    double *high;
    mt_certify_cap cap; /* `below` is the caller's */
} mt_proof_cap;
mt_status mt_proof_cap_init(mt_proof_cap *c, const mt_problem *p, mt_arena *mem, mt_err *err);

#endif
