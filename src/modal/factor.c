/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Modes from the spring factors. K = B^T diag(c) B, M = L L^T, C = B L^-T:
 *     L^-1 K L^-T = (diag(sqrt c) C)^T (diag(sqrt c) C),
 * so omega are the singular values of diag(sqrt c) C and the vectors its right singular
 * vectors. Forming the product first loses everything below eps c_max; the singular values of
 * a product D C with D diagonal and C well conditioned are determined to a relative
 * n eps cond(C), however far D spreads, and one-sided Jacobi finds them.
 *
 * C may be rank deficient (rigid-body modes; more springs than freedoms). Its null space does
 * not depend on D, so it is split off first: rows of C are scaled to unit norm (the norms join
 * D; rows that are known less well are made shorter, see shorten_noisy_rows), C^T P = Q R with
 * column pivoting has Q = [Q1 Q2], Q2 the null space. Then
 *     D C Q1 = D P R^T   (rows of R^T put into C's order)
 * is of full column rank, and every row of R^T keeps its own relative error. Where D spreads
 * far that is not enough: springs beyond the number of freedoms hold each other, and what is
 * exactly 0 in a stiff row must not become eps; then C is eliminated instead (graded.c).
 * lambda: zero for Q2, sigma^2 for Q1 V.
 */
#include "modal/modal_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"

typedef struct graded {
    int n;
    int rows;    /* rows of B with c > 0 and some entry */
    double tol;  /* relative rounding of the best rows of C, at least 16 n eps */
    double *ct;  /* n x rows: columns are rows of C, of length one or (noisy ones) less */
    int *place;  /* [n] coordinate that stands in each row of ct */
    double *d;   /* [rows] sqrt(c) times the row's length, over that in ct */
    mt_qr qr;    /* of ct; of L where elimination takes over */
    double kept; /* smallest diagonal entry of R that counts, of the largest */
    double most; /* max D */
    bool eliminated;
    double *f; /* rows x rank: D P R^T */
    double *s; /* [rank] descending */
    double *v; /* rank x rank */
    mt_interrupt *interrupt;
} graded;

/* ct := (T or L^-1) B^T, all rows of B. */
static void transform(const mt_stiffness_factor *b, const mt_mass_factor *mass, double *bt,
                      double *ct)
{
    const int n = mass->n;
    double *const to = mass->t != NULL ? bt : ct;
    mt_transpose(b->rows, n, b->b, to);
    if (mass->t != NULL) {
        mt_gemm(true, false, n, b->rows, n, 1.0, mass->t, n, bt, n, 0.0, ct, n);
    } else if (mass->l != NULL) {
        mt_tri_solve(false, n, b->rows, mass->l, ct, n);
    }
}

/* Error of row j of C from the errors of row j of B, relative to its length: |dC_j|^2 = db^T
 * M^-1 db; for independent errors only the diagonal remains. */
static double relative_noise(const mt_stiffness_factor *b, const mt_mass_factor *mass, int j,
                             double norm)
{
    double sum = 0.0;
    for (int i = 0; i < mass->n && b->noise != NULL; i++) {
        const double e = b->noise[j + (ptrdiff_t)i * b->rows];
        sum += e * e * mass->w[i];
    }
    return sqrt(sum) / norm;
}

/* Columns of length one, empty ones squeezed out; rho: their relative noise. */
static mt_status normalise(const mt_stiffness_factor *b, const mt_mass_factor *mass, graded *g,
                           double *rho, mt_err *err)
{
    for (int j = 0; j < b->rows; j++) {
        const double *const from = g->ct + (ptrdiff_t)j * g->n;
        double *const to = g->ct + (ptrdiff_t)g->rows * g->n;
        const double norm = mt_norm2(g->n, from);
        if (!(b->c[j] >= 0.0 && isfinite(b->c[j]) && isfinite(norm))) {
            return mt_fail(err, MT_E_DOMAIN,
                           "stiffness factor: row %d is negative or not finite", j + 1);
        }
        if (b->c[j] > 0.0 && norm > 0.0) {
            for (int i = 0; i < g->n; i++) {
                to[i] = from[i] / norm;
            }
            g->d[g->rows] = sqrt(b->c[j]) * norm;
            rho[g->rows] = relative_noise(b, mass, j, norm);
            g->rows++;
        }
    }
    return MT_OK;
}

/* Rows are shortened until the noise of none exceeds that of the best: then one tolerance
 * decides the rank, and precise rows are chosen before noisy ones. D takes it back. */
static void shorten_noisy_rows(graded *g, const double *rho)
{
    double best = HUGE_VAL;
    for (int j = 0; j < g->rows; j++) {
        best = fmin(best, rho[j]);
    }
    g->tol = mt_modal_tolerance(g->n > g->rows ? g->n : g->rows);
    g->tol = g->rows > 0 ? fmax(g->tol, best) : g->tol;
    for (int j = 0; j < g->rows; j++) {
        if (rho[j] > g->tol) {
            const double weight = g->tol / rho[j];
            for (int i = 0; i < g->n; i++) {
                g->ct[i + (ptrdiff_t)j * g->n] *= weight;
            }
            g->d[j] /= weight;
        }
    }
}

/*
 * Coordinates in descending order of their largest entry. With that and column pivoting
 * Householder's method is stable row by row and column by column (Cox and Higham 1998; Higham
 * 2000), so that small entries of C, those of a heavy body beside a light one, keep digits of
 * their own: two springs from a light body to heavy ones are parallel but for them.
 */
static mt_status sort_coordinates(graded *g, mt_arena *scratch, mt_err *err)
{
    const ptrdiff_t n = g->n;
    g->place = mt_arena_int(scratch, (size_t)n);
    double *const size = mt_arena_f64(scratch, (size_t)n, 1);
    double *const column = mt_arena_f64(scratch, (size_t)n, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (ptrdiff_t i = 0; i < n; i++) {
        for (ptrdiff_t j = 0; j < g->rows; j++) {
            size[i] = fmax(size[i], fabs(g->ct[i + j * n]));
        }
        ptrdiff_t at = i; /* insertion: the order of equals stays */
        for (; at > 0 && size[g->place[at - 1]] < size[i]; at--) {
            g->place[at] = g->place[at - 1];
        }
        g->place[at] = (int)i;
    }
    for (ptrdiff_t j = 0; j < g->rows; j++) {
        memcpy(column, g->ct + j * n, (size_t)n * sizeof *column);
        for (ptrdiff_t i = 0; i < n; i++) {
            g->ct[i + j * n] = column[g->place[i]];
        }
    }
    return MT_OK;
}

static mt_status prepare_graded(const mt_stiffness_factor *b, const mt_mass_factor *mass,
                                graded *g, mt_arena *scratch, mt_err *err)
{
    const size_t rows = (size_t)b->rows;
    const size_t n = (size_t)g->n;
    double *const bt = mass->t != NULL ? mt_arena_f64(scratch, n, rows) : NULL;
    double *const rho = mt_arena_f64(scratch, rows, 1);
    g->ct = mt_arena_f64(scratch, n, rows);
    g->d = mt_arena_f64(scratch, rows, 1);
    MT_TRY(mt_arena_check(scratch, err));
    if (!mt_all_finite((ptrdiff_t)b->rows * g->n, b->b)) {
        return mt_fail(err, MT_E_DOMAIN, "stiffness factor: an entry is not a finite number");
    }
    transform(b, mass, bt, g->ct);
    MT_TRY(normalise(b, mass, g, rho, err));
    shorten_noisy_rows(g, rho);
    MT_TRY(sort_coordinates(g, scratch, err));
    return mt_qr_factor(g->n, g->rows, g->ct, g->n, g->tol, scratch, &g->qr, err);
}

/*
 * Householder's method leaves E, eps in every row of C. Of D E the part within the columns of
 * D C is eps / kept of its singular values; where there are more rows than freedoms the rest is
 * eps max D, whatever these are. Where less than this part of the digits would be left of
 * either, elimination takes over; it costs as much again.
 */
static const double GRADED = 1e-4;

static bool is_graded(const graded *g, double most)
{
    double least = HUGE_VAL;
    for (int j = 0; j < g->rows; j++) {
        least = fmin(least, g->d[j]);
    }
    return g->qr.rank > 0 && g->kept * least < GRADED * most;
}

static mt_status singular_values(graded *g, mt_arena *scratch, mt_err *err)
{
    const int r = g->qr.rank;
    g->f = mt_arena_f64(scratch, (size_t)g->rows, (size_t)r);
    g->s = mt_arena_f64(scratch, (size_t)r, 1);
    g->v = mt_arena_f64(scratch, (size_t)r, (size_t)r);
    MT_TRY(mt_arena_check(scratch, err));
    g->kept = g->qr.kept;
    for (int j = 0; j < g->rows; j++) {
        g->most = fmax(g->most, g->d[j]);
    }
    g->eliminated = is_graded(g, g->most);
    if (g->eliminated) {
        mt_graded e = {.n = g->n,
                       .rows = g->rows,
                       .rank = r,
                       .d = g->d,
                       .ct = g->ct,
                       .place = g->place,
                       .w = g->f,
                       .interrupt = g->interrupt};
        MT_TRY(mt_modal_graded(&e, scratch, err));
        g->qr = e.q;
        MT_TRY(mt_interrupt_check(g->interrupt, err));
        return mt_svd_jacobi(r, r, g->f, g->s, g->v, scratch, err);
    }
    for (int j = 0; j < g->rows; j++) {
        const int row = g->qr.perm[j];
        for (int i = 0; i < r && i <= j; i++) {
            g->f[row + (ptrdiff_t)i * g->rows] = g->d[row] * g->qr.qr[i + (ptrdiff_t)j * g->n];
        }
    }
    return mt_svd_jacobi(g->rows, r, g->f, g->s, g->v, scratch, err);
}

/* Q := [Q2, Q1 V] in ascending order, then y. */
static mt_status vectors(const graded *g, const mt_mass_factor *mass, mt_arena *scratch,
                         double *y, mt_err *err)
{
    const int n = g->n;
    const int r = g->qr.rank;
    double *const q = mt_arena_f64(scratch, (size_t)n, (size_t)n);
    double *const column = mt_arena_f64(scratch, (size_t)n, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int j = 0; j < n - r; j++) {
        q[r + j + (ptrdiff_t)j * n] = 1.0;
    }
    for (int j = 0; j < r; j++) {
        memcpy(q + (ptrdiff_t)(n - 1 - j) * n, g->v + (ptrdiff_t)j * r, (size_t)r * sizeof *q);
    }
    MT_TRY(mt_qr_apply_q(&g->qr, false, n, q, scratch, err));
    for (ptrdiff_t j = 0; j < n; j++) {
        memcpy(column, q + j * n, (size_t)n * sizeof *column);
        for (ptrdiff_t i = 0; i < n; i++) {
            q[g->place[i] + j * n] = column[i];
        }
    }
    mt_modal_back(mass, n, q, y);
    return MT_OK;
}

/*
 * Effect of eps in every entry of B on the eigenvalues, in eps of the most affected one:
 *     sum_j 2 c_j |b_j . y| |b_j| . |y| / lambda.
 * With as many springs as freedoms it is at most 1 / kept; elimination has all of it.
 */
static mt_status find_entry_condition(const mt_stiffness_factor *b, const mt_modes *modes,
                                      int first, mt_arena *scratch, double *most, mt_err *err)
{
    const int n = modes->n;
    const int columns = n - first;
    const size_t rows = (size_t)b->rows;
    const double *const y = mt_modal_shape(modes, first);
    double *const abs_b = mt_arena_f64(scratch, rows, (size_t)n);
    double *const abs_y = mt_arena_f64(scratch, (size_t)n, (size_t)columns);
    double *const moved = mt_arena_f64(scratch, rows, (size_t)columns);
    double *const terms = mt_arena_f64(scratch, rows, (size_t)columns);
    MT_TRY(mt_arena_check(scratch, err));
    for (size_t i = 0; i < rows * (size_t)n; i++) {
        abs_b[i] = fabs(b->b[i]);
    }
    for (size_t i = 0; i < (size_t)n * (size_t)columns; i++) {
        abs_y[i] = fabs(y[i]);
    }
    mt_gemm(false, false, b->rows, columns, n, 1.0, b->b, b->rows, y, n, 0.0, moved, b->rows);
    mt_gemm(false, false, b->rows, columns, n, 1.0, abs_b, b->rows, abs_y, n, 0.0, terms,
            b->rows);
    for (int i = 0; i < columns; i++) {
        double sum = 0.0;
        for (size_t j = 0; j < rows; j++) {
            const size_t at = j + ((size_t)i * rows);
            sum += 2.0 * b->c[j] * fabs(moved[at]) * terms[at];
        }
        *most = fmax(*most, sum / modes->lambda[first + i]);
    }
    return MT_OK;
}

/* Relative error from rows other than those that determine each mode. */
static mt_status find_error_beside(const graded *g, const mt_stiffness_factor *b,
                                   const mt_modes *modes, mt_arena *scratch, double *beside,
                                   mt_err *err)
{
    const int r = g->qr.rank;
    *beside = 0.0;
    if (r == 0 || g->rows == r) {
        return MT_OK;
    }
    if (!g->eliminated) {
        *beside = 2.0 * g->most / g->s[r - 1] * fmax(g->tol, mt_modal_relative(g->n));
        return MT_OK;
    }
    double most = 0.0;
    if (modes->y != NULL) {
        MT_TRY(find_entry_condition(b, modes, g->n - r, scratch, &most, err));
    }
    *beside = MT_MODAL_NOISE_ULPS * DBL_EPSILON * most;
    return MT_OK;
}

mt_status mt_modal_by_factor(const mt_stiffness_factor *factor, const mt_mass_factor *mass,
                             mt_arena *scratch, mt_modes *out, int *null_count, mt_err *err)
{
    graded g = {.n = mass->n, .interrupt = factor->interrupt};
    MT_TRY(mt_interrupt_check(g.interrupt, err));
    MT_TRY(prepare_graded(factor, mass, &g, scratch, err));
    MT_TRY(mt_interrupt_check(g.interrupt, err));
    MT_TRY(singular_values(&g, scratch, err));
    MT_TRY(mt_interrupt_check(g.interrupt, err));
    const int r = g.qr.rank;
    *null_count = g.n - r;
    for (int i = 0; i < g.n; i++) {
        const double omega = i < g.n - r ? 0.0 : g.s[g.n - 1 - i];
        out->lambda[i] = omega * omega;
    }
    if (out->y != NULL) {
        MT_TRY(vectors(&g, mass, scratch, out->y, err));
    }
    out->from_factor = true;
    out->error_bound = 0.0;
    double beside = 0.0;
    MT_TRY(find_error_beside(&g, factor, out, scratch, &beside, err));
    out->error_relative =
        (fmax(g.tol, mt_modal_relative(g.n)) * (mass->condition + (1.0 / g.kept))) + beside;
    return MT_OK;
}
