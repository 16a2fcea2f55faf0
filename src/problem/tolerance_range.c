/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What frequencies and expressions do over the tolerances of one design. */
#include <math.h>
#include <string.h>

#include "problem/tolerance.h"
#include "prove/enclosure.h"

/* Modes of a view that are followed to their worst beside those that goals name: the frequency
 * table lists them. */
enum { FIRST_MODES = 4 };

/* The tolerances of the design at w->x. */
typedef struct box {
    mt_workspace *w;
    mt_arena *mem;
    double *lo; /* [n] */
    double *hi;
    double *soft; /* work */
    double *stiff;
    int *effects;
    bool of_rows; /* descent only to what rows limit */
    mt_ranges *out;
} box;

static mt_status make_box(mt_workspace *w, mt_arena *mem, mt_ranges *out, box *b, mt_err *err)
{
    const size_t n = (size_t)w->p->n;
    *b = (box){.w = w,
               .mem = mem,
               .lo = mt_arena_f64(mem, n, 1),
               .hi = mt_arena_f64(mem, n, 1),
               .soft = mt_arena_f64(mem, n, 1),
               .stiff = mt_arena_f64(mem, n, 1),
               .effects = mt_arena_int(mem, n),
               .out = out};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < w->p->n; i++) {
        const double half = mt_tolerance_of_variable(w->p, i) * fabs(w->x[i]);
        b->lo[i] = w->x[i] - half;
        b->hi[i] = w->x[i] + half;
    }
    return MT_OK;
}

/* The corners of the lowest and the highest value, from the effect of raising each input;
 * false: an input has both effects. */
static bool find_corners(const box *b)
{
    const double *const x = b->w->x;
    for (int i = 0; i < b->w->p->n; i++) {
        if (b->effects[i] == (MT_STIFFENS | MT_SOFTENS) && b->lo[i] < b->hi[i]) {
            return false;
        }
        const bool falls = b->effects[i] == MT_SOFTENS;
        b->soft[i] = b->effects[i] == 0 ? x[i] : falls ? b->hi[i] : b->lo[i];
        b->stiff[i] = b->effects[i] == 0 ? x[i] : falls ? b->lo[i] : b->hi[i];
    }
    return true;
}

/* Values at the two corners, which are the range. */
static mt_status evaluate_corners(const mt_tolerance_probe *q, const box *b, double *value,
                                  mt_tolerance_range *out, mt_err *err)
{
    for (int side = 0; side < MT_TOLERANCE_SIDES; side++) {
        const double *const x = side == MT_LOWEST ? b->soft : b->stiff;
        MT_TRY(q->eval(q->context, x, false, value, err));
        for (int k = 0; k < q->m; k++) {
            out[k].value[side] = value[k];
            out[k].proven = true;
            memcpy(out[k].at[side], x, (size_t)q->n * sizeof *x);
        }
    }
    return MT_OK;
}

static mt_status range_of(const box *b, mt_tolerance_probe *q, bool proven,
                          mt_tolerance_range *out, mt_err *err)
{
    double *const value = mt_arena_f64(b->mem, (size_t)q->m, 1);
    MT_TRY(mt_arena_check(b->mem, err));
    q->lo = b->lo;
    q->hi = b->hi;
    for (int k = 0; k < q->m; k++) {
        MT_TRY(mt_tolerance_range_init(b->w->p->n, b->mem, &out[k], err));
    }
    return proven && find_corners(b) ? evaluate_corners(q, b, value, out, err)
                                     : mt_tolerance_sample(q, b->mem, out, err);
}

typedef struct modes_of {
    const mt_problem *p;
    mt_analysis *a;
    int m;
    int sloped; /* of which slopes are asked for */
    long *solutions;
} modes_of;

static mt_status eval_modes(void *context, const double *x, bool with_gradient, double *value,
                            mt_err *err)
{
    const modes_of *const c = context;
    const mt_analysis_options opt = {.shapes = {.first = c->sloped},
                                     .gradient = with_gradient,
                                     .vectors = with_gradient,
                                     .accuracy = MT_MODAL_ACCURACY};
    mt_problem_note_modal(c->p, 1);
    ++*c->solutions;
    MT_TRY(mt_analysis_solve(c->a, x, &opt, err));
    for (int k = 0; k < c->m; k++) {
        const int pos = mt_modal_flexible(&c->a->modes, k + 1);
        value[k] = pos >= 0 ? mt_modal_hz(&c->a->modes, pos) : nan("");
    }
    return MT_OK;
}

static mt_status slope_modes(void *context, int k, double *slope, mt_err *err)
{
    const modes_of *const c = context;
    const int pos = mt_modal_flexible(&c->a->modes, k + 1);
    return pos >= 0 ? mt_analysis_dlambda_raw(c->a, pos, slope, err)
                    : mt_fail(err, MT_E_DOMAIN, "no such mode");
}

/* Accuracy of the descent: full for values that a row limits, `others` for the rest:
 * [modes][side]. */
static void choose_descents(const mt_workspace *w, int view, int modes,
                            mt_tolerance_descent others,
                            mt_tolerance_descent (*descents)[MT_TOLERANCE_SIDES])
{
    const mt_subproblem *const c = w->c;
    /* without an assignment bands have no rows yet, and limit all modes up to theirs */
    const int reach = c->below == NULL ? mt_avoidances_reach(w, view) : 0;
    for (int i = 0; i < MT_TOLERANCE_SIDES * modes; i++) {
        const bool reached = reach > 0 && i / MT_TOLERANCE_SIDES <= reach;
        descents[i / MT_TOLERANCE_SIDES][i % MT_TOLERANCE_SIDES] =
            reached ? MT_DESCENT_FINE : others;
    }
    for (int k = mt_tolerance_next_row(c, 0); k >= 0; k = mt_tolerance_next_row(c, k + 1)) {
        const mt_row *const row = &c->rows.in.rows[k];
        if (row->view == view && row->mode >= 1 && row->mode <= modes) {
            descents[row->mode - 1][row->sense] = MT_DESCENT_FINE;
        }
    }
}

typedef mt_tolerance_descent sides_descent[MT_TOLERANCE_SIDES];

static mt_status range_of_modes(const box *b, int view, int modes, mt_analysis *a, mt_err *err)
{
    char reason[MT_REASON_SIZE] = "";
    mt_enclosure *e = NULL;
    sides_descent *const descents = mt_arena_alloc(b->mem, (size_t)modes, sizeof *descents);
    MT_TRY(mt_arena_check(b->mem, err));
    choose_descents(b->w, view, modes, b->of_rows ? MT_DESCENT_NONE : MT_DESCENT_COARSE,
                    descents);
    modes_of c = {.p = b->w->p,
                  .a = a,
                  .m = b->out->n[view],
                  .sloped = modes,
                  .solutions = &b->out->solutions};
    mt_tolerance_probe q = {.n = b->w->p->n,
                            .m = c.m,
                            .n_descend = modes,
                            .descents =
                                (const mt_tolerance_descent(*)[MT_TOLERANCE_SIDES])descents,
                            .context = &c,
                            .eval = eval_modes,
                            .slope = slope_modes};
    MT_TRY(mt_enclosure_new(a, b->lo, b->hi, &e, reason, err));
    if (e != NULL) {
        mt_enclosure_effects(e, b->lo, b->hi, b->effects);
    }
    const bool enclosed = e != NULL;
    mt_enclosure_delete(e);
    return range_of(b, &q, enclosed, b->out->hz[view], err);
}

static mt_status range_view(const box *b, int view, int modes, mt_err *err)
{
    mt_ranges *const r = b->out;
    mt_analysis *a = NULL;
    mt_problem_note_modal(b->w->p, 1);
    r->solutions++;
    mt_status rc = mt_configuration_analyse(b->w->views[view].of, b->w->x, &a, err);
    const int all = rc == MT_OK ? mt_modal_vibrations(&a->modes) : 0;
    r->hz[view] = mt_arena_alloc(b->mem, (size_t)all, sizeof *r->hz[view]);
    r->n[view] = r->hz[view] == NULL ? 0 : all;
    rc = rc == MT_OK ? mt_arena_check(b->mem, err) : rc;
    rc = rc == MT_OK ? range_of_modes(b, view, modes, a, err) : rc;
    mt_analysis_delete(a);
    return rc;
}

typedef struct number_of {
    mt_workspace *w;
    mt_node node;
} number_of;

static mt_status eval_number(void *context, const double *x, bool with_gradient, double *value,
                             mt_err *err)
{
    const number_of *const c = context;
    mt_tolerance_work *const r = c->w->tolerance_box;
    mt_node bad = MT_NO_NODE;
    mt_err own = {0};
    const mt_status rc =
        with_gradient ? mt_program_gradient(&c->w->p->program, x, r->value, r->grad, &bad, &own)
                      : mt_program_eval(&c->w->p->program, x, r->value, &bad, &own);
    *value = r->value[c->node];
    return rc == MT_OK || (rc == MT_E_DOMAIN && bad > c->node)
               ? MT_OK
               : mt_fail(err, rc, "%s", own.text);
}

static mt_status slope_number(void *context, int k, double *slope, mt_err *err)
{
    const number_of *const c = context;
    (void)k;
    (void)err;
    memcpy(slope, c->w->tolerance_box->grad + ((ptrdiff_t)c->node * c->w->p->n),
           (size_t)c->w->p->n * sizeof *slope);
    return MT_OK;
}

/* All limits on expressions, of which one interval evaluation encloses all slopes. */
static mt_status range_numbers(const box *b, mt_err *err)
{
    const mt_problem *const p = b->w->p;
    const size_t n = (size_t)p->n;
    const size_t count = (size_t)p->program.count;
    double *const lo = mt_arena_f64(b->mem, count, 1);
    double *const hi = mt_arena_f64(b->mem, count, 1);
    double *const dlo = mt_arena_f64(b->mem, count, n);
    double *const dhi = mt_arena_f64(b->mem, count, n);
    MT_TRY(mt_arena_check(b->mem, err));
    mt_program_interval_gradient(&p->program, b->lo, b->hi, lo, hi, dlo, dhi);
    for (int k = 0; k < p->n_requirements; k++) {
        const mt_requirement *const d = &p->requirements[k];
        number_of c = {.w = b->w, .node = d->node};
        mt_tolerance_probe q = {.n = p->n,
                                .m = 1,
                                .n_descend = 1,
                                .context = &c,
                                .eval = eval_number,
                                .slope = slope_number};
        if (d->quantity != MT_QUANTITY_EXPRESSION) {
            continue;
        }
        for (int i = 0; i < p->n; i++) {
            const size_t at = ((size_t)d->node * n) + (size_t)i;
            b->effects[i] =
                (dhi[at] > 0.0 ? MT_STIFFENS : 0) | (dlo[at] < 0.0 ? MT_SOFTENS : 0);
        }
        MT_TRY(range_of(b, &q, true, &b->out->number[k], err));
    }
    return MT_OK;
}

/* Number of modes wanted of each configuration; 0: not used. */
static void count_modes(const mt_workspace *w, int *modes)
{
    const mt_problem *const p = w->p;
    for (int i = 0; i < p->n_requirements; i++) {
        const mt_requirement *const d = &p->requirements[i];
        if (d->view >= 0) {
            const int most = d->mode > FIRST_MODES ? d->mode : FIRST_MODES;
            modes[d->view] = most > modes[d->view] ? most : modes[d->view];
        }
    }
    for (int i = 0; i < p->n_avoidances; i++) {
        const int view = p->avoidances[i].view;
        const int reach = mt_avoidances_reach(w, view) + 1;
        const int most = reach > FIRST_MODES ? reach : FIRST_MODES;
        modes[view] = most > modes[view] ? most : modes[view];
    }
}

/* True where a row evaluated at sampled corners limits a mode of the configuration. */
static bool is_sampled_view(const mt_subproblem *c, int view)
{
    bool any = false;
    const bool exact = c->tolerance_box->views[view].exact;
    for (int k = mt_tolerance_next_row(c, 0); k >= 0 && !exact;
         k = mt_tolerance_next_row(c, k + 1)) {
        any = any || view == c->rows.in.rows[k].view;
    }
    return any;
}

static mt_status find_ranges(mt_workspace *w, bool of_rows, const bool *leave, mt_arena *mem,
                             mt_ranges *out, mt_err *err)
{
    const mt_problem *const p = w->p;
    const size_t n_views = (size_t)p->n_views;
    box b;
    int *const modes = mt_arena_int(mem, n_views);
    *out = (mt_ranges){.n_views = p->n_views,
                       .n_limits = p->n_requirements,
                       .n = mt_arena_int(mem, n_views),
                       .hz = mt_arena_alloc(mem, n_views, sizeof(mt_tolerance_range *)),
                       .number =
                           mt_arena_alloc(mem, (size_t)p->n_requirements, sizeof *out->number)};
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(make_box(w, mem, out, &b, err));
    b.of_rows = of_rows;
    count_modes(w, modes);
    for (int i = 0; i < p->n_views; i++) {
        const bool left = leave != NULL && leave[i];
        if (modes[i] > 0 && !left && (!of_rows || is_sampled_view(w->c, i))) {
            MT_TRY(range_view(&b, i, modes[i], err));
        }
    }
    return range_numbers(&b, err);
}

mt_status mt_tolerance_ranges(mt_workspace *w, mt_arena *mem, mt_ranges *out, mt_err *err)
{
    return find_ranges(w, false, NULL, mem, out, err);
}

mt_status mt_tolerance_ranges_of_rows(mt_workspace *w, const bool *leave, mt_arena *mem,
                                      mt_ranges *out, mt_err *err)
{
    return find_ranges(w, true, leave, mem, out, err);
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

const mt_ranges *mt_tolerance_known(const mt_workspace *w)
{
    return w->tolerance_box != NULL ? w->tolerance_box->ranges : NULL;
}

const mt_tolerance_range *mt_ranges_hz(const mt_ranges *r, int view, int mode)
{
    return r != NULL && mode >= 1 && mode <= r->n[view] ? &r->hz[view][mode - 1] : NULL;
}
