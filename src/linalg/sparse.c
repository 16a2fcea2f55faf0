/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sparse rows, and L D L^T of large sparse symmetric matrices. */
#include "linalg/sparse.h"

#include <cblas.h>

#include <dlfcn.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <suitesparse/cholmod.h>

#include "base/arena.h"
#include "linalg/dense.h"

/* The functions of CHOLMOD in use; include/suitesparse/cholmod_core.h has the contracts. */
typedef struct mt_cholmod {
    int (*start)(cholmod_common *c);
    cholmod_factor *(*analyze)(cholmod_sparse *a, cholmod_common *c);
    cholmod_factor *(*analyze_p)(cholmod_sparse *a, int *perm, int *set, size_t size,
                                 cholmod_common *c);
    int (*free_factor)(cholmod_factor **l, cholmod_common *c);
    int (*finish)(cholmod_common *c);
} mt_cholmod;

/* Sparse rows. */

void mt_rows_begin(mt_rows *s, int n_rows, size_t most, mt_arena *mem)
{
    *s = (mt_rows){.n_rows = n_rows};
    s->start = mt_arena_int(mem, (size_t)n_rows + 1);
    s->index = mt_arena_int(mem, most);
    s->value = mt_arena_f64(mem, most, 1);
}

void mt_rows_of_columns(int n, int count, const double *dense, mt_arena *mem, mt_rows *out)
{
    const ptrdiff_t size = (ptrdiff_t)n * count;
    size_t most = 0;
    for (ptrdiff_t i = 0; i < size; i++) {
        most += dense[i] != 0.0 ? 1 : 0;
    }
    mt_rows_begin(out, count, most, mem);
    for (int c = 0; c < count && !mt_arena_failed(mem); c++) {
        const double *const column = dense + ((ptrdiff_t)c * n);
        for (int i = 0; i < n; i++) {
            if (column[i] != 0.0) {
                mt_rows_push(out, c, i, column[i]);
            }
        }
        mt_rows_end(out, c);
    }
}

void mt_rows_square(const mt_rows *s, int a, double c, int n, double *out)
{
    for (int p = s->start[a]; p < s->start[a + 1]; p++) {
        double *const column = out + ((ptrdiff_t)s->index[p] * n);
        const double part = c * s->value[p];
        for (int q = p; q < s->start[a + 1]; q++) {
            column[s->index[q]] += s->value[q] * part;
        }
    }
}

/* out += c b a^T where that is in the lower triangle. */
static void lower_product(const mt_rows *s, int a, int b, double c, int n, double *out)
{
    int first = s->start[b];
    for (int p = s->start[a]; p < s->start[a + 1]; p++) {
        double *const column = out + ((ptrdiff_t)s->index[p] * n);
        const double part = c * s->value[p];
        while (first < s->start[b + 1] && s->index[first] < s->index[p]) {
            first++;
        }
        for (int q = first; q < s->start[b + 1]; q++) {
            column[s->index[q]] += s->value[q] * part;
        }
    }
}

void mt_rows_pair(const mt_rows *s, int a, int b, double c, int n, double *out)
{
    lower_product(s, a, b, 0.5 * c, n, out);
    lower_product(s, b, a, 0.5 * c, n, out);
}

void mt_rows_transpose(const mt_rows *a, int n, mt_arena *mem, mt_rows *out)
{
    const int size = a->n_rows > 0 ? a->start[a->n_rows] : 0;
    mt_rows_begin(out, n, (size_t)size, mem);
    if (mt_arena_failed(mem)) {
        return;
    }
    for (int i = 0; i < size; i++) {
        out->start[a->index[i] + 1]++;
    }
    for (int j = 0; j < n; j++) {
        out->start[j + 1] += out->start[j];
    }
    for (int r = a->n_rows - 1; r >= 0; r--) { /* fills from the ends, so rows ascend */
        for (int i = a->start[r]; i < a->start[r + 1]; i++) {
            const int at = --out->start[a->index[i] + 1];
            out->index[at] = r;
            out->value[at] = a->value[i];
        }
    }
    /* the ends have become starts, one place too far */
    for (int j = 0; j < n; j++) {
        out->start[j] = out->start[j + 1];
    }
    out->start[n] = size;
}

/* CHOLMOD, loaded when it is first needed. */

#define TEXT_OF(x) #x
#define TEXT(x)    TEXT_OF(x)
/* Of the headers' own interface: its major version is the library's. */
#define LIBRARY "libcholmod.so." TEXT(CHOLMOD_MAIN_VERSION)

/* POSIX gives a function's address as a pointer to an object, which ISO C does not convert. */
static bool find_library_symbol(void *library, const char *name, void *function)
{
    void *const address = dlsym(library, name);
    memcpy(function, (const void *)&address, sizeof address);
    return address != NULL;
}

/* Status from the loader's text, the only report it gives; a lack of memory is recognised in
 * it. */
static mt_status failed(mt_err *err)
{
    const char *const said = dlerror();
    if (said == NULL || strstr(said, "out of memory") != NULL ||
        strstr(said, strerror(ENOMEM)) != NULL) {
        return mt_fail_memory(err);
    }
    return mt_fail(err, MT_E_INTERNAL, "CHOLMOD, which large mechanisms need: %s", said);
}

/**
 * Load the library at the first call: with METIS and its other dependencies that takes a fifth
 * of the start-up time of the program, and only large mechanisms need it. It stays loaded.
 * Returns false, with dlerror, where it is not installed or memory is out.
 */
static bool cholmod_load(mt_cholmod *cholmod)
{
    void *const library = dlopen(LIBRARY, RTLD_NOW | RTLD_LOCAL);
    return library != NULL && find_library_symbol(library, "cholmod_start", &cholmod->start) &&
           find_library_symbol(library, "cholmod_analyze", &cholmod->analyze) &&
           find_library_symbol(library, "cholmod_analyze_p", &cholmod->analyze_p) &&
           find_library_symbol(library, "cholmod_free_factor", &cholmod->free_factor) &&
           find_library_symbol(library, "cholmod_finish", &cholmod->finish) &&
           cholmod->start != NULL && cholmod->analyze != NULL && cholmod->analyze_p != NULL &&
           cholmod->free_factor != NULL && cholmod->finish != NULL;
}

/*
 * Nested dissection of rows that belong together finds what it finds of the rows, in a
 * thirtieth of the time: of six states of a body there are thirty-six couplings to each
 * neighbour. The parts are ordered, then the rows of each in turn.
 */

static mt_status copy_pattern(const cholmod_factor *l, mt_arena *mem, mt_factor_pattern *p,
                              mt_err *err)
{
    const size_t n = l->n;
    const size_t ns = l->nsuper;
    const int *const perm = l->Perm;
    p->n = (int)n;
    p->n_super = (int)ns;
    p->to = mt_arena_int(mem, n);
    p->first = mt_arena_int(mem, ns + 1);
    p->row_at = mt_arena_int(mem, ns + 1);
    p->row = mt_arena_int(mem, l->ssize);
    p->at = mt_arena_alloc(mem, ns + 1, sizeof *p->at);
    p->super_of = mt_arena_int(mem, n);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(p->first, l->super, (ns + 1) * sizeof *p->first);
    memcpy(p->row_at, l->pi, (ns + 1) * sizeof *p->row_at);
    memcpy(p->row, l->s, l->ssize * sizeof *p->row);
    for (size_t i = 0; i < n; i++) {
        p->to[perm[i]] = (int)i;
    }
    for (size_t s = 0; s < ns; s++) {
        const int columns = p->first[s + 1] - p->first[s];
        const int rows = p->row_at[s + 1] - p->row_at[s];
        p->at[s + 1] = p->at[s] + ((ptrdiff_t)rows * columns);
        p->most_rows = p->most_rows > (size_t)rows ? p->most_rows : (size_t)rows;
        p->most_columns = p->most_columns > (size_t)columns ? p->most_columns : (size_t)columns;
        for (int j = p->first[s]; j < p->first[s + 1]; j++) {
            p->super_of[j] = (int)s;
        }
    }
    return MT_OK;
}

/* The lower triangle of a matrix of places alone. */
static cholmod_sparse places(int n, int *start, int *row)
{
    return (cholmod_sparse){.nrow = (size_t)n,
                            .ncol = (size_t)n,
                            .nzmax = (size_t)start[n],
                            .p = start,
                            .i = row,
                            .stype = -1,
                            .itype = CHOLMOD_INT,
                            .xtype = CHOLMOD_PATTERN,
                            .dtype = CHOLMOD_DOUBLE,
                            .sorted = 1,
                            .packed = 1};
}

static mt_status refused(const cholmod_common *c, mt_err *err)
{
    return c->status == CHOLMOD_OUT_OF_MEMORY || c->status == CHOLMOD_TOO_LARGE
               ? mt_fail_memory(err)
               : mt_fail(err, MT_E_INTERNAL, "cholmod_analyze: status %d", c->status);
}

/* Write to row[] the rows of the parts that columns first .. end - 1 of h couple to, marked in
 * met[]; returns their number. row NULL: count only. */
static int meet(const mt_lower *h, const int *part, int first, int end, int *met, int *row)
{
    int count = 0;
    for (int k = h->start[first]; k < h->start[end]; k++) {
        const int other = part[h->row[k]];
        if (met[other] == end) {
            continue;
        }
        met[other] = end;
        if (row != NULL) {
            row[count] = other;
        }
        count++;
    }
    return count;
}

/* Pattern of h by parts: an entry where two parts couple. Rows of a column are unsorted.
 * first[n_parts + 1]: rows of the parts. */
static mt_status join_parts(const mt_lower *h, const int *part, int n_parts, const int *first,
                            mt_arena *mem, mt_lower *out, mt_err *err)
{
    int *const met = mt_arena_int(mem, (size_t)n_parts);
    *out = (mt_lower){.n = n_parts, .start = mt_arena_int(mem, (size_t)n_parts + 1)};
    MT_TRY(mt_arena_check(mem, err));
    for (int p = 0; p < n_parts; p++) {
        out->start[p + 1] = out->start[p] + meet(h, part, first[p], first[p + 1], met, NULL);
    }
    out->row = mt_arena_int(mem, (size_t)out->start[n_parts]);
    MT_TRY(mt_arena_check(mem, err));
    memset(met, 0, (size_t)n_parts * sizeof *met);
    for (int p = 0; p < n_parts; p++) {
        (void)meet(h, part, first[p], first[p + 1], met, out->row + out->start[p]);
    }
    return MT_OK;
}

/* order[n] of the rows, from that of their parts. */
static mt_status order_parts(const mt_lower *h, const int *part, const mt_cholmod *cholmod,
                             cholmod_common *c, int *order, mt_arena *mem, mt_err *err)
{
    const int n_parts = h->n == 0 ? 0 : part[h->n - 1] + 1;
    mt_lower joined;
    int *const first = mt_arena_int(mem, (size_t)n_parts + 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < h->n; i++) {
        first[part[i] + 1]++;
    }
    for (int i = 0; i < n_parts; i++) {
        first[i + 1] += first[i];
    }
    MT_TRY(join_parts(h, part, n_parts, first, mem, &joined, err));
    cholmod_sparse a = places(n_parts, joined.start, joined.row);
    a.sorted = 0;
    c->supernodal = CHOLMOD_SIMPLICIAL;
    c->nmethods = 2; /* both, as what one of them costs is little: the sparser is taken */
    c->method[0].ordering = CHOLMOD_AMD;
    c->method[1].ordering = CHOLMOD_METIS;
    cholmod_factor *l = cholmod->analyze(&a, c);
    const bool is = l != NULL && c->status == CHOLMOD_OK;
    int at = 0;
    for (int k = 0; k < n_parts && is; k++) {
        const int from = ((const int *)l->Perm)[k];
        for (int i = first[from]; i < first[from + 1]; i++) {
            order[at++] = i;
        }
    }
    cholmod->free_factor(&l, c);
    c->nmethods = 1;
    c->method[0].ordering = CHOLMOD_GIVEN;
    return is ? MT_OK : refused(c, err);
}

static mt_status analyse(const mt_lower *h, const int *part, const mt_cholmod *cholmod,
                         cholmod_common *c, mt_arena *mem, mt_arena *scratch,
                         mt_factor_pattern *p, mt_err *err)
{
    int *const order = part == NULL ? NULL : mt_arena_int(scratch, (size_t)h->n);
    MT_TRY(mt_arena_check(scratch, err));
    if (part != NULL) {
        MT_TRY(order_parts(h, part, cholmod, c, order, scratch, err));
    }
    cholmod_sparse a = places(h->n, h->start, h->row);
    c->supernodal = CHOLMOD_SUPERNODAL;
    cholmod_factor *l = cholmod->analyze_p(&a, order, NULL, 0, c);
    const bool is = l != NULL && c->status == CHOLMOD_OK && l->is_super;
    const mt_status rc = is ? copy_pattern(l, mem, p, err) : refused(c, err);
    cholmod->free_factor(&l, c);
    return rc;
}

mt_status mt_factor_analyse(const mt_lower *h, const int *part, mt_arena *mem,
                            mt_factor_pattern **out, mt_err *err)
{
    mt_factor_pattern *const p = mt_arena_alloc(mem, 1, sizeof *p);
    mt_arena scratch = {.first = NULL};
    mt_cholmod cholmod = {.start = NULL};
    cholmod_common c;
    *out = NULL;
    MT_TRY(mt_arena_check(mem, err));
    *p = (mt_factor_pattern){.n = h->n};
    if (!cholmod_load(&cholmod)) {
        return failed(err);
    }
    if (!cholmod.start(&c)) {
        return mt_fail_memory(err);
    }
    c.print = 0;
    mt_status rc = mt_arena_init(&scratch, 0, err);
    rc = rc == MT_OK ? analyse(h, part, &cholmod, &c, mem, &scratch, p, err) : rc;
    mt_arena_free(&scratch);
    cholmod.finish(&c);
    *out = rc == MT_OK ? p : NULL;
    return rc;
}

/*
 * Left-looking, supernode by supernode: columns J of L are H(:, J) less
 *     sum over earlier supernodes K with rows in J of  L(:, K) D_K L(J, K)^T,
 * each one product of dense blocks, scattered into place; then the block J itself is factored,
 * L_JJ D_J L_JJ^T, and the rows below it divided by it. A supernode that has been used waits in
 * the list of the next one that its rows reach.
 */

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
