/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_TOLERANCE_H
#define PROVE_TOLERANCE_H

#include "prove/certify.h"

/* One edge that a mode must keep: "mode 3 stays above 9.46 Hz". */
typedef struct mt_certify_edge {
    int view;
    int band;  /* -1: a limit's */
    int limit; /* -1: a band's */
    int mode;
    double hz;
    bool above; /* the mode must stay above hz; else below */
} mt_certify_edge;

typedef enum mt_tolerance_end {
    /* beyond, the mode of `edge` may cross it (or, where the enclosure is loose, cannot be
     * shown not to) */
    MT_TOLERANCE_EDGE,
    MT_TOLERANCE_DOMAIN, /* beyond, a stiffness or mass may be negative */
    MT_TOLERANCE_BUDGET, /* beyond, nothing was proven: max_work ended */
    MT_TOLERANCE_MOST    /* the largest percentage that was asked about */
} mt_tolerance_end;

typedef struct mt_tolerance {
    /* proven: bands (their edges as given: leave out margins) and limits hold for every design
     * within */
    double percent;
    mt_tolerance_end end;
    mt_certify_edge edge; /* where end is EDGE */
} mt_tolerance;

/*
 * Tolerance boxes about x[n]: |x_i' - x_i| <= percent / 100 * unit_i, for all inputs together
 * (*all) and for each alone (each[n], may be NULL). unit NULL: |x_i|. They may leave the bounds
 * of the enclosures. Tolerances of bands and limits are not granted here: a design on an edge
 * (to 5e-10 of it) has 0 percent and the edge. Where an input enters K and M, up to
 * boxes_per_test sub-boxes (0: 64) tighten each of the some 30 tests of a box.
 * assignment[n_bands] is that of x. c->lower, upper, bounds, catalogues and cap are not used;
 * c->max_work is of all of them, *all first.
 */
typedef struct mt_tolerance_question {
    const double *x;
    const double *unit;
    const int *assignment;
    double most_percent;
    long boxes_per_test;
} mt_tolerance_question;
mt_status mt_certify_tolerance(const mt_certify *c, const mt_tolerance_question *q,
                               mt_arena *scratch, mt_tolerance *all, mt_tolerance *each,
                               mt_err *err);

#endif
