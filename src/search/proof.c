/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is proven of a study by enclosures: least values of the objective, questions over
 * boxes, that nothing meets the goals, and placements at sampled geometries. */
#include "search/proof.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/run.h"
#include "nlp/nlp.h"
#include "problem/configuration.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "problem/requirement.h"
#include "prove/certify.h"
#include "prove/enclosure.h"

/* Least values of the first objective over boxes. */

static double least_cap_value(void *context, const double *lo, const double *hi)
{
    const mt_proof_cap *const c = context;
    const mt_objective_stage *const a = &c->p->stages[0];
    return c->known ? a->ops->least(c->p, a, lo, hi, c->low, c->high) / a->size : -HUGE_VAL;
}

mt_status mt_proof_cap_init(mt_proof_cap *c, const mt_problem *p, mt_arena *mem, mt_err *err)
{
    const int own = p->program.count;
    const int system = p->n_views > 0 ? p->views[0].original->sys->program.count : 0;
    const size_t count = (size_t)(own > system ? own : system);
    *c = (mt_proof_cap){.p = p,
                        .known = p->stages[0].ops->least != NULL,
                        .low = mt_arena_f64(mem, count, 1),
                        .high = mt_arena_f64(mem, count, 1),
                        .cap = {.least = least_cap_value, .context = c}};
    return mt_arena_check(mem, err);
}

static const double PERCENT = 100.0;

/* Questions over boxes. */

/* Spent with the first box. 0 would be the default of certify.h. */
static const double LEAST_WORK = 1.0;

void mt_proof_free(mt_proof *proof)
{
    double work = 0.0;
    for (int i = 0; proof->views != NULL && i < proof->question.n_views; i++) {
        work += proof->views[i] != NULL ? proof->views[i]->operations : 0.0;
        mt_enclosure_delete(proof->views[i]);
        proof->views[i] = NULL;
    }
    mt_work_counters_note(proof->spent, MT_WORK_MULTIPLICATIONS, (long)work);
}

mt_status mt_proof_shaping(const mt_subproblem *c, mt_arena *mem, bool **shapes, int *count,
                           mt_err *err)
{
    const mt_problem *const p = c->p;
    bool *const one = mt_arena_alloc(mem, (size_t)p->n, sizeof *one);
    *shapes = mt_arena_alloc(mem, (size_t)p->n, sizeof **shapes);
    *count = 0;
    MT_TRY(mt_arena_check(mem, err));
    for (int v = 0; v < p->n_views; v++) {
        mt_enclosure_shaping(p->views[v].original, one);
        for (int i = 0; i < p->n; i++) {
            const bool first = one[i] && !(*shapes)[i] && c->lower[i] < c->upper[i];
            (*shapes)[i] = (*shapes)[i] || first;
            *count += first ? 1 : 0;
        }
    }
    return MT_OK;
}

/* The configuration with the geometry of the question, where its bounds allow only one other
 * than the original; NULL: the original's. *ok false, with the reason: no such mechanism. */
static mt_status make_question_configuration(const mt_proof *proof, const mt_problem *p,
                                             int view, mt_arena *mem, mt_analysis **out,
                                             bool *ok, char *why, mt_err *err)
{
    const size_t n = (size_t)p->n;
    const mt_analysis *const original = p->views[view].original;
    bool *const shapes = mt_arena_alloc(mem, n, sizeof *shapes);
    double *const x = mt_arena_f64(mem, n, 1);
    mt_err own = {.code = MT_OK};
    bool moved = false;
    *out = NULL;
    *ok = true;
    MT_TRY(mt_arena_check(mem, err));
    mt_enclosure_shaping(original, shapes);
    for (int i = 0; i < p->n; i++) {
        const bool other = shapes[i] && proof->lower[i] == proof->upper[i];
        x[i] = other ? proof->lower[i] : p->original[i];
        moved = moved || x[i] != p->original[i];
    }
    if (!moved) {
        return MT_OK;
    }
    const mt_status rc = mt_configuration_analyse(&p->views[view], x, out, &own);
    *ok = rc == MT_OK;
    (void)mt_snprintf(why, MT_REASON_SIZE, "%s", own.text);
    return mt_pass_final(rc, &own, err);
}

static mt_status enclose_view(mt_proof *proof, const mt_problem *p, int view, mt_arena *mem,
                              char *why, mt_err *err)
{
    mt_analysis *own = NULL;
    bool ok = false;
    MT_TRY(make_question_configuration(proof, p, view, mem, &own, &ok, why, err));
    const mt_analysis *const a = own != NULL ? own : p->views[view].original;
    const mt_status rc =
        ok ? mt_enclosure_new(a, proof->lower, proof->upper, &proof->views[view], why, err)
           : MT_OK;
    mt_analysis_delete(own);
    return rc;
}

static mt_status enclose(mt_proof *proof, const mt_problem *p, mt_arena *mem, mt_err *err)
{
    proof->possible = p->n_views > 0 && p->n > 0;
    for (int i = 0; i < p->n_views && proof->possible; i++) {
        char why[MT_REASON_SIZE] = "";
        MT_TRY(enclose_view(proof, p, i, mem, why, err));
        if (proof->views[i] == NULL) {
            proof->possible = false;
            (void)mt_snprintf(proof->reason, sizeof proof->reason,
                              "configuration \"%.50s\": %.150s",
                              mt_analysis_configuration(p->views[i].original), why);
        }
    }
    return MT_OK;
}

mt_status mt_proof_query(mt_proof *proof, double most, mt_arena *mem, mt_certify_search *out,
                         mt_err *err)
{
    proof->question.max_work = fmax(fmin(most, proof->left), LEAST_WORK);
    MT_TRY(mt_certify_assignments(&proof->question, 0, NULL, mem, out, err));
    proof->left = fmax(proof->left - out->work, 0.0);
    if (out->proven) {
        mt_progress_proved(proof->question.progress);
    }
    return MT_OK;
}

static void list_bands(mt_proof *proof, const mt_problem *p)
{
    int at = 0;
    for (int i = 0; i < p->n_avoidances; i++) {
        const mt_avoidance *const c = &p->avoidances[i];
        for (int b = 0; b < c->bands.n; b++) {
            const mt_band *const band = &c->bands.items[b];
            proof->bands[at] =
                (mt_certify_band){c->view, band->lower_hz, band->upper_hz, c->tolerance};
            proof->bases[at++] = (mt_certify_band){c->view, band->base_lower_hz,
                                                   band->base_upper_hz, c->tolerance};
        }
    }
    proof->question.n_bands = at;
    proof->question.bands = proof->bands;
    proof->question.same_as = p->tie;
}

/* A ratio, or a distance of one mode above another: in percent it is a ratio less 1. */
static mt_certify_pair pair_of(const mt_requirement *d, double least, double most)
{
    const bool ratio = d->measure == MT_MEASURE_RATIO;
    const bool in_hz = MT_HAS(d->goal->at_least_hz);
    const double give = ratio ? 0.0 : d->tolerance;
    const double part = ratio ? d->tolerance : 0.0;
    const double low = (least * (1.0 - part)) - (give * mt_requirement_unit(d, least));
    const double high = (most * (1.0 + part)) + (give * mt_requirement_unit(d, most));
    const bool percent = !ratio && !in_hz;
    return (mt_certify_pair){.view = d->view,
                             .mode = d->mode,
                             .of_view = d->of.view,
                             .of_mode = d->of.mode,
                             .difference = in_hz,
                             .at_least = percent ? 1.0 + (low / PERCENT) : low,
                             .at_most = percent ? 1.0 + (high / PERCENT) : high};
}

/* Goals of frequencies by index that are constraints, and limits on expressions. */
static void list_limits(mt_proof *proof, const mt_problem *p)
{
    mt_certify *const q = &proof->question;
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        /* the interval that the requirement keeps its number in */
        const double least = MT_HAS(d->equals) ? d->equals : d->goal->at_least;
        const double most = MT_HAS(d->equals) ? d->equals : d->goal->at_most;
        if (d->role == MT_ROLE_RESIDUAL) {
            continue;
        }
        if (mt_requirement_is_frequency(d)) {
            proof->limit_requirement[q->n_limits] = i;
            proof->limits[q->n_limits++] =
                (mt_certify_limit){d->view, d->mode, least, most, d->tolerance};
        } else if (d->quantity == MT_QUANTITY_EXPRESSION) {
            proof->bounds[q->n_bounds++] = (mt_certify_bound){
                d->node, least - (d->tolerance * mt_requirement_unit(d, least)),
                most + (d->tolerance * mt_requirement_unit(d, most))};
        } else if (mt_requirement_is_pair(d)) {
            proof->pairs[q->n_pairs++] = pair_of(d, least, most);
        } else {
            proof->covers = false;
        }
    }
    q->limits = proof->limits;
    q->pairs = proof->pairs;
    q->bounds = proof->bounds;
    q->program = q->n_bounds > 0 ? &p->program : NULL;
}

mt_status mt_proof_init(mt_proof *proof, const mt_subproblem *c, mt_arena *mem, mt_err *err)
{
    const mt_problem *const p = c->p;
    const size_t n = (size_t)p->n;
    const size_t n_requirements = (size_t)p->n_requirements;
    const size_t n_bands = (size_t)p->n_bands;
    *proof = (mt_proof){.left = c->proof_work, .spent = p->run->work};
    proof->views = mt_arena_alloc(mem, (size_t)p->n_views, sizeof(mt_enclosure *));
    proof->bands = mt_arena_alloc(mem, n_bands, sizeof *proof->bands);
    proof->bases = mt_arena_alloc(mem, n_bands, sizeof *proof->bases);
    proof->limits = mt_arena_alloc(mem, n_requirements, sizeof *proof->limits);
    proof->pairs = mt_arena_alloc(mem, n_requirements, sizeof *proof->pairs);
    proof->bounds = mt_arena_alloc(mem, n_requirements, sizeof *proof->bounds);
    proof->limit_requirement = mt_arena_int(mem, n_requirements);
    proof->lower = mt_arena_f64(mem, n, 1);
    proof->upper = mt_arena_f64(mem, n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < p->n; i++) {
        proof->lower[i] = c->lower[i];
        proof->upper[i] = c->upper[i];
    }
    proof->question = (mt_certify){.n_views = p->n_views,
                                   .views = proof->views,
                                   .n = p->n,
                                   .lower = proof->lower,
                                   .upper = proof->upper,
                                   .scale = p->scale,
                                   .max_work = c->proof_work,
                                   .interrupt = p->run->interrupt,
                                   .progress = p->run->progress};
    if (c->proof_work > 0.0) {
        MT_TRY(enclose(proof, p, mem, err));
    } else {
        (void)mt_snprintf(proof->reason, sizeof proof->reason, "\"proof_s\" is 0");
    }
    /* what is possible for a design may not be over its tolerances */
    proof->covers = c->tolerance_box == NULL;
    list_bands(proof, p);
    list_limits(proof, p);
    return MT_OK;
}

/* That no design meets the goals. */

/* Multiplications of branch and bound: a millisecond, or a box. */
static const double LITTLE = 1e6;

/* Limits on expressions and on pairs of modes are not known by their requirement: where one is
 * left out, all are. */
static void leave_out_requirement(mt_proof *proof, int requirement)
{
    mt_certify *const c = &proof->question;
    int n = 0;
    for (int i = 0; i < c->n_limits; i++) {
        if (proof->limit_requirement[i] != requirement) {
            proof->limits[n++] = proof->limits[i];
        }
    }
    c->n_limits = n;
    c->n_bounds = requirement >= 0 ? 0 : c->n_bounds;
    c->n_pairs = requirement >= 0 ? 0 : c->n_pairs;
}

static mt_status prove_infeasible(const mt_infeasible_presolve_question *q, mt_proof *proof,
                                  mt_arena *mem, bool *out, mt_err *err)
{
    const mt_certify *const c = &proof->question;
    mt_certify_search found = {0};
    MT_TRY(mt_certify_out_of_reach(c, mem, out, err));
    if (*out || c->n_bands + c->n_limits + c->n_pairs + c->n_bounds == 0) {
        return MT_OK;
    }
    MT_TRY(mt_proof_query(proof, q->most > 0.0 ? q->most : LITTLE, mem, &found, err));
    *out = found.proven && found.n_found == 0;
    if (*out && q->boxes != NULL) {
        *q->boxes = found.boxes;
    }
    return MT_OK;
}

mt_status mt_infeasible_presolve(const mt_infeasible_presolve_question *q, mt_arena *mem,
                                 bool *out, mt_err *err)
{
    mt_proof proof;
    *out = false;
    mt_status rc = mt_proof_init(&proof, q->c, mem, err);
    if (rc == MT_OK && proof.possible) {
        leave_out_requirement(&proof, q->but);
        proof.question.n_bands = q->bands ? proof.question.n_bands : 0;
        proof.question.progress = NULL; /* not the answer's own */
        proof.spent = q->counted ? proof.spent : NULL;
        rc = prove_infeasible(q, &proof, mem, out, err);
    }
    mt_proof_free(&proof);
    return rc;
}

/* Placements at sampled geometries. */

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
