/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_STUDY_H
#define STUDY_STUDY_H

#include "modetune/study.h"

#include "base/diagnostics.h"
#include "environment/aircraft.h"
#include "environment/bands.h"
#include "io/json.h"
#include "measurement/measurement.h"
#include "model/count_box.h"
#include "model/model.h"
#include "study/goals.h"
#include "study/objective_kinds.h"

/*
 * A study of a model: variables, goals, objective, references, published values. Filled by a
 * reader (io), checked by mt_study_finish, then immutable. Numbers of a study are expressions
 * of the model's parameters evaluated once at the original design (plain doubles here), except
 * those that must follow the design: limit.expression, objective.expression, published.quantity
 * (mt_expr). NaN (nan("")) stands for "not given" in the doubles below.
 */

typedef struct mt_variable {
    mt_name parameter_name;
    int parameter;
    double lower; /* continuous: both bounds are required, lower < upper */
    double upper;
    int n_catalogue;   /* > 0: discrete */
    double *catalogue; /* ascending after finish */
    double weight;     /* weight of its change in the total change; default 1 */
    /* scale of its change, (new - original)/scale; NaN: ln(new/original), or range */
    double scale;
    double range; /* scale of its change where the change has no logarithm; by finish */
    double tolerance_percent; /* of a search over tolerances; NaN: none */
    double original;          /* the model's value; by finish */
    const mt_unit *shown;     /* unit in which its numbers are shown; NULL: SI; by finish */
    mt_addr addr;
} mt_variable;

/* Modes to compare with: another model's configuration, or measured values at sensors. */
typedef struct mt_measured_mode {
    double frequency_hz; /* NaN: not given */
    int n_values;
    mt_name *channels; /* "sensor.direction" */
    double *values;
    mt_addr addr;
} mt_measured_mode;

typedef struct mt_reference {
    mt_name name;
    mt_name model_path;    /* as written; NULL: measured */
    const mt_model *model; /* of the study's models; NULL: measured */
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
    mt_name_list of; /* of mass: patterns of names of bodies, links, bars; none: all */
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
    /* "design": "original": compared at the original design, not at the recommended one */
    bool original;
    /* compared within a tolerance; with limits it is only shown, and the limits are compared */
    double value;
    double tolerance; /* absolute */
    double tolerance_percent;
    double at_least;
    double at_most;
    mt_role role;
    const char *source;
    /* "label": its name in comparison tables; NULL: made from the other members */
    const char *label;
    mt_addr addr;
} mt_published;

/* A trade study: one or two quantities take each of their values (two: all pairs), and the
 * study is solved for its best design at each. */
typedef enum mt_vary_kind {
    MT_VARY_BOUND,    /* a bound of a variable */
    MT_VARY_GOAL,     /* a number of a goal */
    MT_VARY_PARAMETER /* a parameter that is no variable */
} mt_vary_kind;

typedef struct mt_vary {
    mt_vary_kind kind;
    mt_name name;  /* of the variable or parameter */
    int variable;  /* bound: index in the study's variables */
    bool upper;    /* bound: true for the upper one */
    int parameter; /* parameter: of the model */
    int goal;      /* goal: index in the study's goals */
    /* goal: name of its number; NULL: invalid, which the reader has noted */
    const char *member;
    mt_goal_slot slot; /* that number; MT_SLOT_NONE: the goal has none; by finish */
    int n_values;
    double *values;   /* [n_values] in the order given; in the unit of what varies */
    const char *text; /* "upper bound of M_SAU", "target_hz of goal 1": by finish */
    mt_addr addr;
} mt_vary;

enum { MT_MAX_VARY = 2, MT_MAX_TRADE_POINTS = 10000 };

typedef struct mt_trade {
    int n_vary; /* 0: there is no trade study */
    mt_vary vary[MT_MAX_VARY];
    int n_objectives; /* 0 or 2: of the Pareto front */
    mt_objective_type objectives[2];
    mt_addr addr;
} mt_trade;

enum { MT_STARTS_MOST = 100000 };
typedef struct mt_search {
    unsigned long seed;
    int starts; /* 0: chosen from the number of variables */
    /* where starts is 0: starts end where those so far leave little hope of another design. Set
     * by a trade study, which also starts from neighbouring points */
    bool settles;
    long max_evaluations; /* evaluations of the whole answer at most; 0: no limit */
    /* modal solutions of the whole answer at most; 0: no limit. The caller that answers
     * converts it to evaluations and puts them into max_evaluations */
    long max_modal_solutions;
    /* modal solutions per evaluation where max_modal_solutions is given; 0: not given. Set by
     * the caller that answers */
    long solutions_each;
    long judged_as; /* evaluations that are charged for judging a design over its tolerances */
    bool by_solutions; /* the limit on modal solutions is reached before that on evaluations */
    /* positions, each an evaluation, at which a design may be followed along a drive; 0: as
     * many as the path needs. Set by the caller that answers */
    int max_positions;
    /* nominal seconds of each proof (prove/certify.h); 0: no proofs; NaN: not given */
    double proof_s;
} mt_search;

/* The name of the member of "search" whose limit is the budget. */
const char *mt_search_budget(const mt_search *s);

/* Sensitivity of the best design of a misfit to its weights: how far it moves when single
 * weights change. */
typedef struct mt_weight_sensitivity {
    /* factor by which each goal's weight is multiplied and divided in turn */
    double factor;
    mt_addr addr; /* MT_NO_ADDR: not requested */
} mt_weight_sensitivity;

typedef struct mt_input_file {
    const char *name;   /* relative to the study's folder */
    const char *sha256; /* hex */
} mt_input_file;

/* A number that overrides a number of the files. */
typedef struct mt_requested_number {
    const char *kind; /* "parameter" of the model; "search": member of the study's search */
    const char *name;
    const char *unit; /* of a parameter; NULL */
    const mt_unit *shown;
    double value;
    double original; /* the number in the files; NaN: none */
} mt_requested_number;

typedef struct mt_study {
    mt_arena mem;      /* owns everything but the models' own memory */
    mt_json *document; /* of its addresses, owned; NULL: made in memory */
    const char *path;
    const char *name;
    const char *description;
    const char *author; /* author, revision and date as written; NULL: not given */
    const char *revision;
    const char *date;
    mt_name model_path;
    const mt_model *model; /* the first of models */
    /* [n_models] owned: the study's own and those of references, each file once */
    mt_model **models;
    int n_models;
    int cap_models;
    /* units of numbers for parameters, by dimension; NULL: each parameter's own. The reader
     * converts the study's numbers to SI */
    const mt_unit *units[MT_DIMENSION_COUNT];
    /* [number of the model's parameters] values at the original design (model/values.h); made
     * by finish where NULL */
    double *original;
    MT_LIST_OF(mt_variable, variables);
    MT_LIST_OF(mt_goal, goals);
    MT_LIST_OF(mt_reference, references);
    /* finish sets the responses of each that are used */
    MT_LIST_OF(mt_measurement, measurements);
    MT_LIST_OF(mt_objective, objectives);
    MT_LIST_OF(mt_published, published);
    MT_LIST_OF(mt_study_response, responses);
    mt_trade trade;
    /* the box of designs over which modes are counted (analysis.h): variables within their
     * bounds or catalogues, with their tolerances and the original values, and the quantities
     * of a trade study; by finish. Studies made from this one (points of a trade study, one
     * combination of a catalogue) keep it */
    mt_count_box counted;
    MT_LIST_OF(mt_study_profile, profiles); /* profiles that goals name, each once; owned */
    mt_name aircraft_path; /* path of the catalogue, read or unreadable (noted); s NULL: none */
    mt_aircraft_list aircraft;
    /* sentences for the result: values that are not confirmed, bands that were merged; by
     * finish */
    MT_LIST_OF(const char *, warnings);
    /* warnings about the study's own numbers, by the reader and by finish */
    mt_warning_list warning_list;
    mt_accepted accepted; /* accepted warnings, those of its model too */
    bool examined;        /* true for a point of a trade study: warnings were given already */
    int recommendations;  /* number of designs to report; default 5 */
    /* true where `recommendations` is given: others are wanted even where the original is the
     * best */
    bool alternatives;
    mt_search search;
    mt_weight_sensitivity weight_sensitivity;
    /* overrides, by the reader; already applied to model and search */
    MT_LIST_OF(mt_requested_number, asked);
    int n_inputs; /* files read: the study and the models */
    mt_input_file *inputs;
} mt_study;

/* A reference may use the same mt_model as the study or another reference: mt_study_delete
 * frees each model once. */
mt_status mt_study_new(mt_study **out, mt_err *err);
/* Records with every optional member at "not given" (NaN, MT_ABSENT) or its default, and all
 * addresses at addr. */
mt_variable mt_variable_default(mt_addr addr);
mt_vary mt_vary_default(mt_vary_kind kind, mt_addr addr);
mt_published mt_published_default(mt_published_kind kind, mt_addr addr);
/*
 * Resolve names and check the study, noting all problems at once: unknown names with "did you
 * mean", bounds in the wrong order, catalogue and bounds together, duplicate variables, goals
 * without a requirement, weights without the objective "misfit" and the reverse, a variable
 * overridden in every configuration that the goals name, references without a common sensor,
 * mode indices below 1, ... Fill in defaults (configuration: the model's only one; objective:
 * change; range of a variable), sort catalogues, look up aircraft, make the bands, set
 * `original` and `warnings`. study->model is already set and finished. Bounds at or below 0 are
 * allowed for a positive parameter (problem.h defines its change then). Returns MT_E_INPUT
 * where diags holds errors, MT_E_MEMORY.
 */
mt_status mt_study_finish(mt_study *study, mt_diags *diags, mt_err *err);
/* The unit of numbers for this parameter of the study's model, in its file and for people: the
 * study's unit, else the parameter's own; NULL: SI. */
const mt_unit *mt_study_unit(const mt_study *study, int parameter);
/* The unit in which positions of this dimension are shown: the study's, else the model's; NULL:
 * SI. */
const mt_unit *mt_study_shown(const mt_study *study, mt_dimension dimension);
/* The unit in which a limit on an expression of a length, an angle or a speed is read and
 * shown: that of a parameter in it, else the study's. NULL: SI, or another dimension. The
 * expression itself is in SI. */
const mt_unit *mt_study_requirement_unit(const mt_study *study, const mt_expr *e);
/* The unit of a goal's numbers, "" for none: of its kind (goals.h), of its ports, or the
 * SI unit of its expression, where parameters in it are shown in another. */
const char *mt_study_goal_unit(const mt_study *study, const mt_goal *goal);
/* Index by name; MT_ABSENT where there is none. */
int mt_study_find_reference(const mt_study *study, const char *name);
int mt_study_find_measurement(const mt_study *study, const char *name);
/* True where a goal avoids bands. */
bool mt_study_has_bands(const mt_study *study);
/* True where a goal limits a forced vibration from above. */
bool mt_study_has_limits(const mt_study *study);
/* True where the objective takes the goal's limit as its scale. The goal then requires nothing
 * else. */
bool mt_study_is_scale(const mt_study *study, const mt_goal *goal);
/* True where a goal names this configuration. */
bool mt_study_asks(const mt_study *study, int configuration);
/* The address of a member of an object of the study's file; the object's own without one. */
mt_addr mt_study_member(const mt_study *study, mt_addr object, const char *member);
/* Fill in the place of a warning's address, if known; its pointer lies in mem. */
void mt_study_place_warning(const mt_study *study, mt_arena *mem, mt_warning *warning);
/* The line and column of the value that the text's leading JSON pointer ("/goals/2: ...")
 * names; false where the text begins with none, or the study comes from no file. */
bool mt_study_locate(const mt_study *study, const char *text, int *line, int *column);
/* The names in files: "verifies", "parameter". */
const char *mt_role_name(mt_role role);
const char *mt_published_kind_name(mt_published_kind kind);
/* The possible values of a published `status`, in the order of mt_result_status; *n is their
 * number. */
enum { MT_STUDY_STATUSES = MT_RESULT_INTERRUPTED };
extern const char *const mt_study_status_names[];
/* True where the objective is the misfit and every goal is a part of it: no goal then decides
 * whether a design is feasible. */
bool mt_study_is_fit(const mt_study *study);

#endif
