/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search/proof.h"

#include <math.h>

#include "base/format.h"
#include "base/run.h"
#include "problem/configuration.h"
#include "problem/requirement.h"
#include "prove/enclosure.h"

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

/* Frequency goals by index that are constraints, and limits on expressions. */
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
        } else {
            proof->covers = false;
        }
    }
    q->limits = proof->limits;
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

mt_status mt_proof_use_catalogues(mt_proof *proof, const mt_problem *p, mt_arena *mem,
                                  mt_err *err)
{
    int *const count = mt_arena_int(mem, (size_t)p->n);
    const double **const values = mt_arena_alloc(mem, (size_t)p->n, sizeof(double *));
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < p->n; i++) {
        count[i] = p->study->variables[i].n_catalogue;
        values[i] = p->study->variables[i].catalogue;
    }
    proof->question.n_catalogue = count;
    proof->question.catalogue = values;
    return MT_OK;
}
