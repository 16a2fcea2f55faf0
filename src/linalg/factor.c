/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Left-looking, supernode by supernode: columns J of L are H(:, J) less
 *     sum over earlier supernodes K with rows in J of  L(:, K) D_K L(J, K)^T,
 * each one product of dense blocks, scattered into place; then the block J itself is factored,
 * L_JJ D_J L_JJ^T, and the rows below it divided by it. A supernode that has been used waits in
 * the list of the next one that its rows reach.
 */
#include "linalg/factor_priv.h"

#include <cblas.h>

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/kernels.h"

/* Columns of a block that are factored together: products of a few dozen columns run as fast as
 * larger ones, and waste little above the diagonal. */
enum { PANEL = 48 };
/* The same where several columns are solved for. */
enum { TRIANGLE = 32 };

void mt_factor_init(const mt_factor_pattern *p, int columns, mt_arena *mem, mt_factor *f)
{
    *f = (mt_factor){.pattern = p, .columns = columns};
    f->l = mt_arena_f64(mem, (size_t)p->at[p->n_super], 1);
    f->d = mt_arena_f64(mem, (size_t)p->n, 1);
    f->work = mt_arena_f64(mem, p->most_rows + (size_t)p->n, (size_t)columns);
}

/* What a factorisation works with. */
typedef struct making {
    const mt_factor_pattern *p;
    mt_factor *f;
    int *place;    /* [n] of a row in the block that is made */
    int *waiting;  /* [n_super] first supernode that waits for it; -1 */
    int *next;     /* [n_super] that waits for the same */
    int *used;     /* [n_super] rows of it that are behind */
    int *target;   /* [most_rows] place of each row that is subtracted */
    double *right; /* most_columns x PANEL: D_K L(J, K)^T */
    double *sum;   /* most_rows x PANEL */
    double *size;  /* [n] of what each pivot is the rest of */
} making;

static void wait_for(const making *m, int k)
{
    const mt_factor_pattern *const p = m->p;
    const int row = p->row_at[k] + m->used[k];
    if (row < p->row_at[k + 1]) {
        const int s = p->super_of[p->row[row]];
        m->next[k] = m->waiting[s];
        m->waiting[s] = k;
    }
}

/* Add c times the entries of h to the blocks; entry (i, j) is stored in the column that is
 * first in the order of P. */
static void scatter(const mt_factor_pattern *p, double c, const mt_lower *h, double *l)
{
    for (int j = 0; j < h->n; j++) {
        for (int k = h->start[j]; k < h->start[j + 1]; k++) {
            const int a = p->to[h->row[k]];
            const int b = p->to[j];
            const int column = a < b ? a : b;
            const int row = a < b ? b : a;
            const int s = p->super_of[column];
            const int *const rows = p->row + p->row_at[s];
            int low = row < p->first[s + 1] ? row - p->first[s] : 0;
            int high = p->row_at[s + 1] - p->row_at[s] - 1;
            while (low < high && rows[low] != row) { /* by halves: rows ascend */
                const int middle = low + ((high - low) / 2);
                if (rows[middle] < row) {
                    low = middle + 1;
                } else {
                    high = middle;
                }
            }
            const ptrdiff_t ld = p->row_at[s + 1] - p->row_at[s];
            l[p->at[s] + low + ((column - p->first[s]) * ld)] += c * h->value[k];
        }
    }
}

/* to[columns x inner, transposed] := D L^T of rows of a block. */
static void weigh_rows(int columns, int inner, const double *d, const double *l, ptrdiff_t ld,
                       double *to)
{
    for (int c = 0; c < inner; c++) {
        for (int j = 0; j < columns; j++) {
            to[c + ((ptrdiff_t)j * inner)] = d[c] * l[j + (c * ld)];
        }
    }
}

/* Subtract from block s the contribution of supernode k: the lower triangle, panel by panel of
 * columns. */
static void subtract(const making *m, int s, int k)
{
    const mt_factor_pattern *const p = m->p;
    const int *const rows = p->row + p->row_at[k] + m->used[k];
    const int n_rows = p->row_at[k + 1] - p->row_at[k] - m->used[k];
    const int ld = p->row_at[k + 1] - p->row_at[k];
    const int inner = p->first[k + 1] - p->first[k];
    const double *const l = m->f->l + p->at[k] + m->used[k];
    double *const out = m->f->l + p->at[s];
    const ptrdiff_t ld_out = p->row_at[s + 1] - p->row_at[s];
    int columns = 0;
    while (columns < n_rows && rows[columns] < p->first[s + 1]) {
        columns++;
    }
    for (int i = 0; i < n_rows; i++) {
        m->target[i] = m->place[rows[i]];
    }
    for (int first = 0; first < columns; first += PANEL) {
        const int here = first + PANEL < columns ? PANEL : columns - first;
        const int below = n_rows - first;
        weigh_rows(here, inner, m->f->d + p->first[k], l + first, ld, m->right);
        mt_gemm(false, false, below, here, inner, 1.0, l + first, ld, m->right, inner, 0.0,
                m->sum, below);
        for (int j = 0; j < here; j++) {
            double *const to = out + (m->target[first + j] * ld_out);
            const double *const from = m->sum + ((ptrdiff_t)j * below);
            for (int i = j; i < below; i++) {
                to[m->target[first + i]] -= from[i];
            }
        }
    }
    m->used[k] += columns;
}

/* L D L^T of the n rows and columns of a panel's own; false: a pivot is 0 or not finite. */
static bool eliminate_square(int n, double *l, ptrdiff_t ld, double *d)
{
    for (int j = 0; j < n; j++) {
        double *const column = l + (j * ld);
        for (int k = 0; k < j; k++) {
            const double *const before = l + (k * ld);
            const double c = before[j] * d[k];
            for (int i = j; i < n && c != 0.0; i++) {
                column[i] -= c * before[i];
            }
        }
        d[j] = column[j];
        if (d[j] == 0.0 || !isfinite(d[j])) {
            return false;
        }
        column[j] = 1.0;
        for (int i = j + 1; i < n; i++) {
            column[i] /= d[j];
        }
    }
    return true;
}

/* For each panel: subtract the contributions of the earlier columns of the block, factor its
 * square, then compute the rows below, B := B L^-T D^-1. */
static bool eliminate_supernode(const making *m, int s)
{
    const mt_factor_pattern *const p = m->p;
    const int ld = p->row_at[s + 1] - p->row_at[s];
    const int n = p->first[s + 1] - p->first[s];
    double *const l = m->f->l + p->at[s];
    double *const d = m->f->d + p->first[s];
    for (int first = 0; first < n; first += PANEL) {
        const int here = first + PANEL < n ? PANEL : n - first;
        const int below = ld - first - here;
        double *const own = l + first + ((ptrdiff_t)first * ld);
        double *const rest = own + here;
        weigh_rows(here, first, d, l + first, ld, m->right);
        mt_gemm(false, false, ld - first, here, first, -1.0, l + first, ld, m->right, first,
                1.0, own, ld);
        if (!eliminate_square(here, own, ld, d + first)) {
            return false;
        }
        if (below > 0) {
            cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasUnit, below,
                        here, 1.0, own, ld, rest, ld);
        }
        for (int j = 0; j < here; j++) {
            for (int i = 0; i < below; i++) {
                rest[i + ((ptrdiff_t)j * ld)] /= d[first + j];
            }
        }
    }
    return true;
}

/* For each pivot |d_i| + sum |l_ik|^2 |d_k|: the sum of the magnitudes of its terms. */
static void sum_pivot_terms(const making *m)
{
    const mt_factor_pattern *const p = m->p;
    mt_factor *const f = m->f;
    for (int s = 0; s < p->n_super; s++) {
        const int *const rows = p->row + p->row_at[s];
        const ptrdiff_t ld = p->row_at[s + 1] - p->row_at[s];
        for (int j = p->first[s]; j < p->first[s + 1]; j++) {
            const double *const column = f->l + p->at[s] + ((j - p->first[s]) * ld);
            const double d = fabs(f->d[j]);
            for (ptrdiff_t i = j - p->first[s]; i < ld; i++) {
                m->size[rows[i]] += column[i] * column[i] * d;
            }
        }
    }
    f->negative = 0;
    f->least = 1.0;
    for (int i = 0; i < p->n; i++) {
        f->negative += f->d[i] < 0.0 ? 1 : 0;
        f->least = fmin(f->least, fabs(f->d[i]) / m->size[i]);
    }
}

mt_status mt_factor_make(mt_factor *f, const mt_lower *h, double c, const mt_lower *other,
                         mt_arena *mem, mt_err *err)
{
    const mt_factor_pattern *const p = f->pattern;
    const size_t n = (size_t)p->n;
    const size_t ns = (size_t)p->n_super;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    making m = {.p = p, .f = f};
    m.place = mt_arena_int(mem, n);
    m.waiting = mt_arena_int(mem, ns);
    m.next = mt_arena_int(mem, ns);
    m.used = mt_arena_int(mem, ns);
    m.target = mt_arena_int(mem, p->most_rows);
    m.right = mt_arena_f64(mem, p->most_columns, PANEL);
    m.sum = mt_arena_f64(mem, p->most_rows, PANEL);
    m.size = mt_arena_f64(mem, n, 1);
    MT_TRY(mt_arena_check(mem, err));
    memset(f->l, 0, (size_t)p->at[ns] * sizeof *f->l);
    memset(m.waiting, 0xFF, ns * sizeof *m.waiting); /* -1 */
    scatter(p, 1.0, h, f->l);
    if (other != NULL) {
        scatter(p, c, other, f->l);
    }
    bool regular = true;
    for (int s = 0; s < p->n_super && regular; s++) {
        for (int i = p->row_at[s]; i < p->row_at[s + 1]; i++) {
            m.place[p->row[i]] = i - p->row_at[s];
        }
        for (int k = m.waiting[s]; k >= 0;) {
            const int next = m.next[k];
            subtract(&m, s, k);
            wait_for(&m, k);
            k = next;
        }
        regular = eliminate_supernode(&m, s);
        m.used[s] = p->first[s + 1] - p->first[s];
        wait_for(&m, s);
    }
    if (regular) {
        sum_pivot_terms(&m);
    }
    mt_arena_rewind(mem, mark);
    return regular ? MT_OK : mt_fail(err, MT_E_DOMAIN, "a pivot is 0 or not finite");
}

/* C := A op B + beta C with A rows x columns, count columns of the others; by itself one is
 * read faster as a vector. */
/* NOLINTNEXTLINE(readability-function-size): the argument list is BLAS's */
static void multiply_columns(bool trans, int rows, int columns, double alpha, const double *a,
                             int ld, int count, const double *b, int ldb, double beta,
                             double *c, int ldc)
{
    if (count == 1) {
        mt_gemv(trans, rows, columns, alpha, a, ld, b, beta, c);
    } else {
        mt_gemm(trans, false, trans ? columns : rows, count, trans ? rows : columns, alpha, a,
                ld, b, ldb, beta, c, ldc);
    }
}

/* x := T^-1 x or T^-T x of the n rows and columns of a small unit lower triangle. */
static void turn_triangle(bool trans, int n, const double *l, ptrdiff_t ld, double *x)
{
    for (int k = 0; k < n; k++) {
        const int j = trans ? n - 1 - k : k;
        const double *const column = l + (j * ld);
        double sum = x[j];
        if (trans) {
            for (int i = j + 1; i < n; i++) {
                sum -= column[i] * x[i];
            }
            x[j] = sum;
        } else {
            for (int i = j + 1; i < n; i++) {
                x[i] -= column[i] * sum;
            }
        }
    }
}

/* X := L_JJ^-1 X or L_JJ^-T X of a supernode's own columns, count of them n apart: panel by
 * panel, a product with what a panel adds to the others. */
static void turn_own(bool trans, int columns, const double *l, int ld, int count, double *x,
                     int n)
{
    if (count == 1) {
        cblas_dtrsv(CblasColMajor, CblasLower, trans ? CblasTrans : CblasNoTrans, CblasUnit,
                    columns, l, ld, x, 1);
        return;
    }
    const int panels = (columns + TRIANGLE - 1) / TRIANGLE;
    for (int k = 0; k < panels; k++) {
        const int first = TRIANGLE * (trans ? panels - 1 - k : k);
        const int here = first + TRIANGLE < columns ? TRIANGLE : columns - first;
        const int others = columns - first - here;
        const double *const own = l + first + ((ptrdiff_t)first * ld);
        double *const at = x + first;
        if (trans) {
            multiply_columns(true, others, here, -1.0, own + here, ld, count, at + here, n, 1.0,
                             at, n);
        }
        for (int c = 0; c < count; c++) {
            turn_triangle(trans, here, own, ld, at + ((ptrdiff_t)c * n));
        }
        if (!trans) {
            multiply_columns(false, others, here, -1.0, own + here, ld, count, at, n, 1.0,
                             at + here, n);
        }
    }
}

/* Y := L^-T D^-1 L^-1 Y in the order of P. */
static void solve_ordered(const mt_factor *f, int count, double *y)
{
    const mt_factor_pattern *const p = f->pattern;
    for (int s = 0; s < p->n_super; s++) {
        const int columns = p->first[s + 1] - p->first[s];
        const int ld = p->row_at[s + 1] - p->row_at[s];
        const int below = ld - columns;
        const int *const rows = p->row + p->row_at[s] + columns;
        const double *const l = f->l + p->at[s];
        double *const own = y + p->first[s];
        turn_own(false, columns, l, ld, count, own, p->n);
        multiply_columns(false, below, columns, 1.0, l + columns, ld, count, own, p->n, 0.0,
                         f->work, below);
        for (int c = 0; c < count; c++) {
            for (int i = 0; i < below; i++) {
                y[rows[i] + ((ptrdiff_t)c * p->n)] -= f->work[i + ((ptrdiff_t)c * below)];
            }
        }
    }
    for (int c = 0; c < count; c++) {
        for (int i = 0; i < p->n; i++) {
            y[i + ((ptrdiff_t)c * p->n)] /= f->d[i];
        }
    }
    for (int s = p->n_super - 1; s >= 0; s--) {
        const int columns = p->first[s + 1] - p->first[s];
        const int ld = p->row_at[s + 1] - p->row_at[s];
        const int below = ld - columns;
        const int *const rows = p->row + p->row_at[s] + columns;
        const double *const l = f->l + p->at[s];
        double *const own = y + p->first[s];
        for (int c = 0; c < count; c++) {
            for (int i = 0; i < below; i++) {
                f->work[i + ((ptrdiff_t)c * below)] = y[rows[i] + ((ptrdiff_t)c * p->n)];
            }
        }
        multiply_columns(true, below, columns, -1.0, l + columns, ld, count, f->work, below,
                         1.0, own, p->n);
        turn_own(true, columns, l, ld, count, own, p->n);
    }
}

void mt_factor_solve(const mt_factor *f, int count, double *x)
{
    const mt_factor_pattern *const p = f->pattern;
    double *const y = f->work + (p->most_rows * (size_t)f->columns);
    for (int first = 0; first < count; first += f->columns) {
        const int some = first + f->columns < count ? f->columns : count - first;
        double *const part = x + ((ptrdiff_t)first * p->n);
        for (int c = 0; c < some; c++) {
            const ptrdiff_t at = (ptrdiff_t)c * p->n;
            for (int i = 0; i < p->n; i++) {
                y[at + p->to[i]] = part[at + i];
            }
        }
        solve_ordered(f, some, y);
        for (int c = 0; c < some; c++) {
            const ptrdiff_t at = (ptrdiff_t)c * p->n;
            for (int i = 0; i < p->n; i++) {
                part[at + i] = y[at + p->to[i]];
            }
        }
    }
}
