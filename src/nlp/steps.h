/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef NLP_STEPS_H
#define NLP_STEPS_H

#include "base/arena.h"
#include "base/serializer.h"

/*
 * How a search came to its answer: the designs that were better than all before them, in the
 * order of its tasks (start by start, never as workers took them up), with the evaluations up
 * to there. A function of the question alone, as all that it is made from is.
 */
typedef struct mt_step {
    long evals;       /* of all tasks before, and of its own up to here */
    int stage;        /* the objective that f belongs to, from 0 */
    int round;        /* grows where what counted before was found not to hold */
    double f;         /* as the search has it */
    double violation; /* the most of any row, of its tolerance; <= 1 is feasible */
    double squares;   /* of all that is missed */
} mt_step;

typedef struct mt_steps {
    int n;
    int most;
    mt_step *at; /* [most]; NULL: nothing is noted */
} mt_steps;

enum { MT_STEPS_OF_TASK = 16, MT_STEPS_MOST = 96 };

/* Room in mem for `most` of them, 8 or more, which is asked about shortages later. */
mt_steps mt_steps_new(int most, mt_arena *mem);
/* One more, if it is better than the last one of its stage and round, by more than
 * MT_EQUAL_FOUND. Where there is no room every other one goes, the first and the last of each
 * stage and round stay. */
void mt_steps_add(mt_steps *steps, const mt_step *step);
/* Those of another search, which began after so many evaluations. */
void mt_steps_append(mt_steps *steps, const mt_steps *more, long evals, int stage, int round);
/* What the search ended with, however it compares: better than the last of its stage, it is one
 * more step; worse, it begins a round of its own. */
void mt_steps_settle(mt_steps *steps, const mt_step *end);
/* base/serializer.h; stages and rounds are 0. */
void mt_steps_serialize(mt_steps *steps, mt_serializer *serializer);

#endif
