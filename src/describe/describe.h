/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DESCRIBE_DESCRIBE_H
#define DESCRIBE_DESCRIBE_H

#include "nlp/merit.h"
#include "problem/workspace.h"
#include "result/result.h"

/*
 * From a design to what is reported of it. Every number is recomputed here from scratch, in a
 * workspace made anew and solved at that design alone, and compared with what the search used
 * (a difference beyond rounding becomes a warning); its modes also with those of systems that
 * are built anew at that design (describe_verify.c).
 */

/* What the search knew of a design; zeroed for the original one. */
typedef struct mt_design {
    const double *t;              /* [n] coordinates */
    const mt_nlp_solution *found; /* NULL: the original design */
    int stage;                    /* the objective that found->f belongs to */
    int rank;
    /* the search was interrupted: what it knew of the design is not used, and a better one may
     * be near */
    bool cut;
    bool unsearched; /* the original design, which meets all goals: the least change there is */
    const struct mt_catalogue_search_report *discrete; /* NULL: no catalogue was searched */
    /* NULL: no gap assignments were searched */
    const struct mt_mode_placement_result *placements;
    const int *below;                          /* its assignment; NULL likewise */
    const struct mt_mode_placement_held *held; /* [n_held] between positions of a drive */
    int n_held;
    /* likewise limits, of all designs (search.h) */
    const struct mt_at_position_price *at_position;
} mt_design;

/* Fill rec (lists and texts in result->mem; names are the study's until mt_describe_own).
 * baseline: NULL while the baseline itself is described. A design where goals have no value (an
 * unstable configuration) is described as far as it goes, with a warning. Fails: MT_E_MEMORY,
 * MT_E_INTERNAL, failures of the fresh analyses. */
mt_status mt_describe_design(const mt_problem *p, const mt_design *design,
                             const mt_recommendation *baseline, mt_result *result,
                             mt_recommendation *rec, mt_err *err);
/* Parts of it. describe_goals.c: place and solve everything of fresh at t and judge every
 * goal. *motion_margin: as mt_describe_motions. */
mt_status mt_describe_goals(mt_workspace *fresh, const mt_design *design, mt_result *result,
                            mt_recommendation *rec, double *motion_margin, mt_err *err);
/* describe_bands.c: how many goals the avoid goals are, one per configuration; judge them into
 * rec->goals[rec->n_goals...] once the views of fresh are solved. A goal's value is the
 * clearance that comes nearest to its margin (or falls short of it most), in percent of the
 * band's edge, its requirement that margin. */
int mt_describe_avoid_count(const mt_problem *p);
mt_status mt_describe_avoid_goals(mt_workspace *fresh, mt_result *result,
                                  mt_recommendation *rec, mt_err *err);
/* describe_motion.c: how many families of positions of one drive keep clear of bands; each
 * judged over its motion as one more goal, and as a row of rec->motions. After the views of
 * fresh have been solved. *room: the least between their positions; HUGE_VAL: none. */
int mt_describe_motion_count(const mt_problem *p);
/* "-3.2 deg", a position of a family as people see it. NULL where memory is out. */
const char *mt_describe_position(const mt_study *study, const mt_drive_positions *f, double at,
                                 mt_arena *mem);
mt_status mt_describe_motions(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                              double *room, mt_err *err);
/* Clearance of each mode from its neighbouring bands, modes below each band, the least
 * clearance. Nothing of an unstable configuration. */
mt_status mt_describe_clearances(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                                 mt_err *err);
/* describe_tolerance_box.c, nothing without tolerances: what modes and expressions do over the
 * tolerances of fresh's design, once its views are solved. */
mt_status mt_describe_ranges(mt_workspace *fresh, mt_err *err);
/* Judge a requirement by its worst value, which goes into g; *violation (relative) and *percent
 * (of what is asked), of the design itself before, become those of the worst. */
mt_status mt_describe_worst(mt_workspace *fresh, const mt_requirement *d, mt_result *result,
                            mt_result_goal *g, double *violation, double *percent, mt_err *err);
/* How near a mode that is at hz comes to a band, or how deep inside it; *at: [n] where. NaN and
 * NULL without tolerances. */
double mt_describe_worst_hz(const mt_workspace *fresh, int view, int mode, const mt_band *band,
                            double hz, const double **at);
/* "ambiguous between modes 2 and 3", "lost: ..."; "" where the named mode is told. NULL:
 * memory. */
const char *mt_describe_identity(const mt_configuration_work *view, int named, mt_arena *mem);
/* True where it is certain enough which mode the requirement means. A frequency that all
 * candidates have is. */
bool mt_describe_is_told(const mt_configuration_work *view, const mt_requirement *d);
/* describe_responses.c: likewise. */
mt_status mt_describe_responses(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                                mt_err *err);
/* Words of them: "the acceleration of grip.x for base.z"; ", 45 % below its limit"; " rms".
 * NULL: memory. */
const char *mt_describe_response_limit(const mt_response_limit *s, mt_arena *mem);
const char *mt_describe_response_value(const mt_goal *g, double value, mt_arena *mem);
const char *mt_describe_response_kind(const mt_response_limit *s);
/* What the number q of a requirement misses its goal by, as a part of what is asked for;
 * violation: as its kind measures it. */
double mt_describe_off_by(const mt_requirement *d, double q, double violation);
/* describe_between.c: goals that limit a number, between the positions of drives. */
mt_status mt_describe_between(mt_workspace *fresh, const mt_design *design, mt_result *result,
                              mt_recommendation *rec, mt_err *err);
/* describe_frequencies.c: after mt_describe_goals, whose views are compared. */
mt_status mt_describe_frequencies(mt_workspace *fresh, const mt_design *design,
                                  const mt_recommendation *baseline, mt_result *result,
                                  mt_recommendation *rec, mt_err *err);
/* describe_mac.c: the first `listed` modes of a, which is the view's at the design, with those
 * of the references that goals compare their shapes with. */
mt_status mt_describe_mac(const mt_problem *p, int view, mt_analysis *a, int listed,
                          mt_result *result, mt_recommendation *rec, mt_err *err);
/*
 * describe_verify.c: how a study's reading of a configuration at one design differs from that
 * of a fresh analysis of it (solved with its own number of rigid-body modes), beyond the error
 * bounds of both: a sentence; "": they agree. NULL: memory.
 */
const char *mt_describe_disagreement(const mt_modes *study, const mt_modes *fresh,
                                     const char *configuration, mt_arena *mem);
/* describe_withdraw.c: true where a fresh analysis disagrees at any design of the result. Then
 * its certificates and tolerance boxes are withdrawn, and such a design is graded "not
 * verified". */
bool mt_describe_is_doubted(const mt_result *result);
mt_status mt_describe_withdraw(mt_result *result, mt_err *err);
/* describe_tolerance.c: inertia counts confirm the bands of a feasible design; its tolerance
 * box, where the modes can be enclosed. After the clearances. */
mt_status mt_describe_tolerance(mt_workspace *fresh, mt_result *result, mt_recommendation *rec,
                                mt_err *err);
/* describe_unidentifiable.c: directions that the goals do not settle. */
mt_status mt_describe_unidentifiable(const mt_problem *p, const mt_nlp_result *found,
                                     mt_result *result, mt_err *err);
/* describe_curves_asked.c: which responses the result shows, before any design; and
 * describe_curves.c: each of them at fresh->x. None at points of a trade study. What has no
 * response says why. Fails: MT_E_MEMORY, MT_E_INTERRUPTED. */
mt_status mt_describe_asked_curves(const mt_problem *p, mt_result *result, mt_err *err);
mt_status mt_describe_curves(const mt_workspace *fresh, mt_result *result,
                             mt_recommendation *rec, mt_err *err);
/* describe_history.c: the designs that the search met on the way to found->solutions[0], whose
 * f belongs to `stage`; once. Fails: MT_E_MEMORY. */
mt_status mt_describe_history(const mt_problem *p, const mt_nlp_result *found, int stage,
                              mt_result *result, mt_err *err);
/* Slopes of the values of goals at the design, the last that is asked of `fresh`; NULL where
 * there are none (describe_slopes.c). Fails: MT_E_MEMORY, MT_E_INTERRUPTED. */
mt_status mt_describe_slopes(mt_workspace *fresh, const mt_design *design, mt_result *result,
                             mt_recommendation *rec, mt_err *err);
/* What is wrong with the original design, in sentences. */
mt_status mt_describe_baseline_reasons(const mt_problem *p, mt_result *result, mt_err *err);
/* Sentences why a recommendation is what it is; after mt_describe_unidentifiable
 * (describe_reasons.c). */
mt_status mt_describe_reasons(const mt_problem *p, const mt_design *design,
                              const mt_nlp_result *search, mt_result *result,
                              mt_recommendation *rec, mt_err *err);
/* Judge the published list: x_recommended NULL where there is none (then the original design
 * stands in). Fails with the entry's address in the text (describe_published.c). */
mt_status mt_describe_published(mt_workspace *w, const double *x_original,
                                const double *x_recommended, mt_result *result, mt_err *err);
/* Versions, seed, inputs, names of the variables (describe_run.c). */
mt_status mt_describe_run(const mt_study *study, mt_result *result, mt_err *err);
/* Rotors and machines of the avoid goals (describe_excitations.c). */
mt_status mt_describe_excitations(const mt_study *study, mt_result *result, mt_err *err);
/* Copy every text that study and problem lent into the result, which may outlive them
 * (describe_run.c). */
mt_status mt_describe_own(const mt_study *study, mt_result *result, mt_err *err);
/* Add a warning (formatted) to the result, once. */
mt_status mt_describe_warn(mt_result *result, mt_err *err, const char *fmt, ...)
    MT_PRINTF(3, 4);

/* True where the design is stationary for its objective, as far as that was asked. A residual
 * above this is told. */
bool mt_describe_is_optimum(const mt_recommendation *rec);
/* True where the design keeps its limits at all samples between the positions of drives. */
bool mt_describe_keeps_between(const mt_recommendation *rec);

#endif
