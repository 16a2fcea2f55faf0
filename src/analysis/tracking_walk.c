/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The walk from the original design to the present one (tracking.h): each step as long as its
 * shapes can be told, a leap where even the shortest cannot. */
#include "analysis/tracking.h"

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

/* Has the shape dissolved among several modes? */
static bool dissolved(const mt_track *k)
{
    return k->pos >= 0 && k->state != MT_TRACKED &&
           k->share + k->rival_share < MT_TRACK_EXCHANGE;
}

/* Every mode that the walk is for is told. */
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

/* Tell the modes at s from those reached; *told: all are, and w->s is there. */
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

/* Over a place where nothing can be told: two, three, ... shortest steps at once. */
static mt_status leap(walk *k, bool *told, mt_err *err)
{
    *told = false;
    for (int m = 2; m <= LEAPS && !*told && k->s + ((m - 1) * k->way->resolution) < 1.0; m++) {
        const double s = k->s + (m * k->way->resolution);
        MT_TRY(try_at(k, s < 1.0 ? s : 1.0, told, err));
    }
    return MT_OK;
}

/* To the end; *arrived: k->tracks tells all modes there. */
static mt_status go(walk *k, bool *arrived, mt_err *err)
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

/* What the walk found, for the modes that were not settled without it. Two names for one mode:
 * neither can be told. */
static void merge(int n, const mt_track *walked, mt_track *tracks)
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
    if (k->w == NULL || k->own == NULL || k->tracks == NULL) {
        return mt_fail_memory(err);
    }
    for (int r = 0; r < k->n; r++) {
        k->w[r] = w[r];
        k->own[r] = mt_arena_f64(mem, (size_t)k->end->sys->nq, 1);
        if (k->own[r] == NULL) {
            return mt_fail_memory(err);
        }
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
    rc = rc == MT_OK ? go(&k, &arrived, err) : rc;
    if (rc == MT_OK && arrived) {
        merge(n, k.tracks, tracks);
    }
    mt_arena_rewind(mem, mark);
    return rc;
}
