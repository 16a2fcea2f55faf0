/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ANALYSIS_TRACKING_H
#define ANALYSIS_TRACKING_H

#include "analysis/analysis.h"

/*
 * Named modes are followed by their shape. phi_0 is the named mode at the original design, M_0
 * the mass there, phi_j the modes of the present design:
 *
 *     share_j = (phi_0^T M_0 phi_j)^2 / sum_k (phi_0^T M_0 phi_k)^2
 *         over all modes k, rigid-body modes included
 *
 * is the part of the named mode in mode j; the shares of a named mode add up to 1. Named modes
 * and vibration modes are paired one to one with the greatest sum of shares.
 *
 * Crossing and veering. Where two frequencies cross, the shapes stay the same on both sides of
 * a point; where they veer, two neighbouring shapes turn into each other over an interval as
 * wide as their coupling. A name follows a shape: after a narrow veering it is on the other
 * branch, as after a crossing. Only inside the interval the mode is ambiguous, and the state
 * says so. Two modes are separated by the angle by which the named shape has turned towards its
 * rival: share = cos^2, rival = sin^2 where two modes exchange. Up to a rival of half the
 * share, 35 degrees of the 45 at which they change places, the mode counts as identified:
 * beyond, a few percent of a parameter decide. With less than half of the shape the mode is
 * lost among several.
 *
 * A shape may also dissolve: change much and gradually, so that several modes contain part of
 * it. Where the mode and its rival together have less than MT_TRACK_EXCHANGE of it (more than
 * an exchange of two), the straight line of designs from the original to the present one is
 * followed, and the shapes of each point are matched with those of the point before. Steps are
 * halved while any match is ambiguous or any shape has turned by more than 18 degrees, down to
 * MT_TRACK_RESOLUTION of any coordinate (1 % of a parameter): a narrower veering is passed like
 * a crossing (no design lies inside it on purpose), a wider one is a gradual change. The
 * pairing depends on the design alone, not on the path of a search.
 */

/* Shares below this leave room for another mode with a larger one. */
#define MT_TRACK_LOST 0.5
/* A rival with more than this part of the share makes the mode ambiguous. */
#define MT_TRACK_RIVAL 0.5
/* Two modes with more than this of a shape together exchange it: following a path would not add
 * information. */
#define MT_TRACK_EXCHANGE 0.9
/* Least step along the path, in t (ln of a parameter, or its part of the scale). */
#define MT_TRACK_RESOLUTION 0.01

#define MT_TRACK_STATE_LIST(X)         \
    X(MT_TRACKED, "tracked")           \
    X(MT_TRACK_AMBIGUOUS, "ambiguous") \
    X(MT_TRACK_LOST_STATE, "lost")
#define MT_TRACK_STATE_ENUM(id, name) id,
typedef enum mt_track_state {
    MT_TRACK_STATE_LIST(MT_TRACK_STATE_ENUM) MT_TRACK_STATE_COUNT
} mt_track_state;
#undef MT_TRACK_STATE_ENUM
const char *mt_track_state_name(mt_track_state state);

/* Position of a named mode at a design. */
typedef struct mt_track {
    double share; /* of its mode, relative to the shapes it was matched with; 0 without one */
    double rival_share; /* 1 where both are in one cluster: their shapes are arbitrary */
    int pos; /* in a->modes; -1: no vibration mode is left, or the configuration is unstable */
    int rival; /* position of the other mode with the greatest share; -1: none */
    mt_track_state state;
} mt_track;

/* w = M phi of the mode at position pos over all states, w[sys->nq]. Fails: MT_E_MEMORY. */
mt_status mt_track_weigh(mt_analysis *a, int pos, double *w, mt_err *err);
/*
 * Match n named modes (weighed shapes w[n] of mt_track_weigh for the same configuration) with
 * the modes of the last solve, which had vectors: tracks[n]. A mode in a cluster is ambiguous
 * whatever its share: shapes of equal frequencies may be rotated arbitrarily. O(n_modes (nq n +
 * n_modes)); scratch from a->mem is returned. Fails: MT_E_MEMORY, MT_E_INTERNAL (no vectors).
 */
mt_status mt_track_match(mt_analysis *a, int n, const double *const *w, mt_track *tracks,
                         mt_err *err);

/*
 * For a named mode (weighed shape w) at position pos in a cluster of the last solve:
 * derivatives of its eigenvalue by all inputs, along the vector of the cluster with its shape,
 *     y = sum_k c_k y_k / |c|,   c_k = phi_0^T M_0 phi_k,
 * which is the mode itself where frequencies cross. *own: the cluster has more than
 * MT_TRACK_EXCHANGE of the shape; otherwise nothing is computed. O(modes nq). Scratch from
 * a->mem is returned. Fails: MT_E_MEMORY, MT_E_INTERNAL (no vectors).
 */
mt_status mt_track_dlambda(mt_analysis *a, const double *w, int pos, double *dlambda, bool *own,
                           mt_err *err);

/* Designs along the path: solve returns an analysis at the fraction s (0: the original design,
 * 1: the present one). Its failures count as ambiguous, except for memory and internal
 * errors. */
typedef struct mt_track_way {
    mt_status (*solve)(void *context, double s, mt_analysis **out, mt_err *err);
    void *context;
    double resolution; /* least step in s; 1 or more: no path to follow */
} mt_track_way;

/**
 * Tracks at the present design, which `end` has solved with vectors. Modes that the original
 * shapes w[n] identify, and those that two modes exchange, keep that result; the others take
 * that of the path, where it reaches the end. Cost: one match where that identifies all;
 * otherwise at most some 5 / resolution solves. Scratch from mem. Fails: MT_E_MEMORY,
 * MT_E_INTERNAL.
 */
mt_status mt_track_follow(const mt_track_way *way, int n, const double *const *w,
                          mt_analysis *end, mt_arena *mem, mt_track *tracks, mt_err *err);

#endif
