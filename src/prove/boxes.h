/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_BOXES_H
#define PROVE_BOXES_H

#include "prove/certify.h"

/*
 * The stack of boxes not yet processed. A box is bisected at the variable of the largest
 * relative width (2^-depth of the width in t at the start, so that the count of bisections
 * decides; the first of equal ones). Depth first: the stack never holds more than one box per
 * bisection. Along an input with a catalogue a box begins and ends at values of it, and its
 * halves exclude the gap between two values; inputs that take rows together span the rows that
 * are within the box, and a box without a row is dropped. The knowledge about a box (n_known
 * numbers of the caller) holds in its halves.
 */
typedef struct mt_boxes {
    int n;
    int count;
    int capacity;
    double *lo; /* capacity x n */
    double *hi;
    signed char *depth;     /* capacity x n */
    bool *active;           /* [n] may be bisected */
    bool *logarithmic;      /* [n] */
    const int *n_catalogue; /* as in mt_certify; NULL: none */
    const double *const *catalogue;
    int n_rows;
    const mt_certify_rows *rows;
    int n_known;
    int *known;     /* capacity x n_known */
    int *now_known; /* [n_known] knowledge about the popped box; the caller adds to it */
    double *now_lo; /* [n] the popped box */
    double *now_hi;
    signed char *now_depth;
    double *split;  /* [n] where the popped box is halved; with a catalogue, the middle value */
    double *middle; /* [n] a design near that: the same, but of inputs that take rows a row */
    double *beyond; /* [n] lower end of its upper half */
} mt_boxes;

/* Active are the variables on which any view or bound depends (loose_only: those that enter
 * both K and M of a view). */
mt_status mt_boxes_init(mt_boxes *b, const mt_certify *c, bool loose_only, int n_known,
                        mt_arena *mem, mt_err *err);
/* Restart with one box with the knowledge known[n_known]; with none where a catalogue has no
 * value in it. */
void mt_boxes_start(mt_boxes *b, const double *lower, const double *upper, const int *known);
/* Take the next box (into now_*, middle); false where there is none. */
bool mt_boxes_pop(mt_boxes *b);
/* Push both halves of the popped box; false where it is too small to be halved. */
bool mt_boxes_split(mt_boxes *b);

/* Set the box in all views. False where one of them is not enclosed over it. */
bool mt_certify_set(const mt_certify *c, const double *lo, const double *hi);

#endif
