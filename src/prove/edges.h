/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_EDGES_H
#define PROVE_EDGES_H

#include "prove/certify.h"

/*
 * The fewest and the most modes below each edge of bands and limits that a design can have,
 * over the boxes of a branch and bound. Both hold in every inner box (inclusion is monotone),
 * so a box inherits the counts of its outer box and is counted only
 *   - at edges for which the two still differ, and
 *   - at a corner that the outer box did not have: where an input softens or stiffens
 *     everywhere, one half keeps the soft corner, the other the stiff one.
 * Edges 2 i and 2 i + 1 are those of band i, lower and upper; those of limit i, at most and at
 * least, follow in the same order. Edges are moved by their tolerances, in the design's favour.
 */
typedef struct mt_edge {
    int view;
    double lambda; /* [rad^2/s^2]; NaN: no such limit */
    /* MT_LOW: the most modes below it are required, counted at the soft corner; MT_HIGH: the
     * fewest */
    mt_side asked;
} mt_edge;

typedef struct mt_edges {
    const mt_certify *c;
    int n;
    mt_edge *edges;
    /* numbers known of a box: the fewest[n] and the most[n] below each edge, and the keys of
     * the two corners of each view [2 n_views]; -1: no count yet */
    int n_known;
    int *root;   /* [n_known] knowledge that holds for any box */
    int *now;    /* [n_known] of the current box; the caller's (boxes.h) */
    bool *fresh; /* [2 n_views] a corner that the outer box did not have */
} mt_edges;

mt_status mt_edges_init(mt_edges *d, const mt_certify *c, mt_arena *mem, mt_err *err);
/* Begin with a box that is set in all views; now: the knowledge about its outer box, updated to
 * that about this box. */
void mt_edges_use(mt_edges *d, int *now);
/* The most (asked is MT_LOW) or the fewest modes below the edge in the box. */
int mt_edges_count(mt_edges *d, int edge);

#endif
