/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Rows, constraint Jacobian A and geometric stiffness carry their derivative in complex
 * arithmetic (cx.h) at the moving position.
 */
#include "mechanics/tangent.h"

#include <math.h>
#include <string.h>

static bool all_zero(size_t n, const double *x)
{
    for (size_t i = 0; i < n; i++) {
        if (!(x[i] == 0.0)) {
            return false;
        }
    }
    return true;
}

static mt_status tangent_rows(mt_linear *lin, const mt_pose *poses, mt_linear_tangent *t,
                              mt_err *err)
{
    for (int kind = 0; kind < MT_TERM_KINDS; kind++) {
        const mt_term_list *const list = &lin->list[kind];
        const size_t size = (size_t)list->n_rows * MT_LOCAL;
        const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
        mt_cx *const rows = mt_arena_alloc(&lin->scratch, size, sizeof *rows);
        double *const real = mt_arena_f64(&lin->scratch, size, 1);
        MT_TRY(mt_arena_check(&lin->scratch, err));
        mt_rows_eval(&lin->dual, (mt_term_kind)kind, list, poses, rows);
        for (size_t i = 0; i < size; i++) {
            real[i] = cx_derivative(rows[i]);
        }
        mt_rows_over_states(lin->sys, list, real, &lin->geometry->mem, &t->rows[kind]);
        MT_TRY(mt_arena_check(&lin->geometry->mem, err));
        t->moves = t->moves || t->rows[kind].start[list->n_rows] > 0;
        mt_arena_rewind(&lin->scratch, mark);
    }
    return MT_OK;
}

/* c' of the input itself and of the motion d that it causes: c' = (c' - A d) + A d. */
static void closing(const mt_linear *lin, const mt_lagrangian *l, mt_linear_tangent *t)
{
    double squares = 0.0;
    for (int j = 0; j < lin->sys->nq; j++) {
        const double part = lin->position.d_pose[j] / lin->e.dc[j];
        squares += part * part;
    }
    t->motion = sqrt(squares);
    t->terms = 0.0;
    for (ptrdiff_t i = 0; i < lin->m; i++) {
        double moved = 0.0;
        double sizes = 0.0;
        for (ptrdiff_t j = 0; j < lin->sys->nq; j++) {
            const double term = lin->a[i + (j * lin->m)] * lin->position.d_pose[j];
            moved += term;
            sizes += fabs(term);
        }
        t->c[i] = l->c[i];
        t->terms = fmax(t->terms, lin->e.dr[i] * (sizes + fabs(t->c[i] - moved)));
    }
}

static mt_status tangent_constraints(mt_linear *lin, const mt_placement *at,
                                     mt_linear_tangent *t, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const ptrdiff_t nq = sys->nq;
    const int all = sys->n_constraints;
    const mt_stage *const equilibrium = &lin->position.equilibrium;
    const bool loaded = equilibrium->active;
    mt_lagrangian l;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    MT_TRY(mt_lagrangian_init(&l, sys, loaded, &lin->scratch, err));
    mt_cx *const lambda =
        mt_arena_alloc(&lin->geometry->mem, loaded ? (size_t)all : 0, sizeof *lambda);
    t->a = mt_arena_f64(&lin->geometry->mem, (size_t)lin->m, (size_t)nq);
    t->c = mt_arena_f64(&lin->geometry->mem, (size_t)lin->m, 1);
    t->moved = mt_arena_f64(&lin->geometry->mem, (size_t)nq, 1);
    t->kg = loaded ? mt_arena_f64(&lin->geometry->mem, (size_t)nq, (size_t)nq) : NULL;
    MT_TRY(mt_arena_check(&lin->scratch, err));
    MT_TRY(mt_arena_check(&lin->geometry->mem, err));
    for (int i = 0; i < all && loaded; i++) {
        lambda[i] = cx_make(equilibrium->lambda[i], equilibrium->d_lambda[i]);
    }
    l.slope = true;
    l.trim_force = equilibrium->trim_force;
    l.trim_force_derivative = equilibrium->d_trim_force;
    mt_lagrangian_eval(&lin->dual, MT_ENERGY_PHYSICAL, lin->position.drawn, at, all,
                       loaded ? lambda : NULL,
                       loaded ? MT_CURVATURE_GEOMETRIC : MT_CURVATURE_NONE, &l);
    for (ptrdiff_t j = 0; j < nq; j++) {
        for (ptrdiff_t i = 0; i < lin->m; i++) {
            t->a[i + (j * lin->m)] = l.a[i + (j * all)];
        }
    }
    memcpy(t->moved, lin->position.d_pose, (size_t)nq * sizeof *t->moved);
    closing(lin, &l, t);
    t->moves = t->moves || !all_zero((size_t)lin->m * (size_t)nq, t->a);
    if (loaded) {
        memcpy(t->kg, l.h, (size_t)(nq * nq) * sizeof *t->kg);
        t->lambda = lambda;
        t->pose = at->pose;
    }
    t->moves = t->moves || (loaded && !all_zero((size_t)(nq * nq), t->kg));
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

static mt_status make_tangent(mt_linear *lin, int p, mt_placement *at, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    mt_arena *const mem = &lin->geometry->mem;
    lin->dual.input = p;
    if (lin->position.equilibrium.active || at->pose == NULL) {
        at->pose = mt_arena_alloc(mem, (size_t)sys->n_bodies, sizeof *at->pose);
        MT_TRY(mt_arena_check(mem, err));
    }
    MT_TRY(mt_position_tangent(&lin->position, &lin->dual, &lin->scratch, err));
    mt_poses_tangent(sys, lin->position.at.pose, lin->position.d_pose, at->pose);
    MT_TRY(tangent_rows(lin, at->pose, &lin->tangent[p], err));
    return tangent_constraints(lin, at, &lin->tangent[p], err);
}

/* From so many inputs on that act through forces alone, a slope takes less without their
 * tangents: what it needs instead costs as much as one of them. */
enum { ADJOINT_INPUTS = 2 };
/* Inputs in a word of a set of the program. */
enum { SET_WORD = 64 };

/* The inputs of `moves` that act through forces alone. */
static void find_forced(mt_linear *lin, const uint64_t *moves)
{
    const size_t size = (size_t)lin->stages.words * sizeof *lin->forced;
    int count = 0;
    memset(lin->forced, 0, size);
    for (int p = lin->first_input; p < lin->sys->n_inputs && lin->kg != NULL; p++) {
        if (mt_stages_has(moves, p) && !mt_stages_has(lin->sys->places, p)) {
            lin->forced[p / SET_WORD] |= (uint64_t)1 << (unsigned)(p % SET_WORD);
            count++;
        }
    }
    lin->by_adjoint = count >= ADJOINT_INPUTS;
    lin->due = lin->by_adjoint;
    if (!lin->by_adjoint) {
        memset(lin->forced, 0, size);
    }
}

mt_status mt_tangent_update(mt_linear *lin, const uint64_t *moves, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    mt_arena *const mem = &lin->geometry->mem;
    mt_placement at = lin->position.at;
    lin->tangent = mt_arena_alloc(mem, (size_t)sys->n_inputs, sizeof *lin->tangent);
    lin->sections = NULL;
    MT_TRY(mt_arena_check(mem, err));
    find_forced(lin, moves);
    at.pose = NULL;
    for (int p = lin->first_input; p < sys->n_inputs; p++) {
        if (mt_stages_has(moves, p) && !mt_stages_has(lin->forced, p)) {
            MT_TRY(make_tangent(lin, p, &at, err));
        }
    }
    return MT_OK;
}

mt_status mt_tangent_complete(mt_linear *lin, mt_err *err)
{
    mt_placement at = lin->position.at;
    at.pose = NULL;
    for (int p = 0; p < lin->sys->n_inputs && lin->tangent != NULL && lin->due; p++) {
        if (mt_stages_has(lin->forced, p)) {
            MT_TRY(make_tangent(lin, p, &at, err));
        }
    }
    lin->due = false;
    return MT_OK;
}
