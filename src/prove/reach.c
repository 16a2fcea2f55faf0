/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one mode can reach in a box. */
#include "prove/reach.h"

#include <math.h>

#include "prove/box.h"

/* Frequencies of the modes of a view over the box, in scratch; NULL where nothing is known. */
static mt_status ranges_of(const mt_certify *c, int view, mt_arena *scratch, double **low,
                           double **high, mt_err *err)
{
    mt_enclosure *const e = c->views[view];
    *low = NULL;
    *high = NULL;
    if (!mt_enclosure_set(e, c->lower, c->upper)) {
        return MT_OK;
    }
    *low = mt_arena_f64(scratch, (size_t)e->n_modes, 1);
    *high = mt_arena_f64(scratch, (size_t)e->n_modes, 1);
    MT_TRY(mt_arena_check(scratch, err));
    return mt_enclosure_ranges(e, *low, *high, err);
}

static bool exists(const mt_certify *c, const mt_certify_limit *l)
{
    return l->mode >= 1 && l->mode <= c->views[l->view]->n_modes;
}

static bool is_missed(const mt_certify_limit *l, double low_hz, double high_hz)
{
    return high_hz < l->at_least_hz * (1.0 - l->tolerance) ||
           low_hz > l->at_most_hz * (1.0 + l->tolerance);
}

static mt_status find_reachable_range(const mt_certify *c, int limit, mt_arena *scratch,
                                      mt_certify_reach *out, mt_err *err)
{
    const mt_certify_limit *const l = &c->limits[limit];
    mt_certify one = *c;
    *out = (mt_certify_reach){MT_VERDICT_IMPOSSIBLE, nan(""), nan(""), 0};
    double *low = NULL;
    double *high = NULL;
    if (!exists(c, l)) {
        return MT_OK;
    }
    MT_TRY(ranges_of(c, l->view, scratch, &low, &high, err));
    if (low != NULL) {
        out->low_hz = low[l->mode - 1];
        out->high_hz = high[l->mode - 1];
    }
    if (is_missed(l, out->low_hz, out->high_hz)) {
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
    const mt_status rc = find_reachable_range(c, limit, scratch, out, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

/* Limits of one view. */
static mt_status any_missed(const mt_certify *c, int view, mt_arena *scratch, bool *out,
                            mt_err *err)
{
    double *low = NULL;
    double *high = NULL;
    bool known = false;
    for (int i = 0; i < c->n_limits && !*out; i++) {
        const mt_certify_limit *const l = &c->limits[i];
        if (l->view != view) {
            continue;
        }
        if (!known) {
            MT_TRY(ranges_of(c, view, scratch, &low, &high, err));
            known = true;
        }
        *out =
            !exists(c, l) || (low != NULL && is_missed(l, low[l->mode - 1], high[l->mode - 1]));
    }
    return MT_OK;
}

mt_status mt_certify_out_of_reach(const mt_certify *c, mt_arena *scratch, bool *out,
                                  mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    mt_status rc = MT_OK;
    *out = false;
    for (int v = 0; v < c->n_views && rc == MT_OK && !*out; v++) {
        rc = any_missed(c, v, scratch, out, err);
    }
    mt_arena_rewind(scratch, mark);
    return rc;
}
