/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_OBJECTIVE_H
#define PROBLEM_OBJECTIVE_H

#include "problem/workspace.h"

/* A change df of an objective's value at a design, to be expressed in words. */
typedef struct mt_price {
    double df;
    double change; /* total change of the design */
    double score;  /* first objective of the design */
    bool first;    /* the objective is the first one */
} mt_price;

/*
 * The operations of a kind of objective, one file for each kind (objective_<kind>.c); its names
 * in files and results, and its properties, are in study/objectives.h. The search
 * minimises its value f.
 */
typedef struct mt_objective_ops {
    /* Finds the nodes and items of f; nodes[parameters of the model] of p->program. NULL:
     * none. */
    mt_status (*compile)(mt_problem *p, mt_objective_stage *a, const mt_node *nodes,
                         mt_err *err);
    /* f at the last evaluation, and its gradient[n_t] (zeroed by the caller) unless NULL. NULL:
     * f is 0. */
    double (*value)(const mt_workspace *w, const mt_objective_stage *a, double *gradient);
    /* Lower bound of f over a box of inputs; low, high: work, as long as the largest program of
     * p. NULL: not known. */
    double (*least)(const mt_problem *p, const mt_objective_stage *a, const double *lo,
                    const double *hi, double *low, double *high);
    /* Value shown in results. NULL: f, or sqrt(2 f) where f is half a square. */
    double (*shown)(double f);
    /* df in words, such as "0.12 kg". Returns NULL where df is too large for the slope at the
     * design, or out of memory. The member NULL: slopes say nothing about f. */
    const char *(*price)(const mt_price *q, mt_arena *mem);
    /* df for 1 % of a requirement: "moving it by 1 % takes ..." where the variables hardly move
     * it. Returns NULL where they do, or out of memory. The member NULL: slopes say nothing
     * about that. */
    const char *(*hardly)(const mt_price *q, mt_arena *mem);
} mt_objective_ops;

#define MT_OBJECTIVE_OPS(id, name, ...) extern const mt_objective_ops mt_objective_##name;
MT_OBJECTIVE_LIST(MT_OBJECTIVE_OPS)
#undef MT_OBJECTIVE_OPS
const mt_objective_ops *mt_objective_ops_of(mt_objective_type type);

/* f / size of objective k at the last evaluation, and its gradient[n_t] (may be NULL): the
 * values that searches and rankings use. */
double mt_objective_stage_value(const mt_workspace *w, int k, double *gradient);
/* f of an objective, or sqrt(2 f) where f is half a square: differences of this are
 * reported. */
double mt_objective_stage_root(const mt_objective_stage *a, double f);
/* Value of f shown in results. */
double mt_objective_stage_shown(const mt_objective_stage *a, double f);
/* Sets c (of mt_subproblem_for_stages) to a stage: the objectives k before it are held at f[k],
 * within its rounding; a misfit at the residuals of w's last evaluation. */
void mt_objectives_hold(mt_subproblem *c, const mt_workspace *w, int stage, const double *f);

/* Rounding of sums of n terms and of their logarithms is below this many times n eps. */
#define MT_OBJECTIVE_ULPS 16.0

#endif
