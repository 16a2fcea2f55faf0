/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TUNE_PROBLEM_H
#define TUNE_PROBLEM_H

#include "tune/analysis.h"
#include "tune/nlp.h"
#include "tune/study.h"

/*
 * A study compiled for evaluation: variables as scaled coordinates t, one analysis per configuration that a goal names, goals as a flat list of demands (one per goal and
 * configuration), the objective. One problem, one worker.
 *
 * Coordinates: t = ln x where both bounds and the original value are positive, else t = x / scale. The change of a redesign is then
 *     sqrt(sum w_i (t_i - t_i(original))^2).
 */
typedef struct mt_reference_shape {
    const char *reference; /* name */
    int mode;              /* 1-based in the reference */
    int ns;
    int *channel;        /* [ns] channels of the configuration's system */
    double *shape;       /* [ns] of the reference, unit norm */
    double frequency_hz; /* NaN: not known */
} mt_reference_shape;

/* Named mode of the model, as it is at the original design: w = M phi over all states, for the mass-weighted correlation. */
typedef struct mt_named_shape {
    int named; /* of the model */
    double *w; /* [nq] */
} mt_named_shape;

typedef struct mt_view {
    int configuration;
    mt_analysis *analysis; /* owned */
    int n_named;
    mt_named_shape *named; /* named modes of this configuration */
    bool needs_gradient;
    bool needs_vectors;
} mt_view;

typedef struct mt_demand {
    const mt_goal *goal;
    int goal_index;
    int view;                 /* -1: a limit */
    int mode;                 /* 1-based index; 0: by name */
    int named;                /* position in the view's list, where by name */
    mt_node node;             /* limit: node of the expressions' program */
    mt_reference_shape shape; /* shape, mac; frequency: without the shape */
    double target_hz;
    int row_eq;       /* first row in eq, -1 none */
    int row_in;       /* first row in in (two rows where both limits are given), -1 */
    int row_res;      /* first residual, -1 */
    double tolerance; /* relative */
} mt_demand;

/* References that are models are analysed once, when first asked for, and shared by all problems of a study: they do not depend on the design. */
typedef struct mt_reference_cache {
    int n;
    mt_analysis **analysis; /* [n_references] owned */
} mt_reference_cache;

typedef struct mt_problem {
    const mt_study *study;          /* must outlive the problem */
    mt_reference_cache *references; /* likewise */
    mt_arena mem;
    int n;            /* variables */
    int *inputs;      /* [n] parameters */
    double *original; /* [n] */
    double *lower_t;
    double *upper_t;
    double *origin_t;
    double *scale; /* [n] NaN: logarithmic; else x = t * scale */
    int n_views;
    mt_view *views;
    int n_demands;
    mt_demand *demands;
    int n_eq;
    int n_in;
    int n_res;
    double *eq_tol;
    double *in_tol;
    mt_program program; /* expressions: limits, objective, published quantities */
    mt_node *limit;     /* [n_demands] in program */
    mt_node objective_node;
    mt_node *published; /* [study->n_published] */
    double *value;      /* [program.count] */
    double *grad;
    mt_objective_type objective;
    int n_mass;      /* items counted by a mass objective */
    mt_node *mass;   /* nodes in the first view's program */
    double *x;       /* [n] work */
    double *dlambda; /* [n] work */
    double *shape;   /* [max ns] work */
    double *dshape;  /* [max ns x n] work */
    long evaluations;
    const volatile int *stop;
} mt_problem;

/* Compile. Solves every view once at the original design. Fails: MT_E_INPUT (with the goal's address in the text: a mode that is not there, no common sensor), numerical failures. */
mt_status mt_problem_new(const mt_study *study, mt_reference_cache *references,
                         mt_problem **out, mt_err *err);
mt_status mt_reference_cache_init(mt_reference_cache *cache, const mt_study *study,
                                  mt_arena *mem, mt_err *err);
void mt_reference_cache_free(mt_reference_cache *cache);
void mt_problem_delete(mt_problem *p);
/* Parameter values of coordinates t. */
void mt_problem_x(const mt_problem *p, const double *t, double *x);
/* The nlp's callback: context is the problem. */
mt_status mt_problem_eval(void *context, const double *t, bool with_gradient,
                          mt_nlp_values *out, mt_err *err);
/* As a search problem (arrays belong to the problem). */
mt_nlp mt_problem_nlp(mt_problem *p);

/* Position of the demanded mode in the view's modes; -1: there is none (or the configuration is unstable). */
int mt_view_position(mt_view *view, int mode, int named, mt_err *err);
/* View of a configuration, -1. */
int mt_problem_view(const mt_problem *p, int configuration);

/* Channels that both sides have: fills channel[] (of sys) and the reference's shape at them; see reference.c. */
mt_status mt_reference_shape_init(const mt_problem *p, int reference, int mode,
                                  const mt_system *sys, mt_arena *mem, mt_reference_shape *out,
                                  mt_err *err);
/* The reference's frequency alone, for a frequency goal: ns is 0, no sensor is needed. */
mt_status mt_reference_frequency_init(const mt_problem *p, int reference, int mode,
                                      mt_reference_shape *out, mt_err *err);
/* MAC of the mode at pos with the reference; NaN where a shape vanishes. */
mt_status mt_reference_mac(mt_analysis *a, int pos, const mt_reference_shape *ref, double *mac,
                           mt_err *err);

/* problem_demand.c: values (and gradients) of one demand, after its view has been solved. */
mt_status mt_demand_eval(mt_problem *p, const mt_demand *d, bool with_gradient,
                         mt_nlp_values *out, mt_err *err);

#endif
