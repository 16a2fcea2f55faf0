/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_TOLERANCE_H
#define PROVE_TOLERANCE_H

#include "prove/certify.h"

/* An edge that a mode must not cross: "mode 3 stays above 9.46 Hz". */
typedef struct mt_certify_edge {
    int view;
    int band;  /* -1: a limit's */
    int limit; /* -1: a band's */
    int mode;
    double hz;
    bool above; /* the mode must stay above hz; else below */
} mt_certify_edge;

typedef enum mt_tolerance_end {
    /* beyond it the mode of `edge` may cross it (or, where the enclosure is loose, is not
     * proven not to) */
    MT_TOLERANCE_EDGE,
    MT_TOLERANCE_DOMAIN, /* beyond it a stiffness or mass may be negative */
    MT_TOLERANCE_BUDGET, /* beyond it nothing was proven: max_work was spent */
    MT_TOLERANCE_MOST    /* most_percent was reached */
} mt_tolerance_end;

typedef struct mt_tolerance {
    /* proven: bands (with the edges given, so leave out margins) and limits hold for every
     * design within */
    double percent;
    mt_tolerance_end end;
    mt_certify_edge edge; /* where end is EDGE */
} mt_tolerance;

/*
 * Tolerance boxes about x[n]: |x_i' - x_i| <= percent / 100 * unit_i, for all inputs together
 * (*all) and for each alone (each[n], may be NULL). unit NULL: |x_i|. They may exceed the
 * bounds of the enclosures. Edges are not moved by the tolerances of bands and limits: a design
 * on an edge (to 5e-10 of it) has 0 percent and that edge. Where an input enters K and M, up to
 * boxes_per_test sub-boxes (0: 64) tighten each of the some 30 tests of a box.
 * assignment[n_bands] is that of x. c->lower, upper, bounds, catalogues and cap are not used;
 * c->max_work is the budget of all boxes together, *all first.
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
