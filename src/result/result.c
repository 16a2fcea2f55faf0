/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "result/result.h"

#include "study/goal_kinds.h"
#include "study/objective_kinds.h"

/* What each record holds, in the order of result.json. */

#define STATUS_NAME(id, name) name,
static const char *const STATUSES[] = {MT_RESULT_STATUS_LIST(STATUS_NAME)};
#undef STATUS_NAME

#define THIS mt_result_parameter
static const char *const BOUNDS[] = {"lower", "upper"};
static const char *const MEASURES[] = {"logarithmic", "logarithmic with floor", "linear"};
static const mt_field PARAMETER_FIELDS[] = {
    MT_F_TEXT("name", name),
    MT_F_TEXT_OR_NULL("unit", unit),
    MT_F_TEXT_OR_NULL("display_unit", display_unit),
    MT_F_NUMBER_OR_NULL("display_factor", display_factor),
    MT_F_NUMBER_OR_NULL("original", original),
    MT_F_NUMBER_OR_NULL("recommended", recommended),
    MT_F_NUMBER_OR_NULL("change_percent", change_percent),
    MT_F_CHOICE_OR_NULL("at_bound", at_bound, BOUNDS),
    MT_F_NUMBER_OR_NULL("lower", lower),
    MT_F_NUMBER_OR_NULL("upper", upper),
    MT_F_CHOICE("measure", measure, MEASURES),
    MT_F_NUMBER_OR_NULL("measure_floor", measure_floor),
    MT_F_NUMBER_OR_NULL("measure_scale", measure_scale),
};
static const mt_record PARAMETER = MT_F_RECORD_OF(PARAMETER_FIELDS);
#undef THIS

#define THIS mt_result_frequency
static const char *const IDENTITIES[] = {"tracked", "ambiguous", "lost"};
static const mt_field FREQUENCY_FIELDS[] = {
    MT_F_TEXT("configuration", configuration),
    MT_F_COUNT("mode", mode, 0),
    MT_F_TEXT_OR_NULL("name", name),
    MT_F_CHOICE_OR_NULL("identity", identity, IDENTITIES),
    MT_F_NUMBER_OR_NULL("share", share),
    MT_F_COUNT_OR_NULL("rival_mode", rival_mode, 1),
    MT_F_NUMBER_OR_NULL("rival_share", rival_share),
    MT_F_NUMBER_OR_NULL("original_hz", original_hz),
    MT_F_NUMBER_OR_NULL("recommended_hz", recommended_hz),
    MT_F_NUMBER_OR_NULL("target_hz", target_hz),
    MT_F_NUMBER_OR_NULL("at_least_hz", at_least_hz),
    MT_F_NUMBER_OR_NULL("at_most_hz", at_most_hz),
    MT_F_NUMBER_OR_NULL("error_percent", error_percent),
    MT_F_NUMBER_OR_NULL("lowest_hz", lowest_hz),
    MT_F_NUMBER_OR_NULL("highest_hz", highest_hz),
    MT_F_TEXT_OR_NULL("reference", reference),
    MT_F_NUMBER_OR_NULL("mac", mac),
    MT_F_FLAG("repeated", repeated),
    MT_F_BY_VARIABLE_OR_NULL("sensitivity", sensitivity),
    MT_F_NUMBER_OR_NULL("residual", residual),
    MT_F_NUMBER_OR_NULL("orthogonality", orthogonality),
    MT_F_UNWRITTEN_TEXT(slack),
};
static const mt_record FREQUENCY = MT_F_RECORD_OF(FREQUENCY_FIELDS);
#undef THIS

#define THIS mt_result_clearance
static const char *const SIDES[] = {"below", "inside", "above"};
static const mt_field CLEARANCE_FIELDS[] = {
    MT_F_TEXT("configuration", configuration),
    MT_F_TEXT("band", band),
    MT_F_COUNT("band_id", band_id, 1),
    MT_F_COUNT("mode", mode, 1),
    MT_F_NUMBER_OR_NULL("hz", hz),
    MT_F_NUMBER_OR_NULL("percent", percent),
    MT_F_NUMBER_OR_NULL("margin_percent", margin_percent),
    MT_F_NUMBER_OR_NULL("worst_hz", worst_hz),
    MT_F_NUMBER_OR_NULL("worst_percent", worst_percent),
    MT_F_CHOICE("side", side, SIDES),
};
static const mt_record CLEARANCE = MT_F_RECORD_OF(CLEARANCE_FIELDS);
#undef THIS

#define THIS mt_result_mode_placement
static const mt_field GAP_FIELDS[] = {
    MT_F_COUNT("id", id, 1),
    MT_F_TEXT("configuration", configuration),
    MT_F_TEXT("band", band),
    MT_F_NUMBER_OR_NULL("lower_hz", lower_hz),
    MT_F_NUMBER_OR_NULL("upper_hz", upper_hz),
    MT_F_NUMBER_OR_NULL("margin_lower_hz", margin_lower_hz),
    MT_F_NUMBER_OR_NULL("margin_upper_hz", margin_upper_hz),
    MT_F_COUNT("modes_below", modes_below, 0),
};
static const mt_record GAP = MT_F_RECORD_OF(GAP_FIELDS);
#undef THIS

#define THIS mt_result_motion
static const char *const DRIVE_UNITS[] = {"rad", "m"};
static const char *const MOTION_GRADES[] = {"sampled", "sampled coarsely", "incomplete",
                                            "unstable", "not followed"};
static const mt_field MOTION_FIELDS[] = {
    MT_F_TEXT("goal", pointer),
    MT_F_TEXT("drive", drive),
    MT_F_CHOICE("unit", unit, DRIVE_UNITS),
    MT_F_TEXT_OR_NULL("display_unit", display_unit),
    MT_F_NUMBER_OR_NULL("display_factor", display_factor),
    MT_F_NUMBER_OR_NULL("from", from),
    MT_F_NUMBER_OR_NULL("to", to),
    MT_F_COUNT("positions", positions, 0),
    MT_F_NUMBER_OR_NULL("least_clearance_percent", least_clearance_percent),
    MT_F_NUMBER_OR_NULL("margin_percent", margin_percent),
    MT_F_NUMBER_OR_NULL("at", at),
    MT_F_NUMBER_OR_NULL("hz", hz),
    MT_F_COUNT_OR_NULL("mode", mode, 1),
    MT_F_TEXT_OR_NULL("band", band),
    MT_F_COUNT_OR_NULL("band_id", band_id, 1),
    MT_F_FLAG("crosses", crosses),
    MT_F_CHOICE("grade", grade, MOTION_GRADES),
    MT_F_TEXT("text", text),
};
static const mt_record MOTION = MT_F_RECORD_OF(MOTION_FIELDS);
#undef THIS

#define THIS mt_result_tolerance
static const mt_field TOLERANCE_FIELDS[] = {
    MT_F_TEXT("name", name),
    MT_F_NUMBER_OR_NULL("percent", percent),
    MT_F_TEXT_OR_NULL("edge", edge),
};
static const mt_record TOLERANCE = MT_F_RECORD_OF(TOLERANCE_FIELDS);
#undef THIS

#define THIS mt_tolerance_box
static const mt_field TOLERANCE_BOX_FIELDS[] = {
    MT_F_NUMBER_OR_NULL("all_percent", all_percent),
    MT_F_TEXT_OR_NULL("edge", edge),
    MT_F_FLAG("proven", proven),
    MT_F_LIST("per_variable", variables, n_variables, mt_result_tolerance, TOLERANCE),
};
static const mt_record TOLERANCE_BOX = MT_F_RECORD_OF(TOLERANCE_BOX_FIELDS);
#undef THIS

#define THIS                     mt_result_goal
#define GOAL_NAME(id, name, ...) #name,
static const char *const GOAL_TYPES[] = {MT_GOAL_LIST(GOAL_NAME)};
#undef GOAL_NAME
static const mt_field GOAL_FIELDS[] = {
    MT_F_TEXT("goal", text),
    MT_F_TEXT("quantity", quantity),
    MT_F_TEXT("pointer", pointer),
    MT_F_CHOICE("type", type, GOAL_TYPES),
    MT_F_TEXT_OR_NULL("configuration", configuration),
    MT_F_COUNT_OR_NULL("mode", mode, 1),
    MT_F_TEXT_OR_NULL("name", name),
    MT_F_TEXT_OR_NULL("reference", reference),
    MT_F_TEXT_OR_NULL("expression", expression),
    MT_F_TEXT_OR_NULL("unit", unit),
    MT_F_TEXT_OR_NULL("display_unit", display_unit),
    MT_F_NUMBER_OR_NULL("display_factor", display_factor),
    MT_F_NUMBER_OR_NULL("value", value),
    MT_F_NUMBER_OR_NULL("target", target),
    MT_F_NUMBER_OR_NULL("at_least", at_least),
    MT_F_NUMBER_OR_NULL("at_most", at_most),
    MT_F_NUMBER_OR_NULL("tolerance_percent", tolerance_percent),
    MT_F_NUMBER_OR_NULL("worst", worst),
    MT_F_BY_VARIABLE_OR_NULL("worst_at", worst_at),
    MT_F_BY_VARIABLE_OR_NULL("sensitivity", sensitivity),
    MT_F_NUMBER_OR_NULL("off_most_hz", off_most_hz),
    MT_F_NUMBER_OR_NULL("off_most_ratio", off_most_ratio),
    MT_F_NUMBER_OR_NULL("off_most_phase_deg", off_most_phase_deg),
    MT_F_NUMBER_OR_NULL("violation_percent", violation_percent),
    MT_F_FLAG("met", met),
    MT_F_FLAG("weighted", weighted),
    MT_F_FLAG("doubtful", doubtful),
};
static const mt_record GOAL = MT_F_RECORD_OF(GOAL_FIELDS);
#undef THIS

#define THIS mt_design_objective
static const mt_field REACHED_FIELDS[] = {
    MT_F_TEXT("text", text),
    MT_F_TEXT_OR_NULL("unit", unit),
    MT_F_NUMBER_OR_NULL("original", original),
    MT_F_NUMBER_OR_NULL("recommended", recommended),
};
static const mt_record REACHED = MT_F_RECORD_OF(REACHED_FIELDS);
#undef THIS

#define THIS mt_reason
static const char *const REASON_KINDS[] = {"change", "hold", "cost", "rank"};
static const mt_field REASON_FIELDS[] = {
    MT_F_CHOICE("kind", kind, REASON_KINDS),
    MT_F_TEXT_OR_NULL("about", about),
    MT_F_TEXT("text", text),
};
static const mt_record REASON = MT_F_RECORD_OF(REASON_FIELDS);
#undef THIS

#define THIS mt_result_mac_row
static const mt_field MAC_ROW_FIELDS[] = {
    MT_F_COUNT("mode", mode, 1),
    MT_F_NUMBERS("values", values, n_values),
};
static const mt_record MAC_ROW = MT_F_RECORD_OF(MAC_ROW_FIELDS);
#undef THIS

#define THIS mt_result_mac
static const mt_field MAC_FIELDS[] = {
    MT_F_TEXT("configuration", configuration),
    MT_F_TEXT("reference", reference),
    MT_F_NUMBERS("reference_modes", reference_modes, n_reference_modes),
    MT_F_LIST("rows", rows, n_rows, mt_result_mac_row, MAC_ROW),
};
static const mt_record MAC = MT_F_RECORD_OF(MAC_FIELDS);
#undef THIS

#define THIS mt_recommendation
static const char *const SURETIES[] = {"proven", "sampled"};
static const mt_field DESIGN_FIELDS[] = {
    MT_F_COUNT("rank", rank, 0),
    MT_F_FLAG("feasible", feasible),
    MT_F_TEXT_OR_NULL("grade", grade),
    MT_F_NUMBER_OR_NULL("score", score),
    MT_F_LIST("objectives", objectives, n_objectives, mt_design_objective, REACHED),
    MT_F_NUMBER_OR_NULL("change", change),
    MT_F_NUMBER_OR_NULL("misfit", misfit),
    MT_F_NUMBER_OR_NULL("violation_percent", violation_percent),
    MT_F_NUMBER_OR_NULL("clearance_percent", clearance_percent),
    MT_F_NUMBER_OR_NULL("kkt_residual", kkt_residual),
    MT_F_CHOICE_OR_NULL("worst_case", worst_case, SURETIES),
    MT_F_FLAG("singular", singular),
    MT_F_LIST("parameters", parameters, n_parameters, mt_result_parameter, PARAMETER),
    MT_F_LIST("frequencies", frequencies, n_frequencies, mt_result_frequency, FREQUENCY),
    MT_F_LIST("mac_matrices", macs, n_macs, mt_result_mac, MAC),
    MT_F_LIST("clearances", clearances, n_clearances, mt_result_clearance, CLEARANCE),
    MT_F_LIST_OR_NULL("gap_assignment", placements, n_placements, mt_result_mode_placement,
                      GAP),
    MT_F_LIST("motion", motions, n_motions, mt_result_motion, MOTION),
    MT_F_OPTION("tolerance_box", tolerance_box, mt_tolerance_box, TOLERANCE_BOX),
    MT_F_LIST("goals", goals, n_goals, mt_result_goal, GOAL),
    MT_F_LIST("responses", responses, n_responses, mt_result_response, mt_response_record),
    MT_F_LIST("responses_between", between, n_between, mt_result_between, mt_between_record),
    MT_F_LIST("curves", curves, n_curves, mt_design_curve, mt_design_curve_record),
    MT_F_LIST("reasons", reasons, n_reasons, mt_reason, REASON),
    MT_F_UNWRITTEN_TEXT(disagreement),
};
const mt_record mt_design_record = MT_F_RECORD_OF(DESIGN_FIELDS);
#undef THIS

#define THIS mt_unchecked
static const mt_field UNCHECKED_FIELDS[] = {
    MT_F_TEXT("text", text),
    MT_F_NUMBERS_BY_VARIABLE("values", values),
};
static const mt_record UNCHECKED = MT_F_RECORD_OF(UNCHECKED_FIELDS);
#undef THIS

#define THIS mt_unidentifiable_direction
static const mt_field UNIDENTIFIABLE_FIELDS[] = {
    MT_F_TEXT("direction", text),
    MT_F_NUMBER_OR_NULL("effect_percent", effect_percent),
    MT_F_BY_VARIABLE("components", direction),
};
static const mt_record UNIDENTIFIABLE = MT_F_RECORD_OF(UNIDENTIFIABLE_FIELDS);
#undef THIS

#define THIS mt_result_weight_sensitivity
static const mt_field WEIGHT_SENSITIVITY_FIELDS[] = {
    MT_F_TEXT("parameter", parameter),
    MT_F_TEXT_OR_NULL("unit", unit),
    MT_F_TEXT_OR_NULL("display_unit", display_unit),
    MT_F_NUMBER_OR_NULL("display_factor", display_factor),
    MT_F_NUMBER_OR_NULL("value", value),
    MT_F_NUMBER_OR_NULL("low", low),
    MT_F_NUMBER_OR_NULL("low_percent", low_percent),
    MT_F_TEXT_OR_NULL("low_goal", low_goal),
    MT_F_NUMBER_OR_NULL("low_weight_factor", low_factor),
    MT_F_NUMBER_OR_NULL("high", high),
    MT_F_NUMBER_OR_NULL("high_percent", high_percent),
    MT_F_TEXT_OR_NULL("high_goal", high_goal),
    MT_F_NUMBER_OR_NULL("high_weight_factor", high_factor),
};
static const mt_record WEIGHT_SENSITIVITY = MT_F_RECORD_OF(WEIGHT_SENSITIVITY_FIELDS);
#undef THIS

#define THIS mt_certificate
static const mt_field CERTIFICATE_FIELDS[] = {
    MT_F_TEXT("kind", kind),
    MT_F_TEXT("text", text),
    MT_F_FLAG("proven", proven),
    MT_F_TEXT_OR_NULL("pointer", pointer),
    MT_F_NUMBER_OR_NULL("reachable_lower_hz", reachable_lower_hz),
    MT_F_NUMBER_OR_NULL("reachable_upper_hz", reachable_upper_hz),
};
static const mt_record CERTIFICATE = MT_F_RECORD_OF(CERTIFICATE_FIELDS);
#undef THIS

#define THIS mt_relaxation
static const char *const RELAXATIONS[] = {"bound", "band", "goal"};
static const mt_field RELAXATION_FIELDS[] = {
    MT_F_CHOICE("kind", kind, RELAXATIONS),
    MT_F_TEXT("pointer", pointer),
    MT_F_TEXT("what", what),
    MT_F_TEXT_OR_NULL("unit", unit),
    MT_F_TEXT_OR_NULL("display_unit", display_unit),
    MT_F_NUMBER_OR_NULL("display_factor", display_factor),
    MT_F_NUMBER("from", from),
    MT_F_NUMBER("to", to),
    MT_F_NUMBER_OR_NULL("change_percent", change_percent),
    MT_F_NUMBERS_BY_VARIABLE("design", design),
    MT_F_TEXT("text", text),
};
static const mt_record RELAXATION = MT_F_RECORD_OF(RELAXATION_FIELDS);
#undef THIS

#define THIS mt_trade_vary
static const mt_field VARY_FIELDS[] = {
    MT_F_TEXT("quantity", text),
    MT_F_TEXT("pointer", pointer),
    MT_F_TEXT_OR_NULL("unit", unit),
    MT_F_TEXT_OR_NULL("display_unit", display_unit),
    MT_F_NUMBER_OR_NULL("display_factor", display_factor),
};
static const mt_record VARY = MT_F_RECORD_OF(VARY_FIELDS);
#undef THIS

#define THIS mt_trade_point
static const mt_field POINT_FIELDS[] = {
    MT_F_NUMBERS("values", values, n_values),
    MT_F_ENUM("status", status, mt_result_status, STATUSES),
    MT_F_TEXT_OR_NULL("status_text", status_text),
    MT_F_FLAG("pareto", pareto),
    MT_F_RECORD_FLAT("best", best, mt_recommendation, mt_design_record),
};
static const mt_record POINT = MT_F_RECORD_OF(POINT_FIELDS);
#undef THIS

#define THIS mt_trade_result
static const mt_field TRADE_FIELDS[] = {
    MT_F_LIST("vary", vary, n_vary, mt_trade_vary, VARY),
    MT_F_TEXTS("objectives", objectives, n_objectives),
    MT_F_LIST("points", points, n_points, mt_trade_point, POINT),
};
static const mt_record TRADE = MT_F_RECORD_OF(TRADE_FIELDS);
#undef THIS

#define THIS mt_result_order
static const mt_field ORDER_FIELDS[] = {
    MT_F_TEXT("label", label),
    MT_F_NUMBER("order", order),
};
static const mt_record ORDER = MT_F_RECORD_OF(ORDER_FIELDS);
#undef THIS

#define THIS mt_result_excitation
static const mt_field EXCITATION_FIELDS[] = {
    MT_F_TEXT("name", name),
    MT_F_TEXT("pointer", pointer),
    MT_F_NUMBER("speed_lower_hz", speed_lower_hz),
    MT_F_NUMBER("speed_upper_hz", speed_upper_hz),
    MT_F_NUMBER("margin_percent", margin_percent),
    MT_F_NUMBER_OR_NULL("up_to_hz", up_to_hz),
    MT_F_TEXTS("configurations", configurations, n_configurations),
    MT_F_LIST("orders", orders, n_orders, mt_result_order, ORDER),
};
static const mt_record EXCITATION = MT_F_RECORD_OF(EXCITATION_FIELDS);
#undef THIS

#define THIS mt_result_published
static const char *const PUBLISHED_KINDS[] = {"parameter", "quantity", "frequency", "mac",
                                              "status"};
static const char *const ROLES[] = {"verifies", "calibrates", "not_comparable"};
static const mt_field PUBLISHED_FIELDS[] = {
    MT_F_TEXT_OR_NULL("label", label),
    MT_F_CHOICE("kind", kind, PUBLISHED_KINDS),
    MT_F_TEXT("pointer", pointer),
    MT_F_CHOICE("role", role, ROLES),
    MT_F_VALUE_OR_NULL("published", published, published_text),
    MT_F_VALUE_OR_NULL("computed", computed, computed_text),
    MT_F_NUMBER_OR_NULL("difference", difference),
    MT_F_NUMBER_OR_NULL("difference_percent", difference_percent),
    MT_F_TEXT_OR_NULL("demand", requirement),
    MT_F_TEXT_OR_NULL("display_unit", display_unit),
    MT_F_NUMBER_OR_NULL("display_factor", display_factor),
    MT_F_FLAG("holds", holds),
    MT_F_TEXT_OR_NULL("source", source),
};
static const mt_record PUBLISHED = MT_F_RECORD_OF(PUBLISHED_FIELDS);
#undef THIS

#define THIS mt_warning
static const mt_field WARNING_FIELDS[] = {
    MT_F_TEXT("kind", kind),
    MT_F_TEXT("text", text),
    MT_F_TEXT_OR_NULL("configuration", configuration),
    MT_F_TEXT_OR_NULL("file", file),
    MT_F_COUNT_OR_NULL("line", line, 1),
    MT_F_COUNT_OR_NULL("column", column, 1),
    MT_F_TEXT_OR_NULL("pointer", pointer),
};
const mt_record mt_warning_record = MT_F_RECORD_OF(WARNING_FIELDS);
#undef THIS

#define THIS mt_result_digest
static const mt_field DIGEST_FIELDS[] = {
    MT_F_TEXT("file", file),
    MT_F_TEXT("sha256", sha256),
};
static const mt_record DIGEST = MT_F_RECORD_OF(DIGEST_FIELDS);
#undef THIS

#define THIS mt_result_build
static const mt_field BUILD_FIELDS[] = {
    MT_F_TEXT("commit", commit),
    MT_F_TEXT("compiler", compiler),
};
static const mt_record BUILD = MT_F_RECORD_OF(BUILD_FIELDS);
#undef THIS

#define THIS mt_result_work_counters
static const mt_field WORK_COUNTERS_FIELDS[] = {
    MT_F_LONG("search", search),
    MT_F_LONG("positions", positions),
    MT_F_LONG("descriptions", descriptions),
    MT_F_LONG("spread", weight_sensitivity),
    MT_F_LONG("relaxations", relaxations),
    MT_F_LONG("trade", trade),
    MT_F_LONG("multiplications", multiplications),
};
static const mt_record WORK_COUNTERS = MT_F_RECORD_OF(WORK_COUNTERS_FIELDS);
#undef THIS

#define THIS mt_result_override
static const char *const OVERRIDES[] = {"parameter", "search"};
static const mt_field OVERRIDE_FIELDS[] = {
    MT_F_CHOICE("kind", kind, OVERRIDES),
    MT_F_TEXT("name", name),
    MT_F_TEXT_OR_NULL("unit", unit),
    MT_F_TEXT_OR_NULL("display_unit", display_unit),
    MT_F_NUMBER_OR_NULL("display_factor", display_factor),
    MT_F_NUMBER("value", value),
    MT_F_NUMBER_OR_NULL("original", original),
};
static const mt_record OVERRIDE = MT_F_RECORD_OF(OVERRIDE_FIELDS);
#undef THIS

#define THIS mt_result_step
static const mt_field STEP_FIELDS[] = {
    MT_F_COUNT("objective", objective, 1),       MT_F_COUNT("round", round, 1),
    MT_F_LONG("evaluations", evaluations),       MT_F_NUMBER_OR_NULL("value", value),
    MT_F_NUMBER_OR_NULL("violation", violation), MT_F_FLAG("feasible", feasible),
};
static const mt_record STEP = MT_F_RECORD_OF(STEP_FIELDS);
#undef THIS

#define THIS mt_result_run
static const char *const CAUSES[] = {"interrupt", "time limit"};
static const char *const PHASES[] = {"search",      "recommendations", "spread", "certificates",
                                     "relaxations", "published",       "trade"};
static const mt_field RUN_FIELDS[] = {
    MT_F_TEXT_OR_NULL("modetune", modetune_version),
    MT_F_RECORD("build", build, mt_result_build, BUILD),
    MT_F_TEXT_OR_NULL("blas", blas),
    MT_F_TEXT_OR_NULL("nlopt", nlopt_version),
    MT_F_TEXT_OR_NULL("gsl", gsl_version),
    MT_F_LONG("seed", seed),
    MT_F_COUNT("starts", starts, 0),
    MT_F_COUNT_OR_NULL("distinct_designs", distinct_designs, 0),
    MT_F_COUNT_OR_NULL("found_once", singletons, 0),
    MT_F_NUMBER_OR_NULL("estimated_missing", estimated_unseen),
    MT_F_LIST("history", history, n_history, mt_result_step, STEP),
    MT_F_LONG("evaluations", evaluations),
    MT_F_LONG("modal_solutions", modal_solutions),
    MT_F_RECORD("spent", spent, mt_result_work_counters, WORK_COUNTERS),
    MT_F_CHOICES("incomplete", incomplete, n_incomplete, PHASES),
    MT_F_CHOICE_OR_NULL("cut_by", cut_by, CAUSES),
    MT_F_LIST("overrides", overrides, n_overrides, mt_result_override, OVERRIDE),
    MT_F_LIST("inputs", inputs, n_inputs, mt_result_digest, DIGEST),
    MT_F_LIST("outputs", outputs, n_outputs, mt_result_digest, DIGEST),
};
static const mt_record RUN = MT_F_RECORD_OF(RUN_FIELDS);
#undef THIS

#define THIS                          mt_result_objective
#define OBJECTIVE_NAME(id, name, ...) #name,
static const char *const OBJECTIVE_TYPES[] = {MT_OBJECTIVE_LIST(OBJECTIVE_NAME)};
#undef OBJECTIVE_NAME
static const mt_field OBJECTIVE_FIELDS[] = {
    MT_F_CHOICE("type", type, OBJECTIVE_TYPES),
    MT_F_TEXT("text", text),
    MT_F_TEXT_OR_NULL("unit", unit),
};
static const mt_record OBJECTIVE = MT_F_RECORD_OF(OBJECTIVE_FIELDS);
#undef THIS

#define THIS mt_result_source
static const mt_field SOURCE_FIELDS[] = {
    MT_F_TEXT_OR_NULL("name", name),
    MT_F_TEXT("file", file),
};
static const mt_record SOURCE = MT_F_RECORD_OF(SOURCE_FIELDS);
#undef THIS

#define THIS mt_result_study
static const mt_field STUDY_FIELDS[] = {
    MT_F_TEXT_OR_NULL("name", name),     MT_F_TEXT("file", file),
    MT_F_TEXT_OR_NULL("author", author), MT_F_TEXT_OR_NULL("revision", revision),
    MT_F_TEXT_OR_NULL("date", date),
};
static const mt_record STUDY = MT_F_RECORD_OF(STUDY_FIELDS);
#undef THIS

#define THIS mt_result_assumption
static const mt_field ASSUMPTION_FIELDS[] = {
    MT_F_TEXT("parameter", parameter),
    MT_F_TEXT_OR_NULL("unit", unit),
    MT_F_TEXT_OR_NULL("display_unit", display_unit),
    MT_F_NUMBER_OR_NULL("display_factor", display_factor),
    MT_F_NUMBER("value", value),
    MT_F_TEXT_OR_NULL("source", source),
    MT_F_FLAG("variable", variable),
};
static const mt_record ASSUMPTION = MT_F_RECORD_OF(ASSUMPTION_FIELDS);
#undef THIS

#define THIS mt_result
static const mt_field RESULT_FIELDS[] = {
    MT_F_RECORD("study", study, mt_result_study, STUDY),
    MT_F_RECORD("model", model, mt_result_source, SOURCE),
    MT_F_ENUM("status", status, mt_result_status, STATUSES),
    MT_F_TEXT_OR_NULL("status_text", status_text),
    MT_F_LIST("doubts", doubts, n_doubts, mt_warning, mt_warning_record),
    MT_F_LIST("facts", facts, n_facts, mt_warning, mt_warning_record),
    MT_F_LIST("assumptions", assumptions, n_assumptions, mt_result_assumption, ASSUMPTION),
    MT_F_TEXTS("variables", variables, n_variables),
    MT_F_LIST("objectives", objectives, n_objectives, mt_result_objective, OBJECTIVE),
    MT_F_RECORD("baseline", baseline, mt_recommendation, mt_design_record),
    MT_F_LIST("recommendations", recommendations, n_recommendations, mt_recommendation,
              mt_design_record),
    MT_F_LIST("unchecked", unchecked, n_unchecked, mt_unchecked, UNCHECKED),
    MT_F_LIST_OR_NULL("undetermined", unidentifiable, n_unidentifiable,
                      mt_unidentifiable_direction, UNIDENTIFIABLE),
    MT_F_LIST_OR_NULL("spread", weight_sensitivity, n_weight_sensitivity,
                      mt_result_weight_sensitivity, WEIGHT_SENSITIVITY),
    MT_F_LIST_OR_NULL("certificates", certificates, n_certificates, mt_certificate,
                      CERTIFICATE),
    MT_F_LIST_OR_NULL("relaxations", relaxations, n_relaxations, mt_relaxation, RELAXATION),
    MT_F_LIST("excitations", excitations, n_excitations, mt_result_excitation, EXCITATION),
    MT_F_LIST("curves", curves, n_curves, mt_result_curve, mt_curve_record),
    MT_F_OPTION("trade", trade, mt_trade_result, TRADE),
    MT_F_LIST_OR_NULL("published", published, n_published, mt_result_published, PUBLISHED),
    MT_F_TEXTS("warnings", warnings, n_warnings),
    MT_F_RECORD("run", run, mt_result_run, RUN),
};
const mt_record mt_result_record = MT_F_RECORD_OF(RESULT_FIELDS);
#undef THIS

#define DEFAULT(of, record)             \
    of of##_default(void)               \
    {                                   \
        of r;                           \
        mt_record_clear(&(record), &r); \
        return r;                       \
    }
MT_RESULT_DEFAULT_LIST(DEFAULT)
#undef DEFAULT

const char *mt_result_status_name(mt_result_status status)
{
    return (int)status >= 0 && status < MT_RESULT_STATUS_COUNT ? STATUSES[status] : "unknown";
}
