/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_PROBLEM_H
#define PROBLEM_PROBLEM_H

#include "analysis/tracking.h"
#include "environment/bands.h"
#include "mechanics/energy_share.h"
#include "problem/reference.h"
#include "problem/subproblem.h"
#include "study/study.h"

/*
 * A study compiled for evaluation: variables as scaled coordinates t, the configurations that
 * goals name, goals as a flat list of requirements (one per goal and configuration), the
 * objectives. Immutable after compilation and shared by all workers. A subproblem
 * (subproblem.h) selects what is solved, a workspace (workspace.h) is what a worker evaluates
 * it with.
 *
 * Coordinates: t = ln x where the lower bound and the original value are positive. With a lower
 * bound of 0 the logarithm ends at a floor, a thousandth of the original,
 *     t = ln x                              x >= floor
 *     t = ln(floor) + (x - floor)/floor     x <  floor
 *         (continuous with its slope; dx/dt = max(x, floor))
 * Where the original is 0 or negative, the bounds reach below 0, or the study gives a scale, t
 * = x / scale. The total change is
 *     sqrt(sum w_i (t_i - t_i(original))^2).
 *
 * Files: problem.c compiles; goals.c, forced_response.c, goal_frequency_response.c and
 * goal_static.c are the kinds of goal, objective.c those of objectives; rows.h and
 * requirement.c, avoidance.c, tolerance.c, objective.c the kinds of rows, which evaluate.c lays
 * out and evaluates; drive_positions.c ties the positions of one drive.
 */

/* A configuration that goals name; in a subproblem also a further position of a drive. */
typedef struct mt_configuration_problem {
    int configuration;
    /* analysis at the original design, solved once and then shared; owned by the problem (of a
     * cut: by its maker, drive_positions.h) */
    mt_analysis *original;
    int n_rigid; /* used for all designs (mt_analysis) */
    int n_most;
    int n_named;             /* named modes that exist at the original design */
    int *named;              /* [n_named] indices in the model */
    const double **shape;    /* [n_named] weighted shapes at the original design (tracking.h) */
    mt_analysis_options ask; /* modes and shapes that its goals need */
    /* distinct pairs of input and output that goals name: one forced problem each
     * (forced_response.h) */
    int n_pairs;
    struct mt_forced_response_pair *pairs;
} mt_configuration_problem;

/* positions of one drive (drive_positions.h) */
typedef struct mt_drive_positions mt_drive_positions;

/* Kind of value that a requirement limits, which decides what is known of it over boxes of
 * designs and of its order over modes. */
typedef enum mt_quantity {
    MT_QUANTITY_FREQUENCY,   /* of a mode */
    MT_QUANTITY_FREQUENCIES, /* made of those of two modes */
    MT_QUANTITY_EXPRESSION,
    MT_QUANTITY_OTHER
} mt_quantity;

/* What the rows of a requirement are. */
typedef enum mt_requirement_role {
    MT_ROLE_LIMIT,  /* inequalities, one for each limit or part */
    MT_ROLE_TARGET, /* an equality */
    MT_ROLE_RANGE,  /* a target with a range over the tolerances (tolerance.h): corners alone */
    MT_ROLE_RESIDUAL, /* residuals of the misfit */
    MT_ROLE_VIBRATION /* inequalities of the objective "vibration"; it limits nothing else */
} mt_requirement_role;

/* A mode that a requirement is about. */
typedef struct mt_requirement_mode {
    const mt_mode_ref *asked; /* as the study names it */
    int view;                 /* its configuration; -1: there is no such mode */
    int mode;                 /* 1-based index; 0: by name */
    int named;                /* position in the configuration's list, where by name */
} mt_requirement_mode;

typedef struct mt_requirement {
    int index; /* in the subproblem's list */
    mt_requirement_role role;
    int n_rows;                    /* in the block of its role; 0 of a range */
    const struct mt_goal_ops *ops; /* of its kind (goals.h), as the next two */
    mt_quantity quantity;
    mt_goal_measure measure;
    const mt_goal *goal;
    int goal_index;
    int view;                 /* configuration; -1: none, an expression */
    int mode;                 /* 1-based index; 0: by name */
    int named;                /* position in the configuration's list, where by name */
    const mt_mode_ref *asked; /* the mode as the study names it */
    mt_requirement_mode of;   /* the other mode of two */
    int pair;                 /* response, vibration: index of the port pair */
    int first_mode;           /* response over a band: its parts begin with this mode */
    int n_rest; /* static: 1, or 2 with a configuration whose value is subtracted */
    struct mt_rest_reading *rest; /* [n_rest] where they are read (goal_static.c); else NULL */
    int n_parts;  /* number of parts, one row each; 0: a single value, one row per limit */
    mt_node node; /* limit: node of the expressions' program */
    mt_reference_shape shape;     /* shape, mac; frequency: without the shape */
    int direction;                /* energy: of the goal's; 0 where it has none */
    const mt_energy_part *energy; /* energy: the part of the mode's; else NULL */
    struct mt_fit *fit; /* frequency_response (goal_frequency_response.h); else NULL */
    double equals;      /* target, from the goal or its reference; NaN: limits only */
    /* floor of its value, in its unit: below it the logarithm is continued by a tangent */
    double floor_hz;
    double tolerance; /* relative */
    /* divisor of a difference from a limit of 0 (mt_requirement_unit): of an expression its
     * change over the variables at the original design; otherwise 1 */
    double size;
} mt_requirement;

/*
 * Bands to be avoided in one configuration: the union over all avoid goals that name it. A mode
 * placement gives the number of vibration modes below each band; it constrains the cluster of
 * modes on each side of each band (in = ln(lower / f), ln(f / upper)), which is smooth where
 * "no mode inside" is not. Without a placement there are no rows.
 */
typedef struct mt_avoidance {
    int view;
    int goal_index; /* index of the first goal */
    mt_bands bands;
    int cluster;
    int first; /* its bands are first ... first + bands.n - 1 of a placement */
    double tolerance;
} mt_avoidance;

/* An objective. */
typedef struct mt_objective_stage {
    mt_objective_type type;
    const struct mt_objective_ops *ops; /* of its kind (objective.h) */
    const mt_objective *objective;      /* NULL: none */
    mt_node node;                       /* expression: in the problem's program */
    /* divisor of its value in the search, which makes that free of units: for an amount (a
     * mass, an expression) the power of two next to its change over the variables at the
     * original design; else 1 */
    double size;
    int n_mass;    /* items of a mass */
    mt_node *mass; /* [n_mass] nodes in the first configuration's program */
} mt_objective_stage;

/* What is chosen from a catalogue at once: the value of a variable, or a row of values of n
 * neighbouring ones. */
typedef struct mt_choice {
    int first; /* variables first .. first + n - 1 */
    int n;
    int n_rows;
    const double *value;           /* [n_rows x n] */
    const mt_catalogue_rows *rows; /* NULL: values stand alone */
} mt_choice;

typedef struct mt_problem {
    const mt_study *study; /* study and run must outlive the problem */
    const mt_run *run;     /* never NULL */
    mt_reference_cache *references;
    mt_arena mem;
    int n; /* variables */
    int n_choices;
    mt_choice *choices; /* [n_choices] in the order of their variables */
    int *inputs;        /* [n] parameters */
    double *original;   /* [n] */
    double *scale;      /* [n] NaN: logarithmic; else x = t * scale */
    double *floor;      /* [n] floor of the logarithm; 0: none */
    int n_views;
    mt_configuration_problem *views;
    int n_requirements;
    mt_requirement *requirements;
    int n_avoidances;
    mt_avoidance *avoidances;
    int n_bands; /* over all avoidance goals: length of a mode placement */
    int n_families;
    mt_drive_positions *families;
    /* [n_bands] first band of its set of tied bands (drive_positions.h) */
    int *tie;
    double weights;     /* sum of the weights of requirements that are residuals */
    mt_program program; /* expressions: limits, objectives, published quantities */
    /* nodes of it that the search needs; those of published quantities follow */
    int n_searched;
    mt_node *published; /* [study->n_published] */
    int n_stages;       /* at least one */
    mt_objective_stage *stages;
    mt_subproblem whole; /* the whole study: all bounds, no mode placement */
} mt_problem;

/*
 * Compiles a study. Solves every configuration once at the original design; one that is
 * unstable there is no failure: its goals are unmet. Fails: MT_E_INPUT with the goal's address
 * in the text (a mode that does not exist, no common sensor; what this version does not
 * search), numerical failures at the original design (no equilibrium, ...), MT_E_MEMORY.
 */
mt_status mt_problem_new(const mt_study *study, const mt_run *run, mt_problem **out,
                         mt_err *err);
/* Accepts NULL. */
void mt_problem_delete(mt_problem *p);
/* Compiles the study and discards the result, as a check. Fails: as mt_problem_new. */
mt_status mt_problem_try(const mt_study *study, mt_err *err);
/* First row of a requirement in the block of its role. */
static inline int mt_requirement_row(const mt_subproblem *c, const mt_requirement *d)
{
    return c->rows.of[d->index].first;
}
/* dx_i/dt_i at the value x of variable i. */
static inline double mt_problem_dx_dt_at(const mt_problem *p, int i, double x)
{
    return MT_HAS(p->scale[i]) ? p->scale[i] : x > p->floor[i] ? x : p->floor[i];
}

/* The values of row `row` of a choice, [n]. */
const double *mt_choice_row(const mt_choice *choice, int row);
/* The row with the values x [n of the problem]; MT_ABSENT where none has. */
int mt_choice_find(const mt_choice *choice, const double *x);

#endif
