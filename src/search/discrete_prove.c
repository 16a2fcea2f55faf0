/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Branch and bound over catalogues, with continuous variables beside them or not. A box holds
 * values of each catalogue from one to another, and its enclosure is that of the interval
 * between them, so whatever is excluded is excluded for every combination in it; halving leaves
 * the gaps between values out, and a box of single values is a combination. First: which gap
 * assignments can be met; their designs are judged like any other combination. Then, with the
 * objective of the best as a cap: is there a better one? What is found moves the cap, until
 * nothing is left, which proves the best to be the best, or an effort is spent.
 */
#include <math.h>
#include <string.h>

#include "problem/family.h"
#include "search/discrete.h"
#include "search/gaps.h"
#include "search/proof.h"

enum { ROUNDS = 40 /* of a better design found and the cap moved */ };
/* What one question may take of the budget of all. */
static const double PART = 0.2;
/* Objectives that differ by less are equal: as they are ranked (discrete_judge.c), and more
 * than intervals lose. */
static const double EQUAL = 1e-9;
/* With continuous variables what is proven is that no design is better by more than this, or
 * else by more than the second. */
static const double WITHIN[] = {1e-2, 1e-1};

typedef struct prover {
    mt_discrete *d;
    mt_discrete_report *report;
    mt_proof proof;
    mt_proof_cap cap;
    mt_combination **all;
    int n;
    int capacity;
} prover;

/* The best so far, over its range of motion too; NULL: none is feasible. */
static mt_status best_of(const prover *v, const mt_combination **out, mt_err *err)
{
    mt_combination *best = NULL;
    do {
        best = NULL;
        for (int i = 0; i < v->n; i++) {
            mt_combination *const c = v->all[i];
            if (c->judged && c->feasible &&
                (best == NULL || mt_discrete_before(v->d, c, best))) {
                best = c;
            }
        }
        if (best != NULL) {
            MT_TRY(mt_discrete_follow(v->d, best, err));
        }
    } while (best != NULL && !best->feasible);
    *out = best;
    return MT_OK;
}

/* The combination of x, which joins the list where it is not in it. */
static mt_status combination_at(prover *v, const double *x, mt_combination **out, mt_err *err)
{
    mt_discrete *const d = v->d;
    mt_combination *c = NULL;
    MT_TRY(mt_discrete_alloc(d, 1, &c, err));
    for (int k = 0; k < d->n_discrete; k++) {
        const mt_variable *const own = &d->p->study->variables[d->variable[k]];
        while (c->pick[k] + 1 < own->n_catalogue &&
               own->catalogue[c->pick[k]] < x[d->variable[k]]) {
            c->pick[k]++;
        }
    }
    const size_t size = (size_t)d->n_discrete * sizeof *c->pick;
    for (int i = 0; i < v->n; i++) {
        if (memcmp(v->all[i]->pick, c->pick, size) == 0) {
            *out = v->all[i];
            return MT_OK;
        }
    }
    mt_combination **const grown =
        mt_arena_grow(d->mem, v->all, v->n, &v->capacity, sizeof(mt_combination *));
    MT_TRY(mt_arena_check(d->mem, err));
    mt_discrete_set(d, c);
    v->all = grown;
    v->all[v->n++] = c;
    *out = c;
    return MT_OK;
}

/* Judge the combination of a design that meets the question: on its own, or searched from
 * there. */
static mt_status judge(prover *v, const double *x, mt_err *err)
{
    mt_discrete *const d = v->d;
    mt_combination *c = NULL;
    const long most = d->c->search.max_evaluations;
    const long left = most - d->evals;
    MT_TRY(combination_at(v, x, &c, err));
    if (c == NULL) {
        return mt_fail_memory(err);
    }
    if (c->judged && (c->feasible || !d->mixed)) {
        return MT_OK;
    }
    if (most > 0 && left <= 0) {
        d->stop = d->stop == MT_STOP_USER ? MT_STOP_USER : MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    double *const from = mt_arena_f64(d->mem, (size_t)d->p->n + 1, 1);
    MT_TRY(mt_arena_check(d->mem, err));
    for (int i = 0; i < d->p->n; i++) {
        from[i] = mt_problem_t(d->p, i, x[i]);
    }
    c->from = from;
    return mt_discrete_judge(d, 1, c, most > 0 ? left : 0, err);
}

/* Ask, and judge what is found. */
static mt_status ask(prover *v, mt_certify_search *found, mt_err *err)
{
    MT_TRY(mt_proof_ask(&v->proof, PART * v->d->c->proof_work, v->d->mem, found, err));
    v->report->boxes += found->boxes;
    for (int k = 0; k < found->n_found && v->d->stop != MT_STOP_USER; k++) {
        MT_TRY(judge(v, found->at + ((ptrdiff_t)k * v->d->p->n), err));
    }
    return MT_OK;
}

/* Below this value of the first objective a design is better than f by more than the share. */
static double cap_of(const mt_problem *p, double f, double share)
{
    /* f is half the square of the change */
    const bool squares = mt_objective_is(p->aims[0].type, MT_HALF_SQUARE);
    return squares ? f * (1.0 - share) * (1.0 - share) : f - (share * fabs(f));
}

/* Is the best the best, but for a share of its objective? */
static mt_status improve(prover *v, double share, mt_err *err)
{
    for (int round = 0; round < ROUNDS; round++) {
        const mt_combination *best = NULL;
        MT_TRY(best_of(v, &best, err));
        if (best == NULL) { /* interrupted on the way from position to position */
            return MT_OK;
        }
        const double f = best->f[0];
        mt_certify_search found = {0};
        v->cap.cap.below = cap_of(v->d->p, f, share);
        v->proof.question.cap = &v->cap.cap;
        MT_TRY(ask(v, &found, err));
        if (found.proven && found.n_found == 0) {
            v->report->best_within = share;
            return MT_OK;
        }
        v->report->cut = v->report->cut || (!found.proven && !found.stopped);
        MT_TRY(best_of(v, &best, err));
        if (best == NULL || !(best->f[0] < f) || v->d->stop == MT_STOP_USER) {
            return MT_OK;
        }
    }
    return MT_OK;
}

static mt_status prove(prover *v, mt_err *err)
{
    mt_discrete *const d = v->d;
    mt_discrete_report *const report = v->report;
    mt_certify_search found = {0};
    MT_TRY(mt_proof_use_catalogues(&v->proof, d->p, d->mem, err));
    MT_TRY(mt_proof_cap_init(&v->cap, d->p, d->mem, err));
    MT_TRY(ask(v, &found, err));
    const mt_combination *best = NULL;
    MT_TRY(best_of(v, &best, err));
    report->complete = v->proof.covers && !mt_family_any(d->p);
    report->n_possible = mt_gap_count_possible(d->p);
    report->n_kinds = found.n_found;
    report->settled = found.proven && (found.n_found > 0 || best == NULL);
    if (best == NULL || !v->cap.known) {
        return MT_OK;
    }
    MT_TRY(improve(v, d->mixed ? WITHIN[0] : EQUAL, err));
    if (d->mixed && isnan(report->best_within) && d->stop != MT_STOP_USER) {
        MT_TRY(improve(v, WITHIN[1], err));
    }
    return MT_OK;
}

mt_status mt_discrete_prove(mt_discrete *d, mt_combination ***all, int *n,
                            mt_discrete_report *report, mt_err *err)
{
    prover v = {.d = d, .report = report, .all = *all, .n = *n, .capacity = *n};
    report->asked = true;
    mt_status rc = mt_proof_init(&v.proof, d->c, d->mem, err);
    if (rc == MT_OK && v.proof.possible) {
        rc = prove(&v, err);
    } else if (rc == MT_OK) {
        report->reason = mt_arena_strdup(d->mem, v.proof.reason);
        rc = mt_arena_check(d->mem, err);
    }
    mt_proof_free(&v.proof);
    *all = v.all;
    *n = v.n;
    return rc;
}
