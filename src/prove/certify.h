/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_CERTIFY_H
#define PROVE_CERTIFY_H

#include "base/run.h"
#include "prove/box.h"

/*
 * Certificates are statements about every design of a box, proven by enclosures and branch and
 * bound. A proof covers the program's own arithmetic (enclosure.h). Proofs are deterministic
 * and run on one worker. Results are in the caller's arena; scratch memory is released.
 */

/* A forbidden band of one configuration. An edge counts as kept within `tolerance` (relative),
 * so that no design that the search calls feasible is excluded. The caller clips bands at
 * up_to_hz and lists those of one view ascending. */
typedef struct mt_certify_band {
    int view;
    double lower_hz;
    double upper_hz;
    double tolerance;
} mt_certify_band;

/* Limits of a mode's frequency (NaN: none); a target sets both. */
typedef struct mt_certify_limit {
    int view;
    int mode; /* vibration mode, from 1 */
    double at_least_hz;
    double at_most_hz;
    double tolerance; /* relative */
} mt_certify_limit;

/* Limits of what two modes make (NaN: none), already widened by the caller's tolerance. */
typedef struct mt_certify_pair {
    int view;
    int mode; /* from 1 */
    int of_view;
    int of_mode;
    bool difference; /* of the frequencies [Hz]; else their ratio */
    double at_least;
    double at_most;
} mt_certify_pair;

/* Limits of an expression's value (NaN: none), already widened by the caller's absolute
 * tolerance. */
typedef struct mt_certify_bound {
    mt_node node;
    double at_least;
    double at_most;
} mt_certify_bound;

/* Restricts the proof to designs whose objective may be less than `below`. least: a lower bound
 * of the objective over lo <= x <= hi. */
typedef struct mt_certify_cap {
    double (*least)(void *context, const double *lo, const double *hi);
    void *context;
    double below;
} mt_certify_cap;

/* Inputs first .. first + n - 1 take the values of one row together. */
typedef struct mt_certify_rows {
    int first;
    int n;
    int n_rows;
    const double *value; /* [n_rows x n] */
} mt_certify_rows;

/*
 * The requirements on the designs lower <= x <= upper, in which inputs with a catalogue take
 * only its values. A mode placement is int[n_bands]: for each band the number of vibration
 * modes below it (or on its lower edge). Designs that break `same_as` do not meet the
 * requirements. The views share the inputs.
 */
typedef struct mt_certify {
    int n_views;
    mt_enclosure *const *views; /* made for bounds that include this box */
    int n_bands;
    const mt_certify_band *bands;
    /* [n_bands] the first band (itself, or an earlier one) that must have the same number of
     * modes below it (positions of one drive: between different numbers a mode would cross);
     * NULL: all bands are free */
    const int *same_as;
    int n_limits;
    int n_pairs;
    const mt_certify_limit *limits;
    const mt_certify_pair *pairs;
    const mt_program *program; /* of the bounds; NULL where there are none */
    const mt_certify_bound *bounds;
    int n_bounds;
    int n; /* inputs */
    const double *lower;
    const double *upper;
    const int *n_catalogue;         /* [n] 0: continuous; NULL: all are */
    const double *const *catalogue; /* [n] ascending values */
    const mt_certify_rows *rows; /* [n_rows] of inputs with a catalogue, each of its column */
    const mt_certify_cap *cap;   /* NULL: any value of the objective */
    int n_rows;
    /* stop at the first design that is found; nothing is proven then */
    bool any;
    /* [n] NaN: bisected in ln x, else linearly; NULL: in ln x where lower > 0 */
    const double *scale;
    double max_work;         /* budget in multiplications, approximate; 0: MT_CERTIFY_WORK */
    mt_interrupt *interrupt; /* ends the search as an exhausted budget does; NULL: never */
    mt_progress *progress;   /* NULL: no progress reports */
} mt_certify;

/* Budgets count operations, so that the same designs are excluded on any machine. A nominal
 * second is about one second of a core; the default is five. */
#define MT_CERTIFY_WORK_PER_S 1e9
#define MT_CERTIFY_WORK       (5.0 * MT_CERTIFY_WORK_PER_S)
enum { MT_CERTIFY_OPEN_MOST = 256 };

/* Mode placements that designs of the box can have. */
typedef struct mt_certify_search {
    /* every design of the box that meets bands, limits and bounds has a placement of `known` or
     * `found` */
    bool proven;
    /* new placements, each with a design that has it and meets all requirements */
    int n_found;
    int *found; /* [n_found x n_bands] */
    double *at; /* [n_found x n] */
    int n_open; /* neither excluded nor met when the budget ended (0 where proven) */
    int *open;  /* [n_open x n_bands] */
    bool more;  /* open was cut at MT_CERTIFY_OPEN_MOST */
    bool stopped;
    long boxes;
    double work; /* as max_work counts it */
    /* undecided part of the box's volume (in the coordinates of bisection), at most; 0 where
     * proven */
    double undecided;
} mt_certify_search;

/* Branch and bound over the box: every mode placement that is not among known[n_known x
 * n_bands] is found feasible, excluded, or left open. known may be NULL. With n_bands = 0 there
 * is one (empty) placement: n_found is 1 where the limits can be met. Fails: MT_E_MEMORY. */
mt_status mt_certify_assignments(const mt_certify *c, int n_known, const int *known,
                                 mt_arena *mem, mt_certify_search *out, mt_err *err);

/* Index of the placement row[n_bands] in rows[n x n_bands]; n: not found. */
int mt_certify_index_of(const int *rows, int n, const int *row, int n_bands);

typedef enum mt_verdict {
    MT_VERDICT_IMPOSSIBLE, /* proven */
    MT_VERDICT_POSSIBLE,
    MT_VERDICT_OPEN, /* not proven */
    MT_VERDICT_COUNT
} mt_verdict;

/* The verdict whether a design of the box can have this assignment[n_bands] and meet limits and
 * bounds. at[n] (may be NULL): such a design, where POSSIBLE. boxes may be NULL. */
mt_status mt_certify_possible(const mt_certify *c, const int *assignment, mt_arena *scratch,
                              mt_verdict *verdict, double *at, long *boxes, mt_err *err);

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

/* The verdict whether limit `limit` of c alone can be met in the box, and the range of its
 * mode's frequency. The range encloses all reachable frequencies; where the enclosure is loose
 * (an input in K and M) it is wider, and branch and bound decides the verdict. A mode that does
 * not exist is IMPOSSIBLE with range NaN. */
typedef struct mt_certify_reach {
    mt_verdict verdict;
    double low_hz;
    double high_hz;
    long boxes;
} mt_certify_reach;
mt_status mt_certify_reach_of(const mt_certify *c, int limit, mt_arena *scratch,
                              mt_certify_reach *out, mt_err *err);
/* *out is true where any limit or pair of c alone is out of reach over the whole box, by these
 * ranges without branch and bound. True is proven. Cost: two eigensolves per view with limits
 * or pairs. Fails: MT_E_MEMORY, numerical failures of LAPACK. */
mt_status mt_certify_out_of_reach(const mt_certify *c, mt_arena *scratch, bool *out,
                                  mt_err *err);

#endif
