/* SPDX-License-Identifier: GPL-3.0-or-later */
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
#include "prove/terms.h"

#include <float.h>
#include <math.h>

#include "linalg/dense.h"

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

mt_status mt_enclosure_list_terms(mt_enclosure *e, const mt_linear *lin, mt_err *err)
{
    MT_TRY(alloc_term_arrays(e, lin, err));
    MT_TRY(list_matrix(e, lin, MT_STIFFNESS, err));
    return list_matrix(e, lin, MT_MASS, err);
}
