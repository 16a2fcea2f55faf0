/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How much the modes of a configuration are those of a reference that goals compare one of them
 * with: MAC_ij = (a_i . b_j)^2 / (|a_i|^2 |b_j|^2) at the sensors that both have. One mode that
 * has become another, or two that have changed places, are seen beside the diagonal.
 */
#include <math.h>
#include <string.h>

#include "analysis/count.h"
#include "describe/describe.h"
#include "problem/configuration.h"
#include "problem/evaluate.h"
#include "problem/goals.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"

/* Modes of a reference that are compared at most: a table of more says nothing to anybody. */
enum { REFERENCE_MODES = 24 };

/* True where it is the first goal that compares shapes of this configuration with that
 * reference. */
static bool is_first(const mt_problem *p, int i)
{
    const mt_requirement *const d = &p->requirements[i];
    for (int k = 0; k < i; k++) {
        const mt_requirement *const e = &p->requirements[k];
        if (e->shape.ns > 0 && e->view == d->view && e->goal->reference == d->goal->reference) {
            return false;
        }
    }
    return d->shape.ns > 0;
}

/* The modes of the reference that move at common sensors, as many as the configuration has
 * listed, or was measured; shapes in mem. */
static mt_status compared_with(const mt_problem *p, const mt_requirement *d, int listed,
                               mt_arena *mem, mt_reference_shape *shapes, int *n, mt_err *err)
{
    const mt_reference *const r = &p->study->references[d->goal->reference];
    const int most = r->model == NULL ? r->n_modes : listed;
    *n = 0;
    for (int k = 1; k <= most && k <= REFERENCE_MODES; k++) {
        mt_err why = {.code = MT_OK};
        const mt_status rc = mt_reference_shape_init(p->references, d->goal->reference, k,
                                                     p->views[d->view].original->sys,
                                                     d->goal->length, mem, &shapes[*n], &why);
        MT_TRY(mt_pass_final(rc, &why, err));
        *n += rc == MT_OK ? 1 : 0;
    }
    return MT_OK;
}

static mt_status describe_rows(mt_analysis *a, int listed, const mt_reference_shape *shapes,
                               mt_arena *mem, mt_result_mac *m, mt_err *err)
{
    const int n = m->n_reference_modes;
    m->rows = mt_arena_alloc(mem, (size_t)listed, sizeof *m->rows);
    MT_TRY(mt_arena_check(mem, err));
    for (int mode = 1; mode <= listed; mode++) {
        const int pos = mt_modal_flexible(&a->modes, mode);
        mt_result_mac_row row = {.mode = mode, .n_values = n};
        row.values = mt_arena_f64(mem, (size_t)n, 1);
        MT_TRY(mt_arena_check(mem, err));
        bool moves = pos >= 0;
        for (int j = 0; j < n && moves; j++) {
            MT_TRY(mt_reference_mac(a, pos, &shapes[j], &row.values[j], err));
            moves = isfinite(row.values[j]);
        }
        if (moves) {
            m->rows[m->n_rows++] = row;
        }
    }
    return MT_OK;
}

static mt_status describe_one(const mt_problem *p, const mt_requirement *d, mt_analysis *a,
                              int listed, mt_arena *scratch, mt_result *result,
                              mt_result_mac *m, mt_err *err)
{
    mt_arena *const mem = &result->mem;
    mt_reference_shape *const shapes = mt_arena_alloc(scratch, REFERENCE_MODES, sizeof *shapes);
    MT_TRY(mt_arena_check(scratch, err));
    m->configuration = mt_analysis_configuration(a);
    m->reference = p->study->references[d->goal->reference].name.s;
    MT_TRY(compared_with(p, d, listed, scratch, shapes, &m->n_reference_modes, err));
    m->reference_modes = mt_arena_f64(mem, (size_t)m->n_reference_modes, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int j = 0; j < m->n_reference_modes; j++) {
        m->reference_modes[j] = (double)shapes[j].mode;
    }
    return describe_rows(a, listed, shapes, mem, m, err);
}

/* MAC of the first `listed` modes of a, the analysis of the configuration at the design,
 * with those of the references whose shapes goals compare. */
static mt_status describe_mac(const mt_problem *p, int view, mt_analysis *a, int listed,
                              mt_result *result, mt_recommendation *rec, mt_err *err)
{
    mt_arena scratch;
    if (rec->macs == NULL) {
        rec->macs = mt_arena_alloc(&result->mem, (size_t)p->n_requirements, sizeof *rec->macs);
    }
    MT_TRY(mt_arena_check(&result->mem, err));
    MT_TRY(mt_arena_init(&scratch, 0, err));
    mt_status rc = MT_OK;
    for (int i = 0; i < p->n_requirements && rc == MT_OK; i++) {
        if (p->requirements[i].view == view && is_first(p, i)) {
            mt_result_mac *const m = &rec->macs[rec->n_macs++];
            *m = (mt_result_mac){.configuration = NULL};
            rc = describe_one(p, &p->requirements[i], a, listed, &scratch, result, m, err);
        }
    }
    mt_arena_free(&scratch);
    return rc;
}

/* Slopes of the values of goals over the variables, at a design that has been described. */

static bool is_same_name(const char *a, const char *b)
{
    return a == NULL || b == NULL ? a == b : strcmp(a, b) == 0;
}

/* Derivatives of a frequency, computed with it: NULL where its mode repeats. */
static double *of_frequency(const mt_recommendation *rec, const mt_result_goal *g)
{
    for (int i = 0; i < rec->n_frequencies; i++) {
        const mt_result_frequency *const f = &rec->frequencies[i];
        const bool mode = g->name != NULL ? is_same_name(f->name, g->name) : f->mode == g->mode;
        if (mode && is_same_name(f->configuration, g->configuration)) {
            return f->repeated ? NULL : f->sensitivity;
        }
    }
    return NULL;
}

static mt_status solve_with_slopes(mt_workspace *fresh, mt_configuration_work *view,
                                   mt_err *err)
{
    mt_configuration_query_all(view);
    view->ask.vectors = true;
    return mt_configuration_solve(fresh, view, true, err);
}

/* Derivatives of another value, from its slope over t. */
static mt_status of_value(mt_workspace *fresh, const mt_requirement *d, mt_result *result,
                          mt_result_goal *g, mt_err *err)
{
    const int n = fresh->p->n;
    int pos = -1;
    double q = nan("");
    const bool modal = mt_requirement_is_modal(d);
    if (d->view >= 0) {
        mt_configuration_work *const view = &fresh->views[d->view];
        MT_TRY(solve_with_slopes(fresh, view, err));
        MT_TRY(d->of.view >= 0 && d->of.view != d->view
                   ? solve_with_slopes(fresh, &fresh->views[d->of.view], err)
                   : MT_OK);
        MT_TRY(modal ? mt_configuration_position(fresh, view, d->mode, d->named, &pos, err)
                     : MT_OK);
        if (modal && pos < 0) {
            return MT_OK;
        }
    }
    MT_TRY(d->ops->value(fresh, d, pos, &q, fresh->slope, err));
    double *const slopes = mt_arena_f64(&result->mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < n; i++) {
        /* slopes of logarithms are those of ln q */
        slopes[i] = (d->measure == MT_MEASURE_RATIO ? q : 1.0) * fresh->slope[i] /
                    mt_workspace_dx_dt(fresh, i);
    }
    g->sensitivity = slopes;
    return MT_OK;
}

mt_status mt_describe_slopes(mt_workspace *fresh, const mt_design *design, mt_result *result,
                             mt_recommendation *rec, mt_err *err)
{
    bool placed = false;
    for (int i = 0; i < fresh->p->n_requirements; i++) {
        const mt_requirement *const d = &fresh->p->requirements[i];
        mt_result_goal *const g = &rec->goals[i];
        mt_err own = {.code = MT_OK};
        mt_status rc = MT_OK;
        if (d->quantity == MT_QUANTITY_FREQUENCY) {
            g->sensitivity = of_frequency(rec, g);
        } else if (d->ops->value != NULL && isfinite(g->value)) {
            rc = placed ? MT_OK : mt_workspace_place(fresh, design->t, true, &own);
            placed = true;
            rc = rc == MT_OK ? of_value(fresh, d, result, g, &own) : rc;
        }
        MT_TRY(mt_pass_final(rc, &own, err)); /* else it has none */
    }
    return MT_OK;
}

/* Entries of a direction below this part of the largest are rounding. */
static const double PART_OF_DIRECTION = 1e-3;
/* The search's own tolerance where no goal sets one: residuals count as unchanged below it
 * (nlp.h). */
static const double RESIDUAL_TOLERANCE = 1e-6;

/* "K_T2", or "0.71 ln a - 0.71 ln b". */
static const char *direction_text(const mt_problem *p, const double *v, mt_arena *mem)
{
    double largest = 0.0;
    int parts = 0;
    const char *text = "";
    for (int i = 0; i < p->n; i++) {
        largest = fmax(largest, fabs(v[i]));
    }
    for (int i = 0; i < p->n; i++) {
        parts += fabs(v[i]) > PART_OF_DIRECTION * largest ? 1 : 0;
    }
    for (int i = 0; i < p->n && text != NULL; i++) {
        const char *const name = p->study->variables[i].parameter_name.s;
        if (!(fabs(v[i]) > PART_OF_DIRECTION * largest)) {
            continue;
        }
        if (parts == 1) {
            return name;
        }
        const bool first = text[0] == '\0';
        const char *const plus = first ? "" : " + ";
        const char *const minus = first ? "-" : " - ";
        text = mt_arena_printf(mem, "%s%s%.2g %s%s", text, v[i] < 0.0 ? minus : plus,
                               fabs(v[i]), MT_HAS(p->scale[i]) ? "" : "ln ", name);
    }
    return text;
}

mt_status mt_describe_unidentifiable(const mt_problem *p, const mt_nlp_result *found,
                                     mt_result *result, mt_err *err)
{
    double tolerance = RESIDUAL_TOLERANCE;
    for (int i = 0; i < p->n_requirements; i++) {
        tolerance = fmax(tolerance, p->requirements[i].tolerance);
    }
    result->unidentifiable = mt_arena_alloc(&result->mem, (size_t)found->n_unidentifiable,
                                            sizeof *result->unidentifiable);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int k = 0; k < found->n_unidentifiable; k++) {
        const double *const v = found->unidentifiable + ((ptrdiff_t)k * p->n);
        mt_unidentifiable_direction *const u = &result->unidentifiable[k];
        u->direction = mt_arena_f64(&result->mem, (size_t)p->n, 1);
        u->text = direction_text(p, v, &result->mem);
        u->effect_percent = 100.0 * tolerance * found->unidentifiable_effect[k];
        MT_TRY(mt_arena_check(&result->mem, err));
        memcpy(u->direction, v, (size_t)p->n * sizeof *v);
        result->n_unidentifiable++;
    }
    return MT_OK;
}

/* The table of frequencies of a design: for each view the modes that goals name, those between
 * bands, and the first few besides, from an analysis made anew at that design. */

/* Modes listed of a configuration beyond those that goals name. */
enum { LISTED_MODES = 4, SLACK_TEXT = 200 };

/* One configuration while its modes are listed. */
typedef struct listing {
    mt_workspace *fresh;
    const mt_design *design;
    mt_result *result;
    mt_recommendation *rec;
    /* its analysis was opened at the original design and solved here, as in the search */
    mt_configuration_work *view;
    mt_analysis *scratch; /* opened here */
    int first;            /* its first row of rec->frequencies */
} listing;

/* Vibration index of a requirement's mode at this design; 0: it has none. */
static mt_status index_of_requirement(mt_workspace *fresh, mt_configuration_work *view,
                                      const mt_requirement *d, int *index, mt_err *err)
{
    int pos = -1;
    *index = 0;
    if (!mt_requirement_is_modal(d)) {
        return MT_OK;
    }
    MT_TRY(mt_configuration_position(fresh, view, d->mode, d->named, &pos, err));
    *index = mt_modal_index(&view->analysis->modes, pos);
    return MT_OK;
}

/* Set the model's name of the mode with this index, and the certainty of its identity. */
static mt_status put_name(const listing *l, mt_result_frequency *f, mt_err *err)
{
    const mt_modes *const modes = &l->view->analysis->modes;
    for (int i = 0; i < l->view->of->n_named; i++) {
        int pos = -1;
        MT_TRY(mt_configuration_position(l->fresh, l->view, 0, i, &pos, err));
        if (pos >= 0 && mt_modal_index(modes, pos) == f->mode) {
            const mt_track *const k = &l->view->track[i];
            f->name = l->fresh->p->study->model->modes[l->view->of->named[i]].name.s;
            f->identity = mt_track_state_name(k->state);
            f->share = k->share;
            f->rival_mode = mt_modal_index(modes, k->rival);
            f->rival_share = k->rival_share;
        }
    }
    return MT_OK;
}

static mt_status describe_mode(const listing *l, int index, mt_result_frequency *f, mt_err *err)
{
    mt_analysis *const a = l->scratch;
    const int n = l->fresh->p->n;
    const int pos = mt_modal_flexible(&a->modes, index);
    *f = mt_result_frequency_default();
    f->configuration = mt_analysis_configuration(a);
    f->mode = index;
    f->sensitivity = mt_arena_f64(&l->result->mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(&l->result->mem, err));
    if (pos < 0) { /* unstable here */
        for (int i = 0; i < n; i++) {
            f->sensitivity[i] = nan("");
        }
        return MT_OK;
    }
    f->recommended_hz = mt_modal_hz(&a->modes, pos);
    const mt_tolerance_range *const range =
        mt_ranges_hz(mt_tolerance_known(l->fresh), (int)(l->view - l->fresh->views), index);
    f->lowest_hz = range != NULL ? range->value[MT_LOWEST] : nan("");
    f->highest_hz = range != NULL ? range->value[MT_HIGHEST] : nan("");
    f->residual = a->modes.residual[pos];
    f->orthogonality = a->modes.orthogonality[pos];
    MT_TRY(mt_analysis_dlambda(a, pos, f->sensitivity, &f->repeated, err));
    for (int i = 0; i < n; i++) {
        f->sensitivity[i] = mt_modal_hz_slope(f->sensitivity[i], f->recommended_hz);
    }
    char slack[SLACK_TEXT];
    if (mt_analysis_slack(a, pos, slack, sizeof slack)) {
        f->slack = mt_arena_strdup(&l->result->mem, slack);
    }
    return put_name(l, f, err);
}

static void attach_frequency(const mt_requirement *d, mt_result_frequency *f)
{
    const mt_goal *const g = d->goal;
    f->target_hz = MT_HAS(d->equals) ? d->equals : f->target_hz;
    f->at_least_hz = MT_HAS(g->at_least) ? g->at_least : f->at_least_hz;
    f->at_most_hz = MT_HAS(g->at_most) ? g->at_most : f->at_most_hz;
    if (MT_HAS(f->target_hz)) {
        f->error_percent = 100.0 * ((f->recommended_hz / f->target_hz) - 1.0);
        return;
    }
    double over = f->recommended_hz - f->recommended_hz; /* 0, or NaN with the frequency */
    over = f->recommended_hz < f->at_least_hz ? 1.0 - f->recommended_hz / f->at_least_hz : over;
    over = f->recommended_hz > f->at_most_hz ? f->recommended_hz / f->at_most_hz - 1.0 : over;
    f->error_percent = 100.0 * over;
}

/* Enter the requirement into the row of its mode. */
static mt_status attach(const listing *l, const mt_requirement *d, mt_err *err)
{
    int index = 0;
    MT_TRY(index_of_requirement(l->fresh, l->view, d, &index, err));
    index = index == 0 ? d->mode : index; /* unstable: the rows stand without frequency */
    for (int k = l->first; k < l->rec->n_frequencies; k++) {
        mt_result_frequency *const f = &l->rec->frequencies[k];
        const int pos = mt_modal_flexible(&l->scratch->modes, index);
        if (f->mode != index) {
            continue;
        }
        if (d->quantity == MT_QUANTITY_FREQUENCY) {
            attach_frequency(d, f);
        } else if (pos >= 0 && d->shape.ns > 0) {
            f->reference = d->shape.reference;
            MT_TRY(mt_reference_mac(l->scratch, pos, &d->shape, &f->mac, err));
        }
    }
    return MT_OK;
}

/* Warn of named modes of goals that are no longer identified. */
static mt_status warn_lost(const listing *l, const mt_requirement *d, mt_err *err)
{
    int index = 0;
    if (d->named < 0 || l->design->found == NULL || !l->view->solved) {
        return MT_OK;
    }
    MT_TRY(index_of_requirement(l->fresh, l->view, d, &index, err));
    const char *const why = mt_describe_identity(l->view, d->named, &l->result->mem);
    MT_TRY(mt_arena_check(&l->result->mem, err));
    if (index == 0 || why[0] == '\0') {
        return MT_OK;
    }
    return mt_describe_warn(
        l->result, err, "recommendation %d: mode \"%s\" of configuration \"%s\" is %s",
        l->design->rank, d->asked->mode_name.s, mt_analysis_configuration(l->scratch), why);
}

static mt_status count_modes(mt_workspace *fresh, int v, int *count, mt_err *err)
{
    mt_configuration_work *const view = &fresh->views[v];
    const mt_modes *const modes = &view->analysis->modes;
    int wanted = LISTED_MODES;
    *count = 0;
    if (!view->solved) {
        return MT_OK;
    }
    const int flexible = mt_modal_vibrations(modes);
    for (int i = 0; i < fresh->p->n_requirements; i++) {
        int index = 0;
        if (fresh->p->requirements[i].view == v) {
            MT_TRY(index_of_requirement(fresh, view, &fresh->p->requirements[i], &index, err));
            index = index == 0 ? fresh->p->requirements[i].mode : index;
        }
        wanted = index > wanted ? index : wanted;
    }
    const int in_reach = mt_avoidances_reach(fresh, v);
    wanted = in_reach > wanted ? in_reach : wanted;
    *count = wanted < flexible ? wanted : flexible;
    return MT_OK;
}

/* The frequency that the same mode has in the baseline: the same name, else the same index. */
static double original_hz(const mt_recommendation *baseline, const mt_result_frequency *f)
{
    for (int i = 0; baseline != NULL && i < baseline->n_frequencies; i++) {
        const mt_result_frequency *const b = &baseline->frequencies[i];
        const bool same_name =
            f->name != NULL && b->name != NULL && strcmp(f->name, b->name) == 0;
        if (strcmp(f->configuration, b->configuration) == 0 &&
            (f->name != NULL ? same_name : f->mode == b->mode)) {
            return b->recommended_hz;
        }
    }
    return baseline == NULL ? f->recommended_hz : nan("");
}

/* Note where the new analysis, with its own count of rigid-body modes, disagrees. Afterwards it
 * uses the study's count as far as possible. */
static mt_status verify(listing *l, mt_err *err)
{
    const mt_analysis *const had = l->view->analysis;
    const char *const text = mt_describe_disagreement(
        &had->modes, &l->scratch->modes, mt_analysis_configuration(had), &l->result->mem);
    MT_TRY(mt_arena_check(&l->result->mem, err));
    if (text[0] != '\0' && l->rec->disagreement == NULL) {
        l->rec->disagreement = text;
    }
    l->scratch->n_rigid = had->n_rigid;
    l->scratch->recount = true;
    return MT_OK;
}

/* Note a design that the search could analyse, but a fresh analysis cannot. */
static mt_status note_failure(const listing *l, const mt_err *why, mt_err *err)
{
    if (mt_is_final(why->code)) {
        return mt_fail(err, why->code, "%s", why->text);
    }
    if (l->rec->disagreement == NULL) {
        l->rec->disagreement =
            mt_arena_printf(&l->result->mem, "a fresh analysis fails: %s", why->text);
    }
    return mt_arena_check(&l->result->mem, err);
}

static mt_status list_view(listing *l, int v, int count, mt_err *err)
{
    mt_workspace *const fresh = l->fresh;
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = true;
    MT_TRY(verify(l, err));
    MT_TRY(mt_analysis_solve(l->scratch, fresh->x, &opt, err));
    for (int k = 1; k <= count; k++) {
        MT_TRY(describe_mode(l, k, &l->rec->frequencies[l->rec->n_frequencies], err));
        l->rec->n_frequencies++;
    }
    for (int i = 0; i < fresh->p->n_requirements; i++) {
        if (fresh->p->requirements[i].view == v) {
            MT_TRY(attach(l, &fresh->p->requirements[i], err));
            MT_TRY(warn_lost(l, &fresh->p->requirements[i], err));
        }
    }
    return describe_mac(fresh->p, v, l->scratch, count, l->result, l->rec, err);
}

mt_status mt_describe_frequencies(mt_workspace *fresh, const mt_design *design,
                                  const mt_recommendation *baseline, mt_result *result,
                                  mt_recommendation *rec, mt_err *err)
{
    size_t most = 0;
    for (int v = 0; v < fresh->c->n_views; v++) {
        int count = 0;
        MT_TRY(count_modes(fresh, v, &count, err));
        most += (size_t)count;
    }
    rec->frequencies = mt_arena_alloc(&result->mem, most, sizeof *rec->frequencies);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int v = 0; v < fresh->c->n_views; v++) {
        int count = 0;
        listing l = {.fresh = fresh, .design = design, .result = result, .rec = rec};
        l.view = &fresh->views[v];
        l.first = rec->n_frequencies;
        MT_TRY(count_modes(fresh, v, &count, err));
        if (count == 0) {
            continue;
        }
        mt_err why = {.code = MT_OK};
        const mt_system_def def =
            mt_problem_system(fresh->p, l.view->of->configuration, fresh->x);
        mt_status rc = mt_analysis_new_of(&def, 0, &l.scratch, &why);
        rc = rc == MT_OK ? list_view(&l, v, count, err) : note_failure(&l, &why, err);
        mt_analysis_delete(l.scratch);
        MT_TRY(rc);
    }
    for (int k = 0; k < rec->n_frequencies; k++) {
        rec->frequencies[k].original_hz = original_hz(baseline, &rec->frequencies[k]);
    }
    return MT_OK;
}
