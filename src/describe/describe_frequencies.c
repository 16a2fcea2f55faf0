/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of frequencies of a design: for each view the modes that goals name, those between
 * bands, and the first few besides, from an analysis made anew at that design. */
#include <math.h>
#include <string.h>

#include "analysis/count.h"
#include "describe/describe.h"
#include "problem/configuration.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"

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
        l->design->rank, d->goal->mode.mode_name.s, mt_analysis_configuration(l->scratch), why);
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
    return mt_describe_mac(fresh->p, v, l->scratch, count, l->result, l->rec, err);
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
