/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modes of matrices: by the matrix alone, or by the factor of the stiffness, without and
 * with a load. */
#include "modal/solve.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "modal/modes.h"

/* Factor D C of rank >= 1, C^T in ct (n x rows, destroyed), D = diag(d), as U w Q1^T: U
 * orthonormal, Q1 the first rank columns of q, with its row i at coordinate place[i]. */
typedef struct graded_factor {
    int n;
    int rows;
    int rank;
    const double *d; /* [rows] */
    double *ct;
    int *place; /* [n] in: coordinate in each row of ct; out: see above */
    mt_qr q;    /* out */
    double *w;  /* out: rank x rank, zero on entry */
    mt_interrupt *interrupt;
} graded_factor;

/*
 * Directions without mass. With the basis [T1 T0] of mass.c, y = T1 a + T0 b, the lower rows of
 * the eigenproblem have no inertia force,
 *     K01 a + K00 b = 0   =>   b = -K00^-1 K01 a,
 * and the upper ones become (K11 - K10 K00^-1 K01) a = lambda a, so that
 *     Y = (T1 - T0 K00^-1 K01) Q.
 * K00 may be indefinite, so its eigenvalues decide. Its rows are scaled by
 * h_j = (|t_j|^T |K| |t_j|)^-1/2, the size of the terms that make the diagonal: what is left
 * after cancellation is then relative to one, and at most 16 n eps of that is nothing. A
 * negative eigenvalue is an instability without inertia (the limit of one whose rate grows
 * beyond bounds): it is condensed and counted.
 */

typedef struct parts {
    int n;
    int r;           /* with mass */
    int z;           /* without */
    const double *t; /* n x n */
    double *kt;      /* n x n: K T, then T^T K T */
    double *h;       /* [z] */
    double *vectors; /* z x z eigenvectors of scaled K00 */
    double *values;  /* [z] */
    double *k01;     /* z x r: scaled K01, then b for unit a */
    double *work;    /* z x r */
} parts;

static mt_status claim_parts(parts *p, mt_arena *scratch, mt_err *err)
{
    const size_t n = (size_t)p->n;
    const size_t z = (size_t)p->z;
    const size_t r = (size_t)p->r;
    p->kt = mt_arena_f64(scratch, n, n);
    p->h = mt_arena_f64(scratch, z, 1);
    p->vectors = mt_arena_f64(scratch, z, z);
    p->values = mt_arena_f64(scratch, z, 1);
    p->k01 = mt_arena_f64(scratch, z, r);
    p->work = mt_arena_f64(scratch, z, r);
    return mt_arena_check(scratch, err);
}

/* |t|^T |K| |t|, K lower. */
static double stiffness_terms(int n, const double *k, const double *t)
{
    double sum = 0.0;
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            const double term = fabs(t[i] * k[i + (ptrdiff_t)j * n] * t[j]);
            sum += i == j ? term : 2.0 * term;
        }
    }
    return sum;
}

static mt_status no_stiffness(const parts *p, int mode, mt_modes *out, mt_err *err)
{
    const int n = p->n;
    memset(out->massless, 0, (size_t)n * sizeof *out->massless);
    int at = 0;
    for (int j = 0; j < p->z; j++) {
        const double h = p->h[j] > 0.0 ? p->h[j] : 1.0;
        const double part = h * p->vectors[j + (ptrdiff_t)mode * p->z];
        mt_axpy(n, part, p->t + (ptrdiff_t)(p->r + j) * n, out->massless);
    }
    for (int i = 0; i < n; i++) {
        at = fabs(out->massless[i]) > fabs(out->massless[at]) ? i : at;
    }
    const double most = out->massless[at];
    for (int i = 0; i < n && most != 0.0; i++) {
        out->massless[i] /= most;
    }
    return mt_fail(err, MT_E_MASSLESS,
                   "a direction (mostly coordinate %d) has neither mass nor stiffness", at + 1);
}

/* Eigenvalues of the scaled K00; fails where one is nothing. */
static mt_status factor_k00(const parts *p, mt_arena *scratch, mt_modes *out, mt_err *err)
{
    const int n = p->n;
    for (int j = 0; j < p->z; j++) {
        for (int i = j; i < p->z; i++) {
            const double kij = p->kt[p->r + i + (ptrdiff_t)(p->r + j) * n];
            p->vectors[i + (ptrdiff_t)j * p->z] = p->h[i] * kij * p->h[j];
        }
    }
    MT_TRY(mt_eig_sym(p->z, p->vectors, p->values, true, scratch, err));
    for (int j = 0; j < p->z; j++) {
        if (fabs(p->values[j]) <= mt_modal_tolerance(n)) {
            return no_stiffness(p, j, out, err);
        }
        out->n_unstable_condensed += p->values[j] < 0.0 ? 1 : 0;
    }
    return MT_OK;
}

/* k01 := -K00^-1 K01 = -H V diag(1/values) V^T H K01. */
static void solve_k00(const parts *p)
{
    const int z = p->z;
    for (int j = 0; j < p->r; j++) {
        for (int i = 0; i < z; i++) {
            p->k01[i + (ptrdiff_t)j * z] = p->h[i] * p->kt[p->r + i + (ptrdiff_t)j * p->n];
        }
    }
    mt_gemm(true, false, z, p->r, z, -1.0, p->vectors, z, p->k01, z, 0.0, p->work, z);
    for (int j = 0; j < p->r; j++) {
        for (int i = 0; i < z; i++) {
            p->work[i + (ptrdiff_t)j * z] /= p->values[i];
        }
    }
    mt_gemm(false, false, z, p->r, z, 1.0, p->vectors, z, p->work, z, 0.0, p->k01, z);
    for (int j = 0; j < p->r; j++) {
        for (int i = 0; i < z; i++) {
            p->k01[i + (ptrdiff_t)j * z] *= p->h[i];
        }
    }
}

/* K restricted to directions with mass, the others condensed: a (rank x rank, full), t1 (n x
 * rank) with Y = t1 Q. Fails MT_E_MASSLESS. */
static mt_status modal_condense(const double *k, const mt_mass_factor *mass, mt_arena *scratch,
                                double *a, double *t1, mt_modes *out, mt_err *err)
{
    const int n = mass->n;
    parts p = {.n = n, .r = mass->rank, .z = n - mass->rank, .t = mass->t};
    MT_TRY(claim_parts(&p, scratch, err));
    const double *const t0 = p.t + (ptrdiff_t)p.r * n;
    for (int j = 0; j < p.z; j++) {
        const double terms = stiffness_terms(n, k, t0 + (ptrdiff_t)j * n);
        p.h[j] = terms > 0.0 ? 1.0 / sqrt(terms) : 0.0;
    }
    double *const kt = mt_arena_f64(scratch, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(scratch, err));
    mt_symm(n, n, k, p.t, kt);
    mt_gemm(true, false, n, n, n, 1.0, p.t, n, kt, n, 0.0, p.kt, n);
    MT_TRY(factor_k00(&p, scratch, out, err));
    solve_k00(&p);
    for (int j = 0; j < p.r; j++) {
        memcpy(a + (ptrdiff_t)j * p.r, p.kt + (ptrdiff_t)j * n, (size_t)p.r * sizeof *a);
        memcpy(t1 + (ptrdiff_t)j * n, p.t + (ptrdiff_t)j * n, (size_t)n * sizeof *t1);
    }
    const double *const k10 = p.kt + (ptrdiff_t)p.r * n;
    mt_gemm(false, false, p.r, p.r, p.z, 1.0, k10, n, p.k01, p.z, 1.0, a, p.r);
    mt_gemm(false, false, n, p.r, p.z, 1.0, t0, n, p.k01, p.z, 1.0, t1, n);
    return MT_OK;
}

/* A = L^-1 K L^-T (or T^T K T, or the condensed matrix), A Q = Q Lambda by mt_eig_sym, or in
 * two steps where few columns of Q are wanted; Y = L^-T Q (or T1 Q). Absolute error of each
 * lambda: about n eps s. */

/* s = max(|lambda|max, max |K_ii| (M^-1)_ii). */
static double stiffness_scale(const double *k, const mt_mass_factor *mass,
                              const mt_modes *modes)
{
    double s = mt_max_abs(modes->all, modes->lambda);
    for (int i = 0; i < mass->n; i++) {
        s = fmax(s, fabs(k[i + (ptrdiff_t)i * mass->n]) * mass->w[i]);
    }
    return s;
}

/* Regular M: q := A, lower; a and q n x n, the same where mass->t is NULL. */
static void standard(const double *k, const mt_mass_factor *mass, double *a, double *q)
{
    const int n = mass->n;
    if (mass->t != NULL) {
        mt_symm(n, n, k, mass->t, a);
        mt_gemm(true, false, n, n, n, 1.0, mass->t, n, a, n, 0.0, q, n);
    } else {
        for (int j = 0; j < n; j++) {
            const ptrdiff_t jj = j + (ptrdiff_t)j * n;
            memcpy(a + jj, k + jj, (size_t)(n - j) * sizeof *a);
        }
        if (mass->l != NULL) {
            mt_congruence_inverse(n, mass->l, a);
        }
    }
}

/* a: n x n, of which Y is made where vectors are wanted at once. */
static mt_status regular(const double *k, const mt_mass_factor *mass, double *a,
                         mt_arena *scratch, mt_modes *out, mt_tridiagonal *later, mt_err *err)
{
    const int n = mass->n;
    double *q = a;
    if (mass->t != NULL) {
        q = mt_arena_f64(scratch, (size_t)n, (size_t)n);
        MT_TRY(mt_arena_check(scratch, err));
    }
    standard(k, mass, a, q);
    if (later != NULL) {
        return mt_eig_sym_values(n, q, out->lambda, scratch, later, err);
    }
    MT_TRY(mt_eig_sym(n, q, out->lambda, out->y != NULL, scratch, err));
    if (out->y != NULL) {
        mt_modal_back(mass, n, q, a);
    }
    return MT_OK;
}

static mt_status modal_plain_lowest(const double *k, const mt_mass_factor *mass,
                                    const mt_tridiagonal *later, mt_arena *scratch,
                                    mt_modes *out, mt_err *err)
{
    const size_t n = (size_t)mass->n;
    double *q = out->y;
    if (mass->t != NULL) {
        q = mt_arena_f64(scratch, n, n);
        MT_TRY(mt_arena_check(scratch, err));
    }
    mt_err why = {.text = ""};
    const bool few = out->shaped <= mass->rank / MT_MODAL_PART;
    const mt_status rc =
        few ? mt_eig_sym_lowest(later, out->shaped, out->lambda, q, scratch, &why)
            : MT_E_NO_CONVERGENCE;
    if (rc != MT_OK && rc != MT_E_NO_CONVERGENCE) {
        return mt_fail(err, rc, "%s", why.text);
    }
    if (rc == MT_E_NO_CONVERGENCE) { /* more than a few, or inverse iteration failed */
        double *const w = mt_arena_f64(scratch, n, 1);
        MT_TRY(mt_arena_check(scratch, err));
        standard(k, mass, out->y, q);
        MT_TRY(mt_eig_sym(mass->n, q, w, true, scratch, err));
    }
    mt_modal_back(mass, out->shaped, q, out->y);
    return MT_OK;
}

static mt_status condensed(const double *k, const mt_mass_factor *mass, mt_arena *scratch,
                           mt_modes *out, mt_err *err)
{
    const int n = mass->n;
    const int r = mass->rank;
    const bool vectors = out->y != NULL;
    double *const a = mt_arena_f64(scratch, (size_t)r, (size_t)r);
    double *const t1 = mt_arena_f64(scratch, (size_t)n, (size_t)r);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(modal_condense(k, mass, scratch, a, t1, out, err));
    MT_TRY(mt_eig_sym(r, a, out->lambda, vectors, scratch, err));
    if (vectors) {
        mt_gemm(false, false, n, r, r, 1.0, t1, n, a, r, 0.0, out->y, n);
    }
    return MT_OK;
}

/* Fill lambda, y (where wanted), n_condensed..., scale from K restricted to directions with
 * mass. Kinds, clusters, sign and checks come later. later (may be NULL) is filled where y is
 * left to modal_plain_lowest, which computes out->shaped vectors; otherwise later->n is
 * 0. */
static mt_status modal_plain(const double *k, const mt_mass_factor *mass, mt_arena *scratch,
                             mt_modes *out, mt_tridiagonal *later, mt_err *err)
{
    const int n = mass->n;
    mt_tridiagonal *const apart = later != NULL && mass->rank == n ? later : NULL;
    if (!mt_lower_finite(n, k)) {
        return mt_fail(err, MT_E_DOMAIN, "stiffness matrix: an entry is not a finite number");
    }
    if (mass->rank < n) {
        MT_TRY(condensed(k, mass, scratch, out, err));
    } else {
        double *const a = out->y != NULL && apart == NULL
                              ? out->y
                              : mt_arena_f64(scratch, (size_t)n, (size_t)n);
        MT_TRY(mt_arena_check(scratch, err));
        MT_TRY(regular(k, mass, a, scratch, out, apart, err));
    }
    out->scale = stiffness_scale(k, mass, out);
    out->error_bound = mt_modal_tolerance(n) * out->scale;
    out->error_relative = mt_modal_relative(n) * fmin(mass->kept, 1.0 / DBL_EPSILON);
    return MT_OK;
}

/*
 * Singular values of D C where D spreads far or rows of C are almost parallel. Householder's
 * method leaves eps of its length in every entry of a row, also in those that are 0 or small
 * and have digits of their own: two springs from a light body to heavy ones are parallel but
 * for the small entries of the heavy ones. Gaussian elimination with complete pivoting keeps
 * them (Demmel et al., Linear Algebra Appl. 299 (1999), algorithm 3.1):
 *     Pr C^T Pc = L U,         L, U up to a scaling of the rows of U well conditioned,
 *     D C = Y L^T Pr,          Y = D Pc U^T,
 *     L = Q1 R1,   Y P2 = Q2 R2   (rows of Y sorted),
 *     D C = Q2 (R2 P2^T R1^T) Q1^T Pr,
 * where the product in parentheses has rows graded by R2 and one-sided Jacobi does the rest.
 * Every factor is found to high relative accuracy for matrices that are well conditioned up to
 * a scaling of rows and columns; for others the error is no larger than before.
 */

static void swap_rows(int n, int columns, int a, int b, double *x)
{
    for (ptrdiff_t j = 0; j < columns && a != b; j++) {
        const double kept = x[a + j * n];
        x[a + j * n] = x[b + j * n];
        x[b + j * n] = kept;
    }
}

static void swap_columns(int n, int a, int b, double *x)
{
    for (ptrdiff_t i = 0; i < n && a != b; i++) {
        const double kept = x[i + (ptrdiff_t)a * n];
        x[i + (ptrdiff_t)a * n] = x[i + (ptrdiff_t)b * n];
        x[i + (ptrdiff_t)b * n] = kept;
    }
}

static void swap_places(int a, int b, int *place)
{
    const int kept = place[a];
    place[a] = place[b];
    place[b] = kept;
}

/* x (n x columns) := L below the diagonal, U above it, for `rank` steps; fewer where the work
 * is interrupted. most[columns]: where the largest entry of each column that is left stands,
 * looked up while the column is in the cache. */
static void eliminate_columns(const graded_factor *g, int *column, ptrdiff_t *most)
{
    const int n = g->n;
    const int columns = g->rows;
    double *const x = g->ct;
    int *const row = g->place;
    for (ptrdiff_t j = 0; j < columns; j++) {
        most[j] = j * n + mt_max_index(n, x + j * n);
    }
    for (ptrdiff_t k = 0; k < g->rank; k++) {
        if (n >= MT_INTERRUPT_ORDER && mt_interrupted(g->interrupt)) {
            return;
        }
        ptrdiff_t at = most[k];
        for (ptrdiff_t j = k + 1; j < columns; j++) {
            at = fabs(x[most[j]]) > fabs(x[at]) ? most[j] : at;
        }
        swap_places((int)k, (int)(at % n), row);
        swap_places((int)k, (int)(at / n), column);
        swap_rows(n, columns, (int)k, (int)(at % n), x);
        swap_columns(n, (int)k, (int)(at / n), x);
        double *const own = x + k * n;
        for (ptrdiff_t i = k + 1; i < n; i++) {
            own[i] /= own[k];
        }
        const int left = n - 1 - (int)k;
        for (ptrdiff_t j = k + 1; j < columns && left > 0; j++) {
            const double factor = x[k + j * n];
            double *const rest = x + j * n + k + 1;
            if (factor != 0.0) {
                mt_axpy(left, -factor, own + k + 1, rest);
            }
            most[j] = (rest - x) + mt_max_index(left, rest);
        }
    }
}

/* Rows of y (rows x r) in descending order of their largest entry: swapped, smallest last. */
static void sort_rows(int rows, int r, double *y, double *size)
{
    for (ptrdiff_t i = 0; i < rows; i++) {
        size[i] = 0.0;
        for (ptrdiff_t j = 0; j < r; j++) {
            size[i] = fmax(size[i], fabs(y[i + j * rows]));
        }
    }
    for (int i = 0; i < rows; i++) {
        int most = i;
        for (int k = i + 1; k < rows; k++) {
            most = size[k] > size[most] ? k : most;
        }
        swap_rows(rows, r, i, most, y);
        size[most] = size[i];
    }
}

/* w (r x r) := R2 P2^T P1 R1^T, with L P1 = Q1 R1; at[r]: work. */
static void product_of_factors(int r, const mt_qr *l, const mt_qr *y, int *at, double *w)
{
    for (int b = 0; b < r; b++) {
        at[l->perm[b]] = b;
    }
    for (ptrdiff_t a = 0; a < r; a++) {
        const ptrdiff_t b = at[y->perm[a]]; /* the same column of L and Y */
        for (ptrdiff_t j = 0; j <= b; j++) {
            mt_axpy((int)a + 1, l->qr[j + b * l->m], y->qr + a * y->m, w + j * r);
        }
    }
}

static mt_status modal_graded(graded_factor *g, mt_arena *mem, mt_err *err)
{
    const ptrdiff_t n = g->n;
    const ptrdiff_t rows = g->rows;
    const size_t rank = (size_t)g->rank;
    int *const column = mt_arena_int(mem, (size_t)rows);
    ptrdiff_t *const most = mt_arena_alloc(mem, (size_t)rows, sizeof *most);
    double *const l = mt_arena_f64(mem, (size_t)n, rank);
    double *const y = mt_arena_f64(mem, (size_t)rows, rank);
    double *const size = mt_arena_f64(mem, (size_t)rows, 1);
    mt_qr yq;
    MT_TRY(mt_arena_check(mem, err));
    for (int j = 0; j < rows; j++) {
        column[j] = j;
    }
    eliminate_columns(g, column, most);
    MT_TRY(mt_interrupt_check(g->interrupt, err));
    for (ptrdiff_t k = 0; k < g->rank; k++) {
        l[k + k * n] = 1.0;
        for (ptrdiff_t i = k + 1; i < n; i++) {
            l[i + k * n] = g->ct[i + k * n];
        }
        for (ptrdiff_t j = k; j < rows; j++) {
            y[j + k * rows] = g->d[column[j]] * g->ct[k + j * n];
        }
    }
    sort_rows(g->rows, g->rank, y, size);
    MT_TRY(mt_qr_factor(g->n, g->rank, l, g->n, 0.0, mem, &g->q, err));
    MT_TRY(mt_qr_factor(g->rows, g->rank, y, g->rows, 0.0, mem, &yq, err));
    product_of_factors(g->rank, &g->q, &yq, column, g->w);
    return MT_OK;
}

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
 * exactly 0 in a stiff row must not become eps; then C is eliminated instead, as above.
 * lambda: zero for Q2, sigma^2 for Q1 V.
 */

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
        graded_factor e = {.n = g->n,
                           .rows = g->rows,
                           .rank = r,
                           .d = g->d,
                           .ct = g->ct,
                           .place = g->place,
                           .w = g->f,
                           .interrupt = g->interrupt};
        MT_TRY(modal_graded(&e, scratch, err));
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

/* As modal_plain with K = B^T diag(c) B and regular M: *null_count eigenvalues are exactly
 * zero. */
static mt_status modal_by_factor(const mt_stiffness_factor *factor, const mt_mass_factor *mass,
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

/*
 * A load on top of the springs: K = B^T diag(c) B + G, G the part that is no sum of squares.
 * Summed into one matrix, G and the soft springs drown in eps times the stiffest spring.
 * Instead, with the modes Y of the springs alone from the factor (Y^T M Y = I, Y^T B^T diag(c)
 * B Y = D, the entries of D good to a relative error each, null directions first),
 *     H = Y^T K Y = D + W,   W = Y^T G Y:
 * W is as large as the loads are, whatever the springs, and H is graded: it is S A S with
 * S = diag(H)^1/2 and A well conditioned, since |w_ij| is small beside sqrt(h_ii h_jj) wherever
 * D dominates. For a positive definite matrix of that kind a Cholesky factor and one-sided
 * Jacobi on it give every eigenvalue to a relative n eps cond(A) (Demmel and Veselic, SIAM J.
 * Matrix Anal. Appl. 13 (1992) 1204-1245): H = F^T F, F = R S, A = R^T R, eigenvalues
 * sigma(F)^2.
 *
 * Where H is not positive definite (something is free, or topples), or A is nearly singular,
 * the same is done with H + tau, tau = 2 ||W||: then A is as good as diagonal, and tau, no
 * larger than the loads, takes no more than n eps tau from any eigenvalue.
 */

/* Pivots of A (unit diagonal) below this: its condition would cost more digits than the
 * shift. */
static const double LEAST_PIVOT = 1e-6;

typedef struct loaded {
    int n;
    double *h; /* n x n: H, lower */
    double *s; /* [n] */
    double *f; /* n x n: R S */
    double *sigma;
    double *v;   /* n x n */
    double size; /* ||W||: greatest sum of |w_ij| over a row, which no eigenvalue exceeds */
    double tau;
    double pivot; /* least of A */
} loaded;

static mt_status claim_loaded(loaded *l, mt_arena *scratch, mt_err *err)
{
    const size_t n = (size_t)l->n;
    l->h = mt_arena_f64(scratch, n, n);
    l->s = mt_arena_f64(scratch, n, 1);
    l->f = mt_arena_f64(scratch, n, n);
    l->sigma = mt_arena_f64(scratch, n, 1);
    l->v = mt_arena_f64(scratch, n, n);
    return mt_arena_check(scratch, err);
}

/* h := W + D; f is work. */
static mt_status project_load_stiffness(const double *g, const mt_modes *modes, loaded *l,
                                        mt_err *err)
{
    const int n = l->n;
    if (!mt_lower_finite(n, g)) {
        return mt_fail(err, MT_E_DOMAIN, "stiffness of the loads: an entry is not finite");
    }
    mt_symm(n, n, g, modes->y, l->f);
    mt_gemm(true, false, n, n, n, 1.0, modes->y, n, l->f, n, 0.0, l->h, n);
    for (int j = 0; j < n; j++) {
        double sum = 0.0;
        for (int i = 0; i < n; i++) {
            sum += fabs(l->h[i + (ptrdiff_t)j * n]);
        }
        l->size = fmax(l->size, sum);
    }
    for (int j = 0; j < n; j++) {
        l->h[j + (ptrdiff_t)j * n] += modes->lambda[j];
    }
    return MT_OK;
}

/* f := R S of H + tau. False where that is not positive definite, or nearly so. */
static bool square_root(loaded *l)
{
    const ptrdiff_t n = l->n;
    for (ptrdiff_t j = 0; j < n; j++) {
        const double diagonal = l->h[j + j * n] + l->tau;
        if (!(diagonal > 0.0)) {
            return false;
        }
        l->s[j] = sqrt(diagonal);
    }
    for (ptrdiff_t j = 0; j < n; j++) {
        l->v[j + j * n] = 1.0;
        for (ptrdiff_t i = j + 1; i < n; i++) {
            l->v[i + j * n] = l->h[i + j * n] / l->s[i] / l->s[j];
        }
    }
    if (mt_cholesky(l->n, l->v, NULL, NULL) != MT_OK) {
        return false;
    }
    l->pivot = 1.0;
    for (ptrdiff_t j = 0; j < n; j++) {
        l->pivot = fmin(l->pivot, l->v[j + j * n] * l->v[j + j * n]);
        for (ptrdiff_t i = 0; i < n; i++) {
            l->f[i + j * n] = i <= j ? l->v[j + i * n] * l->s[j] : 0.0;
        }
    }
    return l->pivot >= LEAST_PIVOT;
}

/* After modal_by_factor with y: modes of B^T diag(c) B + G from those without G; G n x n
 * symmetric, lower read. */
static mt_status modal_add_load(const double *g, const mt_mass_factor *mass, mt_arena *scratch,
                                mt_modes *out, mt_err *err)
{
    const int n = mass->n;
    const double tolerance = mt_modal_tolerance(n);
    loaded l = {.n = n};
    MT_TRY(claim_loaded(&l, scratch, err));
    MT_TRY(project_load_stiffness(g, out, &l, err));
    if (l.size == 0.0) {
        return MT_OK;
    }
    if (!square_root(&l)) {
        l.tau = 2.0 * l.size;
        if (!square_root(&l)) {
            return mt_fail(err, MT_E_NO_CONVERGENCE, "the modes under load were not found");
        }
    }
    MT_TRY(mt_svd_jacobi(n, n, l.f, l.sigma, l.v, scratch, err));
    for (int i = 0; i < n; i++) {
        const double sigma = l.sigma[n - 1 - i];
        out->lambda[i] = sigma * sigma - l.tau;
        for (int k = 0; k < n; k++) {
            l.h[k + (ptrdiff_t)i * n] = l.v[k + (ptrdiff_t)(n - 1 - i) * n];
        }
    }
    mt_gemm(false, false, n, n, n, 1.0, out->y, n, l.h, n, 0.0, l.f, n);
    memcpy(out->y, l.f, (size_t)n * (size_t)n * sizeof *l.f);
    out->error_bound = tolerance * (l.size + l.tau);
    out->error_relative += tolerance / l.pivot;
    return MT_OK;
}

/*
 * Residual and orthogonality, judged as LAPACK's own tests judge them: in units of n eps, so
 * that O(1) is perfect. Rows of K may have different units, so vectors and forces are measured
 * in coordinates in which m_ii = 1, D = diag(m_ii)^-1/2:
 *     ||D (K y - lambda M y)|| / ((||D K D|| + |lambda| ||D M D||) ||D^-1 y|| n eps).
 * A coordinate without mass takes the mass that would move it at the stiffness scale s, which
 * is |k_ii| / s.
 */

/* Frobenius norm of D A D, A lower; A NULL: identity. */
static double scaled_norm(int n, const double *a, const double *d)
{
    double sum = 0.0;
    for (int j = 0; j < n; j++) {
        const double *const aj = a == NULL ? NULL : a + (ptrdiff_t)j * n;
        const double diagonal = (a == NULL ? 1.0 : aj[j]) * d[j];
        double below = 0.0;
        for (int i = j + 1; i < n && a != NULL; i++) {
            const double e = d[i] * aj[i];
            below += e * e;
        }
        sum += d[j] * d[j] * (2.0 * below + diagonal * diagonal);
    }
    return sqrt(sum);
}

typedef struct checker {
    int n;
    double *d;  /* [n] */
    double *ky; /* n x count */
    double *my; /* n x count; Y itself where M is the identity */
    double k_norm;
    double m_norm;
} checker;

static double residual_of_mode(const checker *c, const mt_modes *modes, int i)
{
    const ptrdiff_t at = (ptrdiff_t)i * c->n;
    const double lambda = modes->lambda[i];
    double force = 0.0;
    double size = 0.0;
    for (int j = 0; j < c->n; j++) {
        const double f = c->d[j] * (c->ky[at + j] - lambda * c->my[at + j]);
        const double v = modes->y[at + j] / c->d[j];
        force += f * f;
        size += v * v;
    }
    const double unit =
        (c->k_norm + fabs(lambda) * c->m_norm) * sqrt(size) * c->n * DBL_EPSILON;
    if (!(force > 0.0)) {
        return 0.0 * unit; /* NaN stays NaN */
    }
    return unit > 0.0 ? sqrt(force) / unit : HUGE_VAL;
}

static void orthogonality(const checker *c, double *gram, mt_modes *modes)
{
    const int r = modes->shaped;
    mt_gemm(true, false, r, r, c->n, 1.0, modes->y, c->n, c->my, c->n, 0.0, gram, r);
    for (int i = 0; i < r; i++) {
        gram[i + (ptrdiff_t)i * r] -= 1.0;
        modes->orthogonality[i] =
            mt_max_abs(r, gram + (ptrdiff_t)i * r) / ((double)c->n * DBL_EPSILON);
    }
}

/* Fill residual and orthogonality. */
static mt_status modal_check(const double *k, const mt_mass_factor *mass, mt_arena *scratch,
                             mt_modes *modes, mt_err *err)
{
    const int n = mass->n;
    const size_t r = (size_t)modes->shaped;
    checker c = {.n = n};
    c.d = mt_arena_f64(scratch, (size_t)n, 1);
    c.ky = mt_arena_f64(scratch, (size_t)n, r);
    c.my = mass->m == NULL ? modes->y : mt_arena_f64(scratch, (size_t)n, r);
    double *const gram = mt_arena_f64(scratch, r, r);
    MT_TRY(mt_arena_check(scratch, err));
    for (int i = 0; i < n; i++) {
        const double kii = fabs(k[i + (ptrdiff_t)i * n]);
        const double virtual_d =
            kii > 0.0 && modes->scale > 0.0 ? fmax(sqrt(modes->scale / kii), DBL_MIN) : 1.0;
        c.d[i] = mass->d[i] > 0.0 ? mass->d[i] : virtual_d;
    }
    c.k_norm = scaled_norm(n, k, c.d);
    c.m_norm = scaled_norm(n, mass->m, c.d);
    mt_symm(n, modes->shaped, k, modes->y, c.ky);
    if (mass->m != NULL) {
        mt_symm(n, modes->shaped, mass->m, modes->y, c.my);
    }
    for (int i = 0; i < modes->shaped; i++) {
        modes->residual[i] = residual_of_mode(&c, modes, i);
    }
    orthogonality(&c, gram, modes);
    return MT_OK;
}

/*
 * One solve:
 *   take results from mem; mark; plain path; kinds; perhaps the factor path (and the load's
 *   part on top of it) and kinds again; clusters; what was asked for; signs; checks; rewind to
 *   the mark.
 */

mt_modal_options mt_modal_options_default(void)
{
    return (mt_modal_options){.n_rigid = -1, .vectors = true, .accuracy = 0.0, .check = true};
}

static mt_status claim_modes(const mt_mass_factor *mass, const mt_modal_options *opt,
                             mt_arena *mem, mt_modes *out, mt_err *err)
{
    const int count = mass->rank;
    const size_t c = (size_t)count;
    *out =
        (mt_modes){.n = mass->n, .all = count, .count = count, .n_condensed = mass->n - count};
    out->lambda = mt_arena_f64(mem, c, 1);
    out->shaped = opt->vectors ? count : 0;
    out->kind = mt_arena_alloc(mem, c, sizeof *out->kind);
    out->cluster = mt_arena_int(mem, c);
    out->error = mt_arena_f64(mem, c, 1);
    if (opt->vectors) {
        out->y = mt_arena_f64(mem, (size_t)mass->n, c);
    }
    if (opt->vectors && opt->check) {
        out->residual = mt_arena_f64(mem, c, 1);
        out->orthogonality = mt_arena_f64(mem, c, 1);
    }
    if (out->n_condensed > 0) {
        out->massless = mt_arena_f64(mem, (size_t)mass->n, 1);
    }
    return mt_arena_check(mem, err);
}

/* Errors of eigenvalues that quotients make the 1e-9 of mt_modal_rough of, by the square. */
static const double SHAPES = 3e-5;

/* True where the plain result is not accurate enough. Signs and ranks are uncertain where a
 * factor (K semidefinite by construction) has an unstable mode, rigid-body modes that were not
 * given, or given ones with stiffness. */
static bool needs_factor(const mt_modes *modes, const mt_modal_options *opt)
{
    if (modes->n_unstable > 0 || modes->n_held > 0 ||
        (opt->n_rigid < 0 && modes->n_rigid > 0)) {
        return true;
    }
    const int lowest = mt_modal_flexible(modes, 1);
    if (lowest >= 0 && opt->judged) {
        return modes->error_bound > SHAPES * modes->lambda[lowest];
    }
    return lowest >= 0 && DBL_EPSILON * modes->scale > opt->accuracy * modes->lambda[lowest];
}

/* Correct n_held, which classification counts above the noise only. */
static void judge_held(mt_modes *modes, const mt_modal_options *opt, double rigid_most,
                       int null_count)
{
    if (null_count >= 0) {
        modes->n_held = opt->n_rigid > null_count ? opt->n_rigid - null_count : 0;
    } else if (!(rigid_most > MT_MODAL_HELD * modes->error_bound)) {
        modes->n_held = 0;
    }
}

/* Solve with the factor, then add G; the rank of B then says nothing about the null directions
 * of K (null_count -1). */
static mt_status by_factor(const mt_stiffness_factor *factor, const mt_mass_factor *mass,
                           mt_arena *scratch, mt_modes *out, int *null_count, mt_err *err)
{
    double *const wanted = out->y;
    if (factor->g != NULL && out->y == NULL) {
        out->y = mt_arena_f64(scratch, (size_t)out->n, (size_t)out->n);
        MT_TRY(mt_arena_check(scratch, err));
    }
    mt_status rc = modal_by_factor(factor, mass, scratch, out, null_count, err);
    if (rc == MT_OK && factor->g != NULL) {
        rc = modal_add_load(factor->g, mass, scratch, out, err);
        *null_count = -1;
    }
    out->y = wanted;
    return rc;
}

/* Kinds and errors; zero eigenvalues are decided by the absolute bound, and the value set to
 * zero is then part of its error. */
static double kinds(mt_modes *out, int n_rigid)
{
    for (int i = 0; i < out->count; i++) {
        out->error[i] = out->lambda[i];
    }
    const double most = mt_modal_classify(out, n_rigid, NULL, NULL);
    for (int i = 0; i < out->count; i++) {
        const double was = out->error[i];
        const double part = out->lambda[i] == was ? out->error_relative : 1.0;
        out->error[i] = out->error_bound + (part * fabs(was));
    }
    return most;
}

/* True where fewer shapes than all may be wanted and are cheaper. The number of modes up to a
 * frequency is not known beforehand. */
static bool is_part(const mt_mass_factor *mass, const mt_modal_options *opt)
{
    const int modes = opt->modes.first > 0 ? opt->modes.first : mass->rank;
    const int shapes = opt->shapes.first > 0 ? opt->shapes.first : modes;
    const bool part = opt->shapes.up_to > 0.0 || opt->modes.up_to > 0.0;
    const int least = part && opt->shapes.first == 0 ? 0 : shapes < modes ? shapes : modes;
    return opt->vectors && mass->rank >= MT_MODAL_PART_ORDER &&
           least <= mass->rank / MT_MODAL_PART;
}

/* Number of lowest modes that contain all of a part; maybe_zero: and all modes that may be
 * 0. */
static int end_of(const mt_modes *out, const mt_modal_part *part, bool maybe_zero)
{
    const bool all = part->first <= 0 && !(part->up_to > 0.0);
    int seen = 0;
    int end = 0;
    for (int i = 0; i < out->count; i++) {
        const bool flexible = out->kind[i] == MT_MODE_FLEXIBLE;
        seen += flexible ? 1 : 0;
        const bool asked =
            seen <= part->first || (part->up_to > 0.0 && out->lambda[i] <= part->up_to);
        const bool repeated = i > 0 && end == i && out->cluster[i] == out->cluster[i - 1];
        const bool zero = maybe_zero && out->lambda[i] <= out->error[i];
        end = all || !flexible || asked || repeated || zero ? i + 1 : end;
    }
    return end;
}

/* Drop modes and shapes that are not wanted. */
static void drop_unwanted_modes(mt_modes *out, const mt_modal_options *opt)
{
    out->count = end_of(out, &opt->modes, false);
    out->shaped = opt->vectors ? end_of(out, &opt->shapes, true) : 0;
}

static mt_status compute(const double *k, const mt_mass_factor *mass,
                         const mt_stiffness_factor *factor, const mt_modal_options *opt,
                         mt_arena *scratch, mt_modes *out, mt_err *err)
{
    int null_count = -1;
    mt_tridiagonal later = {.n = 0};
    MT_TRY(modal_plain(k, mass, scratch, out, is_part(mass, opt) ? &later : NULL, err));
    double rigid_most = kinds(out, opt->n_rigid);
    const bool usable = factor != NULL && opt->accuracy > 0.0 && mass->rank == mass->n;
    if (usable && needs_factor(out, opt)) {
        MT_TRY(by_factor(factor, mass, scratch, out, &null_count, err));
        const bool exact = opt->n_rigid < 0 && null_count >= 0;
        rigid_most = kinds(out, exact ? null_count : opt->n_rigid);
    }
    judge_held(out, opt, rigid_most, null_count);
    mt_modal_find_clusters(out);
    drop_unwanted_modes(out, opt);
    if (later.n > 0 && !out->from_factor) {
        MT_TRY(modal_plain_lowest(k, mass, &later, scratch, out, err));
    }
    if (opt->vectors) {
        mt_modal_fix_sign(out->n, out->shaped, out->y);
    }
    return out->residual == NULL ? MT_OK : modal_check(k, mass, scratch, out, err);
}

mt_status mt_modal_solve(const double *k, const mt_mass_factor *mass,
                         const mt_stiffness_factor *factor, const mt_modal_options *opt,
                         mt_arena *mem, mt_modes *out, mt_err *err)
{
    const mt_modal_options used = opt == NULL ? mt_modal_options_default() : *opt;
    MT_TRY(claim_modes(mass, &used, mem, out, err));
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = compute(k, mass, factor, &used, mem, out, err);
    mt_arena_rewind(mem, mark);
    if (rc != MT_E_MASSLESS) {
        out->massless = NULL;
    }
    return rc;
}
