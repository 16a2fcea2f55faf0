/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where modes repeat: which rows that concerns, the smooth problem that keeps them together,
 * and the search from there. */
#include "search/search_repeated_eigenvalues.h"

#include <math.h>
#include <string.h>

#include "nlp/cone.h"
#include "nlp/merit.h"
#include "problem/evaluate.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"
#include "search/search.h"

/* Which rows of a problem are limits on single modes: of goals, of bands with their assignment,
 * and of both at corners of the tolerances. */

typedef struct listing {
    const mt_workspace *ws;
    mt_repeated_eigenvalues_side *items;
    int n;
} listing;

/* Vibration mode `mode` of the analysis; nothing where there is none, or no limit. */
static void add_mode_side(listing *l, const mt_repeated_eigenvalues_side *what, int mode)
{
    mt_repeated_eigenvalues_side s = *what;
    if (s.analysis->modes.n_unstable == 0 && s.limit_hz > 0.0) {
        s.pos = mt_modal_flexible(&s.analysis->modes, mode);
        if (s.pos >= 0) {
            l->items[l->n++] = s;
        }
    }
}

/* The analysis that a row is evaluated with. */
static mt_repeated_eigenvalues_side side_of(const mt_workspace *ws, const mt_row *row, int at)
{
    const mt_configuration_work *const view = &ws->views[row->view];
    mt_repeated_eigenvalues_side s = {.analysis = view->analysis,
                                      .limit_hz = row->limit,
                                      .sign = mt_row_sign(row),
                                      .moves = row->avoidance >= 0 && ws->c->clearance,
                                      .row = at};
    if (row->corner >= 0) {
        s.analysis = view->corners[row->corner];
        s.factor = ws->c->tolerance_box->views[row->view].corners[row->corner].factor;
    }
    return s;
}

/* True where a row limits the frequency of a mode by its index. */
static bool limits_mode(const mt_subproblem *c, const mt_row *row)
{
    return row->avoidance >= 0 ||
           (row->requirement >= 0 && row->kind != MT_ROW_POSITION &&
            mt_requirement_is_frequency(&c->requirements[row->requirement]));
}

/* A target is a limit on both sides. */
static void add_row(listing *l, const mt_row *row, int at)
{
    if (limits_mode(l->ws->c, row)) {
        mt_repeated_eigenvalues_side s = side_of(l->ws, row, at);
        add_mode_side(l, &s, row->mode);
        if (row->sense == MT_EQUAL) {
            s.sign = -s.sign;
            add_mode_side(l, &s, row->mode);
        }
    }
}

/* All such rows at the problem's last evaluation. In mem. Fails:
 * MT_E_MEMORY. */
static mt_status repeated_eigenvalues_sides(mt_workspace *ws, mt_arena *mem,
                                            mt_repeated_eigenvalues_side **out, int *n,
                                            mt_err *err)
{
    const mt_row_table *const rows = &ws->c->rows;
    const size_t most = (2 * (size_t)rows->eq.n) + (size_t)rows->in.n;
    listing l = {.ws = ws, .items = mt_arena_alloc(mem, most, sizeof *l.items)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < rows->eq.n; i++) {
        add_row(&l, &rows->eq.rows[i], i);
    }
    for (int i = 0; i < rows->in.n; i++) {
        add_row(&l, &rows->in.rows[i], rows->eq.n + i);
    }
    *out = l.items;
    *n = l.n;
    return MT_OK;
}

/* sign ln(f / limit) of the mode at pos, at the last evaluation. */
static double repeated_eigenvalues_margin(const mt_workspace *ws,
                                          const mt_repeated_eigenvalues_side *s, int pos)
{
    const double z = s->moves ? ws->t[ws->p->n] : 0.0;
    return (s->sign * log(mt_modal_hz(&s->analysis->modes, pos) / s->limit_hz)) - z;
}

/* The smooth problem that keeps modes together. */

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
           fabs(repeated_eigenvalues_margin(ws, s, s->pos + r * step)) <= near) {
        r++;
    }
    const int before = s->pos - step;
    const bool apart =
        !vibrates(&a->modes, before) || fabs(repeated_eigenvalues_margin(ws, s, before)) > near;
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
    MT_TRY(repeated_eigenvalues_sides(ws, mem, &sides, &n, err));
    out->blocks = mt_arena_alloc(mem, (size_t)n, sizeof *out->blocks);
    out->replaced = mt_arena_alloc(mem, (size_t)ws->c->rows.eq.n + (size_t)ws->c->rows.in.n,
                                   sizeof *out->replaced);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(find_blocks(out, sides, n, near, mem, err));
    find_rows(out, sides, n);
    MT_TRY(matrices(out, false, err));
    return number_rows(out, mem, err);
}

/* True where a and b, of one problem at one design, have the same modes at the same limits. */
static bool repeated_eigenvalues_same(const mt_repeated_eigenvalues *a,
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

/*
 * Ends of a search where modes repeat. Single modes have no slopes there: the search's own
 * methods stall, and its KKT residual says nothing. So every end with a residual is taken on:
 * the smooth problem that keeps the modes together is solved from
 * there, and stationarity is that of the cluster (cone.h). Where it is none, the residual is a
 * way down: a step along it, and the search from there. Until nothing improves.
 */

/* Evaluations kept for the values of what a solve finds, and for the last judgement. */
enum { RESERVED = 2 };
enum { ROUNDS = 10, SOLVE_EVALUATIONS = 600, STEPS = 5 };
/* Modes within this of a limit are tried as one cluster, the widest first. */
static const double NEAR[] = {2e-2, 3e-3, 3e-4};
/* ... and within this they are one where stationarity is judged: the search leaves them about
 * so far apart. */
static const double TOGETHER = 1e-5;
/* The smooth problem is trusted so far from where its cluster was taken (t is a logarithm). */
static const double BOX = 0.2;
/* First step along the residual, and what it is multiplied with where that was too far. */
static const double STEP = 0.05;
static const double SHORTER = 0.3;
/* A smaller gain, relative to the objective, is none. */
static const double GAIN = 1e-8;
/* A design that uses the tolerances of its requirements (a relative 1e-6) is lighter by about
 * so much than one that meets them exactly. */
static const double TOLERANCES_BUY = 1e-5;
/* An end with a residual above this is not shown to be a local optimum, and not listed behind a
 * better one. */
static const double NOT_SHOWN = 1e-4;
/* As in the search itself: on a bound; an active row. */
static const double ON_BOUND = 1e-8;
static const double ACTIVE = 1e-6;
static const double ACTIVE_TOLS = 10;

typedef struct refine {
    mt_workspace *ws;
    mt_arena *mem;
    long evals;
    long most;
    mt_stop stop;
} refine;

/* True where `more` evaluations would exceed the budget. */
static bool spent(const refine *w, long more)
{
    return w->evals + more > w->most;
}

/* Solve nlp from t, near it; a feasible design of the study: into t, f. */
static mt_status try_solve(refine *w, mt_nlp *nlp, double box, double *t, double *f,
                           bool *found, mt_err *err)
{
    mt_workspace *const ws = w->ws;
    const mt_arena_mark mark = mt_arena_get_mark(w->mem);
    double *const lower = mt_arena_f64(w->mem, (size_t)ws->c->n_t, 1);
    double *const upper = mt_arena_f64(w->mem, (size_t)ws->c->n_t, 1);
    mt_nlp_options opt = mt_nlp_options_default();
    mt_nlp_result end = {0};
    mt_nlp_values v;
    mt_err own = {0};
    const long left = w->most - w->evals - RESERVED;
    *found = false;
    MT_TRY(mt_arena_check(w->mem, err));
    if (left <= 0) {
        return MT_OK;
    }
    for (int j = 0; j < ws->c->n_t; j++) {
        lower[j] = fmax(ws->c->lower_t[j], t[j] - box);
        upper[j] = fmin(ws->c->upper_t[j], t[j] + box);
    }
    nlp->lower = lower;
    nlp->upper = upper;
    nlp->origin = t;
    opt.starts = 1;
    opt.max_solutions = 1;
    opt.least_change = false;
    opt.max_evals = left < SOLVE_EVALUATIONS ? left : SOLVE_EVALUATIONS;
    mt_status rc = mt_workspace_solve(ws, nlp, &opt, w->mem, &end, &own);
    w->evals += end.evals;
    w->stop = end.stop == MT_STOP_USER ? MT_STOP_USER : w->stop;
    const bool is = rc == MT_OK && end.n_solutions > 0 && !end.compromise;
    rc = is ? mt_subproblem_values_init(ws->c, w->mem, &v, &own) : rc;
    rc = is && rc == MT_OK ? mt_workspace_eval(ws, end.solutions[0].t, false, &v, &own) : rc;
    if (is && rc == MT_OK) {
        w->evals++;
        const mt_missed m = mt_subproblem_missed(ws->c, &v);
        if (mt_is_held(m.violation)) {
            memcpy(t, end.solutions[0].t, (size_t)ws->c->n_t * sizeof *t);
            *f = v.f;
            *found = true;
        }
    }
    mt_arena_rewind(w->mem, mark);
    const bool fatal = mt_is_final(rc) || rc == MT_E_USAGE;
    return fatal ? mt_fail(err, rc, "%s", own.text) : MT_OK;
}

/* True where f is a gain; then the design goes into s. */
static bool take_better(const refine *w, const double *t, double f, mt_nlp_solution *s)
{
    const bool better = f < s->f - GAIN * fabs(s->f);
    if (better) {
        memcpy(s->t, t, (size_t)w->ws->c->n_t * sizeof *t);
        s->f = f;
    }
    return better;
}

/* Solves the smooth problem of the clusters near t, from t, unless they are those of `before`
 * (may be NULL); m: the clusters. */
static mt_status keep_together(refine *w, double near, const mt_repeated_eigenvalues *before,
                               mt_repeated_eigenvalues *m, double *t, double *f, bool *found,
                               mt_err *err)
{
    *found = false;
    MT_TRY(mt_repeated_eigenvalues_find(w->ws, t, near, w->mem, m, err));
    w->evals++;
    if (m->n_blocks == 0 || m->n_rows == 0 ||
        (before != NULL && repeated_eigenvalues_same(before, m))) {
        return MT_OK;
    }
    mt_nlp nlp = mt_repeated_eigenvalues_nlp(m);
    return try_solve(w, &nlp, BOX, t, f, found, err);
}

/* Rows of the balance of gradients: equalities, active inequalities that no block stands for,
 * active bounds. which[row]: i < n_eq an equality, then inequalities, then variables. */
static int balance_rows(const mt_repeated_eigenvalues *m, const double *t, double *rows,
                        bool *free_sign, int *which)
{
    const mt_workspace *const ws = m->ws;
    const mt_nlp_values *const v = &m->values;
    const int n = ws->c->n_t;
    const int n_eq = ws->c->rows.eq.n;
    const int n_in = ws->c->rows.in.n;
    int k = 0;
    for (int i = 0; i < n_eq + n_in; i++) {
        const int in = i - n_eq;
        const bool active =
            !m->replaced[i] &&
            (in < 0 || v->in[in] <= fmax(ACTIVE, ACTIVE_TOLS * ws->c->rows.in.tol[in]));
        for (int j = 0; j < n && active; j++) {
            rows[j + ((ptrdiff_t)k * n)] =
                in < 0 ? v->deq[i + ((ptrdiff_t)j * n_eq)] : v->din[in + ((ptrdiff_t)j * n_in)];
        }
        if (active) {
            free_sign[k] = in < 0;
            which[k++] = i;
        }
    }
    for (int j = 0; j < n; j++) {
        const double near = ON_BOUND * (ws->c->upper_t[j] - ws->c->lower_t[j]);
        const bool fixed = !(ws->c->lower_t[j] < ws->c->upper_t[j]);
        const int side = t[j] <= ws->c->lower_t[j] + near   ? 1
                         : t[j] >= ws->c->upper_t[j] - near ? -1
                                                            : 0;
        if (side != 0 || fixed) {
            memset(rows + ((ptrdiff_t)k * n), 0, (size_t)n * sizeof *rows);
            rows[j + ((ptrdiff_t)k * n)] = fixed ? 1.0 : side;
            free_sign[k] = fixed;
            which[k++] = n_eq + n_in + j;
        }
    }
    return k;
}

/* Writes the multipliers of the balance. Of modes held together only the defining one has a
 * multiplier, the trace of U: all can be relaxed with it; where several rows limit them they
 * have none. */
static void put_multipliers(const mt_repeated_eigenvalues *m, const mt_cone *c,
                            const int *which, mt_nlp_solution *s)
{
    const int n_eq = m->ws->c->rows.eq.n;
    const int n_in = m->ws->c->rows.in.n;
    memset(s->mult_bound, 0, (size_t)m->ws->c->n_t * sizeof *s->mult_bound);
    for (int i = 0; i < n_eq + n_in; i++) {
        double *const mult = i < n_eq ? &s->mult_eq[i] : &s->mult_in[i - n_eq];
        *mult = m->replaced[i] ? nan("") : 0.0;
    }
    for (int k = 0; k < c->n_rows; k++) {
        const int i = which[k];
        if (i < n_eq) {
            s->mult_eq[i] = c->x[k];
        } else if (i < n_eq + n_in) {
            s->mult_in[i - n_eq] = c->x[k];
        } else {
            const int j = i - n_eq - n_in;
            s->mult_bound[j] = c->x[k] * c->rows[j + ((ptrdiff_t)k * m->ws->c->n_t)];
        }
    }
    int at = 0; /* in the cone, which has two blocks where both sides hold */
    for (int b = 0; b < m->n_blocks && at < c->n_blocks; b++) {
        const mt_repeated_eigenvalues_block *const block = &m->blocks[b];
        const double *const u = c->blocks[at].u;
        const int row = block->row_most;
        double trace = 0.0;
        for (int k = 0; k < block->r; k++) {
            trace += u[k + (k * block->r)];
        }
        at += block->both ? 2 : 1;
        if (row >= n_eq) {
            s->mult_in[row - n_eq] = trace;
        } else if (row >= 0) {
            s->mult_eq[row] = trace * block->side.sign;
        }
    }
}

/* The clusters' matrices; where both sides hold, once more with the other sign. */
static mt_status cone_blocks(const mt_repeated_eigenvalues *m, mt_arena *mem,
                             mt_cone_block **out, int *n, mt_err *err)
{
    mt_cone_block *const list =
        mt_arena_alloc(mem, 2 * (size_t)m->n_blocks, sizeof(mt_cone_block));
    *n = 0;
    for (int b = 0; b < m->n_blocks && list != NULL; b++) {
        const mt_repeated_eigenvalues_block *const block = &m->blocks[b];
        const size_t r = (size_t)block->r;
        const int size = block->r * block->r * m->ws->c->n_t;
        for (int side = 0; side < (block->both ? 2 : 1); side++) {
            double *const g = mt_arena_f64(mem, (size_t)size, 1);
            double *const u = mt_arena_f64(mem, r, r);
            MT_TRY(mt_arena_check(mem, err));
            mt_axpy(size, side == 0 ? 1.0 : -1.0, block->g, g);
            list[(*n)++] = (mt_cone_block){.r = block->r, .g = g, .u = u};
        }
    }
    *out = list;
    return mt_arena_check(mem, err);
}

/* Stationarity at t in terms of clusters: *kkt, z[n], and the multipliers (s may be NULL). */
static mt_status evaluate_cluster_kkt(refine *w, const double *t, double *kkt, double *z,
                                      mt_nlp_solution *s, mt_err *err)
{
    mt_workspace *const ws = w->ws;
    const mt_arena_mark mark = mt_arena_get_mark(w->mem);
    mt_repeated_eigenvalues m;
    MT_TRY(mt_repeated_eigenvalues_find(ws, t, TOGETHER, w->mem, &m, err));
    w->evals++;
    const size_t n = (size_t)ws->c->n_t;
    const size_t most = (size_t)ws->c->rows.eq.n + (size_t)ws->c->rows.in.n + n;
    double *const rows = mt_arena_f64(w->mem, n, most);
    bool *const free_sign = mt_arena_alloc(w->mem, most, sizeof *free_sign);
    int *const which = mt_arena_int(w->mem, most);
    mt_cone_block *blocks = NULL;
    mt_cone c = {.n = ws->c->n_t,
                 .gradient = m.values.df,
                 .rows = rows,
                 .free_sign = free_sign,
                 .x = mt_arena_f64(w->mem, most, 1)};
    c.z = z;
    MT_TRY(mt_arena_check(w->mem, err));
    MT_TRY(cone_blocks(&m, w->mem, &blocks, &c.n_blocks, err));
    c.blocks = blocks;
    c.n_rows = balance_rows(&m, t, rows, free_sign, which);
    MT_TRY(mt_cone_residual(&c, w->mem, err));
    *kkt = c.kkt;
    if (s != NULL) {
        put_multipliers(&m, &c, which, s);
    }
    mt_arena_rewind(w->mem, mark);
    return MT_OK;
}

/* A step down along -z, and the search from there: a better design into s. */
static mt_status step_down(refine *w, const double *z, mt_nlp_solution *s, bool *better,
                           mt_err *err)
{
    mt_workspace *const ws = w->ws;
    double *const from = mt_arena_f64(w->mem, (size_t)ws->c->n_t, 1);
    const double size = mt_max_abs(ws->c->n_t, z);
    *better = false;
    MT_TRY(mt_arena_check(w->mem, err));
    double step = STEP;
    for (int k = 0; k < STEPS && !*better && size > 0.0 && w->stop == MT_STOP_DONE; k++) {
        for (int j = 0; j < ws->c->n_t; j++) {
            const double to = s->t[j] - (step * z[j] / size);
            from[j] = fmin(fmax(to, ws->c->lower_t[j]), ws->c->upper_t[j]);
        }
        mt_nlp nlp = mt_workspace_nlp(ws);
        nlp.hint = NULL;
        double f = s->f;
        bool found = false;
        MT_TRY(try_solve(w, &nlp, HUGE_VAL, from, &f, &found, err));
        *better = found && take_better(w, from, f, s);
        step *= SHORTER;
    }
    return MT_OK;
}

/* The same design exactly, if that is nearer to a stationary one: into s, kkt, z. */
static mt_status evaluate_exact_clusters(refine *w, const double *t, double f, double *kkt,
                                         double *z, mt_nlp_solution *s, mt_err *err)
{
    const size_t n = (size_t)w->ws->c->n_t;
    double *const z_after = mt_arena_f64(w->mem, n, 1);
    double after = *kkt;
    MT_TRY(mt_arena_check(w->mem, err));
    MT_TRY(evaluate_cluster_kkt(w, t, &after, z_after, NULL, err));
    if (after < *kkt) {
        memcpy(s->t, t, n * sizeof *t);
        memcpy(z, z_after, n * sizeof *z);
        s->f = f;
        *kkt = after;
    }
    return MT_OK;
}

/* The clusters near s kept together, the widest first and none twice, until that is better.
 * Where none is, the local optimum is settled before a step could leave it for another. */
static mt_status hold_clusters(refine *w, double *kkt, double *z, mt_nlp_solution *s,
                               bool *better, mt_err *err)
{
    const size_t n = (size_t)w->ws->c->n_t;
    const mt_arena_mark mark = mt_arena_get_mark(w->mem);
    double *const t = mt_arena_f64(w->mem, n, MT_COUNT(NEAR));
    double f[MT_COUNT(NEAR)] = {0};
    bool found[MT_COUNT(NEAR)] = {false};
    mt_repeated_eigenvalues m[MT_COUNT(NEAR)];
    const double f_from = s->f;
    *better = false;
    MT_TRY(mt_arena_check(w->mem, err));
    for (int k = 0; k < MT_COUNT(NEAR) && !*better && !spent(w, 1 + RESERVED); k++) {
        double *const at = t + ((size_t)k * n);
        memcpy(at, s->t, n * sizeof *at);
        MT_TRY(keep_together(w, NEAR[k], k > 0 ? &m[k - 1] : NULL, &m[k], at, &f[k], &found[k],
                             err));
        *better = found[k] && take_better(w, at, f[k], s);
    }
    for (int k = 0; k < MT_COUNT(NEAR) && !*better && *kkt > MT_STATIONARY; k++) {
        if (found[k] && f[k] < f_from + TOLERANCES_BUY * fabs(f_from) && !spent(w, RESERVED)) {
            MT_TRY(evaluate_exact_clusters(w, t + ((size_t)k * n), f[k], kkt, z, s, err));
        }
    }
    mt_arena_rewind(w->mem, mark);
    return MT_OK;
}

static mt_status refine_one(refine *w, mt_nlp_solution *s, mt_err *err)
{
    if (spent(w, 1)) {
        return MT_OK;
    }
    mt_workspace *const ws = w->ws;
    const mt_arena_mark mark = mt_arena_get_mark(w->mem);
    double *const z = mt_arena_f64(w->mem, (size_t)ws->c->n_t, 1);
    double kkt = s->kkt;
    MT_TRY(mt_arena_check(w->mem, err));
    for (int round = 0; round < ROUNDS && w->stop == MT_STOP_DONE && !spent(w, RESERVED);
         round++) {
        bool better = false;
        MT_TRY(evaluate_cluster_kkt(w, s->t, &kkt, z, NULL, err));
        if (kkt <= MT_STATIONARY) {
            break;
        }
        MT_TRY(hold_clusters(w, &kkt, z, s, &better, err));
        if (!better && kkt > MT_STATIONARY) {
            MT_TRY(step_down(w, z, s, &better, err));
        }
        if (!better) {
            break;
        }
    }
    MT_TRY(evaluate_cluster_kkt(w, s->t, &kkt, z, s, err));
    s->kkt = kkt;
    s->flat = false; /* where modes repeat the curvature of rows says nothing */
    for (int j = 0; j < ws->c->n_t; j++) {
        const double near = ON_BOUND * (ws->c->upper_t[j] - ws->c->lower_t[j]);
        s->bound[j] =
            s->t[j] <= ws->c->lower_t[j] + near ? -1 : s->t[j] >= ws->c->upper_t[j] - near;
    }
    mt_arena_rewind(w->mem, mark);
    return MT_OK;
}

static bool before(const mt_subproblem *c, const mt_nlp_solution *a, const mt_nlp_solution *b)
{
    const mt_merit x = {a->feasible, a->squares, 1, &a->f};
    const mt_merit y = {b->feasible, b->squares, 1, &b->f};
    if (mt_merit_before(&x, &y, MT_EQUAL_FOUND) || mt_merit_before(&y, &x, MT_EQUAL_FOUND)) {
        return mt_merit_before(&x, &y, MT_EQUAL_FOUND);
    }
    return mt_search_nearer(c, a->t, b->t);
}

/* Ranks by objective, joins duplicates, and drops ends not shown to be optimal behind a better
 * design. */
static void rank_and_join_ends(const mt_workspace *ws, mt_nlp_result *out)
{
    int kept = 0;
    for (int i = 1; i < out->n_solutions; i++) {
        const mt_nlp_solution s = out->solutions[i];
        int k = i;
        for (; k > 0 && before(ws->c, &s, &out->solutions[k - 1]); k--) {
            out->solutions[k] = out->solutions[k - 1];
        }
        out->solutions[k] = s;
    }
    for (int i = 0; i < out->n_solutions; i++) {
        const mt_nlp_solution *const s = &out->solutions[i];
        bool drop = i > 0 && s->kkt > NOT_SHOWN;
        for (int k = 0; k < kept && !drop; k++) {
            drop = mt_search_same(ws->p->n, out->solutions[k].t, s->t);
        }
        if (!drop) {
            out->solutions[kept++] = *s;
        }
    }
    out->n_found -= out->n_solutions - kept;
    out->n_solutions = kept;
}

mt_status mt_search_repeated_eigenvalues(mt_workspace *ws, long most, mt_arena *mem,
                                         mt_nlp_result *out, mt_err *err)
{
    refine w = {.ws = ws, .mem = mem, .evals = out->evals, .stop = MT_STOP_DONE};
    bool any = false;
    const bool smooth = out->compromise || out->stop == MT_STOP_USER ||
                        mt_objective_is(ws->c->stages[ws->c->stage].type, MT_RESIDUALS);
    w.most = most > 0 ? most : out->evals + (long)ROUNDS * SOLVE_EVALUATIONS * 8;
    for (int i = 0; i < out->n_solutions && !smooth; i++) {
        if (out->solutions[i].kkt > MT_STATIONARY && out->solutions[i].feasible) {
            any = true;
            const mt_status rc = refine_one(&w, &out->solutions[i], err);
            if (mt_is_final(rc) || rc == MT_E_USAGE) {
                return rc;
            }
        }
    }
    out->evals = w.evals;
    if (any) {
        rank_and_join_ends(ws, out);
    }
    return MT_OK;
}
