/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/shapes.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Parts of the largest component of a mode: what sixteen digits leave of a sum of a few dozen
 * terms of that size; and what nobody sees in a table. */
static const double ROUNDING = 64.0 * DBL_EPSILON;
static const double UNSEEN = 1e-12;

mt_status mt_shapes_at(mt_analysis *a, int ns, const int *channels, int n, const int *positions,
                       double *value, mt_err *err)
{
    for (int i = 0; i < n; i++) {
        MT_TRY(mt_analysis_shape(a, positions[i], ns, channels, value + ((ptrdiff_t)i * ns),
                                 NULL, err));
    }
    return MT_OK;
}

/* Sensors as they are, or all states, named by body and direction. */
static mt_status name_them(const mt_system *sys, int modes, mt_arena *mem, mt_shapes *out,
                           mt_err *err)
{
    static const char *const directions[] = {"x", "y", "z", "rx", "ry", "rz"};
    out->sensors = sys->n_channels > 0;
    out->n = out->sensors ? sys->n_channels : sys->nq;
    out->name = mt_arena_alloc(mem, (size_t)out->n, sizeof *out->name);
    out->value = mt_arena_f64(mem, (size_t)out->n, (size_t)modes);
    out->turns = mt_arena_alloc(mem, (size_t)out->n, sizeof *out->turns);
    out->largest = mt_arena_f64(mem, (size_t)modes, 1);
    out->length_m = sys->length_m;
    for (int k = 0; k < sys->n_channels && !mt_arena_failed(mem); k++) {
        const mt_channel_kind kind = sys->channels[k].kind;
        out->name[k] = mt_arena_strdup(mem, sys->channels[k].name);
        out->turns[k] = mt_channel_turns(kind);
    }
    for (int b = 0; b < sys->n_bodies && !out->sensors && !mt_arena_failed(mem); b++) {
        for (int d = 0; d < MT_COUNT(directions); d++) {
            const int q = sys->bodies[b].dof[d];
            if (q >= 0) {
                out->name[q] =
                    mt_arena_printf(mem, "%s.%s", sys->bodies[b].name, directions[d]);
                out->turns[q] = d >= 3;
            }
        }
    }
    return mt_arena_check(mem, err);
}

static mt_status at_sensors(mt_analysis *a, int modes, mt_arena *mem, mt_shapes *out,
                            mt_err *err)
{
    int *const channels = mt_arena_int(mem, (size_t)out->n);
    int *const positions = mt_arena_int(mem, (size_t)modes);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < out->n; k++) {
        channels[k] = k;
    }
    for (int i = 0; i < modes; i++) {
        positions[i] = i;
    }
    return mt_shapes_at(a, out->n, channels, modes, positions, out->value, err);
}

/* Size of component k of column i, an angle times the model's length. */
static double component_size(const mt_shapes *s, int k, int i)
{
    return fabs(s->value[k + ((ptrdiff_t)i * s->n)]) * (s->turns[k] ? s->length_m : 1.0);
}

/* phi nq x modes, over all states. What is rounding of the largest displacement becomes 0. */
static void clean(const mt_system *sys, int modes, const double *phi, const mt_shapes *s)
{
    for (int i = 0; i < modes; i++) {
        const double *const x = phi + ((ptrdiff_t)i * sys->nq);
        double most = 0.0;
        for (int k = 0; k < s->n; k++) {
            most = fmax(most, component_size(s, k, i));
        }
        for (int k = 0; k < 6 * sys->n_bodies; k++) {
            const int dof = sys->bodies[k / 6].dof[k % 6];
            const double size = dof < 0 ? 0.0 : fabs(x[dof]);
            most = fmax(most, size * (k % 6 >= 3 ? sys->length_m : 1.0));
        }
        s->largest[i] = most;
        for (int k = 0; k < s->n; k++) {
            if (component_size(s, k, i) <= ROUNDING * most) {
                s->value[k + ((ptrdiff_t)i * s->n)] = 0.0;
            }
        }
    }
}

double mt_shapes_shown(const mt_shapes *shapes, int k, int i)
{
    return component_size(shapes, k, i) <= UNSEEN * shapes->largest[i]
               ? 0.0
               : shapes->value[k + ((ptrdiff_t)i * shapes->n)];
}

/* Room for the motions of all bodies. */
static mt_status room_for(const mt_system *sys, int modes, mt_arena *mem, double **phi,
                          mt_err *err)
{
    *phi = mt_arena_f64(mem, (size_t)sys->nq, (size_t)modes);
    return mt_arena_check(mem, err);
}

mt_status mt_shapes_of(mt_analysis *a, int modes, mt_arena *mem, mt_shapes *out, mt_err *err)
{
    double *phi = NULL;
    MT_TRY(name_them(a->sys, modes, mem, out, err));
    MT_TRY(room_for(a->sys, modes, mem, &phi, err));
    mt_linear_expand(a->lin, modes, a->modes.y, phi);
    if (out->sensors) {
        MT_TRY(at_sensors(a, modes, mem, out, err));
    } else {
        memcpy(out->value, phi, (size_t)a->sys->nq * (size_t)modes * sizeof *phi);
    }
    clean(a->sys, modes, phi, out);
    return MT_OK;
}

mt_status mt_shapes_of_lowest(mt_lowest *l, int modes, mt_arena *mem, mt_shapes *out,
                              mt_err *err)
{
    double *phi = NULL;
    MT_TRY(name_them(l->sys, modes, mem, out, err));
    MT_TRY(room_for(l->sys, modes, mem, &phi, err));
    MT_TRY(mt_lowest_shapes(l, modes, phi, err));
    if (out->sensors) {
        MT_TRY(mt_lowest_sense(l, modes, out->value, err));
    } else {
        memcpy(out->value, phi, (size_t)l->sys->nq * (size_t)modes * sizeof *phi);
    }
    clean(l->sys, modes, phi, out);
    return MT_OK;
}
