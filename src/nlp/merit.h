/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_MERIT_H
#define NLP_MERIT_H

#include <stdbool.h>

/*
 * When a constraint is met, and which of two designs is the better one: one rule for points of
 * a search, ends of searches, combinations of a catalogue and answers of a trade study.
 */

/* What is held is met within its tolerance; a number that is recomputed may lie over it by its
 * rounding (of a logarithm, of eigenvalues). NaN: not met. */
bool mt_is_met(double violation, double tolerance);

/* What a row of room `room` is short of: 0 where it has some, NaN where it has no value. */
double mt_short_of(double room);

/* What is missed of all rows that are held. */
typedef struct mt_missed {
    double violation; /* the most of any, of its tolerance; NaN: a row has no value */
    double squares;   /* infinite then */
} mt_missed;
void mt_miss(mt_missed *m, double short_of, double tolerance);
mt_missed mt_missed_of(int n_eq, const double *eq, const double *eq_tol, int n_in,
                       const double *in, const double *in_tol);
/* True where a search holds its rows. It has to reach their tolerances themselves. */
bool mt_is_held(double violation);

/* What designs are ranked by. */
typedef struct mt_merit {
    bool feasible;
    double squares; /* of what is missed, where it is not feasible */
    int n;
    const double *f; /* [n] objectives in their order; less is better */
} mt_merit;

/* Designs that are evaluated alike: rounding on different ways to the same design. */
#define MT_EQUAL_JUDGED 0x1p-40
/* Designs that searches ended at: held objectives, their tolerances used or not. */
#define MT_EQUAL_FOUND 4e-6
/* Designs nearer than this in every coordinate (0.1 percent in a positive parameter) are
 * one. */
#define MT_SAME_DESIGN 1e-3

/* -1: a is less, 1: b is; 0: they differ by less than `equal`, relatively (of 1e-6, where both
 * are smaller); NaN is neither less nor more. */
int mt_compare(double a, double b, double equal);

/* True where a is better than b. One that meets all goals is better than one that does not, of
 * two that do not the one that misses less; then the objectives decide in their order, each as
 * mt_compare has it. */
bool mt_merit_before(const mt_merit *a, const mt_merit *b, double equal);

/* The change of the design t[n] from the original, 1/2 sum w_j (t_j - origin_j)^2; weight NULL:
 * 1 each. */
double mt_change(int n, const double *origin, const double *weight, const double *t);
/* Of two designs s[n] and t[n] that are as good: true where s counts. The one of less change
 * does; of those that mirror each other the one with less of the first coordinate that
 * differs. */
bool mt_is_nearer(int n, const double *origin, const double *weight, const double *s,
                  const double *t);

#endif
