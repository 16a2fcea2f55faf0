/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_OBJECTIVES_H
#define STUDY_OBJECTIVES_H

#include <stdbool.h>

#include "expr/expr.h"
#include "io/members.h"

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

typedef struct mt_objective {
    mt_objective_type type;
    mt_expr expression;
    const char *expression_text;
    mt_name_list of; /* of mass: patterns of names of bodies, links, bars; none: all */
    mt_addr addr;
} mt_objective;

struct mt_study;
struct mt_goal;
/* True where the objective takes the goal's limit as its scale. The goal then requires nothing
 * else. */
bool mt_study_is_scale(const struct mt_study *study, const struct mt_goal *goal);
/* True where the objective is the misfit and every goal is a part of it: no goal then decides
 * whether a design is feasible. */
bool mt_study_is_fit(const struct mt_study *study);

extern const mt_key_table mt_study_objective_keys;

struct mt_study_reader;
struct mt_study_check;
void mt_read_study_objectives(struct mt_study_reader *s, mt_addr value);
/* Check them and what they need of goals, which are checked before; none: the change. */
void mt_study_check_objectives(struct mt_study_check *c);

#endif
