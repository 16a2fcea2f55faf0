/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every goal as text, with its value, what it asks for, and whether it is met: at the design,
 * over the tolerances, and between the positions of drives. First how surely a named mode is
 * told. */
#include <math.h>
#include <string.h>

#include "describe/describe.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/evaluate.h"
#include "problem/forced_response.h"
#include "problem/frequency.h"
#include "problem/goal_frequency_response.h"
#include "problem/goals.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"
#include "search/drive_path.h"

static const double PERCENT = 100.0;
static const double HALF_TURN = 3.14159265358979323846;
static const double HALF_TURN_DEG = 180.0;
/* A phase that rises by more [rad] through a peak is no noise: a quarter turn is due. */
static const double CONJUGATED = 0.5;

/* Of two parts of a violation the greater; NaN is the greatest. */
static double greater(double a, double b)
{
    return b <= a ? a : b;
}

/* The relative deviation of the value q of a requirement from its required value; violation: in
 * the measure of its kind. */
static double relative_deviation(const mt_requirement *d, double q, double violation)
{
    const mt_goal *const g = d->goal;
    double worst = 0.0;
    if (d->measure != MT_MEASURE_RATIO) {
        return violation;
    }
    if (MT_HAS(d->equals)) {
        return fabs(q / d->equals - 1.0);
    }
    worst = MT_HAS(g->at_least) ? greater(worst, 1.0 - q / g->at_least) : worst;
    return MT_HAS(g->at_most) ? greater(worst, q / g->at_most - 1.0) : worst;
}

const char *mt_describe_identity(const mt_configuration_work *view, int named, mt_arena *mem)
{
    const mt_track *const k = &view->track[named];
    const mt_modes *const modes = &view->analysis->modes;
    const int own = mt_modal_index(modes, k->pos);
    const int rival = mt_modal_index(modes, k->rival);
    int size = 1;
    if (k->pos < 0 || k->state == MT_TRACKED) {
        return "";
    }
    if (k->state == MT_TRACK_LOST_STATE || rival == 0) {
        return mt_arena_printf(mem, "lost: mode %d, the nearest, carries %.0f %% of its shape",
                               own, PERCENT * k->share);
    }
    (void)mt_modal_cluster(modes, k->pos, &size);
    const int low = own < rival ? own : rival;
    const int high = own < rival ? rival : own;
    if (size > 1) {
        return mt_arena_printf(mem, "ambiguous between modes %d and %d of equal frequency", low,
                               high);
    }
    return mt_arena_printf(mem, "ambiguous between modes %d and %d", low, high);
}

/* True where a named mode of a requirement is identified, or its frequency, which the
 * requirement is about, is that of all candidates. */
static bool is_mode_told(const mt_configuration_work *view, const mt_requirement *d, int named)
{
    int size = 1;
    if (named < 0 || !view->solved || !view->tracked) {
        return true;
    }
    const mt_track *const k = &view->track[named];
    if (k->pos < 0 || k->state == MT_TRACKED) {
        return true; /* where there is no mode, that is the trouble */
    }
    const int first = mt_modal_cluster(&view->analysis->modes, k->pos, &size);
    const bool same_hz = k->rival >= first && k->rival < first + size;
    const bool of_hz =
        d->quantity == MT_QUANTITY_FREQUENCY || d->quantity == MT_QUANTITY_FREQUENCIES;
    return of_hz && k->state == MT_TRACK_AMBIGUOUS && same_hz;
}

/* The mode of a requirement that is not identified; NULL: all are. */
static const mt_requirement_mode *find_untold(const mt_workspace *fresh,
                                              const mt_requirement *d, mt_requirement_mode *own)
{
    *own = (mt_requirement_mode){d->asked, d->view, d->mode, d->named};
    if (!mt_requirement_is_modal(d)) {
        return NULL;
    }
    if (!is_mode_told(&fresh->views[d->view], d, d->named)) {
        return own;
    }
    return d->of.view < 0 || is_mode_told(&fresh->views[d->of.view], d, d->of.named) ? NULL
                                                                                     : &d->of;
}

/* Goals that limit a number between the positions of one drive that they name: the worst of
 * the positions that were looked at, and whether all of these keep the limit. */

static const double TWO_PI = 6.283185307179586476925;

/* "the acceleration of grip.x for base.z", "the frequency of mode 1". */
static const char *about_text(const mt_requirement *d, mt_arena *mem)
{
    if (d->of.view >= 0) {
        return mt_arena_printf(mem, "the %s of modes %d and %d", d->ops->number, d->mode,
                               d->of.mode);
    }
    return d->goal->response_limit != NULL
               ? mt_describe_response_limit(d->goal->response_limit, mem)
           : d->mode > 0 || d->ops->subject == NULL
               ? mt_arena_printf(mem, "the %s of mode %d", d->ops->number, d->mode)
               : d->ops->subject(d, mt_arena_printf(mem, "the %s", d->ops->number), mem);
}

/* Text of the worst value and its position. */
static const char *worst_text(const mt_study *study, const mt_drive_positions *f,
                              const mt_requirement *d, const mt_result_between *r,
                              mt_arena *mem)
{
    const mt_goal *const g = d->goal;
    const char *const about = about_text(d, mem);
    const mt_unit *const shown = mt_study_shown(study, f->angle ? MT_ANGLE : MT_LENGTH);
    const char *const to = mt_describe_position(study, f, r->to, mem);
    const char *const at = mt_describe_position(study, f, r->at, mem);
    if (about == NULL || to == NULL || at == NULL) {
        return NULL;
    }
    const char *const subject =
        mt_arena_printf(mem, "%s over %s from %.6g to %s (%d positions sampled)", about,
                        r->drive, mt_unit_from_si(shown, r->from), to, r->positions);
    if (subject == NULL || !MT_HAS(r->at)) {
        return subject == NULL ? NULL : mt_arena_printf(mem, "%s has no value", subject);
    }
    if (!MT_HAS(r->value) && g->response_limit == NULL) {
        return mt_arena_printf(mem, "%s is not finite at %s", subject, at);
    }
    if (!MT_HAS(r->value)) {
        return mt_arena_printf(
            mem,
            "%s is unbounded at %s: an undamped motion is excited at its natural frequency",
            subject, at);
    }
    const char *const beside = mt_describe_response_value(g, r->value, mem);
    return beside == NULL ? NULL
                          : mt_arena_printf(mem, "%s is worst at %s%s: %.4g%s%s%s%s", subject,
                                            at, r->named ? ", a named position" : "", r->value,
                                            r->value_unit[0] != '\0' ? " " : "", r->value_unit,
                                            g->response_limit != NULL
                                                ? mt_describe_response_kind(g->response_limit)
                                                : "",
                                            beside);
}

/* Text of the verdict of samples: a limit is missed where one sample misses it; where all keep
 * it, it may still be missed between them. */
static const char *verdict_text(const mt_limit_drive_path *m, const mt_result_between *r)
{
    const bool capped = m->end == MT_MOTION_CAPPED;
    if (!r->holds) {
        return "the limit does not hold over the range";
    }
    return capped ? "all of them keep the limit, as many as the evaluations allow (sampled "
                    "coarsely, not proven)"
                  : "all of them keep the limit (sampled, not proven)";
}

static const char *between_text(const mt_study *study, const mt_drive_positions *f,
                                const mt_requirement *d, const mt_limit_drive_path *m,
                                const mt_result_between *r, mt_arena *mem)
{
    const char *const worst = worst_text(study, f, d, r, mem);
    if (worst == NULL) {
        return NULL;
    }
    if (m->why != NULL) {
        const char *const where = mt_describe_position(study, f, m->broken_at, mem);
        return where == NULL
                   ? NULL
                   : mt_arena_printf(mem, "%s; not known at %s: %s", worst, where, m->why);
    }
    return mt_arena_printf(mem, "%s; %s", worst, verdict_text(m, r));
}

static mt_status describe_limit_between(const mt_workspace *fresh, const mt_requirement *d,
                                        const mt_limit_drive_path *m, mt_arena *mem,
                                        mt_result_between *out, mt_err *err)
{
    const mt_goal *const g = d->goal;
    const mt_drive_positions *const f =
        &fresh->p->families[mt_drive_positions_of(fresh->p, d->view)];
    const bool finite = m->worst.finite;
    *out = (mt_result_between){
        .pointer = mt_arena_printf(mem, "/goals/%d", d->goal_index),
        .drive = f->joint,
        .unit = f->angle ? "rad" : "m",
        .from = m->from,
        .to = m->to,
        .positions = m->positions,
        .at = m->at,
        .named = m->given,
        .value = finite ? m->worst.value : nan(""),
        .value_unit = mt_study_goal_unit(fresh->p->study, g),
        .error = finite ? m->worst.error : nan(""),
        .frequency_hz = finite ? m->worst.omega / TWO_PI : nan(""),
        .end = MT_HAS(m->at) ? m->worst.end_name : "none",
        .violation_percent =
            finite ? PERCENT * relative_deviation(d, m->worst.value, fmax(m->off, 0.0))
                   : nan(""),
        .holds = mt_is_met(m->off, d->tolerance) && m->why == NULL,
        .grade = mt_drive_path_grade(m->end)};
    out->text = between_text(fresh->p->study, f, d, m, out, mem);
    return mt_arena_check(mem, err);
}

/* Warn of a limit that is met at the named positions and missed between them. Limits that are
 * only a scale are left out. */
static mt_status warn_between(const mt_design *design, const mt_result_between *r,
                              mt_result *result, const mt_recommendation *rec, mt_err *err)
{
    if (design->found == NULL || r->holds || !rec->feasible) {
        return MT_OK;
    }
    return mt_describe_warn(
        result, err, "recommendation %d keeps the limit of %s only at the named positions: %s",
        design->rank, r->pointer, r->text);
}

mt_status mt_describe_between(mt_workspace *fresh, const mt_design *design, mt_result *result,
                              mt_recommendation *rec, mt_err *err)
{
    const mt_problem *const p = fresh->p;
    rec->between =
        mt_arena_alloc(&result->mem, (size_t)p->n_requirements, sizeof *rec->between);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        mt_limit_drive_path m = {.end = MT_MOTION_NONE};
        MT_TRY(mt_drive_positions_limits_first(p, d)
                   ? mt_drive_path_limit(fresh, d, &fresh->mem, &m, err)
                   : MT_OK);
        if (m.end != MT_MOTION_NONE) {
            mt_result_between *const row = &rec->between[rec->n_between++];
            MT_TRY(describe_limit_between(fresh, d, &m, &result->mem, row, err));
            MT_TRY(d->role == MT_ROLE_LIMIT ? warn_between(design, row, result, rec, err)
                                            : MT_OK);
        }
    }
    return MT_OK;
}

bool mt_describe_keeps_between(const mt_recommendation *rec)
{
    bool kept = true;
    for (int i = 0; i < rec->n_between; i++) {
        kept = kept && rec->between[i].holds;
    }
    return kept;
}

/* A design between the named positions of a drive: one more goal for each family of positions,
 * the row of the result, and its sentence. */

/* Less than this (ln) beyond an edge is on it: a driven position is closed, and its modes are
 * solved for, to about 1e-12. */
static const double ON_EDGE = 1e-9;

/* The mode that has to cross a band because two positions differ in the number of modes below
 * it. */
typedef struct crossing {
    int mode; /* 0: none */
    const char *band;
    const char *from; /* configurations */
    const char *to;
    int from_below;
    int to_below;
    int band_id;
} crossing;

typedef struct described {
    mt_workspace *fresh; /* views solved */
    mt_result *result;
    const mt_drive_positions *drive_positions;
    double tolerance;
    int goal_index;
    crossing cross;
    mt_drive_path motion;
    bool followed;
    double violation; /* ln; NaN: no value */
    double room;      /* the least of its motion; HUGE_VAL: none */
} described;

static mt_dimension dimension_of(const mt_drive_positions *f)
{
    return f->angle ? MT_ANGLE : MT_LENGTH;
}

/* The unit in which its positions are shown; NULL: SI. */
static const mt_unit *shown_position_unit(const described *d)
{
    return mt_study_shown(d->fresh->p->study, dimension_of(d->drive_positions));
}

static const char *si_of(const described *d)
{
    return mt_dimension_si(dimension_of(d->drive_positions));
}

const char *mt_describe_position(const mt_study *study, const mt_drive_positions *f, double at,
                                 mt_arena *mem)
{
    const mt_unit *const shown = mt_study_shown(study, dimension_of(f));
    return mt_arena_printf(mem, "%.6g %s", mt_unit_from_si(shown, at),
                           mt_unit_name(shown, mt_dimension_si(dimension_of(f))));
}

static const char *configuration_of(const described *d, const mt_avoidance *c)
{
    return mt_configuration_name(d->fresh->p, &d->fresh->p->views[c->view]);
}

/* Tied bands of two clears that have different numbers of modes below their middles.
 * below[n_bands] by the modes. */
static void find_between(described *d, const mt_avoidance *a, const mt_avoidance *b,
                         const int *below)
{
    for (int x = 0; x < a->bands.n; x++) {
        for (int y = 0; y < b->bands.n && d->cross.mode == 0; y++) {
            const int here = below[a->first + x];
            const int there = below[b->first + y];
            if (here != there &&
                d->fresh->c->tie[a->first + x] == d->fresh->c->tie[b->first + y]) {
                d->cross = (crossing){(here < there ? here : there) + 1,
                                      a->bands.items[x].label,
                                      configuration_of(d, a),
                                      configuration_of(d, b),
                                      here,
                                      there,
                                      d->fresh->c->tie[a->first + x] + 1};
            }
        }
    }
}

static void find_crossing(described *d, const int *below)
{
    const mt_workspace *const fresh = d->fresh;
    const int drive_positions = (int)(d->drive_positions - fresh->p->families);
    for (int i = 0; i < fresh->c->n_avoidances; i++) {
        for (int k = 0; k < i && mt_drive_positions_of(
                                     fresh->p, fresh->c->avoidances[i].view) == drive_positions;
             k++) {
            find_between(d, &fresh->c->avoidances[k], &fresh->c->avoidances[i], below);
        }
    }
}

/* Find whether the named positions keep their bands with one number of modes below each. If so
 * the motion is followed. */
static mt_status examine_named_positions(described *d, mt_err *err)
{
    mt_workspace *const fresh = d->fresh;
    const int drive_positions = (int)(d->drive_positions - fresh->p->families);
    int *const below = mt_arena_int(&fresh->mem, (size_t)fresh->c->n_bands);
    int *const best = mt_arena_int(&fresh->mem, (size_t)fresh->c->n_bands);
    double room = HUGE_VAL;
    MT_TRY(mt_arena_check(&fresh->mem, err));
    d->tolerance = HUGE_VAL;
    for (int i = fresh->c->n_avoidances - 1; i >= 0; i--) {
        const mt_avoidance *const c = &fresh->c->avoidances[i];
        const mt_configuration_work *const view = &fresh->views[c->view];
        const bool known =
            view->solved &&
            MT_HAS(mt_avoidance_find_modes(c, &view->analysis->modes, below + c->first));
        if (mt_drive_positions_of(fresh->p, c->view) != drive_positions) {
            continue;
        }
        d->tolerance = fmin(d->tolerance, c->tolerance);
        d->goal_index = c->goal_index;
        room = known ? room : nan("");
    }
    d->violation = nan("");
    if (!MT_HAS(room)) {
        return MT_OK; /* a position has no modes, or is unstable: its own goals say so */
    }
    find_crossing(d, below);
    for (int i = 0; i < fresh->c->n_avoidances; i++) {
        const mt_avoidance *const c = &fresh->c->avoidances[i];
        const bool own = mt_drive_positions_of(fresh->p, c->view) == drive_positions;
        for (int b = c->first; own && b < c->first + c->bands.n; b++) {
            if (fresh->c->tie[b] == b) {
                room = fmin(room, mt_tie_margin(fresh, b, &best[b]));
            }
            best[b] = best[fresh->c->tie[b]];
        }
    }
    d->violation = room >= -ON_EDGE ? 0.0 : -room;
    if (mt_is_met(d->violation, d->tolerance)) {
        d->followed = true;
        MT_TRY(
            mt_drive_path_follow(fresh, drive_positions, best, &fresh->mem, &d->motion, err));
        d->violation = d->motion.end == MT_MOTION_UNSTABLE ? nan("")
                       : d->motion.room >= -ON_EDGE        ? d->violation
                                                    : fmax(d->violation, -d->motion.room);
        d->room = fmin(d->room, d->motion.room);
    }
    return MT_OK;
}

/* Text of the samples of the mode nearest to a band. */
static const char *nearest_text(const described *d, const char *range)
{
    const mt_drive_path *const m = &d->motion;
    mt_arena *const mem = &d->result->mem;
    const mt_unit *const shown = shown_position_unit(d);
    const double at = mt_unit_from_si(shown, m->at);
    const char *const unit = mt_unit_name(shown, si_of(d));
    const char *const side = m->above ? "above" : "below";
    if (m->mode == 0) {
        return mt_arena_printf(mem, "%s (%d positions sampled): no mode beside a band", range,
                               m->positions);
    }
    if (mt_is_met(-m->room, d->tolerance)) {
        return mt_arena_printf(
            mem,
            "%s (%d positions sampled): mode %d comes nearest, at %.4g %s (%.6g Hz), %.3g %% "
            "%s band %s",
            range, m->positions, m->mode, at, unit, m->hz, m->percent, side, m->band.label);
    }
    const bool inside = m->percent < 0.0;
    return mt_arena_printf(
        mem, "%s (%d positions sampled): mode %d %s band %s, worst at %.4g %s (%.6g Hz)", range,
        m->positions, m->mode, inside ? "crosses the edge of" : "comes too near to",
        m->band.label, at, unit, m->hz);
}

static const char *end_text(const described *d)
{
    const mt_drive_path *const m = &d->motion;
    mt_arena *const mem = &d->result->mem;
    const char *const where =
        mt_describe_position(d->fresh->p->study, d->drive_positions, m->broken_at, mem);
    if (where == NULL) {
        return NULL;
    }
    switch (d->followed ? m->end : MT_MOTION_WHOLE) {
    case MT_MOTION_CAPPED:
        return "; sampled more coarsely than the slopes of the frequencies call for";
    case MT_MOTION_BROKEN:
        return mt_arena_printf(mem, "; not known at %s: %s", where, m->why);
    case MT_MOTION_UNSTABLE:
        return mt_arena_printf(mem, "; unstable at %s", where);
    case MT_MOTION_WHOLE:
    case MT_MOTION_NONE:
        break;
    }
    return d->fresh->c->tolerance_box != NULL
               ? "; tolerances are judged only at the named positions"
               : "";
}

static const char *motion_sentence(const described *d, const char *range)
{
    const crossing *const c = &d->cross;
    mt_arena *const mem = &d->result->mem;
    if (!d->followed && c->mode > 0) {
        return mt_arena_printf(
            mem,
            "mode %d crosses %s between \"%s\" and \"%s\", which have %d and "
            "%d modes below it",
            c->mode, c->band, c->from, c->to, c->from_below, c->to_below);
    }
    if (!d->followed) {
        return mt_arena_printf(mem,
                               "%s is not checked between the positions: a named position "
                               "violates its bands already",
                               range);
    }
    const char *const nearest = nearest_text(d, range);
    const char *const end = end_text(d);
    return nearest == NULL || end == NULL ? NULL : mt_arena_printf(mem, "%s%s", nearest, end);
}

static mt_status put_motion_goal(const described *d, const char *range, mt_recommendation *rec,
                                 mt_err *err)
{
    mt_result_goal *const g = &rec->goals[rec->n_goals++];
    mt_arena *const mem = &d->result->mem;
    const crossing *const c = &d->cross;
    const mt_goal *const asked = &d->fresh->p->study->goals[d->goal_index];
    *g = mt_result_goal_default();
    g->type = mt_goal_kind_of(asked->type)->name;
    g->unit = "%";
    g->value = d->followed ? d->motion.percent : nan("");
    g->at_least = d->followed ? d->motion.margin_percent : nan("");
    g->tolerance_percent = asked->tolerance_percent;
    g->violation_percent = PERCENT * d->violation;
    g->met = mt_is_met(d->violation, d->tolerance);
    g->text = c->mode > 0 && !d->followed
                  ? mt_arena_printf(mem,
                                    "%s clear of its bands: mode %d crosses %s between "
                                    "\"%s\" and \"%s\"",
                                    range, c->mode, c->band, c->from, c->to)
                  : mt_arena_printf(mem, "%s clear of its bands between the positions", range);
    g->quantity = mt_arena_strdup(mem, range);
    g->pointer = mt_arena_printf(mem, "/goals/%d", d->goal_index);
    return mt_arena_check(mem, err);
}

static mt_status put_motion_row(const described *d, const char *range, double from, double to,
                                mt_recommendation *rec, mt_err *err)
{
    mt_arena *const mem = &d->result->mem;
    const mt_drive_path *const m = &d->motion;
    const crossing *const c = &d->cross;
    mt_result_motion *const row = &rec->motions[rec->n_motions++];
    const char *const band = d->followed ? m->band.label : c->band;
    *row = mt_result_motion_default();
    row->pointer = mt_arena_printf(mem, "/goals/%d", d->goal_index);
    row->drive = mt_arena_strdup(mem, d->drive_positions->joint);
    row->unit = si_of(d);
    row->display_unit = mt_unit_name(shown_position_unit(d), NULL);
    row->display_factor = mt_unit_display(shown_position_unit(d));
    row->from = from;
    row->to = to;
    row->grade = d->followed ? mt_drive_path_grade(d->motion.end) : "not followed";
    row->mode = d->followed ? m->mode : c->mode;
    row->band = band == NULL ? NULL : mt_arena_strdup(mem, band);
    row->band_id = band == NULL ? 0 : d->followed ? m->tie + 1 : c->band_id;
    row->crosses = d->violation > 0.0 && !mt_is_met(d->violation, d->tolerance) &&
                   (d->followed || c->mode > 0);
    if (d->followed) {
        row->positions = m->positions;
        row->least_clearance_percent = m->percent;
        row->margin_percent = m->margin_percent;
        row->at = m->at;
        row->hz = m->hz;
    }
    row->text = motion_sentence(d, range);
    return mt_arena_check(mem, err);
}

static mt_status describe_drive_positions(mt_workspace *fresh, const mt_drive_positions *f,
                                          mt_result *result, mt_recommendation *rec,
                                          double *room, mt_err *err)
{
    described d = {.fresh = fresh, .result = result, .drive_positions = f, .room = HUGE_VAL};
    double from = HUGE_VAL;
    double to = -HUGE_VAL;
    d.motion.percent = nan("");
    MT_TRY(examine_named_positions(&d, err));
    *room = fmin(*room, d.room);
    for (int k = 0; k < f->n; k++) {
        from = fmin(from, mt_drive_positions_position(f, fresh->views[f->view[k]].analysis));
        to = fmax(to, mt_drive_positions_position(f, fresh->views[f->view[k]].analysis));
    }
    if (d.followed && d.motion.end == MT_MOTION_NONE) {
        return MT_OK; /* no band is asked for on both sides of a motion */
    }
    const mt_unit *const shown = shown_position_unit(&d);
    const char *const range = mt_arena_printf(
        &result->mem, "%s from %.6g to %.6g %s", f->joint, mt_unit_from_si(shown, from),
        mt_unit_from_si(shown, to), mt_unit_name(shown, si_of(&d)));
    MT_TRY(mt_arena_check(&result->mem, err));
    MT_TRY(put_motion_goal(&d, range, rec, err));
    return put_motion_row(&d, range, from, to, rec, err);
}

/* The number of families of positions of one drive that avoid bands. */
static int count_motions(const mt_problem *p)
{
    int n = 0;
    for (int i = 0; i < p->n_families; i++) {
        n += p->families[i].banded ? 1 : 0;
    }
    return n;
}

/* Each of these families is judged over its motion as an additional goal, and as a row of
 * rec->motions. After the configurations of `fresh` are solved. *room: the least margin between
 * their positions; HUGE_VAL: none. */
static mt_status describe_motions(mt_workspace *fresh, mt_result *result,
                                  mt_recommendation *rec, double *room, mt_err *err)
{
    *room = HUGE_VAL;
    const int most = count_motions(fresh->p);
    rec->motions = mt_arena_alloc(&result->mem, (size_t)most, sizeof *rec->motions);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < fresh->p->n_families; i++) {
        if (fresh->p->families[i].banded) {
            MT_TRY(describe_drive_positions(fresh, &fresh->p->families[i], result, rec, room,
                                            err));
        }
    }
    return MT_OK;
}

/* Goals over the tolerances of the variables: nominal and worst values beside each other. */

/* Ranges of modes and expressions over the tolerances of fresh's
 * design, after its configurations are solved. Nothing without tolerances. */
static mt_status find_ranges(mt_workspace *fresh, mt_err *err)
{
    if (fresh->c->tolerance_box == NULL) {
        return MT_OK;
    }
    mt_ranges *const ranges = mt_arena_alloc(&fresh->mem, 1, sizeof *ranges);
    MT_TRY(mt_arena_check(&fresh->mem, err));
    MT_TRY(mt_tolerance_ranges(fresh, &fresh->mem, ranges, err));
    fresh->tolerance_box->ranges = ranges;
    return MT_OK;
}

/* Relative distance by which a range misses a limit; negative: margin left. NaN where a value
 * is missing. */
static double beyond(const mt_tolerance_range *r, mt_tolerance_side side, double limit,
                     const mt_requirement *d)
{
    const double value = r->value[side];
    const double sign = side == MT_LOWEST ? 1.0 : -1.0;
    const bool ratio = d->measure == MT_MEASURE_RATIO;
    const double unit = mt_requirement_unit(d, limit);
    const double far = sign * (ratio ? mt_log_ratio(limit, value) : (limit - value) / unit);
    return ratio && far > MT_MOST_INSIDE ? MT_MOST_INSIDE : far; /* NaN stays */
}

/* A violation in percent of what is asked for: that of a frequency is a logarithm. */
static double percent_of(const mt_requirement *d, mt_tolerance_side side, double violation)
{
    const bool ratio = d->measure == MT_MEASURE_RATIO;
    const double below = ratio ? -expm1(-violation) : violation;
    const double above = ratio ? expm1(violation) : violation;
    return PERCENT * (side == MT_LOWEST ? below : above);
}

typedef struct verdict {
    mt_tolerance_side side; /* that the goal is judged by */
    double violation;       /* at most 0: it is met */
    double percent;
} verdict;

static verdict find_worst_side(const mt_requirement *d, const mt_tolerance_range *r)
{
    const double target = d->equals;
    const bool equal = MT_HAS(target);
    const double limit[MT_TOLERANCE_SIDES] = {equal ? target : d->goal->at_least,
                                              equal ? target : d->goal->at_most};
    verdict v = {.side = MT_LOWEST, .violation = -HUGE_VAL, .percent = -HUGE_VAL};
    for (int k = 0; k < MT_TOLERANCE_SIDES; k++) {
        const mt_tolerance_side side = (mt_tolerance_side)k;
        if (!MT_HAS(limit[k]) || !MT_HAS(v.percent)) {
            continue;
        }
        const double far = beyond(r, side, limit[k], d);
        const double percent = percent_of(d, side, far);
        v.side = percent > v.percent || !MT_HAS(percent) ? side : v.side;
        v.violation = far > v.violation || !MT_HAS(far) ? far : v.violation;
        v.percent = percent > v.percent || !MT_HAS(percent) ? percent : v.percent;
    }
    if (equal &&
        d->measure == MT_MEASURE_RATIO) { /* within the tolerance as a part of the target */
        v.violation = v.percent / PERCENT;
    }
    return v;
}

/* Judge a requirement by its worst value, which goes into g. *violation (relative) and *percent
 * (of the required value): in: at the design; out: at the worst. */
static mt_status judge_worst(mt_workspace *fresh, const mt_requirement *d, mt_result *result,
                             mt_result_goal *g, double *violation, double *percent, mt_err *err)
{
    const mt_ranges *const known = mt_tolerance_known(fresh);
    if (known == NULL || d->role == MT_ROLE_RESIDUAL) {
        return MT_OK; /* without tolerances, or the design itself could not be evaluated */
    }
    const mt_tolerance_range *const r =
        d->view >= 0 ? mt_ranges_hz(known, d->view, d->mode) : &known->number[d->index];
    if (r == NULL) {
        return MT_OK;
    }
    const verdict v = find_worst_side(d, r);
    if (d->role != MT_ROLE_TARGET) {
        *violation =
            v.violation > *violation || !MT_HAS(v.violation) ? v.violation : *violation;
        *percent = v.percent > *percent || !MT_HAS(v.percent) ? v.percent : *percent;
    }
    g->worst = r->value[v.side];
    g->worst_at = mt_arena_f64(&result->mem, (size_t)fresh->p->n, 1);
    MT_TRY(mt_arena_check(&result->mem, err));
    memcpy(g->worst_at, r->at[v.side], (size_t)fresh->p->n * sizeof *g->worst_at);
    return MT_OK;
}

/* Every goal: solved, judged, put into words. */

/* "installed mode 1", "installed \"heave\"", or the expression. */
static const char *quantity_text(const mt_problem *p, const mt_requirement *d, mt_arena *mem)
{
    if (d->view < 0) {
        return d->goal->expression_text;
    }
    const char *const configuration = mt_configuration_name(p, &p->views[d->view]);
    if (!mt_requirement_is_modal(d)) {
        return configuration;
    }
    return d->mode > 0
               ? mt_arena_printf(mem, "%s mode %d", configuration, d->mode)
               : mt_arena_printf(mem, "%s \"%s\"", configuration, d->asked->mode_name.s);
}

/* " from a to b Hz", " at least a Hz", " at most b Hz", " at a Hz as mode 2 of \"fe\"", or
 * nothing. */
static const char *interval_text(const mt_problem *p, const mt_requirement *d, mt_arena *mem)
{
    const mt_goal *const g = d->goal;
    const mt_unit *const shown = mt_study_requirement_unit(p->study, &g->expression);
    const char *const name = mt_unit_name(shown, mt_study_goal_unit(p->study, g));
    const char *const unit = mt_arena_printf(mem, "%s%s", name[0] != '\0' ? " " : "", name);
    const bool least = MT_HAS(g->at_least);
    const double equals = mt_unit_from_si(shown, d->equals);
    const double low = mt_unit_from_si(shown, g->at_least);
    const double high = mt_unit_from_si(shown, g->at_most);
    const double number = least ? low : high;
    if (unit == NULL) {
        return NULL;
    }
    if (MT_HAS(d->equals) && d->shape.reference != NULL) {
        return mt_arena_printf(mem, " %s %.10g%s as mode %d of \"%s\"", d->ops->equals, equals,
                               unit, d->shape.mode, d->shape.reference);
    }
    if (MT_HAS(d->equals)) {
        return mt_arena_printf(mem, " %s %.10g%s", d->ops->equals, equals, unit);
    }
    if (least && MT_HAS(g->at_most)) {
        return mt_arena_printf(mem, " from %.10g to %.10g%s", low, high, unit);
    }
    if (!MT_HAS(number)) {
        return "";
    }
    return mt_arena_printf(mem, " at %s %.10g%s", least ? "least" : "most", number, unit);
}

/* Texts of the quantity that a requirement limits, and of the whole requirement. */
static void name_goal(const mt_problem *p, const mt_requirement *d, mt_arena *mem,
                      mt_result_goal *g)
{
    const char *const quantity = quantity_text(p, d, mem);
    const char *const interval = interval_text(p, d, mem);
    g->quantity = quantity == NULL || d->ops->subject == NULL
                      ? quantity
                      : d->ops->subject(d, quantity, mem);
    g->text = g->quantity == NULL || interval == NULL
                  ? NULL
                  : mt_arena_printf(mem, "%s%s", g->quantity, interval);
}

/* Relative violation of a requirement that has been evaluated, that of a frequency a logarithm;
 * of a shape its distance. */
static double requirement_violation(const mt_workspace *fresh, const mt_requirement *d,
                                    const mt_nlp_values *v, double own_worst)
{
    const int row = mt_requirement_row(fresh->c, d);
    double worst = 0.0;
    if (d->role == MT_ROLE_RESIDUAL) {
        return mt_norm2(d->n_rows, fresh->r + row) / sqrt(d->goal->weight);
    }
    if (d->role == MT_ROLE_TARGET) {
        return fabs(v->eq[row]);
    }
    if (d->role == MT_ROLE_VIBRATION) {
        return fmax(own_worst, 0.0); /* of this requirement alone */
    }
    for (int k = 0; k < d->n_rows; k++) {
        worst = greater(worst, -v->in[row + k]);
    }
    return worst;
}

/* Solve all views; the first that fails otherwise than by memory is told in `why`. */
static mt_status solve_views(mt_workspace *fresh, mt_err *why, mt_err *err)
{
    for (int i = 0; i < fresh->c->n_views; i++) {
        mt_configuration_work *const view = &fresh->views[i];
        mt_err own = {0};
        mt_configuration_query_all(view);
        view->ask.vectors = view->ask.vectors || view->of->n_named > 0;
        const mt_status rc = mt_configuration_solve(fresh, view, false, &own);
        if (mt_is_final(rc)) {
            return mt_fail(err, rc, "%s", own.text);
        }
        if (rc != MT_OK && why->code == MT_OK) {
            *why = own;
        }
    }
    mt_err own = {0};
    const mt_status rc = why->code == MT_OK ? find_ranges(fresh, &own) : MT_OK;
    *why = rc != MT_OK ? own : *why;
    return mt_pass_final(rc, &own, err);
}

/* Warn that the mode of the goal is not identified: the goal is not met, for any value. */
static mt_status warn_unidentified(const mt_workspace *fresh, const mt_requirement_mode *mode,
                                   mt_result *result, mt_result_goal *g, mt_err *err)
{
    const char *const why =
        mt_describe_identity(&fresh->views[mode->view], mode->named, &result->mem);
    g->met = false;
    g->text = mt_arena_printf(&result->mem, "%s, %s", g->text, why);
    g->doubtful = true;
    return mt_arena_check(&result->mem, err);
}

/* Write quantity and requirement in numbers. */
static void write_what(const mt_problem *p, const mt_requirement *d, mt_result_goal *g)
{
    const mt_goal *const asked = d->goal;
    const mt_goal_kind *const kind = mt_goal_kind_of(asked->type);
    g->type = kind->name;
    const char *const unit = mt_study_goal_unit(p->study, asked);
    const mt_unit *const shown = mt_study_requirement_unit(p->study, &asked->expression);
    g->unit = d->view < 0 && unit[0] == '\0' ? NULL : unit;
    g->display_unit = mt_unit_name(shown, NULL);
    g->display_factor = mt_unit_display(shown);
    g->expression = d->view < 0 ? asked->expression_text : NULL;
    g->reference = asked->response_limit != NULL ? asked->response_limit->measurement_name.s
                                                 : asked->reference_name.s;
    if (d->view >= 0) {
        g->configuration = mt_configuration_name(p, &p->views[d->view]);
    }
    if (mt_requirement_is_modal(d)) {
        g->mode = d->mode;
        g->name = d->mode > 0 ? NULL : d->asked->mode_name.s;
    }
    if (d->of.view >= 0) {
        g->of_configuration = mt_configuration_name(p, &p->views[d->of.view]);
        g->of_mode = d->of.mode;
        g->of_name = d->of.mode > 0 ? NULL : d->of.asked->mode_name.s;
    }
    g->at_least = asked->at_least;
    g->at_most = asked->at_most;
    g->target = d->ops->value == NULL ? 0.0 : d->equals; /* a distance is to be none */
    g->tolerance_percent = asked->tolerance_percent;
}

/* Write the measured line of the largest deviation. */
static void write_line(const mt_workspace *fresh, const mt_requirement *d, mt_result_goal *g)
{
    double complex off = 0.0;
    if (mt_fit_worst(fresh, d, &g->off_most_hz, &off)) {
        g->off_most_ratio = exp(creal(off));
        g->off_most_phase_deg = cimag(off) / HALF_TURN * HALF_TURN_DEG;
    }
}

static mt_status describe_requirement(mt_workspace *fresh, const mt_requirement *d,
                                      mt_nlp_values *v, mt_result *result, mt_result_goal *g,
                                      mt_err *why, mt_err *err)
{
    mt_err own = {0};
    double violation = nan("");
    double percent = nan("");
    *g = mt_result_goal_default();
    write_what(fresh->p, d, g);
    const double others = fresh->worst;
    const bool residual = d->role == MT_ROLE_RESIDUAL;
    const bool vibration = d->role == MT_ROLE_VIBRATION;
    fresh->worst = -HUGE_VAL;
    const mt_status rc = mt_requirement_eval(fresh, d, false, v, &g->value, &own);
    if (mt_is_final(rc)) {
        return mt_fail(err, rc, "%s", own.text);
    }
    if (rc == MT_OK) {
        const double own_worst = fresh->worst;
        const bool none = vibration && !isfinite(g->value); /* a resonance undamped */
        fresh->worst = none || isnan(others) ? nan("") : fmax(others, own_worst);
        violation = requirement_violation(fresh, d, v, own_worst);
        g->value = isfinite(g->value) ? g->value : nan(""); /* a mode at infinity has none */
        percent = PERCENT * relative_deviation(d, g->value, violation);
        write_line(fresh, d, g);
        MT_TRY(judge_worst(fresh, d, result, g, &violation, &percent, err));
    } else {
        g->value = nan("");
        fresh->worst = vibration ? nan("") : others;
        *why = why->code == MT_OK ? own : *why;
        for (int i = 0; i < d->n_rows && residual; i++) {
            /* nor is the misfit known */
            fresh->r[mt_requirement_row(fresh->c, d) + i] = nan("");
        }
    }
    g->weighted = residual || vibration;
    name_goal(fresh->p, d, &result->mem, g);
    g->pointer = mt_arena_printf(&result->mem, "/goals/%d", d->goal_index);
    g->violation_percent = percent;
    g->met = mt_is_met(violation, d->tolerance);
    MT_TRY(mt_arena_check(&result->mem, err));
    mt_requirement_mode first;
    const mt_requirement_mode *const untold = find_untold(fresh, d, &first);
    return untold == NULL ? MT_OK : warn_unidentified(fresh, untold, result, g, err);
}

/* Write the length at which angles count as arcs, where sensors of a MAC or a shape mix
 * displacements and angles and the study does not give it. */
static mt_status write_length(const mt_requirement *d, const mt_design *design,
                              mt_result *result, mt_err *err)
{
    return design->found != NULL || d->shape.scale == NULL || MT_HAS(d->goal->length)
               ? MT_OK
               : mt_describe_warn(result, err,
                                  "/goals/%d: the sensors of \"%s\" mix displacements and "
                                  "rotations: a rotation counts as its arc at %.4g m, the "
                                  "model's length (\"length_m\" of the goal chooses another)",
                                  d->goal_index, d->shape.reference, d->shape.length);
}

/* Warn of measured data that fit no mechanism: where the original design or the best one shows
 * it. */
static mt_status warn_data(const mt_workspace *fresh, const mt_requirement *d,
                           const mt_design *design, mt_result *result, mt_err *err)
{
    double hz = 0.0;
    const double rise = design->found == NULL ? mt_fit_rise(d, &hz) : 0.0;
    if (rise > CONJUGATED) {
        MT_TRY(mt_describe_warn(
            result, err,
            "/goals/%d: the data look conjugated: through the peak at %.6g Hz the measured "
            "phase rises by %.0f degrees, where that of a damped mechanism falls; check the "
            "sign convention of the phase, exp(i w t) or exp(-i w t)",
            d->goal_index, hz, rise * HALF_TURN_DEG / HALF_TURN));
    }
    return design->rank <= 1 && mt_fit_is_reversed(fresh, d)
               ? mt_describe_warn(result, err,
                                  "/goals/%d: the data look reversed: with the other sign of "
                                  "the measured response its phases would fit better; check "
                                  "the direction of the sensor and of the force",
                                  d->goal_index)
               : MT_OK;
}

mt_status mt_describe_goals(mt_workspace *fresh, const mt_design *design, mt_result *result,
                            mt_recommendation *rec, double *motion_margin, mt_err *err)
{
    mt_nlp_values v;
    mt_err why = {.code = MT_OK};
    const size_t most = (size_t)fresh->p->n_requirements +
                        (size_t)mt_describe_avoid_count(fresh->p) +
                        (size_t)count_motions(fresh->p);
    rec->goals = mt_arena_alloc(&result->mem, most, sizeof *rec->goals);
    rec->feasible = true;
    rec->violation_percent = 0.0;
    MT_TRY(mt_arena_check(&result->mem, err));
    MT_TRY(mt_subproblem_values_init(fresh->c, &fresh->mem, &v, err));
    MT_TRY(mt_workspace_place(fresh, design->t, false, err));
    MT_TRY(solve_views(fresh, &why, err));
    for (int i = 0; i < fresh->p->n_requirements; i++) {
        MT_TRY(describe_requirement(fresh, &fresh->p->requirements[i], &v, result,
                                    &rec->goals[i], &why, err));
        MT_TRY(write_length(&fresh->p->requirements[i], design, result, err));
        MT_TRY(warn_data(fresh, &fresh->p->requirements[i], design, result, err));
        rec->n_goals++;
    }
    MT_TRY(mt_describe_avoid_goals(fresh, result, rec, err));
    MT_TRY(describe_motions(fresh, result, rec, motion_margin, err));
    for (int i = 0; i < rec->n_goals; i++) {
        const mt_result_goal *const g = &rec->goals[i];
        if (!g->weighted) {
            const bool worse = !(g->violation_percent <= rec->violation_percent);
            rec->feasible = rec->feasible && g->met;
            rec->violation_percent = worse ? g->violation_percent : rec->violation_percent;
        } else if (!(g->violation_percent >= 0.0)) {
            rec->feasible = false; /* a residual without a value: the misfit has none */
        }
    }
    if (why.code == MT_OK) {
        return MT_OK;
    }
    rec->violation_percent = nan("");
    const char *const where =
        design->found == NULL
            ? "the original design"
            : mt_arena_printf(&result->mem, "recommendation %d", design->rank);
    return where == NULL ? mt_fail_memory(err)
                         : mt_describe_warn(result, err, "not all goals have a value at %s: %s",
                                            where, why.text);
}
