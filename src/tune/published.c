/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Published values against computed ones. A value without any tolerance is reported and holds always only where it is "not comparable"; else it needs one. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tune/describe.h"

typedef struct judge {
    mt_problem *p;
    mt_result *result;
    const double *x[2];     /* original, recommended */
    mt_analysis **analysis; /* [2 * configurations], made when first asked for */
    double *value[2];       /* program values at both designs */
} judge;

static mt_status analysis_at(judge *j, int configuration, bool original, mt_analysis **out,
                             mt_err *err)
{
    const int design = original ? 0 : 1;
    mt_analysis **const slot = &j->analysis[(2 * configuration) + design];
    if (*slot == NULL) {
        MT_TRY(mt_analysis_new(j->p->study->model, configuration, j->p->n, j->p->inputs,
                               j->x[design], slot, err));
    }
    *out = *slot;
    return MT_OK;
}

/* Position of the mode meant: by index, or by name through the shape at the original design. */
static mt_status mode_at(judge *j, const mt_published *pub, mt_analysis *a, int *pos,
                         int *index, mt_err *err)
{
    const mt_model *const model = j->p->study->model;
    *index = pub->mode.index > 0 ? pub->mode.index : model->modes[pub->mode.named].index;
    *pos = mt_modal_flexible(&a->modes, *index);
    if (pub->mode.index > 0 || pub->original) {
        return MT_OK;
    }
    /* by name at the recommended design: largest mass-weighted correlation with the mode at the original design */
    mt_analysis *first = NULL;
    MT_TRY(analysis_at(j, pub->configuration, true, &first, err));
    const int there = mt_modal_flexible(&first->modes, *index);
    const ptrdiff_t nq = a->sys->nq;
    double *const w = mt_arena_f64(&j->result->mem, (size_t)nq, 2);
    double best = -1.0;
    if (w == NULL) {
        return mt_fail_memory(err);
    }
    if (there < 0 || *pos < 0) {
        *pos = -1;
        return MT_OK;
    }
    MT_TRY(mt_linear_mass_product(first->lin,
                                  first->modes.y + ((ptrdiff_t)there * first->lin->n), w, err));
    for (int i = 0; i < a->modes.count; i++) {
        mt_linear_expand(a->lin, 1, a->modes.y + ((ptrdiff_t)i * a->lin->n), w + nq);
        const double c = fabs(mt_dot((int)nq, w, w + nq));
        if (a->modes.kind[i] == MT_MODE_FLEXIBLE && c > best) {
            best = c;
            *pos = i;
        }
    }
    return MT_OK;
}

static mt_status compute(judge *j, int i, double *value, mt_err *err)
{
    const mt_published *const pub = &j->p->study->published[i];
    mt_analysis *a = NULL;
    int pos = -1;
    int index = 0;
    *value = nan("");
    switch (pub->kind) {
    case MT_PUBLISHED_PARAMETER:
    case MT_PUBLISHED_QUANTITY:
        *value = j->value[pub->original ? 0 : 1][j->p->published[i]];
        return MT_OK;
    case MT_PUBLISHED_FREQUENCY:
    case MT_PUBLISHED_MAC: {
        MT_TRY(analysis_at(j, pub->configuration, pub->original, &a, err));
        MT_TRY(mode_at(j, pub, a, &pos, &index, err));
        if (pos < 0) {
            return MT_OK;
        }
        if (pub->kind == MT_PUBLISHED_FREQUENCY) {
            *value = mt_modal_hz(&a->modes, pos);
            return MT_OK;
        }
        mt_reference_shape shape;
        MT_TRY(mt_reference_shape_init(j->p, pub->reference,
                                       pub->reference_mode > 0 ? pub->reference_mode : index,
                                       a->sys, &j->result->mem, &shape, err));
        return mt_reference_mac(a, pos, &shape, value, err);
    }
    case MT_PUBLISHED_STATUS:
    case MT_PUBLISHED_KIND_COUNT:
        break;
    }
    return MT_OK;
}

static const char *label_of(const mt_problem *p, const mt_published *pub, mt_arena *mem)
{
    const mt_model *const model = p->study->model;
    if (pub->label != NULL) {
        return pub->label;
    }
    switch (pub->kind) {
    case MT_PUBLISHED_PARAMETER:
        return pub->parameter_name.s;
    case MT_PUBLISHED_QUANTITY:
        return pub->quantity_text;
    case MT_PUBLISHED_FREQUENCY:
    case MT_PUBLISHED_MAC: {
        const char *const what = pub->kind == MT_PUBLISHED_MAC ? "MAC of " : "";
        const char *const unit = pub->kind == MT_PUBLISHED_MAC ? "" : " [Hz]";
        const char *const configuration = model->configurations[pub->configuration].name.s;
        return pub->mode.index > 0 ? mt_arena_printf(mem, "%s%s mode %d%s", what, configuration,
                                                     pub->mode.index, unit)
                                   : mt_arena_printf(mem, "%s%s \"%s\"%s", what, configuration,
                                                     pub->mode.mode_name.s, unit);
    }
    case MT_PUBLISHED_STATUS:
        return "status";
    case MT_PUBLISHED_KIND_COUNT:
        break;
    }
    return "";
}

/* A limit beside a published value is told; alone it stands in the value's place. */
static const char *limit_text(const mt_published *pub, mt_arena *mem)
{
    const bool shown = MT_HAS(pub->value);
    if (MT_HAS(pub->at_least) && MT_HAS(pub->at_most)) {
        return mt_arena_printf(mem, "from %.10g to %.10g", pub->at_least, pub->at_most);
    }
    if (MT_HAS(pub->at_least)) {
        return shown ? mt_arena_printf(mem, "at least %.10g", pub->at_least) : "at least";
    }
    return shown ? mt_arena_printf(mem, "at most %.10g", pub->at_most) : "at most";
}

static const char *demand_of(const mt_published *pub, mt_arena *mem)
{
    if (MT_HAS(pub->tolerance)) {
        return mt_arena_printf(mem, "within %g", pub->tolerance);
    }
    if (MT_HAS(pub->tolerance_percent)) {
        return mt_arena_printf(mem, "within %g %%", pub->tolerance_percent);
    }
    if (MT_HAS(pub->at_least) || MT_HAS(pub->at_most)) {
        return limit_text(pub, mem);
    }
    return "reported";
}

static bool holds(const mt_published *pub, double computed)
{
    bool ok = computed == computed;
    if (MT_HAS(pub->value) && MT_HAS(pub->tolerance)) {
        ok = ok && fabs(computed - pub->value) <= pub->tolerance;
    }
    if (MT_HAS(pub->value) && MT_HAS(pub->tolerance_percent)) {
        ok = ok &&
             fabs(computed - pub->value) <= 0.01 * pub->tolerance_percent * fabs(pub->value);
    }
    if (MT_HAS(pub->at_least)) {
        ok = ok && computed >= pub->at_least;
    }
    if (MT_HAS(pub->at_most)) {
        ok = ok && computed <= pub->at_most;
    }
    return ok;
}

static mt_status judge_one(judge *j, int i, mt_result_published *out, mt_err *err)
{
    const mt_published *const pub = &j->p->study->published[i];
    mt_arena *const mem = &j->result->mem;
    *out = mt_result_published_default();
    out->label = label_of(j->p, pub, mem);
    out->pointer = mt_arena_printf(mem, "/published/%d", i);
    out->role = mt_role_name(pub->role);
    out->kind = mt_published_kind_name(pub->kind);
    out->source = pub->source;
    out->demand = demand_of(pub, mem);
    if (out->label == NULL || out->pointer == NULL || out->demand == NULL) {
        return mt_fail_memory(err);
    }
    if (pub->kind == MT_PUBLISHED_STATUS) {
        out->published_text = pub->status;
        out->computed_text = mt_result_status_name(j->result->status);
        out->demand = "equal";
        out->holds = strcmp(pub->status, out->computed_text) == 0;
        return MT_OK;
    }
    MT_TRY(mt_err_in(err, compute(j, i, &out->computed, err), "/published/%d", i));
    out->published = MT_HAS(pub->value)
                         ? pub->value
                         : (MT_HAS(pub->at_least) ? pub->at_least : pub->at_most);
    out->difference = out->computed - out->published;
    out->difference_percent =
        out->published != 0.0 ? 100.0 * out->difference / fabs(out->published) : nan("");
    out->holds = pub->role == MT_ROLE_NOT_COMPARABLE || holds(pub, out->computed);
    return MT_OK;
}

mt_status mt_describe_published(mt_problem *p, const double *x_original,
                                const double *x_recommended, mt_result *result, mt_err *err)
{
    const int n = p->study->n_published;
    const size_t n_analyses = 2 * (size_t)p->study->model->n_configurations;
    judge j = {
        .p = p,
        .result = result,
        .x = {x_original, x_recommended != NULL ? x_recommended : x_original}
    };
    result->published = mt_arena_alloc(&result->mem, (size_t)n, sizeof *result->published);
    j.analysis = mt_arena_alloc(&result->mem, n_analyses, sizeof(mt_analysis *));
    for (int d = 0; d < 2; d++) {
        j.value[d] = mt_arena_f64(&result->mem, (size_t)p->program.count, 1);
        if (result->published == NULL || j.analysis == NULL || j.value[d] == NULL) {
            return mt_fail_memory(err);
        }
        MT_TRY(mt_program_eval(&p->program, j.x[d], j.value[d], NULL, err));
    }
    mt_status rc = MT_OK;
    for (int i = 0; i < n && rc == MT_OK; i++) {
        rc = judge_one(&j, i, &result->published[i], err);
        result->n_published += rc == MT_OK ? 1 : 0;
    }
    for (size_t i = 0; i < n_analyses; i++) {
        mt_analysis_delete(j.analysis[i]);
    }
    return rc;
}
