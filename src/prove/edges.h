/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_EDGES_H
#define PROVE_EDGES_H

#include "prove/certify.h"

/*
 * How many modes lie below each edge of bands and limits, over the boxes of a branch and bound:
 * the fewest and the most that a design of the box can have. Both hold in every box within
 * (inclusion is monotone), so a box begins with what is known of the one that it is a part of,
 * and is counted only
 *   - at edges for which the two still differ, and
 *   - at a corner that the outer box did not have: where an input softens or stiffens
 *     everywhere, one half keeps the soft corner, the other the stiff one.
 * Edges 2 i and 2 i + 1 are those of band i, lower and upper; those of limit i, at most and at
 * least, follow likewise. Tolerances are granted.
 */
typedef struct mt_edge {
    int view;
    double lambda; /* [rad^2/s^2]; NaN: a limit that there is not */
    /* MT_LOW: asked is the most below it, as the soft corner has; MT_HIGH: the fewest */
    mt_side asked;
} mt_edge;

typedef struct mt_edges {
    const mt_certify *c;
    int n;
    mt_edge *edges;
    /* numbers known of a box: the fewest[n], the most[n] below each edge, and the keys of the
     * two corners of each view [2 n_views], -1: none was counted at */
    int n_known;
    int *root;   /* [n_known] what is known of any box */
    int *now;    /* [n_known] of the box that is set; the caller's (boxes.h) */
    bool *fresh; /* [2 n_views] a corner that the outer box did not have */
} mt_edges;

mt_status mt_edges_init(mt_edges *d, const mt_certify *c, mt_arena *mem, mt_err *err);
/* The box is set in all views; now: what is known of the one around it, and then of it. */
void mt_edges_use(mt_edges *d, int *now);
/* The most (MT_LOW is asked) or the fewest modes below the edge in the box. */
int mt_edges_count(mt_edges *d, int edge);

#endif
