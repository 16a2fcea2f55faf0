/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/names.h"

#include <math.h>

#include "base/format.h"

/* Entries of a left null vector (largest 1) above this belong to the dependent set. */
static const double IN_THE_SET = 1e-6;

mt_status mt_name_joints(const mt_system *sys, int m, const double *w, mt_arena *mem,
                         mt_joint_names *out, mt_err *err)
{
    const double least = IN_THE_SET * mt_max_abs(m, w);
    const char **const name = mt_arena_alloc(mem, (size_t)m, sizeof *name);
    const char *text = "";
    int n = 0;
    for (int i = 0; i < m && name != NULL; i++) {
        const int joint = sys->constraints[i].joint;
        const char *const of = joint >= 0 ? sys->joints[joint].name : NULL;
        bool in = joint >= 0 && fabs(w[i]) > least;
        for (int k = 0; k < n && in; k++) {
            in = name[k] != of;
        }
        if (in) {
            text = mt_arena_printf(mem, "%s%s\"%s\"", text, n == 0 ? "" : ", ", of);
            name[n++] = of;
        }
    }
    *out = (mt_joint_names){.n = n, .name = name, .text = text};
    return mt_arena_check(mem, err);
}

/* Freedoms that move more than this fraction of the largest motion are named. */
static const double NAMED = 0.3;

void mt_name_motion(const mt_system *sys, const mt_elimination *e, const double *y, char *text,
                    size_t size)
{
    static const char *const MOTION[6] = {"along x",          "along y",
                                          "along z",          "rotation about x",
                                          "rotation about y", "rotation about z"};
    double largest = 0.0;
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < 12 * sys->n_bodies; i++) { /* all bodies for the largest, then again */
        const int b = i % (6 * sys->n_bodies) / 6;
        const int k = i % 6;
        const int dof = sys->bodies[b].dof[k];
        double s = 0.0;
        for (int c = 0; c < e->n && dof >= 0; c++) {
            s += e->z[dof + ((ptrdiff_t)c * e->nq)] * y[c];
        }
        s = fabs(s) * (k < 3 ? 1.0 : sys->length_m);
        if (i < 6 * sys->n_bodies) {
            largest = fmax(largest, s);
        } else if (s > NAMED * largest && used < size) {
            const char *const motion = sys->dimension == 2 && k == 5 ? "rotation" : MOTION[k];
            const int n = mt_snprintf(text + used, size - used, "%s\"%s\" (%s)",
                                      used == 0 ? "" : ", ", sys->bodies[b].name, motion);
            used += n > 0 ? (size_t)n : 0;
        }
    }
}
