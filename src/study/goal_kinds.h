/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_GOAL_KINDS_H
#define STUDY_GOAL_KINDS_H

#include <stdbool.h>

#include "base/possible.h"

/*
 * The kinds of goals as a table: their names in files, the members that each reads, the
 * possible numbers of those, and how the deviation of a value is measured. Readers, checks,
 * trade studies, sentences and the JSON Schema go through it.
 *
 * X(slot, name, type, required, row, sentence, ...) for each member: its place in an mt_goal,
 * its name in files, its type there (MT_KEY_... of io/reader.h), true where it is required, the
 * row of base/possible.h with its possible numbers, its sentence in the JSON Schema, and what
 * other columns of an mt_key it has.
 */
#define MT_GOAL_ANY(X, tolerance)                                             \
    X(TYPE, "type", TEXT, true, NONE, "What kind of goal this is.")           \
    X(DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.") \
    X(SOURCE, "source", TEXT, false, NONE,                                    \
      "Where it comes from: a table, a page, a test report.")                 \
    X(TOLERANCE, "tolerance_percent", NUMBER, false, MET, tolerance, .otherwise = "0.0001")
#define MT_GOAL_TOLERANCE "The goal is met within this, in percent of the demand."
#define MT_GOAL_OF_CONFIGURATIONS(X, tolerance)                  \
    MT_GOAL_ANY(X, tolerance)                                    \
    X(CONFIGURATION, "configuration", TEXT, false, NONE,         \
      "Configuration of the model. Absent: its only one.")       \
    X(CONFIGURATIONS, "configurations", LIST, false, NONE,       \
      "Several configurations: the goal holds in each of them.", \
      .what = "the list of configurations")
#define MT_GOAL_OF_MODE(X, mode)                    \
    MT_GOAL_OF_CONFIGURATIONS(X, MT_GOAL_TOLERANCE) \
    X(MODE, "mode", TEXT_OR_COUNT, true, WHOLE, mode)
/* A mode by its index, in the JSON Schema */
#define MT_GOAL_INDEX "\"allOf\": [{\"$ref\": \"#/definitions/index\"}]"
#define MT_GOAL_REFERENCE_MODE(X)                            \
    X(REFERENCE_MODE, "reference_mode", COUNT, false, WHOLE, \
      "Mode of the reference. Absent: the same index as \"mode\".", .schema = MT_GOAL_INDEX)
#define MT_GOAL_OF_REFERENCE(X)                                                                \
    X(REFERENCE, "reference", TEXT, true, NONE, "Name of one of the study's references.")      \
    MT_GOAL_REFERENCE_MODE(X)                                                                  \
    X(LENGTH, "length_m", NUMBER, false, POSITIVE,                                             \
      "Where sensors of displacements and of rotations are compared together: the length [m] " \
      "at which a rotation counts as its arc, above 0. Absent: the model's length, with a "    \
      "warning.")

#define MT_GOAL_FREQUENCY_MEMBERS(X)                                                      \
    MT_GOAL_OF_MODE(X, "Which mode: index from 1 or name.")                               \
    X(EQUALS, "target_hz", NUMBER, false, ASKED,                                          \
      "Wanted frequency [Hz]; excludes the limits.")                                      \
    X(REFERENCE, "reference", TEXT, false, NONE,                                          \
      "Name of one of the study's references: the wanted frequency is that of its mode. " \
      "Excludes \"target_hz\" and the limits.")                                           \
    MT_GOAL_REFERENCE_MODE(X)                                                             \
    X(AT_LEAST, "at_least_hz", NUMBER, false, ASKED, "Lower limit [Hz].")                 \
    X(AT_MOST, "at_most_hz", NUMBER, false, ASKED, "Upper limit [Hz].")                   \
    X(WEIGHT, "weight", NUMBER, false, POSITIVE,                                          \
      "With a weight the goal is a residual of the objective \"misfit\", "                \
      "ln(frequency/target), instead of a constraint.")
#define MT_GOAL_SHAPE_MEMBERS(X)                            \
    MT_GOAL_OF_MODE(X, "Which mode: index from 1 or name.") \
    MT_GOAL_OF_REFERENCE(X)                                 \
    X(WEIGHT, "weight", NUMBER, true, POSITIVE, "Weight of the residuals (no unit), above 0.")
#define MT_GOAL_MAC_MEMBERS(X)                              \
    MT_GOAL_OF_MODE(X, "Which mode: index from 1 or name.") \
    MT_GOAL_OF_REFERENCE(X)                                 \
    X(AT_LEAST, "at_least", NUMBER, true, SHARE, "Least MAC, above 0 and at most 1.")
#define MT_GOAL_DAMPING_MEMBERS(X)                                                            \
    MT_GOAL_OF_MODE(                                                                          \
        X, "Which mode: index from 1 of those that oscillate with damping, by their natural " \
           "frequency, or name: the one with most of that mode in its shape.")                \
    X(EQUALS, "target", NUMBER, false, SHARE,                                                 \
      "Wanted ratio, above 0 and at most 1; excludes the limits.")                            \
    X(AT_LEAST, "at_least", NUMBER, false, SHARE, "Least ratio, above 0 and at most 1.")      \
    X(AT_MOST, "at_most", NUMBER, false, SHARE, "Greatest ratio, above 0 and at most 1.")     \
    X(WEIGHT, "weight", NUMBER, false, POSITIVE,                                              \
      "With a weight the goal is a residual of the objective \"misfit\", (ratio - "           \
      "target)/target, instead of a constraint.")
#define MT_GOAL_OUTPUT(X)                                                                  \
    X(OUTPUT, "output", TEXT, true, NONE,                                                  \
      "The output: a sensor's motion (\"grip.x\", \"grip.x:acceleration\", "               \
      "\"grip.x:relative_displacement\"; displacement where it does not say), or a force " \
      "(\"spring.NAME\", \"damper.NAME\", of a bushing a component, \"spring.NAME.x\", "   \
      "\"spring.NAME.rx\"; \"joint.NAME.x\").")
#define MT_GOAL_RESPONSE_MEMBERS(X)                                                          \
    MT_GOAL_OF_CONFIGURATIONS(X, MT_GOAL_TOLERANCE)                                          \
    X(INPUT, "input", TEXT, true, NONE,                                                      \
      "The excitation: the ground along an axis (\"base.z\"; its acceleration, or "          \
      "\"base.z:displacement\", \"base.z:velocity\"), or a force at a sensor (\"grip.x\"; "  \
      "\"grip.rx\" is a moment).")                                                           \
    MT_GOAL_OUTPUT(X)                                                                        \
    X(EQUALS, "target", NUMBER, false, POSITIVE,                                             \
      "Wanted value, above 0, at one frequency; excludes the limits.")                       \
    X(AT_LEAST, "at_least", NUMBER, false, POSITIVE,                                         \
      "Least value, above 0, at one frequency.")                                             \
    X(AT_MOST, "at_most", NUMBER, false, POSITIVE,                                           \
      "Greatest value, above 0 [SI: m/s^2 per N].")                                          \
    X(WEIGHT, "weight", NUMBER, false, POSITIVE,                                             \
      "With a weight the goal is a residual of the objective \"misfit\", ln(value/target), " \
      "instead of a constraint.")                                                            \
    X(BAND, "band_hz", NUMBERS, false, RANGE,                                                \
      "Lower and upper frequency [Hz], above 0: the largest value between them, which is "   \
      "found and proven, not sampled.")                                                      \
    X(AT, "at_hz", NUMBER, false, POSITIVE, "One frequency [Hz], above 0.")
#define MT_GOAL_VIBRATION_MEMBERS(X)                                                           \
    MT_GOAL_OF_CONFIGURATIONS(X, MT_GOAL_TOLERANCE)                                            \
    X(INPUT, "input", TEXT, false, NONE,                                                       \
      "Axis along which the ground accelerates: \"base.x\", \"base.y\" or \"base.z\". "        \
      "Absent: that of the profile.")                                                          \
    MT_GOAL_OUTPUT(X)                                                                          \
    X(EQUALS, "target", NUMBER, false, POSITIVE,                                               \
      "Wanted value, above 0, of the RMS; excludes the limits.")                               \
    X(AT_LEAST, "at_least", NUMBER, false, POSITIVE, "Least value, above 0, of the RMS.")      \
    X(AT_MOST, "at_most", NUMBER, false, POSITIVE, "Greatest value, above 0 [SI: m/s^2].")     \
    X(WEIGHT, "weight", NUMBER, false, POSITIVE,                                               \
      "With a weight the goal is a residual of the objective \"misfit\", ln(value/target), "   \
      "instead of a constraint.")                                                              \
    X(PROFILE, "profile", TEXT, true, NONE,                                                    \
      "File of the profile, relative to this one; or the name of one that is part of the "     \
      "program (`modetune profile` lists them).",                                              \
      .examples = "[\"helicopter_uh60_panel\", \"../problems/profiles/truck_vertical.json\"]") \
    X(QUANTITY, "quantity", TEXT, false, NONE,                                                 \
      "What of it counts: \"rms\" of the random parts; \"sine\", the peaks of the tones by "   \
      "the rule of the profile, each the largest over its range; \"peak\": sigma times the "   \
      "RMS and the tones.",                                                                    \
      .otherwise = "\"rms\"", .choices = mt_response_limit_names + MT_RESPONSE_LIMIT_RMS,      \
      .n_choices = MT_RESPONSE_LIMIT_QUANTITIES - MT_RESPONSE_LIMIT_RMS)
#define MT_GOAL_FREQUENCY_RESPONSE_MEMBERS(X)                                               \
    MT_GOAL_OF_CONFIGURATIONS(X, MT_GOAL_TOLERANCE)                                         \
    X(INPUT, "input", TEXT, true, NONE, "The input, as for response --input.",              \
      .examples = "[\"grip.x\"]")                                                           \
    X(OUTPUT, "output", TEXT, true, NONE, "The output, as for response --output.",          \
      .examples = "[\"grip.x:acceleration\"]")                                              \
    X(MEASUREMENT, "measurement", TEXT, true, NONE,                                         \
      "Name of one of the study's measurements.")                                           \
    X(BAND, "band_hz", NUMBERS, false, BAND,                                                \
      "The range of measured frequencies that is used [Hz]. Absent: all of them.")          \
    X(COHERENCE, "coherence", BOOL, false, NONE,                                            \
      "Let lines weigh by their coherence g2, as g2/(1 - g2), 1 - g2 being 0.01 at least.", \
      .otherwise = "false")                                                                 \
    X(WEIGHT, "weight", NUMBER, true, POSITIVE, "Weight of the residuals (no unit), above 0.")
#define MT_GOAL_LIMIT_MEMBERS(X)                                                               \
    MT_GOAL_ANY(                                                                               \
        X,                                                                                     \
        "The goal is met within this, in percent of the demand; of a demand of 0 in percent "  \
        "of what the expression changes by at the original design where every variable "       \
        "changes by 1 in its coordinate (a logarithm by a factor of e), whatever the units.")  \
    X(EXPRESSION, "expression", TEXT, true, NONE,                                              \
      "Expression of the model's parameters, evaluated at every design.",                      \
      .examples = "[\"M_SAU + m_crank\"]")                                                     \
    X(AT_LEAST, "at_least", NUMBER, false, LIMIT,                                              \
      "Lower limit, in the unit of the expression.")                                           \
    X(AT_MOST, "at_most", NUMBER, false, LIMIT, "Upper limit, in the unit of the expression.") \
    X(EQUALS, "equals", NUMBER, false, ANY,                                                    \
      "Wanted value, in the unit of the expression; excludes the limits.")
#define MT_GOAL_AVOID_MEMBERS(X)                                                              \
    MT_GOAL_OF_CONFIGURATIONS(X, "The goal is met within this, in percent of a band's edge.") \
    X(BANDS, "bands_hz", NUMBERS, false, BAND, "Bands [lower, upper] [Hz].",                  \
      .examples = "[[[15.5, 18.9]]]",                                                         \
      .schema = "\"type\": \"array\", \"minItems\": 1, \"items\": {\"$ref\": "                \
                "\"#/definitions/pair\"}")                                                    \
    X(ROTOR, "rotor", OBJECT, false, NONE, NULL, .of = &mt_study_rotor_keys)                  \
    X(ROTORS, "rotors", LIST, false, NONE, "Several rotors.", .what = "the list of rotors",   \
      .of = &mt_study_rotor_keys)                                                             \
    X(MACHINE, "machine", OBJECT, false, NONE, NULL, .of = &mt_study_machine_keys)            \
    X(MACHINES, "machines", LIST, false, NONE, "Several machines.",                           \
      .what = "the list of machines", .of = &mt_study_machine_keys)                           \
    X(MARGIN, "margin_percent", NUMBER, false, MARGIN,                                        \
      "Separation margin on both sides of every band, in percent of its edges: of "           \
      "\"bands_hz\", and of rotors and machines that give none.",                             \
      .otherwise = "0")                                                                       \
    X(UP_TO, "up_to_hz", NUMBER, false, POSITIVE,                                             \
      "Bands are cut off at this frequency [Hz]; modes above it are free.")                   \
    X(CLUSTER, "cluster", COUNT, false, WHOLE,                                                \
      "Number of neighbouring modes on each side of a band that the search constrains "       \
      "individually.",                                                                        \
      .least = 1, .most = MT_MAX_CLUSTER, .otherwise = "2")

/* X(id, name in files, unit of the numbers, measure of the deviation, sentence of the JSON
 * Schema, what holds of members together there). The members of a kind are
 * MT_GOAL_<id>_MEMBERS, its operations mt_goal_<name> of problem/goals.h. */
#define MT_GOAL_LIST(X)                                                                        \
    X(FREQUENCY, frequency, "Hz", RATIO,                                                       \
      "A natural frequency: equal to a target or to that of a reference, or within limits.",   \
      "\"dependencies\": {\"reference_mode\": [\"reference\"]}, \"not\": {\"required\": "      \
      "[\"configuration\", \"configurations\"]}")                                              \
    X(SHAPE, shape, "", DIFFERENCE,                                                            \
      "A mode shape close to a reference's: a residual of the objective \"misfit\" "           \
      "(difference of unit vectors at the common sensors).",                                   \
      "\"not\": {\"required\": [\"configuration\", \"configurations\"]}")                      \
    X(MAC, mac, "", DIFFERENCE, "A modal assurance criterion with a reference's shape.",       \
      "\"not\": {\"required\": [\"configuration\", \"configurations\"]}")                      \
    X(DAMPING, damping, "", PART,                                                              \
      "The damping ratio of a complex mode: at a target, or within limits. No proof covers "   \
      "it.",                                                                                   \
      "\"not\": {\"required\": [\"configuration\", \"configurations\"]}")                      \
    X(RESPONSE, response, "", RATIO,                                                           \
      "A limit on a frequency response: the amplitude of an output for an input of 1, at one " \
      "frequency or the largest over a band.",                                                 \
      "\"not\": {\"required\": [\"configuration\", \"configurations\"]}, \"oneOf\": "          \
      "[{\"required\": [\"band_hz\"]}, {\"required\": [\"at_hz\"]}]")                          \
    X(VIBRATION, vibration, "", RATIO,                                                         \
      "A limit on the vibration of an output under a vibration profile.",                      \
      "\"not\": {\"required\": [\"configuration\", \"configurations\"]}")                      \
    X(FREQUENCY_RESPONSE, frequency_response, "", DIFFERENCE,                                  \
      "A frequency response close to a measured one: residuals of the objective \"misfit\", "  \
      "ln(response/measured) at each of the measured frequencies, each with 1/N of the "       \
      "weight.",                                                                               \
      "\"not\": {\"required\": [\"configuration\", \"configurations\"]}")                      \
    X(LIMIT, limit, "", PART, "A limit on an expression of the parameters.", "")               \
    X(AVOID, avoid, "Hz", RATIO,                                                               \
      "Forbidden frequency bands: every mode keeps clear of them. Bands that overlap are "     \
      "merged.",                                                                               \
      "\"anyOf\": [{\"required\": [\"bands_hz\"]}, {\"required\": [\"rotor\"]}, "              \
      "{\"required\": [\"rotors\"]}, {\"required\": [\"machine\"]}, {\"required\": "           \
      "[\"machines\"]}], \"allOf\": [{\"not\": {\"required\": [\"configuration\", "            \
      "\"configurations\"]}}, {\"not\": {\"required\": [\"rotor\", \"rotors\"]}}, {\"not\": "  \
      "{\"required\": [\"machine\", \"machines\"]}}]")
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
