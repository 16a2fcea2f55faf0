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
 * is the part of the named mode that mode j carries; shares of a mode add up to 1. Named modes
 * and vibration modes are paired one to one so that the sum of the shares is greatest.
 *
 * Crossing and veering. Where two frequencies cross, the shapes keep their place on either side
 * of a point; where they veer, the shapes of two neighbours turn into each other over an
 * interval as wide as their coupling. A name belongs to a shape: after a narrow veering it is
 * found on the other branch, as after a crossing. Only inside the interval nobody can tell, and
 * that is what the state says. What separates two modes is the angle by which the named shape
 * has turned towards its rival: share = cos^2, rival = sin^2 where two modes exchange. Up to a
 * rival of half the share, 35 degrees of the 45 at which they change places, a mode counts as
 * told apart: beyond, a few percent of a parameter decide. With less than half of the shape the
 * mode is lost among several.
 *
 * A shape may also dissolve: change by much, and gradually, so that several modes carry some of
 * it. Where the mode and its rival hold less than MT_TRACK_EXCHANGE of it together (there is
 * more at work than an exchange of two), the straight line of designs from the original one to
 * the present one is walked, each point's shapes being told from those of the point before.
 * Steps are halved while anything is ambiguous or has turned by more than 18 degrees, down to
 * MT_TRACK_RESOLUTION of any coordinate (1 % of a parameter): a veering narrower than that is
 * leapt over like a crossing (no part is made to sit inside it on purpose), a wider one is a
 * gradual change. The pairing depends on the design alone, not on where a search came from.
 */

/* Shares below this leave room for another mode with a larger one. */
#define MT_TRACK_LOST 0.5
/* A rival with more than this part of the share cannot be told from the mode. */
#define MT_TRACK_RIVAL 0.5
/* Two modes that hold more than this of a shape exchange it: then no walk could say more than
 * the shape does. */
#define MT_TRACK_EXCHANGE 0.9
/* Least step of a walk, in t (ln of a parameter, or its part of the scale). */
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

/* Where a named mode is at a design. */
typedef struct mt_track {
    double share; /* of its mode, relative to the shapes it was told from; 0 without one */
    double rival_share; /* 1 where both belong to one cluster: their shapes are any */
    int pos; /* in a->modes; -1: no vibration mode is left, or the configuration is unstable */
    int rival; /* position of the other mode with the greatest share; -1: none */
    mt_track_state state;
} mt_track;

/* w = M phi of the mode at position pos over all states, w[sys->nq]. Fails: MT_E_MEMORY. */
mt_status mt_track_weigh(mt_analysis *a, int pos, double *w, mt_err *err);
/*
 * Pair n named modes (weighed shapes w[n], made by mt_track_weigh for the same configuration)
 * with the modes of the last solve, which had vectors: tracks[n]. A mode in a cluster is
 * ambiguous whatever its share: shapes of equal frequencies may be turned at will. O(n_modes
 * (nq n + n_modes)); scratch from a->mem, given back. Fails: MT_E_MEMORY, MT_E_INTERNAL (no
 * vectors).
 */
mt_status mt_track_match(mt_analysis *a, int n, const double *const *w, mt_track *tracks,
                         mt_err *err);

/*
 * Where the named mode (weighed shape w) is at position pos, in a cluster of the last solve:
 * the derivatives of its eigenvalue by all inputs, along the vector of the cluster that has its
 * shape,
 *     y = sum_k c_k y_k / |c|,   c_k = phi_0^T M_0 phi_k,
 * which is the mode's own where frequencies cross. *own: the cluster holds more than
 * MT_TRACK_EXCHANGE of the shape; else nothing is done. O(modes nq). Scratch from a->mem, given
 * back. Fails: MT_E_MEMORY, MT_E_INTERNAL (no vectors).
 */
mt_status mt_track_dlambda(mt_analysis *a, const double *w, int pos, double *dlambda, bool *own,
                           mt_err *err);

/* Designs on the way: brings an analysis to the fraction s of it (0: the original design, 1:
 * the present one). What it fails with counts as ambiguous, but memory and our own errors. */
typedef struct mt_track_way {
    mt_status (*solve)(void *context, double s, mt_analysis **out, mt_err *err);
    void *context;
    double resolution; /* least step in s; 1 or more: there is no way to walk */
} mt_track_way;

/**
 * Tracks at the present design, which `end` has solved with vectors. Modes that the original
 * shapes w[n] settle, and those that two modes exchange, keep that answer; the others take that
 * of the walk, where it arrives. Cost: one match where that settles all; else at most some 5 /
 * resolution solves. Scratch from mem. Fails: MT_E_MEMORY, MT_E_INTERNAL.
 */
mt_status mt_track_follow(const mt_track_way *way, int n, const double *const *w,
                          mt_analysis *end, mt_arena *mem, mt_track *tracks, mt_err *err);

#endif
