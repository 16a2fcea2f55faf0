/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Ends of a search where modes repeat. Single modes have no slopes there: the search's own
 * methods stall, and its KKT residual says nothing. So every end with a residual is taken on:
 * the smooth problem that keeps the modes together (repeated_eigenvalues.h) is solved from
 * there, and stationarity is that of the cluster (cone.h). Where it is none, the residual is a
 * way down: a step along it, and the search from there. Until nothing improves.
 */
#include <math.h>
#include <string.h>

#include "nlp/merit.h"
#include "problem/evaluate.h"
#include "search/repeated_eigenvalues.h"
#include "search/search.h"

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
static const double STATIONARY = 1e-6;
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
        (before != NULL && mt_repeated_eigenvalues_same(before, m))) {
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
    for (int k = 0; k < MT_COUNT(NEAR) && !*better && *kkt > STATIONARY; k++) {
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
        if (kkt <= STATIONARY) {
            break;
        }
        MT_TRY(hold_clusters(w, &kkt, z, s, &better, err));
        if (!better && kkt > STATIONARY) {
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
        if (out->solutions[i].kkt > STATIONARY && out->solutions[i].feasible) {
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
