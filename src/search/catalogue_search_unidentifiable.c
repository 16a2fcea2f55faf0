/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Directions that the goals do not settle, where there are catalogues. A catalogue is one where
 * each of its values in turn, all else as it is in the best combination, changes no goal by its
 * tolerance (and no objective but the change, which always asks for the value nearest to the
 * original).
 */
#include <math.h>
#include <string.h>

#include "problem/avoidance.h"
#include "problem/evaluate.h"
#include "problem/objective.h"
#include "problem/tolerance.h"
#include "search/catalogue_search.h"

/* Residuals and objectives carry no tolerance: relative to their size, as elsewhere (nlp.h). */
static const double VALUE_TOL = 1e-6;
/* Evaluations without which the search of a best combination is not begun once more. */
enum { SEARCH_LEAST = 50 };

typedef struct crossing {
    mt_catalogue_search *d;
    mt_nlp_values v;
    int rows;
    double *at; /* [rows] rows in tolerances at the best combination */
    double *now;
    int *below;   /* [2 x bands] assignments at both */
    double *t;    /* [n + 1] */
    mt_status rc; /* what ends the comparison */
    mt_err err;
} crossing;

/* Rows divided by their tolerances at x->t; false where a goal has no value. */
static bool evaluate_crossing_rows(crossing *x, double *rows, int *below)
{
    mt_workspace *const w = x->d->workers[0];
    int n = 0;
    if (x->rc != MT_OK) {
        return false;
    }
    const mt_status rc = mt_workspace_eval(w, x->t, false, &x->v, &x->err);
    bool known = rc == MT_OK;
    x->rc = mt_is_final(rc) ? rc : MT_OK;
    x->d->evals++;
    for (int i = 0; i < w->c->rows.eq.n && known; i++) {
        rows[n++] = x->v.eq[i] / w->c->rows.eq.tol[i];
    }
    for (int i = 0; i < w->c->rows.in.n && known; i++) {
        rows[n++] = x->v.in[i] / w->c->rows.in.tol[i];
    }
    for (int i = 0; i < w->c->rows.res.n && known; i++) {
        rows[n++] = w->r[i] / VALUE_TOL;
    }
    for (int k = 0; k < w->c->n_stages && known; k++) {
        const mt_objective_type type = w->c->stages[k].type;
        const bool counts =
            mt_objective_is(type, MT_AMOUNT) || mt_objective_is(type, MT_SHAKES);
        rows[n++] = counts ? mt_objective_stage_value(w, k, NULL) / VALUE_TOL : 0.0;
    }
    for (int i = 0; i < w->c->n_avoidances && known; i++) {
        const mt_avoidance *const c = &w->c->avoidances[i];
        const mt_modes *const modes = &w->views[c->view].analysis->modes;
        known = MT_HAS(mt_avoidance_find_modes(c, modes, below + c->first));
        rows[n++] = mt_avoidance_margin(w, c) / c->tolerance;
    }
    return known;
}

/* The size that makes an objective's change relative; 1 for the other rows. */
static double size_of(const crossing *x, int row)
{
    const mt_problem *const p = x->d->p;
    const int first = x->d->c->rows.eq.n + x->d->c->rows.in.n + x->d->c->rows.res.n;
    const bool stage = row >= first && row < first + p->n_stages;
    return stage ? fmax(fabs(x->at[row]) * VALUE_TOL, VALUE_TOL) : 1.0;
}

/* Greatest change of any row, in tolerances, over all values of variable i; infinite where a
 * mode placement changes or a value does not exist. */
static double effect_of(crossing *x, int i)
{
    const mt_problem *const p = x->d->p;
    const mt_variable *const v = &p->study->variables[i];
    const double keep = x->t[i];
    double most = 0.0;
    for (int k = 0; k < v->n_catalogue && most < 1.0; k++) {
        x->t[i] = mt_problem_t(p, i, v->catalogue[k]);
        if (!evaluate_crossing_rows(x, x->now, x->below + p->n_bands) ||
            memcmp(x->below, x->below + p->n_bands, (size_t)p->n_bands * sizeof(int)) != 0) {
            most = HUGE_VAL;
        }
        for (int r = 0; r < x->rows && most < 1.0; r++) {
            most = fmax(most, fabs(x->now[r] - x->at[r]) / size_of(x, r));
        }
    }
    x->t[i] = keep;
    return most;
}

static mt_status cross(crossing *x, const mt_nlp_result *continuous, mt_nlp_result *out,
                       mt_err *err)
{
    const mt_problem *const p = x->d->p;
    const size_t n = (size_t)p->n;
    const size_t room = (size_t)x->d->n_listed + (size_t)continuous->n_unidentifiable;
    out->unidentifiable = mt_arena_f64(x->d->mem, n, room);
    out->unidentifiable_effect = mt_arena_f64(x->d->mem, room, 1);
    MT_TRY(mt_arena_check(x->d->mem, err));
    const bool known = evaluate_crossing_rows(x, x->at, x->below);
    for (int k = 0; k < x->d->n_listed && known; k++) {
        const int i = x->d->variable[k];
        const double effect =
            p->study->variables[i].n_catalogue > 1 ? effect_of(x, i) : HUGE_VAL;
        if (effect < 1.0) {
            out->unidentifiable_effect[out->n_unidentifiable] = effect;
            out->unidentifiable[((size_t)out->n_unidentifiable++ * n) + (size_t)i] = 1.0;
        }
    }
    if (x->rc != MT_OK) {
        return mt_fail(err, x->rc, "%s", x->err.text);
    }
    for (int k = 0; k < continuous->n_unidentifiable; k++) {
        memcpy(out->unidentifiable + ((size_t)out->n_unidentifiable * n),
               continuous->unidentifiable + ((size_t)k * n), n * sizeof(double));
        out->unidentifiable_effect[out->n_unidentifiable++] =
            continuous->unidentifiable_effect[k];
    }
    return MT_OK;
}

/* Evaluations that they take at most: every value of each catalogue, and a search. */
static long questions(const mt_catalogue_search *d)
{
    long n = d->mixed ? SEARCH_LEAST : 1;
    for (int k = 0; k < d->n_listed; k++) {
        n += d->p->study->variables[d->variable[k]].n_catalogue;
    }
    return n;
}

mt_status mt_catalogue_search_unidentifiable(mt_catalogue_search *d, const mt_combination *best,
                                             mt_nlp_result *out, mt_err *err)
{
    crossing x = {.d = d};
    const long most = d->c->search.max_evaluations;
    if (most > 0 && most - d->evals < questions(d)) {
        out->stop = out->stop == MT_STOP_USER ? MT_STOP_USER : MT_STOP_MAX_EVALS;
        return MT_OK;
    }
    mt_nlp_result continuous = {0};
    const mt_problem *const p = d->p;
    x.rows =
        d->c->rows.eq.n + d->c->rows.in.n + d->c->rows.res.n + p->n_stages + p->n_avoidances;
    x.at = mt_arena_f64(d->mem, (size_t)x.rows, 1);
    x.now = mt_arena_f64(d->mem, (size_t)x.rows, 1);
    x.below = mt_arena_int(d->mem, 2 * (size_t)p->n_bands + 1);
    x.t = mt_arena_f64(d->mem, (size_t)p->n + 1, 1);
    MT_TRY(mt_arena_check(d->mem, err));
    MT_TRY(mt_subproblem_values_init(d->c, d->mem, &x.v, err));
    memcpy(x.t, best->t, (size_t)p->n * sizeof *x.t);
    if (d->mixed) {
        MT_TRY(mt_catalogue_search_directions(d, best, d->mem, &continuous, err));
        d->evals += continuous.evals;
    }
    MT_TRY(cross(&x, &continuous, out, err));
    out->evals = d->evals;
    return MT_OK;
}
