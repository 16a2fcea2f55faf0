/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Branch and bound over catalogues, with continuous variables beside them or not. A box holds
 * values of each catalogue from one to another, and its enclosure is that of the interval
 * between them, so whatever is excluded is excluded for every combination in it; halving leaves
 * the gaps between values out, and a box of single values is a combination. First: which gap
 * assignments can be met; their designs are judged like any other combination. Then, with the
 * objective of the best as a cap: whether there is a better one. What is found moves the cap,
 * until nothing is left, which proves the best to be the best, or an effort is spent. Where
 * catalogues shape the geometry each of their combinations is asked by itself, if they are not
 * too many.
 */
#include <math.h>
#include <string.h>

#include "problem/drive_positions.h"
#include "search/catalogue_search.h"
#include "search/catalogue_search_proofs.h"
#include "search/mode_placements.h"

enum {
    ROUNDS = 40, /* of a better design found and the cap moved */
    GEOMETRIES_MOST = 64
};
/* What one question may take of the budget of all. */
static const double PART = 0.2;
/* Objectives that differ by less are equal: as they are ranked (catalogue_search_verify.c), and
 * more than intervals lose. */
static const double EQUAL = 1e-9;
/* With continuous variables what is proven is that no design is better by more than this, or
 * else by more than the second. */
static const double WITHIN[] = {1e-2, 1e-1};

/* What all geometries say. */
typedef struct outcome {
    bool proven;
    bool stopped;
    int n_found;
} outcome;

typedef struct prover {
    mt_catalogue_search *d;
    mt_catalogue_search_report *report;
    mt_catalogue_search_proofs proofs;
    int n_geometries;
    double *lower; /* [n] of one of them */
    double *upper;
    double left; /* of the budget, in multiplications */
    mt_proof_cap cap;
    bool capped; /* only better designs are asked for */
    bool covers; /* no goal is left out of the question */
    int n_kinds; /* gap assignments that were found */
    int *kinds;  /* [n_kinds x n_bands] */
    int cap_kinds;
    mt_combination **all;
    int n;
    int capacity;
} prover;

/* The best so far, over its range of motion too; NULL: none is feasible. */
static mt_status find_best_combination(const prover *v, const mt_combination **out, mt_err *err)
{
    mt_combination *best = NULL;
    do {
        best = NULL;
        for (int i = 0; i < v->n; i++) {
            mt_combination *const c = v->all[i];
            if (c->judged && c->feasible &&
                (best == NULL || mt_catalogue_search_before(v->d, c, best))) {
                best = c;
            }
        }
        if (best != NULL) {
            MT_TRY(mt_catalogue_search_follow(v->d, best, err));
        }
    } while (best != NULL && !best->feasible);
    *out = best;
    return MT_OK;
}

/* The combination of x; appended to the list where it is not in it. */
static mt_status combination_at(prover *v, const double *x, mt_combination **out, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    mt_combination *c = NULL;
    MT_TRY(mt_catalogue_search_alloc(d, 1, &c, err));
    for (int k = 0; k < d->n_listed; k++) {
        const mt_variable *const own = &d->p->study->variables[d->variable[k]];
        while (c->pick[k] + 1 < own->n_catalogue &&
               own->catalogue[c->pick[k]] < x[d->variable[k]]) {
            c->pick[k]++;
        }
    }
    const size_t size = (size_t)d->n_listed * sizeof *c->pick;
    for (int i = 0; i < v->n; i++) {
        if (memcmp(v->all[i]->pick, c->pick, size) == 0) {
            *out = v->all[i];
            return MT_OK;
        }
    }
    mt_combination **const grown =
        mt_arena_grow(d->mem, v->all, v->n, &v->capacity, sizeof(mt_combination *));
    MT_TRY(mt_arena_check(d->mem, err));
    mt_catalogue_search_set(d, c);
    v->all = grown;
    v->all[v->n++] = c;
    *out = c;
    return MT_OK;
}

/* Evaluates the combination of a design that the proof found: alone, or searched from that
 * design. */
static mt_status evaluate_proof_design(prover *v, const double *x, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
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
    return mt_catalogue_search_verify(d, 1, c, most > 0 ? left : 0, err);
}

/* The proof of a geometry; NULL: there is none. */
static mt_status proof_of(prover *v, int geometry, mt_proof **out, mt_err *err)
{
    mt_catalogue_search_geometry(&v->proofs, geometry, v->lower, v->upper);
    MT_TRY(mt_catalogue_search_proof_of(&v->proofs, v->lower, v->upper, out, err));
    if (*out != NULL) {
        (*out)->left = v->left;
        (*out)->question.cap = v->capped ? &v->cap.cap : NULL;
        v->covers = v->covers && (*out)->covers;
    }
    return MT_OK;
}

/* Mode placements that one geometry has and none before it had. */
static mt_status note_kinds(prover *v, const mt_certify_search *found, mt_err *err)
{
    const int m = v->d->p->n_bands;
    for (int k = 0; k < found->n_found; k++) {
        const int *const row = found->found + ((ptrdiff_t)k * m);
        if (mt_certify_index_of(v->kinds, v->n_kinds, row, m) < v->n_kinds) {
            continue;
        }
        int *const grown = mt_arena_grow(v->d->mem, v->kinds, v->n_kinds, &v->cap_kinds,
                                         ((size_t)m + 1) * sizeof *grown);
        MT_TRY(mt_arena_check(v->d->mem, err));
        v->kinds = grown;
        memcpy(v->kinds + ((ptrdiff_t)v->n_kinds * m), row, (size_t)m * sizeof *row);
        v->n_kinds++;
    }
    return MT_OK;
}

/* Runs the proof of each geometry with its share of `most`, and evaluates the designs found. */
static mt_status run_geometry_proofs(prover *v, outcome *out, mt_err *err)
{
    double most = fmin(PART * v->d->c->proof_work, v->left);
    *out = (outcome){.proven = true};
    for (int g = 0; g < v->n_geometries && !out->stopped; g++) {
        mt_certify_search found = {0};
        mt_proof *proof = NULL;
        MT_TRY(proof_of(v, g, &proof, err));
        out->proven = out->proven && proof != NULL;
        if (proof == NULL) {
            continue;
        }
        const double before = v->left;
        MT_TRY(mt_proof_query(proof, most / (double)(v->n_geometries - g), v->d->mem, &found,
                              err));
        v->left = proof->left;
        most -= before - v->left;
        out->proven = out->proven && found.proven;
        out->stopped = found.stopped;
        out->n_found += found.n_found;
        v->report->boxes += found.boxes;
        MT_TRY(note_kinds(v, &found, err));
        for (int k = 0; k < found.n_found && v->d->stop != MT_STOP_USER; k++) {
            MT_TRY(evaluate_proof_design(v, found.at + ((ptrdiff_t)k * v->d->p->n), err));
        }
    }
    out->proven = out->proven && !out->stopped;
    return MT_OK;
}

/* Below this value of the first objective a design is better than f by more than the share. */
static double cap_of(const mt_problem *p, double f, double share)
{
    /* f is half the square of the change */
    const bool squares = mt_objective_is(p->stages[0].type, MT_HALF_SQUARE);
    return squares ? f * (1.0 - share) * (1.0 - share) : f - (share * fabs(f));
}

/* Proves that the best is within a share of its objective of the optimum; a better design that
 * is found replaces it. */
static mt_status improve(prover *v, double share, mt_err *err)
{
    for (int round = 0; round < ROUNDS; round++) {
        const mt_combination *best = NULL;
        MT_TRY(find_best_combination(v, &best, err));
        if (best == NULL) { /* interrupted on the way from position to position */
            return MT_OK;
        }
        const double f = best->f[0];
        outcome found = {0};
        v->cap.cap.below = cap_of(v->d->p, f, share);
        v->capped = true;
        MT_TRY(run_geometry_proofs(v, &found, err));
        if (found.proven && found.n_found == 0) {
            v->report->best_within = share;
            return MT_OK;
        }
        v->report->cut = v->report->cut || (!found.proven && !found.stopped);
        MT_TRY(find_best_combination(v, &best, err));
        if (best == NULL || !(best->f[0] < f) || v->d->stop == MT_STOP_USER) {
            return MT_OK;
        }
    }
    return MT_OK;
}

static mt_status prove(prover *v, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    mt_catalogue_search_report *const report = v->report;
    outcome found = {0};
    v->left = d->c->proof_work;
    v->covers = true;
    MT_TRY(mt_proof_cap_init(&v->cap, d->p, d->mem, err));
    MT_TRY(run_geometry_proofs(v, &found, err));
    report->n_kinds = v->n_kinds;
    const mt_combination *best = NULL;
    MT_TRY(find_best_combination(v, &best, err));
    report->complete = v->covers && !mt_drive_positions_any(d->p);
    report->n_possible = mt_mode_placement_count_possible(d->p);
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

/* Reason why the whole question cannot be proven. */
static mt_status give_reason(const prover *v, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    mt_proof whole;
    const mt_status rc = mt_proof_init(&whole, d->c, d->mem, err);
    v->report->reason = mt_arena_strdup(d->mem, whole.reason);
    mt_proof_free(&whole);
    return rc == MT_OK ? mt_arena_check(d->mem, err) : rc;
}

/* One proof for each geometry, where these are not too many; 0 geometries, and the reason,
 * where no proof is possible. */
static mt_status start_geometry_proofs(prover *v, mt_err *err)
{
    mt_catalogue_search *const d = v->d;
    mt_proof *first = NULL;
    v->lower = mt_arena_f64(d->mem, (size_t)d->p->n, 1);
    v->upper = mt_arena_f64(d->mem, (size_t)d->p->n, 1);
    MT_TRY(mt_arena_check(d->mem, err));
    MT_TRY(mt_catalogue_search_proofs_init(&v->proofs, d->c, d->mem, err));
    const double n = mt_catalogue_search_geometries(&v->proofs);
    if (n <= (double)GEOMETRIES_MOST) {
        MT_TRY(proof_of(v, 0, &first, err));
    }
    v->n_geometries = first != NULL ? (int)n : 0;
    return v->n_geometries > 0 ? MT_OK : give_reason(v, err);
}

mt_status mt_catalogue_search_prove(mt_catalogue_search *d, mt_combination ***all, int *n,
                                    mt_catalogue_search_report *report, mt_err *err)
{
    prover v = {.d = d, .report = report, .all = *all, .n = *n, .capacity = *n};
    report->asked = true;
    mt_status rc = start_geometry_proofs(&v, err);
    if (rc == MT_OK && v.n_geometries > 0) {
        rc = prove(&v, err);
    }
    mt_catalogue_search_proofs_free(&v.proofs);
    *all = v.all;
    *n = v.n;
    return rc;
}
