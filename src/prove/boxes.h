/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROVE_BOXES_H
#define PROVE_BOXES_H

#include "prove/certify.h"

/*
 * Boxes still to be looked at: a stack, bisected at the variable that is relatively widest (its
 * width in t over that at the start is 2^-depth, so a count of bisections says which; ties go
 * to the first). Depth first: the stack never holds more than one box per bisection. Along an
 * input with a catalogue a box begins and ends at values of it, and its halves leave the gap
 * between two values out. What is known of a box (n_known numbers, the caller's) holds in its
 * halves.
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
    const int *n_catalogue; /* as in the question; NULL: none */
    const double *const *catalogue;
    int n_known;
    int *known;     /* capacity x n_known */
    int *now_known; /* [n_known] of the box that was popped; the caller adds to it */
    double *now_lo; /* [n] the box that was popped */
    double *now_hi;
    signed char *now_depth;
    double *middle; /* [n] of it: with a catalogue, the value in the middle */
    double *beyond; /* [n] where its upper half begins */
} mt_boxes;

/* active: those on which any view, or bound, depends (loose_only: those that enter K and M of a
 * view). */
mt_status mt_boxes_init(mt_boxes *b, const mt_certify *c, bool loose_only, int n_known,
                        mt_arena *mem, mt_err *err);
/* Start over with one box, of which known[n_known] is known; none where a catalogue has no
 * value in it. */
void mt_boxes_start(mt_boxes *b, const double *lower, const double *upper, const int *known);
/* Take the next box (into now_*, middle); false where there is none. */
bool mt_boxes_pop(mt_boxes *b);
/* Put both halves of the box that was popped back; false where it is too small to be halved. */
bool mt_boxes_split(mt_boxes *b);

/* Set the box in all views. False where nothing is known over it in one of them. */
bool mt_certify_set(const mt_certify *c, const double *lo, const double *hi);

#endif
