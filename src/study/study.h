/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_STUDY_H
#define STUDY_STUDY_H

#include "modetune/study.h"

#include "base/warning.h"
#include "model/count_box.h"
#include "model/model.h"
#include "study/aircraft.h"
#include "study/bands.h"
#include "study/goal_kinds.h"
#include "study/measurement.h"
#include "study/objective_kinds.h"
#include "study/response_limit.h"

/*
 * A question asked of a model: variables, goals, objective, references, published values.
 * Filled by a reader (io), checked by mt_study_finish, then immutable. Numbers of a study are
 * expressions of the model's parameters evaluated once at the original design (plain doubles
 * here), except those that must follow the design: limit.expression, objective.expression,
 * published.quantity (mt_expr). NaN (nan("")) stands for "not given" in the doubles below;
 * MT_HAS(x) asks.
 */
#define MT_HAS(x) ((x) == (x))

/* A goal is met within this, in percent of the requirement, where it does not say: far below
 * what an engineer can build, far above rounding. */
#define MT_DEFAULT_TOLERANCE_PERCENT 1e-4

typedef struct mt_variable {
    mt_name parameter_name;
    int parameter;
    double lower; /* continuous: both bounds are required, lower < upper */
    double upper;
    int n_catalogue;   /* > 0: discrete */
    double *catalogue; /* ascending after finish */
    double weight;     /* of the change; default 1 */
    double scale; /* of the change, (new - original)/scale; NaN: ln(new/original), or range */
    double range; /* scale of a change that has no logarithm; by finish */
    double tolerance_percent; /* robust search; NaN: none */
    double original;          /* the model's value; by finish */
    const mt_unit *shown;     /* what its numbers are in for people; NULL: SI; by finish */
    mt_addr addr;
    mt_addr lower_addr; /* the addresses of what was not given equal addr */
    mt_addr upper_addr;
    mt_addr catalogue_addr;
    mt_addr weight_addr;
    mt_addr scale_addr;
    mt_addr tolerance_addr;
} mt_variable;

typedef struct mt_mode_ref {
    int index; /* 1-based vibration mode; 0: by name */
    mt_name mode_name;
    int named; /* resolved named mode of the model; MT_ABSENT: by index */
    mt_addr addr;
} mt_mode_ref;

/* What modes must keep clear of, and how the search goes about it. */
typedef struct mt_avoid {
    mt_bands_source source;
    /* modes on each side of a band that are held there by constraints of their own, so that
     * neighbours which change places are seen */
    int cluster;
    mt_bands bands;     /* of the source; by finish */
    mt_addr bands_addr; /* the addresses of what was not given equal the goal's */
    mt_addr margin_addr;
    mt_addr up_to_addr;
} mt_avoid;

typedef struct mt_goal {
    mt_goal_type type; /* kinds: goal_kinds.h */
    /* one ("configuration") or several ("configurations"); none given: the model's only one */
    mt_name_list configuration_names;
    mt_addr configurations_addr; /* of either member; addr: none is there */
    int n_configurations;
    int *configurations;
    mt_mode_ref mode;
    union {
        struct {
            double equals;   /* "target_hz", "equals" */
            double at_least; /* in the unit of the kind of goal (goal_kinds.h) */
            double at_most;
            double tolerance_percent;
            double weight; /* NaN: a constraint; else a residual of the misfit */
            double length; /* at which angles are arcs [m]; NaN: the model's */
        };
        double number[MT_GOAL_NUMBERS];
    };
    union { /* where these stand; of what was not given equal to addr */
        struct {
            mt_addr equals_addr;
            mt_addr at_least_addr;
            mt_addr at_most_addr;
            mt_addr tolerance_addr;
            mt_addr weight_addr;
            mt_addr length_addr;
        };
        mt_addr number_addr[MT_GOAL_NUMBERS];
    };
    /* shape, mac; frequency: its target is the frequency of that mode, instead of "target_hz";
     * its addr equals addr where it was not given */
    mt_name reference_name;
    int reference;
    int reference_mode; /* 1-based; 0: same index as mode */
    mt_expr expression; /* limit */
    const char *expression_text;
    mt_avoid *avoid;                   /* avoid: in the study's arena; else NULL */
    mt_response_limit *response_limit; /* of ports: likewise */
    const char *description;
    mt_addr addr;
} mt_goal;

/* Modes to compare with: another model's configuration, or measured values at sensors. */
typedef struct mt_measured_mode {
    double frequency_hz; /* NaN: not given */
    int n_values;
    mt_name *channels; /* "sensor.direction" */
    double *values;
    mt_addr addr;
    mt_addr frequency_addr;
} mt_measured_mode;

typedef struct mt_reference {
    mt_name name;
    mt_name model_path; /* as written; NULL: measured */
    mt_model *model;    /* owned by the study; NULL: measured */
    mt_name configuration_name;
    int configuration;
    int n_modes;
    mt_measured_mode *modes;
    const char *source;
    mt_addr addr;
} mt_reference;

typedef struct mt_objective {
    mt_objective_type type;
    mt_expr expression;
    const char *expression_text;
    mt_name_list of; /* mass: patterns of names of bodies, links, bars; none: all */
    mt_addr addr;
} mt_objective;

#define MT_ROLE_LIST(X)                 \
    X(MT_ROLE_VERIFIES, "verifies")     \
    X(MT_ROLE_CALIBRATES, "calibrates") \
    X(MT_ROLE_NOT_COMPARABLE, "not_comparable")
#define MT_ROLE_ENUM(id, name) id,
typedef enum mt_role { MT_ROLE_LIST(MT_ROLE_ENUM) MT_ROLE_COUNT } mt_role;
#undef MT_ROLE_ENUM

#define MT_PUBLISHED_LIST(X)               \
    X(MT_PUBLISHED_PARAMETER, "parameter") \
    X(MT_PUBLISHED_QUANTITY, "quantity")   \
    X(MT_PUBLISHED_FREQUENCY, "frequency") \
    X(MT_PUBLISHED_MAC, "mac")             \
    X(MT_PUBLISHED_STATUS, "status")
#define MT_PUBLISHED_ENUM(id, name) id,
typedef enum mt_published_kind {
    MT_PUBLISHED_LIST(MT_PUBLISHED_ENUM) MT_PUBLISHED_KIND_COUNT
} mt_published_kind;
#undef MT_PUBLISHED_ENUM

typedef struct mt_published {
    mt_published_kind kind;
    mt_name parameter_name;
    int parameter;
    mt_expr quantity;
    const char *quantity_text;
    mt_name configuration_name; /* frequency, mac */
    int configuration;
    mt_mode_ref mode;
    mt_name reference_name; /* mac */
    int reference;
    int reference_mode;
    const char *status; /* "solved" | "compromise" | "infeasible" | "fitted" */
    bool original;      /* "design": "original": judged there, not at the recommended design */
    double value;     /* judged within a tolerance, or shown beside limits, which then judge */
    double tolerance; /* absolute */
    double tolerance_percent;
    double at_least;
    double at_most;
    mt_role role;
    const char *source;
    const char *label; /* "label": what a comparison table calls it; NULL: made from the rest */
    mt_addr addr;
    mt_addr status_addr; /* the addresses of what was not given equal addr */
    mt_addr value_addr;
    mt_addr tolerance_addr;
    mt_addr tolerance_percent_addr;
} mt_published;

/* A response that the result has to show, of every design. */
typedef struct mt_study_response {
    mt_name configuration_name;
    int configuration;
    mt_response_limit response_limit; /* ports and frequencies; a profile, where there is one */
    const char *description;
    const char *source;
    mt_addr addr;
} mt_study_response;

/* A trade study: one or two quantities take each of their values (all pairs of two), and every
 * such study is answered by its best design. */
typedef enum mt_vary_kind {
    MT_VARY_BOUND,    /* a bound of a variable */
    MT_VARY_GOAL,     /* a number of a goal */
    MT_VARY_PARAMETER /* a parameter that is no variable */
} mt_vary_kind;

typedef struct mt_vary {
    mt_vary_kind kind;
    mt_name name;       /* of the variable or parameter */
    int variable;       /* bound: index in the study's variables */
    bool upper;         /* bound: which one */
    int parameter;      /* parameter: of the model */
    int goal;           /* goal: index in the study's goals */
    const char *member; /* goal: name of its number; NULL: noted by who filled the study */
    mt_goal_slot slot;  /* of that number; by finish */
    int n_values;
    double *values;   /* [n_values] in the order given; in the unit of what varies */
    const char *text; /* "upper bound of M_SAU", "target_hz of goal 1": by finish */
    mt_addr addr;
    mt_addr values_addr;
} mt_vary;

enum { MT_MAX_VARY = 2, MT_MAX_TRADE_POINTS = 10000 };

typedef struct mt_trade {
    int n_vary; /* 0: there is no trade study */
    mt_vary vary[MT_MAX_VARY];
    int n_objectives; /* 0 or 2: of the Pareto front */
    mt_objective_type objectives[2];
    mt_addr addr;
    mt_addr objectives_addr; /* addr where not given */
} mt_trade;

enum { MT_STARTS_MOST = 100000 };
typedef struct mt_search {
    unsigned long seed;
    int starts; /* 0: chosen by the number of variables */
    /* where starts are not said: they end when those so far leave little hope of another
     * design. By a trade study, whose neighbours are tried, too */
    bool settles;
    long max_evaluations; /* of everything that the answer takes; 0: no limit */
    /* likewise; what it comes to in evaluations is put into max_evaluations by who answers */
    long max_modal_solutions;
    /* those of one evaluation where there is such a limit; 0: there is none. By who answers */
    long solutions_each;
    long judged_as;    /* evaluations that judging a design over its tolerances is counted as */
    bool by_solutions; /* it is the one that is reached first */
    /* of them, positions that a design may be followed over on its way along one drive; 0: as
     * many as it takes. By who answers */
    int max_positions;
    /* nominal seconds of each proof (prove/certify.h); 0: none; NaN: not said */
    double proof_s;
    mt_addr proof_addr;
} mt_search;

/* The member whose limit is the budget. */
const char *mt_search_budget(const mt_search *s);

/* How far the best design of a misfit moves when single weights are changed: the uncertainty
 * that a choice of weights hides. */
typedef struct mt_weight_sensitivity {
    /* every weighted goal's weight times and divided by it in turn; NaN: not asked for */
    double factor;
    mt_addr factor_addr;
} mt_weight_sensitivity;

typedef struct mt_input_file {
    const char *name;   /* relative to the study's folder */
    const char *sha256; /* hex */
} mt_input_file;

/* Where an address of the study's file stands, kept for what is found later. */
typedef struct mt_study_place {
    mt_addr addr;
    int line; /* from 1 */
    int column;
    const char *pointer;
} mt_study_place;

/* A number that is asked for instead of what files say. */
typedef struct mt_requested_number {
    const char *kind; /* "parameter": of the model; "search": member of the study's search */
    const char *name;
    const char *unit; /* of a parameter; NULL */
    const mt_unit *shown;
    double value;
    double original; /* what the files say; NaN: nothing */
} mt_requested_number;

typedef struct mt_study {
    mt_arena mem; /* owns everything but the models' own memory */
    const char *path;
    const char *name;
    const char *description;
    const char *author; /* who asks, which issue of the question, when: as written; NULL */
    const char *revision;
    const char *date;
    mt_name model_path;
    mt_model *model; /* owned */
    /* what numbers for parameters are in; NULL: each in its own. Those of the study are in SI
     * from the reader on. */
    const mt_unit *units[MT_DIMENSION_COUNT];
    /* [model's parameters] values at the original design (model/values.h); made by finish where
     * NULL */
    double *original;
    MT_LIST_OF(mt_variable, variables);
    MT_LIST_OF(mt_goal, goals);
    MT_LIST_OF(mt_reference, references);
    /* of each the responses that are meant, by finish */
    MT_LIST_OF(mt_measurement, measurements);
    MT_LIST_OF(mt_objective, objectives);
    MT_LIST_OF(mt_published, published);
    MT_LIST_OF(mt_study_response, responses);
    mt_trade trade;
    /* the designs that are counted alike (analysis.h): variables within their bounds or
     * catalogues, with their tolerances and the original values, and what a trade study varies;
     * by finish. Studies made from this one (points of a trade study, one combination of a
     * catalogue) keep it. */
    mt_count_box counted;
    MT_LIST_OF(mt_study_profile, profiles); /* those that goals name, each once; owned */
    mt_name aircraft_path; /* of the catalogue read, or unreadable (noted); s NULL: none */
    mt_aircraft_list aircraft;
    /* for the result: what a reader of it must know (values that nobody confirmed, bands that
     * were merged); by finish */
    MT_LIST_OF(const char *, warnings);
    /* of the study's own numbers; by finish, their places by the reader */
    mt_warning_list warning_list;
    mt_accepted accepted; /* warnings that are known and meant, of its model, too */
    /* of goals, variables and their numbers; by the reader */
    MT_LIST_OF(mt_study_place, places);
    bool examined;       /* doubts have been told already: a point of a trade study */
    int recommendations; /* how many to report; default 5 */
    bool alternatives;   /* that is said: others are wanted where the original is the best */
    mt_addr recommendations_addr;
    mt_search search;
    mt_weight_sensitivity weight_sensitivity;
    MT_LIST_OF(mt_requested_number, asked); /* by the reader; model and search have them */
    int n_inputs;                           /* files read: study, models */
    mt_input_file *inputs;
} mt_study;

/* A reference may use the same mt_model as the study or another reference: mt_study_delete
 * frees each model once. */
mt_status mt_study_new(mt_study **out, mt_err *err);
/* Records with every optional member at "not given" (NaN, MT_ABSENT, defaults) and all
 * addresses at addr. */
mt_variable mt_variable_default(mt_addr addr);
mt_goal mt_goal_default(mt_goal_type type, mt_addr addr);
mt_avoid mt_avoid_default(mt_addr addr);
mt_response_limit mt_response_limit_default(mt_addr addr);
/* Tolerance of a goal, of 1. */
double mt_goal_tolerance(const mt_goal *goal);
mt_vary mt_vary_default(mt_vary_kind kind, mt_addr addr);
mt_published mt_published_default(mt_published_kind kind, mt_addr addr);
mt_study_response mt_study_response_default(mt_addr addr);
/*
 * Resolve names and check meaning, all problems at once: unknown names with "did you mean",
 * bounds in the wrong order, catalogue and bounds together, duplicate variables, goals without
 * a requirement, weights without the objective "misfit" and the reverse, a variable overridden
 * in every configuration that the goals name, references without a common sensor, mode indices
 * below 1, ... Fills in defaults (configuration: the model's only one; objective: change; range
 * of a variable), sorts catalogues, looks up aircraft, makes the bands, sets `original` and
 * `warnings`. study->model is set and finished before. Bounds at or below 0 are fine for a
 * positive parameter (problem.h: how its change is measured then). Returns MT_E_INPUT where
 * diags holds errors, MT_E_MEMORY.
 */
mt_status mt_study_finish(mt_study *study, mt_diags *diags, mt_err *err);
/* What a number for this parameter of the study's model is in, in its file and for people: the
 * study's unit, else the parameter's own; NULL: SI. */
const mt_unit *mt_study_unit(const mt_study *study, int parameter);
/* What people are shown positions of this dimension in: the study's unit, else the model's;
 * NULL: SI. */
const mt_unit *mt_study_shown(const mt_study *study, mt_dimension dimension);
/* The unit that somebody thinks in who asks for a value of an expression of a length, an angle
 * or a speed: that of a parameter in it, else the study's. NULL: SI, or it is none of these.
 * The expression is in SI all the same. */
const mt_unit *mt_study_requirement_unit(const mt_study *study, const mt_expr *e);
/* The unit of a goal's numbers, "" for none: of its kind (goal_kinds.h), of its ports, or that
 * of SI of its expression, where parameters in it are shown in another. */
const char *mt_study_goal_unit(const mt_study *study, const mt_goal *goal);
/* MT_ABSENT where there is none. */
int mt_study_find_reference(const mt_study *study, const char *name);
int mt_study_find_measurement(const mt_study *study, const char *name);
/* Whether there is a goal that keeps clear of bands. */
bool mt_study_has_bands(const mt_study *study);
/* Whether the goal limits a forced vibration from above; then, whether there is one that
 * does. */
bool mt_goal_is_limit(const mt_goal *goal);
bool mt_study_has_limits(const mt_study *study);
/* Whether the objective takes the goal's limit as its scale. Then nothing else is asked of
 * it. */
bool mt_study_is_scale(const mt_study *study, const mt_goal *goal);
/* Whether a goal asks for this configuration. */
bool mt_study_asks(const mt_study *study, int configuration);
/* Fill in where a doubt's address stands, if that is known. */
void mt_study_place_warning(const mt_study *study, mt_warning *warning);
/* Where what the text's leading JSON pointer names ("/goals/2: ...") stands; NULL: it begins
 * with none, or the place was not kept. */
const mt_study_place *mt_study_locate(const mt_study *study, const char *text);
/* The names that files use: "verifies", "parameter". */
const char *mt_role_name(mt_role role);
const char *mt_published_kind_name(mt_published_kind kind);
/* What a published `status` may say, in the order of mt_result_status; *n their number. */
const char *const *mt_study_statuses(int *n);
/* The misfit is made least, and every goal is a part of it: none decides whether a design is
 * good. */
bool mt_study_is_fit(const mt_study *study);

#endif
