/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MECHANICS_STAGES_H
#define MECHANICS_STAGES_H

#include "base/run.h"
#include "mechanics/rows.h"

/*
 * Inputs that each stage of a linearised system depends on, by the structure of its program,
 * and their values at its last computation. Sets of inputs are bit sets, as in the program.
 */
typedef struct mt_stages {
    int n_inputs;
    int words;
    uint64_t *loaded;    /* `shape` and `forces` of the system (system.h) */
    uint64_t *stiffness; /* coefficients of K */
    uint64_t *mass;      /* coefficients of M */
    uint64_t *all;
    uint64_t *none;
    double *at[MT_STAGES]; /* [n_inputs] */
    bool valid[MT_STAGES]; /* the results of the stage are valid for the inputs `at` */
    mt_stage_counts counts;
    double started_s;    /* start of the current stage */
    mt_profile *profile; /* NULL: not reported; not owned */
} mt_stages;

/* lists[MT_TERM_KINDS]. In mem; a failure is the arena's. */
void mt_stages_init(mt_stages *s, const mt_system *sys, const mt_term_list *lists,
                    mt_arena *mem);
/* True where the stage has to be computed, if it depends on the inputs of `set` only. Bits are
 * compared. A stage to be computed is not valid until mt_stages_done; another one is counted as
 * skipped. */
bool mt_stages_begin(mt_stages *s, mt_stage_id stage, const uint64_t *set,
                     const double *inputs);
void mt_stages_done(mt_stages *s, mt_stage_id stage, const double *inputs);
/* Instead of done: the results were taken from another system. */
void mt_stages_shared(mt_stages *s, mt_stage_id stage, const double *inputs);
/* True where the inputs of the set have the same bits. */
bool mt_stages_same(const mt_stages *s, const uint64_t *set, const double *at,
                    const double *inputs);
bool mt_stages_has(const uint64_t *set, int input);
/* True where the set is empty. */
bool mt_stages_empty(const mt_stages *s, const uint64_t *set);

#endif
