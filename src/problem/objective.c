/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Objectives of any kind, and how those that come first are held while the next one is
 * searched. */

#include "problem/objective.h"

#include <float.h>
#include <math.h>

#include "base/text.h"
#include "problem/configuration.h"
#include "problem/requirement.h"

/* An objective is held within this part of its value (of its size, where it is below that). */
static const double HELD = 1e-6;
/* The same for the objectives that are half a square, of the root where it is below 1: a change
 * or a misfit of 1e-6 is none to an engineer. */
static const double HELD_ROOT = 1e-6;
/* A held objective may leave its limit by this part of what it was given above its optimum: the
 * optimum itself stays well inside. */
static const double HELD_TOLERANCE = 0.01;

static const double PERCENT = 100.0;

/* "change": f = 1/2 sum w_i (t_i - t_i(original))^2, of which each term is least at the end of
 * a box that is nearer to the original. */

static double evaluate_change(const mt_workspace *w, const mt_objective_stage *a,
                              double *gradient)
{
    double f = 0.0;
    (void)a;
    for (int i = 0; i < w->p->n; i++) {
        const double weight = w->p->study->variables[i].weight;
        const double d = w->t[i] - w->c->origin_t[i];
        f += 0.5 * weight * d * d;
        if (gradient != NULL) {
            gradient[i] = weight * d;
        }
    }
    return f;
}

/* Distance of a box from the original in coordinate i, less the rounding of its two logarithms
 * or quotients: near the original their difference has few digits. */
static double apart(const mt_problem *p, int i, double lo, double hi)
{
    const double origin = p->whole.origin_t[i];
    const double low = mt_problem_t(p, i, lo);
    const double high = mt_problem_t(p, i, hi);
    const double d = origin > high ? origin - high : low - origin;
    const double size = fmax(fabs(origin), fmax(fabs(low), fabs(high)));
    return fmax(d - (MT_OBJECTIVE_ULPS * DBL_EPSILON * size), 0.0);
}

static double change_least(
    const mt_problem *p, const mt_objective_stage *a, const double *lo, const double *hi,
    double *low,  /* NOLINT(readability-non-const-parameter): others write there */
    double *high) /* NOLINT(readability-non-const-parameter) */
{
    double f = 0.0;
    (void)a;
    (void)low;
    (void)high;
    for (int i = 0; i < p->n; i++) {
        const double d = apart(p, i, lo[i], hi[i]);
        f += 0.5 * p->study->variables[i].weight * d * d;
    }
    return f * (1.0 - (MT_OBJECTIVE_ULPS * (double)p->n * DBL_EPSILON));
}

/* dc = df / c, within a sixth of c - sqrt(c^2 - 2 df) up to a quarter of c^2. */
static const char *change_price(const mt_price *q, mt_arena *mem)
{
    return !(q->change > 0.0) || fabs(q->df) > 0.25 * q->change * q->change
               ? NULL
               : mt_arena_printf(mem, "the total change by %.3g %%",
                                 100.0 * q->df / (q->change * q->change));
}

/* At the optimum c u = mult g + ..., u of unit length: with the other rows held, the slope of
 * the requirement by the variables is at most c / mult. */
static const char *change_hardly(const mt_price *q, mt_arena *mem)
{
    return !(q->change > 0.0) || !(q->df > q->change)
               ? NULL
               : mt_arena_printf(mem, "moving it by 1 %% takes a total change of %.2g or more",
                                 q->df / q->change);
}

const mt_objective_ops mt_objective_change = {.value = evaluate_change,
                                              .least = change_least,
                                              .price = change_price,
                                              .hardly = change_hardly};

/*
 * "clearance": f = -ln(1 + least clearance of any mode from any band). In the search of one
 * mode placement that is the last coordinate, which every row of a band has to exceed
 * (avoidance.c); elsewhere mt_avoidances_margin looks it up among the modes.
 */

static double evaluate_clearance(const mt_workspace *w, const mt_objective_stage *a,
                                 double *gradient)
{
    (void)a;
    if (w->c->clearance && gradient != NULL) {
        gradient[w->p->n] = -1.0;
    }
    return w->c->clearance ? -w->t[w->p->n] : 0.0;
}

static double clearance_shown(double f)
{
    return PERCENT * expm1(-f);
}

static const char *clearance_price(const mt_price *q, mt_arena *mem)
{
    return mt_arena_printf(mem, "the least clearance by %.3g percentage points",
                           (PERCENT + q->score) * q->df);
}

const mt_objective_ops mt_objective_clearance = {
    .value = evaluate_clearance, .shown = clearance_shown, .price = clearance_price};

/* An expression of parameters: f = its value. */

static mt_status compile_expression_objective(mt_problem *p, mt_objective_stage *a,
                                              const mt_node *nodes, mt_err *err)
{
    (void)err;
    a->node =
        mt_program_expr(&p->program, &a->objective->expression, nodes, a->objective->addr);
    return MT_OK; /* the program tells when it is finished */
}

static double evaluate_expression_objective(const mt_workspace *w, const mt_objective_stage *a,
                                            double *gradient)
{
    for (int i = 0; i < w->p->n && gradient != NULL; i++) {
        gradient[i] = mt_workspace_dx_dt(w, i) * w->grad[((ptrdiff_t)a->node * w->p->n) + i];
    }
    return w->value[a->node];
}

static double expression_least(const mt_problem *p, const mt_objective_stage *a,
                               const double *lo, const double *hi, double *low, double *high)
{
    mt_program_interval(&p->program, lo, hi, low, high);
    return low[a->node];
}

static const char *expression_price(const mt_price *q, mt_arena *mem)
{
    return mt_arena_printf(mem, "the objective by %.3g", q->df);
}

const mt_objective_ops mt_objective_expression = {.compile = compile_expression_objective,
                                                  .value = evaluate_expression_objective,
                                                  .least = expression_least,
                                                  .price = expression_price};

/* "mass": f = sum of the masses of the items named, those of the first configuration that a
 * goal names. */

static bool counted(const mt_objective *o, const char *name)
{
    for (int i = 0; i < o->of.count; i++) {
        if (mt_text_matches(o->of.items[i].s, name)) {
            return true;
        }
    }
    return o->of.count == 0;
}

static mt_status compile_mass_objective(mt_problem *p, mt_objective_stage *a,
                                        const mt_node *nodes, mt_err *err)
{
    int view = 0;
    (void)nodes;
    if (p->n_views == 0) {
        MT_TRY(mt_problem_add_configuration(p, 0, &view, err));
    }
    const mt_system *const sys = p->views[view].original->sys;
    a->mass = mt_arena_alloc(&p->mem, (size_t)sys->n_items, sizeof *a->mass);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < sys->n_items; i++) {
        if (sys->items[i].mass != MT_NO_NODE && counted(a->objective, sys->items[i].name)) {
            a->mass[a->n_mass++] = sys->items[i].mass;
        }
    }
    if (a->n_mass == 0) {
        return mt_fail(err, MT_E_INPUT,
                       "objective \"mass\": nothing that is meant is part of configuration "
                       "\"%s\", the first that a goal names",
                       mt_analysis_configuration(p->views[view].original));
    }
    return MT_OK;
}

static double evaluate_mass(const mt_workspace *w, const mt_objective_stage *a,
                            double *gradient)
{
    const mt_linear *const lin = w->views[0].analysis->lin;
    double f = 0.0;
    for (int k = 0; k < a->n_mass; k++) {
        f += mt_linear_value(lin, a->mass[k]);
        for (int i = 0; i < w->p->n && gradient != NULL; i++) {
            gradient[i] += mt_workspace_dx_dt(w, i) * mt_linear_slope(lin, a->mass[k], i);
        }
    }
    return f;
}

static double mass_least(const mt_problem *p, const mt_objective_stage *a, const double *lo,
                         const double *hi, double *low, double *high)
{
    double f = 0.0;
    mt_program_interval(&p->views[0].original->sys->program, lo, hi, low, high);
    for (int k = 0; k < a->n_mass; k++) {
        f += low[a->mass[k]];
    }
    return f - (MT_OBJECTIVE_ULPS * (double)a->n_mass * DBL_EPSILON * fabs(f));
}

static const char *mass_price(const mt_price *q, mt_arena *mem)
{
    return q->first && fabs(q->df) > q->score
               ? NULL
               : mt_arena_printf(mem, "the mass by %.3g kg", q->df);
}

static const char *mass_hardly(const mt_price *q, mt_arena *mem)
{
    return !q->first || !(q->df > q->score)
               ? NULL
               : mt_arena_printf(mem, "1 %% of it is worth more than the whole mass");
}

const mt_objective_ops mt_objective_mass = {.compile = compile_mass_objective,
                                            .value = evaluate_mass,
                                            .least = mass_least,
                                            .price = mass_price,
                                            .hardly = mass_hardly};

/* "misfit": f = 1/2 |r|^2 of the weighted goals' residuals, df/dt = dr^T r. */

static double evaluate_misfit(const mt_workspace *w, const mt_objective_stage *a,
                              double *gradient)
{
    (void)a;
    for (int i = 0; i < w->p->n && gradient != NULL; i++) {
        gradient[i] = mt_dot(w->c->rows.res.n, w->dr + ((ptrdiff_t)i * w->c->rows.res.n), w->r);
    }
    return 0.5 * mt_dot(w->c->rows.res.n, w->r, w->r);
}

const mt_objective_ops mt_objective_misfit = {.value = evaluate_misfit};

/*
 * "vibration": f = the largest of ln(value / limit) over all goals of forced vibration that are
 * limited from above. In a search that is the last coordinate less MT_FORCED_RESPONSE_SHIFT,
 * which every row of these goals has to stay below (requirement.c): a minimax is smooth so.
 * Elsewhere it is looked up.
 */

static double evaluate_worst_vibration(const mt_workspace *w, const mt_objective_stage *a,
                                       double *gradient)
{
    (void)a;
    if (gradient != NULL && w->c->forced_response) {
        gradient[w->p->n] = 1.0;
    }
    return mt_forced_response_given(w) ? w->t[w->p->n] - MT_FORCED_RESPONSE_SHIFT : w->worst;
}

static double vibration_shown(double f)
{
    return PERCENT * exp(f);
}

static const char *vibration_price(const mt_price *q, mt_arena *mem)
{
    return mt_arena_printf(mem, "the largest part of a limit by %.3g percentage points",
                           q->score * q->df);
}

const mt_objective_ops mt_objective_vibration = {
    .value = evaluate_worst_vibration, .shown = vibration_shown, .price = vibration_price};

#define OPS(id, name, ...) &mt_objective_##name,
static const mt_objective_ops *const OPERATIONS[] = {MT_OBJECTIVE_LIST(OPS)};

const mt_objective_ops *mt_objective_ops_of(mt_objective_type type)
{
    return OPERATIONS[type];
}

const mt_objective_ops mt_objective_none = {.value = NULL};

double mt_objective_stage_value(const mt_workspace *w, int k, double *gradient)
{
    const mt_objective_stage *const a = &w->c->stages[k];
    for (int i = 0; i < w->c->n_t && gradient != NULL; i++) {
        gradient[i] = 0.0;
    }
    const double f = a->ops->value == NULL ? 0.0 : a->ops->value(w, a, gradient);
    for (int i = 0; i < w->c->n_t && gradient != NULL; i++) {
        gradient[i] /= a->size;
    }
    return f / a->size;
}

double mt_objective_stage_root(const mt_objective_stage *a, double f)
{
    return mt_objective_is(a->type, MT_HALF_SQUARE) ? sqrt(2.0 * (f < 0.0 ? 0.0 : f)) : f;
}

double mt_objective_stage_shown(const mt_objective_stage *a, double f)
{
    return a->ops->shown != NULL ? a->ops->shown(f) : mt_objective_stage_root(a, f * a->size);
}

/* Appends the rows that hold an objective; a misfit is held at the residuals of w. */
static void hold(mt_subproblem *c, const mt_workspace *w, int k, double f)
{
    mt_held *const held = &c->held[k];
    const double root = sqrt(2.0 * fmax(f, 0.0));
    const bool misfit = mt_objective_is(c->stages[k].type, MT_RESIDUALS);
    mt_row_block *const block = misfit ? &c->rows.eq : &c->rows.in;
    mt_row row = mt_row_init(MT_ROW_HELD, misfit ? MT_EQUAL : MT_AT_MOST);
    row.objective = k;
    if (misfit) {
        row.tolerance = HELD_ROOT * fmax(root, 1.0);
    } else if (mt_objective_is(c->stages[k].type, MT_HALF_SQUARE)) {
        const double most = root + (HELD_ROOT * fmax(root, 1.0));
        held->limit = 0.5 * most * most;
        held->unit = held->limit;
        row.tolerance = HELD_TOLERANCE * (held->limit - f) / held->unit;
    } else {
        held->unit = fmax(fabs(f), 1.0);
        held->limit = f + (HELD * held->unit);
        row.tolerance = HELD_TOLERANCE * (held->limit - f) / held->unit;
    }
    for (int i = 0; i < (misfit ? c->rows.res.n : 1); i++) {
        row.part = i;
        if (misfit) {
            c->r_held[i] = w->r[i];
        }
        block->tol[block->n] = row.tolerance;
        block->rows[block->n++] = row;
    }
}

static void drop_held(mt_row_block *block)
{
    while (block->n > 0 && block->rows[block->n - 1].kind == MT_ROW_HELD) {
        block->n--;
    }
}

void mt_objectives_hold(mt_subproblem *c, const mt_workspace *w, int stage, const double *f)
{
    drop_held(&c->rows.eq);
    drop_held(&c->rows.in);
    c->stage = stage;
    for (int k = 0; k < stage; k++) {
        hold(c, w, k, f[k]);
    }
}

static void eval_held_residual(const mt_workspace *w, int at, bool with_gradient,
                               mt_nlp_values *out)
{
    const mt_row_table *const rows = &w->c->rows;
    const int i = rows->eq.rows[at].part;
    out->eq[at] = w->r[i] - w->c->r_held[i];
    for (int j = 0; j < w->c->n_t && with_gradient; j++) {
        out->deq[at + ((ptrdiff_t)j * rows->eq.n)] =
            j < w->p->n ? w->dr[i + ((ptrdiff_t)j * rows->res.n)] : 0.0;
    }
}

static void eval_held_value(mt_workspace *w, int at, bool with_gradient, mt_nlp_values *out)
{
    const mt_subproblem *const c = w->c;
    const int k = c->rows.in.rows[at].objective;
    const mt_held *const held = &c->held[k];
    out->in[at] =
        (held->limit - mt_objective_stage_value(w, k, with_gradient ? w->work : NULL)) /
        held->unit;
    for (int j = 0; j < c->n_t && with_gradient; j++) {
        out->din[at + ((ptrdiff_t)j * c->rows.in.n)] = -w->work[j] / held->unit;
    }
}

static mt_status eval_held(mt_workspace *w, bool with_gradient, mt_nlp_values *out, mt_err *err)
{
    const mt_row_table *const rows = &w->c->rows;
    (void)err;
    for (int i = rows->eq.n - 1; i >= 0 && rows->eq.rows[i].kind == MT_ROW_HELD; i--) {
        eval_held_residual(w, i, with_gradient, out);
    }
    for (int i = rows->in.n - 1; i >= 0 && rows->in.rows[i].kind == MT_ROW_HELD; i--) {
        eval_held_value(w, i, with_gradient, out);
    }
    return MT_OK;
}

const mt_row_ops mt_rows_held = {.eval = eval_held}; /* mt_objectives_hold appends them */
