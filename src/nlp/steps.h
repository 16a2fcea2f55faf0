/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_STEPS_H
#define NLP_STEPS_H

#include "base/arena.h"
#include "base/workers.h"

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
