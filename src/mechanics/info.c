/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Mass properties from the kinetic energy of the six rigid-body motions of everything together: with R = [translations, rotations about the origin] over all states,
 *     R^T M R = [ m I     -m [c]x          ]        [c]x v = c x v,
 *               [ m [c]x   J - m [c]x [c]x ]
 * which holds for points, bodies, and consistent bars and beams alike.
 */
#include "mechanics/info.h"

#include <math.h>

#include "mechanics/displaced.h"

enum { MOTIONS = 6 };

/* Motion k of the whole: translation along axis k, or rotation about axis k - 3 through the origin. */
static void rigid_motion(const mt_linear *lin, int k, double *phi)
{
    const mt_system *const sys = lin->sys;
    for (int b = 0; b < sys->n_bodies; b++) {
        const mt_pose *const pose = &lin->position.pose[b];
        for (int i = 0; i < MOTIONS; i++) {
            const int dof = sys->bodies[b].dof[i];
            double v = i == k ? 1.0 : 0.0;
            if (i < 3 && k >= 3 && i != k - 3) { /* e_axis x r */
                const int other = 3 - i - (k - 3);
                const bool cyclic = (k - 3 + 1) % 3 == other;
                v = (cyclic ? 1.0 : -1.0) * creal(pose->x[other]);
            }
            if (dof >= 0) {
                phi[dof] = v;
            }
        }
    }
}

static void from_energy(const double g[MOTIONS][MOTIONS], int dimension, mt_info *out)
{
    static const int PAIR[6][2] = {
        {0, 0},
        {1, 1},
        {2, 2},
        {0, 1},
        {0, 2},
        {1, 2}
    };
    const double m = g[0][0];
    const double per_m = m > 0.0 ? 1.0 / m : 0.0;
    /* a rotation about axis a has the momentum m e_a x c */
    const double c[3] = {per_m * g[5][1], -per_m * g[5][0],
                         dimension == 3 ? per_m * g[4][0] : 0.0};
    out->mass_kg = m;
    const double cc = (c[0] * c[0]) + (c[1] * c[1]) + (c[2] * c[2]);
    for (int k = 0; k < 6; k++) {
        const int i = PAIR[k][0];
        const int j = PAIR[k][1];
        const double steiner = (i == j ? cc : 0.0) - (c[i] * c[j]);
        const bool there = dimension == 3 || k == 2;
        out->inertia_kg_m2[k] = there ? g[3 + i][3 + j] - (m * steiner) : 0.0;
    }
    for (int k = 0; k < 3; k++) {
        out->centre_m[k] = m > 0.0 ? c[k] : nan("");
    }
}

mt_status mt_info_fill(mt_linear *lin, mt_info *out, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const size_t nq = (size_t)sys->nq;
    double g[MOTIONS][MOTIONS] = {{0.0}};
    *out = (mt_info){.states = sys->nq,
                     .equations = lin->m,
                     .freedoms = lin->n,
                     .redundant = mt_linear_redundant(lin),
                     .residual = lin->position.residual,
                     .gap_m = lin->position.gap_m};
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const m = mt_arena_f64(&lin->scratch, nq, nq);
    double *const r = mt_arena_f64(&lin->scratch, nq, MOTIONS);
    double *const mr = mt_arena_f64(&lin->scratch, nq, MOTIONS);
    if (m == NULL || r == NULL || mr == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(mt_mass_matrix(lin, lin->position.pose, m, err));
    for (size_t k = 0; k < MOTIONS; k++) {
        rigid_motion(lin, (int)k, r + (k * nq));
    }
    mt_gemm(false, false, (int)nq, MOTIONS, (int)nq, 1.0, m, (int)nq, r, (int)nq, 0.0, mr,
            (int)nq);
    for (size_t i = 0; i < MOTIONS; i++) {
        for (size_t j = 0; j < MOTIONS; j++) {
            g[i][j] = mt_dot((int)nq, r + (i * nq), mr + (j * nq));
        }
    }
    from_energy((const double(*)[MOTIONS])g, sys->dimension, out);
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}
