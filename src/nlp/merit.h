/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_MERIT_H
#define NLP_MERIT_H

#include <stdbool.h>

#include "base/arena.h"
#include "base/workers.h"

/*
 * One rule for meeting a constraint and for ranking two designs: points and ends of a search,
 * combinations of a catalogue, answers of a trade study.
 */

/* True where violation <= tolerance (1 + 1e-6): a recomputed number may exceed the tolerance by
 * its rounding (of a logarithm, of eigenvalues). NaN: not met. */
bool mt_is_met(double violation, double tolerance);

/* Shortfall of a row with the margin `room`: max(-room, 0); NaN where it has no value. */
double mt_short_of(double room);

/* Violations over all rows that are held. */
typedef struct mt_missed {
    double violation; /* largest violation / tolerance; NaN: a row has no value */
    double squares;   /* sum of squares of the violations; infinite where a row has no value */
} mt_missed;
void mt_miss(mt_missed *m, double short_of, double tolerance);
mt_missed mt_missed_of(int n_eq, const double *eq, const double *eq_tol, int n_in,
                       const double *in, const double *in_tol);
/* True where violation <= 1: a search must reach the tolerances themselves. */
bool mt_is_held(double violation);

/* What ranks a design. */
typedef struct mt_merit {
    bool feasible;
    double squares; /* of the violations, where not feasible */
    int n;
    const double *f; /* [n] objectives in their order; smaller is better */
} mt_merit;

/* Values of designs evaluated in the same way: rounding along different paths to one design. */
#define MT_EQUAL_JUDGED 0x1p-40
/* Values at the ends of searches: objectives under constraints, whose tolerances may be used or
 * not. */
#define MT_EQUAL_FOUND 4e-6
/* Designs nearer than this in every coordinate (0.1 percent in a positive parameter) are
 * one. */
#define MT_SAME_DESIGN 1e-3
/* KKT residuals up to this are those of local solutions. */
#define MT_STATIONARY 1e-6

/* -1 where a < b, 1 where b < a; 0 where |a - b| <= equal max(|a|, |b|, 1e-6), or where one is
 * NaN. */
int mt_compare(double a, double b, double equal);

/* True where a is better than b. A feasible design is better than an infeasible one, and of two
 * infeasible ones the one with the smaller squares; then the objectives decide in their order,
 * each by mt_compare. */
bool mt_merit_before(const mt_merit *a, const mt_merit *b, double equal);

/* Half of the squared total change of the design t[n], 1/2 sum w_j (t_j - origin_j)^2; weight
 * NULL: 1 each. */
double mt_change(int n, const double *origin, const double *weight, const double *t);
/* Tie-break of two equally good designs: true where s[n] precedes t[n], by total change, then
 * (mirror images) by the first coordinate that differs, smaller first. */
bool mt_is_nearer(int n, const double *origin, const double *weight, const double *s,
                  const double *t);

/*
 * The improvements of a search: the designs that were better than all before them, in the order
 * of its tasks (start by start, whatever the workers' order), with the evaluations up to each.
 * Deterministic for equal input.
 */
typedef struct mt_step {
    long evals;       /* of all earlier tasks, and of its own so far */
    int stage;        /* the objective that f belongs to, from 0 */
    int round;        /* increased where an earlier step was found not to hold */
    double f;         /* value in the search */
    double violation; /* largest violation / tolerance of a row; <= 1 is feasible */
    double squares;   /* sum of squares of the violations */
} mt_step;

typedef struct mt_steps {
    int n;
    int most;
    mt_step *at; /* [most]; NULL: no record is kept */
} mt_steps;

enum { MT_STEPS_OF_TASK = 16, MT_STEPS_MOST = 96 };

/* A record in mem with capacity `most`, 8 or more. The caller checks mem for shortage. */
mt_steps mt_steps_new(int most, mt_arena *mem);
/* Adds a step where it is better than the last one of its stage and round, by more than
 * MT_EQUAL_FOUND. A full record drops every other step; the first and the last of each stage
 * and round stay. */
void mt_steps_add(mt_steps *steps, const mt_step *step);
/* Adds the steps of another search that began after `evals` evaluations. */
void mt_steps_append(mt_steps *steps, const mt_steps *more, long evals, int stage, int round);
/* Adds the end of the search in any case: in the last round of its stage where it is not worse
 * than that round's last step, else in a new round. */
void mt_steps_settle(mt_steps *steps, const mt_step *end);
/* Writes or reads the steps (base/workers.h); stages and rounds are 0. */
void mt_steps_serialize(mt_steps *steps, mt_serializer *serializer);

#endif
