/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_DRIVE_POSITIONS_H
#define PROBLEM_DRIVE_POSITIONS_H

#include "problem/workspace.h"

/*
 * Configurations that are one mechanism in several positions of one driven joint
 * (mechanics/system.h: mt_system_same_drive) are a family. Frequencies are continuous along the
 * drive, so between two positions that differ in the number of modes below a band a mode passes
 * through it. Two bands of two views of a family that share frequencies are tied: a design has
 * the same number of modes below both. Where positions are named on both sides, what is
 * forbidden between them is what some position on the one side and some position on the other
 * side both forbid.
 */
struct mt_drive_positions {
    int n; /* views, at least two */
    int *view;
    const char *joint;
    const char *spring; /* trimmed to hold the joint; NULL: locked */
    bool angle;         /* positions in rad; else m */
    bool fixed;         /* the positions do not depend on the design */
    int configuration;  /* of a view with a drive */
    bool banded;        /* at least two views keep clear of bands */
    bool limited;       /* a goal limits a number in at least two views */
    /* where banded or limited: the mechanism with the position as its last input, beside the
     * variables; its original is owned by the problem, NULL where there is none: `why` */
    mt_configuration_problem moving;
    double *moving_at; /* [n + 1] where that is solved */
    const char *why;
};

/* One more position of a family where the bands between its positions are kept, or where one
 * limit of a number is: a cutting plane of a search. Its analysis lends its system to
 * all cases and workers that keep it, which it outlives. */
typedef struct mt_cut {
    int drive_positions;
    int requirement; /* the limit that is kept there (at_position.h); -1: bands */
    double position;
    mt_analysis *original; /* owned */
} mt_cut;

/* After views and clears: families, p->tie. Fails: MT_E_MEMORY, MT_E_INTERRUPTED. */
mt_status mt_families_init(mt_problem *p, mt_err *err);
void mt_families_free(mt_problem *p);
/* Fails: as mt_analysis_new_driven. */
mt_status mt_cut_init(const mt_problem *p, int drive_positions, double position, mt_cut *out,
                      mt_err *err);
/* Accepts a zeroed one. */
void mt_cut_free(mt_cut *cut);
/* Whether a family keeps clear of bands in several positions. */
bool mt_drive_positions_any(const mt_problem *p);
/* Two requirements are one limit, of one goal or of goals that ask the same elsewhere. */
bool mt_drive_positions_same_limit(const mt_requirement *a, const mt_requirement *b);
/* The requirement limits a number (a frequency, a damping ratio, a MAC, a forced vibration) in
 * several positions of its family, and is the first of its goal there, and of those that ask
 * the same. */
bool mt_drive_positions_limits_first(const mt_problem *p, const mt_requirement *d);
/* Position of a view at its last solve [rad, m]. */
double mt_drive_positions_position(const mt_analysis *a);
/* Family that a view belongs to; -1. */
int mt_drive_positions_of(const mt_problem *p, int view);
/* Whether tied bands have the same number of modes below them. */
bool mt_ties_agree(const mt_problem *p, const int *below);
/* below made so that they do: the least (most: the greatest) number of each set of tied
 * bands. */
void mt_ties_settle(const mt_problem *p, bool most, int *below);
/*
 * The best that the bands tied to band `tie` can have: *below the number of modes below all of
 * them that leaves the most room, the room ln(edge / f), ln(f / edge) of the mode that comes
 * nearest to an edge with its margin, or is beyond it most (negative). Of a band that is tied
 * to no other this is the room of its own modes. NaN: unstable. After the views have been
 * solved.
 */
double mt_tie_margin(const mt_workspace *w, int tie, int *below);
/* The least of all ties; below[n_bands] (may be NULL) as above. */
double mt_ties_margin(const mt_workspace *w, int *below);

/* How far the bands are from an assignment: -room (ln) of the worst, 0 where all have theirs.
 * NaN: unstable. */
double mt_ties_violation(const mt_workspace *w, const int *below);

/* A band that is forbidden between two neighbouring positions. */
typedef struct mt_band_along_path {
    int tie;
    mt_band band; /* its label: that of the left position */
    double tolerance;
} mt_band_along_path;
typedef struct mt_band_along_paths {
    int n;
    mt_band_along_path *items; /* ascending */
} mt_band_along_paths;
/* What is forbidden at positions from left to right (a < b: no position of the family between
 * them), in mem. at[f->n]: positions of its views. */
mt_status mt_drive_positions_bands(const mt_problem *p, const mt_drive_positions *f,
                                   const double *at, double left, double right, mt_arena *mem,
                                   mt_band_along_paths *out, mt_err *err);

#endif
