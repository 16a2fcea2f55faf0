/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the elimination found, in the user's words: redundant joints, directions named by body. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "mechanics/linear.h"

/* Entries of a left null vector (largest 1) above this belong to the dependent set. */
static const double IN_THE_SET = 1e-6;

int mt_linear_redundant(const mt_linear *lin)
{
    return lin->m - lin->e.qr.rank;
}

mt_status mt_linear_redundant_set(mt_linear *lin, int k, const char **text, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const null = mt_arena_f64(&lin->scratch, (size_t)lin->m, 1);
    char *out = mt_arena_strdup(&lin->geometry, "");
    int last = -1;
    if (null == NULL || out == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(mt_eliminate_left_null(&lin->e, k, null, &lin->scratch, err));
    for (int i = 0; i < lin->m && out != NULL; i++) {
        const int joint = sys->constraints[i].joint;
        if (fabs(null[i]) > IN_THE_SET && joint != last && joint >= 0) {
            out = mt_arena_printf(&lin->geometry, "%s%s\"%s\"", out, out[0] == '\0' ? "" : ", ",
                                  sys->joints[joint].name);
            last = joint;
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    *text = out;
    return out == NULL ? mt_fail_memory(err) : MT_OK;
}

/* Freedoms that move more than this fraction of the largest motion are named. */
static const double NAMED = 0.3;

void mt_position_name_motion(const mt_system *sys, const mt_elimination *e, const double *y,
                             char *text, size_t size)
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
            const int n = snprintf(text + used, size - used, "%s\"%s\" (%s)",
                                   used == 0 ? "" : ", ", sys->bodies[b].name, motion);
            used += n > 0 ? (size_t)n : 0;
        }
    }
}

void mt_linear_name_direction(const mt_linear *lin, const double *y, char *text, size_t size)
{
    mt_position_name_motion(lin->sys, &lin->e, y, text, size);
}
