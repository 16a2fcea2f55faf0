/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search/sampled_bounds.h"

#include <math.h>
#include <string.h>

#include "nlp/starts.h"
#include "problem/evaluate.h"
#include "search/proof.h"

/* Slices for each variable that shapes the geometry, and in all. */
enum { SAMPLED_BOUNDS_PER_SHAPE = 16, SAMPLED_BOUNDS_MOST = 32 };
/* Multiplications of one: tens of milliseconds. */
static const double SLICE_WORK = 5e7;

/* Adds the new placements of one sampled geometry to the list. */
static mt_status add_sampled_placements(const mt_problem *p, const mt_certify_search *slice,
                                        mt_arena *mem, mt_sampled_bounds *out, mt_err *err)
{
    const size_t row = (size_t)p->n_bands;
    const size_t had = (size_t)out->n_found;
    const size_t n = had + (size_t)slice->n_found;
    if (slice->n_found == 0) {
        return MT_OK;
    }
    int *const found = mt_arena_int(mem, n * row);
    double *const at = mt_arena_f64(mem, n, (size_t)p->n);
    MT_TRY(mt_arena_check(mem, err));
    if (had > 0) {
        memcpy(found, out->found, had * row * sizeof *found);
        memcpy(at, out->at, had * (size_t)p->n * sizeof *at);
    }
    memcpy(found + (had * row), slice->found, (n - had) * row * sizeof *found);
    for (size_t k = 0; k < n - had; k++) {
        for (int i = 0; i < p->n; i++) {
            const size_t own = (k * (size_t)p->n) + (size_t)i;
            at[(had * (size_t)p->n) + own] = mt_problem_t(p, i, slice->at[own]);
        }
    }
    out->found = found;
    out->at = at;
    out->n_found = (int)n;
    return MT_OK;
}

/* *possible: the others can be enclosed there. */
static mt_status prove_sampled_geometry(const mt_subproblem *c, mt_arena *mem,
                                        mt_sampled_bounds *out, bool *possible, mt_err *err)
{
    mt_proof proof;
    mt_certify_search found = {0};
    mt_status rc = mt_proof_init(&proof, c, mem, err);
    *possible = rc == MT_OK && proof.possible;
    if (*possible) {
        proof.question.max_work = c->proof_work;
        rc =
            mt_certify_assignments(&proof.question, out->n_found, out->found, mem, &found, err);
        rc = rc == MT_OK ? add_sampled_placements(c->p, &found, mem, out, err) : rc;
        out->n_settled += rc == MT_OK && found.proven ? 1 : 0;
    }
    mt_proof_free(&proof);
    return rc;
}

static mt_status prove_sampled_shapes(const mt_workspace *w, const bool *shapes,
                                      const double *t, mt_arena *mem, mt_sampled_bounds *out,
                                      mt_err *err)
{
    const mt_problem *const p = w->p;
    mt_subproblem c;
    double *const x = mt_arena_f64(mem, (size_t)p->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_subproblem_copy(w->c, mem, &c, err));
    c.proof_work = fmin(SLICE_WORK, w->c->proof_work / (double)out->n);
    for (int k = 0; k < out->n && !mt_interrupted(p->run->interrupt); k++) {
        bool possible = false;
        mt_subproblem_x(w->c, t + ((ptrdiff_t)k * p->n), x);
        for (int i = 0; i < p->n; i++) {
            if (shapes[i]) {
                mt_subproblem_bound(&c, i, x[i], x[i]);
            }
        }
        MT_TRY(prove_sampled_geometry(&c, mem, out, &possible, err));
        if (k == 0 && !possible) { /* the original geometry: more is in the way */
            out->n = 0;
        }
    }
    return MT_OK;
}

mt_status mt_sampled_bounds_search(mt_workspace *w, mt_arena *mem, mt_sampled_bounds *out,
                                   mt_err *err)
{
    const mt_problem *const p = w->p;
    bool *shapes = NULL;
    int m = 0;
    *out = (mt_sampled_bounds){.n = 0};
    MT_TRY(mt_proof_shaping(w->c, mem, &shapes, &m, err));
    if (m == 0 || !(w->c->proof_work > 0.0)) {
        return MT_OK;
    }
    mt_nlp nlp = mt_workspace_nlp(w);
    nlp.n = p->n;
    out->n = m * SAMPLED_BOUNDS_PER_SHAPE < SAMPLED_BOUNDS_MOST ? m * SAMPLED_BOUNDS_PER_SHAPE
                                                                : SAMPLED_BOUNDS_MOST;
    const double *const t = mt_nlp_starts(&nlp, w->c->search.seed, out->n, mem);
    MT_TRY(mt_arena_check(mem, err));
    return prove_sampled_shapes(w, shapes, t, mem, out, err);
}
