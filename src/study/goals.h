/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_GOALS_H
#define STUDY_GOALS_H

#include "io/members.h"
#include "study/avoid.h"
#include "study/energy_goal.h"
#include "study/response_limit.h"

/*
 * Goals: their kinds, what they demand, and the table of members of each kind. A kind is its
 * line in MT_GOAL_LIST and its table mt_goal_<name>_keys: reader, checks, trade study, doubts,
 * relaxation, sentences and the JSON Schema go through these. Its operations are
 * mt_goal_<name> of problem/goals.h.
 *
 * X(id, name in files, unit of the numbers, measure of the deviation)
 */
#define MT_GOAL_LIST(X)                                       \
    X(FREQUENCY, frequency, "Hz", RATIO)                      \
    X(SHAPE, shape, "", DIFFERENCE)                           \
    X(MAC, mac, "", DIFFERENCE)                               \
    X(DAMPING, damping, "", PART)                             \
    X(ENERGY, energy, "%", PART)                              \
    X(RESPONSE, response, "", RATIO)                          \
    X(VIBRATION, vibration, "", RATIO)                        \
    X(FREQUENCY_RESPONSE, frequency_response, "", DIFFERENCE) \
    X(STATIC, static, "", PART)                               \
    X(LIMIT, limit, "", PART)                                 \
    X(AVOID, avoid, "Hz", RATIO)                              \
    X(RATIO, ratio, "", RATIO)                                \
    X(APART, apart, "%", PART)
#define MT_GOAL_ENUM(id, ...) MT_GOAL_##id,
typedef enum mt_goal_type { MT_GOAL_LIST(MT_GOAL_ENUM) MT_GOAL_TYPE_COUNT } mt_goal_type;
#undef MT_GOAL_ENUM

/* The numbers that a goal demands and a trade study may vary. The first ones index
 * mt_goal.number. */
typedef enum mt_goal_slot {
    MT_SLOT_EQUALS,
    MT_SLOT_AT_LEAST,
    MT_SLOT_AT_MOST,
    MT_GOAL_NUMBERS,
    MT_SLOT_MARGIN = MT_GOAL_NUMBERS, /* of the bands that are avoided */
    MT_SLOT_AT_LEAST_HZ,              /* MT_SLOT_AT_LEAST by another member, in Hz */
    MT_SLOT_NONE
} mt_goal_slot;

/* A mode that a study names. */
typedef struct mt_mode_ref {
    int index; /* 1-based vibration mode; 0: by name */
    mt_name mode_name;
    int named; /* resolved named mode of the model; MT_ABSENT: by index */
} mt_mode_ref;

/* The mode whose frequency a ratio is divided by. */
typedef struct mt_goal_of {
    mt_name configuration_name;
    int configuration; /* MT_ABSENT: that of the goal */
    mt_mode_ref mode;
} mt_goal_of;

/* Default tolerance of a goal, in percent of its limit or target: far below what an engineer
 * can build, far above rounding. */
#define MT_DEFAULT_TOLERANCE_PERCENT 1e-4

typedef struct mt_goal {
    mt_goal_type type;
    /* one ("configuration") or several ("configurations"); none given: the model's only one */
    mt_name_list configuration_names;
    int n_configurations;
    int *configurations;
    mt_mode_ref mode;
    mt_goal_of of; /* ratio */
    /* apart: modes in their order, each of which keeps its distance from the one before */
    int n_modes;
    mt_mode_ref *modes;
    int up_to_mode;     /* 0: the modes are listed */
    double at_least_hz; /* NaN: in percent; else also at_least */
    union {
        struct {
            double equals;   /* "target_hz", "equals" */
            double at_least; /* in the unit of the kind of goal */
            double at_most;
        };
        double number[MT_GOAL_NUMBERS];
    };
    double tolerance_percent;
    bool tolerance_given; /* false: tolerance_percent is the default */
    /* NaN: a limit or target to meet; else the weight of a residual of the misfit */
    double weight;
    double length; /* length at which an angle counts as an arc [m]; NaN: the model's */
    /* of shape and mac; of frequency: the target is that mode's frequency instead of
     * "target_hz" */
    mt_name reference_name;
    int reference;
    int reference_mode; /* 1-based; 0: same index as mode */
    mt_expr expression; /* limit */
    const char *expression_text;
    mt_avoid *avoid;        /* of avoid goals, in the study's arena; else NULL */
    mt_energy_goal *energy; /* of energy goals, in the study's arena; else NULL */
    /* of goals about ports, in the study's arena; else NULL */
    mt_response_limit *response_limit;
    mt_static_limit *static_limit; /* of goals about rest, in the study's arena; else NULL */
    const char *description;
    mt_addr addr;
} mt_goal;

/* Deviation of a value v from the requested value v0. */
typedef enum mt_goal_measure {
    MT_MEASURE_RATIO,      /* ln(v / v0) */
    MT_MEASURE_PART,       /* (v - v0) / |v0|, or v where v0 is 0 */
    MT_MEASURE_DIFFERENCE, /* v - v0 */
} mt_goal_measure;

typedef struct mt_goal_kind {
    const char *name;
    const char *unit; /* "": none, or that of the goal's expression */
    mt_goal_measure measure;
    const mt_key_table *members;
} mt_goal_kind;

struct mt_study;
const mt_goal_kind *mt_goal_kind_of(mt_goal_type type);
/* True where goals of the kind have the member. */
bool mt_goal_has(const mt_goal_kind *kind, const char *member);
/* The member that gives a number; NULL: the kind has none. */
const mt_key *mt_goal_member(const mt_goal_kind *kind, mt_goal_slot slot);
/* Its name in files; NULL: the kind has none. */
const char *mt_goal_member_name(const mt_goal_kind *kind, mt_goal_slot slot);
/* The name of the member by which the goal gives a number, or could. */
const char *mt_goal_number_name(const mt_goal *goal, mt_goal_slot slot);
/* The scale of a deviation: what the difference v - asked is divided by. */
double mt_measure_unit(mt_goal_measure measure, double asked);
/* Tolerance of a goal as a fraction: tolerance_percent / 100. */
double mt_goal_tolerance(const mt_goal *goal);
/* The unit of a goal's numbers, "" for none: of its kind, of its ports, or the SI unit of its
 * expression, where parameters in it are shown in another. */
const char *mt_study_goal_unit(const struct mt_study *study, const mt_goal *goal);
/* True where the goal limits a forced vibration from above. */
bool mt_goal_is_limit(const mt_goal *goal);
/* True where a goal means no mode by index or name, but the one that has most. */
bool mt_goal_is_most(const mt_goal *goal);
/* Number of requirements in each configuration: of directions, where it has several. */
int mt_goal_directions(const mt_goal *goal);
/* True where a goal avoids bands. */
bool mt_study_has_bands(const struct mt_study *study);
/* True where a goal limits a forced vibration from above. */
bool mt_study_has_limits(const struct mt_study *study);

/*
 * The tables of members. All fill an mt_goal_parts, of which the goal keeps what its kind is
 * about. The macros write rows that several kinds have, with THIS for mt_goal_parts.
 */
typedef struct mt_goal_parts {
    mt_goal goal;
    mt_avoid avoid;
    mt_energy_goal energy;
    mt_response_limit response_limit;
    mt_static_limit static_limit;
} mt_goal_parts;

#define MT_GOAL_ROWS(tolerance)                                                           \
    MT_M_JUST("type", TEXT, true, NONE, "What kind of goal this is."),                    \
        MT_M_TEXT("description", goal.description, "Free text for people."), MT_M_SOURCE, \
        MT_S_NUMBER("tolerance_percent", false, goal.tolerance_percent, MET, tolerance,   \
                    .otherwise = "0.0001")
#define MT_GOAL_TOLERANCE "The goal is met within this, in percent of the demand."
#define MT_GOAL_CONFIGURATION_ROWS                                                    \
    {.name = "configuration",                                                         \
     .type = MT_KEY_TEXT,                                                             \
     MT_M_TO(mt_goal_read_configurations, mt_name_list, goal.configuration_names),    \
     .says = "Configuration of the model. Absent: its only one."},                    \
    {                                                                                 \
        .name = "configurations", .type = MT_KEY_LIST,                                \
        MT_M_TO(mt_goal_read_configurations, mt_name_list, goal.configuration_names), \
        .what = "the list of configurations",                                         \
        .says = "Several configurations: the goal holds in each of them."             \
    }
#define MT_GOAL_ONE_OR_SEVERAL \
    "\"not\": {\"required\": [\"configuration\", \"configurations\"]}"
void mt_goal_read_configurations(mt_reader *r, const mt_key *key, mt_addr value, void *item);
/* mt_key_table.check of goals with configurations and .finish of all, by themselves or from
 * those of their kind. */
void mt_goal_check(mt_reader *r, mt_object *o);
void mt_goal_finish(mt_reader *r, const mt_object *o, int which, void *item);

#define MT_GOAL_KEYS(id, name, ...) extern const mt_key_table mt_goal_##name##_keys;
MT_GOAL_LIST(MT_GOAL_KEYS)
#undef MT_GOAL_KEYS

extern const mt_key_table mt_study_goal_of_keys;

struct mt_study_reader;
struct mt_study_check;
void mt_read_study_goals(struct mt_study_reader *s, mt_addr list);
void mt_study_check_goals(struct mt_study_check *c);

#endif
