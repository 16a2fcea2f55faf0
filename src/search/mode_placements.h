/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SEARCH_MODE_PLACEMENTS_H
#define SEARCH_MODE_PLACEMENTS_H

#include "problem/workspace.h"
#include "result/result.h"
#include "search/proof.h"

/*
 * Search over mode placements: each way of keeping the modes outside the bands (which modes lie
 * below which band) is a separate search. Placements met by a short proof or a few samples are
 * searched before long work begins, so that an interrupt finds a design. All candidates come
 * from a proof where possible (branch and bound over the bounds: what it excludes is proven
 * infeasible), else from samples; each is searched once, by the bound formulation from several
 * starts, on workers. Results are ranked by the objective and do not depend on the number of
 * workers.
 */
/* An active limit of a mode at a position between the named ones, where bands apply. */
typedef struct mt_mode_placement_held {
    int drive_positions;
    double position; /* [rad, m] */
    int mode;        /* vibration index */
    bool above;
    const char *band;
    double multiplier; /* of its row */
} mt_mode_placement_held;

typedef struct mt_mode_placement_solution {
    /* its t has problem->n_t entries; the first n are the design */
    const mt_nlp_solution *found;
    const int *below; /* [n_bands] its mode placement */
    const mt_mode_placement_held *held;
    int n_held;
    const double *stages; /* [n_stages] its objectives, during ranking */
    int n_stages;
    int candidate;
} mt_mode_placement_solution;

typedef struct mt_mode_placement_result {
    int n_solutions; /* feasible ones by objective; or else compromises by violation */
    mt_mode_placement_solution *solutions;
    bool compromise;
    /* placements that may have a design; 0: proven that none has, and the solutions are the
     * nearest misses */
    int n_candidates;
    int n_searched; /* of all */
    int n_feasible; /* of these, with a design that meets all goals */
    /* ended: candidates were searched best first until the requested designs were known.
     * Proven: no design of an unsearched one has a first objective below `rest` (HUGE_VAL: none
     * has a design), nor, where `bounded`, below those listed */
    double rest;
    bool ended;
    bool bounded;
    double n_possible; /* number of monotone placements */
    /* a configuration is a driven position: positions between are not searched */
    bool driven;
    /* several are positions of one drive: designs were followed between them (drive_path.h) */
    bool motion;
    bool tolerances;    /* variables have tolerances, which the proof ignores */
    bool proven;        /* every unsearched placement is proven infeasible */
    const char *reason; /* why not proven */
    /* unidentifiable directions at the best solution (mt_nlp_result) */
    int n_unidentifiable;
    double *unidentifiable; /* n x n_unidentifiable */
    double *unidentifiable_effect;
    long boxes; /* of the proof */
    long evals;
    int starts;
    int stage; /* the objective that the solutions' f belongs to */
    mt_steps steps;
    mt_stop stop;
} mt_mode_placement_result;

/* Called before a long proof or many samples with what was found so far, where that meets all
 * goals; `found` is valid during the call. */
typedef struct mt_mode_placement_incumbent {
    mt_status (*tell)(void *context, const mt_mode_placement_result *found, mt_err *err);
    void *context;
} mt_mode_placement_incumbent;
/* Search all placements. workers[n_workers]: set to one subproblem without a placement, and
 * to it again afterwards. incumbent may be NULL. Results in mem. Fails also: as
 * incumbent->tell. */
mt_status mt_mode_placements_solve(mt_workspace *const *workers, int n_workers,
                                   const mt_mode_placement_incumbent *incumbent, mt_arena *mem,
                                   mt_mode_placement_result *out, mt_err *err);
/* Where the objective is the least clearance: designs met by a search, and those it ended at,
 * count a negative clearance as a violation. */
void mt_mode_placement_refuse_step(const mt_subproblem *c, mt_step *s);

/* A search with fewer than MT_GAP_SEARCH_LEAST is not begun. */
enum { MT_GAP_SEARCH_LEAST = 10 };
/* Maximum number of evaluations for verifying one design, with its objectives. */
long mt_mode_placement_verdict(const mt_subproblem *c);

enum { MT_GAP_SAMPLES_NEAR = 512 };
/* Placements to search, n rows of n_bands. */
typedef struct mt_mode_placement_candidates {
    int n;
    int *below;
    double *at; /* n rows of p->n: a start t for each, NaN: none; NULL: none at all */
    /* [n] lower bound of the first objective of its designs (mode_placements_bounds.h); NULL:
     * not known */
    double *least;
    /* [n] estimate of the first objective of its best design (mode_placements_bounds.h);
     * NULL: not known */
    double *estimate;
    int n_proven; /* number of leading rows with a known design */
    double possible;
    /* every unlisted placement is proven infeasible */
    bool proven;
    /* the same, but listed ones may be infeasible too */
    bool all;
    const char *reason;
    long boxes;
    double undecided; /* share of the volume within the bounds that the proof left open */
    long evals;
} mt_mode_placement_candidates;
/* Number of monotone placements of m bands among n modes, C(n + m, m), over all configurations;
 * positions of one drive share one. */
double mt_mode_placement_count_possible(const mt_problem *p);
/* Placement below[n_bands] of the design t[n], and its largest violation; NaN where it cannot
 * be evaluated. Fails: MT_E_MEMORY, MT_E_INTERNAL. */
mt_status mt_mode_placement_assignment(mt_workspace *w, const double *t, int *below,
                                       double *violation, mt_err *err);
/* The at most `most` placements that samples over the bounds come nearest to. */
mt_status mt_mode_placement_candidates_near(mt_workspace *w, int most, long spent,
                                            mt_arena *mem, mt_mode_placement_candidates *out,
                                            mt_err *err);

#endif
