/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/displaced.h"

#include "mechanics/linear_priv.h"

#include <string.h>

/* m += c (f g^T + g f^T)/2 over the states of a term's bodies. */
static void add_product(const mt_system *sys, const mt_term *t, double c, const mt_cx *f,
                        const mt_cx *g, double *m)
{
    for (int j = 0; j < MT_LOCAL; j++) {
        const int column = mt_local_dof(sys, t->body, j);
        for (int i = 0; i < MT_LOCAL && column >= 0; i++) {
            const int row = mt_local_dof(sys, t->body, i);
            if (row >= 0) {
                m[row + (ptrdiff_t)column * sys->nq] +=
                    0.5 * c * ((creal(f[i]) * creal(g[j])) + (creal(g[i]) * creal(f[j])));
            }
        }
    }
}

/* m nq x nq, both triangles. */
static mt_status mass_matrix(mt_linear *lin, const mt_pose *poses, double *m, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const mt_term_list *const list = &lin->list[MT_TERM_MASS];
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    mt_cx *const rows =
        mt_arena_alloc(&lin->scratch, (size_t)list->n_rows * MT_LOCAL, sizeof *rows);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    memset(m, 0, (size_t)sys->nq * (size_t)sys->nq * sizeof *m);
    mt_rows_eval(&lin->data, MT_TERM_MASS, list, poses, rows);
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        const double c = lin->value[t->coefficient];
        for (int r = 0; r < (t->pair ? 1 : t->count); r++) {
            const mt_cx *const f = rows + ((ptrdiff_t)(t->first + r) * MT_LOCAL);
            add_product(sys, t, c, f, t->pair ? f + MT_LOCAL : f, m);
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

/* The trimmed spring carries its trim force at the linearised position and its stiffness from
 * there. */
static double trimmed_force(const mt_linear *lin, const mt_placement *at)
{
    const mt_system *const sys = lin->sys;
    if (sys->trim_spring < 0) {
        return 0.0;
    }
    const mt_spring_def *const s = &sys->springs[sys->trim_spring];
    const mt_measure_def *const def = &sys->measures[s->measure[0]];
    const double there = creal(mt_data_value(&lin->data, def, at));
    const double here = creal(mt_data_value(&lin->data, def, &lin->position.at));
    return lin->position.equilibrium.trim_force + (lin->value[s->stiffness] * (there - here));
}

mt_status mt_displaced_eval(mt_linear *lin, const double *dq, double *m, double *q, double *a,
                            double *c, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const ptrdiff_t all = sys->n_constraints;
    mt_lagrangian l;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    mt_placement at;
    MT_TRY(mt_placement_init(&at, sys, &lin->scratch, err));
    MT_TRY(mt_lagrangian_init(&l, sys, false, &lin->scratch, err));
    mt_placement_copy(sys, &lin->position.at, &at);
    if (dq != NULL) {
        mt_poses_move(sys, at.pose, dq);
    }
    l.trim_force = trimmed_force(lin, &at);
    mt_lagrangian_eval(&lin->data, MT_ENERGY_PHYSICAL, lin->position.drawn, &at, (int)all, NULL,
                       MT_CURVATURE_NONE, &l);
    for (ptrdiff_t j = 0; j < sys->nq; j++) {
        q[j] = -l.g[j];
        for (ptrdiff_t i = 0; i < lin->m; i++) {
            a[i + (j * lin->m)] = l.a[i + (j * all)];
        }
    }
    for (ptrdiff_t i = 0; i < lin->m && c != NULL; i++) {
        c[i] = l.c[i];
    }
    MT_TRY(mass_matrix(lin, at.pose, m, err));
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}
