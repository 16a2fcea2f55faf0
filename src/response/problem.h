/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_PROBLEM_H
#define RESPONSE_PROBLEM_H

#include "analysis/analysis.h"
#include "mechanics/forcing.h"
#include "response/forced.h"
#include "response/ports.h"

/* Port data over all states, kept for derivatives; see mt_joint_force. */
typedef struct mt_response_ways {
    mt_joint_force *joint; /* [n_out] for outputs that are joints' forces */
    double *c;             /* n x n viscous damping; NULL: none */
    double *h;             /* n x n structural damping; NULL: none */
} mt_response_ways;

/*
 * The forced problem of the last solve of an analysis (all modes with vectors, nothing
 * unstable); refers to that analysis. Motions x are relative to the ground. For a ground
 * acceleration along r, f = -M r; a point's motion in space is x plus that of the ground.
 * Results in mem. Fails: MT_E_USAGE (a redundant joint's force), MT_E_EQUILIBRIUM (a mode is
 * unstable, or rounding hides whether it is), as mt_linear_joint_force, MT_E_MEMORY.
 */
mt_status mt_response_problem(mt_analysis *a, const mt_port_set *ports, mt_arena *mem,
                              mt_forced *f, mt_response_ways *ways, mt_err *err);
/* Power of s of an input's force. */
int mt_response_power(const mt_port *in);
/* Value of a node; 0 where there is none. */
double mt_response_node(const mt_analysis *a, mt_node node);
/* A part of the force in a spring or damper: share times the term's coefficient times the
 * motion along the row. A bushing's component has one part per row of its stiffness. */
enum { MT_FORCE_PARTS = 6 };
typedef struct mt_force_part {
    int row;
    const mt_term *term;
    double share;
} mt_force_part;
/* part[MT_FORCE_PARTS]: the parts of the port's force. Returns their number. */
int mt_response_force(const mt_analysis *a, const mt_port *port, mt_force_part *part);
/* The same for a given list of terms of the port's kind instead of the analysis' own. */
int mt_response_force_among(const mt_system *sys, const mt_term_list *list, const mt_port *port,
                            mt_force_part *part);

#endif
