/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TUNE_STUDY_H
#define TUNE_STUDY_H

#include "model/model.h"

/*
 * A question asked of a model: variables, goals, objective, references, published values. Filled by a reader (io), checked by
 * mt_study_finish, then immutable. Numbers of a study are expressions of the model's parameters evaluated once at the original design
 * (plain doubles here), except those that must follow the design: limit.expression, objective.expression, published.quantity (mt_expr).
 * NaN (nan("")) stands for "not given" in the doubles below; MT_HAS(x) asks.
 */
#define MT_HAS(x) ((x) == (x))

typedef struct mt_variable {
    mt_name parameter_name;
    int parameter;
    double lower; /* continuous: both bounds are required, lower < upper */
    double upper;
    int n_catalogue;       /* > 0: discrete */
    double *catalogue;     /* ascending after finish */
    double weight;         /* of the change; default 1 */
    double scale;          /* change of a parameter that may be zero or negative: (new - original)/scale; default upper - lower */
    double tolerance_percent; /* robust search; NaN: none */
    double original;       /* the model's value; by finish */
    mt_addr addr;
    mt_addr lower_addr;
    mt_addr upper_addr;
} mt_variable;

typedef struct mt_mode_ref {
    int index;          /* 1-based vibration mode; 0: by name */
    mt_name mode_name;
    int named;          /* resolved named mode of the model */
    mt_addr addr;
} mt_mode_ref;

typedef enum mt_goal_type { MT_GOAL_FREQUENCY, MT_GOAL_SHAPE, MT_GOAL_MAC, MT_GOAL_LIMIT, MT_GOAL_AVOID } mt_goal_type;

typedef struct mt_goal {
    mt_goal_type type;
    mt_name_list configuration_names; /* one ("configuration") or several ("configurations"); none given: the model's only one */
    int n_configurations;
    int *configurations;
    mt_mode_ref mode;
    double target_hz;
    double at_least; /* frequency: Hz; mac: 0..1; limit: unit of the expression */
    double at_most;
    double equals;   /* limit */
    double tolerance_percent; /* default 1e-4 */
    double weight;   /* NaN: a constraint; else a residual of the misfit */
    mt_name reference_name;
    int reference;
    int reference_mode; /* 1-based; 0: same index as mode */
    mt_expr expression; /* limit */
    const char *expression_text;
    const char *description;
    mt_addr addr;
} mt_goal;

/* Modes to compare with: another model's configuration, or measured values at sensors. */
typedef struct mt_measured_mode {
    double frequency_hz; /* NaN: not given */
    int n_values;
    mt_name *channels;   /* "sensor.direction" */
    double *values;
} mt_measured_mode;

typedef struct mt_reference {
    mt_name name;
    mt_name model_path;       /* as written; NULL: measured */
    mt_model *model;          /* owned by the study; NULL: measured */
    mt_name configuration_name;
    int configuration;
    int n_modes;
    mt_measured_mode *modes;
    const char *source;
    mt_addr addr;
} mt_reference;

typedef enum mt_objective_type {
    MT_OBJECTIVE_NONE,
    MT_OBJECTIVE_CHANGE,
    MT_OBJECTIVE_MASS,
    MT_OBJECTIVE_EXPRESSION,
    MT_OBJECTIVE_MISFIT,
    MT_OBJECTIVE_CLEARANCE
} mt_objective_type;

typedef struct mt_objective {
    mt_objective_type type;
    mt_expr expression;
    const char *expression_text;
    mt_name_list of; /* mass: patterns of item names (bodies, links, springs that have mass); none: all */
    mt_addr addr;
} mt_objective;

typedef enum mt_role { MT_ROLE_VERIFIES, MT_ROLE_CALIBRATES, MT_ROLE_NOT_COMPARABLE } mt_role;
typedef enum mt_published_kind { MT_PUBLISHED_PARAMETER, MT_PUBLISHED_QUANTITY, MT_PUBLISHED_FREQUENCY, MT_PUBLISHED_MAC, MT_PUBLISHED_STATUS } mt_published_kind;

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
    const char *status;     /* "solved" | "compromise" | "infeasible" */
    bool original;          /* judge at the original design instead of the recommended one ("design": "original") */
    double value;
    double tolerance;         /* absolute */
    double tolerance_percent;
    double at_least;
    double at_most;
    mt_role role;
    const char *source;
    const char *label;        /* "label": what a comparison table calls it; NULL: made from the rest */
    mt_addr addr;
} mt_published;

typedef struct mt_search {
    unsigned long seed;
    int starts;         /* 0: chosen by the number of variables */
    long max_evaluations; /* 0: default */
} mt_search;

typedef struct mt_study {
    mt_arena mem; /* owns everything but the models' own memory */
    const char *path;
    const char *name;
    const char *description;
    mt_name model_path;
    mt_model *model; /* owned */
    MT_LIST_OF(mt_variable, variables);
    MT_LIST_OF(mt_goal, goals);
    MT_LIST_OF(mt_reference, references);
    MT_LIST_OF(mt_objective, objectives);
    MT_LIST_OF(mt_published, published);
    int recommendations; /* how many to report; default 5 */
    mt_search search;
    int n_inputs;        /* files read: study, models */
    struct mt_input_file {
        const char *name;    /* relative to the study's folder */
        const char *sha256;  /* hex */
    } *inputs;
} mt_study;

mt_status mt_study_new(mt_study **out, mt_err *err);
void mt_study_delete(mt_study *study);
/* Resolve names and check meaning (model is set and finished): unknown names with "did you mean", lower >= upper, a positive parameter with bounds <= 0 is fine (linear scale),
 * goals without any demand, weights without misfit objective and misfit objective without weights, a variable overridden in every configuration that goals name, references without a common sensor,
 * mode indices < 1, duplicate variables, catalogue and bounds together, ... Returns MT_E_INPUT where diags holds errors. */
mt_status mt_study_finish(mt_study *study, mt_diags *diags, mt_err *err);
int mt_study_find_reference(const mt_study *study, const char *name);

#endif
