/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which corners of the tolerances may be the worst, which goals can be judged there, and their
 * rows. */
#include "problem/tolerance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "problem/requirement.h"
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
    return any_tolerance(p) && MT_HAS(d->equals) && d->goal->tolerance_addr != d->goal->addr;
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

double mt_tolerance_factor(const mt_subproblem *c, int i, int side)
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
        out->factor[i] = mt_tolerance_factor(c, i, at);
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
    if (d->quantity == MT_QUANTITY_OTHER) {
        return mt_fail(err, MT_E_INPUT,
                       "/goals/%d: a goal of type \"%s\" is not judged over "
                       "\"tolerance_percent\": give it a weight, or the variables no tolerance",
                       d->goal_index, mt_goal_kind_of(d->goal->type)->name);
    }
    return d->mode > 0 ? MT_OK
                       : mt_fail(err, MT_E_INPUT,
                                 "/goals/%d: with \"tolerance_percent\" a mode is meant by its "
                                 "index, as frequencies keep their order over the tolerances: "
                                 "name its number instead of \"%s\"",
                                 d->goal_index, d->goal->mode.mode_name.s);
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
        MT_TRY(mt_tolerance_first(c, view, signs, mem, set, err));
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

/* Makes c->tolerance_box and its rows, where a variable has a tolerance. */
static mt_status lay_out_corners(const mt_row_layout *l, mt_err *err)
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
        .upper = mt_arena_f64(l->mem, n, 1)};
    MT_TRY(mt_arena_check(l->mem, err));
    c->tolerance_box = r;
    widen_tolerance_bounds(c);
    MT_TRY(init_views(c, l->known, l->mem, err));
    MT_TRY(l->known != NULL ? MT_OK : init_limits(c, l->mem, err));
    return append_rows(l, err);
}

const mt_row_ops mt_rows_corners = {.lay_out = lay_out_corners, .eval = mt_tolerance_rows};

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
