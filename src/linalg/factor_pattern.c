/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Nested dissection of rows that belong together finds what it finds of the rows, in a
 * thirtieth of the time: of six states of a body there are thirty-six couplings to each
 * neighbour. The parts are ordered, then the rows of each in turn.
 */
#include "linalg/factor_priv.h"

#include <string.h>

#include "linalg/cholmod.h"

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
    mt_cholmod cholmod;
    cholmod_common c;
    *out = NULL;
    MT_TRY(mt_arena_check(mem, err));
    *p = (mt_factor_pattern){.n = h->n};
    MT_TRY(mt_cholmod_load(&cholmod, err));
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
