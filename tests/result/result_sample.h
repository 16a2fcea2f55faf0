/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_RESULT_SAMPLE_H
#define IO_RESULT_SAMPLE_H

/* A result with a value in every member. */
#include <math.h>

#include "mt_test.h"
#include "result/result.h"
#include "result/result_curves_sample.h"

static mt_result_parameter PARAMETERS[] = {
    {.name = "K_T1",
     .unit = "N m/rad",
     .original = 1e4,
     .recommended = 10147.0 + 1.0 / 3.0,
     .change_percent = 1.4733333333333334,
     .at_bound = NULL,
     .measure = "logarithmic with floor",
     .measure_floor = 20.0},
    {.name = "M_SAU",
     .unit = NULL,
     .original = 0.0,
     .recommended = 0.2,
     .at_bound = "lower",
     .lower = 0.2,
     .upper = 0.5,
     .measure = "linear",
     .measure_scale = 10.0},
};
static double SENSITIVITY[] = {1.25e-3, -2.0};
static mt_result_goal GOALS[] = {{.text = "installed mode 1 at 18 Hz",
                                  .quantity = "installed mode 1",
                                  .pointer = "/goals/0",
                                  .value = 18.0,
                                  .type = "frequency",
                                  .configuration = "installed",
                                  .mode = 1,
                                  .unit = "Hz",
                                  .target = 18.0,
                                  .tolerance_percent = 1e-4,
                                  .met = true,
                                  .off_most_hz = 17.25,
                                  .off_most_ratio = 1.125,
                                  .off_most_phase_deg = -3.5,
                                  .worst = 17.5,
                                  .sensitivity = SENSITIVITY}};
static mt_reason REASONS[] = {{"change", "K_T1", "K_T1 rises by 1.5 %."},
                              {"rank", NULL, "It is the only one."}};
static const char *WARNINGS[] = {"It is hot."};
static const char *VARIABLES[] = {"K_T1", "M_SAU"};
static double DIRECTION[] = {0.0, 1.0};
static const char *INCOMPLETE[] = {"trade"};
static const char SHA256[] = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
static mt_result_digest INPUTS[] = {{"study.json", SHA256}};
static mt_result_override OVERRIDES[] = {{"parameter", "l", "m", "mm", 1e-3, 0.5, 0.25}};
static mt_result_step HISTORY[] = {{1, 1, 3, 0.5, 12.5, false}, {2, 1, 1000, 0.25, 0.0, true}};
static mt_result_digest OUTPUTS[] = {{"report.html", SHA256}};
static mt_warning DOUBTS[] = {{.kind = "margin",
                               .text = "a margin of 0.1 %",
                               .level = MT_LEVEL_WARNING,
                               .file = "study_1.json",
                               .line = 12,
                               .column = 3}};
static mt_warning FACTS[] = {
    {.kind = "free_motion", .text = "2 free motions", .configuration = "installed"}};
static mt_result_assumption ASSUMPTIONS[] = {{"l", "m", "mm", 1e-3, 0.25, NULL, true}};
static double DESIGN[] = {1e4, 0.25};
static mt_relaxation RELAXATIONS[] = {{.kind = "bound",
                                       .pointer = "/variables/0",
                                       .what = "upper bound of K_T1",
                                       .unit = "N m/rad",
                                       .from = 1e4,
                                       .to = 2e4,
                                       .change_percent = 100.0,
                                       .design = DESIGN,
                                       .text = "raise it"}};
static mt_design_objective REACHED[] = {{"change", "", 0.0, 0.1 + 0.2},
                                        {"k1 + k2", NULL, 7.5, -1.25}};
static mt_result_objective OBJECTIVES[] = {{"change", "change", ""},
                                           {"expression", "a + b", NULL}};
static const char *CONFIGURATIONS[] = {"installed"};
static mt_result_order ORDERS[] = {{"4P", 4.0}};
static double MAC[] = {0.25, 1.0};
static double REFERENCE_MODES[] = {1.0, 3.0};
static mt_result_mac_row MAC_ROWS[] = {{2, MT_COUNT(MAC), MAC}};
static mt_result_mac MACS[] = {{"installed", "measured", MT_COUNT(REFERENCE_MODES),
                                REFERENCE_MODES, MT_COUNT(MAC_ROWS), MAC_ROWS}};
static mt_result_excitation EXCITATIONS[] = {{"/goals/1", "UH-60", 4.0, 4.5, 10.0, 60.0,
                                              MT_COUNT(CONFIGURATIONS), CONFIGURATIONS,
                                              MT_COUNT(ORDERS), ORDERS}};

typedef struct sample {
    mt_result *result;
    mt_result_frequency frequency;
    mt_recommendation recommendation;
    mt_unchecked unchecked;
    mt_unidentifiable_direction unidentifiable;
    mt_result_weight_sensitivity weight_sensitivity;
    mt_certificate certificate;
    mt_tolerance_box box;
    mt_trade_point point;
    mt_trade_result trade;
    mt_result_published published[2];
} sample;

static void fill_design(sample *s, mt_recommendation *r)
{
    PARAMETERS[1].change_percent = nan("");
    *r = mt_recommendation_default();
    r->feasible = true;
    r->grade = "feasible";
    r->score = 0.1 + 0.2;
    r->n_objectives = MT_COUNT(REACHED);
    r->objectives = REACHED;
    r->change = 0.25;
    r->violation_percent = 0.0;
    r->n_parameters = MT_COUNT(PARAMETERS);
    r->parameters = PARAMETERS;
    r->n_frequencies = 1;
    r->frequencies = &s->frequency;
    r->n_macs = MT_COUNT(MACS);
    r->macs = MACS;
    r->n_goals = MT_COUNT(GOALS);
    r->goals = GOALS;
    EXTREMES[0].magnitude = nan("");
    r->n_curves = MT_COUNT(DESIGN_CURVES);
    r->curves = DESIGN_CURVES;
    r->n_reasons = MT_COUNT(REASONS);
    r->reasons = REASONS;
}

static mt_result_clearance CLEARANCES[] = {
    {.configuration = "installed",
     .band = "4P of UH-60",
     .band_id = 1,
     .mode = 1,
     .hz = 14.0,
     .percent = 12.5,
     .side = "below"},
    {.configuration = "installed",
     .band = "4P of UH-60",
     .band_id = 1,
     .mode = 2,
     .hz = 25.0,
     .percent = 30.0,
     .side = "above"},
};
static mt_result_mode_placement GAPS[] = {
    {.id = 1, .configuration = "installed", .band = "4P of UH-60", .modes_below = 1},
};
static mt_result_motion MOTIONS[] = {
    {.pointer = "/goals/0",
     .drive = "pivot",
     .unit = "rad",
     .from = -0.25,
     .to = 0.5,
     .positions = 40,
     .least_clearance_percent = 10.5,
     .margin_percent = 10.0,
     .at = 0.125,
     .hz = 14.5,
     .mode = 1,
     .band = "4P of UH-60",
     .band_id = 1,
     .grade = "sampled",
     .text = "mode 1 comes nearest"},
};
static mt_result_between BETWEEN[] = {
    {.pointer = "/goals/2",
     .drive = "pivot",
     .unit = "rad",
     .from = -0.25,
     .to = 0.5,
     .positions = 31,
     .at = 0.0625,
     .value = 4.5,
     .value_unit = "m/s^2",
     .error = 1e-9,
     .frequency_hz = 14.25,
     .end = "finite",
     .violation_percent = 12.5,
     .grade = "sampled",
     .text = "the acceleration of grip.x is largest between the positions"},
};
static mt_result_response RESPONSES[] = {
    {.pointer = "/goals/2",
     .configuration = "installed",
     .input = "base.z",
     .output = "grip.x:acceleration",
     .profile = "helicopter_uh60_panel",
     .quantity = "rms",
     .unit = "m/s^2",
     .value = 3.25,
     .error = 1e-9,
     .frequency_hz = 17.25,
     .at_edge = true,
     .lower_hz = 5.0,
     .upper_hz = 500.0,
     .end = "finite",
     .grade = "proven",
     .text = "the acceleration of grip.x is 3.25 m/s^2 rms"},
};
static mt_result_tolerance TOLERANCES[] = {
    {"K_T1", 4.5, "mode 1 at 4P of UH-60"},
    {"M_SAU", HUGE_VAL, NULL},
};
static double TRADE_VALUES[] = {10.0, 0.25};
static mt_trade_vary VARY[] = {
    {"upper bound of l", "/trade/vary/0", "m", "in", 0.0254},
    {"margin_percent", "/trade/vary/1", NULL, NULL, 0.0},
};
static const char *FRONT[] = {"change", "clearance"};

/* What a study with bands and a trade section adds. */
static void fill_bands(sample *s)
{
    s->box = mt_tolerance_box_default();
    s->box.all_percent = 2.5;
    s->box.edge = "mode 1 at 4P of UH-60";
    s->box.proven = true;
    s->box.n_variables = MT_COUNT(TOLERANCES);
    s->box.variables = TOLERANCES;
    mt_recommendation *const r = &s->recommendation;
    r->clearance_percent = 12.5;
    r->n_clearances = MT_COUNT(CLEARANCES);
    r->clearances = CLEARANCES;
    r->n_placements = MT_COUNT(GAPS);
    r->placements = GAPS;
    r->n_motions = MT_COUNT(MOTIONS);
    r->motions = MOTIONS;
    r->n_responses = MT_COUNT(RESPONSES);
    r->responses = RESPONSES;
    r->n_between = MT_COUNT(BETWEEN);
    r->between = BETWEEN;
    r->tolerance_box = &s->box;
    s->point = (mt_trade_point){.n_values = MT_COUNT(TRADE_VALUES),
                                .values = TRADE_VALUES,
                                .status = MT_RESULT_SOLVED,
                                .status_text = "Solved.",
                                .best = *r,
                                .pareto = true};
    s->trade = (mt_trade_result){
        MT_COUNT(VARY), VARY, MT_COUNT(FRONT), FRONT, 1, &s->point,
    };
    s->result->trade = &s->trade;
}

static void fill_run(mt_result *r)
{
    r->n_objectives = MT_COUNT(OBJECTIVES);
    r->objectives = OBJECTIVES;
    r->run = (mt_result_run){.modetune_version = "1.0.0",
                             .build = {"0123456789ab", "GNU 12.2.0"},
                             .blas = "OpenBLAS 0.3.21",
                             .nlopt_version = "2.7.1",
                             .gsl_version = "2.7.1",
                             .seed = 1,
                             .evaluations = 1234,
                             .spent = {1000, 100, 14, 20, 30, 70, 123456789},
                             .starts = 16,
                             .distinct_designs = 9,
                             .singletons = 3,
                             .estimated_unseen = 1.5,
                             .n_history = MT_COUNT(HISTORY),
                             .history = HISTORY,
                             .n_overrides = MT_COUNT(OVERRIDES),
                             .overrides = OVERRIDES,
                             .n_inputs = MT_COUNT(INPUTS),
                             .inputs = INPUTS,
                             .n_outputs = MT_COUNT(OUTPUTS),
                             .outputs = OUTPUTS,
                             .n_incomplete = MT_COUNT(INCOMPLETE),
                             .incomplete = INCOMPLETE,
                             .cut_by = "time limit"};
}

static inline void fill_published(sample *s)
{
    s->published[0] = mt_result_published_default();
    s->published[0].label = "M_SAU";
    s->published[0].pointer = "/published/0";
    s->published[0].role = "verifies";
    s->published[0].kind = "parameter";
    s->published[0].published = 0.2;
    s->published[0].computed = 0.2;
    s->published[0].requirement = "within 1 %";
    s->published[0].holds = true;
    s->published[1] = s->published[0];
    s->published[1].kind = "status";
    s->published[1].published_text = "solved";
    s->published[1].computed_text = "compromise";
    s->published[1].holds = false;
}

static inline bool make_sample(sample *s)
{
    if (mt_result_new(&s->result, NULL) != MT_OK) {
        return false;
    }
    mt_result *const r = s->result;
    s->frequency = mt_result_frequency_default();
    s->frequency.configuration = "installed";
    s->frequency.mode = 1;
    s->frequency.original_hz = 17.5;
    s->frequency.recommended_hz = 18.0;
    s->frequency.target_hz = 18.0;
    s->frequency.error_percent = 0.0;
    s->frequency.sensitivity = SENSITIVITY;
    fill_design(s, &r->baseline);
    fill_design(s, &s->recommendation);
    s->recommendation.rank = 1;
    s->unchecked = (mt_unchecked){DIRECTION, "M_SAU = 0.5 kg"};
    s->unidentifiable = (mt_unidentifiable_direction){DIRECTION, "M_SAU", 1e-5};
    s->weight_sensitivity = (mt_result_weight_sensitivity){.parameter = "M_SAU",
                                                           .unit = "kg",
                                                           .display_unit = NULL,
                                                           .display_factor = nan(""),
                                                           .value = 0.4,
                                                           .low = 0.3,
                                                           .high = 0.4,
                                                           .low_percent = -25.0,
                                                           .high_percent = nan(""),
                                                           .low_goal = "/goals/0",
                                                           .low_factor = 0.25,
                                                           .high_factor = nan("")};
    s->certificate = mt_certificate_default();
    s->certificate.kind = "range";
    s->certificate.text = "Mode 1 stays below 20 Hz.";
    s->certificate.proven = true;
    s->certificate.pointer = "/goals/0";
    s->certificate.reachable_upper_hz = 19.5;
    fill_bands(s);
    fill_published(s);
    r->study = (mt_result_study){"Study \"1\"", "study_1.json", "A. Engineer", "B", NULL};
    r->model = (mt_result_source){"Inceptor", "../problems/inceptor.json"};
    r->n_doubts = MT_COUNT(DOUBTS);
    r->doubts = DOUBTS;
    r->n_facts = MT_COUNT(FACTS);
    r->facts = FACTS;
    r->n_assumptions = MT_COUNT(ASSUMPTIONS);
    r->assumptions = ASSUMPTIONS;
    r->n_relaxations = MT_COUNT(RELAXATIONS);
    r->relaxations = RELAXATIONS;
    r->n_excitations = MT_COUNT(EXCITATIONS);
    r->excitations = EXCITATIONS;
    r->n_curves = MT_COUNT(CURVES);
    r->curves = CURVES;
    r->status = MT_RESULT_COMPROMISE;
    r->status_text = "No design meets every goal.";
    r->n_variables = MT_COUNT(VARIABLES);
    r->variables = VARIABLES;
    r->n_recommendations = 1;
    r->recommendations = &s->recommendation;
    r->n_unchecked = 1;
    r->unchecked = &s->unchecked;
    r->n_unidentifiable = 1;
    r->unidentifiable = &s->unidentifiable;
    r->n_weight_sensitivity = 1;
    r->weight_sensitivity = &s->weight_sensitivity;
    r->n_certificates = 1;
    r->certificates = &s->certificate;
    r->n_published = 2;
    r->published = s->published;
    r->n_warnings = 1;
    r->warnings = WARNINGS;
    fill_run(r);
    return true;
}

#endif
