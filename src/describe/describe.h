/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DESCRIBE_DESCRIBE_H
#define DESCRIBE_DESCRIBE_H

#include "nlp/merit.h"
#include "problem/workspace.h"
#include "result/result.h"

/*
 * The description of a design in the result. Every number is recomputed from scratch, in a new
 * workspace solved at that design only, and compared with the search's (a difference beyond
 * rounding becomes a warning); modes are also compared with those of systems built again at
 * that design (describe_run.c).
 */

/* The search's knowledge of a design; zeroed for the original one. */
typedef struct mt_design {
    const double *t;              /* [n] coordinates */
    const mt_nlp_solution *found; /* NULL: the original design */
    int stage;                    /* index of the objective of found->f */
    int rank;
    /* the search was interrupted: its knowledge of the design is not used, and a better design
     * may be near */
    bool cut;
    bool unsearched; /* the original design, which meets all goals: the least possible change */
    const struct mt_catalogue_search_report *discrete; /* NULL: no catalogue was searched */
    /* NULL: no mode placements were searched */
    const struct mt_mode_placement_result *placements;
    const int *below; /* its placement; NULL: no mode placements were searched */
    /* [n_held] modes at an edge of a band between named positions of a drive (active rows) */
    const struct mt_mode_placement_held *held;
    int n_held;
    /* active limits at such positions, of all designs (search.h) */
    const struct mt_at_position_price *at_position;
} mt_design;

/* Fill rec (lists and texts in result->mem; names are the study's until mt_describe_own).
 * baseline: NULL while the baseline itself is described. Where goals have no value (an unstable
 * configuration) the rest is described, with a warning. Fails: MT_E_MEMORY, MT_E_INTERNAL,
 * failures of the fresh analyses. */
mt_status mt_describe_design(const mt_problem *p, const mt_design *design,
                             const mt_recommendation *baseline, mt_result *result,
                             mt_recommendation *rec, mt_err *err);
/* Parts of mt_describe_design. describe_goals.c: place and solve everything of `fresh` at t and
 * judge every goal. *motion_margin: the least margin between the positions of drives; HUGE_VAL:
 * none. */
mt_status mt_describe_goals(mt_workspace *fresh, const mt_design *design, mt_result *result,
                            mt_recommendation *rec, double *motion_margin, mt_err *err);
/* describe_bands.c: the number of goals that avoid bands, counted per configuration; judge them
 * into rec->goals[rec->n_goals...] after the configurations of `fresh` are solved. A goal's
 * value is the clearance that exceeds its margin least (or falls short of it most), in percent
 * of the band's edge; its requirement is that margin. */
int mt_describe_avoid_count(const mt_problem *p);
mt_status mt_describe_avoid_goals(mt_workspace *fresh, mt_result *result,
                                  mt_recommendation *rec, mt_err *err);
/* "-3.2 deg", a position of a family in its displayed unit. NULL where memory is out. */
const char *mt_describe_position(const mt_study *study, const mt_drive_positions *f, double at,
                                 mt_arena *mem);
/* Clearance of each mode from its neighbouring bands, modes below each band, the least
 * clearance. Nothing for an unstable configuration. */
mt_status mt_describe_clearances(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                                 mt_err *err);
/* "ambiguous between modes 2 and 3", "lost: ..."; "" where the named mode is identified. NULL:
 * memory. */
const char *mt_describe_identity(const mt_configuration_work *view, int named, mt_arena *mem);
/* describe_curves.c: judge the goals of forced vibration. */
mt_status mt_describe_responses(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                                mt_err *err);
/* Phrases for these goals: "the acceleration of grip.x for base.z"; ", 45 % below its limit";
 * "rms" with a blank before. NULL: memory. */
const char *mt_describe_response_limit(const mt_response_limit *s, mt_arena *mem);
const char *mt_describe_response_value(const mt_goal *g, double value, mt_arena *mem);
const char *mt_describe_response_kind(const mt_response_limit *s);
/* describe_goals.c: goals that limit a number, between the named positions of drives. */
mt_status mt_describe_between(mt_workspace *fresh, const mt_design *design, mt_result *result,
                              mt_recommendation *rec, mt_err *err);
/* describe_frequencies.c: compare modes; after mt_describe_goals, which solves the
 * configurations. */
mt_status mt_describe_frequencies(mt_workspace *fresh, const mt_design *design,
                                  const mt_recommendation *baseline, mt_result *result,
                                  mt_recommendation *rec, mt_err *err);
/*
 * describe_verify.c: the difference of the study's modes of a configuration at one design from
 * those of a fresh analysis (with its own number of rigid-body modes), beyond the error bounds
 * of both, as a sentence; "": they agree. NULL: memory.
 */
const char *mt_describe_disagreement(const mt_modes *study, const mt_modes *fresh,
                                     const char *configuration, mt_arena *mem);
/* describe_run.c: is_doubted is true where a fresh analysis disagrees at any design of the
 * result; withdraw then removes its certificates and tolerance boxes, and grades such a design
 * "not verified". */
bool mt_describe_is_doubted(const mt_result *result);
mt_status mt_describe_withdraw(mt_result *result, mt_err *err);
/* describe_tolerance.c: confirm the bands of a feasible design by inertia counts, and compute
 * its tolerance box where the modes can be enclosed. After the clearances. */
mt_status mt_describe_tolerance(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                                mt_err *err);
/* describe_frequencies.c: directions that the goals do not identify. */
mt_status mt_describe_unidentifiable(const mt_problem *p, const mt_nlp_result *found,
                                     mt_result *result, mt_err *err);
/* describe_curves.c: the list of responses shown, before any design; describe_curves.c:
 * each of them at fresh->x. None at points of a trade study. A missing response has its reason.
 * Fails: MT_E_MEMORY, MT_E_INTERRUPTED. */
mt_status mt_describe_asked_curves(const mt_problem *p, mt_result *result, mt_err *err);
mt_status mt_describe_curves(const mt_workspace *fresh, mt_result *result,
                             mt_recommendation *rec, mt_err *err);
/* describe_run.c: the improving designs of the search up to found->solutions[0], whose f
 * belongs to objective `stage`; call once. Fails: MT_E_MEMORY. */
mt_status mt_describe_history(const mt_problem *p, const mt_nlp_result *found, int stage,
                              mt_result *result, mt_err *err);
/* describe_frequencies.c: derivatives of the values of goals at the design, the last use of
 * `fresh`; NULL where not available. Fails: MT_E_MEMORY, MT_E_INTERRUPTED. */
mt_status mt_describe_slopes(mt_workspace *fresh, const mt_design *design, mt_result *result,
                             mt_recommendation *rec, mt_err *err);
/* Add sentences about the unmet goals of the original design. */
mt_status mt_describe_baseline_reasons(const mt_problem *p, mt_result *result, mt_err *err);
/* Add sentences that explain a recommendation; after mt_describe_unidentifiable
 * (describe_reasons.c). */
mt_status mt_describe_reasons(const mt_problem *p, const mt_design *design,
                              const mt_nlp_result *search, mt_result *result,
                              mt_recommendation *rec, mt_err *err);
/* Compare the published values: x_recommended NULL where there is none (the original design is
 * used). Fails with the entry's address in the text (describe_published.c). */
mt_status mt_describe_published(mt_workspace *w, const double *x_original,
                                const double *x_recommended, mt_result *result, mt_err *err);
/* Fill in versions, seed, inputs, names of the variables (describe_run.c). */
mt_status mt_describe_run(const mt_study *study, mt_result *result, mt_err *err);
/* Fill in rotors and machines of the avoid goals (describe_curves.c). */
mt_status mt_describe_excitations(const mt_study *study, mt_result *result, mt_err *err);
/* Copy every borrowed text of study and problem into the result, which may outlive them
 * (describe_run.c). */
mt_status mt_describe_own(const mt_study *study, mt_result *result, mt_err *err);
/* Add a formatted warning to the result, once. */
mt_status mt_describe_warn(mt_result *result, mt_err *err, const char *fmt, ...)
    MT_PRINTF(3, 4);

/* True where the design is stationary for its objective, within MT_KKT_TOLD, or where that was
 * not computed. */
bool mt_describe_is_optimum(const mt_recommendation *rec);
/* True where the design meets its limits at all samples between the named positions of
 * drives. */
bool mt_describe_keeps_between(const mt_recommendation *rec);

#endif
