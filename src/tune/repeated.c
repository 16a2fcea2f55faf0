/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tune/repeated.h"

#include <math.h>
#include <string.h>

enum { MODES_MOST = 6 };
/* Two limits nearer than this are one. */
static const double SAME_LIMIT = 1e-9;
/* Entries of B whose slopes depend on those of others up to this part are told by them: by symmetry. */
static const double INDEPENDENT = 1e-6;

/* One side of a frequency goal, at the present design. */
typedef struct side {
    const mt_demand *d;
    double limit_hz;
    double sign;
    int row;
    int pos;
} side;

static mt_status side_of(mt_problem *p, const mt_demand *d, double sign, side *out, bool *is,
                         mt_err *err)
{
    const mt_goal *const g = d->goal;
    const double limit = sign > 0 ? g->at_least : g->at_most;
    *is = g->type == MT_GOAL_FREQUENCY && d->view >= 0 && d->row_in >= 0 && MT_HAS(limit);
    if (*is) {
        const int row = d->row_in + (sign < 0 && MT_HAS(g->at_least) ? 1 : 0);
        *out = (side){.d = d, .limit_hz = limit, .sign = sign, .row = row, .pos = -1};
        MT_TRY(mt_view_position(p, &p->views[d->view], d->mode, d->named, &out->pos, err));
        *is = out->pos >= 0;
    }
    return MT_OK;
}

static double above(const mt_modes *modes, int pos, const side *s)
{
    return s->sign * log(mt_modal_hz(modes, pos) / s->limit_hz);
}

static bool vibrates(const mt_modes *modes, int pos)
{
    return pos >= 0 && pos < modes->count && modes->kind[pos] == MT_MODE_FLEXIBLE;
}

static bool known(const mt_repeated *m, const side *s)
{
    for (int b = 0; b < m->n_blocks; b++) {
        const mt_repeated_block *const k = &m->blocks[b];
        if (k->view == s->d->view && k->sign * s->sign > 0 &&
            fabs(k->limit_hz / s->limit_hz - 1.0) <= SAME_LIMIT) {
            return true;
        }
    }
    return false;
}

/* The modes from s->pos on (upwards for a lower limit, downwards for an upper one) that are near the limit, as a block. */
static mt_status add_block(mt_repeated *m, const side *s, double near, mt_arena *mem,
                           mt_err *err)
{
    mt_problem *const p = m->p;
    const mt_analysis *const a = p->views[s->d->view].analysis;
    const int step = s->sign > 0 ? 1 : -1;
    int r = 0;
    while (r < MODES_MOST && vibrates(&a->modes, s->pos + r * step) &&
           fabs(above(&a->modes, s->pos + r * step, s)) <= near) {
        r++;
    }
    const int before = s->pos - step;
    const bool apart = !vibrates(&a->modes, before) || fabs(above(&a->modes, before, s)) > near;
    if (r < 2 || !apart) {
        return MT_OK;
    }
    const int low = s->sign > 0 ? s->pos : s->pos - r + 1;
    const int n = a->lin->n;
    const size_t r2 = (size_t)r * (size_t)r;
    mt_repeated_block *const b = &m->blocks[m->n_blocks++];
    *b = (mt_repeated_block){.view = s->d->view,
                             .r = r,
                             .limit_hz = s->limit_hz,
                             .sign = s->sign,
                             .row_most = -1,
                             .c = mt_arena_f64(mem, (size_t)n, (size_t)r),
                             .b = mt_arena_f64(mem, r2, 1),
                             .g = mt_arena_f64(mem, r2, (size_t)p->n),
                             .entry = mt_arena_int(mem, r2)};
    if (!b->c || !b->b || !b->g || !b->entry) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i <= low; i++) {
        b->index += a->modes.kind[i] == MT_MODE_FLEXIBLE;
    }
    mt_gemm(false, false, n, r, n, 1.0, a->lin->m_r, n, a->modes.y + ((ptrdiff_t)low * n), n,
            0.0, b->c, n);
    return MT_OK;
}

/* Both sides of all goals, the outermost mode of each limit first. */
static mt_status find_blocks(mt_repeated *m, double near, mt_arena *mem, mt_err *err)
{
    mt_problem *const p = m->p;
    for (int i = 0; i < 2 * p->n_demands; i++) {
        side s;
        bool is = false;
        MT_TRY(side_of(p, &p->demands[i / 2], i % 2 == 0 ? 1.0 : -1.0, &s, &is, err));
        if (!is || known(m, &s)) {
            continue;
        }
        side first = s; /* of all that ask the same limit of modes near it */
        for (int k = 0; k < p->n_demands; k++) {
            side other;
            MT_TRY(side_of(p, &p->demands[k], s.sign, &other, &is, err));
            if (is && other.d->view == s.d->view &&
                fabs(other.limit_hz / s.limit_hz - 1.0) <= SAME_LIMIT &&
                s.sign * (first.pos - other.pos) > 0) {
                first = other;
            }
        }
        MT_TRY(add_block(m, &first, near, mem, err));
    }
    return MT_OK;
}

/* Which rows of `in` do the blocks stand for? */
static mt_status find_rows(mt_repeated *m, mt_err *err)
{
    mt_problem *const p = m->p;
    for (int i = 0; i < 2 * p->n_demands; i++) {
        side s;
        bool is = false;
        MT_TRY(side_of(p, &p->demands[i / 2], i % 2 == 0 ? 1.0 : -1.0, &s, &is, err));
        for (int k = 0; k < m->n_blocks && is; k++) {
            mt_repeated_block *const b = &m->blocks[k];
            const mt_modes *const modes = &p->views[b->view].analysis->modes;
            const int low = mt_modal_flexible(modes, b->index);
            if (b->view == s.d->view && b->sign * s.sign > 0 && s.pos >= low &&
                s.pos < low + b->r && fabs(b->limit_hz / s.limit_hz - 1.0) <= SAME_LIMIT) {
                m->replaced[s.row] = true;
                b->row_most = b->first == 0 ? s.row : -1;
                b->first++; /* for the moment: how many ask */
            }
        }
    }
    return MT_OK;
}

/* out := W^T a W, symmetric r x r. */
static void turned(int r, const double *w, double *a)
{
    double aw[MODES_MOST * MODES_MOST];
    mt_gemm(false, false, r, r, r, 1.0, a, r, w, r, 0.0, aw, r);
    mt_gemm(true, false, r, r, r, 1.0, w, r, aw, r, 0.0, a, r);
}

static mt_status block_matrices(mt_repeated *m, mt_repeated_block *b, bool turn, mt_err *err)
{
    mt_problem *const p = m->p;
    mt_analysis *const a = p->views[b->view].analysis;
    const int n = a->lin->n;
    const int r = b->r;
    const int low = mt_modal_flexible(&a->modes, b->index);
    const double w0 = 6.283185307179586 * b->limit_hz;
    const double s = w0 * w0;
    if (low < 0 || low + r > a->modes.count) {
        return mt_fail(err, MT_E_DOMAIN, "repeated modes: they are not all there");
    }
    const double *const y = a->modes.y + ((ptrdiff_t)low * n);
    memset(b->b, 0, (size_t)r * (size_t)r * sizeof *b->b);
    for (int k = 0; k < r; k++) {
        b->b[k + (k * r)] = b->sign * 0.5 * (a->modes.lambda[low + k] / s - 1.0);
        MT_TRY(mt_analysis_dlambda_raw(a, low + k, p->work, err)); /* leaves dK y, dM y */
        for (int j = 0; j < p->n; j++) {
            const double factor = b->sign * mt_problem_stretch(p, j) / (2.0 * s);
            for (int l = 0; l < r; l++) {
                const double *const yl = y + ((ptrdiff_t)l * n);
                const double slope = mt_dot(n, yl, a->dky + ((ptrdiff_t)j * n)) -
                                     (s * mt_dot(n, yl, a->dmy + ((ptrdiff_t)j * n)));
                b->g[l + (k * r) + ((ptrdiff_t)j * r * r)] = factor * slope;
            }
        }
    }
    if (turn) {
        double w[MODES_MOST * MODES_MOST];
        mt_gemm(true, false, r, r, n, 1.0, y, n, b->c, n, 0.0, w, r);
        turned(r, w, b->b);
        for (int j = 0; j < p->n; j++) {
            turned(r, w, b->g + ((ptrdiff_t)j * r * r));
        }
    }
    return MT_OK;
}

mt_status mt_repeated_matrices(mt_repeated *m, bool turn, mt_err *err)
{
    for (int b = 0; b < m->n_blocks; b++) {
        MT_TRY(block_matrices(m, &m->blocks[b], turn, err));
    }
    return MT_OK;
}

/* Entries of B whose slopes are independent, by pivoted QR; off the diagonal times sqrt 2, so that a turned basis changes nothing. */
static mt_status choose_entries(mt_repeated *m, mt_repeated_block *b, mt_arena *mem,
                                mt_err *err)
{
    const int n = m->p->n;
    const int r = b->r;
    double *const a = mt_arena_f64(mem, (size_t)n, (size_t)r * (size_t)r);
    int *const entry = mt_arena_int(mem, (size_t)r * (size_t)r);
    int k = 0;
    if (a == NULL || entry == NULL) {
        return mt_fail_memory(err);
    }
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

mt_status mt_repeated_find(mt_problem *p, const double *t, double near, mt_arena *mem,
                           mt_repeated *out, mt_err *err)
{
    *out = (mt_repeated){.p = p};
    out->blocks = mt_arena_alloc(mem, 2 * (size_t)p->n_demands, sizeof *out->blocks);
    out->replaced = mt_arena_alloc(mem, (size_t)mt_problem_rows_in(p), sizeof(bool));
    if (out->blocks == NULL || out->replaced == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(mt_problem_values_init(p, mem, &out->values, err));
    MT_TRY(mt_problem_eval(p, t, true, &out->values, err));
    MT_TRY(find_blocks(out, near, mem, err));
    MT_TRY(find_rows(out, err));
    MT_TRY(mt_repeated_matrices(out, false, err));
    const int n_eq = mt_problem_rows_eq(p);
    for (int b = 0; b < out->n_blocks; b++) {
        MT_TRY(choose_entries(out, &out->blocks[b], mem, err));
        out->blocks[b].first = n_eq + out->n_rows;
        out->n_rows += out->blocks[b].n_rows;
    }
    out->eq_tol = mt_arena_f64(mem, (size_t)n_eq + (size_t)out->n_rows, 1);
    if (out->eq_tol == NULL) {
        return mt_fail_memory(err);
    }
    double least = 1.0;
    for (int i = 0; i < mt_problem_rows_in(p); i++) {
        least = fmin(least, p->in_tol[i]);
    }
    for (int i = 0; i < n_eq + out->n_rows; i++) {
        out->eq_tol[i] = i < n_eq ? p->eq_tol[i] : 0.5 * least;
    }
    return MT_OK;
}

static mt_status evaluate(void *context, const double *t, bool with_gradient,
                          mt_nlp_values *out, mt_err *err)
{
    mt_repeated *const m = context;
    mt_problem *const p = m->p;
    const mt_nlp_values *const v = &m->values;
    const int n_eq = mt_problem_rows_eq(p);
    const int n_in = mt_problem_rows_in(p);
    const int rows = n_eq + m->n_rows;
    (void)with_gradient; /* the matrices need the vectors anyhow */
    MT_TRY(mt_problem_eval(p, t, true, &m->values, err));
    MT_TRY(mt_repeated_matrices(m, true, err));
    out->f = v->f;
    memcpy(out->df, v->df, (size_t)p->n * sizeof *v->df);
    for (int i = 0; i < n_in; i++) {
        out->in[i] = m->replaced[i] ? 1.0 : v->in[i];
        for (int j = 0; j < p->n; j++) {
            const ptrdiff_t at = i + ((ptrdiff_t)j * n_in);
            out->din[at] = m->replaced[i] ? 0.0 : v->din[at];
        }
    }
    for (int j = 0; j < p->n; j++) {
        memcpy(out->deq + ((ptrdiff_t)j * rows), v->deq + ((ptrdiff_t)j * n_eq),
               (size_t)n_eq * sizeof *v->deq);
    }
    memcpy(out->eq, v->eq, (size_t)n_eq * sizeof *v->eq);
    for (int k = 0; k < m->n_blocks; k++) {
        const mt_repeated_block *const b = &m->blocks[k];
        for (int i = 0; i < b->n_rows; i++) {
            const int e = b->entry[i];
            const double factor = e / b->r == e % b->r ? 1.0 : sqrt(2.0);
            out->eq[b->first + i] = factor * b->b[e];
            for (int j = 0; j < p->n; j++) {
                out->deq[b->first + i + ((ptrdiff_t)j * rows)] =
                    factor * b->g[e + ((ptrdiff_t)j * b->r * b->r)];
            }
        }
    }
    return MT_OK;
}

mt_nlp mt_repeated_nlp(mt_repeated *m)
{
    mt_nlp nlp = mt_problem_nlp(m->p);
    nlp.n_eq += m->n_rows;
    nlp.eq_tol = m->eq_tol;
    nlp.eval = evaluate;
    nlp.context = m;
    nlp.hint = NULL;
    nlp.n_workers = 1;
    nlp.contexts = NULL;
    return nlp;
}
