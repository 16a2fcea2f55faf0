/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_OBJECTIVE_KINDS_H
#define STUDY_OBJECTIVE_KINDS_H

#include <stdbool.h>

/*
 * The kinds of objectives as a table: X(id, name, unit in results, properties). The operations
 * of a kind are mt_objective_<name> of problem/objective.h. Properties:
 *     WORD         files name it by its name (an expression is its own text)
 *     MAXIMISED    its value is the negative of the quantity that is maximised
 *     HALF_SQUARE  its value is half the square of the value in results; it has a derivative
 *                  where the square's root has none
 *     AMOUNT       without a natural size: two values are compared relative to themselves
 *     RESIDUALS    half the square of the weighted goals' residuals, which it needs
 *     BANDS        of the bands that goals keep clear of, which it needs; a coordinate of the
 *                  search for one mode placement, elsewhere found among the modes
 *     SHAKES       of the goals of forced vibration that are limited from above, which it
 *                  needs, and which then limit nothing; a coordinate of the search, elsewhere
 *                  found among the responses
 *     OF_ITEMS     "of" may list items
 *     FRONT        can be one side of a Pareto front; with OF_STUDY, if the study has it
 */
#define MT_OBJECTIVE_LIST(X)                                                                \
    X(NONE, none, "", 0)                                                                    \
    X(CHANGE, change, "", MT_WORD | MT_HALF_SQUARE | MT_FRONT)                              \
    X(MASS, mass, "kg", MT_WORD | MT_AMOUNT | MT_OF_ITEMS | MT_FRONT | MT_OF_STUDY)         \
    X(EXPRESSION, expression, "", MT_AMOUNT)                                                \
    X(MISFIT, misfit, "", MT_WORD | MT_HALF_SQUARE | MT_RESIDUALS | MT_FRONT | MT_OF_STUDY) \
    X(CLEARANCE, clearance, "%", MT_WORD | MT_MAXIMISED | MT_BANDS | MT_FRONT)              \
    X(VIBRATION, vibration, "%", MT_WORD | MT_SHAKES | MT_FRONT)
#define MT_OBJECTIVE_ENUM(id, ...) MT_OBJECTIVE_##id,
typedef enum mt_objective_type {
    MT_OBJECTIVE_LIST(MT_OBJECTIVE_ENUM) MT_OBJECTIVE_TYPE_COUNT
} mt_objective_type;
#undef MT_OBJECTIVE_ENUM

enum {
    MT_WORD = 1,
    MT_MAXIMISED = 2,
    MT_HALF_SQUARE = 4,
    MT_AMOUNT = 8,
    MT_OF_ITEMS = 16,
    MT_FRONT = 32,
    MT_OF_STUDY = 64,
    MT_RESIDUALS = 128,
    MT_BANDS = 256,
    MT_SHAKES = 512
};

typedef struct mt_objective_kind {
    const char *name;
    const char *unit; /* of the value in results */
    unsigned properties;
} mt_objective_kind;

const mt_objective_kind *mt_objective_kind_of(mt_objective_type type);
/* The kinds that have all of these properties, in the order of the table: types[] and names[],
 * both of MT_OBJECTIVE_TYPE_COUNT. Returns their number. */
int mt_objectives_with(unsigned properties, mt_objective_type *types, const char **names);
/* True where the kind has all of these properties. */
bool mt_objective_is(mt_objective_type type, unsigned properties);

#endif
