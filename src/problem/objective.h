/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_OBJECTIVE_H
#define PROBLEM_OBJECTIVE_H

#include "problem/workspace.h"

/* What a change df of an objective's value is worth at a design. */
typedef struct mt_price {
    double df;
    double change; /* of the design */
    double score;  /* of the design, by the first objective */
    bool first;    /* the objective is the first one */
} mt_price;

/*
 * The operations of a kind of objective, one file for each kind (objective_<kind>.c); what
 * files and results call it, and its properties, stand in study/objective_kinds.h. The search
 * makes its value f least.
 */
typedef struct mt_objective_ops {
    /* Nodes and items that f is made of; nodes[parameters of the model] of p->program. NULL:
     * there are none. */
    mt_status (*compile)(mt_problem *p, mt_objective_stage *a, const mt_node *nodes,
                         mt_err *err);
    /* f at the last evaluation, and its gradient[n_t], zero before, unless NULL. NULL: 0. */
    double (*value)(const mt_workspace *w, const mt_objective_stage *a, double *gradient);
    /* At most any f over a box of inputs; low, high: room for
     * the nodes of any program of p. NULL: not known. */
    double (*least)(const mt_problem *p, const mt_objective_stage *a, const double *lo,
                    const double *hi, double *low, double *high);
    /* What results show of f. NULL: f, or the root of twice f where f is half a square. */
    double (*shown)(double f);
    /* "0.12 kg". NULL: further than the slope at the design tells, or out of memory. The
     * member NULL: slopes tell nothing of f. */
    const char *(*price)(const mt_price *q, mt_arena *mem);
    /* df is that of 1 % of a requirement: "moving it by 1 % takes ..." where the variables
     * hardly move it. NULL: they do, or out of memory. The member NULL: slopes do not tell. */
    const char *(*hardly)(const mt_price *q, mt_arena *mem);
} mt_objective_ops;

#define MT_OBJECTIVE_OPS(id, name, ...) extern const mt_objective_ops mt_objective_##name;
MT_OBJECTIVE_LIST(MT_OBJECTIVE_OPS)
#undef MT_OBJECTIVE_OPS
const mt_objective_ops *mt_objective_ops_of(mt_objective_type type);

/* f of objective k at the last evaluation over its size, gradient[n_t] (may be NULL)
 * likewise: all that searches and ranks see. */
double mt_objective_stage_value(const mt_workspace *w, int k, double *gradient);
/* A value f of an objective, a half square as its root: differences of these are told. */
double mt_objective_stage_root(const mt_objective_stage *a, double f);
/* What results show of it. */
double mt_objective_stage_shown(const mt_objective_stage *a, double f);
/* Hold objective k of c (mt_subproblem_for_stages) at f, as well as it can be told from f, from
 * the next stage on; a misfit at the residuals of w's last evaluation. */
void mt_objective_stage_hold(mt_subproblem *c, const mt_workspace *w, int k, double f);
/* The rows of the objectives that are held. */
void mt_objective_stage_hold_rows(mt_workspace *w, bool with_gradient, mt_nlp_values *out);

/* Sums of n terms and the logarithms in them are rounded by less than this many times n eps. */
#define MT_OBJECTIVE_ULPS 16.0

#endif
