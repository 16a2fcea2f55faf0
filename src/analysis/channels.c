/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "analysis/channels.h"

mt_status mt_channels_scale(const mt_system *sys, int n, const int *channels, double length,
                            mt_arena *mem, double **scale, mt_err *err)
{
    int turns = 0;
    *scale = NULL;
    for (int i = 0; i < n; i++) {
        turns += mt_channel_turns(sys->channels[channels[i]].kind) ? 1 : 0;
    }
    if (turns == 0 || turns == n) {
        return MT_OK;
    }
    *scale = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        (*scale)[i] = mt_channel_turns(sys->channels[channels[i]].kind) ? length : 1.0;
    }
    return MT_OK;
}

void mt_channels_weigh(int n, const double *scale, int columns, double *shapes)
{
    for (int k = 0; k < columns && scale != NULL; k++) {
        for (int i = 0; i < n; i++) {
            shapes[i + ((ptrdiff_t)k * n)] *= scale[i];
        }
    }
}

mt_status mt_analysis_common_channels(const mt_analysis *a, const mt_analysis *b, mt_arena *mem,
                                      mt_common_channels *out, mt_err *err)
{
    const size_t most = (size_t)a->sys->n_channels;
    *out = (mt_common_channels){.a = mt_arena_int(mem, most), .b = mt_arena_int(mem, most)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < a->sys->n_channels; i++) {
        const int other = mt_system_find_channel(b->sys, a->sys->channels[i].name);
        if (other >= 0) {
            out->a[out->n] = i;
            out->b[out->n++] = other;
        }
    }
    return MT_OK;
}
