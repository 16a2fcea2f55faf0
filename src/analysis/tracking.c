/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "analysis/tracking.h"

#include <math.h>
#include <string.h>

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

/* The mode's own vector in the cluster [first, first + size); *own: the cluster contains enough
 * of it. */
static void own_vector(const mt_analysis *a, const double *w, int first, int size, double *phi,
                       double *y, bool *own)
{
    const mt_modes *const modes = &a->modes;
    const int n = mt_linear_freedoms(a->lin);
    double all = 0.0;
    double held = 0.0;
    memset(y, 0, (size_t)n * sizeof *y);
    for (int k = 0; k < modes->count; k++) {
        mt_linear_expand(a->lin, 1, mt_modal_shape(modes, k), phi);
        const double c = mt_dot(a->sys->nq, w, phi);
        all += c * c;
        if (k >= first && k < first + size) {
            held += c * c;
            mt_axpy(n, c, mt_modal_shape(modes, k), y);
        }
    }
    *own = held > MT_TRACK_EXCHANGE * all;
    for (int i = 0; i < n && *own; i++) {
        y[i] /= sqrt(held);
    }
}

mt_status mt_track_dlambda(mt_analysis *a, const double *w, int pos, double *dlambda, bool *own,
                           mt_err *err)
{
    int size = 1;
    const int first = mt_modal_cluster(&a->modes, pos, &size);
    if (a->modes.shaped < a->modes.count) {
        return mt_fail(err, MT_E_INTERNAL, "a named mode's slope asked for without shapes");
    }
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    double *const y = mt_arena_f64(&a->mem, (size_t)mt_linear_freedoms(a->lin), 1);
    double *const phi = mt_arena_f64(&a->mem, (size_t)a->sys->nq, 1);
    mt_status rc = mt_arena_check(&a->mem, err);
    *own = false;
    if (rc == MT_OK) {
        own_vector(a, w, first, size, phi, y, own);
    }
    if (*own) {
        rc = mt_linear_slopes(a->lin, a->modes.lambda[pos], y, dlambda, err);
    }
    mt_arena_rewind(&a->mem, mark);
    return rc;
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
    if (a->modes.shaped < a->modes.count) {
        return mt_fail(err, MT_E_INTERNAL,
                       "named modes asked for after a solve without shapes");
    }
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    double *const all = mt_arena_f64(&a->mem, (size_t)n, (size_t)a->modes.count);
    double *const phi = mt_arena_f64(&a->mem, (size_t)a->sys->nq, 1);
    int *const pair = mt_arena_int(&a->mem, (size_t)n);
    mt_status rc = mt_arena_check(&a->mem, err);
    if (rc != MT_OK) {
        mt_arena_rewind(&a->mem, mark);
        return rc;
    }
    shares(a, n, w, phi, all);
    rc = mt_assign(n, a->modes.count, all, pair, &a->mem, err);
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

/* Leaps of up to so many shortest steps over what no step can settle: a crossing, or a veering
 * narrower than that. */
enum { LEAPS = 4 };
/* A step that could be shorter must keep so much of every shape (turn it by less than 18
 * degrees), lest it leaps over a veering wider than the resolution. */
static const double STEP_SHARE = 0.9;

typedef struct walk {
    const mt_track_way *way;
    int n;
    mt_analysis *end;
    const double **w;       /* [n] the shapes reached, weighed */
    double **own;           /* [n] room for them */
    mt_track *tracks;       /* [n] of the step tried */
    const mt_track *direct; /* [n] told from the original shapes */
    double least;           /* share that a step must keep */
    double s;
} walk;

/* True where the shape is spread among several modes. */
static bool dissolved(const mt_track *k)
{
    return k->pos >= 0 && k->state != MT_TRACKED &&
           k->share + k->rival_share < MT_TRACK_EXCHANGE;
}

/* True where every mode that the path is followed for is identified. */
static bool settled(const walk *k)
{
    for (int r = 0; r < k->n; r++) {
        if (dissolved(&k->direct[r]) &&
            (k->tracks[r].state != MT_TRACKED || k->tracks[r].share < k->least)) {
            return false;
        }
    }
    return true;
}

/* Match the modes at s with those of the last point; *told: all are identified, and w->s is
 * s. */
static mt_status try_at(walk *k, double s, bool *told, mt_err *err)
{
    mt_analysis *a = k->end;
    mt_err own = {0};
    *told = false;
    const mt_status rc = s < 1.0 ? k->way->solve(k->way->context, s, &a, &own) : MT_OK;
    if (rc != MT_OK) {
        return mt_pass_final(rc, &own, err);
    }
    MT_TRY(mt_track_match(a, k->n, k->w, k->tracks, err));
    *told = settled(k);
    for (int r = 0; r < k->n && *told && s < 1.0; r++) {
        if (k->tracks[r].pos < 0) {
            continue;
        }
        MT_TRY(mt_track_weigh(a, k->tracks[r].pos, k->own[r], err));
        k->w[r] = k->own[r];
    }
    k->s = *told ? s : k->s;
    return MT_OK;
}

/* Pass a point where modes are ambiguous by two, three, ... shortest steps at once. */
static mt_status leap(walk *k, bool *told, mt_err *err)
{
    *told = false;
    for (int m = 2; m <= LEAPS && !*told && k->s + ((m - 1) * k->way->resolution) < 1.0; m++) {
        const double s = k->s + (m * k->way->resolution);
        MT_TRY(try_at(k, s < 1.0 ? s : 1.0, told, err));
    }
    return MT_OK;
}

/* Follow the path to its end; *arrived: k->tracks identifies all modes there. */
static mt_status follow_path_to_end(walk *k, bool *arrived, mt_err *err)
{
    const double least = k->way->resolution;
    double h = 0.5; /* the whole way at once has been tried */
    *arrived = false;
    while (k->s < 1.0) {
        bool told = false;
        h = h < least ? least : h;
        k->least = h > least ? STEP_SHARE : MT_TRACK_LOST;
        MT_TRY(try_at(k, k->s + h < 1.0 ? k->s + h : 1.0, &told, err));
        if (!told && h <= least) {
            MT_TRY(leap(k, &told, err));
            if (!told) {
                return MT_OK;
            }
        }
        h = told ? 2.0 * h : 0.5 * h;
    }
    *arrived = true;
    return MT_OK;
}

/* Take the result of the path for the modes that were not identified without it. A mode with
 * two names is ambiguous for both. */
static void merge_walked_tracks(int n, const mt_track *walked, mt_track *tracks)
{
    for (int r = 0; r < n; r++) {
        if (dissolved(&tracks[r])) {
            tracks[r] = walked[r];
        }
    }
    for (int r = 0; r < n; r++) {
        for (int q = 0; q < r; q++) {
            if (tracks[r].pos == tracks[q].pos && tracks[r].pos >= 0) {
                tracks[r].state = MT_TRACK_AMBIGUOUS;
                tracks[q].state = MT_TRACK_AMBIGUOUS;
            }
        }
    }
}

static mt_status walk_init(walk *k, const double *const *w, mt_arena *mem, mt_err *err)
{
    const size_t n = (size_t)k->n;
    k->w = mt_arena_alloc(mem, n, sizeof *k->w);
    k->own = mt_arena_alloc(mem, n, sizeof *k->own);
    k->tracks = mt_arena_alloc(mem, n, sizeof *k->tracks);
    MT_TRY(mt_arena_check(mem, err));
    for (int r = 0; r < k->n; r++) {
        k->w[r] = w[r];
        k->own[r] = mt_arena_f64(mem, (size_t)k->end->sys->nq, 1);
        MT_TRY(mt_arena_check(mem, err));
    }
    return MT_OK;
}

mt_status mt_track_follow(const mt_track_way *way, int n, const double *const *w,
                          mt_analysis *end, mt_arena *mem, mt_track *tracks, mt_err *err)
{
    walk k = {.way = way, .n = n, .end = end, .direct = tracks};
    bool arrived = false;
    bool needed = false;
    MT_TRY(mt_track_match(end, n, w, tracks, err));
    for (int r = 0; r < n; r++) {
        needed = needed || dissolved(&tracks[r]);
    }
    if (!needed || !(way->resolution < 1.0)) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    mt_status rc = walk_init(&k, w, mem, err);
    rc = rc == MT_OK ? follow_path_to_end(&k, &arrived, err) : rc;
    if (rc == MT_OK && arrived) {
        merge_walked_tracks(n, k.tracks, tracks);
    }
    mt_arena_rewind(mem, mark);
    return rc;
}
