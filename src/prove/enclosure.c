/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Making an enclosure: conditions, coefficients, basis. And what is asked of an input. */
#include "prove/enclosure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/count.h"
#include "base/format.h"
#include "prove/basis.h"
#include "prove/check.h"
#include "prove/coefficients.h"

void mt_enclosure_delete(mt_enclosure *e)
{
    if (e != NULL) {
        mt_arena_free(&e->mem);
        mt_arena_free(&e->scratch);
        free(e);
    }
}

static mt_status keep_bounds(mt_enclosure *e, const double *lower, const double *upper,
                             mt_err *err)
{
    const size_t n = (size_t)e->n_inputs;
    e->lower = mt_arena_f64(&e->mem, n, 1);
    e->upper = mt_arena_f64(&e->mem, n, 1);
    e->frozen = mt_arena_alloc(&e->mem, n, sizeof(bool));
    e->in[MT_STIFFNESS] = mt_arena_alloc(&e->mem, n, sizeof(bool));
    e->in[MT_MASS] = mt_arena_alloc(&e->mem, n, sizeof(bool));
    MT_TRY(mt_arena_check(&e->mem, err));
    if (n > 0) {
        memcpy(e->lower, lower, n * sizeof *lower);
        memcpy(e->upper, upper, n * sizeof *upper);
    }
    return MT_OK;
}

static mt_status note_inputs(mt_enclosure *e, mt_err *err)
{
    bool *const depends = mt_arena_alloc(&e->mem, (size_t)e->n_inputs, sizeof *depends);
    MT_TRY(mt_arena_check(&e->mem, err));
    for (int i = 0; i < e->n_coefficients; i++) {
        mt_program_depends(&e->program, e->coefficients[i].node, depends);
        for (int m = 0; m < MT_MATRICES; m++) {
            for (int k = 0; k < e->n_inputs; k++) {
                e->in[m][k] =
                    e->in[m][k] || (depends[k] && e->coefficients[i].part[m].count > 0);
            }
        }
    }
    return MT_OK;
}

/* *ok: false where a direction that the analysis counts as free is held at some design within
 * the bounds. A term can hold it wherever its coefficient can be positive. */
static mt_status check_count(mt_enclosure *e, const mt_analysis *a, bool *ok, char *reason,
                             mt_err *err)
{
    const mt_term_list *const list = mt_linear_terms(a->lin, MT_TERM_STIFFNESS);
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    bool *const holds = mt_arena_alloc(&e->scratch, (size_t)list->n_terms, sizeof *holds);
    int free_directions = 0;
    MT_TRY(mt_arena_check(&e->scratch, err));
    for (int t = 0; t < list->n_terms; t++) {
        const int at = e->of_term[MT_STIFFNESS][t];
        holds[t] = at < 0 ? mt_linear_value(a->lin, list->terms[t].coefficient) != 0.0
                          : e->coefficients[at].most > 0.0 || e->coefficients[at].least < 0.0;
    }
    const mt_status rc = mt_analysis_free_directions(a->lin, &a->mass, holds, &e->scratch,
                                                     &free_directions, err);
    mt_arena_rewind(&e->scratch, mark);
    if (rc == MT_OK && free_directions < a->n_rigid) {
        *ok = false;
        (void)mt_snprintf(
            reason, MT_REASON_SIZE,
            "%d of its %d rigid-body modes may be held by a spring within the bounds",
            a->n_rigid - free_directions, a->n_rigid);
    }
    return rc;
}

static mt_status build(mt_enclosure *e, const mt_analysis *a, const double *lower,
                       const double *upper, bool *ok, char *reason, mt_err *err)
{
    *ok = false;
    MT_TRY(mt_arena_init(&e->mem, 0, err));
    MT_TRY(mt_arena_init(&e->scratch, 0, err));
    e->n_inputs = a->sys->n_inputs;
    MT_TRY(keep_bounds(e, lower, upper, err));
    if (!mt_enclosure_admits(a, lower, upper, e->frozen, reason)) {
        return MT_OK;
    }
    if (a->modes.n_unstable > 0) {
        (void)mt_snprintf(reason, MT_REASON_SIZE, "the mechanism is unstable");
        return MT_OK;
    }
    if (a->modes.n_undecided > 0) {
        (void)mt_snprintf(reason, MT_REASON_SIZE,
                          "rounding hides whether the mechanism is stable");
        return MT_OK;
    }
    e->interrupt = a->sys->run->interrupt;
    MT_TRY(mt_interrupt_check(e->interrupt, err));
    e->n_rigid = a->n_rigid;
    MT_TRY(mt_enclosure_collect(e, a->lin, ok, reason, err));
    if (*ok && a->n_rigid > 0) {
        MT_TRY(check_count(e, a, ok, reason, err));
    }
    if (*ok) {
        MT_TRY(mt_enclosure_reduce(e, a->lin, ok, reason, err));
    }
    return *ok ? note_inputs(e, err) : MT_OK;
}

mt_status mt_enclosure_new(const mt_analysis *a, const double *lower, const double *upper,
                           mt_enclosure **out, char *reason, mt_err *err)
{
    mt_enclosure *const e = calloc(1, sizeof *e);
    bool ok = false;
    *out = NULL;
    reason[0] = '\0';
    if (e == NULL) {
        return mt_fail_memory(err);
    }
    const mt_status rc = build(e, a, lower, upper, &ok, reason, err);
    if (rc != MT_OK || !ok) {
        mt_enclosure_delete(e);
        return rc;
    }
    *out = e;
    return MT_OK;
}

bool mt_enclosure_loose(const mt_enclosure *e, int i)
{
    return e->in[MT_STIFFNESS][i] && e->in[MT_MASS][i];
}

bool mt_enclosure_depends(const mt_enclosure *e, int i)
{
    return e->in[MT_STIFFNESS][i] || e->in[MT_MASS][i];
}

/* Effect of raising input k over the box whose gradient is in dnode. */
static int effect(const mt_enclosure *e, int k)
{
    int bits = 0;
    for (int i = 0; i < e->n_coefficients; i++) {
        const mt_enclosure_coefficient *const c = &e->coefficients[i];
        const size_t at = ((size_t)c->node * (size_t)e->n_inputs) + (size_t)k;
        const bool rises = e->dnode[MT_HIGH][at] > 0.0;
        const bool falls = e->dnode[MT_LOW][at] < 0.0;
        if (c->part[MT_STIFFNESS].count > 0) {
            bits |= (rises ? MT_STIFFENS : 0) | (falls ? MT_SOFTENS : 0);
        }
        if (c->part[MT_MASS].count > 0) {
            bits |= (rises ? MT_SOFTENS : 0) | (falls ? MT_STIFFENS : 0);
        }
    }
    return bits;
}

static void enclose_slopes(mt_enclosure *e, const double *lo, const double *hi)
{
    mt_program_interval_gradient(&e->program, lo, hi, e->node[MT_LOW], e->node[MT_HIGH],
                                 e->dnode[MT_LOW], e->dnode[MT_HIGH]);
}

void mt_enclosure_effects(mt_enclosure *e, const double *lo, const double *hi, int *effects)
{
    enclose_slopes(e, lo, hi);
    for (int k = 0; k < e->n_inputs; k++) {
        effects[k] = effect(e, k);
    }
}

bool mt_enclosure_corners(mt_enclosure *e, const mt_model *model, const int *inputs,
                          const double *lo, const double *hi, double *soft, double *stiff,
                          char *reason)
{
    enclose_slopes(e, lo, hi);
    for (int k = 0; k < e->n_inputs; k++) {
        const int bits = effect(e, k);
        if (bits == (MT_STIFFENS | MT_SOFTENS) && lo[k] < hi[k]) {
            (void)mt_snprintf(reason, MT_REASON_SIZE, "parameter \"%s\" %s",
                              model->parameters[inputs[k]].name.s,
                              mt_enclosure_loose(e, k)
                                  ? "enters both stiffness and mass"
                                  : "stiffens in one place and softens in another");
            return false;
        }
        const double middle = 0.5 * (lo[k] + hi[k]);
        soft[k] = bits == 0 ? middle : (bits == MT_SOFTENS ? hi[k] : lo[k]);
        stiff[k] = bits == 0 ? middle : (bits == MT_SOFTENS ? lo[k] : hi[k]);
    }
    return true;
}
