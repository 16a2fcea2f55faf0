/* SPDX-License-Identifier: GPL-3.0-or-later */
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
#include "prove/basis.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "linalg/dense.h"
#include "modal/modal.h"

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

static const mt_term_kind KINDS[MT_MATRICES] = {MT_TERM_STIFFNESS, MT_TERM_MASS};

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
static void add_piece(const mt_linear *lin, const basis *b, const mt_enclosure_piece *p,
                      double weight, double *work, double *dense)
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
            add_piece(lin, NULL, &e->pieces[i], e->value[MT_LOW][e->pieces[i].coefficient],
                      work, *out);
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
            add_piece(b->lin, b, p, 1.0, work, dense);
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
 * as the modal room counts (modal_priv.h).
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

mt_status mt_enclosure_reduce(mt_enclosure *e, const mt_linear *lin, bool *ok, char *reason,
                              mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    basis b = {.lin = lin, .n = mt_linear_freedoms(lin)};
    *ok = true;
    const mt_status rc = reduce_to_basis(e, &b, ok, reason, err);
    mt_arena_rewind(&e->scratch, mark);
    return rc;
}
