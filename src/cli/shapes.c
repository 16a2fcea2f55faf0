/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/shapes.h"

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
    for (int k = 0; k < sys->n_channels && !mt_arena_failed(mem); k++) {
        out->name[k] = mt_arena_strdup(mem, sys->channels[k].name);
    }
    for (int b = 0; b < sys->n_bodies && !out->sensors && !mt_arena_failed(mem); b++) {
        for (int d = 0; d < MT_COUNT(directions); d++) {
            const int q = sys->bodies[b].dof[d];
            if (q >= 0) {
                out->name[q] =
                    mt_arena_printf(mem, "%s.%s", sys->bodies[b].name, directions[d]);
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

mt_status mt_shapes_of(mt_analysis *a, int modes, mt_arena *mem, mt_shapes *out, mt_err *err)
{
    MT_TRY(name_them(a->sys, modes, mem, out, err));
    if (out->sensors) {
        return at_sensors(a, modes, mem, out, err);
    }
    mt_linear_expand(a->lin, modes, a->modes.y, out->value);
    return MT_OK;
}

mt_status mt_shapes_of_lowest(mt_lowest *l, int modes, mt_arena *mem, mt_shapes *out,
                              mt_err *err)
{
    MT_TRY(name_them(l->sys, modes, mem, out, err));
    return out->sensors ? mt_lowest_sense(l, modes, out->value, err)
                        : mt_lowest_shapes(l, modes, out->value, err);
}
