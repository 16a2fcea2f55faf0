/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The processor's BLAS and LAPACK, and what is computed of dense matrices. */
#include "linalg/dense.h"

#include <cblas.h>
#include <lapacke.h>

#include <complex.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "linalg/eig_small.h"

/*
 * OpenBLAS claims a work buffer (128 MB of address space, of which small matrices touch little)
 * for every thread that is in it at the same time, keeps it, and where it cannot have one asks
 * for ever. Its own threads, started when it is loaded, do the same before main begins. So a
 * program loads it with one thread, and claims the buffers of its workers while a failure can
 * still be told. (The serial OpenBLAS starts no threads, but without locks: Debian's is not for
 * callers with threads.)
 */

/* Exported by every OpenBLAS, though no header declares them: its constructor, which does
 * nothing the second time, and its pool. */
extern void gotoblas_init(void) __attribute__((weak));
extern void *blas_memory_alloc(int position) __attribute__((weak));
extern void blas_memory_free(void *buffer) __attribute__((weak));

void mt_blas_load(void)
{
    if (gotoblas_init != NULL) {
        gotoblas_init();
    }
}

void mt_blas_set_threads(int threads)
{
    openblas_set_num_threads(threads > 1 ? threads : 1);
}

mt_status mt_blas_claim(int callers, mt_err *err)
{
    enum { MOST = 64 };
    void *buffers[MOST];
    const int n = callers < 1 ? 1 : callers > MOST ? MOST : callers;
    int have = 0;
    while (have < n && blas_memory_alloc != NULL && blas_memory_free != NULL) {
        void *volatile const room = malloc(MT_BLAS_BUFFER); /* not to be optimised away */
        if (room == NULL) {
            break;
        }
        free(room);
        buffers[have++] = blas_memory_alloc(0);
    }
    for (int i = have - 1; i >= 0; i--) {
        blas_memory_free(buffers[i]);
    }
    if (have < n && blas_memory_alloc != NULL && blas_memory_free != NULL) {
        return mt_fail(err, MT_E_MEMORY,
                       "out of memory: OpenBLAS reserves 128 MB of address space for each "
                       "worker, which not all of %d can have",
                       n);
    }
    return MT_OK;
}

const char *mt_blas_description(void)
{
    const char *const text = openblas_get_config();
    return text == NULL ? "OpenBLAS" : text;
}

/* Failures and work arrays of LAPACK. */

mt_status mt_lapack_bug(const char *routine, int info, mt_err *err)
{
    return mt_fail(err, MT_E_INTERNAL, "%s: argument %d is wrong", routine, -info);
}

mt_status mt_lapack_not_finite(const char *routine, mt_err *err)
{
    return mt_fail(err, MT_E_DOMAIN, "%s: a matrix entry is not a finite number", routine);
}

mt_status mt_lapack_work(mt_arena *scratch, double query, double minimum, double **work,
                         int *lwork, mt_err *err)
{
    const double size = ceil(fmax(fmax(query, minimum), 1.0));
    if (!(size <= (double)INT_MAX)) {
        return mt_fail_memory(err);
    }
    *lwork = (int)size;
    *work = mt_arena_f64(scratch, (size_t)size, 1);
    return mt_arena_check(scratch, err);
}

/* glibc chooses its functions by the processor. Their variants agree in most last bits: a few
 * thousand arguments tell them apart. */

enum { ARGUMENTS = 1024, FUNCTIONS = 10 };

/* FNV-1a on words, with the high bits, which know all others, brought down. */
static uint64_t mixed(uint64_t hash, double value)
{
    uint64_t bits = 0;
    memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * UINT64_C(0x9E3779B97F4A7C15);
    return hash ^ (hash >> 32U);
}

void mt_arithmetic_digest(char out[MT_ARITHMETIC_TEXT])
{
    uint64_t hash = 0;
    for (int i = 0; i < ARGUMENTS; i++) {
        const double x = 0.1 + 0.0371 * i;
        const double all[FUNCTIONS] = {sin(x),        cos(x),        tan(x),      exp(-x),
                                       log(x),        pow(x, 1.7),   atan2(x, 3), hypot(x, 0.7),
                                       sinh(0.1 * x), tanh(0.01 * x)};
        for (int k = 0; k < FUNCTIONS; k++) {
            hash = mixed(hash, all[k]);
        }
    }
    (void)mt_snprintf(out, MT_ARITHMETIC_TEXT, "%08lx%08lx", (unsigned long)(hash >> 32U),
                      (unsigned long)(hash & UINT64_C(0xFFFFFFFF)));
}

/* Products and norms. BLAS refuses leading dimensions below one, hence `ld`. */

static int ld(int rows)
{
    return rows > 1 ? rows : 1;
}

static enum CBLAS_TRANSPOSE op(bool trans)
{
    return trans ? CblasTrans : CblasNoTrans;
}

/* NOLINTNEXTLINE(readability-function-size): the argument list is BLAS's */
void mt_gemm(bool trans_a, bool trans_b, int m, int n, int k, double alpha, const double *a,
             int lda, const double *b, int ldb, double beta, double *c, int ldc)
{
    if (m > 0 && n > 0) {
        cblas_dgemm(CblasColMajor, op(trans_a), op(trans_b), m, n, k, alpha, a, ld(lda), b,
                    ld(ldb), beta, c, ld(ldc));
    }
}

/* NOLINTNEXTLINE(readability-function-size): the argument list is BLAS's */
void mt_gemv(bool trans, int m, int n, double alpha, const double *a, int lda, const double *x,
             double beta, double *y)
{
    /* an empty sum must still scale y, and BLAS returns early there */
    const int rows = trans ? n : m;
    const int terms = trans ? m : n;
    if (terms > 0 && rows > 0) {
        cblas_dgemv(CblasColMajor, op(trans), m, n, alpha, a, ld(lda), x, 1, beta, y, 1);
        return;
    }
    for (int i = 0; i < rows; i++) {
        y[i] = beta == 0.0 ? 0.0 : beta * y[i];
    }
}

void mt_symm(int n, int nrhs, const double *a, const double *b, double *c)
{
    if (n > 0 && nrhs > 0) {
        cblas_dsymm(CblasColMajor, CblasLeft, CblasLower, n, nrhs, 1.0, a, n, b, n, 0.0, c, n);
    }
}

double mt_dot(int n, const double *x, const double *y)
{
    return cblas_ddot(n, x, 1, y, 1);
}

double mt_norm2(int n, const double *x)
{
    return cblas_dnrm2(n, x, 1);
}

void mt_axpy(int n, double alpha, const double *x, double *y)
{
    cblas_daxpy(n, alpha, x, 1, y, 1);
}

int mt_max_index(int n, const double *x)
{
    return (int)cblas_idamax(n, x, 1);
}

double mt_max_abs(ptrdiff_t n, const double *x)
{
    double most = 0.0;
    for (ptrdiff_t i = 0; i < n; i++) {
        const double v = fabs(x[i]);
        if (!(v <= most)) { /* also true for NaN, which then stays */
            most = v;
        }
        if (isnan(most)) {
            break;
        }
    }
    return most;
}

/* 0 * x is 0 for finite x and NaN otherwise, so one sum checks all entries without a branch. */
bool mt_all_finite(ptrdiff_t n, const double *x)
{
    double sum = 0.0;
    for (ptrdiff_t i = 0; i < n; i++) {
        sum += 0.0 * x[i];
    }
    return sum == 0.0;
}

bool mt_lower_finite(int n, const double *a)
{
    double sum = 0.0;
    for (int j = 0; j < n; j++) {
        const double *const aj = a + (ptrdiff_t)j * n;
        for (int i = j; i < n; i++) {
            sum += 0.0 * aj[i];
        }
    }
    return sum == 0.0;
}

/* NOLINTNEXTLINE(readability-function-size): as a product's */
void mt_turn_columns(ptrdiff_t n, int m, int count, const double *q, ptrdiff_t step, double *v,
                     double *row)
{
    for (ptrdiff_t i = 0; i < n; i++) {
        for (int k = 0; k < m; k++) {
            row[k] = v[i + (n * k)];
        }
        for (int k = 0; k < count; k++) {
            v[i + (n * k)] = mt_dot(m, row, q + (step * k));
        }
    }
}

void mt_transpose(int m, int n, const double *a, double *b)
{
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < m; i++) {
            b[j + (ptrdiff_t)i * n] = a[i + (ptrdiff_t)j * m];
        }
    }
}

void mt_symmetrise_lower(int n, double *a)
{
    for (int j = 0; j < n; j++) {
        for (int i = j + 1; i < n; i++) {
            a[j + (ptrdiff_t)i * n] = a[i + (ptrdiff_t)j * n];
        }
    }
}

/* Cholesky's factor. */

mt_status mt_cholesky(int n, double *a, int *bad, mt_err *err)
{
    if (bad != NULL) {
        *bad = -1;
    }
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_lower_finite(n, a)) {
        return mt_lapack_not_finite("dpotrf", err);
    }
    const lapack_int info = LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', n, a, n);
    if (info < 0) {
        return mt_lapack_bug("dpotrf", info, err);
    }
    /* products of finite entries may overflow: every such entry reaches a later diagonal one */
    int pivot = (int)info - 1;
    for (int i = 0; i < n && pivot < 0; i++) {
        const double d = a[i + (ptrdiff_t)i * n];
        if (!(d > 0.0 && isfinite(d))) {
            pivot = i;
        }
    }
    if (pivot < 0) {
        return MT_OK;
    }
    if (bad != NULL) {
        *bad = pivot;
    }
    return mt_fail(err, MT_E_NOT_SPD, "the matrix loses positivity at row %d", pivot + 1);
}

void mt_tri_solve(bool trans, int n, int nrhs, const double *l, double *x, int ldx)
{
    if (n > 0 && nrhs > 0) {
        cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, trans ? CblasTrans : CblasNoTrans,
                    CblasNonUnit, n, nrhs, 1.0, l, n, x, ldx > 1 ? ldx : 1);
    }
}

void mt_congruence_inverse(int n, const double *l, double *a)
{
    if (n == 0) {
        return;
    }
    mt_symmetrise_lower(n, a);
    mt_tri_solve(false, n, n, l, a, n);
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, n, n, 1.0, l,
                n, a, n);
    mt_symmetrise_lower(n, a); /* the two triangles differ by rounding */
}

void mt_tri_inverse(int n, const double *l, double *x)
{
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            x[i + (ptrdiff_t)j * n] = i == j ? 1.0 : 0.0;
        }
    }
    mt_tri_solve(false, n, n, l, x, n);
}

/* Linear equations. */

static mt_status singular(const char *what, lapack_int pivot, mt_err *err)
{
    return mt_fail(err, MT_E_SINGULAR, "%s: the matrix is singular at row %d", what,
                   (int)pivot);
}

static mt_status estimate_rcond(int n, const double *lu, double norm, double *rcond,
                                mt_arena *scratch, mt_err *err)
{
    double *const work = mt_arena_f64(scratch, 4, (size_t)n);
    lapack_int *const iwork = mt_arena_alloc(scratch, (size_t)n, sizeof *iwork);
    MT_TRY(mt_arena_check(scratch, err));
    const lapack_int info =
        LAPACKE_dgecon_work(LAPACK_COL_MAJOR, '1', n, lu, n, norm, rcond, work, iwork);
    return info < 0 ? mt_lapack_bug("dgecon", info, err) : MT_OK;
}

static mt_status lu_solve(int n, double *a, int nrhs, double *b, double *rcond,
                          mt_arena *scratch, mt_err *err)
{
    lapack_int *const ipiv = mt_arena_alloc(scratch, (size_t)n, sizeof *ipiv);
    double *const unused = mt_arena_f64(scratch, (size_t)n, 1);
    MT_TRY(mt_arena_check(scratch, err));
    const double norm =
        rcond == NULL ? 0.0 : LAPACKE_dlange_work(LAPACK_COL_MAJOR, '1', n, n, a, n, unused);
    lapack_int info = LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, n, n, a, n, ipiv);
    if (info < 0) {
        return mt_lapack_bug("dgetrf", info, err);
    }
    if (info > 0) {
        return singular("LU", info, err);
    }
    if (rcond != NULL) {
        MT_TRY(estimate_rcond(n, a, norm, rcond, scratch, err));
    }
    info =
        nrhs == 0 ? 0 : LAPACKE_dgetrs_work(LAPACK_COL_MAJOR, 'N', n, nrhs, a, n, ipiv, b, n);
    return info < 0 ? mt_lapack_bug("dgetrs", info, err) : MT_OK;
}

mt_status mt_lu_solve(int n, double *a, int nrhs, double *b, double *rcond, mt_arena *scratch,
                      mt_err *err)
{
    if (rcond != NULL) {
        *rcond = n == 0 ? 1.0 : 0.0;
    }
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_all_finite((ptrdiff_t)n * n, a) || !mt_all_finite((ptrdiff_t)n * nrhs, b)) {
        return mt_lapack_not_finite("dgetrf", err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = lu_solve(n, a, nrhs, b, rcond, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

static mt_status lu_sign(int n, double *a, int *sign, mt_arena *scratch, mt_err *err)
{
    lapack_int *const ipiv = mt_arena_alloc(scratch, (size_t)n, sizeof *ipiv);
    MT_TRY(mt_arena_check(scratch, err));
    const lapack_int info = LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, n, n, a, n, ipiv);
    if (info < 0) {
        return mt_lapack_bug("dgetrf", info, err);
    }
    *sign = info > 0 ? 0 : 1;
    for (ptrdiff_t i = 0; i < n; i++) {
        const bool swapped = ipiv[i] != i + 1;
        *sign = swapped == (a[i + (i * n)] < 0.0) ? *sign : -*sign;
    }
    return MT_OK;
}

mt_status mt_lu_sign(int n, double *a, int *sign, mt_arena *scratch, mt_err *err)
{
    *sign = 1;
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_all_finite((ptrdiff_t)n * n, a)) {
        return mt_lapack_not_finite("dgetrf", err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = lu_sign(n, a, sign, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

/* Pivoted QR. */

static int lesser_of(int m, int n)
{
    return m < n ? m : n;
}

static void decide_rank(double tol, mt_qr *f)
{
    const int r = lesser_of(f->m, f->n);
    const double first = r > 0 ? fabs(f->qr[0]) : 0.0;
    f->rank = 0;
    f->kept = 1.0;
    f->dropped = 0.0;
    for (int i = 0; i < r && first > 0.0; i++) {
        const double ratio = fabs(f->qr[i + (ptrdiff_t)i * f->m]) / first;
        if (!(ratio > tol)) {
            f->dropped = ratio;
            return;
        }
        f->kept = ratio;
        f->rank = i + 1;
    }
}

static mt_status factor_pivoted(mt_qr *f, mt_arena *scratch, mt_err *err)
{
    lapack_int *const jpvt = mt_arena_alloc(scratch, (size_t)f->n, sizeof *jpvt);
    MT_TRY(mt_arena_check(scratch, err));
    double query = 0.0;
    lapack_int info = 0;
    if (lesser_of(f->m, f->n) > MT_LAPACK_UNBLOCKED) {
        info = LAPACKE_dgeqp3_work(LAPACK_COL_MAJOR, f->m, f->n, f->qr, f->m, jpvt, f->tau,
                                   &query, -1);
    }
    if (info != 0) {
        return mt_lapack_bug("dgeqp3", info, err);
    }
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, 3.0 * f->n + 1.0, &work, &lwork, err));
    info = LAPACKE_dgeqp3_work(LAPACK_COL_MAJOR, f->m, f->n, f->qr, f->m, jpvt, f->tau, work,
                               lwork);
    for (int j = 0; j < f->n; j++) {
        f->perm[j] = (int)jpvt[j] - 1;
    }
    return info != 0 ? mt_lapack_bug("dgeqp3", info, err) : MT_OK;
}

mt_status mt_qr_factor(int m, int n, const double *a, int lda, double tol, mt_arena *mem,
                       mt_qr *out, mt_err *err)
{
    *out = (mt_qr){.m = m, .n = n};
    out->perm = mt_arena_int(mem, (size_t)n);
    out->qr = mt_arena_f64(mem, (size_t)m, (size_t)n);
    out->tau = mt_arena_f64(mem, (size_t)lesser_of(m, n), 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int j = 0; j < n; j++) {
        out->perm[j] = j;
        if (m > 0) {
            memcpy(out->qr + (ptrdiff_t)j * m, a + (ptrdiff_t)j * lda,
                   (size_t)m * sizeof *out->qr);
        }
    }
    if (!mt_all_finite((ptrdiff_t)m * n, out->qr)) {
        return mt_lapack_not_finite("dgeqp3", err);
    }
    if (m > 0 && n > 0) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        const mt_status rc = factor_pivoted(out, mem, err);
        mt_arena_rewind(mem, mark);
        if (rc != MT_OK) {
            return rc;
        }
    }
    decide_rank(tol, out);
    return MT_OK;
}

/* Up to so many columns the reflectors are applied one by one: the blocked routine first
 * multiplies them together, which costs as much as some ten columns, and wants a workspace of
 * 33 kB. */
enum { FEW_COLUMNS = 8 };

/* x := H_1 ... H_k x, or H_k ... H_1 x, with H_i = 1 - tau_i v v^T, v = (0, ..., 0, 1, below
 * the diagonal of column i). */
static void reflect(const mt_qr *f, bool trans, double *x)
{
    const int k = lesser_of(f->m, f->n);
    for (int step = 0; step < k; step++) {
        const int i = trans ? step : k - 1 - step;
        const double *const v = f->qr + ((ptrdiff_t)i * f->m);
        double s = x[i];
        for (int j = i + 1; j < f->m; j++) {
            s += v[j] * x[j];
        }
        s *= f->tau[i];
        x[i] -= s;
        for (int j = i + 1; j < f->m; j++) {
            x[j] -= s * v[j];
        }
    }
}

static mt_status apply_q(const mt_qr *f, char trans, int nrhs, double *x, mt_arena *scratch,
                         mt_err *err)
{
    const int k = lesser_of(f->m, f->n);
    double query = 0.0;
    lapack_int info = LAPACKE_dormqr_work(LAPACK_COL_MAJOR, 'L', trans, f->m, nrhs, k, f->qr,
                                          f->m, f->tau, x, f->m, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("dormqr", info, err);
    }
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, nrhs, &work, &lwork, err));
    info = LAPACKE_dormqr_work(LAPACK_COL_MAJOR, 'L', trans, f->m, nrhs, k, f->qr, f->m, f->tau,
                               x, f->m, work, lwork);
    return info != 0 ? mt_lapack_bug("dormqr", info, err) : MT_OK;
}

mt_status mt_qr_apply_q(const mt_qr *f, bool trans, int nrhs, double *x, mt_arena *scratch,
                        mt_err *err)
{
    if (!mt_all_finite((ptrdiff_t)f->m * nrhs, x)) {
        return mt_lapack_not_finite("dormqr", err);
    }
    if (f->m == 0 || f->n == 0 || nrhs == 0) {
        return MT_OK;
    }
    if (nrhs <= FEW_COLUMNS) {
        for (int c = 0; c < nrhs; c++) {
            reflect(f, trans, x + ((ptrdiff_t)c * f->m));
        }
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = apply_q(f, trans ? 'T' : 'N', nrhs, x, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

mt_status mt_qr_q(const mt_qr *f, int from, double *q, mt_arena *scratch, mt_err *err)
{
    const int columns = f->m - from;
    for (int j = 0; j < columns; j++) {
        for (int i = 0; i < f->m; i++) {
            q[i + (ptrdiff_t)j * f->m] = i == from + j ? 1.0 : 0.0;
        }
    }
    return mt_qr_apply_q(f, false, columns, q, scratch, err);
}

/* x := R11^-1 x (back substitution) or, transposed, R11^-T x (forward), with the leading rank x
 * rank block. */
static void solve_r(const mt_qr *f, bool trans, double *x)
{
    const int r = f->rank;
    for (int step = 0; step < r; step++) {
        const int i = trans ? step : r - 1 - step;
        double sum = x[i];
        for (int j = trans ? 0 : i + 1; j < (trans ? i : r); j++) {
            sum -= f->qr[trans ? j + (ptrdiff_t)i * f->m : i + (ptrdiff_t)j * f->m] * x[j];
        }
        x[i] = sum / f->qr[i + (ptrdiff_t)i * f->m];
    }
}

mt_status mt_qr_solve(const mt_qr *f, int nrhs, const double *b, double *x, mt_arena *scratch,
                      mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const size_t entries = (size_t)f->m * (size_t)nrhs;
    double *const qtb = mt_arena_f64(scratch, (size_t)f->m, (size_t)nrhs);
    mt_status rc = mt_arena_check(scratch, err);
    if (rc == MT_OK && entries > 0) {
        memcpy(qtb, b, entries * sizeof *qtb);
        rc = mt_qr_apply_q(f, true, nrhs, qtb, scratch, err);
    }
    for (int k = 0; k < nrhs && rc == MT_OK; k++) {
        double *const z = qtb + (ptrdiff_t)k * f->m;
        double *const xk = x + (ptrdiff_t)k * f->n;
        solve_r(f, false, z);
        for (int j = 0; j < f->n; j++) {
            xk[f->perm[j]] = j < f->rank ? z[j] : 0.0;
        }
    }
    mt_arena_rewind(scratch, mark);
    return rc;
}

mt_status mt_qr_solve_transposed(const mt_qr *f, int nrhs, const double *c, double *y,
                                 mt_arena *scratch, mt_err *err)
{
    for (int k = 0; k < nrhs; k++) {
        double *const yk = y + (ptrdiff_t)k * f->m;
        for (int i = 0; i < f->m; i++) {
            yk[i] = i < f->rank ? c[f->perm[i] + (ptrdiff_t)k * f->n] : 0.0;
        }
        solve_r(f, true, yk);
    }
    return mt_qr_apply_q(f, false, nrhs, y, scratch, err);
}

/* Singular values. */

typedef struct svd_job {
    int m;
    int n;
    int r; /* min(m, n) */
    bool vectors;
    double *a;
    double *s;
    double *u;  /* m x r, where vectors */
    double *vt; /* r x n, where vectors */
} svd_job;

static lapack_int gesdd(const svd_job *j, double *work, lapack_int lwork, lapack_int *iwork)
{
    return LAPACKE_dgesdd_work(LAPACK_COL_MAJOR, j->vectors ? 'S' : 'N', j->m, j->n, j->a, j->m,
                               j->s, j->u, j->m, j->vt, j->r, work, lwork, iwork);
}

static lapack_int gesvd(const svd_job *j, double *work, lapack_int lwork)
{
    const char job = j->vectors ? 'S' : 'N';
    return LAPACKE_dgesvd_work(LAPACK_COL_MAJOR, job, job, j->m, j->n, j->a, j->m, j->s, j->u,
                               j->m, j->vt, j->r, work, lwork);
}

/* One work array that serves both routines. */
static mt_status svd_work(const svd_job *j, mt_arena *scratch, double **work, lapack_int *lwork,
                          mt_err *err)
{
    double query[2] = {0.0, 0.0};
    lapack_int none = 0;
    const lapack_int info = gesdd(j, &query[0], -1, &none);
    const lapack_int info2 = gesvd(j, &query[1], -1);
    if (info != 0 || info2 != 0) {
        return mt_lapack_bug(info != 0 ? "dgesdd" : "dgesvd", info != 0 ? info : info2, err);
    }
    /* documented minima: dgesdd 4 r^2 + 7 r ('S') or 3 r + max(m, n, 7 r) ('N'), dgesvd max(3 r
     * + max(m, n), 5 r) */
    const double r = j->r;
    const double most = j->m > j->n ? j->m : j->n;
    const double least = 4.0 * r * r + 10.0 * r + most;
    return mt_lapack_work(scratch, query[0] > query[1] ? query[0] : query[1], least, work,
                          lwork, err);
}

static mt_status svd(svd_job *j, mt_arena *scratch, mt_err *err)
{
    const size_t m = (size_t)j->m;
    const size_t n = (size_t)j->n;
    const size_t r = (size_t)j->r;
    if (j->vectors && j->u == NULL) {
        j->u = mt_arena_f64(scratch, m, r);
    }
    if (j->vectors && j->vt == NULL) {
        j->vt = mt_arena_f64(scratch, r, n);
    }
    /* dgesdd destroys A even where it fails */
    double *const copy = mt_arena_f64(scratch, m, n);
    lapack_int *const iwork = mt_arena_alloc(scratch, 8 * r, sizeof *iwork);
    MT_TRY(mt_arena_check(scratch, err));
    memcpy(copy, j->a, m * n * sizeof *copy);
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(svd_work(j, scratch, &work, &lwork, err));
    lapack_int info = gesdd(j, work, lwork, iwork);
    if (info > 0) {
        memcpy(j->a, copy, m * n * sizeof *copy);
        info = gesvd(j, work, lwork);
    }
    if (info < 0) {
        return mt_lapack_bug("dgesdd/dgesvd", info, err);
    }
    if (info > 0 || !mt_all_finite(j->r, j->s)) {
        return mt_fail(err, MT_E_NO_CONVERGENCE, "the singular values did not converge");
    }
    return MT_OK;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): LAPACK writes through them */
mt_status mt_svd(int m, int n, double *a, double *s, double *u, double *vt, mt_arena *scratch,
                 mt_err *err)
{
    svd_job j = {.m = m, .n = n, .r = m < n ? m : n, .a = a, .s = s, .u = u, .vt = vt};
    j.vectors = u != NULL || vt != NULL;
    if (j.r == 0) {
        return MT_OK;
    }
    if (!mt_all_finite((ptrdiff_t)m * n, a)) {
        return mt_lapack_not_finite("dgesdd", err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = svd(&j, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

/* dgejsv: A as D1 C D2 with row pivoting ('F'), no left vectors ('N'), right ones ('V'), tiny
 * columns kept ('N'), no transposition ('N'), no perturbation ('N'). */
static mt_status jacobi(int m, int n, double *a, double *s, double *v, mt_arena *scratch,
                        mt_err *err)
{
    enum { BLOCK = 64 }; /* room for the blocked QR inside; dgejsv has no workspace query */
    const double order = n;
    const double least = 2.0 * m + 2.0 * order * order + (6.0 + BLOCK) * order + 7.0;
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, 0.0, least, &work, &lwork, err));
    lapack_int *const iwork =
        mt_arena_alloc(scratch, (size_t)m + 3 * (size_t)n + 1, sizeof *iwork);
    MT_TRY(mt_arena_check(scratch, err));
    double none = 0.0;
    const lapack_int info =
        LAPACKE_dgejsv_work(LAPACK_COL_MAJOR, 'F', 'N', v == NULL ? 'N' : 'V', 'N', 'N', 'N', m,
                            n, a, m, s, &none, m, v == NULL ? &none : v, n, work, lwork, iwork);
    if (info < 0 || work == NULL) {
        return mt_lapack_bug("dgejsv", info, err);
    }
    /* guards over- and underflow: values are scale * s */
    const double scale = work[0] / work[1];
    for (int i = 0; i < n; i++) {
        s[i] *= scale;
    }
    if (info > 0 || !mt_all_finite(n, s)) {
        return mt_fail(err, MT_E_NO_CONVERGENCE,
                       "dgejsv: the singular values did not converge");
    }
    return MT_OK;
}

mt_status mt_svd_jacobi(int m, int n, double *a, double *s, double *v, mt_arena *scratch,
                        mt_err *err)
{
    if (n == 0) {
        return MT_OK;
    }
    if (m < n) {
        return mt_fail(err, MT_E_INTERNAL, "mt_svd_jacobi: %d rows for %d columns", m, n);
    }
    if (!mt_all_finite((ptrdiff_t)m * n, a)) {
        return mt_lapack_not_finite("dgejsv", err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = jacobi(m, n, a, s, v, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

static mt_status pinv_of(int m, int n, const double *a, double tol, double *pinv, int *rank,
                         mt_arena *scratch, mt_err *err)
{
    const int r = m < n ? m : n;
    double *const copy = mt_arena_f64(scratch, (size_t)m, (size_t)n);
    double *const s = mt_arena_f64(scratch, (size_t)r, 1);
    double *const u = mt_arena_f64(scratch, (size_t)m, (size_t)r);
    double *const vt = mt_arena_f64(scratch, (size_t)r, (size_t)n);
    MT_TRY(mt_arena_check(scratch, err));
    memcpy(copy, a, (size_t)m * (size_t)n * sizeof *copy);
    MT_TRY(mt_svd(m, n, copy, s, u, vt, scratch, err));
    int kept = 0;
    while (kept < r && s[kept] > tol * s[0]) {
        for (int i = 0; i < m; i++) {
            u[i + (ptrdiff_t)kept * m] /= s[kept];
        }
        kept++;
    }
    mt_gemm(true, true, n, m, kept, 1.0, vt, r, u, m, 0.0, pinv, n);
    *rank = kept;
    return MT_OK;
}

mt_status mt_pinv(int m, int n, const double *a, double tol, double *pinv, int *rank,
                  mt_arena *scratch, mt_err *err)
{
    int kept = 0;
    mt_status rc = MT_OK;
    if (m > 0 && n > 0) {
        const mt_arena_mark mark = mt_arena_get_mark(scratch);
        rc = pinv_of(m, n, a, tol, pinv, &kept, scratch, err);
        mt_arena_rewind(scratch, mark);
    }
    if (rank != NULL) {
        *rank = kept;
    }
    return rc;
}

/* Eigenvalues of small symmetric matrices by eig_small.c, others by LAPACK. dsyevd and not
 * dsyevr: the latter loses orthogonality on clusters in the LAPACK that we build on. */

static mt_status eig_sym(int n, double *a, double *w, char job, mt_arena *scratch, mt_err *err)
{
    double query = 0.0;
    lapack_int iquery = 0;
    lapack_int info = 0;
    if (n > MT_LAPACK_UNBLOCKED) {
        info = LAPACKE_dsyevd_work(LAPACK_COL_MAJOR, job, 'L', n, a, n, w, &query, -1, &iquery,
                                   -1);
    }
    if (info != 0) {
        return mt_lapack_bug("dsyevd", info, err);
    }
    /* documented minima: 1 + 6 n + 2 n^2 and 3 + 5 n with vectors, 2 n + 1 and 1 without */
    const double size = n;
    const double least = job == 'V' ? 1.0 + 6.0 * size + 2.0 * size * size : 2.0 * size + 1.0;
    const int ileast = n > (INT_MAX - 3) / 5 ? INT_MAX : 3 + 5 * n;
    const int liwork = iquery > ileast ? (int)iquery : ileast;
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, least, &work, &lwork, err));
    int *const iwork = mt_arena_int(scratch, (size_t)liwork);
    MT_TRY(mt_arena_check(scratch, err));
    info =
        LAPACKE_dsyevd_work(LAPACK_COL_MAJOR, job, 'L', n, a, n, w, work, lwork, iwork, liwork);
    if (info < 0) {
        return mt_lapack_bug("dsyevd", info, err);
    }
    if (info > 0 ||
        !mt_all_finite(n, w)) { /* entries near overflow may leave NaN and info = 0 */
        return mt_fail(err, MT_E_NO_CONVERGENCE, "dsyevd: the eigenvalues did not converge");
    }
    return MT_OK;
}

/* Far from these, squares of entries leave the range of numbers. */
static const double LEAST_SIZE = 1e-100;
static const double MOST_SIZE = 1e100;

/* a *= the power of 2 that makes its size 1, unless its size is a moderate one. */
static double scale_lower(int n, double *a)
{
    double size = 0.0;
    for (ptrdiff_t j = 0; j < n; j++) {
        size = fmax(size, mt_max_abs(n - j, a + j + (j * n)));
    }
    if (size == 0.0 || (size >= LEAST_SIZE && size <= MOST_SIZE)) {
        return 1.0;
    }
    const int least = DBL_MIN_EXP; /* of a subnormal size the inverse may have no number */
    const double scale = ldexp(1.0, -(ilogb(size) > least ? ilogb(size) : least));
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = j; i < n; i++) {
            a[i + (j * n)] *= scale;
        }
    }
    return scale;
}

static mt_status eig_small(int n, double *a, double *w, bool vectors, mt_err *err)
{
    const double scale = scale_lower(n, a);
    const bool converged = mt_eig_small(n, a, w, vectors);
    for (int i = 0; i < n; i++) {
        w[i] /= scale;
    }
    return converged && mt_all_finite(n, w)
               ? MT_OK
               : mt_fail(err, MT_E_NO_CONVERGENCE, "QL: the eigenvalues did not converge");
}

mt_status mt_eig_sym(int n, double *a, double *w, bool vectors, mt_arena *scratch, mt_err *err)
{
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_lower_finite(n, a)) {
        return mt_lapack_not_finite("dsyevd", err);
    }
    if (n <= MT_EIG_SMALL) {
        return eig_small(n, a, w, vectors, err);
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = eig_sym(n, a, w, vectors ? 'V' : 'N', scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

static mt_status eig_sym_values(const mt_tridiagonal *t, double *w, mt_arena *scratch,
                                mt_err *err)
{
    const int n = t->n;
    double query = 0.0;
    lapack_int info =
        LAPACKE_dsytrd_work(LAPACK_COL_MAJOR, 'L', n, t->a, n, t->d, t->e, t->tau, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("dsytrd", info, err);
    }
    double *const beside = mt_arena_f64(scratch, (size_t)n, 1);
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, (double)n, &work, &lwork, err));
    info =
        LAPACKE_dsytrd_work(LAPACK_COL_MAJOR, 'L', n, t->a, n, t->d, t->e, t->tau, work, lwork);
    if (info != 0) {
        return mt_lapack_bug("dsytrd", info, err);
    }
    memcpy(w, t->d, (size_t)n * sizeof *w);
    memcpy(beside, t->e, (size_t)n * sizeof *beside);
    info = LAPACKE_dsterf_work(n, w, beside);
    if (info < 0) {
        return mt_lapack_bug("dsterf", info, err);
    }
    for (int i = 0; i < n; i++) {
        w[i] /= t->scale;
    }
    return info > 0 || !mt_all_finite(n, w)
               ? mt_fail(err, MT_E_NO_CONVERGENCE, "dsterf: the eigenvalues did not converge")
               : MT_OK;
}

mt_status mt_eig_sym_values(int n, double *a, double *w, mt_arena *mem, mt_tridiagonal *out,
                            mt_err *err)
{
    const size_t size = (size_t)n;
    *out = (mt_tridiagonal){.n = n, .scale = 1.0, .a = a};
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_lower_finite(n, a)) {
        return mt_lapack_not_finite("dsytrd", err);
    }
    out->scale = scale_lower(n, a);
    out->tau = mt_arena_f64(mem, size, 1);
    out->d = mt_arena_f64(mem, size, 1);
    out->e = mt_arena_f64(mem, size, 1);
    MT_TRY(mt_arena_check(mem, err));
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = eig_sym_values(out, w, mem, err);
    mt_arena_rewind(mem, mark);
    return rc;
}

/* dstein orthogonalises vectors whose eigenvalues differ by less than a thousandth of the norm
 * of T; other pairs are orthogonal to eps times the norm over their distance, up to a thousand
 * eps. The correction changes the residual by its size times the distance: by eps times the
 * norm. */
static void make_orthogonal(int n, int count, double *z)
{
    for (ptrdiff_t i = 0; i < count; i++) {
        double *const own = z + (i * n);
        for (ptrdiff_t j = 0; j < i; j++) {
            mt_axpy(n, -mt_dot(n, z + (j * n), own), z + (j * n), own);
        }
        const double norm = mt_norm2(n, own);
        for (ptrdiff_t k = 0; k < n; k++) {
            own[k] /= norm;
        }
    }
}

static mt_status eig_sym_lowest(const mt_tridiagonal *t, int count, const double *w, double *z,
                                mt_arena *scratch, mt_err *err)
{
    const int n = t->n;
    const size_t size = (size_t)n;
    double query = 0.0;
    lapack_int info = LAPACKE_dormtr_work(LAPACK_COL_MAJOR, 'L', 'L', 'N', n, count, t->a, n,
                                          t->tau, z, n, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("dormtr", info, err);
    }
    double *const scaled = mt_arena_f64(scratch, (size_t)count, 1);
    int *const block = mt_arena_int(scratch, size);
    int *const end = mt_arena_int(scratch, size);
    int *const iwork = mt_arena_int(scratch, size);
    int *const failed = mt_arena_int(scratch, (size_t)count);
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, 5.0 * n, &work, &lwork, err));
    MT_TRY(mt_arena_check(scratch, err));
    for (int i = 0; i < n; i++) {
        block[i] = 1; /* all of T is one */
    }
    for (int i = 0; i < count; i++) {
        scaled[i] = w[i] * t->scale;
    }
    end[0] = n;
    info = LAPACKE_dstein_work(LAPACK_COL_MAJOR, n, t->d, t->e, count, scaled, block, end, z, n,
                               work, iwork, failed);
    if (info < 0) {
        return mt_lapack_bug("dstein", info, err);
    }
    if (info > 0) {
        return mt_fail(err, MT_E_NO_CONVERGENCE, "dstein: %d vectors did not converge", info);
    }
    make_orthogonal(n, count, z);
    info = LAPACKE_dormtr_work(LAPACK_COL_MAJOR, 'L', 'L', 'N', n, count, t->a, n, t->tau, z, n,
                               work, lwork);
    return info == 0 ? MT_OK : mt_lapack_bug("dormtr", info, err);
}

mt_status mt_eig_sym_lowest(const mt_tridiagonal *t, int count, const double *w, double *z,
                            mt_arena *scratch, mt_err *err)
{
    if (count == 0) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = eig_sym_lowest(t, count, w, z, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

typedef struct general {
    int n;
    double *a;
    double *wr;
    double *wi;
    double *vr; /* or NULL */
} general;

static lapack_int geev(const general *g, double *work, lapack_int lwork)
{
    double none = 0.0;
    return LAPACKE_dgeev_work(LAPACK_COL_MAJOR, 'N', g->vr == NULL ? 'N' : 'V', g->n, g->a,
                              g->n, g->wr, g->wi, &none, 1, g->vr == NULL ? &none : g->vr,
                              g->vr == NULL ? 1 : g->n, work, lwork);
}

static mt_status eig_general(const general *g, mt_arena *scratch, mt_err *err)
{
    double query = 0.0;
    lapack_int info = geev(g, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("dgeev", info, err);
    }
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, 4.0 * g->n, &work, &lwork, err));
    info = geev(g, work, lwork);
    if (info < 0) {
        return mt_lapack_bug("dgeev", info, err);
    }
    if (info > 0 || !mt_all_finite(g->n, g->wr) || !mt_all_finite(g->n, g->wi)) {
        return mt_fail(err, MT_E_NO_CONVERGENCE, "dgeev: the eigenvalues did not converge");
    }
    return MT_OK;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): LAPACK writes through them */
mt_status mt_eig_general(int n, double *a, double *wr, double *wi, double *vr,
                         mt_arena *scratch, mt_err *err)
{
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_all_finite((ptrdiff_t)n * n, a)) {
        return mt_lapack_not_finite("dgeev", err);
    }
    const general g = {.n = n, .a = a, .wr = wr, .wi = wi, .vr = vr};
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = eig_general(&g, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

typedef struct complex_general {
    int n;
    double complex *a;
    double complex *w;
    double complex *vr; /* or NULL */
    double *rwork;      /* [2 n] */
} complex_general;

static lapack_int zgeev(const complex_general *g, double complex *work, lapack_int lwork)
{
    double complex none = 0.0;
    return LAPACKE_zgeev_work(LAPACK_COL_MAJOR, 'N', g->vr == NULL ? 'N' : 'V', g->n, g->a,
                              g->n, g->w, &none, 1, g->vr == NULL ? &none : g->vr,
                              g->vr == NULL ? 1 : g->n, work, lwork, g->rwork);
}

static mt_status eig_complex(complex_general *g, mt_arena *scratch, mt_err *err)
{
    double complex query = 0.0;
    g->rwork = mt_arena_f64(scratch, 2, (size_t)g->n);
    MT_TRY(mt_arena_check(scratch, err));
    lapack_int info = zgeev(g, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("zgeev", info, err);
    }
    double *work = NULL; /* of pairs of doubles */
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, 2.0 * creal(query), 4.0 * g->n, &work, &lwork, err));
    info = zgeev(g, (double complex *)work, lwork / 2);
    if (info < 0) {
        return mt_lapack_bug("zgeev", info, err);
    }
    if (info > 0 || !mt_all_finite(2 * (ptrdiff_t)g->n, (const double *)g->w)) {
        return mt_fail(err, MT_E_NO_CONVERGENCE, "zgeev: the eigenvalues did not converge");
    }
    return MT_OK;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): LAPACK writes through them */
mt_status mt_eig_complex(int n, double complex *a, double complex *w, double complex *vr,
                         mt_arena *scratch, mt_err *err)
{
    if (n == 0) {
        return MT_OK;
    }
    if (!mt_all_finite(2 * (ptrdiff_t)n * n, (const double *)a)) {
        return mt_lapack_not_finite("zgeev", err);
    }
    complex_general g = {.n = n, .a = a, .w = w, .vr = vr};
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = eig_complex(&g, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

/* Eigenvalues of graded matrices. */

static mt_status graded(int n, double *a, double *w, mt_arena *scratch, mt_err *err)
{
    double *const factor = mt_arena_f64(scratch, (size_t)n, (size_t)n); /* zero */
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_cholesky(n, a, NULL, err));
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = j; i < n; i++) {
            factor[j + (i * n)] = a[i + (j * n)]; /* L^T: its right vectors are those of A */
        }
    }
    MT_TRY(mt_svd_jacobi(n, n, factor, w, a, scratch, err));
    for (int i = 0; i < n; i++) {
        w[i] *= w[i];
    }
    return MT_OK;
}

mt_status mt_eig_graded(int n, double *a, double *w, mt_arena *scratch, mt_err *err)
{
    if (n == 0) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = graded(n, a, w, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

/*
 * Sylvester: P^T S (A - shift B) S P = L D L^T keeps the numbers of negative, zero and positive
 * eigenvalues, and D has blocks of order one and two only. S = diag(2^-e), e chosen such that
 * |a_ii| + |shift b_ii| becomes about one: the pivots of D then say how much is left after
 * cancellation, whatever the units of the rows are; powers of two change no digit.
 */

/* c := scaled A - shift B, lower triangle. exponent[n] is scratch. */
static void shifted(int n, const double *a, const double *b, double shift, double *c,
                    int *exponent)
{
    for (int i = 0; i < n; i++) {
        const ptrdiff_t ii = i + (ptrdiff_t)i * n;
        const double size = fabs(a[ii]) + fabs(shift) * (b == NULL ? 1.0 : fabs(b[ii]));
        int e = 0;
        if (size > 0.0 && isfinite(size)) {
            (void)frexp(size, &e);
        }
        exponent[i] = e / 2;
    }
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            const ptrdiff_t ij = i + (ptrdiff_t)j * n;
            const double unit = i == j ? 1.0 : 0.0;
            const double entry = a[ij] - shift * (b == NULL ? unit : b[ij]);
            c[ij] = ldexp(entry, -exponent[i] - exponent[j]);
        }
    }
}

/* Eigenvalues of [p q; q r]: the large one by the formula without cancellation, the small one
 * from the determinant. */
static void eig2(double p, double q, double r, double e[2])
{
    const double mean = 0.5 * (p + r);
    const double radius = hypot(0.5 * (p - r), q);
    e[0] = mean >= 0.0 ? mean + radius : mean - radius;
    e[1] = e[0] == 0.0 ? 0.0 : (p / e[0]) * r - (q / e[0]) * q;
}

typedef struct tally {
    int count[3];
    double least;
    double most;
} tally;

static void count_eigenvalue(tally *t, double e)
{
    t->count[e < 0.0 ? 0 : (e > 0.0 ? 2 : 1)]++;
    t->least = fmin(t->least, fabs(e));
    t->most = fmax(t->most, fabs(e));
}

static mt_status factor_symmetric(int n, double *c, lapack_int *ipiv, mt_arena *scratch,
                                  mt_err *err)
{
    double query = 0.0;
    lapack_int info = LAPACKE_dsytrf_work(LAPACK_COL_MAJOR, 'L', n, c, n, ipiv, &query, -1);
    if (info != 0) {
        return mt_lapack_bug("dsytrf", info, err);
    }
    double *work = NULL;
    lapack_int lwork = 0;
    MT_TRY(mt_lapack_work(scratch, query, n, &work, &lwork, err));
    info = LAPACKE_dsytrf_work(LAPACK_COL_MAJOR, 'L', n, c, n, ipiv, work, lwork);
    /* > 0: a zero pivot is counted */
    return info < 0 ? mt_lapack_bug("dsytrf", info, err) : MT_OK;
}

static tally count_blocks(int n, const double *c, const lapack_int *ipiv)
{
    tally t = {.least = HUGE_VAL};
    for (int i = 0; i < n; i++) {
        const double *const d = c + i + (ptrdiff_t)i * n;
        if (ipiv[i] > 0 || i + 1 == n) {
            count_eigenvalue(&t, d[0]);
            continue;
        }
        double e[2];
        eig2(d[0], d[1], d[n + 1], e);
        count_eigenvalue(&t, e[0]);
        count_eigenvalue(&t, e[1]);
        i++;
    }
    return t;
}

static mt_status inertia(int n, const double *a, const double *b, double shift, tally *t,
                         mt_arena *scratch, mt_err *err)
{
    double *const c = mt_arena_f64(scratch, (size_t)n, (size_t)n);
    int *const exponent = mt_arena_int(scratch, (size_t)n);
    lapack_int *const ipiv = mt_arena_alloc(scratch, (size_t)n, sizeof *ipiv);
    MT_TRY(mt_arena_check(scratch, err));
    shifted(n, a, b, shift, c, exponent);
    if (!mt_lower_finite(n, c)) {
        return mt_lapack_not_finite("dsytrf", err);
    }
    MT_TRY(factor_symmetric(n, c, ipiv, scratch, err));
    *t = count_blocks(n, c, ipiv);
    return MT_OK;
}

mt_status mt_inertia(int n, const double *a, const double *b, double shift, int count[3],
                     double *gap, mt_arena *scratch, mt_err *err)
{
    tally t = {.least = HUGE_VAL};
    mt_status rc = MT_OK;
    if (n > 0) {
        const mt_arena_mark mark = mt_arena_get_mark(scratch);
        rc = inertia(n, a, b, shift, &t, scratch, err);
        mt_arena_rewind(scratch, mark);
    }
    for (int i = 0; i < 3; i++) {
        count[i] = rc == MT_OK ? t.count[i] : 0;
    }
    if (gap != NULL) {
        const double zero = n > 0 ? 0.0 : 1.0;
        *gap = rc == MT_OK && t.most > 0.0 ? t.least / t.most : zero;
    }
    return rc;
}
