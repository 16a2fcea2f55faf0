/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Published values against computed ones, from analyses of their own. A value that could not be
 * computed (NaN) never holds; one that is not comparable holds where it has a value. */
#include <math.h>
#include <string.h>

#include "analysis/count.h"
#include "describe/describe.h"
#include "problem/configuration.h"
#include "problem/evaluate.h"

enum { ORIGINAL, RECOMMENDED, DESIGNS };

typedef struct judge {
    mt_workspace *w;
    const mt_problem *p;
    mt_result *result;
    mt_arena mem;             /* work */
    const double *x[DESIGNS]; /* parameters */
    mt_analysis **analysis;   /* [DESIGNS * configurations] owned, made when first asked for */
    double *value[DESIGNS];   /* program values at both designs */
} judge;

static mt_status analysis_at(judge *j, int configuration, int design, mt_analysis **out,
                             mt_err *err)
{
    mt_analysis **const slot = &j->analysis[(DESIGNS * configuration) + design];
    if (*slot == NULL) {
        MT_TRY(mt_problem_analyse(j->p, configuration, j->x[design], slot, err));
    }
    *out = *slot;
    return MT_OK;
}

/* The position of a named mode in the configuration as goals use it, which follows shapes where
 * they mix; *found: there is one. */
static mt_status viewed_at(judge *j, const mt_published *pub, const mt_analysis *a, int *pos,
                           bool *found, mt_err *err)
{
    mt_workspace *const w = j->w;
    const int v = mt_problem_configuration(w->p, pub->configuration);
    double *const t = mt_arena_f64(&j->mem, (size_t)w->p->n + 1, 1);
    *found = false;
    MT_TRY(mt_arena_check(&j->mem, err));
    for (int i = 0; i < w->p->n; i++) {
        t[i] = mt_problem_t(w->p, i, j->x[RECOMMENDED][i]);
    }
    for (int i = 0; v >= 0 && i < w->p->views[v].n_named; i++) {
        mt_configuration_work *const view = &w->views[v];
        if (view->of->named[i] != pub->mode.named) {
            continue;
        }
        mt_configuration_query_all(view);
        view->ask.vectors = true;
        MT_TRY(mt_workspace_place(w, t, false, err));
        MT_TRY(mt_configuration_solve(w, view, false, err));
        MT_TRY(mt_configuration_position(w, view, 0, i, pos, err));
        *pos = mt_modal_flexible(&a->modes, mt_modal_index(&view->analysis->modes, *pos));
        *found = true;
    }
    return MT_OK;
}

/* Position of a named mode at the recommended design: its configuration's named modes of the
 * original design, paired one to one. */
static mt_status named_at(judge *j, const mt_published *pub, mt_analysis *a, int *pos,
                          mt_err *err)
{
    const mt_model *const model = j->p->study->model;
    const size_t most = (size_t)model->n_modes;
    mt_analysis *first = NULL;
    int n = 0;
    int wanted = -1;
    MT_TRY(analysis_at(j, pub->configuration, ORIGINAL, &first, err));
    const double **const w = mt_arena_alloc(&j->mem, most, sizeof *w);
    mt_track *const track = mt_arena_alloc(&j->mem, most, sizeof *track);
    *pos = -1;
    MT_TRY(mt_arena_check(&j->mem, err));
    for (int i = 0; i < model->n_modes; i++) {
        const int there = mt_analysis_named(first, model->modes[i].index);
        if (model->modes[i].configuration != pub->configuration || there < 0) {
            continue;
        }
        double *const shape = mt_arena_f64(&j->mem, (size_t)first->sys->nq, 1);
        MT_TRY(mt_arena_check(&j->mem, err));
        MT_TRY(mt_track_weigh(first, there, shape, err));
        wanted = i == pub->mode.named ? n : wanted;
        w[n++] = shape;
    }
    if (wanted >= 0) {
        MT_TRY(mt_track_match(a, n, w, track, err));
        *pos = track[wanted].pos;
    }
    return MT_OK;
}

static mt_status compute_mode(judge *j, const mt_published *pub, double *value, mt_err *err)
{
    mt_analysis *a = NULL;
    MT_TRY(analysis_at(j, pub->configuration, pub->original ? ORIGINAL : RECOMMENDED, &a, err));
    /* the mode meant: its index at the original design, its position at this one */
    const bool by_index = pub->mode.index > 0;
    const int index =
        by_index ? pub->mode.index : j->p->study->model->modes[pub->mode.named].index;
    int pos = by_index ? mt_modal_flexible(&a->modes, index) : mt_analysis_named(a, index);
    const mt_arena_mark mark = mt_arena_get_mark(&j->mem);
    if (!by_index && !pub->original) {
        bool found = false;
        mt_status rc = viewed_at(j, pub, a, &pos, &found, err);
        rc = rc == MT_OK && !found ? named_at(j, pub, a, &pos, err) : rc;
        mt_arena_rewind(&j->mem, mark);
        MT_TRY(rc);
    }
    if (pos < 0) {
        return MT_OK;
    }
    if (pub->kind == MT_PUBLISHED_FREQUENCY) {
        *value = mt_modal_hz(&a->modes, pos);
        return MT_OK;
    }
    mt_reference_shape shape;
    mt_status rc = mt_reference_shape_init(
        j->p->references, pub->reference, pub->reference_mode > 0 ? pub->reference_mode : index,
        a->sys, nan(""), &j->mem, &shape, err);
    rc = rc == MT_OK ? mt_reference_mac(a, pos, &shape, value, err) : rc;
    mt_arena_rewind(&j->mem, mark);
    return rc;
}

/* The unit in which numbers of a parameter or a quantity are shown; NULL: unchanged. */
static const mt_unit *shown_published_unit(const mt_problem *p, const mt_published *pub)
{
    return pub->kind == MT_PUBLISHED_PARAMETER ? mt_study_unit(p->study, pub->parameter)
           : pub->kind == MT_PUBLISHED_QUANTITY
               ? mt_study_requirement_unit(p->study, &pub->quantity)
               : NULL;
}

static const char *label_of(const mt_problem *p, const mt_published *pub, mt_arena *mem)
{
    const mt_model *const model = p->study->model;
    if (pub->label != NULL) {
        return pub->label;
    }
    switch (pub->kind) {
    case MT_PUBLISHED_PARAMETER:
        return shown_published_unit(p, pub) == NULL
                   ? pub->parameter_name.s
                   : mt_arena_printf(mem, "%s [%s]", pub->parameter_name.s,
                                     mt_unit_name(shown_published_unit(p, pub), ""));
    case MT_PUBLISHED_QUANTITY: {
        const mt_unit *const other = mt_study_requirement_unit(p->study, &pub->quantity);
        return other == NULL ? pub->quantity_text
                             : mt_arena_printf(mem, "%s [%s]", pub->quantity_text, other->name);
    }
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

/* Text of the requirement: a limit beside a published value; a limit alone replaces the
 * value. */
static const char *requirement_of(const mt_published *pub, const mt_unit *unit, mt_arena *mem)
{
    const bool shown = MT_HAS(pub->value);
    const double at_least = mt_unit_from_si(unit, pub->at_least);
    const double at_most = mt_unit_from_si(unit, pub->at_most);
    if (MT_HAS(pub->tolerance)) {
        return mt_arena_printf(mem, "within %g", mt_unit_from_si(unit, pub->tolerance));
    }
    if (MT_HAS(pub->tolerance_percent)) {
        return mt_arena_printf(mem, "within %g %%", pub->tolerance_percent);
    }
    if (MT_HAS(pub->at_least) && MT_HAS(pub->at_most)) {
        return mt_arena_printf(mem, "from %.10g to %.10g", at_least, at_most);
    }
    if (MT_HAS(pub->at_least)) {
        return shown ? mt_arena_printf(mem, "at least %.10g", at_least) : "at least";
    }
    if (MT_HAS(pub->at_most)) {
        return shown ? mt_arena_printf(mem, "at most %.10g", at_most) : "at most";
    }
    return "reported";
}

static bool holds(const mt_published *pub, double computed)
{
    bool ok = MT_HAS(computed);
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
    out->display_unit = mt_unit_name(shown_published_unit(j->p, pub), NULL);
    out->display_factor = mt_unit_display(shown_published_unit(j->p, pub));
    out->requirement = requirement_of(pub, shown_published_unit(j->p, pub), mem);
    MT_TRY(mt_arena_check(mem, err));
    if (pub->kind == MT_PUBLISHED_STATUS) {
        out->published_text = pub->status;
        out->computed_text = mt_result_status_name(j->result->status);
        out->requirement = "equal";
        out->holds = strcmp(pub->status, out->computed_text) == 0;
        return MT_OK;
    }
    if (pub->kind == MT_PUBLISHED_PARAMETER || pub->kind == MT_PUBLISHED_QUANTITY) {
        out->computed = j->value[pub->original ? ORIGINAL : RECOMMENDED][j->p->published[i]];
    } else {
        MT_TRY(mt_err_in(err, compute_mode(j, pub, &out->computed, err), "/published/%d", i));
    }
    out->published = MT_HAS(pub->value)
                         ? pub->value
                         : (MT_HAS(pub->at_least) ? pub->at_least : pub->at_most);
    out->difference = out->computed - out->published;
    out->difference_percent =
        out->published != 0.0 ? 100.0 * out->difference / fabs(out->published) : nan("");
    out->holds =
        pub->role == MT_ROLE_NOT_COMPARABLE ? MT_HAS(out->computed) : holds(pub, out->computed);
    return MT_OK;
}

static mt_status judge_all(judge *j, mt_err *err)
{
    mt_result *const result = j->result;
    const int n = j->p->study->n_published;
    result->published = mt_arena_alloc(&result->mem, (size_t)n, sizeof *result->published);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int d = 0; d < DESIGNS; d++) {
        j->value[d] = mt_arena_f64(&j->mem, (size_t)j->p->program.count, 1);
        MT_TRY(mt_arena_check(&j->mem, err));
        MT_TRY(mt_program_eval(&j->p->program, j->x[d], j->value[d], NULL, err));
    }
    for (int i = 0; i < n; i++) {
        MT_TRY(judge_one(j, i, &result->published[i], err));
        result->n_published++;
    }
    return MT_OK;
}

mt_status mt_describe_published(mt_workspace *w, const double *x_original,
                                const double *x_recommended, mt_result *result, mt_err *err)
{
    const int n_analyses = DESIGNS * w->p->study->model->n_configurations;
    judge j = {.w = w,
               .p = w->p,
               .result = result,
               .x = {x_original, x_recommended != NULL ? x_recommended : x_original}};
    MT_TRY(mt_arena_init(&j.mem, 0, err));
    j.analysis = mt_arena_alloc(&j.mem, (size_t)n_analyses, sizeof(mt_analysis *));
    mt_status rc = mt_arena_check(&j.mem, err);
    rc = rc == MT_OK ? judge_all(&j, err) : rc;
    for (int i = 0; j.analysis != NULL && i < n_analyses; i++) {
        mt_analysis_delete(j.analysis[i]);
    }
    mt_arena_free(&j.mem);
    return rc;
}
