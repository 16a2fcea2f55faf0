/* SPDX-License-Identifier: GPL-3.0-or-later */

#include "problem/tolerance_cut.h"

#include <math.h>
#include <string.h>

#include "base/run.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/evaluate.h"
#include "problem/requirement.h"

/* Factors that differ by less are those of one corner: rounding of x (1 + tolerance) / x. */
static const double SAME_FACTOR = 1e-12;
/* A row keeps this many times the way to the corner that its slopes name, and as many times the
 * largest tolerance (where slopes vanish the way is short): worse points, three times as far,
 * are not looked for before the design is described. */
static const double FAR = 2.0;
/* Once is enough where the slopes at the corner agree with those at the design: the sums
 * of their effects differ by no more than this share, and effects that turn make up no
 * more. What is almost linear is nowhere twice as far as at its corner. */
static const double AGREE = 0.25;

/* Margin of the row for the value `value`: relative, for frequencies logarithmic; negative:
 * violated. Without the clearance. */
static double row_margin(const mt_subproblem *c, const mt_row *row, double value)
{
    const double sign = mt_row_sign(row);
    if (row->view >= 0) {
        return sign * -mt_log_ratio(row->limit, value);
    }
    return sign * (value - row->limit) /
           mt_requirement_unit(&c->requirements[row->requirement], row->limit);
}

/* True where two rows limit one value on one side, at two corners. */
static bool is_same(const mt_row *a, const mt_row *b)
{
    return a->requirement == b->requirement && a->sense == b->sense &&
           a->avoidance == b->avoidance && a->band == b->band && a->mode == b->mode;
}

static bool same_factor(int n, const double *a, const double *b)
{
    for (int i = 0; i < n; i++) {
        if (!(fabs(a[i] - b[i]) <= SAME_FACTOR)) {
            return false;
        }
    }
    return true;
}

/* True where a search with these cuts has the corners of a set as well. */
static bool has_corners(const mt_subproblem *c, const mt_tolerance_cuts *cuts, int view,
                        const mt_tolerance_corners *set)
{
    bool has = !cuts->alone || set->exact || view < 0;
    for (int i = 0; i < c->p->n_requirements && !has; i++) {
        has = c->p->requirements[i].view == view && c->p->requirements[i].role == MT_ROLE_RANGE;
    }
    return has;
}

/* Adds the corner where the value of a row is worst, unless it is one already. */
static mt_status add_cut(const mt_workspace *w, const mt_row *row, const double *at,
                         mt_arena *mem, mt_tolerance_cuts *cuts, mt_err *err)
{
    const mt_subproblem *const c = w->c;
    const int n = c->p->n;
    const int view = row->view;
    const mt_tolerance_corners *const set = mt_tolerance_corners_of(c, view, row->requirement);
    double *const factor = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        factor[i] = w->x[i] != 0.0 ? at[i] / w->x[i] : 1.0;
    }
    const int n_known = has_corners(c, cuts, view, set) ? set->n : 0;
    for (int k = 0; k < n_known; k++) {
        const mt_tolerance_corner *const known = &set->corners[k];
        if (known->may[row->sense] && same_factor(n, known->factor, factor)) {
            return MT_OK;
        }
    }
    for (int k = 0; k < cuts->n; k++) {
        mt_tolerance_cut *const known = &cuts->items[k];
        const bool own =
            known->view == view && (view >= 0 || known->requirement == row->requirement);
        if (own && same_factor(n, known->factor, factor)) {
            cuts->added += known->may[row->sense] ? 0 : 1;
            known->may[row->sense] = true;
            return MT_OK;
        }
    }
    mt_tolerance_cut *const grown =
        mt_arena_grow(mem, cuts->items, cuts->n, &cuts->room, sizeof *grown);
    MT_TRY(mt_arena_check(mem, err));
    cuts->items = grown;
    grown[cuts->n] =
        (mt_tolerance_cut){.view = view, .requirement = row->requirement, .factor = factor};
    grown[cuts->n++].may[row->sense] = true;
    cuts->added++;
    return MT_OK;
}

/* Range over the tolerances of the value that a row limits; NULL: not available. */
static const mt_tolerance_range *range_of(const mt_ranges *ranges, const mt_row *row)
{
    return row->view >= 0 ? mt_ranges_hz(ranges, row->view, row->mode)
                          : &ranges->number[row->requirement];
}

static mt_status verify_tolerance_rows(const mt_workspace *w, const mt_ranges *ranges,
                                       mt_nlp_values *v, mt_arena *mem, mt_tolerance_cuts *cuts,
                                       mt_err *err)
{
    const mt_subproblem *const c = w->c;
    int before = -1;
    for (int k = mt_tolerance_next_row(c, 0); k >= 0; k = mt_tolerance_next_row(c, k + 1)) {
        const mt_row *const row = &c->rows.in.rows[k];
        const bool again = before >= 0 && is_same(&c->rows.in.rows[before], row);
        before = k;
        const mt_tolerance_range *const range =
            again || !mt_tolerance_row_is_sampled(c, row) ? NULL : range_of(ranges, row);
        if (range == NULL) {
            continue;
        }
        const double room = row_margin(c, row, range->value[row->sense]);
        const double wanted = row->requirement < 0 && c->clearance ? w->t[c->p->n] : 0.0;
        mt_miss(&cuts->missed, mt_short_of(room), row->tolerance);
        cuts->band_margin =
            row->requirement < 0 ? fmin(cuts->band_margin, room) : cuts->band_margin;
        v->in[k] = fmin(v->in[k], room - wanted);
        /* where it has no value no row leads on */
        if (room - wanted < -row->tolerance) {
            MT_TRY(add_cut(w, row, range->at[row->sense], mem, cuts, err));
        }
    }
    return MT_OK;
}

static void begin_judging(mt_tolerance_cuts *cuts)
{
    cuts->added = 0;
    cuts->missed = (mt_missed){0.0, 0.0};
    cuts->band_margin = HUGE_VAL;
}

/* leave: [n_views of the problem] configurations whose rows are far from their limits; NULL:
 * none. */
static mt_status lower(mt_workspace *w, mt_nlp_values *v, const bool *leave, mt_arena *mem,
                       mt_tolerance_cuts *cuts, mt_err *err)
{
    mt_arena own;
    mt_ranges ranges = {.solutions = 0};
    begin_judging(cuts);
    if (!mt_tolerance_is_sampled(w->c)) {
        return MT_OK;
    }
    MT_TRY(mt_arena_init(&own, 0, err));
    mt_status rc = mt_tolerance_ranges_of_rows(w, leave, &own, &ranges, err);
    /* what is cut off has no value at some sample: nothing is known */
    rc = rc == MT_OK ? mt_interrupt_check(w->p->run->interrupt, err) : rc;
    rc = rc == MT_OK ? verify_tolerance_rows(w, &ranges, v, mem, cuts, err) : rc;
    cuts->solutions += ranges.solutions;
    mt_arena_free(&own);
    return rc;
}

mt_status mt_tolerance_lower(mt_workspace *w, mt_nlp_values *v, mt_arena *mem,
                             mt_tolerance_cuts *cuts, mt_err *err)
{
    return lower(w, v, NULL, mem, cuts, err);
}

/* slope[n] := slopes of a mode, raw; false: it has none. */
static bool find_slopes(mt_analysis *a, int mode, double *slope)
{
    const int pos = mt_modal_flexible(&a->modes, mode);
    mt_err own = {.code = MT_OK};
    return pos >= 0 && mt_analysis_dlambda_raw(a, pos, slope, &own) == MT_OK;
}

/* Half the width of the tolerance of variable i at the design of w. */
static double half_width(const mt_workspace *w, int i)
{
    return mt_tolerance_of_variable(w->p, i) * fabs(w->x[i]);
}

/* x[n] := the corner that is worst to first order for the mode of a row at the design that w
 * was evaluated at with slopes, which are in tolerance_box->slope then; false: it has none. */
static bool name_worst(mt_workspace *w, const mt_row *row, int mode, double *x)
{
    const double *const slope = w->tolerance_box->slope;
    if (!find_slopes(w->views[row->view].analysis, mode, w->tolerance_box->slope)) {
        return false;
    }
    for (int i = 0; i < w->p->n; i++) {
        const bool low = (slope[i] > 0.0) == (row->sense == MT_AT_LEAST);
        x[i] = w->x[i] + (low ? -half_width(w, i) : half_width(w, i));
    }
    return true;
}

/* True where the slopes at the corner, of the analysis a, are those at the design but for a
 * small share: over the tolerances the mode changes almost linearly. slope[n]: work. */
static bool slopes_agree(const mt_workspace *w, mt_analysis *a, int mode, double *slope)
{
    double here = 0.0;
    double there = 0.0;
    double other = 0.0; /* of the other sign */
    if (!find_slopes(a, mode, slope)) {
        return false;
    }
    for (int i = 0; i < w->p->n; i++) {
        const double half = half_width(w, i);
        const double effect = half * fabs(slope[i]);
        const bool turns = slope[i] * w->tolerance_box->slope[i] < 0.0;
        here += half * fabs(w->tolerance_box->slope[i]);
        there += effect;
        other += turns ? effect : 0.0;
    }
    return fabs(there - here) <= AGREE * here && other <= AGREE * here;
}

static double largest_tolerance(const mt_problem *p)
{
    double most = 0.0;
    for (int i = 0; i < p->n; i++) {
        most = fmax(most, mt_tolerance_of_variable(p, i));
    }
    return most;
}

/* Evaluates a row of a mode at the corner given by its slopes, with an analysis of a corner.
 * *far: its limit holds there by a wide margin. */
static mt_status verify_first(mt_workspace *w, const mt_row *row, double *x, mt_arena *mem,
                              mt_tolerance_cuts *cuts, bool *far, mt_err *err)
{
    const mt_subproblem *const c = w->c;
    const int mode = row->mode;
    const mt_configuration_work *const view = &w->views[row->view];
    const mt_analysis_options opt = mt_configuration_queries(w, view, true);
    mt_analysis *const a = view->corners[0];
    mt_err own = {.code = MT_OK};
    *far = false;
    if (!name_worst(w, row, mode, x)) {
        return MT_OK;
    }
    mt_problem_note_modal(w->p, 1);
    cuts->solutions++;
    const mt_status rc = mt_analysis_solve(a, x, &opt, &own);
    const int pos = rc == MT_OK ? mt_modal_flexible(&a->modes, mode) : -1;
    MT_TRY(mt_pass_final(rc, &own, err));
    if (pos < 0) {
        return MT_OK; /* what is not there is judged by samples */
    }
    const double room = row_margin(c, row, mt_modal_hz(&a->modes, pos));
    const double wanted = row->requirement < 0 && c->clearance ? w->t[c->p->n] : 0.0;
    const mt_modes *const modes = &view->analysis->modes;
    const double here = row_margin(c, row, mt_modal_hz(modes, mt_modal_flexible(modes, mode)));
    const double way = fmax(fabs(here - room), largest_tolerance(w->p));
    /* of bands the least room is asked for, wherever it is */
    *far = (row->requirement >= 0 || c->clearance) && room - wanted > FAR * way;
    if (!*far && row->requirement >= 0 && room - wanted > fabs(here - room)) {
        double *const slope = mt_arena_f64(mem, (size_t)w->p->n, 1);
        MT_TRY(mt_arena_check(mem, err));
        *far = slopes_agree(w, a, mode, slope);
    }
    if (room - wanted < -row->tolerance) {
        mt_miss(&cuts->missed, mt_short_of(room), row->tolerance);
        MT_TRY(add_cut(w, row, x, mem, cuts, err));
    }
    return MT_OK;
}

/* All rows of modes evaluated at sampled corners. far: [n_views of the problem] all rows of a
 * configuration hold by a wide margin. */
static mt_status verify_by_slopes(mt_workspace *w, mt_arena *mem, mt_tolerance_cuts *cuts,
                                  bool *far, mt_err *err)
{
    const mt_subproblem *const c = w->c;
    int before = -1;
    double *const x = mt_arena_f64(mem, (size_t)c->p->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < c->p->n_views; i++) {
        far[i] = true;
    }
    for (int k = mt_tolerance_next_row(c, 0); k >= 0; k = mt_tolerance_next_row(c, k + 1)) {
        const mt_row *const row = &c->rows.in.rows[k];
        const int view = row->view;
        const bool again = before >= 0 && is_same(&c->rows.in.rows[before], row);
        bool own = false;
        before = k;
        if (!again && mt_tolerance_row_is_sampled(c, row) && view >= 0) {
            MT_TRY(verify_first(w, row, x, mem, cuts, &own, err));
            far[view] = far[view] && own;
        }
    }
    return MT_OK;
}

static mt_status verify(mt_workspace *w, const double *t, bool by_slopes, mt_arena *mem,
                        mt_tolerance_cuts *cuts, mt_err *err)
{
    mt_nlp_values v;
    begin_judging(cuts);
    cuts->solutions = 0;
    if (!mt_tolerance_is_sampled(w->c)) {
        return MT_OK;
    }
    bool *const far = mt_arena_alloc(mem, (size_t)w->p->n_views, sizeof *far);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_subproblem_values_init(w->c, mem, &v, err));
    MT_TRY(mt_workspace_eval(w, t, true, &v, err));
    MT_TRY(verify_by_slopes(w, mem, cuts, far, err));
    return cuts->added > 0 || by_slopes ? MT_OK : lower(w, &v, far, mem, cuts, err);
}

mt_status mt_tolerance_verify(mt_workspace *w, const double *t, mt_arena *mem,
                              mt_tolerance_cuts *cuts, mt_err *err)
{
    return verify(w, t, false, mem, cuts, err);
}

mt_status mt_tolerance_verify_by_slopes(mt_workspace *w, const double *t, mt_arena *mem,
                                        mt_tolerance_cuts *cuts, mt_err *err)
{
    return verify(w, t, true, mem, cuts, err);
}

/* The corners of one set, and those of its cuts. */
static mt_status extend(const mt_subproblem *c, const mt_tolerance_cuts *cuts, int view,
                        int requirement, mt_arena *mem, mt_tolerance_corners *out, mt_err *err)
{
    const size_t n = (size_t)c->p->n;
    const mt_tolerance_corners *const set = mt_tolerance_corners_of(c, view, requirement);
    *out = *set;
    out->n = has_corners(c, cuts, view, set) ? set->n : 0;
    out->corners = mt_arena_alloc(mem, (size_t)out->n + (size_t)cuts->n, sizeof *out->corners);
    MT_TRY(mt_arena_check(mem, err));
    if (out->n > 0) {
        memcpy(out->corners, set->corners, (size_t)out->n * sizeof *out->corners);
    }
    for (int k = 0; k < cuts->n; k++) {
        const mt_tolerance_cut *const cut = &cuts->items[k];
        if (cut->view != view || (view < 0 && cut->requirement != requirement)) {
            continue;
        }
        mt_tolerance_corner *const corner = &out->corners[out->n++];
        *corner = (mt_tolerance_corner){.factor = mt_arena_f64(mem, n, 1),
                                        .may = {cut->may[MT_LOWEST], cut->may[MT_HIGHEST]}};
        MT_TRY(mt_arena_check(mem, err));
        memcpy(corner->factor, cut->factor, n * sizeof *corner->factor);
    }
    return MT_OK;
}

mt_status mt_tolerance_add_cuts(const mt_subproblem *c, const mt_tolerance_cuts *cuts,
                                mt_arena *mem, mt_problem_tolerance_box **out, mt_err *err)
{
    const size_t n_views = (size_t)c->p->n_views;
    const size_t n_requirements = (size_t)c->p->n_requirements;
    mt_problem_tolerance_box *const r = mt_arena_alloc(mem, 1, sizeof *r);
    MT_TRY(mt_arena_check(mem, err));
    *r = (mt_problem_tolerance_box){.views = mt_arena_alloc(mem, n_views, sizeof *r->views),
                                    .limits =
                                        mt_arena_alloc(mem, n_requirements, sizeof *r->limits),
                                    .sampled_later = cuts->alone};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < c->p->n_views; i++) {
        MT_TRY(extend(c, cuts, i, -1, mem, &r->views[i], err));
    }
    for (int i = 0; i < c->p->n_requirements; i++) {
        MT_TRY(extend(c, cuts, -1, i, mem, &r->limits[i], err));
    }
    *out = r;
    return MT_OK;
}
