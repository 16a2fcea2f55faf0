/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is seen of a tree's shapes: states, and sensors where it is drawn. */
#include "tree/tree_priv.h"

#include "mechanics/lagrangian.h"
#include "mechanics/rows.h"

void mt_tree_states(const mt_tree *t, const double *v, double *phi)
{
    for (int i = 0; i < t->n; i++) {
        const int *const dof = t->sys->bodies[t->body[i]].dof;
        for (int k = 0; k < t->s; k++) {
            const int q = dof[mt_tree_freedom(t, k)];
            if (q >= 0) {
                phi[q] = v[k + ((ptrdiff_t)t->s * i)];
            }
        }
    }
}

mt_status mt_tree_sense(const mt_tree *t, const double *inputs, int n, const double *phi,
                        double *value, mt_arena *scratch, mt_err *err)
{
    const mt_system *const sys = t->sys;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const nodes = mt_arena_f64(scratch, (size_t)sys->program.count, 1);
    mt_pose *const pose = mt_arena_alloc(scratch, (size_t)sys->n_bodies, sizeof *pose);
    mt_data d;
    MT_TRY(mt_data_init(&d, sys, scratch, err));
    MT_TRY(mt_program_eval(&sys->program, inputs, nodes, NULL, err));
    d.value = nodes;
    mt_data_vecs(&d);
    mt_data_drawn(&d, pose);
    for (int i = 0; i < sys->n_channels; i++) {
        const int *const body = sys->channels[i].body;
        const mt_term term = {
            .coefficient = MT_NO_NODE, .count = 1, .body = {body[0], body[1]}, .source = i};
        mt_cx row[MT_LOCAL];
        mt_term_rows(&d, MT_TERM_CHANNEL, &term, pose, row);
        for (int a = 0; a < n; a++) {
            double sum = 0.0;
            for (int k = 0; k < MT_LOCAL; k++) {
                const int q = mt_local_dof(sys, body, k);
                sum += q < 0 ? 0.0 : creal(row[k]) * phi[q + ((ptrdiff_t)sys->nq * a)];
            }
            value[i + ((ptrdiff_t)sys->n_channels * a)] = sum;
        }
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
