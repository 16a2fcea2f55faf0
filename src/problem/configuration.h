/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_CONFIGURATION_H
#define PROBLEM_CONFIGURATION_H

#include "problem/workspace.h"

/* The system of a configuration at inputs x[n]; with a drive that the caller adds, x[n + 1]. */
mt_system_def mt_problem_system(const mt_problem *p, int configuration, const double *x);
/* Counts n modal solutions and reports progress. */
void mt_problem_note_modal(const mt_problem *p, long n);
/* Analysis of a configuration at x[n], counted in study->counted. *out is the caller's. Fails:
 * as mt_analysis_new. */
mt_status mt_problem_analyse(const mt_problem *p, int configuration, const double *x,
                             mt_analysis **out, mt_err *err);
/* The same with the system and mode count of a compiled configuration (mt_analysis_new_like),
 * which is cheaper. */
mt_status mt_configuration_analyse(const mt_configuration_problem *view, const double *x,
                                   mt_analysis **out, mt_err *err);
/* Analysis of the configuration's mechanism with a drive and the configuration's mode count, at
 * the inputs of mt_analysis_new_driven. */
mt_status mt_configuration_drive(const mt_problem *p, const mt_configuration_problem *view,
                                 const mt_system_drive *drive, const double *at,
                                 mt_analysis **out, mt_err *err);
/* Index in p->views of a model's configuration; -1: none. */
int mt_problem_configuration(const mt_problem *p, int configuration);
/* The same, added where missing. Only while the problem is compiled. */
mt_status mt_problem_add_configuration(mt_problem *p, int configuration, int *out, mt_err *err);
/* Number of vibration modes of a configuration, the most of any design of the study. */
int mt_configuration_vibrations(const mt_configuration_problem *view);
/* Name of the configuration. */
const char *mt_configuration_name(const mt_problem *p, const mt_configuration_problem *view);
/* From now on all modes are requested and, where shapes are, all of these. */
void mt_configuration_query_all(mt_configuration_work *view);
/* *pos: position of a mode (by index, or for mode 0 by `named`, its place in the
 * configuration's list of named modes) among the modes; -1: none, or the configuration is
 * unstable. */
mt_status mt_configuration_position(mt_workspace *w, mt_configuration_work *view, int mode,
                                    int named, int *pos, mt_err *err);
/* Positions of all named modes at the last solve, which was at w->x (workspace_track.c). */
mt_status mt_configuration_track(mt_workspace *w, mt_configuration_work *view, mt_err *err);

#endif
