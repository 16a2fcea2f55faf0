/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How surely a named mode is told at a design. */
#include "describe/describe.h"

static const double PERCENT = 100.0;

const char *mt_describe_identity(const mt_configuration_work *view, int named, mt_arena *mem)
{
    const mt_track *const k = &view->track[named];
    const mt_modes *const modes = &view->analysis->modes;
    const int own = mt_modal_index(modes, k->pos);
    const int rival = mt_modal_index(modes, k->rival);
    int size = 1;
    if (k->pos < 0 || k->state == MT_TRACKED) {
        return "";
    }
    if (k->state == MT_TRACK_LOST_STATE || rival == 0) {
        return mt_arena_printf(mem, "lost: mode %d, the nearest, carries %.0f %% of its shape",
                               own, PERCENT * k->share);
    }
    (void)mt_modal_cluster(modes, k->pos, &size);
    const int low = own < rival ? own : rival;
    const int high = own < rival ? rival : own;
    if (size > 1) {
        return mt_arena_printf(mem, "ambiguous between modes %d and %d of equal frequency", low,
                               high);
    }
    return mt_arena_printf(mem, "ambiguous between modes %d and %d", low, high);
}

bool mt_describe_is_told(const mt_configuration_work *view, const mt_requirement *d)
{
    int size = 1;
    if (d->named < 0 || !view->solved || !view->tracked) {
        return true;
    }
    const mt_track *const k = &view->track[d->named];
    if (k->pos < 0 || k->state == MT_TRACKED) {
        return true; /* where there is no mode, that is the trouble */
    }
    const int first = mt_modal_cluster(&view->analysis->modes, k->pos, &size);
    const bool same_hz = k->rival >= first && k->rival < first + size;
    return d->quantity == MT_QUANTITY_FREQUENCY && k->state == MT_TRACK_AMBIGUOUS && same_hz;
}
