/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The coefficients that vary: each node once, in a program of their own, so that a box costs no
 * more than it must.
 *
 * An interval evaluation is tight where each input occurs once in an expression. Where one
 * occurs twice (h^3 b / (h b + ...)) the value at the right corner is used instead: over a box
 * in which the derivative's enclosure has one sign for an input, the extremes lie at that
 * input's ends; and the mean value, the better the smaller the box. Where even so a coefficient
 * is not shown to be positive over the bounds (d^2 - (d - 2 t)^2), they are divided until it
 * is, or an effort is spent; the bound that this gives holds for every box within them.
 */
#include "prove/coefficients.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "expr/interval.h"
#include "prove/terms.h"

/* Copy what the coefficients need of the system's program. */
static mt_status extract(mt_enclosure *e, const mt_program *from, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    int *const map = mt_arena_int(&e->scratch, (size_t)from->count);
    MT_TRY(mt_arena_check(&e->scratch, err));
    for (int i = 0; i < e->n_coefficients; i++) {
        map[e->sources[i]] = 1;
    }
    for (int i = from->count - 1; i >= 0; i--) {
        const mt_program_node *const n = &from->nodes[i];
        if (map[i] != 0 && n->a != MT_NO_NODE) {
            map[n->a] = 1;
        }
        if (map[i] != 0 && n->b != MT_NO_NODE) {
            map[n->b] = 1;
        }
    }
    MT_TRY(mt_program_init(&e->program, e->n_inputs, &e->mem, err));
    for (int i = 0; i < from->count; i++) {
        const mt_program_node *const n = &from->nodes[i];
        if (map[i] == 0) {
            continue;
        }
        if (n->op == MT_OP_CONST) {
            map[i] = mt_program_const(&e->program, n->value);
        } else if (n->op == MT_OP_PARAM) {
            map[i] = mt_program_input(&e->program, n->input, n->addr);
        } else if (n->b == MT_NO_NODE) {
            map[i] = mt_program_unary(&e->program, n->op, map[n->a], n->addr);
        } else {
            map[i] = mt_program_binary(&e->program, n->op, map[n->a], map[n->b], n->addr);
        }
    }
    for (int i = 0; i < e->n_coefficients; i++) {
        mt_enclosure_coefficient *const c = &e->coefficients[i];
        c->node = map[e->sources[i]];
        if (c->required == MT_SIGN_NEGATED) {
            c->node = mt_program_unary(&e->program, MT_OP_NEG, c->node, MT_NO_ADDR);
        }
    }
    mt_arena_rewind(&e->scratch, mark);
    return mt_program_finish(&e->program, err);
}

/* Find which coefficients an input reaches on two ways. (x * x is a square, enclosed as
 * one.) */
static mt_status find_dependent(mt_enclosure *e, mt_err *err)
{
    const mt_program *const p = &e->program;
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    const size_t inputs = (size_t)e->n_inputs;
    int *const ways = mt_arena_int(&e->scratch, (size_t)p->count * inputs);
    MT_TRY(mt_arena_check(&e->scratch, err));
    for (int i = 0; i < p->count; i++) {
        const mt_program_node *const n = &p->nodes[i];
        int *const own = ways + ((size_t)i * inputs);
        if (n->op == MT_OP_PARAM) {
            own[n->input] = 1;
        }
        for (size_t k = 0; k < inputs; k++) {
            const int a = n->a == MT_NO_NODE ? 0 : ways[((size_t)n->a * inputs) + k];
            const bool square = n->op == MT_OP_MUL && n->a == n->b;
            const int b = n->b == MT_NO_NODE || square ? 0 : ways[((size_t)n->b * inputs) + k];
            own[k] = a + b > 2 ? 2 : (a + b > own[k] ? a + b : own[k]);
        }
    }
    for (int i = 0; i < e->n_coefficients; i++) {
        mt_enclosure_coefficient *const c = &e->coefficients[i];
        for (size_t k = 0; k < inputs; k++) {
            c->dependent = c->dependent || ways[((size_t)c->node * inputs) + k] > 1;
        }
    }
    mt_arena_rewind(&e->scratch, mark);
    return MT_OK;
}

static void set_signs(mt_enclosure *e)
{
    mt_program_interval_gradient(&e->program, e->lower, e->upper, e->node[MT_LOW],
                                 e->node[MT_HIGH], e->dnode[MT_LOW], e->dnode[MT_HIGH]);
    for (int i = 0; i < e->n_coefficients; i++) {
        mt_enclosure_coefficient *const c = &e->coefficients[i];
        const size_t row = (size_t)c->node * (size_t)e->n_inputs;
        c->monotone = true;
        for (int k = 0; k < e->n_inputs; k++) {
            const double lo = e->dnode[MT_LOW][row + (size_t)k];
            const double hi = e->dnode[MT_HIGH][row + (size_t)k];
            c->sign[k] =
                (signed char)(lo >= 0.0 && hi > 0.0 ? 1 : (hi <= 0.0 && lo < 0.0 ? -1 : 0));
            c->monotone = c->monotone && (lo >= 0.0 || hi <= 0.0);
        }
    }
}

/* Sub-boxes of the bounds that one coefficient may cost. */
enum { LEAST_BOXES = 512 };

/* The input on which a coefficient depends that is widest as a share of the bounds; -1: none is
 * wide. */
static int widest_input(const mt_enclosure *e, const mt_enclosure_coefficient *c,
                        const double *lo, const double *hi)
{
    const mt_program *const p = &e->program;
    const uint64_t *const of_node = p->inputs_of + ((size_t)c->node * (size_t)p->words);
    int widest = -1;
    double most = 0.0;
    for (int k = 0; k < e->n_inputs; k++) {
        const double share = (hi[k] - lo[k]) / (e->upper[k] - e->lower[k]);
        if (mt_program_has_input(of_node, k) && share > most) {
            most = share;
            widest = k;
        }
    }
    return widest;
}

/* c->least, c->most over the bounds, by sub-boxes where one box does not show that they are
 * positive and finite. */
static mt_status refine_coefficient_range(mt_enclosure *e, int i, mt_err *err)
{
    mt_enclosure_coefficient *const c = &e->coefficients[i];
    const size_t n = (size_t)e->n_inputs;
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    double *const lo = mt_arena_f64(&e->scratch, n, LEAST_BOXES + 1);
    double *const hi = mt_arena_f64(&e->scratch, n, LEAST_BOXES + 1);
    int count = 1;
    MT_TRY(mt_arena_check(&e->scratch, err));
    memcpy(lo, e->lower, n * sizeof *lo);
    memcpy(hi, e->upper, n * sizeof *hi);
    double least = HUGE_VAL;
    double most = -HUGE_VAL;
    for (int boxes = 1; count > 0; boxes++) {
        double *const a = lo + ((size_t)(count - 1) * n);
        double *const b = hi + ((size_t)(count - 1) * n);
        mt_enclosure_bounds(e, a, b);
        const int k = widest_input(e, c, a, b);
        const bool fine = e->value[MT_LOW][i] >= 0.0 && isfinite(e->value[MT_HIGH][i]);
        if (fine || k < 0 || boxes >= LEAST_BOXES) {
            least = fmin(least, e->value[MT_LOW][i]);
            most = fmax(most, e->value[MT_HIGH][i]);
            count--;
            if (!fine) {
                break; /* no use in going on */
            }
            continue;
        }
        const double middle = a[k] + (0.5 * (b[k] - a[k]));
        memcpy(a + n, a, n * sizeof *a);
        memcpy(b + n, b, n * sizeof *b);
        b[k] = middle;
        a[n + (size_t)k] = middle;
        count++;
    }
    mt_arena_rewind(&e->scratch, mark);
    if (count == 0) {
        c->least = least;
        c->most = most;
    }
    return MT_OK;
}

static mt_status check_positive(mt_enclosure *e, bool *ok, char *reason, mt_err *err)
{
    mt_enclosure_bounds(e, e->lower, e->upper);
    for (int i = 0; i < e->n_coefficients; i++) {
        e->coefficients[i].least = e->value[MT_LOW][i];
        e->coefficients[i].most = e->value[MT_HIGH][i];
    }
    e->bounded = false;
    for (int i = 0; i < e->n_coefficients && *ok; i++) {
        mt_enclosure_coefficient *const c = &e->coefficients[i];
        if (c->dependent && !(c->least >= 0.0 && isfinite(c->most))) {
            MT_TRY(refine_coefficient_range(e, i, err));
        }
        const bool either = c->required != MT_SIGN_POSITIVE;
        *ok = (either ? isfinite(c->least) : c->least >= 0.0) && isfinite(c->most);
        if (!*ok) {
            (void)mt_snprintf(reason, MT_REASON_SIZE,
                              "%s of \"%s\" may be %s within the bounds",
                              c->mass ? "mass" : "stiffness", c->name,
                              c->least < 0.0 && !either ? "negative" : "without limit");
        }
    }
    e->bounded = *ok;
    mt_enclosure_bounds(e, e->lower, e->upper);
    return MT_OK;
}

mt_status mt_enclosure_collect(mt_enclosure *e, const mt_linear *lin, bool *ok, char *reason,
                               mt_err *err)
{
    MT_TRY(mt_enclosure_list_terms(e, lin, err));
    MT_TRY(extract(e, &mt_linear_system(lin)->program, err));
    const size_t inputs = (size_t)e->n_inputs;
    for (int s = 0; s < 2; s++) {
        e->value[s] = mt_arena_f64(&e->mem, (size_t)e->n_coefficients, 1);
        e->node[s] = mt_arena_f64(&e->mem, (size_t)e->program.count, 1);
        e->dnode[s] = mt_arena_f64(&e->mem, (size_t)e->program.count, inputs);
        e->corner_x[s] = mt_arena_f64(&e->mem, inputs, 1);
    }
    for (int i = 0; i < e->n_coefficients; i++) {
        e->coefficients[i].sign = mt_arena_alloc(&e->mem, inputs, sizeof(signed char));
    }
    MT_TRY(mt_arena_check(&e->mem, err));
    MT_TRY(find_dependent(e, err));
    set_signs(e);
    *ok = true;
    return check_positive(e, ok, reason, err);
}

/* The inputs at which a coefficient is least (side MT_LOW) or greatest: the end that its
 * derivative's sign says, the whole interval where it has none. */
static void corner_of(mt_enclosure *e, const mt_enclosure_coefficient *c, mt_side side,
                      const double *lo, const double *hi)
{
    const size_t row = (size_t)c->node * (size_t)e->n_inputs;
    for (int k = 0; k < e->n_inputs; k++) {
        const bool rises = e->dnode[MT_LOW][row + (size_t)k] >= 0.0;
        const bool falls = e->dnode[MT_HIGH][row + (size_t)k] <= 0.0;
        const bool at_low = side == MT_LOW ? rises : falls;
        const bool at_high = side == MT_LOW ? falls : rises;
        e->corner_x[MT_LOW][k] = at_high && !at_low ? hi[k] : lo[k];
        e->corner_x[MT_HIGH][k] = at_low ? lo[k] : hi[k];
    }
}

/* True where the box lies within the bounds. */
static bool within(const mt_enclosure *e, const double *lo, const double *hi)
{
    bool inside = true;
    for (int k = 0; k < e->n_inputs; k++) {
        inside = inside && lo[k] >= e->lower[k] && hi[k] <= e->upper[k];
    }
    return inside;
}

/* The middle of the box: f(x) = f(m) + sum_k f_k (x_k - m_k) with f_k from the gradient's
 * enclosure over the box, which dnode holds (mean value). */
static void mean_values(mt_enclosure *e, const double *lo, const double *hi)
{
    const size_t inputs = (size_t)e->n_inputs;
    for (size_t k = 0; k < inputs; k++) {
        e->corner_x[MT_LOW][k] = fmin(fmax(lo[k] + (0.5 * (hi[k] - lo[k])), lo[k]), hi[k]);
    }
    mt_program_interval(&e->program, e->corner_x[MT_LOW], e->corner_x[MT_LOW], e->node[MT_LOW],
                        e->node[MT_HIGH]);
    for (int i = 0; i < e->n_coefficients; i++) {
        const mt_node node = e->coefficients[i].node;
        mt_interval f = mt_interval_of(e->node[MT_LOW][node], e->node[MT_HIGH][node]);
        for (size_t k = 0; e->coefficients[i].dependent && k < inputs; k++) {
            const size_t at = ((size_t)node * inputs) + k;
            const mt_interval slope =
                mt_interval_of(e->dnode[MT_LOW][at], e->dnode[MT_HIGH][at]);
            const double m = e->corner_x[MT_LOW][k];
            const mt_interval away =
                mt_interval_sub(mt_interval_of(lo[k], hi[k]), mt_interval_of(m, m));
            f = mt_interval_add(f, mt_interval_mul(slope, away));
        }
        if (e->coefficients[i].dependent) { /* elsewhere a value is rounded as much as here */
            const double rounding = e->node[MT_HIGH][node] - e->node[MT_LOW][node];
            e->value[MT_LOW][i] = fmax(e->value[MT_LOW][i], f.lo - rounding);
            e->value[MT_HIGH][i] = fmin(e->value[MT_HIGH][i], f.hi + rounding);
        }
    }
}

/* Bounds of dependent coefficients: the best of the plain enclosure, the mean value's and that
 * of the corners. */
static void sharpen(mt_enclosure *e, const double *lo, const double *hi)
{
    mt_program_interval_gradient(&e->program, lo, hi, e->node[MT_LOW], e->node[MT_HIGH],
                                 e->dnode[MT_LOW], e->dnode[MT_HIGH]);
    mean_values(e, lo, hi);
    for (int i = 0; i < e->n_coefficients; i++) {
        const mt_enclosure_coefficient *const c = &e->coefficients[i];
        for (mt_side side = MT_LOW; c->dependent && side <= MT_HIGH; side++) {
            corner_of(e, c, side, lo, hi);
            mt_program_interval(&e->program, e->corner_x[MT_LOW], e->corner_x[MT_HIGH],
                                e->node[MT_LOW], e->node[MT_HIGH]);
            double *const v = &e->value[side][i];
            const double corner = e->node[side][c->node];
            *v = side == MT_LOW ? fmax(*v, corner) : fmin(*v, corner);
        }
    }
}

void mt_enclosure_bounds(mt_enclosure *e, const double *lo, const double *hi)
{
    bool dependent = false;
    mt_program_interval(&e->program, lo, hi, e->node[MT_LOW], e->node[MT_HIGH]);
    for (int i = 0; i < e->n_coefficients; i++) {
        const mt_enclosure_coefficient *const c = &e->coefficients[i];
        e->value[MT_LOW][i] = e->node[MT_LOW][c->node];
        e->value[MT_HIGH][i] = e->node[MT_HIGH][c->node];
        dependent = dependent || c->dependent;
    }
    if (!dependent) {
        return;
    }
    sharpen(e, lo, hi);
    for (int i = 0; i < e->n_coefficients && e->bounded && within(e, lo, hi); i++) {
        e->value[MT_LOW][i] = fmax(e->value[MT_LOW][i], e->coefficients[i].least);
        e->value[MT_HIGH][i] = fmin(e->value[MT_HIGH][i], e->coefficients[i].most);
    }
}
