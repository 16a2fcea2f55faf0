/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What frequencies and expressions do over the tolerances of one design. */
#include <math.h>
#include <string.h>

#include "problem/robust.h"
#include "prove/enclosure.h"

/* The tolerances of the design at w->x. */
typedef struct box {
    double *lo; /* [n] */
    double *hi;
    double *soft; /* work */
    double *stiff;
    int *effects;
} box;

static mt_status make_box(mt_workspace *w, box *b, mt_err *err)
{
    const size_t n = (size_t)w->p->n;
    *b = (box){.lo = mt_arena_f64(&w->mem, n, 1),
               .hi = mt_arena_f64(&w->mem, n, 1),
               .soft = mt_arena_f64(&w->mem, n, 1),
               .stiff = mt_arena_f64(&w->mem, n, 1),
               .effects = mt_arena_int(&w->mem, n)};
    MT_TRY(mt_arena_check(&w->mem, err));
    for (int i = 0; i < w->p->n; i++) {
        const double half = mt_robust_tolerance(w->p, i) * fabs(w->x[i]);
        b->lo[i] = w->x[i] - half;
        b->hi[i] = w->x[i] + half;
    }
    return MT_OK;
}

/* The corners of the lowest and the highest value by what raising each input does; false: one
 * of them does both. */
static bool find_corners(const mt_workspace *w, box *b)
{
    for (int i = 0; i < w->p->n; i++) {
        if (b->effects[i] == (MT_STIFFENS | MT_SOFTENS) && b->lo[i] < b->hi[i]) {
            return false;
        }
        const bool falls = b->effects[i] == MT_SOFTENS;
        b->soft[i] = b->effects[i] == 0 ? w->x[i] : falls ? b->hi[i] : b->lo[i];
        b->stiff[i] = b->effects[i] == 0 ? w->x[i] : falls ? b->lo[i] : b->hi[i];
    }
    return true;
}

/* Values at the two corners, which are the range. */
static mt_status settle(const mt_robust_probe *q, const box *b, double *value,
                        mt_robust_range *out, mt_err *err)
{
    for (int side = 0; side < MT_ROBUST_SIDES; side++) {
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

static mt_status range_of(mt_workspace *w, mt_robust_probe *q, box *b, bool proven,
                          mt_robust_range *out, mt_err *err)
{
    double *const value = mt_arena_f64(&w->mem, (size_t)q->m, 1);
    MT_TRY(mt_arena_check(&w->mem, err));
    q->lo = b->lo;
    q->hi = b->hi;
    for (int k = 0; k < q->m; k++) {
        MT_TRY(mt_robust_range_init(w->p->n, &w->mem, &out[k], err));
    }
    return proven && find_corners(w, b) ? settle(q, b, value, out, err)
                                        : mt_robust_sample(q, &w->mem, out, err);
}

typedef struct modes_of {
    mt_analysis *a;
    int m;
} modes_of;

static mt_status eval_modes(void *context, const double *x, bool with_gradient, double *value,
                            mt_err *err)
{
    const modes_of *const c = context;
    const mt_analysis_options opt = {
        .gradient = with_gradient, .vectors = with_gradient, .accuracy = true};
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

static mt_status range_of_modes(mt_workspace *w, int view, int modes, mt_analysis *a, box *b,
                                mt_err *err)
{
    mt_robust_work *const r = w->robust;
    char reason[MT_REASON_SIZE] = "";
    mt_enclosure *e = NULL;
    modes_of c = {.a = a, .m = r->n_ranges[view]};
    mt_robust_probe q = {.n = w->p->n,
                         .m = c.m,
                         .n_descend = modes,
                         .context = &c,
                         .eval = eval_modes,
                         .slope = slope_modes};
    MT_TRY(mt_enclosure_new(a, b->lo, b->hi, &e, reason, err));
    if (e != NULL) {
        mt_enclosure_effects(e, b->lo, b->hi, b->effects);
    }
    const bool enclosed = e != NULL;
    mt_enclosure_delete(e);
    return range_of(w, &q, b, enclosed, r->hz[view], err);
}

static mt_status range_view(mt_workspace *w, int view, int modes, box *b, mt_err *err)
{
    mt_robust_work *const r = w->robust;
    mt_analysis *a = NULL;
    mt_status rc = mt_view_analyse(w->views[view].of, w->x, &a, err);
    const int all = rc == MT_OK ? mt_modal_vibrations(&a->modes) : 0;
    r->hz[view] = mt_arena_alloc(&w->mem, (size_t)all, sizeof *r->hz[view]);
    r->n_ranges[view] = r->hz[view] == NULL ? 0 : all;
    rc = rc == MT_OK ? mt_arena_check(&w->mem, err) : rc;
    rc = rc == MT_OK ? range_of_modes(w, view, modes, a, b, err) : rc;
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
    mt_robust_work *const r = c->w->robust;
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
    memcpy(slope, c->w->robust->grad + ((ptrdiff_t)c->node * c->w->p->n),
           (size_t)c->w->p->n * sizeof *slope);
    return MT_OK;
}

/* All limits on expressions, of which one interval evaluation encloses all slopes. */
static mt_status range_numbers(mt_workspace *w, box *b, mt_err *err)
{
    const size_t n = (size_t)w->p->n;
    const size_t count = (size_t)w->p->program.count;
    double *const lo = mt_arena_f64(&w->mem, count, 1);
    double *const hi = mt_arena_f64(&w->mem, count, 1);
    double *const dlo = mt_arena_f64(&w->mem, count, n);
    double *const dhi = mt_arena_f64(&w->mem, count, n);
    MT_TRY(mt_arena_check(&w->mem, err));
    mt_program_interval_gradient(&w->p->program, b->lo, b->hi, lo, hi, dlo, dhi);
    for (int k = 0; k < w->p->n_demands; k++) {
        const mt_demand *const d = &w->p->demands[k];
        number_of c = {.w = w, .node = d->node};
        mt_robust_probe q = {.n = w->p->n,
                             .m = 1,
                             .n_descend = 1,
                             .context = &c,
                             .eval = eval_number,
                             .slope = slope_number};
        if (d->quantity != MT_QUANTITY_EXPRESSION) {
            continue;
        }
        for (int i = 0; i < w->p->n; i++) {
            const size_t at = ((size_t)d->node * n) + (size_t)i;
            b->effects[i] =
                (dhi[at] > 0.0 ? MT_STIFFENS : 0) | (dlo[at] < 0.0 ? MT_SOFTENS : 0);
        }
        MT_TRY(range_of(w, &q, b, true, &w->robust->number[k], err));
    }
    return MT_OK;
}

mt_status mt_robust_ranges(mt_workspace *w, const int *modes, mt_err *err)
{
    box b;
    MT_TRY(make_box(w, &b, err));
    for (int i = 0; i < w->p->n_views; i++) {
        if (modes[i] > 0) {
            MT_TRY(range_view(w, i, modes[i], &b, err));
        }
    }
    return range_numbers(w, &b, err);
}

bool mt_robust_proven(const mt_workspace *w)
{
    const mt_robust_work *const r = w->robust;
    bool proven = true;
    for (int i = 0; i < w->p->n_views; i++) {
        proven = proven && (r->n_ranges[i] == 0 || r->hz[i][0].proven);
    }
    for (int k = 0; k < w->p->n_demands; k++) {
        const bool limit = w->p->demands[k].quantity == MT_QUANTITY_EXPRESSION;
        proven = proven && (!limit || r->number[k].proven);
    }
    return proven;
}

const mt_robust_range *mt_robust_hz(const mt_workspace *w, int view, int mode)
{
    const mt_robust_work *const r = w->robust;
    return r != NULL && mode >= 1 && mode <= r->n_ranges[view] ? &r->hz[view][mode - 1] : NULL;
}
