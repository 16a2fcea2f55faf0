/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One requirement of any kind: its number q against what is asked for, as the kind measures it.
 * With off(limit) of problem/goals.h
 *     target:   eq = off(target)
 *     limits:   in = off(at_least), -off(at_most)
 *     residual: r  = sqrt(w) off(target)
 */

#include "problem/requirement.h"

#include <math.h>
#include <string.h>

#include "analysis/count.h"
#include "problem/configuration.h"
#include "problem/drive_positions.h"
#include "problem/forced_response.h"
#include "problem/frequency.h"
#include "problem/goals.h"
#include "problem/tolerance.h"

static void write_gradient_row(const mt_workspace *w, double *matrix, int rows, int row,
                               double factor, const double *gradient)
{
    const int n = w->p->n;
    if (gradient != NULL && w->c->n_t > n && matrix != w->dr) {
        /* the last coordinate enters no goal, but bands or those of its own */
        matrix[row + ((ptrdiff_t)n * rows)] = 0.0;
    }
    for (int i = 0; i < n && gradient != NULL; i++) {
        matrix[row + ((ptrdiff_t)i * rows)] = factor * gradient[i];
    }
}

/* Deviation of q from a limit, and the factor of its slope. */
static double off(const mt_workspace *w, const mt_requirement *d, double q, double limit,
                  double *factor)
{
    const double unit = mt_requirement_unit(d, limit);
    *factor = 1.0 / unit;
    if (isinf(q) && d->measure == MT_MEASURE_PART) { /* beside a mode at 0 Hz */
        return MT_MOST_INSIDE;
    }
    if (isinf(q) && d->goal->response_limit != NULL) {
        return MT_MOST_INSIDE + w->beyond;
    }
    return d->measure == MT_MEASURE_RATIO ? mt_frequency_ln_ratio(q, limit, d->floor_hz)
                                          : (q - limit) / unit;
}

/* Writes the excess of one part of a goal of the objective "vibration": the last coordinate
 * exceeds all of them. */
static void store_vibration(mt_workspace *w, const mt_requirement *d, int row, double q,
                            const double *slope, mt_nlp_values *out)
{
    double factor = 1.0;
    const int rows = w->c->rows.in.n;
    const double over = off(w, d, q, d->goal->at_most, &factor);
    w->worst = over <= w->worst ? w->worst : over;
    if (!w->c->forced_response) {
        return;
    }
    out->in[row] =
        mt_forced_response_given(w) ? w->t[w->p->n] - MT_FORCED_RESPONSE_SHIFT - over : 0.0;
    write_gradient_row(w, out->din, rows, row, -factor, slope);
    if (slope != NULL) {
        out->din[row + ((ptrdiff_t)w->p->n * rows)] = 1.0;
    }
}

/* Writes row k of a requirement for the value q: slope NULL where none is wanted. */
static void store_row(mt_workspace *w, const mt_requirement *d, int k, double q,
                      const double *slope, mt_nlp_values *out)
{
    const mt_row_table *const rows = &w->c->rows;
    const int at = mt_requirement_row(w->c, d) + k;
    double factor = 1.0;
    if (d->role == MT_ROLE_RESIDUAL) {
        const double weight = sqrt(mt_requirement_weight(w, d));
        w->r[at] = weight * off(w, d, q, rows->res.rows[at].limit, &factor);
        write_gradient_row(w, w->dr, rows->res.n, at, weight * factor, slope);
    } else if (d->role == MT_ROLE_TARGET) {
        out->eq[at] = off(w, d, q, rows->eq.rows[at].limit, &factor);
        write_gradient_row(w, out->deq, rows->eq.n, at, factor, slope);
    } else if (d->role == MT_ROLE_VIBRATION) {
        store_vibration(w, d, at, q, slope, out);
    } else {
        const double sign = mt_row_sign(&rows->in.rows[at]);
        out->in[at] = sign * off(w, d, q, rows->in.rows[at].limit, &factor);
        write_gradient_row(w, out->din, rows->in.n, at, sign * factor, slope);
    }
}

static mt_status no_mode(const mt_workspace *w, const mt_requirement *d, mt_err *err)
{
    const mt_analysis *const a = w->views[d->view].analysis;
    const char *const why =
        a->modes.n_unstable > 0 ? "is unstable, so that its modes have no index"
        : a->modes.n_undecided > 0
            ? "has a mode of which rounding hides whether it is stable, so that its modes have "
              "no index"
            : "has no such vibration mode here";
    return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\" %s", mt_analysis_configuration(a),
                   why);
}

/* Index of the requirement's mode; -1: a goal without one, or a frequency at infinity. */
static mt_status find_mode(mt_workspace *w, const mt_requirement *d, int *pos, mt_err *err)
{
    *pos = -1;
    if (!mt_requirement_is_modal(d)) {
        return d->view < 0 || w->views[d->view].solved
                   ? MT_OK
                   : mt_fail(err, MT_E_DOMAIN, "configuration \"%s\" has no modes here",
                             mt_analysis_configuration(w->views[d->view].analysis));
    }
    mt_configuration_work *const view = &w->views[d->view];
    MT_TRY(mt_configuration_position(w, view, d->mode, d->named, pos, err));
    const bool infinite = d->quantity == MT_QUANTITY_FREQUENCY && view->solved &&
                          mt_analysis_is_infinite(view->analysis, d->mode);
    return *pos < 0 && !infinite ? no_mode(w, d, err) : MT_OK;
}

/* The rows of a number that is the largest of several. */
static mt_status store_parts(mt_workspace *w, const mt_requirement *d, bool with_gradient,
                             mt_nlp_values *out, double *value, mt_err *err)
{
    double *const slope = with_gradient ? w->slope : NULL;
    *value = 0.0;
    for (int k = 0; k < d->n_parts; k++) {
        double q = nan("");
        MT_TRY(d->ops->part(w, d, k, &q, slope, err));
        store_row(w, d, k, q, slope, out);
        *value = q <= *value ? *value : q;
    }
    return MT_OK;
}

mt_status mt_requirement_eval(mt_workspace *w, const mt_requirement *d, bool with_gradient,
                              mt_nlp_values *out, double *value, mt_err *err)
{
    int pos = -1;
    double q = nan("");
    double *const slope = with_gradient ? w->slope : NULL;
    MT_TRY(find_mode(w, d, &pos, err));
    if (d->ops->value == NULL) {
        MT_TRY(d->ops->residuals(w, d, pos, with_gradient, err));
        q = mt_norm2(d->n_rows, w->r + mt_requirement_row(w->c, d)) /
            sqrt(mt_requirement_weight(w, d));
    } else if (d->n_parts > 0) {
        MT_TRY(store_parts(w, d, with_gradient, out, &q, err));
    } else {
        MT_TRY(d->ops->value(w, d, pos, &q, slope, err));
        for (int k = 0; k < d->n_rows; k++) {
            store_row(w, d, k, q, slope, out);
        }
    }
    if (value != NULL) {
        *value = q;
    }
    return MT_OK;
}

/* mt_forced_response_find_peak at another position of the drive: another analysis of the
 * mechanism, solved with all shapes. */
static mt_status find_peak_at(mt_workspace *w, const mt_requirement *d, mt_analysis *a,
                              mt_forced_response_value *out, mt_err *err)
{
    mt_configuration_work *const view = &w->views[d->view];
    mt_analysis *const own = view->analysis;
    mt_forced_response_close(view);
    view->analysis = a;
    const mt_status rc = mt_forced_response_find_peak(w, d, out, err);
    mt_forced_response_close(view);
    view->analysis = own;
    return rc;
}

mt_status mt_requirement_find_peak(mt_workspace *w, const mt_requirement *d, mt_analysis *a,
                                   mt_forced_response_value *out, mt_err *err)
{
    if (d->ops->look != NULL) {
        return find_peak_at(w, d, a, out, err);
    }
    mt_configuration_work *const view = &w->views[d->view];
    const mt_configuration_work own = *view;
    int pos = -1;
    *out = (mt_forced_response_value){.value = nan(""), .error = nan(""), .omega = nan("")};
    view->analysis = a;
    view->solved = true;
    mt_status rc = find_mode(w, d, &pos, err);
    rc = rc == MT_OK ? d->ops->value(w, d, pos, &out->value, NULL, err) : rc;
    view->analysis = own.analysis;
    view->solved = own.solved;
    out->finite = rc == MT_OK && isfinite(out->value);
    out->end = isinf(out->value) ? MT_FORCED_INFINITE : MT_FORCED_FINITE;
    out->end_name = mt_forced_end_name(out->end);
    return rc;
}

static double over_limit(const mt_requirement *d, double q, double limit)
{
    if (d->measure != MT_MEASURE_RATIO) {
        return (q - limit) / mt_requirement_unit(d, limit);
    }
    const double part = q / limit;
    return log(part >= MT_FORCED_RESPONSE_FLOOR ? part : MT_FORCED_RESPONSE_FLOOR);
}

double mt_requirement_over(const mt_requirement *d, double q)
{
    const mt_goal *const g = d->goal;
    double worst = -HUGE_VAL;
    if (isnan(q)) {
        return q;
    }
    worst = MT_HAS(g->at_most) ? over_limit(d, q, g->at_most) : worst;
    return MT_HAS(g->at_least) ? fmax(worst, -over_limit(d, q, g->at_least)) : worst;
}

/* Appends the n rows of a requirement to a block: its limits in their order, or its parts. */
static mt_status append_rows(const mt_row_layout *l, mt_row_kind kind, const mt_requirement *d,
                             double tolerance, mt_row_block *block, mt_err *err)
{
    const bool equal = d->role == MT_ROLE_RESIDUAL || d->role == MT_ROLE_TARGET;
    const bool both = d->n_parts == 0 && MT_HAS(d->goal->at_least);
    l->c->rows.of[d->index] = (mt_row_span){.first = block->n, .n = d->n_rows};
    for (int k = 0; k < d->n_rows; k++) {
        const bool least = both && k == 0;
        mt_row row = mt_row_init(kind, equal ? MT_EQUAL : least ? MT_AT_LEAST : MT_AT_MOST);
        row.requirement = d->index;
        row.part = d->n_parts > 0 || d->ops->value == NULL ? k : 0;
        row.view = d->view;
        row.mode = d->mode;
        row.limit = equal ? d->equals : least ? d->goal->at_least : d->goal->at_most;
        row.tolerance = tolerance;
        MT_TRY(mt_rows_append(block, &row, l->mem, err));
    }
    return MT_OK;
}

static mt_status lay_out_goals(const mt_row_layout *l, mt_err *err)
{
    mt_subproblem *const c = l->c;
    const size_t most = (size_t)c->p->n_requirements + (size_t)l->n_cuts;
    c->rows.of = mt_arena_alloc(l->mem, most, sizeof *c->rows.of);
    MT_TRY(mt_arena_check(l->mem, err));
    for (int i = 0; i < c->p->n_requirements; i++) {
        const mt_requirement *const d = &c->p->requirements[i];
        mt_row_block *const block = d->role == MT_ROLE_RESIDUAL ? &c->rows.res
                                    : d->role == MT_ROLE_TARGET ? &c->rows.eq
                                                                : &c->rows.in;
        MT_TRY(d->role == MT_ROLE_VIBRATION
                   ? MT_OK
                   : append_rows(l, MT_ROW_GOAL, d, d->tolerance, block, err));
    }
    return MT_OK;
}

static mt_status eval_each(mt_workspace *w, int first, int end, bool with_gradient,
                           mt_nlp_values *out, mt_err *err)
{
    for (int i = first; i < end; i++) {
        const mt_requirement *const d = &w->c->requirements[i];
        MT_TRY(mt_err_in(err, mt_requirement_eval(w, d, with_gradient, out, NULL, err),
                         "/goals/%d", d->goal_index));
    }
    return MT_OK;
}

static mt_status eval_goals(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                            mt_err *err)
{
    return eval_each(w, 0, w->p->n_requirements, with_gradient, out, err);
}

const mt_row_ops mt_rows_goals = {.lay_out = lay_out_goals, .eval = eval_goals};

/* Of rows of the objective "vibration": what it is told within. */
static const double VIBRATION_TOLERANCE = 1e-7;

/* The rows of the objective "vibration", and its coordinate: any ratio of e^-49 to e^50. */
static mt_status lay_out_vibration(const mt_row_layout *l, mt_err *err)
{
    mt_subproblem *const c = l->c;
    const int n = c->p->n;
    c->forced_response = mt_objective_is(c->stages[0].type, MT_SHAKES);
    if (!c->forced_response) {
        return MT_OK;
    }
    c->n_t = n + 1;
    c->lower_t[n] = 1.0;
    c->upper_t[n] = 2.0 * MT_FORCED_RESPONSE_SHIFT;
    c->origin_t[n] = MT_FORCED_RESPONSE_SHIFT;
    for (int i = 0; i < c->p->n_requirements; i++) {
        const mt_requirement *const d = &c->p->requirements[i];
        MT_TRY(
            d->role != MT_ROLE_VIBRATION
                ? MT_OK
                : append_rows(l, MT_ROW_VIBRATION, d, VIBRATION_TOLERANCE, &c->rows.in, err));
    }
    return MT_OK;
}

const mt_row_ops mt_rows_vibration = {.lay_out = lay_out_vibration}; /* eval_goals fills them */

/* The configuration's mechanism at the cut's position, with the configuration's queries and
 * port pairs. */
static mt_configuration_problem view_at_cut(const mt_problem *p, const mt_cut *cut,
                                            const mt_configuration_problem *like)
{
    return (mt_configuration_problem){.configuration =
                                          p->families[cut->drive_positions].configuration,
                                      .original = cut->original,
                                      .n_rigid = cut->original->n_rigid,
                                      .n_most = cut->original->n_most,
                                      .ask = like->ask,
                                      .n_pairs = like->n_pairs,
                                      .pairs = like->pairs};
}

/* Limits at positions of a drive that the study does not name: each cut that has one adds a
 * configuration and its requirement to those of the subproblem. After the bands; cuts of bands
 * are ignored here. Fails: MT_E_MEMORY. */
static mt_status add_positions(mt_subproblem *c, int n_cuts, const mt_cut *cuts, mt_arena *mem,
                               mt_err *err)
{
    const mt_problem *const p = c->p;
    const int n_before = c->n_views;
    if (n_cuts == 0) {
        return MT_OK;
    }
    const size_t n_own = (size_t)p->n_requirements;
    const size_t n_views = (size_t)n_before + (size_t)n_cuts;
    mt_configuration_problem *const views = mt_arena_alloc(mem, n_views, sizeof *views);
    mt_requirement *const all = mt_arena_alloc(mem, n_own + (size_t)n_cuts, sizeof *all);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(views, c->views, (size_t)n_before * sizeof *views);
    memcpy(all, p->requirements, n_own * sizeof *all);
    for (int i = 0; i < n_cuts; i++) {
        if (cuts[i].requirement < 0) {
            continue;
        }
        const mt_requirement *const d = &p->requirements[cuts[i].requirement];
        mt_requirement *const here = &all[c->n_requirements];
        views[c->n_views] = view_at_cut(p, &cuts[i], &p->views[d->view]);
        *here = *d;
        here->index = c->n_requirements++;
        here->of.view = d->of.view == d->view ? c->n_views : d->of.view;
        here->view = c->n_views++;
    }
    c->views = views;
    c->requirements = all;
    return MT_OK;
}

static mt_status lay_out_positions(const mt_row_layout *l, mt_err *err)
{
    mt_subproblem *const c = l->c;
    MT_TRY(add_positions(c, l->n_cuts, l->cuts, l->mem, err));
    for (int i = c->p->n_requirements; i < c->n_requirements; i++) {
        const mt_requirement *const d = &c->requirements[i];
        MT_TRY(append_rows(l, MT_ROW_POSITION, d, d->tolerance, &c->rows.in, err));
    }
    return MT_OK;
}

static mt_status eval_positions(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                                mt_err *err)
{
    return eval_each(w, w->p->n_requirements, w->c->n_requirements, with_gradient, out, err);
}

const mt_row_ops mt_rows_positions = {.lay_out = lay_out_positions, .eval = eval_positions};

/*
 * Modes are sorted: f_k at least a limit means f_(k+1) at least it, too. Such rows require
 * nothing, but f_k has a kink where modes cross, and of a slope that is that of one mode here
 * and of another there a search learns little. With the rows of the modes that come next, where
 * they do not touch each other (those of different symmetry), all rows are smooth.
 */

/* Appends the rows that row `at` of `in` implies. */
static mt_status append_implied(const mt_row_layout *l, int at, mt_err *err)
{
    mt_row_table *const rows = &l->c->rows;
    mt_row next = rows->in.rows[at];
    const int mode = next.mode;
    const int most = mt_configuration_vibrations(&l->c->views[next.view]);
    const int step = next.sense == MT_AT_LEAST ? 1 : -1;
    next.kind = MT_ROW_ORDER;
    next.implied_by = at;
    for (int k = 1; k <= MT_MODE_ORDER_MOST; k++) {
        next.mode = mode + (k * step);
        if (next.mode < 1 || next.mode > most || !(next.limit > 0.0)) {
            break;
        }
        MT_TRY(mt_rows_append(&rows->next, &next, l->mem, err));
    }
    return MT_OK;
}

/* True where a row limits a frequency of a requirement, at the design or at a corner. */
static bool implies(const mt_subproblem *c, const mt_row *row, bool at_corner)
{
    const bool own = row->kind == MT_ROW_GOAL || row->kind == MT_ROW_CORNER;
    return own && row->requirement >= 0 && (row->corner >= 0) == at_corner &&
           mt_requirement_is_frequency(&c->requirements[row->requirement]);
}

/* Those of the design itself, then those at corners. */
static mt_status lay_out_order(const mt_row_layout *l, mt_err *err)
{
    mt_row_table *const rows = &l->c->rows;
    for (int i = 0; i < 2 * rows->in.n; i++) {
        const int at = i % rows->in.n;
        MT_TRY(implies(l->c, &rows->in.rows[at], i >= rows->in.n) ? append_implied(l, at, err)
                                                                  : MT_OK);
    }
    rows->next_of = mt_arena_int(l->mem, (size_t)rows->next.n);
    MT_TRY(mt_arena_check(l->mem, err));
    for (int i = 0; i < rows->next.n; i++) {
        rows->next_of[i] = rows->next.rows[i].implied_by;
    }
    return MT_OK;
}

static mt_status eval_order(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                            mt_err *err)
{
    const mt_subproblem *const c = w->c;
    const int n = w->p->n;
    const int rows = c->rows.next.n;
    for (int k = 0; out->next != NULL && k < rows; k++) {
        const mt_row *const row = &c->rows.next.rows[k];
        const mt_configuration_work *const view = &w->views[row->view];
        mt_analysis *const a = row->corner < 0 ? view->analysis : view->corners[row->corner];
        const double *const factor =
            row->corner < 0 ? NULL
                            : c->tolerance_box->views[row->view].corners[row->corner].factor;
        const int pos = mt_modal_flexible(&a->modes, row->mode);
        const double floor_hz = MT_FREQUENCY_FLOOR * row->limit;
        const double sign = mt_row_sign(row);
        out->next[k] = sign * mt_problem_ln_ratio(&a->modes, pos, row->limit, floor_hz);
        if (!with_gradient) {
            continue;
        }
        MT_TRY(mt_problem_dln_frequency(w, a, pos, floor_hz, w->dshape, err));
        for (int i = 0; i < c->n_t; i++) {
            const double part = i < n && factor != NULL ? factor[i] : 1.0;
            out->dnext[k + ((ptrdiff_t)i * rows)] = i < n ? sign * part * w->dshape[i] : 0.0;
        }
    }
    return MT_OK;
}

const mt_row_ops mt_rows_order = {.lay_out = lay_out_order, .eval = eval_order};
