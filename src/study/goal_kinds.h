/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_GOAL_KINDS_H
#define STUDY_GOAL_KINDS_H

#include <stdbool.h>

#include "base/possible.h"

/*
 * The kinds of goals as a table: their names in files, the members that each reads, the
 * possible numbers of those, and how the deviation of a value is measured. Readers, checks,
 * trade studies and sentences go through it.
 *
 * X(slot, name, type, required, row) for each member: its place in an mt_goal, its name in
 * files, its type there (MT_KEY_... of io/reader.h), true where it is required, and the row of
 * base/possible.h with its possible numbers.
 */
#define MT_GOAL_ANY(X)                               \
    X(TYPE, "type", TEXT, true, NONE)                \
    X(DESCRIPTION, "description", TEXT, false, NONE) \
    X(SOURCE, "source", TEXT, false, NONE)           \
    X(TOLERANCE, "tolerance_percent", NUMBER, false, MET)
#define MT_GOAL_OF_CONFIGURATIONS(X)                     \
    MT_GOAL_ANY(X)                                       \
    X(CONFIGURATION, "configuration", TEXT, false, NONE) \
    X(CONFIGURATIONS, "configurations", LIST, false, NONE)
#define MT_GOAL_OF_MODE(X)       \
    MT_GOAL_OF_CONFIGURATIONS(X) \
    X(MODE, "mode", TEXT_OR_COUNT, true, WHOLE)

#define MT_GOAL_FREQUENCY_MEMBERS(X)                         \
    MT_GOAL_OF_MODE(X)                                       \
    X(EQUALS, "target_hz", NUMBER, false, ASKED)             \
    X(REFERENCE, "reference", TEXT, false, NONE)             \
    X(REFERENCE_MODE, "reference_mode", COUNT, false, WHOLE) \
    X(AT_LEAST, "at_least_hz", NUMBER, false, ASKED)         \
    X(AT_MOST, "at_most_hz", NUMBER, false, ASKED)           \
    X(WEIGHT, "weight", NUMBER, false, POSITIVE)
#define MT_GOAL_SHAPE_MEMBERS(X)                             \
    MT_GOAL_OF_MODE(X)                                       \
    X(REFERENCE, "reference", TEXT, true, NONE)              \
    X(REFERENCE_MODE, "reference_mode", COUNT, false, WHOLE) \
    X(LENGTH, "length_m", NUMBER, false, POSITIVE)           \
    X(WEIGHT, "weight", NUMBER, true, POSITIVE)
#define MT_GOAL_MAC_MEMBERS(X)                               \
    MT_GOAL_OF_MODE(X)                                       \
    X(REFERENCE, "reference", TEXT, true, NONE)              \
    X(REFERENCE_MODE, "reference_mode", COUNT, false, WHOLE) \
    X(LENGTH, "length_m", NUMBER, false, POSITIVE)           \
    X(AT_LEAST, "at_least", NUMBER, true, SHARE)
#define MT_GOAL_DAMPING_MEMBERS(X)                \
    MT_GOAL_OF_MODE(X)                            \
    X(EQUALS, "target", NUMBER, false, SHARE)     \
    X(AT_LEAST, "at_least", NUMBER, false, SHARE) \
    X(AT_MOST, "at_most", NUMBER, false, SHARE)   \
    X(WEIGHT, "weight", NUMBER, false, POSITIVE)
#define MT_GOAL_OF_PORTS(X, needs_input)             \
    MT_GOAL_OF_CONFIGURATIONS(X)                     \
    X(INPUT, "input", TEXT, needs_input, NONE)       \
    X(OUTPUT, "output", TEXT, true, NONE)            \
    X(EQUALS, "target", NUMBER, false, POSITIVE)     \
    X(AT_LEAST, "at_least", NUMBER, false, POSITIVE) \
    X(AT_MOST, "at_most", NUMBER, false, POSITIVE)   \
    X(WEIGHT, "weight", NUMBER, false, POSITIVE)
#define MT_GOAL_RESPONSE_MEMBERS(X)           \
    MT_GOAL_OF_PORTS(X, true)                 \
    X(BAND, "band_hz", NUMBERS, false, RANGE) \
    X(AT, "at_hz", NUMBER, false, POSITIVE)
#define MT_GOAL_VIBRATION_MEMBERS(X)        \
    MT_GOAL_OF_PORTS(X, false)              \
    X(PROFILE, "profile", TEXT, true, NONE) \
    X(QUANTITY, "quantity", TEXT, false, NONE)
#define MT_GOAL_FREQUENCY_RESPONSE_MEMBERS(X)       \
    MT_GOAL_OF_CONFIGURATIONS(X)                    \
    X(INPUT, "input", TEXT, true, NONE)             \
    X(OUTPUT, "output", TEXT, true, NONE)           \
    X(MEASUREMENT, "measurement", TEXT, true, NONE) \
    X(BAND, "band_hz", NUMBERS, false, BAND)        \
    X(COHERENCE, "coherence", BOOL, false, NONE)    \
    X(WEIGHT, "weight", NUMBER, true, POSITIVE)
#define MT_GOAL_LIMIT_MEMBERS(X)                  \
    MT_GOAL_ANY(X)                                \
    X(EXPRESSION, "expression", TEXT, true, NONE) \
    X(AT_LEAST, "at_least", NUMBER, false, LIMIT) \
    X(AT_MOST, "at_most", NUMBER, false, LIMIT)   \
    X(EQUALS, "equals", NUMBER, false, ANY)
#define MT_GOAL_AVOID_MEMBERS(X)                       \
    MT_GOAL_OF_CONFIGURATIONS(X)                       \
    X(BANDS, "bands_hz", NUMBERS, false, BAND)         \
    X(ROTOR, "rotor", OBJECT, false, NONE)             \
    X(ROTORS, "rotors", LIST, false, NONE)             \
    X(MACHINE, "machine", OBJECT, false, NONE)         \
    X(MACHINES, "machines", LIST, false, NONE)         \
    X(MARGIN, "margin_percent", NUMBER, false, MARGIN) \
    X(UP_TO, "up_to_hz", NUMBER, false, POSITIVE)      \
    X(CLUSTER, "cluster", COUNT, false, WHOLE)

/* X(id, name in files, unit of the numbers, measure of the deviation). The members of a kind
 * are MT_GOAL_<id>_MEMBERS, its operations mt_goal_<name> of problem/goals.h. */
#define MT_GOAL_LIST(X)                                       \
    X(FREQUENCY, frequency, "Hz", RATIO)                      \
    X(SHAPE, shape, "", DIFFERENCE)                           \
    X(MAC, mac, "", DIFFERENCE)                               \
    X(DAMPING, damping, "", PART)                             \
    X(RESPONSE, response, "", RATIO)                          \
    X(VIBRATION, vibration, "", RATIO)                        \
    X(FREQUENCY_RESPONSE, frequency_response, "", DIFFERENCE) \
    X(LIMIT, limit, "", PART)                                 \
    X(AVOID, avoid, "Hz", RATIO)
#define MT_GOAL_ENUM(id, ...) MT_GOAL_##id,
typedef enum mt_goal_type { MT_GOAL_LIST(MT_GOAL_ENUM) MT_GOAL_TYPE_COUNT } mt_goal_type;
#undef MT_GOAL_ENUM

/* The place of a member. The first ones index mt_goal.number[] of any goal. */
typedef enum mt_goal_slot {
    MT_SLOT_EQUALS,
    MT_SLOT_AT_LEAST,
    MT_SLOT_AT_MOST,
    MT_SLOT_TOLERANCE,
    MT_SLOT_WEIGHT,
    MT_SLOT_LENGTH,
    MT_GOAL_NUMBERS,
    MT_SLOT_MARGIN = MT_GOAL_NUMBERS, /* from here on each is placed by its reader */
    MT_SLOT_UP_TO,
    MT_SLOT_TYPE,
    MT_SLOT_DESCRIPTION,
    MT_SLOT_SOURCE,
    MT_SLOT_CONFIGURATION,
    MT_SLOT_CONFIGURATIONS,
    MT_SLOT_MODE,
    MT_SLOT_REFERENCE,
    MT_SLOT_REFERENCE_MODE,
    MT_SLOT_EXPRESSION,
    MT_SLOT_BANDS,
    MT_SLOT_ROTOR,
    MT_SLOT_ROTORS,
    MT_SLOT_MACHINE,
    MT_SLOT_MACHINES,
    MT_SLOT_CLUSTER,
    MT_SLOT_INPUT,
    MT_SLOT_OUTPUT,
    MT_SLOT_BAND,
    MT_SLOT_AT,
    MT_SLOT_PROFILE,
    MT_SLOT_QUANTITY,
    MT_SLOT_MEASUREMENT,
    MT_SLOT_COHERENCE
} mt_goal_slot;

/* Deviation of a value v from the requested value v0. */
typedef enum mt_goal_measure {
    MT_MEASURE_RATIO,      /* ln(v / v0) */
    MT_MEASURE_PART,       /* (v - v0) / |v0|, or v where v0 is 0 */
    MT_MEASURE_DIFFERENCE, /* v - v0 */
} mt_goal_measure;

typedef struct mt_goal_member {
    mt_goal_slot slot;
    const char *name;
    bool required;
    mt_possible_id possible;
} mt_goal_member;

typedef struct mt_goal_kind {
    const char *name;
    const char *unit; /* "": none, or that of the goal's expression */
    mt_goal_measure measure;
    int n;
    const mt_goal_member *members; /* [n] in the order in which readers read them */
} mt_goal_kind;

const mt_goal_kind *mt_goal_kind_of(mt_goal_type type);
/* Index of a member among those of its kind; -1: the kind has none. */
int mt_goal_member_at(const mt_goal_kind *kind, mt_goal_slot slot);
/* The member's name in files; NULL: the kind has no such member. */
const char *mt_goal_member_name(const mt_goal_kind *kind, mt_goal_slot slot);
/* The scale of a deviation: what the difference v - asked is divided by. */
double mt_measure_unit(mt_goal_measure measure, double asked);
/* True where the member is one of the numbers that a trade study may vary. */
bool mt_goal_may_vary(const mt_goal_member *member);

#endif
