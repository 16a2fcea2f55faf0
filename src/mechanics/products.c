/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Checks whether redundant equations stay redundant as an input changes. The derivatives of
 * rows of unit length are compared with the sums of their own terms: a derivative that should
 * vanish is rounding of them, also through the position's derivative; any other is of their
 * size.
 */
#include "mechanics/products.h"

#include "mechanics/linear_priv.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "mechanics/equilibrium_slopes.h"
#include "mechanics/linear.h"
#include "mechanics/tangent.h"

static const double VANISHES = 1e-8;
/* Rounding, of what is made of terms of size 1: an entry of w (largest 1) below this does not
 * tell an equation that takes part from one that does not. */
static const double TAKES_PART = 1e-13;

/* Length of row j of A. in scaled coordinates, with the row of A scaled to unit length. */
static double row_length(const mt_elimination *e, const mt_linear_tangent *t, int j)
{
    double squares = 0.0;
    for (ptrdiff_t k = 0; k < e->nq; k++) {
        const double entry = e->dr[j] * t->a[j + (k * e->m)] * e->dc[k];
        squares += entry * entry;
    }
    return sqrt(squares);
}

/* row[nq] = sum_j w_j dr_j A._j; returns the sum of the lengths of its terms in scaled
 * coordinates, each at least the rounding of w. */
static double combine(const mt_linear *lin, const mt_linear_tangent *t, const double *w,
                      double *row)
{
    const mt_elimination *const e = &lin->e;
    double terms = 0.0;
    memset(row, 0, (size_t)e->nq * sizeof *row);
    for (int j = 0; j < e->m; j++) {
        for (ptrdiff_t k = 0; k < e->nq; k++) {
            row[k] += w[j] * e->dr[j] * t->a[j + (k * e->m)];
        }
        terms += fmax(fabs(w[j]), TAKES_PART / VANISHES) * row_length(e, t, j);
    }
    return terms;
}

typedef struct dependence {
    double *w;   /* [m] */
    double *row; /* [nq] */
    double *out; /* [n] */
} dependence;

static mt_status dependence_init(dependence *l, const mt_linear *lin, mt_arena *mem,
                                 mt_err *err)
{
    l->w = mt_arena_f64(mem, (size_t)lin->m, 1);
    l->row = mt_arena_f64(mem, (size_t)lin->sys->nq, 1);
    l->out = mt_arena_f64(mem, (size_t)lin->n, 1);
    return mt_arena_check(mem, err);
}

static bool can_change(const mt_linear *lin, int p)
{
    return mt_linear_redundant(lin) > 0 && lin->tangent != NULL && lin->tangent[p].moves;
}

/*
 * A gap's derivative is a sum of motions of points that the input moves; those that cancel at
 * once (both bodies' point is drawn elsewhere) are not among its terms, but in A., which turns
 * with the arms: arms grow by up to |A.| model lengths. Nor is the motion itself known beyond
 * its rounding, in whatever direction it is not.
 */
static bool opens(const mt_linear *lin, const mt_linear_tangent *t, const double *w)
{
    double terms = fmax(t->terms, TAKES_PART / VANISHES * t->motion);
    for (int j = 0; j < lin->m; j++) {
        const double arms = lin->sys->length_m * row_length(&lin->e, t, j);
        terms = fmax(terms, TAKES_PART / VANISHES * arms);
    }
    for (int i = 0; i < lin->m; i++) {
        const double part = fabs(w[i] * lin->e.dr[i] * t->c[i]);
        if (part > VANISHES * terms) {
            return true;
        }
    }
    return false;
}

mt_status mt_linear_independence(mt_linear *lin, int p, mt_arena *mem, mt_independence *out,
                                 mt_err *err)
{
    *out = (mt_independence){.opens = false};
    if (mt_linear_redundant(lin) > 0) {
        MT_TRY(mt_tangent_complete(lin, err));
    }
    if (!can_change(lin, p)) {
        return MT_OK;
    }
    const mt_linear_tangent *const t = &lin->tangent[p];
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    dependence l;
    MT_TRY(dependence_init(&l, lin, &lin->scratch, err));
    for (int k = 0; k < mt_linear_redundant(lin) && !out->opens; k++) {
        MT_TRY(mt_eliminate_left_null(&lin->e, k, l.w, &lin->scratch, err));
        const double terms = combine(lin, t, l.w, l.row);
        mt_eliminate_project(&lin->e, l.row, l.out);
        const bool blocks = mt_norm2(lin->n, l.out) > VANISHES * terms;
        out->opens = opens(lin, t, l.w);
        if (out->opens || (blocks && !out->blocks)) {
            MT_TRY(mt_name_joints(lin->sys, lin->m, l.w, mem, &out->joints, err));
        }
        out->blocks = out->blocks || blocks;
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_linear_blocked(mt_linear *lin, int p, int cols, const double *y, bool *blocked,
                            mt_err *err)
{
    memset(blocked, 0, (size_t)cols * sizeof *blocked);
    if (mt_linear_redundant(lin) > 0) {
        MT_TRY(mt_tangent_complete(lin, err));
    }
    if (!can_change(lin, p)) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    dependence l;
    MT_TRY(dependence_init(&l, lin, &lin->scratch, err));
    for (int k = 0; k < mt_linear_redundant(lin); k++) {
        MT_TRY(mt_eliminate_left_null(&lin->e, k, l.w, &lin->scratch, err));
        const double terms = combine(lin, &lin->tangent[p], l.w, l.row);
        mt_eliminate_project(&lin->e, l.row, l.out);
        for (int c = 0; c < cols; c++) {
            const double *const motion = y + ((ptrdiff_t)c * lin->n);
            const double part = fabs(mt_dot(lin->n, l.out, motion));
            blocked[c] = blocked[c] || part > VANISHES * terms * mt_norm2(lin->n, motion);
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

/*
 * Derivatives of the reduced matrices, a dash being the derivative that tangent.c fills. The
 * basis of the freedoms moves too: A Z = 0 gives, with the choice that Z' has no part along Z,
 *     Z' = -A^+ A' Z,        K_r' y = Z^T (K' phi + K z') + Z'^T K phi,    phi = Z y,
 *         z' = Z' y = -A^+ A' phi,
 * and Z'^T w = -Z^T A'^T (A^+)^T w, where (A^+)^T w are the multipliers that balance w. Only
 * products with vectors are formed. Any other choice of Z' changes y' but no physical result
 * (phi' = Z y' + Z' y).
 *
 * The slope of an eigenvalue needs no Z': with w = (K - lambda M) phi = A^T mu, as Z^T w = 0,
 *     lambda' = phi^T (K' - lambda M') phi + 2 z'^T w,    z'^T w = -(A' phi)^T mu,
 * one mu for all inputs, and of K' and M' only the terms that an input touches.
 */

/* A sum of terms: K, C or M by their coefficients, or H by what the loss factors make of those
 * of K. */
typedef struct sum {
    int kind;
    bool loss;
} sum;
static const sum STIFFNESS = {MT_TERM_STIFFNESS, false};
static const sum MASS = {MT_TERM_MASS, false};
static const sum DAMPING = {MT_TERM_DAMPING, false};
static const sum STRUCTURAL = {MT_TERM_STIFFNESS, true};

static double weight(const mt_linear *lin, sum s, const mt_term *t)
{
    return s.loss ? mt_linear_loss(lin, t) : lin->value[t->coefficient];
}

static double weight_slope(const mt_linear *lin, sum s, const mt_term *t, int p)
{
    const double slope = mt_linear_slope(lin, t->coefficient, p);
    if (!s.loss) {
        return slope;
    }
    return t->loss == MT_NO_NODE
               ? 0.0
               : (lin->value[t->loss] * slope) +
                     (mt_linear_slope(lin, t->loss, p) * lin->value[t->coefficient]);
}

/* A row that the joints block, r = Z^T f = 0, has no part in a derivative: (r r^T)' = r' r^T +
 * r r'^T = 0. */
static bool is_blocked(const mt_linear *lin, int kind, int row, const mt_term *t)
{
    return mt_rows_empty(&lin->entries[kind], row) && !t->pair;
}

/* The row that row i of a term is multiplied with. */
static int partner(const mt_term *t, int i)
{
    return t->pair ? (2 * t->first) + 1 - i : i;
}

/* One row of a sum, what it is multiplied with, and its part of the term. */
typedef struct piece {
    const mt_term *term;
    int row;
    int other;
    double part;
} piece;

/* The first piece from row *i on that joints do not block; *i is set behind it. */
static bool next_piece(const mt_linear *lin, sum s, int *i, piece *out)
{
    const mt_term_list *const list = &lin->list[s.kind];
    for (; *i < list->n_rows; ++*i) {
        const mt_term *const t = &list->terms[list->row_term[*i]];
        if (!is_blocked(lin, s.kind, *i, t)) {
            *out = (piece){t, *i, partner(t, *i), t->pair ? 0.5 : 1.0};
            ++*i;
            return true;
        }
    }
    return false;
}

/* out += scale K phi (STIFFNESS), M phi (MASS) and so on, full coordinates, without the
 * geometric part. */
static void full_product(const mt_linear *lin, sum s, double scale, const double *phi,
                         double *out)
{
    const mt_rows *const rows = &lin->full[s.kind];
    piece k;
    for (int i = 0; next_piece(lin, s, &i, &k);) {
        const double c = scale * weight(lin, s, k.term) * k.part;
        mt_rows_axpy(rows, k.row, c * mt_rows_dot(rows, k.other, phi), out);
    }
}

static bool is_moved(const mt_linear *lin, int p)
{
    assert(lin->tangent == NULL || !lin->due);
    return lin->tangent != NULL && lin->tangent[p].moves;
}

/* out += K' phi at fixed phi. */
static void full_product_derivative(const mt_linear *lin, sum s, int p, const double *phi,
                                    double *out)
{
    const mt_rows *const rows = &lin->full[s.kind];
    const mt_rows *const drows = is_moved(lin, p) ? &lin->tangent[p].rows[s.kind] : NULL;
    piece k;
    for (int i = 0; next_piece(lin, s, &i, &k);) {
        const double c = weight(lin, s, k.term) * k.part;
        const double dc = weight_slope(lin, s, k.term, p) * k.part;
        const bool turns =
            drows != NULL && !(mt_rows_empty(drows, k.row) && mt_rows_empty(drows, k.other));
        if (dc == 0.0 && !turns) {
            continue;
        }
        const double way = mt_rows_dot(rows, k.other, phi);
        const double dway = turns ? mt_rows_dot(drows, k.other, phi) : 0.0;
        mt_rows_axpy(rows, k.row, (dc * way) + (c * dway), out);
        if (turns) {
            mt_rows_axpy(drows, k.row, c * way, out);
        }
    }
}

/* Fixed geometry: the sum over terms whose coefficient depends on p, in reduced coordinates. */
static void coefficient_products(const mt_linear *lin, sum s, int p, int cols, const double *y,
                                 double *out)
{
    const mt_term_list *const list = &lin->list[s.kind];
    const mt_rows *const rows = &lin->entries[s.kind];
    const ptrdiff_t n = lin->n;
    memset(out, 0, (size_t)n * (size_t)cols * sizeof *out);
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        const double dc = t->varies || s.loss ? weight_slope(lin, s, t, p) : 0.0;
        for (int r = t->first; r < t->first + t->count && dc != 0.0; r++) {
            for (int c = 0; c < cols; c++) {
                const double way =
                    dc * (t->pair ? 0.5 : 1.0) * mt_rows_dot(rows, partner(t, r), y + (c * n));
                mt_rows_axpy(rows, r, way, out + (c * n));
            }
        }
    }
}

/* slope[p] += sign times the sum over terms of dc/dp (r . y)^2, of all inputs at once. */
static void coefficient_slopes(const mt_linear *lin, int kind, double sign, const double *y,
                               double *slope)
{
    const mt_term_list *const list = &lin->list[kind];
    const mt_rows *const rows = &lin->entries[kind];
    const int np = lin->sys->n_inputs;
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        double energy = 0.0;
        for (int r = t->first; r < t->first + t->count && t->varies; r++) {
            const double s = mt_rows_dot(rows, r, y);
            energy += t->pair ? 0.5 * s * mt_rows_dot(rows, partner(t, r), y) : s * s;
        }
        const double *const dc = lin->grad + ((ptrdiff_t)t->coefficient * np);
        const mt_program_span span = lin->sys->program.span[t->coefficient];
        for (int p = span.first; p < span.end && energy != 0.0; p++) {
            slope[p] += sign * energy * dc[p];
        }
    }
}

typedef struct moving {
    double *phi;
    double *z; /* Z' y */
    double *kphi;
    double *w;
    double *lambda;
    double *b;
} moving;

static mt_status moving_init(moving *v, const mt_linear *lin, mt_arena *scratch, mt_err *err)
{
    const size_t nq = (size_t)lin->sys->nq;
    v->phi = mt_arena_f64(scratch, nq, 1);
    v->z = mt_arena_f64(scratch, nq, 1);
    v->kphi = mt_arena_f64(scratch, nq, 1);
    v->w = mt_arena_f64(scratch, nq, 1);
    v->lambda = mt_arena_f64(scratch, (size_t)lin->m, 1);
    v->b = mt_arena_f64(scratch, (size_t)lin->m, 1);
    return mt_arena_check(scratch, err);
}

/* phi = Z y, z = Z' y. */
static mt_status moving_shape(mt_linear *lin, const mt_linear_tangent *t, const double *y,
                              moving *v, mt_err *err)
{
    mt_eliminate_expand(&lin->e, y, v->phi);
    mt_gemv(false, lin->m, lin->sys->nq, -1.0, t->a, lin->m, v->phi, 0.0, v->b);
    return mt_eliminate_particular(&lin->e, v->b, v->z, &lin->scratch, err);
}

static mt_status moving_product(mt_linear *lin, sum s, int p, moving *v, double *out,
                                mt_err *err)
{
    const int nq = lin->sys->nq;
    const mt_linear_tangent *const t = &lin->tangent[p];
    const bool geometric = s.kind == MT_TERM_STIFFNESS && !s.loss && lin->kg != NULL;
    memset(v->w, 0, (size_t)nq * sizeof *v->w);
    full_product_derivative(lin, s, p, v->phi, v->w);
    if (geometric) {
        mt_gemv(false, nq, nq, 1.0, t->kg, nq, v->phi, 1.0, v->w);
    }
    if (lin->m > 0) { /* without constraints the basis stands still */
        memset(v->kphi, 0, (size_t)nq * sizeof *v->kphi);
        full_product(lin, s, 1.0, v->phi, v->kphi);
        full_product(lin, s, 1.0, v->z, v->w);
        if (geometric) {
            mt_linear_add_load(lin, 1.0, v->phi, v->kphi);
            mt_linear_add_load(lin, 1.0, v->z, v->w);
        }
        MT_TRY(mt_eliminate_multipliers(&lin->e, v->kphi, v->lambda, &lin->scratch, err));
        mt_gemv(true, lin->m, nq, -1.0, t->a, lin->m, v->lambda, 1.0, v->w);
    }
    mt_eliminate_project(&lin->e, v->w, out);
    return MT_OK;
}

/* out[k] = (ds[k]/dp) y of both sums, n x cols each. */
static mt_status products(mt_linear *lin, const sum s[2], int p, int cols, const double *y,
                          double *const out[2], mt_err *err)
{
    MT_TRY(mt_tangent_complete(lin, err));
    if (!is_moved(lin, p)) {
        coefficient_products(lin, s[0], p, cols, y, out[0]);
        coefficient_products(lin, s[1], p, cols, y, out[1]);
        return MT_OK;
    }
    moving v;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    MT_TRY(moving_init(&v, lin, &lin->scratch, err));
    for (int c = 0; c < cols; c++) {
        const ptrdiff_t at = (ptrdiff_t)c * lin->n;
        MT_TRY(moving_shape(lin, &lin->tangent[p], y + at, &v, err));
        MT_TRY(moving_product(lin, s[0], p, &v, out[0] + at, err));
        MT_TRY(moving_product(lin, s[1], p, &v, out[1] + at, err));
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_linear_products(mt_linear *lin, int p, int cols, const double *y, double *dky,
                             double *dmy, mt_err *err)
{
    return products(lin, (const sum[2]){STIFFNESS, MASS}, p, cols, y,
                    (double *const[2]){dky, dmy}, err);
}

mt_status mt_linear_damping_products(mt_linear *lin, int p, int cols, const double *y,
                                     double *dcy, double *dhy, mt_err *err)
{
    return products(lin, (const sum[2]){DAMPING, STRUCTURAL}, p, cols, y,
                    (double *const[2]){dcy, dhy}, err);
}

/* phi^T K' phi of rows that move, coefficients as they are. */
static double row_slope(const mt_linear *lin, int kind, int p, const double *phi)
{
    const mt_term_list *const list = &lin->list[kind];
    const mt_rows *const rows = &lin->full[kind];
    const mt_rows *const drows = &lin->tangent[p].rows[kind];
    double total = 0.0;
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        if (!mt_rows_empty(drows, i) && !is_blocked(lin, kind, i, t)) {
            const double c = lin->value[t->coefficient] * (t->pair ? 1.0 : 2.0);
            total += c * mt_rows_dot(rows, partner(t, i), phi) * mt_rows_dot(drows, i, phi);
        }
    }
    return total;
}

mt_status mt_linear_complete(mt_linear *lin, mt_err *err)
{
    return mt_tangent_complete(lin, err);
}

void mt_linear_rows_product(const mt_linear *lin, double lambda, const double *phi, double *w)
{
    full_product(lin, STIFFNESS, 1.0, phi, w);
    full_product(lin, MASS, -lambda, phi, w);
}

/* v->lambda := mu, A^T mu = (K - lambda M) phi: joint forces of the mode. */
static mt_status joint_forces(mt_linear *lin, double lambda, moving *v, mt_err *err)
{
    mt_linear_rows_product(lin, lambda, v->phi, v->w);
    mt_linear_add_load(lin, 1.0, v->phi, v->w);
    return mt_eliminate_multipliers(&lin->e, v->w, v->lambda, &lin->scratch, err);
}

/* True where a tangent has the slope of an eigenvalue by input p, beyond the coefficients. */
static bool has_own_slope(const mt_linear *lin, int p)
{
    const bool forced = lin->by_adjoint && mt_stages_has(lin->forced, p);
    return lin->tangent != NULL && !forced && lin->tangent[p].moves;
}

mt_status mt_linear_slopes(mt_linear *lin, double lambda, const double *y, double *slope,
                           mt_err *err)
{
    const int nq = lin->sys->nq;
    const int np = lin->sys->n_inputs;
    moving v;
    memset(slope, 0, (size_t)np * sizeof *slope);
    coefficient_slopes(lin, MT_TERM_STIFFNESS, 1.0, y, slope);
    coefficient_slopes(lin, MT_TERM_MASS, -lambda, y, slope);
    bool any = lin->tangent != NULL && lin->by_adjoint;
    for (int p = 0; p < np; p++) {
        any = any || has_own_slope(lin, p);
    }
    if (!any) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    MT_TRY(moving_init(&v, lin, &lin->scratch, err));
    mt_eliminate_expand(&lin->e, y, v.phi);
    MT_TRY(joint_forces(lin, lambda, &v, err));
    for (int p = 0; p < np; p++) {
        if (!has_own_slope(lin, p)) {
            continue;
        }
        const mt_linear_tangent *const t = &lin->tangent[p];
        slope[p] += row_slope(lin, MT_TERM_STIFFNESS, p, v.phi) -
                    (lambda * row_slope(lin, MT_TERM_MASS, p, v.phi));
        if (lin->kg != NULL) {
            mt_gemv(false, nq, nq, 1.0, t->kg, nq, v.phi, 0.0, v.z);
            slope[p] += mt_dot(nq, v.phi, v.z);
        }
        mt_gemv(false, lin->m, nq, 1.0, t->a, lin->m, v.phi, 0.0, v.b);
        slope[p] -= 2.0 * mt_dot(lin->m, v.lambda, v.b);
    }
    if (lin->by_adjoint) {
        MT_TRY(mt_equilibrium_slopes(lin, lambda, v.phi, v.lambda, slope, err));
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_linear_sense(mt_linear *lin, int ns, const int *channel, int cols, const double *y,
                          double *s, mt_err *err)
{
    const mt_term_list *const list = &lin->list[MT_TERM_CHANNEL];
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const phi = mt_arena_f64(&lin->scratch, (size_t)lin->sys->nq, 1);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    for (int c = 0; c < cols; c++) {
        mt_eliminate_expand(&lin->e, y + ((ptrdiff_t)c * lin->n), phi);
        for (int i = 0; i < ns; i++) {
            const mt_term *const t = &list->terms[channel[i]];
            const bool still = mt_rows_empty(&lin->entries[MT_TERM_CHANNEL], t->first);
            s[i + ((ptrdiff_t)c * ns)] =
                still ? 0.0 : mt_rows_dot(&lin->full[MT_TERM_CHANNEL], t->first, phi);
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

/* Shapes and their derivative, both as mt_linear_sense takes them. */
/* NOLINTNEXTLINE(readability-function-size) */
mt_status mt_linear_sense_derivative(mt_linear *lin, int p, int ns, const int *channel,
                                     int cols, const double *y, const double *dy, double *ds,
                                     mt_err *err)
{
    MT_TRY(mt_tangent_complete(lin, err));
    if (!is_moved(lin, p)) {
        return mt_linear_sense(lin, ns, channel, cols, dy, ds, err);
    }
    const mt_term_list *const list = &lin->list[MT_TERM_CHANNEL];
    const mt_linear_tangent *const tangent = &lin->tangent[p];
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    moving v;
    MT_TRY(moving_init(&v, lin, &lin->scratch, err));
    for (int c = 0; c < cols; c++) {
        MT_TRY(moving_shape(lin, tangent, y + ((ptrdiff_t)c * lin->n), &v, err));
        mt_gemv(false, lin->sys->nq, lin->n, 1.0, lin->e.z, lin->sys->nq,
                dy + ((ptrdiff_t)c * lin->n), 1.0, v.z); /* phi' */
        for (int i = 0; i < ns; i++) {
            const mt_term *const t = &list->terms[channel[i]];
            ds[i + ((ptrdiff_t)c * ns)] =
                mt_rows_dot(&tangent->rows[MT_TERM_CHANNEL], t->first, v.phi) +
                mt_rows_dot(&lin->full[MT_TERM_CHANNEL], t->first, v.z);
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_linear_mass_product(mt_linear *lin, const double *y, double *w, mt_err *err)
{
    const size_t nq = (size_t)lin->sys->nq;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const phi = mt_arena_f64(&lin->scratch, nq, 1);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    mt_linear_expand(lin, 1, y, phi);
    memset(w, 0, nq * sizeof *w);
    full_product(lin, MASS, 1.0, phi, w);
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

static sum sum_of(mt_linear_matrix matrix)
{
    static const sum *const sums[] = {[MT_MATRIX_STIFFNESS] = &STIFFNESS,
                                      [MT_MATRIX_LOSS] = &STRUCTURAL,
                                      [MT_MATRIX_DAMPERS] = &DAMPING,
                                      [MT_MATRIX_MASS] = &MASS};
    return *sums[matrix];
}

void mt_linear_states_product(const mt_linear *lin, mt_linear_matrix matrix, double scale,
                              const double *phi, double *out)
{
    full_product(lin, sum_of(matrix), scale, phi, out);
    if (matrix == MT_MATRIX_STIFFNESS) {
        mt_linear_add_load(lin, scale, phi, out);
    }
}

void mt_linear_states_slope(const mt_linear *lin, int p, mt_linear_matrix matrix,
                            const double *phi, double *out)
{
    const int nq = lin->sys->nq;
    full_product_derivative(lin, sum_of(matrix), p, phi, out);
    if (is_moved(lin, p) && matrix == MT_MATRIX_STIFFNESS && lin->kg != NULL) {
        mt_gemv(false, nq, nq, 1.0, lin->tangent[p].kg, nq, phi, 1.0, out);
    }
}

double mt_linear_between_slope(const mt_linear *lin, int p, mt_linear_matrix matrix,
                               const double *a, const double *b)
{
    const sum s = sum_of(matrix);
    const mt_rows *const rows = &lin->full[s.kind];
    const mt_rows *const drows = is_moved(lin, p) ? &lin->tangent[p].rows[s.kind] : NULL;
    const ptrdiff_t nq = lin->sys->nq;
    double out = 0.0;
    piece k;
    for (int i = 0; next_piece(lin, s, &i, &k);) {
        const double left = mt_rows_dot(rows, k.row, a);
        const double right = mt_rows_dot(rows, k.other, b);
        out += k.part * weight_slope(lin, s, k.term, p) * left * right;
        if (drows != NULL) {
            out += k.part * weight(lin, s, k.term) *
                   ((mt_rows_dot(drows, k.row, a) * right) +
                    (left * mt_rows_dot(drows, k.other, b)));
        }
    }
    for (ptrdiff_t c = 0;
         c < nq && drows != NULL && matrix == MT_MATRIX_STIFFNESS && lin->kg != NULL; c++) {
        out += b[c] * mt_dot((int)nq, lin->tangent[p].kg + (c * nq), a);
    }
    return out;
}

/* a^T g b of rows i of a and k of b, g nq x nq. */
static double between_rows(const mt_rows *a, int i, const mt_rows *b, int k, ptrdiff_t nq,
                           const double *g)
{
    double out = 0.0;
    for (int c = b->start[k]; c < b->start[k + 1]; c++) {
        out += b->value[c] * mt_rows_dot(a, i, g + ((ptrdiff_t)b->index[c] * nq));
    }
    return out;
}

double mt_linear_contract_slope(const mt_linear *lin, int p, mt_linear_matrix matrix,
                                const double *g)
{
    const sum s = sum_of(matrix);
    const mt_term_list *const list = &lin->list[s.kind];
    const mt_rows *const rows = &lin->full[s.kind];
    const mt_rows *const drows = is_moved(lin, p) ? &lin->tangent[p].rows[s.kind] : NULL;
    const ptrdiff_t nq = lin->sys->nq;
    double out = 0.0;
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        if (is_blocked(lin, s.kind, i, t)) {
            continue;
        }
        const int other = partner(t, i);
        const double half = t->pair ? 0.5 : 1.0;
        const double by = half * weight_slope(lin, s, t, p);
        out += by == 0.0 ? 0.0 : by * between_rows(rows, i, rows, other, nq, g);
        if (drows != NULL) {
            out += half * weight(lin, s, t) *
                   (between_rows(drows, i, rows, other, nq, g) +
                    between_rows(rows, i, drows, other, nq, g));
        }
    }
    for (ptrdiff_t c = 0;
         c < nq && drows != NULL && matrix == MT_MATRIX_STIFFNESS && lin->kg != NULL; c++) {
        out += mt_dot((int)nq, lin->tangent[p].kg + (c * nq), g + (c * nq));
    }
    return out;
}
