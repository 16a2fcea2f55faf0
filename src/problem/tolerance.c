/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which corners of the tolerances may be the worst, which goals can be judged there, and their
 * rows. */

#include "problem/tolerance.h"

#include <math.h>
#include <string.h>

#include "analysis/count.h"
#include "problem/avoidance.h"
#include "problem/configuration.h"
#include "problem/frequency.h"
#include "problem/requirement.h"
#include "problem/tolerance_cut.h"
#include "prove/enclosure.h"

/* All combinations of so many variables whose sign is not known; of more: all low, all high,
 * and each alone against the others. */
enum { COMBINED_MOST = 5 };
/* A target's range is kept within this, relatively. */
static const double ROW_TOLERANCE = MT_DEFAULT_TOLERANCE_PERCENT / 100.0;

double mt_tolerance_of_variable(const mt_problem *p, int i)
{
    const double percent = p->study->variables[i].tolerance_percent;
    return MT_HAS(percent) ? percent / 100.0 : 0.0;
}

static bool any_tolerance(const mt_problem *p)
{
    for (int i = 0; i < p->n; i++) {
        if (mt_tolerance_of_variable(p, i) > 0.0) {
            return true;
        }
    }
    return false;
}

bool mt_tolerance_is_range(const mt_problem *p, const mt_requirement *d)
{
    return any_tolerance(p) && MT_HAS(d->equals) && d->goal->tolerance_given;
}

/* Bounds widened by the tolerances. */
static void widen_tolerance_bounds(const mt_subproblem *c)
{
    for (int i = 0; i < c->p->n; i++) {
        const double tolerance = mt_tolerance_of_variable(c->p, i);
        c->tolerance_box->lower[i] = c->lower[i] - (tolerance * fabs(c->lower[i]));
        c->tolerance_box->upper[i] = c->upper[i] + (tolerance * fabs(c->upper[i]));
    }
}

/* Factor of input i at its low end (side -1), its high end (1), or without influence (0). */
static double end_factor(const mt_subproblem *c, int i, int side)
{
    const double sign = c->upper[i] > 0.0 ? 1.0 : -1.0;
    return 1.0 + (sign * (double)side * mt_tolerance_of_variable(c->p, i));
}

/* True where the j-th of n variables of unknown sign is high in combination c. */
static bool is_high(int c, int j, int n)
{
    if (n <= COMBINED_MOST) {
        return ((c >> j) & 1) != 0;
    }
    return c < 2 ? c == 1 : ((c & 1) != 0) != (j == (c - 2) / 2);
}

/* Corner k of sides * combinations: which side, and which combination of the variables of
 * unknown sign. */
static mt_status make_corner(const mt_subproblem *c, const int *signs, int sides, int unknown,
                             int k, mt_arena *mem, mt_tolerance_corner *out, mt_err *err)
{
    const int side = k % sides;
    int j = 0;
    *out = (mt_tolerance_corner){
        .factor = mt_arena_f64(mem, (size_t)c->p->n, 1),
        .may = {sides == 1 || side == MT_LOWEST, sides == 1 || side == MT_HIGHEST}};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < c->p->n; i++) {
        int at = side == MT_LOWEST ? -signs[i] : signs[i];
        if (signs[i] == MT_UNKNOWN) {
            at = is_high(k / sides, j++, unknown) ? 1 : -1;
        }
        out->factor[i] = end_factor(c, i, at);
    }
    return MT_OK;
}

/* Corners by signs[n], without analyses; at least the nominal design, where a range has no
 * other rows. */
static mt_status make_corners(const mt_subproblem *c, const int *signs, bool ranged,
                              mt_arena *mem, mt_tolerance_corners *out, mt_err *err)
{
    int known = 0;
    int unknown = 0;
    for (int i = 0; i < c->p->n; i++) {
        known += signs[i] == MT_RISES || signs[i] == MT_FALLS ? 1 : 0;
        unknown += signs[i] == MT_UNKNOWN ? 1 : 0;
    }
    *out = (mt_tolerance_corners){.exact = unknown == 0};
    if (known + unknown == 0 && !ranged) {
        return MT_OK;
    }
    const int sides = known > 0 ? MT_TOLERANCE_SIDES : 1;
    const int n = sides * (unknown <= COMBINED_MOST ? 1 << unknown : 2 * (unknown + 1));
    out->corners = mt_arena_alloc(mem, (size_t)n, sizeof *out->corners);
    MT_TRY(mt_arena_check(mem, err));
    for (; out->n < n; out->n++) {
        MT_TRY(make_corner(c, signs, sides, unknown, out->n, mem, &out->corners[out->n], err));
    }
    return MT_OK;
}

/* Effect of raising variable i; MT_UNKNOWN for bounds on both sides of 0, where the ends of a
 * relative tolerance swap. */
static int sign_of(const mt_subproblem *c, int i, bool rises, bool falls)
{
    const bool turns = c->lower[i] < 0.0 && c->upper[i] > 0.0;
    if (!(mt_tolerance_of_variable(c->p, i) > 0.0) || (!rises && !falls)) {
        return MT_NOTHING;
    }
    return turns || (rises && falls) ? MT_UNKNOWN : rises ? MT_RISES : MT_FALLS;
}

/* Signs over the whole box of all variables. */
static mt_status signs_of_view(const mt_subproblem *c, const mt_analysis *a, int *signs,
                               mt_err *err)
{
    char reason[MT_REASON_SIZE] = "";
    mt_enclosure *e = NULL;
    MT_TRY(
        mt_enclosure_new(a, c->tolerance_box->lower, c->tolerance_box->upper, &e, reason, err));
    if (e != NULL) {
        mt_enclosure_effects(e, c->tolerance_box->lower, c->tolerance_box->upper, signs);
    }
    for (int i = 0; i < c->p->n; i++) {
        const int effect = e == NULL ? MT_STIFFENS | MT_SOFTENS : signs[i];
        signs[i] = sign_of(c, i, (effect & MT_STIFFENS) != 0, (effect & MT_SOFTENS) != 0);
    }
    mt_enclosure_delete(e);
    return MT_OK;
}

static bool has_range(const mt_problem *p, int view)
{
    bool any = false;
    for (int i = 0; i < p->n_requirements; i++) {
        any = any ||
              (p->requirements[i].view == view && p->requirements[i].role == MT_ROLE_RANGE);
    }
    return any;
}

static mt_status check_requirement(const mt_requirement *d, mt_err *err)
{
    if (d->role == MT_ROLE_RESIDUAL) {
        return MT_OK;
    }
    if (d->quantity == MT_QUANTITY_OTHER || d->quantity == MT_QUANTITY_FREQUENCIES) {
        return mt_fail(err, MT_E_INPUT,
                       "/goals/%d: a goal of type \"%s\" is not judged over "
                       "\"tolerance_percent\": give %sthe variables no tolerance",
                       d->goal_index, mt_goal_kind_of(d->goal->type)->name,
                       MT_HAS(d->equals) ? "it a weight, or " : "");
    }
    return d->mode > 0 ? MT_OK
                       : mt_fail(err, MT_E_INPUT,
                                 "/goals/%d: with \"tolerance_percent\" a mode is meant by its "
                                 "index, as frequencies keep their order over the tolerances: "
                                 "name its number instead of \"%s\"",
                                 d->goal_index, d->asked->mode_name.s);
}

/* True where a search can continue from a design that violates a corner. */
static bool goes_on(const mt_problem *p)
{
    bool any = false;
    for (int i = 0; i < p->n; i++) {
        any = any || p->study->variables[i].n_catalogue == 0;
    }
    return any;
}

static bool any_unknown(const mt_problem *p, const int *signs)
{
    bool any = false;
    for (int i = 0; i < p->n; i++) {
        any = any || signs[i] == MT_UNKNOWN;
    }
    return any;
}

/*
 * The corners that a search over tolerances begins with. With h_i = tolerance_i |x_i|,
 *     lambda(x + d) = lambda(x) + sum_i (dlambda/dx_i) d_i + O(h^2),   |d_i| <= h_i
 * is least at d_i = -h_i sign(dlambda/dx_i) and greatest at the opposite corner. Where slopes
 * change their sign within the tolerances that is wrong: a design that counts is evaluated at
 * the other corners, too (tolerance_cut.c).
 */

/* Adds the corner to the set; where it is already there, only its sides are added. */
static void add_corner(const mt_tolerance_corner *corner, int n, mt_tolerance_corners *out)
{
    for (int k = 0; k < out->n; k++) {
        mt_tolerance_corner *const known = &out->corners[k];
        if (memcmp(known->factor, corner->factor, (size_t)n * sizeof *known->factor) == 0) {
            for (int side = 0; side < MT_TOLERANCE_SIDES; side++) {
                known->may[side] = known->may[side] || corner->may[side];
            }
            return;
        }
    }
    out->corners[out->n++] = *corner;
}

/* The corner of one mode on one side. */
static mt_status make_first(const mt_subproblem *c, const int *signs, const double *slope,
                            mt_tolerance_side side, mt_arena *mem, mt_tolerance_corner *out,
                            mt_err *err)
{
    *out = (mt_tolerance_corner){.factor = mt_arena_f64(mem, (size_t)c->p->n, 1)};
    MT_TRY(mt_arena_check(mem, err));
    out->may[side] = true;
    for (int i = 0; i < c->p->n; i++) {
        const int by_slope = slope[i] < 0.0 ? MT_FALLS : MT_RISES;
        const int rises = signs[i] == MT_UNKNOWN ? by_slope : signs[i];
        out->factor[i] = end_factor(c, i, side == MT_LOWEST ? -rises : rises);
    }
    return MT_OK;
}

/* Sides on which goals limit mode `mode` of a configuration: bands on both sides, for modes
 * below their upper edges and one above. */
static void find_sides(const mt_subproblem *c, int view, int mode, double hz_before,
                       bool *sides)
{
    for (int i = 0; i < c->p->n_requirements; i++) {
        const mt_requirement *const d = &c->p->requirements[i];
        const bool ranged = d->role == MT_ROLE_RANGE;
        if (d->view == view && d->mode == mode && (ranged || d->role == MT_ROLE_LIMIT)) {
            sides[MT_LOWEST] = sides[MT_LOWEST] || ranged || MT_HAS(d->goal->at_least);
            sides[MT_HIGHEST] = sides[MT_HIGHEST] || ranged || MT_HAS(d->goal->at_most);
        }
    }
    for (int i = 0; i < c->n_avoidances; i++) {
        const mt_bands *const bands = &c->avoidances[i].bands;
        const bool reaches = c->avoidances[i].view == view && bands->n > 0 &&
                             hz_before <= bands->items[bands->n - 1].upper_hz;
        sides[MT_LOWEST] = sides[MT_LOWEST] || reaches;
        sides[MT_HIGHEST] = sides[MT_HIGHEST] || reaches;
    }
}

/* The corners that the slopes of one mode name. */
static mt_status add_sides(const mt_subproblem *c, const int *signs, const double *slope,
                           const bool sides[MT_TOLERANCE_SIDES], mt_arena *mem,
                           mt_tolerance_corners *out, mt_err *err)
{
    for (int k = 0; k < MT_TOLERANCE_SIDES; k++) {
        mt_tolerance_corner corner;
        if (sides[k]) {
            MT_TRY(make_first(c, signs, slope, (mt_tolerance_side)k, mem, &corner, err));
            add_corner(&corner, c->p->n, out);
        }
    }
    return MT_OK;
}

/* Gives a side that no corner has to the first corner, so that every row is evaluated at
 * one. */
static void hold_somewhere(mt_tolerance_corners *out)
{
    for (int side = 0; side < MT_TOLERANCE_SIDES && out->n > 0; side++) {
        bool any = false;
        for (int k = 0; k < out->n; k++) {
            any = any || out->corners[k].may[side];
        }
        out->corners[0].may[side] = out->corners[0].may[side] || !any;
    }
}

static mt_status name_corners(const mt_subproblem *c, int view, mt_analysis *a,
                              const int *signs, mt_arena *mem, mt_tolerance_corners *out,
                              mt_err *err)
{
    const int n = c->p->n;
    const int most = mt_modal_vibrations(&a->modes);
    double hz_before = 0.0;
    double *const slope = mt_arena_f64(mem, (size_t)n, 1);
    out->corners =
        mt_arena_alloc(mem, (size_t)MT_TOLERANCE_SIDES * (size_t)most, sizeof *out->corners);
    MT_TRY(mt_arena_check(mem, err));
    for (int mode = 1; mode <= most; mode++) {
        bool sides[MT_TOLERANCE_SIDES] = {false};
        mt_err own = {.code = MT_OK};
        const int pos = mt_modal_flexible(&a->modes, mode);
        if (pos < 0) {
            continue;
        }
        find_sides(c, view, mode, hz_before, sides);
        hz_before = mt_modal_hz(&a->modes, pos);
        if (!sides[MT_LOWEST] && !sides[MT_HIGHEST]) {
            continue;
        }
        const mt_status rc = mt_analysis_dlambda_raw(a, pos, slope, &own);
        MT_TRY(mt_pass_final(rc, &own, err));
        if (rc == MT_OK) {
            MT_TRY(add_sides(c, signs, slope, sides, mem, out, err));
        }
    }
    hold_somewhere(out);
    return MT_OK;
}

/*
 * For a configuration whose corners signs[n] do not decide, the worst
 * corners by slopes, for each limited mode m and each side,
 *     x_i (1 -+ tolerance_i)   by the sign of dlambda_m/dx_i   where the sign is not known,
 * at the design within the bounds that is nearest to the original one, each corner once. out->n
 * = 0: no mode has slopes there. Cost: one analysis. Fails: MT_E_MEMORY, MT_E_INTERNAL.
 */
static mt_status first_corners(const mt_subproblem *c, int view, const int *signs,
                               mt_arena *mem, mt_tolerance_corners *out, mt_err *err)
{
    const mt_analysis_options opt = {
        .gradient = true, .vectors = true, .accuracy = MT_MODAL_ACCURACY};
    mt_analysis *a = NULL;
    mt_err own = {.code = MT_OK};
    double *const x = mt_arena_f64(mem, (size_t)c->p->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < c->p->n; i++) {
        x[i] = fmin(fmax(c->p->original[i], c->lower[i]), c->upper[i]);
    }
    *out = (mt_tolerance_corners){.exact = false};
    mt_problem_note_modal(c->p, 2); /* made and solved with slopes */
    mt_status rc = mt_configuration_analyse(&c->views[view], x, &a, &own);
    rc = rc == MT_OK ? mt_analysis_solve(a, x, &opt, &own) : rc;
    const bool known = rc == MT_OK;
    rc = mt_pass_final(rc, &own, err);
    rc = rc == MT_OK && known ? name_corners(c, view, a, signs, mem, out, err) : rc;
    mt_analysis_delete(a);
    return rc;
}

/* Corners of one configuration. Those of a cut (a position of a drive) are not verified
 * later. */
static mt_status init_view(mt_subproblem *c, int view, mt_arena *mem, mt_err *err)
{
    const mt_problem *const p = c->p;
    mt_tolerance_corners *const set = &c->tolerance_box->views[view];
    int *const signs = mt_arena_int(mem, (size_t)p->n);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(signs_of_view(c, c->views[view].original, signs, err));
    if (view < p->n_views && goes_on(p) && any_unknown(p, signs)) {
        MT_TRY(first_corners(c, view, signs, mem, set, err));
    }
    return set->n > 0 ? MT_OK : make_corners(c, signs, has_range(p, view), mem, set, err);
}

/* Corners of the configurations that constraints or bands use; those of the problem's own may
 * be known. */
static mt_status init_views(mt_subproblem *c, const mt_problem_tolerance_box *known,
                            mt_arena *mem, mt_err *err)
{
    const mt_problem *const p = c->p;
    int *const wanted = mt_arena_int(mem, (size_t)c->n_views + 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        if (d->view >= 0) {
            MT_TRY(check_requirement(d, err));
            const bool held = d->role == MT_ROLE_LIMIT || d->role == MT_ROLE_RANGE;
            wanted[d->view] = wanted[d->view] || held;
        }
    }
    for (int i = 0; i < c->n_avoidances; i++) {
        wanted[c->avoidances[i].view] = 1;
    }
    for (int i = 0; i < c->n_views; i++) {
        if (known != NULL && i < p->n_views) {
            c->tolerance_box->views[i] = known->views[i];
        } else if (wanted[i]) {
            MT_TRY(init_view(c, i, mem, err));
        }
    }
    return MT_OK;
}

/* Signs of the expressions' slopes over the bounds decide their corners. */
static mt_status init_limits(mt_subproblem *c, mt_arena *mem, mt_err *err)
{
    const mt_problem *const p = c->p;
    const size_t n = (size_t)p->n;
    const size_t count = (size_t)p->program.count;
    int *const signs = mt_arena_int(mem, n);
    double *const lo = mt_arena_f64(mem, count, 1);
    double *const hi = mt_arena_f64(mem, count, 1);
    double *const dlo = mt_arena_f64(mem, count, n);
    double *const dhi = mt_arena_f64(mem, count, n);
    MT_TRY(mt_arena_check(mem, err));
    mt_program_interval_gradient(&p->program, c->tolerance_box->lower, c->tolerance_box->upper,
                                 lo, hi, dlo, dhi);
    for (int k = 0; k < p->n_requirements; k++) {
        const mt_requirement *const d = &p->requirements[k];
        const bool held = d->role == MT_ROLE_LIMIT || d->role == MT_ROLE_RANGE;
        if (d->quantity != MT_QUANTITY_EXPRESSION || !held) {
            continue;
        }
        const size_t row = (size_t)d->node * n;
        for (int i = 0; i < p->n; i++) {
            signs[i] = sign_of(c, i, dhi[row + (size_t)i] > 0.0, dlo[row + (size_t)i] < 0.0);
        }
        MT_TRY(make_corners(c, signs, d->role == MT_ROLE_RANGE, mem,
                            &c->tolerance_box->limits[k], err));
    }
    return MT_OK;
}

/* Rows of one limit at all corners of its side. The worst corner takes the place of the
 * design's own row `own`; where the corners are samples, or there is no such row (-1), they
 * come on top. */
static mt_status append_corners(const mt_row_layout *l, const mt_tolerance_corners *set,
                                const mt_row *what, int own, mt_err *err)
{
    mt_row_block *const in = &l->c->rows.in;
    mt_row row = *what;
    row.kind = MT_ROW_CORNER;
    for (int k = 0; k < set->n; k++) {
        row.corner = k;
        if (set->corners[k].may[what->sense] && set->exact && own >= 0) {
            in->rows[own] = row;
        } else if (set->corners[k].may[what->sense]) {
            MT_TRY(mt_rows_append(in, &row, l->mem, err));
        }
    }
    return MT_OK;
}

/* Limit of a target's range, whose tolerance is the goal's. */
static double range_limit(const mt_requirement *d, mt_row_sense sense)
{
    const double give = sense == MT_AT_LEAST ? -d->tolerance : d->tolerance;
    return d->measure == MT_MEASURE_RATIO
               ? d->equals * (1.0 + give)
               : d->equals + (give * mt_requirement_unit(d, d->equals));
}

static mt_status append_range(const mt_row_layout *l, const mt_requirement *d,
                              const mt_tolerance_corners *set, mt_err *err)
{
    for (int side = 0; side < MT_TOLERANCE_SIDES; side++) {
        mt_row row = mt_row_init(MT_ROW_CORNER, (mt_row_sense)side);
        row.requirement = d->index;
        row.view = d->view;
        row.mode = d->mode;
        row.limit = range_limit(d, row.sense);
        row.tolerance = ROW_TOLERANCE;
        MT_TRY(append_corners(l, set, &row, -1, err));
    }
    return MT_OK;
}

static mt_status append_requirement(const mt_row_layout *l, const mt_requirement *d,
                                    mt_err *err)
{
    const mt_subproblem *const c = l->c;
    const mt_tolerance_corners *const set = mt_tolerance_corners_of(c, d->view, d->index);
    const int first = mt_requirement_row(c, d);
    if (d->role == MT_ROLE_RANGE) {
        return append_range(l, d, set, err);
    }
    for (int k = 0; d->role == MT_ROLE_LIMIT && k < d->n_rows; k++) {
        const mt_row row = c->rows.in.rows[first + k];
        MT_TRY(append_corners(l, set, &row, first + k, err));
    }
    return MT_OK;
}

static mt_status append_rows(const mt_row_layout *l, mt_err *err)
{
    const mt_subproblem *const c = l->c;
    const mt_row_span bands = c->rows.of_kind[MT_ROW_BAND];
    for (int i = 0; i < c->p->n_requirements; i++) {
        MT_TRY(append_requirement(l, &c->p->requirements[i], err));
    }
    for (int k = bands.first; k < bands.first + bands.n; k++) {
        const mt_row row = c->rows.in.rows[k];
        MT_TRY(append_corners(l, &c->tolerance_box->views[row.view], &row, k, err));
    }
    return MT_OK;
}

/* Makes the subproblem's tolerance_box (NULL where no variable has a tolerance) and appends its
 * rows. Fails: MT_E_INPUT where a goal cannot be evaluated over tolerances, with the reason;
 * MT_E_MEMORY, numerical failures. */
static mt_status lay_out(const mt_row_layout *l, mt_err *err)
{
    mt_subproblem *const c = l->c;
    const size_t n = (size_t)c->p->n;
    if (!any_tolerance(c->p)) {
        return MT_OK;
    }
    mt_problem_tolerance_box *const r = mt_arena_alloc(l->mem, 1, sizeof *r);
    MT_TRY(mt_arena_check(l->mem, err));
    *r = (mt_problem_tolerance_box){
        .views = mt_arena_alloc(l->mem, (size_t)c->n_views, sizeof *r->views),
        .limits = l->known != NULL
                      ? l->known->limits
                      : mt_arena_alloc(l->mem, (size_t)c->p->n_requirements, sizeof *r->limits),
        .lower = mt_arena_f64(l->mem, n, 1),
        .upper = mt_arena_f64(l->mem, n, 1),
        .sampled_later = l->known != NULL && l->known->sampled_later};
    MT_TRY(mt_arena_check(l->mem, err));
    c->tolerance_box = r;
    widen_tolerance_bounds(c);
    MT_TRY(init_views(c, l->known, l->mem, err));
    MT_TRY(l->known != NULL ? MT_OK : init_limits(c, l->mem, err));
    return append_rows(l, err);
}

const mt_tolerance_corners *mt_tolerance_corners_of(const mt_subproblem *c, int view,
                                                    int requirement)
{
    return view >= 0 ? &c->tolerance_box->views[view] : &c->tolerance_box->limits[requirement];
}

int mt_tolerance_next_row(const mt_subproblem *c, int from)
{
    for (int i = from; c->tolerance_box != NULL && i < c->rows.in.n; i++) {
        if (c->rows.in.rows[i].corner >= 0) {
            return i;
        }
    }
    return -1;
}

bool mt_tolerance_row_is_sampled(const mt_subproblem *c, const mt_row *row)
{
    return row->view < c->p->n_views &&
           !mt_tolerance_corners_of(c, row->view, row->requirement)->exact;
}

bool mt_tolerance_is_sampled(const mt_subproblem *c)
{
    if (c->tolerance_box == NULL || c->tolerance_box->sampled_later) {
        return c->tolerance_box != NULL;
    }
    for (int k = mt_tolerance_next_row(c, 0); k >= 0; k = mt_tolerance_next_row(c, k + 1)) {
        if (mt_tolerance_row_is_sampled(c, &c->rows.in.rows[k])) {
            return true;
        }
    }
    return false;
}

mt_status mt_tolerance_work_init(mt_workspace *w, mt_err *err)
{
    const size_t n = (size_t)w->p->n;
    const size_t count = (size_t)w->p->program.count;
    if (!any_tolerance(w->p)) {
        return MT_OK;
    }
    mt_tolerance_work *const r = mt_arena_alloc(&w->mem, 1, sizeof *r);
    MT_TRY(mt_arena_check(&w->mem, err));
    *r = (mt_tolerance_work){.x = mt_arena_f64(&w->mem, n, 1),
                             .slope = mt_arena_f64(&w->mem, n, 1),
                             .value = mt_arena_f64(&w->mem, count, 1),
                             .grad = mt_arena_f64(&w->mem, count, n)};
    w->tolerance_box = r;
    return mt_arena_check(&w->mem, err);
}

const mt_ranges *mt_tolerance_known(const mt_workspace *w)
{
    return w->tolerance_box != NULL ? w->tolerance_box->ranges : NULL;
}

const mt_tolerance_range *mt_ranges_hz(const mt_ranges *r, int view, int mode)
{
    return r != NULL && mode >= 1 && mode <= r->n[view] ? &r->hz[view][mode - 1] : NULL;
}

bool mt_ranges_proven(const mt_ranges *r)
{
    bool proven = r != NULL;
    for (int i = 0; proven && i < r->n_views; i++) {
        proven = r->n[i] == 0 || r->hz[i][0].proven;
    }
    for (int k = 0; proven && k < r->n_limits; k++) {
        const bool limit = r->number[k].at[MT_LOWEST] != NULL;
        proven = !limit || r->number[k].proven;
    }
    return proven;
}

/* Rows at the corners: as requirement.c and avoidance.c make them, with the corner's modes and
 * its factors in the gradient. */

static void scale_design(const mt_workspace *w, const double *factor)
{
    for (int i = 0; i < w->p->n; i++) {
        w->tolerance_box->x[i] = w->x[i] * factor[i];
    }
}

mt_status mt_tolerance_solve(mt_workspace *w, bool with_gradient, mt_err *err)
{
    for (int i = 0; w->c->tolerance_box != NULL && i < w->c->n_views; i++) {
        const mt_tolerance_corners *const set = &w->c->tolerance_box->views[i];
        const mt_analysis_options opt =
            mt_configuration_queries(w, &w->views[i], with_gradient);
        for (int k = 0; k < set->n; k++) {
            mt_analysis *const a = w->views[i].corners[k];
            scale_design(w, set->corners[k].factor);
            MT_TRY(mt_err_in(err, mt_analysis_solve(a, w->tolerance_box->x, &opt, err),
                             "configuration \"%s\" at a corner of the tolerances",
                             mt_analysis_configuration(a)));
        }
    }
    return MT_OK;
}

/* in = sign (q - edge) - z: q = ln(f / limit) and edge 0, or an expression and its limit over
 * their unit. */
typedef struct quantity {
    double value;
    double edge;
    double z; /* least clearance that is asked for */
} quantity;

/* ln(f / limit) at the corner, with its slopes over t in tolerance_box->slope. */
static mt_status frequency(mt_workspace *w, const mt_row *row, bool with_gradient,
                           double *value, mt_err *err)
{
    mt_analysis *const a = w->views[row->view].corners[row->corner];
    const double *const factor =
        w->c->tolerance_box->views[row->view].corners[row->corner].factor;
    const int pos = mt_modal_flexible(&a->modes, row->mode);
    const double floor_hz = MT_FREQUENCY_FLOOR * row->limit;
    if (pos < 0 && !mt_analysis_is_infinite(a, row->mode)) {
        return mt_fail(err, MT_E_DOMAIN,
                       "configuration \"%s\" has no vibration mode %d at a corner of the "
                       "tolerances",
                       mt_analysis_configuration(a), row->mode);
    }
    *value = mt_problem_ln_ratio(&a->modes, pos, row->limit, floor_hz);
    if (with_gradient) {
        MT_TRY(mt_problem_dln_frequency(w, a, pos, floor_hz, w->tolerance_box->slope, err));
        for (int i = 0; i < w->p->n; i++) {
            w->tolerance_box->slope[i] *= factor[i];
        }
    }
    return MT_OK;
}

static mt_status expression(mt_workspace *w, const mt_tolerance_corner *c, mt_node node,
                            double unit, bool with_gradient, double *value, mt_err *err)
{
    const mt_problem *const p = w->p;
    mt_tolerance_work *const r = w->tolerance_box;
    mt_node bad = MT_NO_NODE;
    mt_err own = {0};
    scale_design(w, c->factor);
    const mt_status rc =
        with_gradient ? mt_program_gradient(&p->program, r->x, r->value, r->grad, &bad, &own)
                      : mt_program_eval(&p->program, r->x, r->value, &bad, &own);
    if (rc != MT_OK && !(rc == MT_E_DOMAIN && bad >= p->n_searched)) {
        return mt_fail(err, rc, "%s", own.text);
    }
    *value = r->value[node] / unit;
    for (int i = 0; i < p->n && with_gradient; i++) {
        r->slope[i] = mt_workspace_dx_dt(w, i) * c->factor[i] *
                      r->grad[((ptrdiff_t)node * p->n) + i] / unit;
    }
    return MT_OK;
}

static mt_status value_at_corner(mt_workspace *w, const mt_row *row, bool with_gradient,
                                 quantity *q, mt_err *err)
{
    if (row->view >= 0) {
        q->z = row->avoidance >= 0 && w->c->clearance ? w->t[w->p->n] : 0.0;
        return frequency(w, row, with_gradient, &q->value, err);
    }
    const mt_requirement *const d = &w->c->requirements[row->requirement];
    const mt_tolerance_corners *const set = &w->c->tolerance_box->limits[row->requirement];
    const double unit = mt_requirement_unit(d, row->limit);
    q->edge = row->limit / unit;
    return expression(w, &set->corners[row->corner], d->node, unit, with_gradient, &q->value,
                      err);
}

static mt_status eval_corners(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                              mt_err *err)
{
    const ptrdiff_t rows = w->c->rows.in.n;
    const int n = w->p->n;
    for (int at = mt_tolerance_next_row(w->c, 0); at >= 0;
         at = mt_tolerance_next_row(w->c, at + 1)) {
        const mt_row *const row = &w->c->rows.in.rows[at];
        const double sign = mt_row_sign(row);
        quantity q = {.z = 0.0};
        MT_TRY(value_at_corner(w, row, with_gradient, &q, err));
        out->in[at] = (sign * (q.value - q.edge)) - q.z;
        for (int i = 0; i < n && with_gradient; i++) {
            out->din[at + (i * rows)] = sign * w->tolerance_box->slope[i];
        }
        if (with_gradient && w->c->n_t > n) {
            out->din[at + (n * rows)] = row->avoidance < 0 ? 0.0 : -1.0;
        }
    }
    return MT_OK;
}

/* Lowest and highest frequency of vibration mode k of a configuration: its range where known,
 * else over the nominal design and its corners; false: no such mode. */
static bool span_of(const mt_workspace *w, int view, int k, double *low, double *high)
{
    const int n_corners = w->c->tolerance_box->views[view].n;
    const mt_ranges *const known = mt_tolerance_known(w);
    const mt_tolerance_range *const range = mt_ranges_hz(known, view, k);
    if (range != NULL) {
        *low = range->value[MT_LOWEST];
        *high = range->value[MT_HIGHEST];
        return true;
    }
    if (known != NULL && known->n[view] > 0) {
        return false;
    }
    *low = HUGE_VAL;
    *high = 0.0;
    for (int c = -1; c < n_corners; c++) {
        const mt_modes *const modes =
            c < 0 ? &w->views[view].analysis->modes : &w->views[view].corners[c]->modes;
        const int pos = mt_modal_flexible(modes, k);
        if (pos < 0) {
            return false;
        }
        *low = fmin(*low, mt_modal_hz(modes, pos));
        *high = fmax(*high, mt_modal_hz(modes, pos));
    }
    return true;
}

/* mt_avoidance_margin over all corners, or over the ranges where known; modes correspond by
 * index. */
static double tolerance_margin(const mt_workspace *w, const mt_avoidance *c)
{
    const mt_modes *const modes = &w->views[c->view].analysis->modes;
    const int n_corners = w->c->tolerance_box->views[c->view].n;
    double low = 0.0;
    double high = 0.0;
    bool indexed = mt_modal_indexed(modes);
    for (int k = 0; k < n_corners; k++) {
        indexed = indexed && mt_modal_indexed(&w->views[c->view].corners[k]->modes);
    }
    double room = indexed ? HUGE_VAL : nan("");
    mt_mode_band_pair p = mt_mode_band_pairs_all(modes, &c->bands);
    while (MT_HAS(room) && mt_mode_band_pairs_next(&p)) {
        if (p.b == 0 && !span_of(w, c->view, p.mode, &low, &high)) {
            break;
        }
        room = fmin(room, MT_HAS(low + high) ? mt_band_margin(p.band, low, high) : -HUGE_VAL);
    }
    return room > -HUGE_VAL ? room : nan("");
}

double mt_avoidance_margin(const mt_workspace *w, const mt_avoidance *c)
{
    return w->c->tolerance_box != NULL
               ? tolerance_margin(w, c)
               : mt_avoidance_find_modes(c, &w->views[c->view].analysis->modes, NULL);
}

double mt_avoidances_margin(const mt_workspace *w)
{
    double room = HUGE_VAL;
    for (int i = 0; i < w->c->n_avoidances; i++) {
        const mt_avoidance *const c = &w->c->avoidances[i];
        const double here = w->views[c->view].solved ? mt_avoidance_margin(w, c) : nan("");
        room = here < room || !MT_HAS(here) ? here : room;
    }
    return room;
}

const mt_row_ops mt_rows_corners = {.lay_out = lay_out, .eval = eval_corners};
