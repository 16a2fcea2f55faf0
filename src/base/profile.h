/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_PROFILE_H
#define BASE_PROFILE_H

#include <stdatomic.h>

/*
 * The stages of an evaluation, in order. A stage is computed again only where a value that it
 * depends on has changed since its last computation; otherwise it is skipped, because it would
 * give the same bits.
 */
#define MT_STAGE_LIST(X)                                                 \
    X(PROGRAM, "program", "numbers of the model from the inputs")        \
    X(GEOMETRY, "geometry", "positions, constraints, rows of the terms") \
    X(TANGENT, "tangent", "derivatives of these")                        \
    X(REDUCTION, "reduction", "basis of the freedoms, reduced rows")     \
    X(STIFFNESS, "stiffness", "reduced stiffness matrix")                \
    X(MASS, "mass", "reduced mass matrix")                               \
    X(MODES, "modes", "factor of the mass, eigenvalues, shapes, bounds")

#define MT_STAGE_ID(id, name, text) MT_STAGE_##id,
typedef enum mt_stage_id { MT_STAGE_LIST(MT_STAGE_ID) MT_STAGES } mt_stage_id;
#undef MT_STAGE_ID

/* Work of one evaluator. */
typedef struct mt_stage_counts {
    long done[MT_STAGES];
    long shared[MT_STAGES]; /* taken from another evaluator of the same worker */
    long skipped[MT_STAGES];
    double seconds[MT_STAGES]; /* 0 without a clock */
} mt_stage_counts;

/* Work of all evaluators of a model, any number of workers. */
typedef struct mt_profile {
    double (*clock_s)(void); /* CPU time of the thread [s] */
    atomic_long done[MT_STAGES];
    atomic_long shared[MT_STAGES];
    atomic_long skipped[MT_STAGES];
    atomic_llong nanoseconds[MT_STAGES];
} mt_profile;

void mt_profile_init(mt_profile *p, double (*clock_s)(void));
/* Add the work of an evaluator; p NULL: does nothing. */
void mt_profile_add(mt_profile *p, const mt_stage_counts *counts);
/* CPU time of the thread [s] where p has a clock; otherwise 0. */
double mt_profile_now(const mt_profile *p);
/* Name ("geometry") and description of a stage. */
const char *mt_stage_name(mt_stage_id stage);
const char *mt_stage_text(mt_stage_id stage);

#endif
