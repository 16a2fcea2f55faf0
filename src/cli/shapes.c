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

static mt_status at_sensors(mt_analysis *a, int modes, mt_arena *mem, mt_shapes *out,
                            mt_err *err)
{
    const mt_system *const sys = a->sys;
    const int n = sys->n_channels;
    int *const channels = mt_arena_int(mem, (size_t)n);
    int *const positions = mt_arena_int(mem, (size_t)modes);
    MT_TRY(mt_arena_check(mem, err));
    out->sensors = true;
    out->n = n;
    for (int k = 0; k < n; k++) {
        channels[k] = k;
        out->name[k] = mt_arena_strdup(mem, sys->channels[k].name);
        MT_TRY(mt_arena_check(mem, err));
    }
    for (int i = 0; i < modes; i++) {
        positions[i] = i;
    }
    return mt_shapes_at(a, n, channels, modes, positions, out->value, err);
}

/* All states, named by body and direction. */
static mt_status of_bodies(mt_analysis *a, int modes, mt_arena *mem, mt_shapes *out,
                           mt_err *err)
{
    static const char *const directions[] = {"x", "y", "z", "rx", "ry", "rz"};
    const mt_system *const sys = a->sys;
    out->sensors = false;
    out->n = sys->nq;
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int d = 0; d < MT_COUNT(directions); d++) {
            const int q = sys->bodies[b].dof[d];
            if (q >= 0) {
                out->name[q] =
                    mt_arena_printf(mem, "%s.%s", sys->bodies[b].name, directions[d]);
            }
        }
    }
    for (int q = 0; q < sys->nq; q++) {
        MT_TRY(mt_arena_check(mem, err));
    }
    mt_linear_expand(a->lin, modes, a->modes.y, out->value);
    return MT_OK;
}

mt_status mt_shapes_of(mt_analysis *a, int modes, mt_arena *mem, mt_shapes *out, mt_err *err)
{
    const size_t most = (size_t)(a->sys->n_channels > 0 ? a->sys->n_channels : a->sys->nq);
    out->name = mt_arena_alloc(mem, most, sizeof *out->name);
    out->value = mt_arena_f64(mem, most, (size_t)modes);
    MT_TRY(mt_arena_check(mem, err));
    return a->sys->n_channels > 0 ? at_sensors(a, modes, mem, out, err)
                                  : of_bodies(a, modes, mem, out, err);
}
