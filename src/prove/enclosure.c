/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is known of the terms of K and M over a box of the inputs, and of their eigenvalues. */
#include "prove/enclosure.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/count.h"
#include "base/format.h"
#include "expr/interval.h"
#include "linalg/dense.h"
#include "modal/modal.h"

void mt_enclosure_shaping(const mt_analysis *a, bool *found)
{
    for (int i = 0; i < a->sys->n_inputs; i++) {
        found[i] = mt_program_has_input(a->sys->frame, i);
    }
}

/*
 * The varying terms as coefficients c(x) >= 0 times positive semidefinite matrices. A term that
 * is a sum of squares of rows is one. A term that couples two rows,
 *     c (a b^T + b a^T) / 2,
 * is not; but all terms of one block (a bushing, an inertia tensor) whose coefficients are one
 * product f(x) times constants form f R^T B R with a constant B, which is semidefinite or not:
 * it is asked. Where it is not, or where there is no common f,
 *     c (a b^T + b a^T) / 2 = c (s a + b/s)(s a + b/s)^T / 4 - c (s a - b/s)(s a - b/s)^T / 4,
 * two semidefinite matrices with coefficients c and -c of either sign: bounds of them are
 * bounds still, less tight ones, the least loose with s^2 = |b|/|a|.
 */

enum { FACTORS = 8, STACK = 32, BLOCK = 6, BLOCK_TERMS = 64 };

static const mt_term_kind KINDS[MT_MATRICES] = {MT_TERM_STIFFNESS, MT_TERM_MASS};

/* Below minus this times n eps an eigenvalue of a block of unit diagonal is negative: rounding
 * of its constants. */
static const double NEGATIVE_ULPS = 16.0;

/* constant x product of base^power, bases ascending. */
typedef struct monomial {
    bool known;
    double constant;
    int n;
    mt_node base[FACTORS];
    int power[FACTORS];
} monomial;

static void add_factor(monomial *m, mt_node base, int power)
{
    int at = 0;
    while (at < m->n && m->base[at] < base) {
        at++;
    }
    if (at < m->n && m->base[at] == base) {
        m->power[at] += power;
        return;
    }
    if (m->n == FACTORS) {
        m->known = false;
        return;
    }
    for (int i = m->n++; i > at; i--) {
        m->base[i] = m->base[i - 1];
        m->power[i] = m->power[i - 1];
    }
    m->base[at] = base;
    m->power[at] = power;
}

static monomial monomial_of(const mt_program *p, mt_node node)
{
    monomial m = {.known = true, .constant = 1.0};
    mt_node todo[STACK] = {node};
    int power[STACK] = {1};
    for (int count = 1; count > 0 && m.known;) {
        const int w = power[--count];
        const mt_program_node *const n = &p->nodes[todo[count]];
        const bool product = n->op == MT_OP_MUL || n->op == MT_OP_DIV;
        if (n->op == MT_OP_CONST) {
            m.constant *= pow(n->value, (double)w);
        } else if (product && count + 2 <= STACK) {
            todo[count] = n->a;
            power[count++] = w;
            todo[count] = n->b;
            power[count++] = n->op == MT_OP_DIV ? -w : w;
        } else if (n->op == MT_OP_NEG) {
            m.constant *= w % 2 == 0 ? 1.0 : -1.0;
            todo[count] = n->a;
            power[count++] = w;
        } else {
            add_factor(&m, todo[count], w);
        }
    }
    m.known = m.known && isfinite(m.constant) && m.constant != 0.0;
    return m;
}

static bool proportional(const monomial *a, const monomial *b)
{
    bool same = a->known && b->known && a->n == b->n;
    for (int i = 0; same && i < a->n; i++) {
        same = a->base[i] == b->base[i] && a->power[i] == b->power[i];
    }
    return same;
}

/* Key of row `which` (0, 1) of a term: the measure of a spring, the body and axis of a
 * rotation; -1: terms that are in no block. */
static int key_of(const mt_linear *lin, mt_enclosure_matrix m, int term, int which)
{
    const mt_system *const sys = mt_linear_system(lin);
    const int source = mt_linear_terms(lin, KINDS[m])->terms[term].source;
    if (m == MT_STIFFNESS) {
        return sys->springs[source].measure[which];
    }
    const mt_inertia_def *const def = &sys->inertias[source];
    return def->kind == MT_INERTIA_ROTATION ? (def->body[0] * sys->n_vecs) + def->dir[which]
                                            : -1;
}

typedef struct block {
    monomial factor; /* of its terms, but for their constants */
    int n;
    int key[BLOCK];
    int n_terms;
    int term[BLOCK_TERMS];
    double constant[BLOCK_TERMS];
    int reference; /* of term: its coefficient is that of the block */
} block;

static int place_of(const block *b, int key)
{
    for (int i = 0; i < b->n; i++) {
        if (b->key[i] == key) {
            return i;
        }
    }
    return -1;
}

/* Let the block grow over the terms that couple one of its rows to another; false where it
 * grows too large. */
static bool grow(const mt_linear *lin, mt_enclosure_matrix m, block *b)
{
    const mt_term_list *const list = mt_linear_terms(lin, KINDS[m]);
    for (bool grown = true; grown;) {
        grown = false;
        for (int t = 0; t < list->n_terms; t++) {
            const int key[2] = {key_of(lin, m, t, 0), key_of(lin, m, t, 1)};
            const int known = place_of(b, key[0]) >= 0 ? 0 : 1;
            if (!list->terms[t].varies || !list->terms[t].pair || place_of(b, key[known]) < 0 ||
                place_of(b, key[1 - known]) >= 0) {
                continue;
            }
            const monomial f =
                monomial_of(&mt_linear_system(lin)->program, list->terms[t].coefficient);
            if (proportional(&f, &b->factor)) {
                if (b->n == BLOCK) {
                    return false;
                }
                b->key[b->n++] = key[1 - known];
                grown = true;
            }
        }
    }
    return true;
}

/* The terms of the block; false where there are too many, or none that could be its
 * reference. */
static bool gather_block_terms(const mt_linear *lin, mt_enclosure_matrix m,
                               const mt_enclosure *e, block *b)
{
    const mt_term_list *const list = mt_linear_terms(lin, KINDS[m]);
    b->reference = -1;
    for (int t = 0; t < list->n_terms; t++) {
        const mt_term *const term = &list->terms[t];
        if (!term->varies || e->of_term[m][t] >= 0 || place_of(b, key_of(lin, m, t, 0)) < 0 ||
            place_of(b, key_of(lin, m, t, 1)) < 0) {
            continue;
        }
        const monomial f = monomial_of(&mt_linear_system(lin)->program, term->coefficient);
        if (!proportional(&f, &b->factor)) {
            continue;
        }
        if (b->n_terms == BLOCK_TERMS) {
            return false;
        }
        if (!term->pair && b->reference < 0 && f.constant > 0.0) {
            b->reference = b->n_terms;
        }
        b->term[b->n_terms] = t;
        b->constant[b->n_terms++] = f.constant;
    }
    return b->reference >= 0;
}

/* B, lower, its diagonal made one so that units do not matter; false where an entry of that is
 * not positive. */
static bool block_matrix(const mt_linear *lin, mt_enclosure_matrix m, const block *b, double *a)
{
    const mt_term_list *const list = mt_linear_terms(lin, KINDS[m]);
    const double one = b->constant[b->reference];
    const ptrdiff_t n = b->n;
    double root[BLOCK] = {0.0};
    bool positive = true;
    for (int i = 0; i < b->n_terms; i++) {
        const ptrdiff_t r = place_of(b, key_of(lin, m, b->term[i], 0));
        const ptrdiff_t c = place_of(b, key_of(lin, m, b->term[i], 1));
        const double half = list->terms[b->term[i]].pair ? 0.5 : 1.0;
        a[(r > c ? r : c) + (n * (r > c ? c : r))] += half * b->constant[i] / one;
    }
    for (ptrdiff_t i = 0; i < n; i++) {
        positive = positive && a[i * (n + 1)] > 0.0;
        root[i] = sqrt(fabs(a[i * (n + 1)]));
    }
    for (ptrdiff_t i = 0; i < n * n && positive; i++) {
        a[i] /= root[i % n] * root[i / n];
    }
    return positive;
}

/* *yes: true where B is semidefinite, to rounding. */
static mt_status semidefinite(const mt_linear *lin, mt_enclosure_matrix m, const block *b,
                              mt_arena *scratch, bool *yes, mt_err *err)
{
    double a[BLOCK * BLOCK] = {0.0};
    double w[BLOCK] = {0.0};
    *yes = block_matrix(lin, m, b, a);
    if (*yes) {
        MT_TRY(mt_eig_sym(b->n, a, w, false, scratch, err));
        *yes = w[0] >= -NEGATIVE_ULPS * (double)b->n * DBL_EPSILON;
    }
    return MT_OK;
}

static const char *term_name(const mt_linear *lin, mt_enclosure_matrix m, int term)
{
    const mt_system *const sys = mt_linear_system(lin);
    const int source = mt_linear_terms(lin, KINDS[m])->terms[term].source;
    return m == MT_STIFFNESS ? sys->springs[source].name
                             : sys->items[sys->inertias[source].item].name;
}

static int add_coefficient(mt_enclosure *e, const mt_linear *lin, mt_enclosure_matrix m,
                           int term, mt_sign sign)
{
    const mt_node source = mt_linear_terms(lin, KINDS[m])->terms[term].coefficient;
    for (int i = 0; i < e->n_coefficients && sign == MT_SIGN_POSITIVE; i++) {
        if (e->sources[i] == source && e->coefficients[i].required == MT_SIGN_POSITIVE) {
            return i;
        }
    }
    e->sources[e->n_coefficients] = source;
    e->coefficients[e->n_coefficients].name = term_name(lin, m, term);
    e->coefficients[e->n_coefficients].mass = m == MT_MASS;
    e->coefficients[e->n_coefficients].required = sign;
    return e->n_coefficients++;
}

static void add_piece(mt_enclosure *e, mt_enclosure_matrix m, int term, int coefficient,
                      mt_enclosure_form form, double factor)
{
    e->pieces[e->n_pieces++] = (mt_enclosure_piece){
        .matrix = m, .term = term, .coefficient = coefficient, .form = form, .factor = factor};
    e->of_term[m][term] = coefficient;
}

/* The sum and the difference of its two rows. */
static void split_coupled_term(mt_enclosure *e, const mt_linear *lin, mt_enclosure_matrix m,
                               int term)
{
    const double *const a =
        mt_linear_row(lin, KINDS[m], mt_linear_terms(lin, KINDS[m])->terms[term].first);
    const int n = mt_linear_freedoms(lin);
    const double norm_a = mt_norm2(n, a);
    const double norm_b = mt_norm2(n, a + n);
    const double s = norm_a > 0.0 && norm_b > 0.0 ? sqrt(norm_b / norm_a) : 1.0;
    add_piece(e, m, term, add_coefficient(e, lin, m, term, MT_SIGN_NEGATED), MT_FORM_DIFFERENCE,
              s);
    add_piece(e, m, term, add_coefficient(e, lin, m, term, MT_SIGN_ANY), MT_FORM_SUM, s);
    if (e->coupled == NULL) {
        e->coupled = term_name(lin, m, term);
        e->coupled_mass = m == MT_MASS;
    }
}

/* One block at once, or this one of its terms alone. */
static mt_status list_pair(mt_enclosure *e, const mt_linear *lin, mt_enclosure_matrix m,
                           int term, mt_err *err)
{
    const mt_node node = mt_linear_terms(lin, KINDS[m])->terms[term].coefficient;
    block b = {.factor = monomial_of(&mt_linear_system(lin)->program, node),
               .n = 2,
               .key = {key_of(lin, m, term, 0), key_of(lin, m, term, 1)}};
    bool whole = b.factor.known && grow(lin, m, &b) && gather_block_terms(lin, m, e, &b);
    if (whole) {
        MT_TRY(semidefinite(lin, m, &b, &e->scratch, &whole, err));
    }
    if (!whole) {
        split_coupled_term(e, lin, m, term);
        return MT_OK;
    }
    const int c = add_coefficient(e, lin, m, b.term[b.reference], MT_SIGN_POSITIVE);
    for (int i = 0; i < b.n_terms; i++) {
        const bool pair = mt_linear_terms(lin, KINDS[m])->terms[b.term[i]].pair;
        add_piece(e, m, b.term[i], c, pair ? MT_FORM_PAIR : MT_FORM_ROWS,
                  b.constant[i] / b.constant[b.reference]);
    }
    return MT_OK;
}

static mt_status alloc_term_arrays(mt_enclosure *e, const mt_linear *lin, mt_err *err)
{
    const size_t n[MT_MATRICES] = {(size_t)mt_linear_terms(lin, MT_TERM_STIFFNESS)->n_terms,
                                   (size_t)mt_linear_terms(lin, MT_TERM_MASS)->n_terms};
    const size_t most = (2 * (n[0] + n[1])) + 1;
    e->sources = mt_arena_int(&e->mem, most);
    e->coefficients = mt_arena_alloc(&e->mem, most, sizeof *e->coefficients);
    e->pieces = mt_arena_alloc(&e->mem, most, sizeof *e->pieces);
    for (int m = 0; m < MT_MATRICES; m++) {
        e->of_term[m] = mt_arena_int(&e->mem, n[m] + 1);
        MT_TRY(mt_arena_check(&e->mem, err));
        for (size_t t = 0; t < n[m]; t++) {
            e->of_term[m][t] = -1;
        }
    }
    return MT_OK;
}

/* Couplings first: they take the squares of their block along. */
static mt_status list_matrix(mt_enclosure *e, const mt_linear *lin, mt_enclosure_matrix m,
                             mt_err *err)
{
    const mt_term_list *const list = mt_linear_terms(lin, KINDS[m]);
    for (int t = 0; t < list->n_terms; t++) {
        if (list->terms[t].varies && list->terms[t].pair && e->of_term[m][t] < 0) {
            MT_TRY(list_pair(e, lin, m, t, err));
        }
    }
    for (int t = 0; t < list->n_terms; t++) {
        if (list->terms[t].varies && e->of_term[m][t] < 0) {
            add_piece(e, m, t, add_coefficient(e, lin, m, t, MT_SIGN_POSITIVE), MT_FORM_ROWS,
                      1.0);
        }
    }
    return MT_OK;
}

/* List the coefficients (without their nodes) and pieces of all varying terms. */
static mt_status enclosure_list_terms(mt_enclosure *e, const mt_linear *lin, mt_err *err)
{
    MT_TRY(alloc_term_arrays(e, lin, err));
    MT_TRY(list_matrix(e, lin, MT_STIFFNESS, err));
    return list_matrix(e, lin, MT_MASS, err);
}

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
        map[i] = mt_program_copy(&e->program, n, n->a == MT_NO_NODE ? MT_NO_NODE : map[n->a],
                                 n->b == MT_NO_NODE ? MT_NO_NODE : map[n->b]);
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
        const double range = e->upper[k] - e->lower[k]; /* 0: a column of one value */
        const double share = range > 0.0 ? (hi[k] - lo[k]) / range : 0.0;
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

/* Collect the coefficients of all varying terms, each node once, with a program of their own
 * and their bounds over the enclosure's bounds. *ok is false, with the reason, where one may be
 * negative there. */
static mt_status enclosure_collect(mt_enclosure *e, const mt_linear *lin, bool *ok,
                                   char *reason, mt_err *err)
{
    MT_TRY(enclosure_list_terms(e, lin, err));
    MT_TRY(extract(e, &mt_linear_system(lin)->program, err));
    const size_t inputs = (size_t)e->n_inputs;
    for (int s = 0; s < 2; s++) {
        e->value[s] = mt_arena_f64(&e->mem, (size_t)e->n_coefficients, 1);
        e->node[s] = mt_arena_f64(&e->mem, (size_t)e->program.count, 1);
        e->dnode[s] = mt_arena_f64(&e->mem, (size_t)e->program.count, inputs);
        e->corner_x[s] = mt_arena_f64(&e->mem, inputs, 1);
    }
    e->corner = mt_arena_alloc(&e->mem, inputs, 1);
    for (int i = 0; i < e->n_coefficients; i++) {
        e->coefficients[i].sign = mt_arena_alloc(&e->mem, inputs, sizeof(signed char));
    }
    MT_TRY(mt_arena_check(&e->mem, err));
    MT_TRY(find_dependent(e, err));
    set_signs(e);
    *ok = true;
    return check_positive(e, ok, reason, err);
}

/* Where an input stands at an extreme of a coefficient: anywhere where the coefficient does not
 * depend on it, at the end that the sign of its derivative says, over its whole interval where
 * it has none. */
typedef enum corner_place { CORNER_ANY, CORNER_LOW, CORNER_HIGH, CORNER_WHOLE } corner_place;

static corner_place place_in_corner(const mt_enclosure *e, const mt_enclosure_coefficient *c,
                                    mt_side side, int k)
{
    const size_t at = ((size_t)c->node * (size_t)e->n_inputs) + (size_t)k;
    const bool rises = e->dnode[MT_LOW][at] >= 0.0;
    const bool falls = e->dnode[MT_HIGH][at] <= 0.0;
    if (rises == falls) {
        return rises ? CORNER_ANY : CORNER_WHOLE;
    }
    return rises == (side == MT_LOW) ? CORNER_LOW : CORNER_HIGH;
}

/* Adds the corner of the coefficient to corner[n_inputs] where both agree. */
static bool share_corner(const mt_enclosure *e, const mt_enclosure_coefficient *c, mt_side side,
                         unsigned char *corner)
{
    for (int k = 0; k < e->n_inputs; k++) {
        const corner_place own = place_in_corner(e, c, side, k);
        if (own != CORNER_ANY && corner[k] != CORNER_ANY && corner[k] != own) {
            return false;
        }
    }
    for (int k = 0; k < e->n_inputs; k++) {
        const corner_place own = place_in_corner(e, c, side, k);
        corner[k] = own != CORNER_ANY ? (unsigned char)own : corner[k];
    }
    return true;
}

/* Enclosures of the program's nodes in the corner. */
static void enclose_corner(mt_enclosure *e, const double *lo, const double *hi)
{
    for (int k = 0; k < e->n_inputs; k++) {
        e->corner_x[MT_LOW][k] = e->corner[k] == CORNER_HIGH ? hi[k] : lo[k];
        e->corner_x[MT_HIGH][k] = e->corner[k] >= CORNER_HIGH ? hi[k] : lo[k];
    }
    mt_program_interval(&e->program, e->corner_x[MT_LOW], e->corner_x[MT_HIGH], e->node[MT_LOW],
                        e->node[MT_HIGH]);
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

/* Bounds by corners on one side: coefficients whose corners agree share one. */
static void sharpen_by_corners(mt_enclosure *e, mt_side side, const double *lo,
                               const double *hi)
{
    for (int i = 0; i < e->n_coefficients; i++) {
        e->coefficients[i].open = e->coefficients[i].dependent;
    }
    for (int first = 0; first < e->n_coefficients; first++) {
        if (!e->coefficients[first].open) {
            continue;
        }
        memset(e->corner, CORNER_ANY, (size_t)e->n_inputs);
        for (int i = first; i < e->n_coefficients; i++) {
            mt_enclosure_coefficient *const c = &e->coefficients[i];
            c->shares = c->open && share_corner(e, c, side, e->corner);
            c->open = c->open && !c->shares;
        }
        enclose_corner(e, lo, hi);
        for (int i = first; i < e->n_coefficients; i++) {
            double *const v = &e->value[side][i];
            const double at_corner = e->node[side][e->coefficients[i].node];
            if (e->coefficients[i].shares) {
                *v = side == MT_LOW ? fmax(*v, at_corner) : fmin(*v, at_corner);
            }
        }
    }
}

/* Bounds of dependent coefficients: the best of the plain enclosure, the mean value's and that
 * of the corners. The gradient's enclosure is in dnode. */
static void sharpen(mt_enclosure *e, const double *lo, const double *hi)
{
    mean_values(e, lo, hi);
    sharpen_by_corners(e, MT_LOW, lo, hi);
    sharpen_by_corners(e, MT_HIGH, lo, hi);
}

void mt_enclosure_bounds(mt_enclosure *e, const double *lo, const double *hi)
{
    bool dependent = false;
    for (int i = 0; i < e->n_coefficients; i++) {
        dependent = dependent || e->coefficients[i].dependent;
    }
    if (dependent) {
        mt_program_interval_gradient(&e->program, lo, hi, e->node[MT_LOW], e->node[MT_HIGH],
                                     e->dnode[MT_LOW], e->dnode[MT_HIGH]);
    } else {
        mt_program_interval(&e->program, lo, hi, e->node[MT_LOW], e->node[MT_HIGH]);
    }
    for (int i = 0; i < e->n_coefficients; i++) {
        e->value[MT_LOW][i] = e->node[MT_LOW][e->coefficients[i].node];
        e->value[MT_HIGH][i] = e->node[MT_HIGH][e->coefficients[i].node];
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

/*
 * Coordinates in which the eigenvalue problem of every box is (nearly) a standard one: M_low is
 * the mass at the low end of the bounds, W the basis with W^T M_low W = I. Then W^T M(x) W >= I
 * within the bounds, so a perturbation of norm e of W^T (K - lambda M) W moves no eigenvalue by
 * more than e.
 *
 * Regular M_low = L L^T: W = L^-T, which keeps chains sparse (L is diagonal there). Directions
 * T0 without mass: where the varying springs do not act on them (T0^T r = 0), their static
 * condensation is the same at every design, and the mode shapes Y at the soft corner span {y:
 * T0^T K y = 0}: W = Y.
 */

typedef struct basis {
    const mt_linear *lin;
    int n;           /* freedoms of the analysis */
    int r;           /* order of the enclosure: directions with mass */
    const double *l; /* n x n Cholesky factor of M_low; NULL where y is used */
    const double *y; /* n x r */
    double condition;
    double *k_low; /* n x n, full */
    double *m_low;
} basis;

/* The massless part of a varying spring's row, relative to the row, that counts as none:
 * rounding of rows and null space. */
static const double MASSLESS_SHARE = 1e-12;

static mt_status room(mt_arena *mem, size_t m, size_t n, double **out, mt_err *err)
{
    *out = mt_arena_f64(mem, m, n);
    return mt_arena_check(mem, err);
}

/* out (r) = W^T row; without a basis the row itself. */
static void to_basis(const basis *b, int n, const double *row, double *out)
{
    if (b == NULL || b->l != NULL) {
        memcpy(out, row, (size_t)n * sizeof *out);
    }
    if (b != NULL && b->l != NULL) {
        mt_tri_solve(false, n, 1, b->l, out, n);
    } else if (b != NULL) {
        mt_gemv(true, n, b->r, 1.0, b->y, n, row, 0.0, out);
    }
}

/* dense (r x r, lower) += weight x piece, in the basis b (NULL: as the rows are). work: 4 n. */
static void add_piece_of_basis(const mt_linear *lin, const basis *b,
                               const mt_enclosure_piece *p, double weight, double *work,
                               double *dense)
{
    const int n = mt_linear_freedoms(lin);
    const ptrdiff_t r = b == NULL ? n : b->r;
    const mt_term *const t = &mt_linear_terms(lin, KINDS[p->matrix])->terms[p->term];
    const double *const rows = mt_linear_row(lin, KINDS[p->matrix], t->first);
    const bool whole = p->form == MT_FORM_SUM || p->form == MT_FORM_DIFFERENCE;
    const double c = whole ? 0.25 * weight : p->factor * weight;
    double *const v = work + (2 * (ptrdiff_t)n);
    double *const second = work + n;
    for (int k = 0; k < n && whole; k++) {
        const double other = rows[n + k] / p->factor;
        v[k] = (p->factor * rows[k]) + (p->form == MT_FORM_SUM ? other : -other);
    }
    if (p->form == MT_FORM_PAIR) {
        to_basis(b, n, rows + n, second);
    }
    for (int i = 0; i < (p->form == MT_FORM_ROWS ? t->count : 1); i++) {
        to_basis(b, n, whole ? v : rows + ((ptrdiff_t)i * n), work);
        const double *const other = p->form == MT_FORM_PAIR ? second : work;
        for (ptrdiff_t j = 0; j < r; j++) {
            for (ptrdiff_t k = j; k < r; k++) {
                dense[k + (j * r)] +=
                    0.5 * ((c * work[k] * other[j]) + (c * other[k] * work[j]));
            }
        }
    }
}

/* fixed + sum of the varying terms with their coefficients at the low end of the bounds. */
static mt_status low_matrix(const mt_enclosure *e, const mt_linear *lin,
                            mt_enclosure_matrix which, mt_arena *mem, double **out, mt_err *err)
{
    const ptrdiff_t n = mt_linear_freedoms(lin);
    double *work = NULL;
    MT_TRY(room(mem, (size_t)n, 4, &work, err));
    MT_TRY(room(mem, (size_t)n, (size_t)n, out, err));
    memcpy(*out, mt_linear_fixed(lin, KINDS[which]), (size_t)(n * n) * sizeof **out);
    for (int i = 0; i < e->n_pieces; i++) {
        if (e->pieces[i].matrix == which) {
            add_piece_of_basis(lin, NULL, &e->pieces[i],
                               e->value[MT_LOW][e->pieces[i].coefficient], work, *out);
        }
    }
    mt_symmetrise_lower((int)n, *out);
    return MT_OK;
}

/* max_i m_ii (Y Y^T)_ii: how oblique the coordinates are to M. */
static double condition_of(const basis *b)
{
    double most = 1.0;
    for (ptrdiff_t i = 0; i < b->n; i++) {
        double sum = 0.0;
        for (ptrdiff_t j = 0; j < b->r; j++) {
            sum += b->y[i + (j * b->n)] * b->y[i + (j * b->n)];
        }
        most = fmax(most, b->m_low[i + (i * b->n)] * sum);
    }
    return most;
}

/* *ok: false where a varying spring acts on the directions without mass, or a varying mass may
 * fade. */
static mt_status check_massless(const mt_enclosure *e, const basis *b, mt_arena *scratch,
                                bool *ok, char *reason, mt_err *err)
{
    const size_t n = (size_t)b->n;
    const size_t z = n - (size_t)b->r;
    const mt_linear *const lin = b->lin;
    double *my = NULL;
    double *t0 = NULL;
    double *part = NULL;
    mt_qr qr;
    MT_TRY(room(scratch, n, (size_t)b->r, &my, err));
    MT_TRY(room(scratch, n, z, &t0, err));
    MT_TRY(room(scratch, z, 1, &part, err));
    mt_symm(b->n, b->r, b->m_low, b->y, my);
    MT_TRY(mt_qr_factor(b->n, b->r, my, b->n, 0.0, scratch, &qr, err));
    MT_TRY(mt_qr_q(&qr, b->r, t0, scratch, err));
    const mt_term_list *const list = mt_linear_terms(lin, MT_TERM_STIFFNESS);
    for (int i = 0; i < list->n_rows && *ok; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        const double *const row = mt_linear_row(lin, MT_TERM_STIFFNESS, i);
        mt_gemv(true, b->n, (int)z, 1.0, t0, b->n, row, 0.0, part);
        if (t->varies && mt_norm2((int)z, part) > MASSLESS_SHARE * mt_norm2(b->n, row)) {
            *ok = false;
            (void)mt_snprintf(reason, MT_REASON_SIZE,
                              "spring \"%s\" acts on a massless freedom",
                              mt_linear_system(lin)->springs[t->source].name);
        }
    }
    for (int i = 0; i < e->n_coefficients && *ok; i++) {
        const mt_enclosure_coefficient *const c = &e->coefficients[i];
        const bool mass = c->part[MT_MASS].count < 0; /* marked by find_kinds */
        if (mass && !(c->least > 0.0)) {
            *ok = false;
            (void)mt_snprintf(reason, MT_REASON_SIZE,
                              "mass of \"%s\" may vanish within the bounds", c->name);
        }
    }
    return MT_OK;
}

/* The reason for K low or M low not being positive: the model, or bounds of couplings that are
 * too loose to tell. */
static void say_lost(const mt_enclosure *e, bool unstable, char *reason)
{
    if (e->coupled != NULL) {
        (void)mt_snprintf(reason, MT_REASON_SIZE, "%s \"%s\" %s",
                          e->coupled_mass ? "body" : "spring", e->coupled,
                          e->coupled_mass
                              ? "has a product of inertia that varies"
                              : "couples two directions with a stiffness that varies");
        return;
    }
    (void)mt_snprintf(reason, MT_REASON_SIZE, "%s",
                      unstable
                          ? "the mechanism may be unstable within the bounds"
                          : "a freedom may lose its mass or its stiffness within the bounds");
}

/* Modes of (K low, M low) show an instability; and they are the basis where M is singular. */
static mt_status choose_mass_basis(mt_enclosure *e, basis *b, bool *ok, char *reason,
                                   mt_err *err)
{
    mt_mass_factor mass;
    mt_modes modes;
    mt_modal_options opt = mt_modal_options_default();
    opt.n_rigid = e->n_rigid;
    opt.check = false;
    mt_status rc = mt_modal_factor_mass(b->n, b->m_low, &e->scratch, &mass, err);
    rc = rc == MT_OK ? mt_modal_solve(b->k_low, &mass, NULL, &opt, &e->scratch, &modes, err)
                     : rc;
    *ok = rc == MT_OK && mt_modal_indexed(&modes);
    if (rc == MT_E_NOT_SPD || rc == MT_E_MASSLESS || (rc == MT_OK && !*ok)) {
        say_lost(e, rc == MT_OK, reason);
        return MT_OK;
    }
    MT_TRY(rc);
    b->r = mass.rank;
    if (b->r == b->n && isfinite(mass.condition)) {
        double *l = NULL;
        MT_TRY(room(&e->scratch, (size_t)b->n, (size_t)b->n, &l, err));
        memcpy(l, b->m_low, (size_t)b->n * (size_t)b->n * sizeof *l);
        MT_TRY(mt_cholesky(b->n, l, NULL, err));
        b->l = l;
        b->condition = mass.condition;
        return MT_OK;
    }
    b->y = modes.y;
    b->condition = condition_of(b);
    return b->r == b->n ? MT_OK : check_massless(e, b, &e->scratch, ok, reason, err);
}

/* W^T A W of a fixed matrix (lower triangle given), full. */
static mt_status to_basis_matrix(const basis *b, const double *a, mt_arena *scratch,
                                 double *out, mt_err *err)
{
    double *full = NULL;
    double *ay = NULL;
    MT_TRY(room(scratch, (size_t)b->n, (size_t)b->n, &full, err));
    memcpy(full, a, (size_t)b->n * (size_t)b->n * sizeof *full);
    mt_symmetrise_lower(b->n, full);
    if (b->l != NULL) {
        mt_congruence_inverse(b->n, b->l, full);
        memcpy(out, full, (size_t)b->n * (size_t)b->n * sizeof *out);
        return MT_OK;
    }
    MT_TRY(room(scratch, (size_t)b->n, (size_t)b->r, &ay, err));
    mt_symm(b->n, b->r, full, b->y, ay);
    mt_gemm(true, false, b->r, b->r, b->n, 1.0, b->y, b->n, ay, b->n, 0.0, out, b->r);
    return MT_OK;
}

/* dense (r x r, lower): the sum of a coefficient's pieces in the basis; returns whether there
 * are any. */
static bool add_pieces(const mt_enclosure *e, const basis *b, mt_enclosure_matrix which,
                       int coefficient, double *work, double *dense)
{
    bool any = false;
    memset(dense, 0, (size_t)b->r * (size_t)b->r * sizeof *dense);
    for (int i = 0; i < e->n_pieces; i++) {
        const mt_enclosure_piece *const p = &e->pieces[i];
        if (p->matrix == which && p->coefficient == coefficient) {
            any = true;
            add_piece_of_basis(b->lin, b, p, 1.0, work, dense);
        }
    }
    return any;
}

static mt_status make_part(const double *dense, ptrdiff_t r, mt_arena *mem,
                           mt_enclosure_part *part, mt_err *err)
{
    int count = 0;
    for (ptrdiff_t i = 0; i < r * r; i++) {
        count += dense[i] != 0.0 ? 1 : 0;
    }
    part->at = mt_arena_int(mem, (size_t)count);
    part->value = mt_arena_f64(mem, (size_t)count, 1);
    MT_TRY(mt_arena_check(mem, err));
    part->count = 0;
    for (ptrdiff_t i = 0; i < r * r; i++) {
        if (dense[i] != 0.0) {
            part->at[part->count] = (int)i;
            part->value[part->count++] = dense[i];
        }
    }
    for (ptrdiff_t i = 0; i < r; i++) {
        part->trace += dense[i + (i * r)];
    }
    return MT_OK;
}

/* The parts of coefficient i in both matrices. */
static mt_status parts_of(mt_enclosure *e, const basis *b, int i, double *work, double *dense,
                          mt_err *err)
{
    for (mt_enclosure_matrix m = MT_STIFFNESS; m < MT_MATRICES; m++) {
        mt_enclosure_part *const part = &e->coefficients[i].part[m];
        part->count = 0;
        if (add_pieces(e, b, m, i, work, dense)) {
            MT_TRY(make_part(dense, b->r, &e->mem, part, err));
        }
        e->mass_varies = e->mass_varies || (m == MT_MASS && part->count > 0);
    }
    return MT_OK;
}

static mt_status make_parts(mt_enclosure *e, const basis *b, mt_err *err)
{
    double *dense = NULL;
    double *work = NULL;
    MT_TRY(room(&e->scratch, (size_t)b->r, (size_t)b->r, &dense, err));
    MT_TRY(room(&e->scratch, (size_t)b->n, 4, &work, err));
    for (int i = 0; i < e->n_coefficients; i++) {
        MT_TRY(parts_of(e, b, i, work, dense, err));
    }
    return MT_OK;
}

static bool all_squares(const mt_linear *lin)
{
    bool squares = true;
    for (int m = 0; m < MT_MATRICES; m++) {
        const mt_term_list *const list = mt_linear_terms(lin, KINDS[m]);
        for (int i = 0; i < list->n_terms; i++) {
            const mt_term *const t = &list->terms[i];
            const double c = t->varies ? 0.0 : mt_linear_value(lin, t->coefficient);
            squares = squares && (c == 0.0 || (c > 0.0 && !t->pair));
        }
    }
    return squares;
}

/*
 * Slack of an eigenvalue relative to the trace of K (or of lambda M): ROUNDING_ULPS (n + terms)
 * eps, times the condition of the basis, for the rounding of the rows in the basis (n eps each,
 * amplified by the condition), of sums of `terms` parts, and of the model's own evaluation. 16
 * as the modal room counts (modal/modes.h).
 */
static const double ROUNDING_ULPS = 16.0;

static mt_status reduce_to_basis(mt_enclosure *e, basis *b, bool *ok, char *reason, mt_err *err)
{
    const mt_linear *const lin = b->lin;
    for (int i = 0; i < e->n_pieces; i++) { /* masses, until make_parts fills them */
        if (e->pieces[i].matrix == MT_MASS) {
            e->coefficients[e->pieces[i].coefficient].part[MT_MASS].count = -1;
        }
    }
    MT_TRY(low_matrix(e, lin, MT_STIFFNESS, &e->scratch, &b->k_low, err));
    MT_TRY(low_matrix(e, lin, MT_MASS, &e->scratch, &b->m_low, err));
    MT_TRY(choose_mass_basis(e, b, ok, reason, err));
    if (!*ok) {
        return MT_OK;
    }
    const size_t r = (size_t)b->r;
    e->n = b->r;
    e->n_modes = e->n - e->n_rigid;
    MT_TRY(make_parts(e, b, err));
    for (mt_enclosure_matrix m = MT_STIFFNESS; m < MT_MATRICES; m++) {
        MT_TRY(room(&e->mem, r, r, &e->fixed[m], err));
        MT_TRY(
            to_basis_matrix(b, mt_linear_fixed(lin, KINDS[m]), &e->scratch, e->fixed[m], err));
        for (mt_side s = MT_LOW; s <= MT_HIGH && (m == MT_STIFFNESS || e->mass_varies); s++) {
            MT_TRY(room(&e->mem, r, r, &e->at[m][s], err));
        }
    }
    MT_TRY(room(&e->mem, r, r, &e->work, err));
    e->fixed_norm = mt_norm2((int)(r * r), e->fixed[MT_STIFFNESS]);
    e->squares = all_squares(lin) && e->coupled == NULL;
    e->roundoff = ROUNDING_ULPS *
                  (double)(e->n + mt_linear_terms(lin, MT_TERM_STIFFNESS)->n_rows +
                           mt_linear_terms(lin, MT_TERM_MASS)->n_rows) *
                  DBL_EPSILON * b->condition;
    return MT_OK;
}

/* Compute the fixed matrices and parts in coordinates in which M at the low end of the bounds
 * is the identity. *ok is false, with the reason, where massless freedoms or an instability
 * prevent it. */
static mt_status enclosure_reduce(mt_enclosure *e, const mt_linear *lin, bool *ok, char *reason,
                                  mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    basis b = {.lin = lin, .n = mt_linear_freedoms(lin)};
    *ok = true;
    const mt_status rc = reduce_to_basis(e, &b, ok, reason, err);
    mt_arena_rewind(&e->scratch, mark);
    return rc;
}

/* Conditions under which bounds of the coefficients bound the modes, as far as the system's
 * structure shows them. */

static bool write_refusal(char *reason, const char *what, const char *name, const char *does)
{
    (void)mt_snprintf(reason, MT_REASON_SIZE, "%s \"%s\" %s", what, name, does);
    return false;
}

static bool loads_refused(const mt_system *sys, char *reason)
{
    if (!sys->loaded) {
        return true;
    }
    for (int i = 0; i < sys->n_springs && sys->n_loads == 0; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        if (!s->damper && (s->free != MT_NO_NODE || s->preload != MT_NO_NODE)) {
            return write_refusal(reason, "spring", s->name, "is preloaded");
        }
    }
    for (int i = 0; i < sys->n_loads; i++) {
        if (sys->loads[i].name != NULL) {
            return write_refusal(reason, "load", sys->loads[i].name, "acts on the mechanism");
        }
    }
    (void)mt_snprintf(reason, MT_REASON_SIZE, "gravity loads the mechanism");
    return false;
}

/* True where the analysis was last solved at this value of the input. */
static bool stands_at(const mt_analysis *a, int input, double value)
{
    const mt_program *const p = &a->sys->program;
    for (int i = 0; i < p->count; i++) {
        if (p->nodes[i].op == MT_OP_PARAM && p->nodes[i].input == input) {
            return mt_linear_value(a->lin, i) == value;
        }
    }
    return false;
}

/* True where the analysis can be enclosed over lower <= x <= upper; false with the reason.
 * frozen[n_inputs]: mt_enclosure_shaping. */
static bool enclosure_admits(const mt_analysis *a, const double *lower, const double *upper,
                             bool *frozen, char *reason)
{
    const mt_system *const sys = a->sys;
    if (!loads_refused(sys, reason)) {
        return false;
    }
    if (mt_linear_reduced(a->lin).loaded) {
        (void)mt_snprintf(reason, MT_REASON_SIZE,
                          "a driven joint or an equilibrium places the mechanism");
        return false;
    }
    mt_enclosure_shaping(a, frozen);
    for (int i = 0; i < sys->n_inputs; i++) {
        const bool fixed = lower[i] == upper[i] && stands_at(a, i, lower[i]);
        if (frozen[i] && !fixed) {
            return write_refusal(reason, "parameter",
                                 sys->model->parameters[sys->inputs[i]].name.s,
                                 "shapes the geometry");
        }
    }
    return true;
}

/* Making an enclosure: conditions, coefficients, basis. And what is asked of an input. */

void mt_enclosure_delete(mt_enclosure *e)
{
    if (e != NULL) {
        mt_arena_free(&e->mem);
        mt_arena_free(&e->scratch);
        free(e);
    }
}

static mt_status keep_bounds(mt_enclosure *e, const double *lower, const double *upper,
                             mt_err *err)
{
    const size_t n = (size_t)e->n_inputs;
    e->lower = mt_arena_f64(&e->mem, n, 1);
    e->upper = mt_arena_f64(&e->mem, n, 1);
    e->frozen = mt_arena_alloc(&e->mem, n, sizeof(bool));
    e->in[MT_STIFFNESS] = mt_arena_alloc(&e->mem, n, sizeof(bool));
    e->in[MT_MASS] = mt_arena_alloc(&e->mem, n, sizeof(bool));
    MT_TRY(mt_arena_check(&e->mem, err));
    if (n > 0) {
        memcpy(e->lower, lower, n * sizeof *lower);
        memcpy(e->upper, upper, n * sizeof *upper);
    }
    return MT_OK;
}

static mt_status note_inputs(mt_enclosure *e, mt_err *err)
{
    bool *const depends = mt_arena_alloc(&e->mem, (size_t)e->n_inputs, sizeof *depends);
    MT_TRY(mt_arena_check(&e->mem, err));
    for (int i = 0; i < e->n_coefficients; i++) {
        mt_program_depends(&e->program, e->coefficients[i].node, depends);
        for (int m = 0; m < MT_MATRICES; m++) {
            for (int k = 0; k < e->n_inputs; k++) {
                e->in[m][k] =
                    e->in[m][k] || (depends[k] && e->coefficients[i].part[m].count > 0);
            }
        }
    }
    return MT_OK;
}

/* *ok: false where a direction that the analysis counts as free is held at some design within
 * the bounds. A term can hold it wherever its coefficient can be positive. */
static mt_status check_count(mt_enclosure *e, const mt_analysis *a, bool *ok, char *reason,
                             mt_err *err)
{
    const mt_term_list *const list = mt_linear_terms(a->lin, MT_TERM_STIFFNESS);
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    bool *const holds = mt_arena_alloc(&e->scratch, (size_t)list->n_terms, sizeof *holds);
    int free_directions = 0;
    MT_TRY(mt_arena_check(&e->scratch, err));
    for (int t = 0; t < list->n_terms; t++) {
        const int at = e->of_term[MT_STIFFNESS][t];
        holds[t] = at < 0 ? mt_linear_value(a->lin, list->terms[t].coefficient) != 0.0
                          : e->coefficients[at].most > 0.0 || e->coefficients[at].least < 0.0;
    }
    const mt_status rc = mt_analysis_free_directions(a->lin, &a->mass, holds, &e->scratch,
                                                     &free_directions, err);
    mt_arena_rewind(&e->scratch, mark);
    if (rc == MT_OK && free_directions < a->n_rigid) {
        *ok = false;
        (void)mt_snprintf(
            reason, MT_REASON_SIZE,
            "%d of its %d rigid-body modes may be held by a spring within the bounds",
            a->n_rigid - free_directions, a->n_rigid);
    }
    return rc;
}

static mt_status build(mt_enclosure *e, const mt_analysis *a, const double *lower,
                       const double *upper, bool *ok, char *reason, mt_err *err)
{
    *ok = false;
    MT_TRY(mt_arena_init(&e->mem, 0, err));
    MT_TRY(mt_arena_init(&e->scratch, 0, err));
    e->n_inputs = a->sys->n_inputs;
    MT_TRY(keep_bounds(e, lower, upper, err));
    if (!enclosure_admits(a, lower, upper, e->frozen, reason)) {
        return MT_OK;
    }
    if (a->modes.n_unstable > 0) {
        (void)mt_snprintf(reason, MT_REASON_SIZE, "the mechanism is unstable");
        return MT_OK;
    }
    if (a->modes.n_undecided > 0) {
        (void)mt_snprintf(reason, MT_REASON_SIZE,
                          "rounding hides whether the mechanism is stable");
        return MT_OK;
    }
    e->interrupt = a->sys->run->interrupt;
    MT_TRY(mt_interrupt_check(e->interrupt, err));
    e->n_rigid = a->n_rigid;
    MT_TRY(enclosure_collect(e, a->lin, ok, reason, err));
    if (*ok && a->n_rigid > 0) {
        MT_TRY(check_count(e, a, ok, reason, err));
    }
    if (*ok) {
        MT_TRY(enclosure_reduce(e, a->lin, ok, reason, err));
    }
    return *ok ? note_inputs(e, err) : MT_OK;
}

mt_status mt_enclosure_new(const mt_analysis *a, const double *lower, const double *upper,
                           mt_enclosure **out, char *reason, mt_err *err)
{
    mt_enclosure *const e = calloc(1, sizeof *e);
    bool ok = false;
    *out = NULL;
    reason[0] = '\0';
    if (e == NULL) {
        return mt_fail_memory(err);
    }
    const mt_status rc = build(e, a, lower, upper, &ok, reason, err);
    if (rc != MT_OK || !ok) {
        mt_enclosure_delete(e);
        return rc;
    }
    *out = e;
    return MT_OK;
}

bool mt_enclosure_loose(const mt_enclosure *e, int i)
{
    return e->in[MT_STIFFNESS][i] && e->in[MT_MASS][i];
}

/* Effect of raising input k over the box whose gradient is in dnode. */
static int effect(const mt_enclosure *e, int k)
{
    int bits = 0;
    for (int i = 0; i < e->n_coefficients; i++) {
        const mt_enclosure_coefficient *const c = &e->coefficients[i];
        const size_t at = ((size_t)c->node * (size_t)e->n_inputs) + (size_t)k;
        const bool rises = e->dnode[MT_HIGH][at] > 0.0;
        const bool falls = e->dnode[MT_LOW][at] < 0.0;
        if (c->part[MT_STIFFNESS].count > 0) {
            bits |= (rises ? MT_STIFFENS : 0) | (falls ? MT_SOFTENS : 0);
        }
        if (c->part[MT_MASS].count > 0) {
            bits |= (rises ? MT_SOFTENS : 0) | (falls ? MT_STIFFENS : 0);
        }
    }
    return bits;
}

static void enclose_slopes(mt_enclosure *e, const double *lo, const double *hi)
{
    mt_program_interval_gradient(&e->program, lo, hi, e->node[MT_LOW], e->node[MT_HIGH],
                                 e->dnode[MT_LOW], e->dnode[MT_HIGH]);
}

void mt_enclosure_effects(mt_enclosure *e, const double *lo, const double *hi, int *effects)
{
    enclose_slopes(e, lo, hi);
    for (int k = 0; k < e->n_inputs; k++) {
        effects[k] = effect(e, k);
    }
}

bool mt_enclosure_corners(mt_enclosure *e, const mt_model *model, const int *inputs,
                          const double *lo, const double *hi, double *soft, double *stiff,
                          char *reason)
{
    enclose_slopes(e, lo, hi);
    for (int k = 0; k < e->n_inputs; k++) {
        const int bits = effect(e, k);
        if (bits == (MT_STIFFENS | MT_SOFTENS) && lo[k] < hi[k]) {
            (void)mt_snprintf(reason, MT_REASON_SIZE, "parameter \"%s\" %s",
                              model->parameters[inputs[k]].name.s,
                              mt_enclosure_loose(e, k)
                                  ? "enters both stiffness and mass"
                                  : "stiffens in one place and softens in another");
            return false;
        }
        const double middle = 0.5 * (lo[k] + hi[k]);
        soft[k] = bits == 0 ? middle : (bits == MT_SOFTENS ? hi[k] : lo[k]);
        stiff[k] = bits == 0 ? middle : (bits == MT_SOFTENS ? lo[k] : hi[k]);
    }
    return true;
}
