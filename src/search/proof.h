/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_PROOF_H
#define SEARCH_PROOF_H

#include "problem/subproblem.h"
#include "problem/workspace.h"
#include "prove/certify.h"

/*
 * A subproblem as a question for proofs: an enclosure of every configuration, its bands, the
 * limits and targets of its frequency goals and of ratios and distances of frequencies, and the
 * limits on expressions. Goals that no proof
 * covers (shapes, MAC, modes by name) are left out, so that "impossible" remains true.
 */
typedef struct mt_proof {
    mt_certify question;
    mt_enclosure **views;   /* [n_views] owned */
    mt_certify_band *bands; /* with margin, in the order of the problem's avoidance goals */
    mt_certify_band *bases; /* without margin */
    mt_certify_limit *limits;
    int *limit_requirement; /* [n_limits] index of the requirement */
    mt_certify_pair *pairs;
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

/* The first objective as a cap for proofs; `known` false where it has no bounds (a
 * misfit, a clearance). p must outlive it. */
typedef struct mt_proof_cap {
    const mt_problem *p;
    bool known;
    double *low; /* work */
    double *high;
    mt_certify_cap cap; /* `below` is set by the caller */
} mt_proof_cap;
mt_status mt_proof_cap_init(mt_proof_cap *c, const mt_problem *p, mt_arena *mem, mt_err *err);

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

/*
 * Mode placements at sampled geometries. Modes cannot be enclosed over variables that shape the
 * geometry, but with these fixed they can over the others (prove/enclosure.h). At each sample
 * of the former, the placements that the others allow, with the limits, are proven, each with a
 * design. This finds placements that are feasible only in a narrow range of the other
 * variables, which samples over all variables miss. Nothing is known between the samples.
 */
typedef struct mt_sampled_bounds {
    /* samples of the geometry; 0: no variable shapes it, or enclosures are not possible for
     * another reason */
    int n;
    int n_settled; /* samples at which every unlisted placement is proven infeasible */
    int n_found;
    int *found; /* [n_found x n_bands] */
    double *at; /* [n_found x n] design t with that placement */
} mt_sampled_bounds;

/* Search w's subproblem with its proof_work at most. Results in mem. Fails: MT_E_MEMORY,
 * MT_E_INTERNAL, numerical failures of LAPACK. */
mt_status mt_sampled_bounds_search(mt_workspace *w, mt_arena *mem, mt_sampled_bounds *out,
                                   mt_err *err);

#endif
