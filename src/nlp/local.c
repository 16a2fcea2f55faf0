/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One local search, in two halves. The approach is of first order and comes to within about
 * 1e-5 of where it leads:
 *
 *     roots by least squares         where the equalities leave no freedom
 *     least squares                  where there are residuals and bounds only
 *     SLSQP, or a restoration        otherwise
 *
 * The second half is Newton's, with Hessians by differences: full accuracy, and the sign of the
 * curvature. A saddle is left along its direction, and the approach is made again from there.
 * An infeasible end is a local minimum of the squares of the violations.
 */
#include "nlp/local.h"

#include <math.h>
#include <string.h>

#include "nlp/kkt.h"
#include "nlp/lsq.h"
#include "nlp/near_null_directions.h"
#include "nlp/polish.h"
#include "nlp/slsqp.h"

enum { ROUNDS = 3 };
/* KKT residuals below this are local solutions. */
static const double STATIONARY = 1e-6;
/* Length of the first step away from a saddle. */
static const double SADDLE_STEP = 0.05;
/* Rows and those that follow from them are one within this: there rows have no slopes of their
 * own, and Newton's method comes to rest by chance only. */
static const double TOGETHER = 1e-4;
/* A smaller gain of a round, relative to the objective, is what tolerances buy. */
static const double GAIN = 1e-5;
/* Violation (in tolerances) below which an end is worth a Newton polish before a
 * restoration. */
static const double NEARLY = 1e4;
/* ... before anything more, where a compromise is of no use. */
static const double WORTH = 100.0;

bool mt_nlp_nearly_feasible(const mt_nlp_point *p)
{
    return p->violation <= NEARLY;
}

mt_nlp_local mt_nlp_local_new(const mt_nlp_engine *e, mt_arena *mem)
{
    return (mt_nlp_local){.p = mt_nlp_point_new(e, mem),
                          .last = mt_nlp_point_new(e, mem),
                          .from = mt_arena_f64(mem, (size_t)e->n, 1),
                          .rows = mt_arena_int(mem, (size_t)e->nlp->n_eq),
                          .kkt = HUGE_VAL,
                          .hits = 1};
}

const mt_nlp_point *mt_nlp_local_stand(const mt_nlp_local *s)
{
    return s->stage == MT_NLP_OBJECTIVE && !s->polished && mt_nlp_nearly_feasible(s->last)
               ? s->last
               : s->p;
}

/* True where compromises are not wanted and the end is far from feasible. */
static bool is_given_up(const mt_nlp_engine *e, const mt_nlp_local *s)
{
    return e->opt.no_compromise && !(s->p->violation <= WORTH) &&
           !(s->last->violation <= WORTH);
}

/* SLSQP from p, to close tolerances where Newton's method has failed; an end far from feasible
 * is restored where possible. */
static void descend(mt_nlp_engine *e, bool close, mt_nlp_local *s)
{
    mt_nlp_slsqp(e, s->n_rows, s->rows, close, s->p, s->last);
    s->abandoned = is_given_up(e, s);
    s->restored = !s->abandoned && !mt_nlp_feasible(s->p) && !mt_nlp_nearly_feasible(s->last);
    if (s->restored) {
        mt_nlp_least_squares(e, MT_NLP_SQUARES, s->p);
        mt_nlp_point_copy(e, s->last, s->p);
    }
}

/* Newton from the end of SLSQP, or from the best point met where that is better; an infeasible
 * point is restored first. */
static void newton(mt_nlp_engine *e, mt_nlp_local *s, double *saddle)
{
    mt_nlp_point *const p = s->p;
    memset(saddle, 0, (size_t)e->n * sizeof *saddle);
    if (mt_nlp_nearly_feasible(s->last)) {
        mt_nlp_polish(e, MT_NLP_OBJECTIVE, s->last, saddle);
        if (mt_nlp_feasible(s->last) && (s->last->kkt <= STATIONARY || !mt_nlp_feasible(p))) {
            mt_nlp_point_copy(e, p, s->last);
            return;
        }
    }
    if (!mt_nlp_feasible(p) && !s->restored) {
        mt_nlp_least_squares(e, MT_NLP_SQUARES, p);
    }
    if (mt_nlp_feasible(p)) {
        mt_nlp_polish(e, MT_NLP_OBJECTIVE, p, saddle);
    }
}

/* Move p a little along `saddle`; false where there is none, or no value there. */
static bool step_off(mt_nlp_engine *e, const double *saddle, mt_nlp_point *p)
{
    const double most = mt_max_abs(e->n, saddle);
    if (!(most > 0.0)) {
        return false;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    mt_nlp_point *const to = mt_nlp_point_new(e, &e->scratch);
    bool moved = false;
    if (mt_nlp_has_room(e, &e->scratch)) {
        mt_nlp_point_copy(e, to, p);
        mt_axpy(e->n, SADDLE_STEP / most, saddle, to->t);
        moved = mt_nlp_evaluate(e, to->t, true, to);
        if (moved) {
            mt_nlp_point_copy(e, p, to);
        }
    }
    mt_arena_rewind(&e->scratch, mark);
    return moved;
}

/* True where rows swap at p, on their limit. */
static bool is_crossing(const mt_nlp_engine *e, const mt_nlp_point *p)
{
    for (int i = 0; i < e->nlp->n_next; i++) {
        const double row = p->in[e->nlp->next_of[i]];
        if (fabs(row) <= TOGETHER && fabs(p->next[i] - row) <= TOGETHER) {
            return true;
        }
    }
    return false;
}

/* From the end of SLSQP: Newton, and SLSQP again while that is no minimum; never makes p
 * worse. */
static void finish_minimum(mt_nlp_engine *e, mt_nlp_local *s)
{
    mt_nlp_point *const before = mt_nlp_point_new(e, &e->scratch);
    double *const saddle = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return;
    }
    for (int round = 0; round < ROUNDS && !e->ended; round++) {
        if (round > 0) {
            descend(e, true, s);
        }
        newton(e, s, saddle);
        if (round > 0 &&
            !mt_nlp_better(s->p, before)) { /* the same again would end there again */
            mt_nlp_point_copy(e, s->p, before);
            return;
        }
        const bool idle = round > 0 && mt_nlp_feasible(before) && s->p->kkt > STATIONARY &&
                          is_crossing(e, s->p) &&
                          s->p->f >= before->f - (GAIN * fabs(before->f));
        mt_nlp_point_copy(e, before, s->p);
        const bool last = round + 1 == ROUNDS || idle || !mt_nlp_feasible(s->p);
        if (last || (!step_off(e, saddle, s->p) && s->p->kkt <= STATIONARY)) {
            return;
        }
    }
    mt_nlp_point_copy(e, s->p, before); /* the search ended on the way */
}

void mt_nlp_minimise(mt_nlp_engine *e, mt_nlp_local *s)
{
    s->stage = MT_NLP_OBJECTIVE;
    descend(e, false, s);
    finish_minimum(e, s);
}

/* Roots of equalities that leave no freedom; where these are dependent, the objective
 * decides. */
static void find_root(mt_nlp_engine *e, mt_nlp_local *s)
{
    mt_nlp_near_null_directions w;
    mt_nlp_least_squares(e, MT_NLP_SQUARES, s->p);
    if (!mt_nlp_feasible(s->p) || e->ended ||
        !mt_nlp_near_null_directions_at(e, s->p, &e->scratch, &w)) {
        return;
    }
    s->curve = w.curve;
    if (w.curve && w.n_rows < e->n_free) {
        s->stage = MT_NLP_OBJECTIVE;
        s->n_rows = w.n_rows;
        memcpy(s->rows, w.rows, (size_t)w.n_rows * sizeof *s->rows);
        descend(e, false, s);
    }
}

static void approach(mt_nlp_engine *e, mt_nlp_local *s)
{
    const mt_nlp *const q = e->nlp;
    for (s->n_rows = 0; s->n_rows < q->n_eq; s->n_rows++) {
        s->rows[s->n_rows] = s->n_rows;
    }
    if (e->impossible) {
        s->stage = MT_NLP_SQUARES;
        mt_nlp_least_squares(e, MT_NLP_SQUARES, s->p);
    } else if (q->n_eq >= e->n_free) {
        s->stage = MT_NLP_SQUARES;
        find_root(e, s);
    } else if (q->n_res > 0 && q->n_eq == 0 && q->n_in == 0) {
        s->stage = MT_NLP_RESIDUALS;
        mt_nlp_least_squares(e, MT_NLP_RESIDUALS, s->p);
    } else {
        s->stage = MT_NLP_OBJECTIVE;
        descend(e, false, s);
    }
}

void mt_nlp_local_approach(mt_nlp_engine *e, mt_nlp_local *s)
{
    approach(e, s);
    s->polished = s->stage == MT_NLP_SQUARES && mt_nlp_feasible(s->p);
    const mt_nlp_point *const at = mt_nlp_local_stand(s);
    /* or it minimises squares by now */
    const bool below = mt_nlp_feasible(at) || at == s->last;
    mt_nlp_active a;
    memcpy(s->from, at->t, (size_t)e->n * sizeof *s->from);
    if (!e->ended && !s->polished &&
        mt_nlp_active_set(e, at, below ? s->stage : MT_NLP_SQUARES, &e->scratch, &a)) {
        s->kkt = a.kkt;
    }
}

void mt_nlp_local_finish(mt_nlp_engine *e, mt_nlp_local *s)
{
    mt_nlp_point *const before = mt_nlp_point_new(e, &e->scratch);
    double *const saddle = mt_arena_f64(&e->scratch, (size_t)e->n, 1);
    const bool room = mt_nlp_has_room(e, &e->scratch);
    for (int round = 0; room && !s->abandoned && round < ROUNDS; round++) {
        if (round > 0) {
            approach(e, s);
        }
        if (s->abandoned) {
            break;
        }
        if (s->stage == MT_NLP_OBJECTIVE) {
            finish_minimum(e, s);
        } else if (s->stage == MT_NLP_RESIDUALS) {
            mt_nlp_polish(e, MT_NLP_RESIDUALS, s->p, NULL);
        }
        if (!mt_nlp_feasible(s->p)) {
            mt_nlp_polish(e, MT_NLP_SQUARES, s->p, saddle);
        }
        if (round > 0 && mt_nlp_better(before, s->p)) {
            mt_nlp_point_copy(e, s->p, before);
        }
        mt_nlp_point_copy(e, before, s->p);
        const bool last = round + 1 == ROUNDS || mt_nlp_feasible(s->p) || e->ended;
        if (last || !step_off(e, saddle, s->p)) {
            break;
        }
    }
    s->polished = true;
}
