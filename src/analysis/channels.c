/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "analysis/channels.h"

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
