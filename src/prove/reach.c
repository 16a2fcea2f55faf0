/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one mode can reach in a box. */
#include "prove/reach.h"

#include <math.h>

#include "prove/box.h"

/* Frequency range of the limit's mode over the box; NaN where nothing is known. */
static mt_status range_of(const mt_certify *c, const mt_certify_limit *l, mt_arena *scratch,
                          mt_certify_reach *out, mt_err *err)
{
    mt_enclosure *const e = c->views[l->view];
    if (!mt_enclosure_set(e, c->lower, c->upper)) {
        return MT_OK;
    }
    double *const low = mt_arena_f64(scratch, (size_t)e->n_modes, 1);
    double *const high = mt_arena_f64(scratch, (size_t)e->n_modes, 1);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_enclosure_ranges(e, low, high, err));
    out->low_hz = low[l->mode - 1];
    out->high_hz = high[l->mode - 1];
    return MT_OK;
}

static mt_status reach(const mt_certify *c, int limit, mt_arena *scratch, mt_certify_reach *out,
                       mt_err *err)
{
    const mt_certify_limit *const l = &c->limits[limit];
    mt_certify one = *c;
    *out = (mt_certify_reach){MT_VERDICT_IMPOSSIBLE, nan(""), nan(""), 0};
    if (l->mode < 1 || l->mode > c->views[l->view]->n_modes) {
        return MT_OK;
    }
    MT_TRY(range_of(c, l, scratch, out, err));
    if (out->high_hz < l->at_least_hz * (1.0 - l->tolerance) ||
        out->low_hz > l->at_most_hz * (1.0 + l->tolerance)) {
        return MT_OK;
    }
    one.n_bands = 0;
    one.n_bounds = 0;
    one.limits = l;
    one.n_limits = 1;
    return mt_certify_possible(&one, NULL, scratch, &out->verdict, NULL, &out->boxes, err);
}

mt_status mt_certify_reach_of(const mt_certify *c, int limit, mt_arena *scratch,
                              mt_certify_reach *out, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = reach(c, limit, scratch, out, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}
