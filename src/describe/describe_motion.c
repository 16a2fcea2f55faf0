/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design between the named positions of a drive: one more goal for each family of positions,
 * the row of the result, and its sentence. */
#include <math.h>

#include "describe/describe.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "search/drive_path.h"

/* Less than this (ln) beyond an edge is on it: a driven position is closed, and its modes are
 * solved for, to about 1e-12. */
static const double ON_EDGE = 1e-9;
static const double PERCENT = 100.0;

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

static const char *sentence(const described *d, const char *range)
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

static mt_status put_goal(const described *d, const char *range, mt_recommendation *rec,
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

static mt_status put_row(const described *d, const char *range, double from, double to,
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
    row->text = sentence(d, range);
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
        from = fmin(from, mt_drive_positions_position(fresh->views[f->view[k]].analysis));
        to = fmax(to, mt_drive_positions_position(fresh->views[f->view[k]].analysis));
    }
    if (d.followed && d.motion.end == MT_MOTION_NONE) {
        return MT_OK; /* no band is asked for on both sides of a motion */
    }
    const mt_unit *const shown = shown_position_unit(&d);
    const char *const range = mt_arena_printf(
        &result->mem, "%s from %.6g to %.6g %s", f->joint, mt_unit_from_si(shown, from),
        mt_unit_from_si(shown, to), mt_unit_name(shown, si_of(&d)));
    MT_TRY(mt_arena_check(&result->mem, err));
    MT_TRY(put_goal(&d, range, rec, err));
    return put_row(&d, range, from, to, rec, err);
}

int mt_describe_motion_count(const mt_problem *p)
{
    int n = 0;
    for (int i = 0; i < p->n_families; i++) {
        n += p->families[i].banded ? 1 : 0;
    }
    return n;
}

mt_status mt_describe_motions(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                              double *room, mt_err *err)
{
    *room = HUGE_VAL;
    const int most = mt_describe_motion_count(fresh->p);
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
