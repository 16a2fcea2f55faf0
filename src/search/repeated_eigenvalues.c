/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search/repeated_eigenvalues.h"

#include <math.h>
#include <string.h>

#include "problem/evaluate.h"
#include "problem/requirement.h"

enum { MODES_MOST = 1 + MT_MODE_ORDER_MOST };
/* Two limits nearer than this are one. */
static const double SAME_LIMIT = 1e-9;
/* Entries of B whose slopes depend on those of others up to this part are told by them: by
 * symmetry. */
static const double INDEPENDENT = 1e-6;

/* True where both are the same limit on modes of one analysis. */
static bool alike(const mt_repeated_eigenvalues_side *a, const mt_repeated_eigenvalues_side *b)
{
    return a->analysis == b->analysis && a->moves == b->moves &&
           fabs(a->limit_hz / b->limit_hz - 1.0) <= SAME_LIMIT;
}

static bool vibrates(const mt_modes *modes, int pos)
{
    return pos >= 0 && pos < modes->shaped && modes->kind[pos] == MT_MODE_FLEXIBLE;
}

static bool has_block_for(const mt_repeated_eigenvalues *m,
                          const mt_repeated_eigenvalues_side *s)
{
    for (int b = 0; b < m->n_blocks; b++) {
        const mt_repeated_eigenvalues_block *const k = &m->blocks[b];
        if (alike(&k->side, s) && (k->both || k->side.sign * s->sign > 0)) {
            return true;
        }
    }
    return false;
}

/* True where a block with the same modes exists from the other side; it is then used for
 * both. */
static bool joined(mt_repeated_eigenvalues *m, const mt_repeated_eigenvalues_side *s, int index,
                   int r)
{
    for (int b = 0; b < m->n_blocks; b++) {
        mt_repeated_eigenvalues_block *const k = &m->blocks[b];
        if (alike(&k->side, s) && k->index == index && k->r == r) {
            k->both = true;
            return true;
        }
    }
    return false;
}

/* The modes from s->pos on (upwards for a lower limit, downwards for an upper one) that are
 * near the limit, as a block. */
static mt_status add_block(mt_repeated_eigenvalues *m, const mt_repeated_eigenvalues_side *s,
                           double near, mt_arena *mem, mt_err *err)
{
    mt_workspace *const ws = m->ws;
    const mt_analysis *const a = s->analysis;
    const int step = s->sign > 0 ? 1 : -1;
    int r = 0;
    while (r < MODES_MOST && vibrates(&a->modes, s->pos + r * step) &&
           fabs(mt_repeated_eigenvalues_margin(ws, s, s->pos + r * step)) <= near) {
        r++;
    }
    const int before = s->pos - step;
    const bool apart = !vibrates(&a->modes, before) ||
                       fabs(mt_repeated_eigenvalues_margin(ws, s, before)) > near;
    if (r < 2 || !apart) {
        return MT_OK;
    }
    const int low = s->sign > 0 ? s->pos : s->pos - r + 1;
    const int n = mt_linear_freedoms(a->lin);
    const size_t r2 = (size_t)r * (size_t)r;
    const int index = mt_modal_index(&a->modes, low);
    if (joined(m, s, index, r)) {
        return MT_OK;
    }
    mt_repeated_eigenvalues_block *const b = &m->blocks[m->n_blocks++];
    *b = (mt_repeated_eigenvalues_block){.side = *s,
                                         .index = index,
                                         .r = r,
                                         .row_most = -1,
                                         .c = mt_arena_f64(mem, (size_t)n, (size_t)r),
                                         .b = mt_arena_f64(mem, r2, 1),
                                         .g = mt_arena_f64(mem, r2, (size_t)ws->c->n_t),
                                         .entry = mt_arena_int(mem, r2)};
    MT_TRY(mt_arena_check(mem, err));
    mt_gemm(false, false, n, r, n, 1.0, mt_linear_reduced(a->lin).m, n,
            mt_modal_shape(&a->modes, low), n, 0.0, b->c, n);
    return MT_OK;
}

/* The outermost mode of each limit first. */
static mt_status find_blocks(mt_repeated_eigenvalues *m,
                             const mt_repeated_eigenvalues_side *sides, int n, double near,
                             mt_arena *mem, mt_err *err)
{
    for (int i = 0; i < n; i++) {
        mt_repeated_eigenvalues_side first = sides[i];
        if (has_block_for(m, &first)) {
            continue;
        }
        for (int k = 0; k < n; k++) {
            const mt_repeated_eigenvalues_side *const other = &sides[k];
            if (alike(other, &first) && first.sign * other->sign > 0 &&
                first.sign * (first.pos - other->pos) > 0) {
                first = *other;
            }
        }
        MT_TRY(add_block(m, &first, near, mem, err));
    }
    return MT_OK;
}

/* Find the rows of the problem that the blocks stand for. */
static void find_rows(mt_repeated_eigenvalues *m, const mt_repeated_eigenvalues_side *sides,
                      int n)
{
    for (int i = 0; i < n; i++) {
        const mt_repeated_eigenvalues_side *const s = &sides[i];
        for (int k = 0; k < m->n_blocks; k++) {
            mt_repeated_eigenvalues_block *const b = &m->blocks[k];
            const int low = mt_modal_flexible(&b->side.analysis->modes, b->index);
            if (alike(&b->side, s) && (b->both || b->side.sign * s->sign > 0) &&
                s->pos >= low && s->pos < low + b->r && !m->replaced[s->row]) {
                m->replaced[s->row] = true;
                b->row_most = b->first == 0 ? s->row : -1;
                b->first++; /* for the moment: how many ask */
            }
        }
    }
}

/* out := W^T a W, symmetric r x r. */
static void turned(int r, const double *w, double *a)
{
    double aw[MODES_MOST * MODES_MOST];
    mt_gemm(false, false, r, r, r, 1.0, a, r, w, r, 0.0, aw, r);
    mt_gemm(true, false, r, r, r, 1.0, w, r, aw, r, 0.0, a, r);
}

/* Column k of B, and of its slopes: s moves with z as exp(2 sign z). */
static mt_status block_column(const mt_repeated_eigenvalues *m,
                              mt_repeated_eigenvalues_block *b, int low, int k, double s,
                              mt_err *err)
{
    mt_workspace *const ws = m->ws;
    mt_analysis *const a = b->side.analysis;
    const int n = mt_linear_freedoms(a->lin);
    const int r = b->r;
    const double sign = b->side.sign;
    const double *const y = mt_modal_shape(&a->modes, low);
    b->b[k + (k * r)] = sign * 0.5 * (a->modes.lambda[low + k] / s - 1.0);
    MT_TRY(mt_analysis_products(a, low + k, err));
    for (int j = 0; j < ws->p->n; j++) {
        const double part = b->side.factor != NULL ? b->side.factor[j] : 1.0;
        const double factor = sign * part * mt_workspace_dx_dt(ws, j) / (2.0 * s);
        for (int l = 0; l < r; l++) {
            const double *const yl = y + ((ptrdiff_t)l * n);
            const double slope = mt_dot(n, yl, a->dky + ((ptrdiff_t)j * n)) -
                                 (s * mt_dot(n, yl, a->dmy + ((ptrdiff_t)j * n)));
            b->g[l + (k * r) + ((ptrdiff_t)j * r * r)] = factor * slope;
        }
    }
    for (int l = 0; l < r && ws->c->n_t > ws->p->n; l++) {
        b->g[l + (k * r) + ((ptrdiff_t)ws->p->n * r * r)] =
            l == k && b->side.moves ? -a->modes.lambda[low + k] / s : 0.0;
    }
    return MT_OK;
}

static mt_status block_matrices(mt_repeated_eigenvalues *m, mt_repeated_eigenvalues_block *b,
                                bool turn, mt_err *err)
{
    const mt_workspace *const ws = m->ws;
    const mt_analysis *const a = b->side.analysis;
    const int n = mt_linear_freedoms(a->lin);
    const int r = b->r;
    const int low = mt_modal_flexible(&a->modes, b->index);
    const double z = b->side.moves ? ws->t[ws->p->n] : 0.0;
    const double w0 = 6.283185307179586 * b->side.limit_hz * exp(b->side.sign * z);
    if (low < 0 || low + r > a->modes.shaped) {
        return mt_fail(err, MT_E_DOMAIN, "repeated modes: they are not all there");
    }
    memset(b->b, 0, (size_t)r * (size_t)r * sizeof *b->b);
    for (int k = 0; k < r; k++) {
        MT_TRY(block_column(m, b, low, k, w0 * w0, err));
    }
    if (turn) {
        double w[MODES_MOST * MODES_MOST];
        mt_gemm(true, false, r, r, n, 1.0, mt_modal_shape(&a->modes, low), n, b->c, n, 0.0, w,
                r);
        turned(r, w, b->b);
        for (int j = 0; j < ws->c->n_t; j++) {
            turned(r, w, b->g + ((ptrdiff_t)j * r * r));
        }
    }
    return MT_OK;
}

/* b and g of every block at the problem's last evaluation, which had gradients. turn: in the
 * basis of t0; else in that of the modes. */
static mt_status matrices(mt_repeated_eigenvalues *m, bool turn, mt_err *err)
{
    for (int b = 0; b < m->n_blocks; b++) {
        MT_TRY(block_matrices(m, &m->blocks[b], turn, err));
    }
    return MT_OK;
}

/* Entries of B with independent slopes, by pivoted QR; off-diagonal ones times sqrt 2, so that
 * the result does not depend on the basis. */
static mt_status choose_entries(mt_repeated_eigenvalues *m, mt_repeated_eigenvalues_block *b,
                                mt_arena *mem, mt_err *err)
{
    const int n = m->ws->c->n_t;
    const int r = b->r;
    double *const a = mt_arena_f64(mem, (size_t)n, (size_t)r * (size_t)r);
    int *const entry = mt_arena_int(mem, (size_t)r * (size_t)r);
    int k = 0;
    MT_TRY(mt_arena_check(mem, err));
    for (int l = 0; l < r; l++) {
        for (int i = l; i < r; i++) {
            for (int j = 0; j < n; j++) {
                a[j + ((ptrdiff_t)k * n)] =
                    (i == l ? 1.0 : sqrt(2.0)) * b->g[i + (l * r) + ((ptrdiff_t)j * r * r)];
            }
            entry[k++] = i + (l * r);
        }
    }
    mt_qr qr;
    MT_TRY(mt_qr_factor(n, k, a, n, INDEPENDENT, mem, &qr, err));
    b->n_rows = qr.rank;
    for (int i = 0; i < qr.rank; i++) {
        b->entry[i] = entry[qr.perm[i]];
    }
    return MT_OK;
}

/* Rows of the smooth problem: the problem's own equalities that no block stands for, then the
 * entries. */
static mt_status number_rows(mt_repeated_eigenvalues *m, mt_arena *mem, mt_err *err)
{
    const mt_workspace *const ws = m->ws;
    const int n_eq = ws->c->rows.eq.n;
    double least = 1.0;
    for (int i = 0; i < n_eq; i++) {
        m->n_kept += m->replaced[i] ? 0 : 1;
    }
    for (int b = 0; b < m->n_blocks; b++) {
        MT_TRY(choose_entries(m, &m->blocks[b], mem, err));
        m->blocks[b].first = m->n_kept + m->n_rows;
        m->n_rows += m->blocks[b].n_rows;
    }
    m->eq_tol = mt_arena_f64(mem, (size_t)m->n_kept + (size_t)m->n_rows, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < ws->c->rows.in.n; i++) {
        least = fmin(least, ws->c->rows.in.tol[i]);
    }
    int kept = 0;
    for (int i = 0; i < n_eq; i++) {
        least = fmin(least, ws->c->rows.eq.tol[i]);
        if (!m->replaced[i]) {
            m->eq_tol[kept++] = ws->c->rows.eq.tol[i];
        }
    }
    for (int i = 0; i < m->n_rows; i++) {
        m->eq_tol[m->n_kept + i] = 0.5 * least;
    }
    return MT_OK;
}

mt_status mt_repeated_eigenvalues_find(mt_workspace *ws, const double *t, double near,
                                       mt_arena *mem, mt_repeated_eigenvalues *out, mt_err *err)
{
    mt_repeated_eigenvalues_side *sides = NULL;
    int n = 0;
    *out = (mt_repeated_eigenvalues){.ws = ws};
    MT_TRY(mt_subproblem_values_init(ws->c, mem, &out->values, err));
    MT_TRY(mt_workspace_eval(ws, t, true, &out->values, err));
    MT_TRY(mt_repeated_eigenvalues_sides(ws, mem, &sides, &n, err));
    out->blocks = mt_arena_alloc(mem, (size_t)n, sizeof *out->blocks);
    out->replaced = mt_arena_alloc(mem, (size_t)ws->c->rows.eq.n + (size_t)ws->c->rows.in.n,
                                   sizeof *out->replaced);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(find_blocks(out, sides, n, near, mem, err));
    find_rows(out, sides, n);
    MT_TRY(matrices(out, false, err));
    return number_rows(out, mem, err);
}

bool mt_repeated_eigenvalues_same(const mt_repeated_eigenvalues *a,
                                  const mt_repeated_eigenvalues *b)
{
    bool same = a->n_blocks == b->n_blocks;
    for (int k = 0; k < a->n_blocks && same; k++) {
        const mt_repeated_eigenvalues_block *const x = &a->blocks[k];
        const mt_repeated_eigenvalues_block *const y = &b->blocks[k];
        same = x->index == y->index && x->r == y->r && x->both == y->both &&
               x->row_most == y->row_most && x->side.row == y->side.row &&
               alike(&x->side, &y->side);
    }
    return same;
}

/* The problem's own rows at its last evaluation. */
static void own_rows(const mt_repeated_eigenvalues *m, mt_nlp_values *out)
{
    const mt_workspace *const ws = m->ws;
    const mt_nlp_values *const v = &m->values;
    const int n_eq = ws->c->rows.eq.n;
    const int n_in = ws->c->rows.in.n;
    const int rows = m->n_kept + m->n_rows;
    int kept = 0;
    for (int i = 0; i < n_in; i++) {
        const bool replaced = m->replaced[n_eq + i];
        out->in[i] = replaced ? 1.0 : v->in[i];
        for (int j = 0; j < ws->c->n_t; j++) {
            const ptrdiff_t at = i + ((ptrdiff_t)j * n_in);
            out->din[at] = replaced ? 0.0 : v->din[at];
        }
    }
    for (int i = 0; i < n_eq; i++) {
        if (m->replaced[i]) {
            continue;
        }
        out->eq[kept] = v->eq[i];
        for (int j = 0; j < ws->c->n_t; j++) {
            out->deq[kept + ((ptrdiff_t)j * rows)] = v->deq[i + ((ptrdiff_t)j * n_eq)];
        }
        kept++;
    }
}

static mt_status evaluate_blocks(void *context, const double *t, bool with_gradient,
                                 mt_nlp_values *out, mt_err *err)
{
    mt_repeated_eigenvalues *const m = context;
    mt_workspace *const ws = m->ws;
    const int rows = m->n_kept + m->n_rows;
    (void)with_gradient; /* the matrices need the vectors anyhow */
    MT_TRY(mt_workspace_eval_uncounted(ws, t, true, &m->values, err));
    MT_TRY(matrices(m, true, err));
    out->f = m->values.f;
    memcpy(out->df, m->values.df, (size_t)ws->c->n_t * sizeof *out->df);
    own_rows(m, out);
    for (int k = 0; k < m->n_blocks; k++) {
        const mt_repeated_eigenvalues_block *const b = &m->blocks[k];
        for (int i = 0; i < b->n_rows; i++) {
            const int e = b->entry[i];
            const double factor = e / b->r == e % b->r ? 1.0 : sqrt(2.0);
            out->eq[b->first + i] = factor * b->b[e];
            for (int j = 0; j < ws->c->n_t; j++) {
                out->deq[b->first + i + ((ptrdiff_t)j * rows)] =
                    factor * b->g[e + ((ptrdiff_t)j * b->r * b->r)];
            }
        }
    }
    return MT_OK;
}

mt_nlp mt_repeated_eigenvalues_nlp(mt_repeated_eigenvalues *m)
{
    mt_nlp nlp = mt_workspace_nlp(m->ws);
    nlp.n_eq = m->n_kept + m->n_rows;
    nlp.eq_tol = m->eq_tol;
    nlp.eval = evaluate_blocks;
    nlp.n_next = 0;
    nlp.context = m;
    nlp.hint = NULL;
    nlp.n_workers = 1;
    nlp.contexts = NULL;
    return nlp;
}
