/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_DRIVE_POSITIONS_H
#define PROBLEM_DRIVE_POSITIONS_H

#include "problem/workspace.h"

/*
 * Configurations that are one mechanism in several positions of one driven joint, all others
 * that they drive in the same position (mechanics/geometry.h: mt_system_same_drive).
 * Frequencies are continuous along the drive, so where two positions have different numbers of
 * modes below a band, a mode crosses it between them. Bands of two positions that share
 * frequencies are therefore tied: a design must have the same number of modes below both.
 * Between two named positions a frequency is forbidden where some position on each side forbids
 * it.
 */
struct mt_drive_positions {
    int n; /* configurations, at least two */
    int *view;
    const char *joint;
    const char *spring; /* holds the joint by re-adjusting; NULL: the joint is locked */
    bool angle;         /* positions in rad; else in m */
    bool fixed;         /* the positions do not depend on the design */
    int configuration;  /* a configuration with the drive */
    bool banded;        /* bands apply in at least two positions */
    bool limited;       /* a goal limits a value in at least two positions */
    /* where banded or limited: the mechanism with the position as last input after the
     * variables; its original is owned by the problem, NULL where it could not be made: see
     * `why` */
    mt_configuration_problem moving;
    double *moving_at; /* [n + 1] inputs of its original */
    const char *why;
};

/* A further position of a drive at which its bands, or one limit of a value, must hold: a
 * cutting plane of a search. Its analysis lends its system to all subproblems and workers that
 * use the cut, and outlives them. */
typedef struct mt_cut {
    int drive_positions;
    int requirement; /* the limit that must hold there (below); -1: bands */
    double position;
    mt_analysis *original; /* owned */
} mt_cut;

/* Finds the drives with several positions, and p->tie, after configurations and avoidance
 * goals. Fails: MT_E_MEMORY, MT_E_INTERRUPTED. */
mt_status mt_families_init(mt_problem *p, mt_err *err);
void mt_families_free(mt_problem *p);
/* Analyses the drive at `position`. Fails: as mt_analysis_new_driven. */
mt_status mt_cut_init(const mt_problem *p, int drive_positions, double position, mt_cut *out,
                      mt_err *err);
/* Accepts a zeroed cut. */
void mt_cut_free(mt_cut *cut);
/* True where bands apply in several positions of a drive. */
bool mt_drive_positions_any(const mt_problem *p);
/* True where both requirements are the same limit: of one goal, or of equal goals of other
 * configurations. */
bool mt_drive_positions_same_limit(const mt_requirement *a, const mt_requirement *b);
/* True where d limits a value (a frequency, a damping ratio, a MAC, a forced vibration) in
 * several positions of its drive, and is the first among equal limits there. */
bool mt_drive_positions_limits_first(const mt_problem *p, const mt_requirement *d);
/* True where a goal names two postures of several joints, *a and *b, between which no drive is
 * followed: more than one joint moves, or another one than between positions named before. */
bool mt_drive_positions_unfollowed(const mt_problem *p, int *a, int *b);
/* Position of the drive at the last solve [rad, m]. */
double mt_drive_positions_position(const mt_drive_positions *f, const mt_analysis *a);
/* Index of the drive that a configuration belongs to; -1: none. */
int mt_drive_positions_of(const mt_problem *p, int view);
/* True where tied bands have the same number of modes below them. */
bool mt_ties_agree(const mt_problem *p, const int *below);
/* Sets below[] to agree over ties: the least (most: the greatest) number of each set of tied
 * bands. */
void mt_ties_settle(const mt_problem *p, bool most, int *below);
/*
 * Best common margin of the bands tied to band `tie`: the largest, over numbers k of modes
 * below all of them (*below), of the least log margin ln(edge / f) or ln(f / edge) of a mode to
 * an edge with its margin; negative: a mode is inside. For an untied band this is the margin of
 * its own modes. NaN: unstable. After the configurations have been solved.
 */
double mt_tie_margin(const mt_workspace *w, int tie, int *below);
/* The least over all ties; below[n_bands] (may be NULL) as mt_tie_margin. */
double mt_ties_margin(const mt_workspace *w, int *below);

/* Violation of a mode placement: -margin (ln) of the worst band, 0 where all hold. NaN:
 * unstable. */
double mt_ties_violation(const mt_workspace *w, const int *below);

/* A band that applies between two neighbouring positions. */
typedef struct mt_band_along_path {
    int tie;
    mt_band band; /* label as at the left position */
    double tolerance;
} mt_band_along_path;
typedef struct mt_band_along_paths {
    int n;
    mt_band_along_path *items; /* ascending */
} mt_band_along_paths;
/* Bands that apply between the neighbouring positions left < right of the drive, in mem.
 * at[f->n]: positions of its configurations. */
mt_status mt_drive_positions_bands(const mt_problem *p, const mt_drive_positions *f,
                                   const double *at, double left, double right, mt_arena *mem,
                                   mt_band_along_paths *out, mt_err *err);

#endif
