/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_PROBLEM_H
#define PROBLEM_PROBLEM_H

#include "analysis/tracking.h"
#include "problem/reference.h"
#include "problem/subproblem.h"
#include "study/bands.h"
#include "study/study.h"

/*
 * A study compiled for evaluation: variables as scaled coordinates t, configurations that goals
 * name, goals as a flat list of requirements (one per goal and configuration), the objectives.
 * Compiled once and never changed: all workers share it. What of it is asked is a case
 * (subproblem.h), what a worker needs to evaluate it a workspace (workspace.h).
 *
 * Coordinates: t = ln x where the lower bound and the original value are positive. A lower
 * bound of 0 keeps the logarithm down to a floor, a thousandth of the original,
 *     t = ln x                              x >= floor
 *     t = ln(floor) + (x - floor)/floor     x <  floor
 *         (continuous with its slope; dx/dt = max(x, floor))
 * Where the original is 0 or negative, the bounds reach below 0, or the study gives a scale, t
 * = x / scale. The change of a redesign is then
 *     sqrt(sum w_i (t_i - t_i(original))^2).
 *
 * Files: problem.c (life, coordinates), problem_requirements.c (goals to requirements),
 * problem_program.c (expressions and objectives); goal_*.c and objective_*.c are the kinds,
 * drive_positions.c ties the positions of one drive.
 */

/* A configuration that goals speak of; or, of a case, one more position of a drive. */
typedef struct mt_configuration_problem {
    int configuration;
    /* owned by the problem (of a cut: by who made it, drive_positions.h); solved at the
     * original design and never again: it is shared */
    mt_analysis *original;
    int n_rigid; /* modes are counted so at all designs (mt_analysis) */
    int n_most;
    int n_named; /* named modes of this configuration that exist at the original design */
    int *named;  /* [n_named] of the model */
    const double **shape;    /* [n_named] weighed there (tracking.h) */
    mt_analysis_options ask; /* what its goals need of its modes: which, and their shapes */
    /* pairs of an input and an output that goals name there, each once: a forced problem each
     * (forced_response.h) */
    int n_pairs;
    struct mt_forced_response_pair *pairs;
} mt_configuration_problem;

/* positions of one drive (drive_positions.h) */
typedef struct mt_drive_positions mt_drive_positions;

/* What a requirement limits: what is known of it over boxes of designs, and of modes in their
 * order. */
typedef enum mt_quantity {
    MT_QUANTITY_FREQUENCY, /* of a mode */
    MT_QUANTITY_EXPRESSION,
    MT_QUANTITY_OTHER
} mt_quantity;

typedef struct mt_requirement {
    const struct mt_goal_ops *ops; /* of its kind (goal.h), likewise the next two */
    mt_quantity quantity;
    mt_goal_measure measure;
    const mt_goal *goal;
    int goal_index;
    int view;       /* -1: of no configuration, an expression */
    int mode;       /* 1-based index; 0: by name */
    int named;      /* position in the view's list, where by name */
    int pair;       /* response, vibration: of its view */
    int first_mode; /* response over a band: its parts begin with this mode, */
    int n_parts;    /* and are so many rows; 0: it is one number, one row for each limit */
    mt_node node;   /* limit: node of the expressions' program */
    mt_reference_shape shape; /* shape, mac; frequency: without the shape */
    struct mt_fit *fit;       /* frequency_response (goal_frequency_response.h); else NULL */
    double equals; /* what is asked for, by the goal or its reference; NaN: limits only */
    /* a target that is a range over the tolerances of the variables (tolerance.h) */
    bool ranged;
    int row_eq;       /* its row in eq, -1 none */
    int row_in;       /* first row in in, -1 none */
    int n_in;         /* 2 where at_least and at_most are both given; or n_parts */
    int row_soft;     /* first row of the objective "vibration" that it is part of, -1 none, */
    int n_soft;       /* so many: then it limits nothing else */
    int row_res;      /* first residual, -1 none */
    int n_res;        /* residuals */
    double floor_hz;  /* in the unit of its number: below, its logarithm goes on as a tangent */
    double tolerance; /* relative */
    /* what a difference from a limit of 0 is divided by (mt_requirement_unit): of an expression
     * what it changes by with the variables at the original design, of anything else 1 */
    double size;
} mt_requirement;

/*
 * The bands that one configuration keeps clear of: all avoid goals that name it, united. A gap
 * assignment says how many vibration modes lie below each band; with one, the cluster of modes
 * on each side of each band is constrained (in = ln(lower / f), ln(f / upper)), which is smooth
 * where "no mode inside" is not. Without one, no rows.
 */
typedef struct mt_avoidance {
    int view;
    int goal_index; /* of the first goal */
    mt_bands bands;
    int cluster;
    int first; /* bands first .. first + bands.n - 1 of an assignment */
    double tolerance;
} mt_avoidance;

/* An objective. */
typedef struct mt_objective_stage {
    mt_objective_type type;
    const struct mt_objective_ops *ops; /* of its kind (objective.h) */
    const mt_objective *objective;      /* NULL: none */
    mt_node node;                       /* expression: in the problem's program */
    /* what its value is divided by in the search, which then knows no units: of an amount (a
     * mass, an expression) a power of two next to what it changes by with the variables at the
     * original design; else 1 */
    double size;
    int n_mass;    /* items counted by a mass */
    mt_node *mass; /* [n_mass] nodes in the first view's program */
} mt_objective_stage;

typedef struct mt_problem {
    const mt_study *study; /* must outlive the problem, like the run */
    const mt_run *run;     /* never NULL */
    mt_reference_cache *references;
    mt_arena mem;
    int n;            /* variables */
    int *inputs;      /* [n] parameters */
    double *original; /* [n] */
    double *scale;    /* [n] NaN: logarithmic; else x = t * scale */
    double *floor;    /* [n] where the logarithm ends; 0: nowhere */
    int n_views;
    mt_configuration_problem *views;
    int n_requirements;
    mt_requirement *requirements;
    int n_avoidances;
    mt_avoidance *avoidances;
    int n_bands; /* of all clears: length of a gap assignment */
    int n_families;
    mt_drive_positions *families;
    /* [n_bands] the first of the bands that have the same number of modes below them
     * (drive_positions.h) */
    int *tie;
    int n_eq;
    int n_in; /* of the requirements; those of a case are more */
    int n_soft;
    int n_res;
    double weights;     /* sum of the weights of the requirements that are residuals */
    mt_program program; /* expressions: limits, objectives, published quantities */
    /* nodes of it that the search needs: those of published quantities follow */
    int n_searched;
    mt_node *published; /* [study->n_published] */
    int n_aims;         /* at least one */
    mt_objective_stage *aims;
    mt_subproblem whole; /* the study as it is asked: all bounds, no gap assignment */
} mt_problem;

/*
 * Compile. Solves every view once at the original design; a configuration that is unstable
 * there is no failure, its goals are unmet. Fails: MT_E_INPUT with the goal's address in the
 * text (a mode that is not there, no common sensor; what this version does not search),
 * numerical failures at the original design (no equilibrium, ...), MT_E_MEMORY.
 */
mt_status mt_problem_new(const mt_study *study, const mt_run *run, mt_problem **out,
                         mt_err *err);
/* Accepts NULL. */
void mt_problem_delete(mt_problem *p);
/* The system of a configuration at inputs x[n]; with a drive that the caller adds, x[n + 1]. */
mt_system_def mt_problem_system(const mt_problem *p, int configuration, const double *x);
/* n modal solutions were made: to who counts them and to who watches. */
void mt_problem_note_modal(const mt_problem *p, long n);
/* Compile and forget: whether the study can be asked. Fails as mt_problem_new. */
mt_status mt_problem_try(const mt_study *study, mt_err *err);
/* The coordinate of value x of variable i. */
double mt_problem_t(const mt_problem *p, int i, double x);
/* The value of variable i at a coordinate, between the bounds; to rounding. */
double mt_problem_value(const mt_problem *p, int i, double t);
/* dx_i/dt_i at the value x of variable i. */
static inline double mt_problem_dx_dt_at(const mt_problem *p, int i, double x)
{
    return MT_HAS(p->scale[i]) ? p->scale[i] : x > p->floor[i] ? x : p->floor[i];
}

/* An analysis of a configuration at x[n], counted as the study counts (study->counted). *out is
 * the caller's. Fails as mt_analysis_new. */
mt_status mt_problem_analyse(const mt_problem *p, int configuration, const double *x,
                             mt_analysis **out, mt_err *err);
/* The same for a view, with its count and its system (mt_analysis_new_like): cheaper. */
mt_status mt_configuration_analyse(const mt_configuration_problem *view, const double *x,
                                   mt_analysis **out, mt_err *err);
/* An analysis of the view's mechanism with a drive, counted as the view is, at the inputs of
 * mt_analysis_new_driven. */
mt_status mt_configuration_drive(const mt_problem *p, const mt_configuration_problem *view,
                                 const mt_system_drive *drive, const double *at,
                                 mt_analysis **out, mt_err *err);
/* View of a configuration, -1. */
int mt_problem_configuration(const mt_problem *p, int configuration);
/* The same, made where it is not there yet. While the problem is compiled. */
mt_status mt_problem_add_configuration(mt_problem *p, int configuration, int *out, mt_err *err);
/* Vibration modes of a view: as many as any design of the study has. */
int mt_configuration_vibrations(const mt_configuration_problem *view);
/* The configuration's name. */
const char *mt_configuration_name(const mt_problem *p, const mt_configuration_problem *view);

/* problem_requirements.c: views, requirements and their rows. */
mt_status mt_problem_init_requirements(mt_problem *p, mt_err *err);
/* problem_responses.c. Fails: MT_E_INPUT, with the port that there is not. */
mt_status mt_problem_check_responses(const mt_problem *p, mt_err *err);
/* What each view is asked for; after requirements and bands. */
void mt_problem_query(mt_problem *p);
/* problem_program.c: the program of expressions, and the objectives. After the requirements. */
mt_status mt_problem_init_program(mt_problem *p, mt_err *err);

#endif
