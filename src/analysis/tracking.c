/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "analysis/tracking.h"

#include "mechanics/products.h"

mt_status mt_track_weigh(mt_analysis *a, int pos, double *w, mt_err *err)
{
    return mt_linear_mass_product(a->lin, mt_modal_shape(&a->modes, pos), w, err);
}

/* share: n x count, column-major; rows are the named modes. */
static void shares(const mt_analysis *a, int n, const double *const *w, double *phi,
                   double *share)
{
    const int nq = a->sys->nq;
    for (int c = 0; c < a->modes.count; c++) {
        mt_linear_expand(a->lin, 1, mt_modal_shape(&a->modes, c), phi);
        for (int r = 0; r < n; r++) {
            const double part = mt_dot(nq, w[r], phi);
            share[r + ((ptrdiff_t)c * n)] = part * part;
        }
    }
    for (int r = 0; r < n; r++) {
        double sum = 0.0;
        for (int c = 0; c < a->modes.count; c++) {
            sum += share[r + ((ptrdiff_t)c * n)];
        }
        for (int c = 0; c < a->modes.count; c++) {
            double *const s = &share[r + ((ptrdiff_t)c * n)];
            *s = sum > 0.0 && a->modes.kind[c] == MT_MODE_FLEXIBLE ? *s / sum : -1.0;
        }
    }
}

static void put_track(const mt_analysis *a, int n, const double *all, int r, int pos,
                      mt_track *out)
{
    int size = 1;
    *out = (mt_track){.pos = -1, .rival = -1, .state = MT_TRACK_LOST_STATE};
    if (pos < 0 || all[r + ((ptrdiff_t)pos * n)] < 0.0) {
        return; /* no vibration mode was left */
    }
    out->pos = pos;
    out->share = all[r + ((ptrdiff_t)pos * n)];
    for (int c = 0; c < a->modes.count; c++) {
        const double other = all[r + ((ptrdiff_t)c * n)];
        if (c != pos && other >= 0.0 && (out->rival < 0 || other > out->rival_share)) {
            out->rival = c;
            out->rival_share = other;
        }
    }
    const int first = mt_modal_cluster(&a->modes, pos, &size);
    if (size > 1) {
        out->rival = pos == first ? first + 1 : first;
        out->rival_share = 1.0;
    }
    const bool rivalled = out->rival_share > MT_TRACK_RIVAL * out->share;
    const bool lost = out->share + (rivalled ? out->rival_share : 0.0) < MT_TRACK_LOST;
    out->state = lost                         ? MT_TRACK_LOST_STATE
                 : rivalled                   ? MT_TRACK_AMBIGUOUS
                 : out->share < MT_TRACK_LOST ? MT_TRACK_LOST_STATE
                                              : MT_TRACKED;
}

mt_status mt_track_match(mt_analysis *a, int n, const double *const *w, mt_track *tracks,
                         mt_err *err)
{
    for (int r = 0; r < n; r++) {
        tracks[r] = (mt_track){.pos = -1, .rival = -1, .state = MT_TRACK_LOST_STATE};
    }
    if (!mt_modal_indexed(&a->modes) || n == 0) {
        return MT_OK;
    }
    if (a->modes.y == NULL) {
        return mt_fail(err, MT_E_INTERNAL,
                       "named modes asked for after a solve without shapes");
    }
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    double *const all = mt_arena_f64(&a->mem, (size_t)n, (size_t)a->modes.count);
    double *const phi = mt_arena_f64(&a->mem, (size_t)a->sys->nq, 1);
    int *const pair = mt_arena_int(&a->mem, (size_t)n);
    if (all == NULL || phi == NULL || pair == NULL) {
        mt_arena_rewind(&a->mem, mark);
        return mt_fail_memory(err);
    }
    shares(a, n, w, phi, all);
    const mt_status rc = mt_assign(n, a->modes.count, all, pair, &a->mem, err);
    for (int r = 0; r < n && rc == MT_OK; r++) {
        put_track(a, n, all, r, pair[r], &tracks[r]);
    }
    mt_arena_rewind(&a->mem, mark);
    return rc;
}

#define STATE_NAME(id, name) \
    case id:                 \
        return name;

const char *mt_track_state_name(mt_track_state state)
{
    switch (state) {
        MT_TRACK_STATE_LIST(STATE_NAME)
    case MT_TRACK_STATE_COUNT:
        break;
    }
    return "unknown";
}
