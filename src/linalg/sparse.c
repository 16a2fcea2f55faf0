/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linalg/sparse.h"

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
