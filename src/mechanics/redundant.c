/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the elimination found, in the user's words: redundant joints, directions named by
 * body. */
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "mechanics/linear.h"

/* Entries of a left null vector (largest 1) above this belong to the dependent set. */
static const double IN_THE_SET = 1e-6;

/* Is equation i the first of its joint in the combination? */
static bool names_a_joint(const mt_system *sys, const double *w, double least, int i)
{
    const int joint = sys->constraints[i].joint;
    bool first = joint >= 0 && fabs(w[i]) > least;
    for (int k = 0; k < i && first; k++) {
        first = sys->constraints[k].joint != joint || !(fabs(w[k]) > least);
    }
    return first;
}

void mt_joint_names(const mt_system *sys, int m, const double *w, char *text, size_t size)
{
    const double least = IN_THE_SET * mt_max_abs(m, w);
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < m; i++) {
        if (!names_a_joint(sys, w, least, i)) {
            continue;
        }
        const int n = mt_snprintf(text + used, size - used, "%s\"%s\"", used == 0 ? "" : ", ",
                                  sys->joints[sys->constraints[i].joint].name);
        if (n < 0 || (size_t)n >= size - used) {
            text[used] = '\0';
            return;
        }
        used += (size_t)n;
    }
}

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
    if (null == NULL || out == NULL) {
        return mt_fail_memory(err);
    }
    MT_TRY(mt_eliminate_left_null(&lin->e, k, null, &lin->scratch, err));
    for (int i = 0; i < lin->m && out != NULL; i++) {
        if (names_a_joint(sys, null, IN_THE_SET, i)) {
            out = mt_arena_printf(&lin->geometry, "%s%s\"%s\"", out, out[0] == '\0' ? "" : ", ",
                                  sys->joints[sys->constraints[i].joint].name);
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    *text = out;
    return out == NULL ? mt_fail_memory(err) : MT_OK;
}

mt_status mt_linear_nearness(mt_linear *lin, mt_nearness *out, mt_err *err)
{
    return mt_singular_nearness(&lin->data, lin->position.pose, &lin->e, &lin->scratch, out,
                                err);
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
            const int n = mt_snprintf(text + used, size - used, "%s\"%s\" (%s)",
                                      used == 0 ? "" : ", ", sys->bodies[b].name, motion);
            used += n > 0 ? (size_t)n : 0;
        }
    }
}

void mt_linear_name_direction(const mt_linear *lin, const double *y, char *text, size_t size)
{
    mt_position_name_motion(lin->sys, &lin->e, y, text, size);
}
