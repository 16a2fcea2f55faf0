/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What each record of a result holds, in the order of result.json. */
#include "result/result.h"
#include "study/goals.h"
#include "study/objectives.h"

/* In which unit people are shown the numbers beside it, which are in SI. */
#define SHOWN_FIELDS                                                                           \
    MT_F_TEXT_OR_NULL("display_unit", display_unit,                                            \
                      "What people are shown these values in; null: in the unit itself.",      \
                      .later = true),                                                          \
        MT_F_NUMBER_OR_NULL(                                                                   \
            "display_factor", display_factor,                                                  \
            "How much of the unit that is: value / display_factor is shown; null: the value.", \
            .later = true)

#define STATUS_NAME(id, name) name,
static const char *const STATUSES[] = {MT_RESULT_STATUS_LIST(STATUS_NAME)};
#undef STATUS_NAME

#define THIS mt_result_parameter
static const char *const BOUNDS[] = {"lower", "upper"};
static const char *const MEASURES[] = {"logarithmic", "logarithmic with floor", "linear"};
static const mt_field PARAMETER_FIELDS[] = {
    MT_F_TEXT("name", name, "Name in the model."),
    MT_F_TEXT_OR_NULL("unit", unit, "SI unit of both values; null: none given."),
    SHOWN_FIELDS,
    MT_F_NUMBER_OR_NULL("original", original, "Value at the original design."),
    MT_F_NUMBER_OR_NULL("recommended", recommended, "Value at this design."),
    MT_F_NUMBER_OR_NULL("change_percent", change_percent,
                        "Change relative to the original, in percent; null where that is 0."),
    MT_F_CHOICE_OR_NULL("at_bound", at_bound, BOUNDS, "Whether the value lies at a bound."),
    MT_F_NUMBER_OR_NULL("lower", lower, "Its lower bound; of a catalogue the least entry.",
                        .later = true),
    MT_F_NUMBER_OR_NULL("upper", upper, "Its upper bound; of a catalogue the greatest entry.",
                        .later = true),
    MT_F_CHOICE("measure", measure, MEASURES,
                "How a change counts: by ln(new/original); the same, linearly below a floor; "
                "or (new - original)/scale."),
    MT_F_NUMBER_OR_NULL(
        "measure_floor", measure_floor,
        "Where the logarithm goes on as its tangent, in the unit of the value; null: nowhere."),
    MT_F_NUMBER_OR_NULL("measure_scale", measure_scale,
                        "Change that counts as 1, in the unit of the value; null where the "
                        "measure is logarithmic."),
    MT_F_TEXT("catalogue", catalogue,
              "The study's catalogue of parts of which a row sets it together with others; "
              "absent: none.",
              .other = MT_F_MEMBER(const char *, catalogue), .later = true),
    MT_F_TEXT(
        "part", part,
        "That row of this design: its name, or its number from 1 as \"row 3\"; absent: the "
        "values are those of no row.",
        .other = MT_F_MEMBER(const char *, part), .later = true),
};
static const mt_record PARAMETER =
    MT_F_RECORD_OF(PARAMETER_FIELDS, "parameter", "A parameter that the study may change.");
#undef THIS

#define THIS mt_result_frequency
static const char *const IDENTITIES[] = {"tracked", "ambiguous", "lost"};
static const mt_field FREQUENCY_FIELDS[] = {
    MT_F_TEXT("configuration", configuration, "Configuration of the model."),
    MT_F_COUNT("mode", mode, 0, "Index at this design, from 1 without rigid-body modes."),
    MT_F_TEXT_OR_NULL("name", name, "The named mode that it is."),
    MT_F_CHOICE_OR_NULL("identity", identity, IDENTITIES,
                        "How surely: \"tracked\", \"ambiguous\" (another mode has more than "
                        "half as much of its shape), \"lost\"; null: not named."),
    MT_F_NUMBER_OR_NULL(
        "share", share,
        "Part of the named mode's shape that this mode carries, mass-weighted, 0 to 1."),
    MT_F_COUNT_OR_NULL("rival_mode", rival_mode, 1,
                       "The mode that carries most of the rest; null: none."),
    MT_F_NUMBER_OR_NULL("rival_share", rival_share, "How much."),
    MT_F_NUMBER_OR_NULL("original_hz", original_hz, "At the original design [Hz]."),
    MT_F_NUMBER_OR_NULL("recommended_hz", recommended_hz, "At this design [Hz]."),
    MT_F_NUMBER_OR_NULL("target_hz", target_hz, "Wanted [Hz]."),
    MT_F_NUMBER_OR_NULL("at_least_hz", at_least_hz, "Lower limit [Hz]."),
    MT_F_NUMBER_OR_NULL("at_most_hz", at_most_hz, "Upper limit [Hz]."),
    MT_F_NUMBER_OR_NULL("error_percent", error_percent,
                        "Distance from the target, or beyond a limit, in percent."),
    MT_F_NUMBER_OR_NULL("lowest_hz", lowest_hz,
                        "Lowest frequency of the mode with this index over the tolerances of "
                        "the variables [Hz]; null: they have none."),
    MT_F_NUMBER_OR_NULL("highest_hz", highest_hz,
                        "The highest frequency of the same mode [Hz]."),
    MT_F_TEXT_OR_NULL("reference", reference, "Reference whose shape it is compared with."),
    MT_F_NUMBER_OR_NULL("mac", mac, "Modal assurance criterion with that shape, 0 to 1."),
    MT_F_FLAG("repeated", repeated,
              "The frequency is a repeated one: it has no single gradient."),
    MT_F_BY_VARIABLE_OR_NULL("sensitivity", sensitivity,
                             "Hz per unit of each variable; null where not computed or, for "
                             "one, at a repeated mode."),
    MT_F_NUMBER_OR_NULL("residual", residual,
                        "Backward error of the mode (no unit; of order 1: exact to rounding)."),
    MT_F_NUMBER_OR_NULL(
        "orthogonality", orthogonality,
        "Loss of orthogonality of the mode (no unit; of order 1: exact to rounding)."),
    MT_F_UNWRITTEN_TEXT(slack),
};
static const mt_record FREQUENCY = MT_F_RECORD_OF(
    FREQUENCY_FIELDS, "frequency", "A natural frequency that the goals ask about.");
#undef THIS

#define THIS mt_result_clearance
static const char *const SIDES[] = {"below", "inside", "above"};
static const mt_field CLEARANCE_FIELDS[] = {
    MT_F_TEXT("configuration", configuration, "Configuration of the model."),
    MT_F_TEXT("band", band, "The band: \"4P of UH-60\"."),
    MT_F_COUNT("band_id", band_id, 1, "Its id in gap_assignment."),
    MT_F_COUNT("mode", mode, 1, "Index at this design, from 1 without rigid-body modes."),
    MT_F_NUMBER_OR_NULL("hz", hz, "Its frequency [Hz]."),
    MT_F_NUMBER_OR_NULL("percent", percent,
                        "Clearance |ln(f/edge)| from the nearest edge of the band without its "
                        "margin, as the greater of the two frequencies over the smaller less "
                        "1, in percent; negative inside; null: at 0 Hz."),
    MT_F_NUMBER_OR_NULL("margin_percent", margin_percent,
                        "What was asked for at that edge, as a clearance: a margin of 10 % of "
                        "the edge is 10 % above a band and 11.1 % below it."),
    MT_F_NUMBER_OR_NULL("worst_hz", worst_hz,
                        "Where it comes nearest to the band, or lies deepest in it, over the "
                        "tolerances of the variables [Hz]; null: they have none."),
    MT_F_NUMBER_OR_NULL("worst_percent", worst_percent,
                        "Its clearance there; negative inside."),
    MT_F_CHOICE("side", side, SIDES, "Where the mode lies."),
};
static const mt_record CLEARANCE =
    MT_F_RECORD_OF(CLEARANCE_FIELDS, "clearance", "A mode beside a band.");
#undef THIS

#define THIS mt_result_mode_placement
static const mt_field GAP_FIELDS[] = {
    MT_F_COUNT("id", id, 1, "Of this band of this configuration: the same at all designs."),
    MT_F_TEXT("configuration", configuration, "Configuration of the model."),
    MT_F_TEXT("band", band, "The band."),
    MT_F_NUMBER_OR_NULL("lower_hz", lower_hz, "Its lower edge without margin [Hz]."),
    MT_F_NUMBER_OR_NULL("upper_hz", upper_hz, "Its upper edge without margin [Hz]."),
    MT_F_NUMBER_OR_NULL("margin_lower_hz", margin_lower_hz, "Its lower edge with margin [Hz]."),
    MT_F_NUMBER_OR_NULL("margin_upper_hz", margin_upper_hz, "Its upper edge with margin [Hz]."),
    MT_F_COUNT("modes_below", modes_below, 0, "Their number, without rigid-body modes."),
};
static const mt_record GAP =
    MT_F_RECORD_OF(GAP_FIELDS, "gap", "How many modes lie below a band.");
#undef THIS

#define THIS mt_result_motion
static const char *const DRIVE_UNITS[] = {"rad", "m"};
static const char *const MOTION_GRADES[] = {"sampled", "sampled coarsely", "incomplete",
                                            "unstable", "not followed"};
static const mt_field MOTION_FIELDS[] = {
    MT_F_TEXT("goal", pointer, "Where the study asks for the bands (JSON pointer)."),
    MT_F_TEXT("drive", drive, "The driven joint."),
    MT_F_CHOICE("unit", unit, DRIVE_UNITS, "Of its positions."),
    SHOWN_FIELDS,
    MT_F_NUMBER_OR_NULL("from", from, "The first named position."),
    MT_F_NUMBER_OR_NULL("to", to, "The last named position."),
    MT_F_COUNT("positions", positions, 0,
               "How many positions were looked at, the named ones included; 0: not followed."),
    MT_F_NUMBER_OR_NULL("least_clearance_percent", least_clearance_percent,
                        "Where a mode comes nearest to an edge: its clearance from the edge of "
                        "the band without its margin, as the greater of the two frequencies "
                        "over the smaller less 1, in percent; negative beyond it."),
    MT_F_NUMBER_OR_NULL("margin_percent", margin_percent,
                        "What was asked for at that edge, as a clearance: a margin of 10 % of "
                        "the edge is 10 % above a band and 11.1 % below it."),
    MT_F_NUMBER_OR_NULL("at", at, "The position where that is."),
    MT_F_NUMBER_OR_NULL("hz", hz, "The mode's frequency there [Hz]."),
    MT_F_COUNT_OR_NULL("mode", mode, 1,
                       "Which mode that is, or which one crosses a band; null: none."),
    MT_F_TEXT_OR_NULL("band", band, "The band; null: none."),
    MT_F_COUNT_OR_NULL(
        "band_id", band_id, 1,
        "Its id in gap_assignment, of the first position that has it; null: none."),
    MT_F_FLAG("crosses", crosses,
              "A mode is inside a band, with its margin, between the positions."),
    MT_F_CHOICE(
        "grade", grade, MOTION_GRADES,
        "How sure that is. sampled: no mode moves further than a tenth of its clearance from "
        "one position to the next; sampled coarsely: the greatest number of positions was not "
        "enough for that; incomplete: some positions cannot be reached; unstable: at some; not "
        "followed: a named position misses its bands."),
    MT_F_TEXT("text", text, "The same as a sentence."),
};
static const mt_record MOTION = MT_F_RECORD_OF(
    MOTION_FIELDS, "motion", "A design between the named positions of one drive.");
#undef THIS

#define THIS mt_result_tolerance
static const mt_field TOLERANCE_FIELDS[] = {
    MT_F_TEXT("name", name, "Its name."),
    MT_F_NUMBER_OR_NULL("percent", percent, "How much it may change either way."),
    MT_F_TEXT_OR_NULL("edge", edge, "What would be met there, in words."),
};
static const mt_record TOLERANCE = MT_F_RECORD_OF(TOLERANCE_FIELDS, NULL, "One variable.");
#undef THIS

#define THIS mt_tolerance_box
static const mt_field TOLERANCE_BOX_FIELDS[] = {
    MT_F_NUMBER_OR_NULL("all_percent", all_percent,
                        "All variables together, either way, in percent of their values; 0: "
                        "the design lies on an edge."),
    MT_F_TEXT_OR_NULL("edge", edge, "What would be met there, in words."),
    MT_F_FLAG("proven", proven, "true: a proof; false: sampled."),
    MT_F_LIST("per_variable", variables, n_variables, mt_result_tolerance, TOLERANCE,
              "Each variable alone, in the study's order."),
};
static const mt_record TOLERANCE_BOX = MT_F_RECORD_OF(
    TOLERANCE_BOX_FIELDS, "tolerance_box",
    "How much the variables may change with every band, without its margin, still kept.");
#undef THIS

#define THIS                     mt_result_goal
#define GOAL_NAME(id, name, ...) #name,
static const char *const GOAL_TYPES[] = {MT_GOAL_LIST(GOAL_NAME)};
#undef GOAL_NAME
static const mt_field GOAL_FIELDS[] = {
    MT_F_TEXT("goal", text, "What is asked, in words."),
    MT_F_TEXT("quantity", quantity, "Of these words what is limited: \"installed mode 1\".",
              .other = MT_F_MEMBER(const char *, text), .later = true),
    MT_F_TEXT("pointer", pointer, "Where the study asks it (JSON pointer)."),
    MT_F_CHOICE("type", type, GOAL_TYPES, "Kind of goal, as the study calls it."),
    MT_F_TEXT_OR_NULL("configuration", configuration,
                      "Of the model; null: none, or the motion between several."),
    MT_F_COUNT_OR_NULL("mode", mode, 1,
                       "The mode that is asked for, by its index; null: by its name, or none."),
    MT_F_TEXT_OR_NULL("name", name, "The mode that is asked for, by its name."),
    MT_F_TEXT("of_configuration", of_configuration,
              "Of a ratio or a distance of frequencies: that of the other mode.",
              .other = MT_F_MEMBER(const char *, of_configuration), .later = true),
    MT_F_LONG("of_mode", of_mode, "The other mode, by its index.", .least = 1, .later = true),
    MT_F_TEXT("of_name", of_name, "The other mode, by its name.",
              .other = MT_F_MEMBER(const char *, of_name), .later = true),
    MT_F_TEXT_OR_NULL("reference", reference,
                      "The reference or the measurement that it is compared with."),
    MT_F_TEXT_OR_NULL("expression", expression, "Of a limit."),
    MT_F_TEXT_OR_NULL(
        "unit", unit,
        "Of value, worst, target and limits: \"Hz\"; of an avoid goal \"%\", the least "
        "clearance from an edge without margin; empty: none; null: that of the expression."),
    SHOWN_FIELDS,
    MT_F_NUMBER_OR_NULL("value", value, "Value at this design."),
    MT_F_NUMBER_OR_NULL("target", target,
                        "Wanted value; of a shape 0, its distance; null: limits only."),
    MT_F_NUMBER_OR_NULL(
        "at_least", at_least,
        "Lower limit; of an avoid goal the margin at the edge that is nearest to it."),
    MT_F_NUMBER_OR_NULL("at_most", at_most, "Upper limit."),
    MT_F_NUMBER_OR_NULL("tolerance_percent", tolerance_percent, "A violation up to it is met."),
    MT_F_NUMBER_OR_NULL("worst", worst,
                        "Its worst value over the tolerances of the variables, by which the "
                        "goal is judged; null: they have none."),
    MT_F_BY_VARIABLE_OR_NULL("worst_at", worst_at,
                             "Values of the variables where that is; null: as \"worst\"."),
    MT_F_BY_VARIABLE_OR_NULL("sensitivity", sensitivity,
                             "Slopes of the value, per unit of each variable; null: it has "
                             "none, as a mode that repeats, or a distance.",
                             .later = true),
    MT_F_NUMBER_OR_NULL("off_most_hz", off_most_hz,
                        "Of a frequency response: the measured frequency where the deviation "
                        "is greatest [Hz]; null: it is none, or has no value.",
                        .later = true),
    MT_F_NUMBER_OR_NULL("off_most_ratio", off_most_ratio,
                        "Its magnitude there, over the measured one.", .later = true),
    MT_F_NUMBER_OR_NULL("off_most_phase_deg", off_most_phase_deg,
                        "Its phase there, less the measured one [deg].", .later = true),
    MT_F_NUMBER_OR_NULL("violation_percent", violation_percent,
                        "How far the goal is missed, in percent."),
    MT_F_FLAG("met", met, "Within the goal's tolerance."),
    MT_F_FLAG("weighted", weighted,
              "Part of an objective (the misfit, or the vibration, whose scale its limit is): "
              "does not decide the status."),
    MT_F_FLAG("doubtful", doubtful,
              "The named mode cannot be identified at this design: the goal counts as not met, "
              "whatever its number."),
};
static const mt_record GOAL =
    MT_F_RECORD_OF(GOAL_FIELDS, "goal", "A goal, judged at this design.");
#undef THIS

#define THIS mt_design_objective
static const mt_field REACHED_FIELDS[] = {
    MT_F_TEXT("text", text, "As in the result's \"objectives\"."),
    MT_F_TEXT_OR_NULL("unit", unit, "As there."),
    MT_F_NUMBER_OR_NULL(
        "original", original,
        "Of the original design; null: it has none (of a clearance: unstable)."),
    MT_F_NUMBER_OR_NULL("recommended", recommended, "Of this design."),
};
static const mt_record REACHED = MT_F_RECORD_OF(
    REACHED_FIELDS, NULL,
    "An objective's values. A clearance is the least distance from a band with its margin, as "
    "a ratio of frequencies less 1; \"clearance_percent\" is that from the edges without it.");
#undef THIS

#define THIS mt_reason
static const char *const REASON_KINDS[] = {"change", "hold", "cost", "rank"};
static const mt_field REASON_FIELDS[] = {
    MT_F_CHOICE("kind", kind, REASON_KINDS,
                "Whether it tells what changes, what holds the design, what that costs, or how "
                "it stands among others.",
                .later = true),
    MT_F_TEXT_OR_NULL("about", about,
                      "The parameter's name, or the goal's JSON pointer; null: neither.",
                      .later = true),
    MT_F_TEXT("text", text, "The sentence.", .alone = true),
};
static const mt_record REASON = MT_F_RECORD_OF(REASON_FIELDS, "reason", "One sentence of why.");
#undef THIS

#define THIS mt_result_mac_row
static const mt_field MAC_ROW_FIELDS[] = {
    MT_F_COUNT("mode", mode, 1, "Vibration index at this design."),
    MT_F_NUMBERS(
        "values", values, n_values,
        "MAC with each of \"reference_modes\": 1 is the same shape at the common sensors.",
        .rules = "\"minimum\": 0"),
};
static const mt_record MAC_ROW =
    MT_F_RECORD_OF(MAC_ROW_FIELDS, NULL, "A mode of the configuration.");
#undef THIS

#define THIS mt_result_mac
static const mt_field MAC_FIELDS[] = {
    MT_F_TEXT("configuration", configuration, "Configuration."),
    MT_F_TEXT("reference", reference, "Name of the reference."),
    MT_F_NUMBERS("reference_modes", reference_modes, n_reference_modes,
                 "Modes of the reference that move at sensors that both have, by their index; "
                 "at most 24.",
                 .rules = "\"minimum\": 1"),
    MT_F_LIST("rows", rows, n_rows, mt_result_mac_row, MAC_ROW,
              "Modes of the configuration that move there."),
};
static const mt_record MAC =
    MT_F_RECORD_OF(MAC_FIELDS, NULL, "A configuration beside a reference.");
#undef THIS

/* What goals of forced vibration find. */
static const char *const SURETIES[] = {"proven", "sampled"};

#define THIS mt_result_response
static const char *const FORCED_RESPONSE[] = {"response", "rms", "sine", "peak"};
static const char *const FORCED_RESPONSE_ENDS[] = {"finite", "infinite", "unstable", "none"};
static const mt_field RESPONSE_FIELDS[] = {
    MT_F_TEXT("goal", pointer, "JSON pointer of the goal in the study."),
    MT_F_TEXT("configuration", configuration, "Configuration of the model."),
    MT_F_TEXT("input", input, "What shakes, as the study names it."),
    MT_F_TEXT("output", output, "What is looked at."),
    MT_F_TEXT_OR_NULL(
        "profile", profile,
        "The profile of vibration, as the study names it; null: the response itself."),
    MT_F_CHOICE(
        "quantity", quantity, FORCED_RESPONSE,
        "What counts: the response, or of a profile its random parts, its tones, both."),
    MT_F_TEXT("unit", unit, "Of value and error; empty: not known."),
    MT_F_NUMBER_OR_NULL("value", value, "How large it is; null: see end."),
    MT_F_NUMBER_OR_NULL("error_at_most", error,
                        "The value is known to within this, of one that is sampled by an "
                        "estimate; null: there is none, or it is not known."),
    MT_F_NUMBER_OR_NULL(
        "frequency_hz", frequency_hz,
        "Where the response is largest within its range [Hz]; null: not known."),
    MT_F_FLAG("at_edge", at_edge,
              "That is an end of the range: the response still grows there."),
    MT_F_NUMBER_OR_NULL("lower_hz", lower_hz, "The range [Hz]."),
    MT_F_NUMBER_OR_NULL("upper_hz", upper_hz, "The range [Hz]."),
    MT_F_CHOICE("end", end, FORCED_RESPONSE_ENDS,
                "Whether there is a number: infinite where an undamped resonance is excited, "
                "none where the response could not be computed."),
    MT_F_CHOICE("grade", grade, SURETIES,
                "How it is known that no frequency of the range has more."),
    MT_F_TEXT("text", text, "In words, without a full stop."),
};
static const mt_record RESPONSE =
    MT_F_RECORD_OF(RESPONSE_FIELDS, "response", "How large a forced vibration is.");
#undef THIS

#define THIS mt_result_between
static const char *const BETWEEN_GRADES[] = {"sampled", "sampled coarsely", "incomplete",
                                             "unstable"};
static const mt_field BETWEEN_FIELDS[] = {
    MT_F_TEXT("goal", pointer, "JSON pointer of the goal in the study."),
    MT_F_TEXT("drive", drive, "The driven joint."),
    MT_F_CHOICE("unit", unit, DRIVE_UNITS, "Of its positions."),
    MT_F_NUMBER_OR_NULL("from", from, "The first position that the goal names."),
    MT_F_NUMBER_OR_NULL("to", to, "The last position that the goal names."),
    MT_F_COUNT("positions", positions, 0,
               "How many positions were looked at, the named ones included; 0: none."),
    MT_F_NUMBER_OR_NULL("at", at,
                        "The position where the limit is missed most, or comes nearest; null: "
                        "no position has a value."),
    MT_F_FLAG("named", named, "That is a position that the goal names."),
    MT_F_NUMBER_OR_NULL("value", value, "The number there; null: see end."),
    MT_F_TEXT("value_unit", value_unit, "Of value and error; empty: not known."),
    MT_F_NUMBER_OR_NULL("error_at_most", error,
                        "At that position the value is known to within this; null: there is "
                        "none, or it is not known."),
    MT_F_NUMBER_OR_NULL("frequency_hz", frequency_hz,
                        "Of a forced vibration: where the response is largest within its range "
                        "there [Hz]; null: not known."),
    MT_F_CHOICE("end", end, FORCED_RESPONSE_ENDS,
                "Whether there is a number: infinite where an undamped resonance is excited, "
                "or of a mode at infinity, none where no position has one."),
    MT_F_NUMBER_OR_NULL("violation_percent", violation_percent,
                        "What the limit is missed by there, in percent of it; 0: it is kept; "
                        "null: there is no number.",
                        .rules = "\"minimum\": 0"),
    MT_F_FLAG(
        "holds", holds,
        "The limit is kept, within its tolerance, at all positions that were looked at, and "
        "all of them have a value; these are samples, and no proof of what lies between them."),
    MT_F_CHOICE(
        "grade", grade, BETWEEN_GRADES,
        "How the positions between are known: samples where value and neighbours ask for them, "
        "as many as the budget had, not all of them with a value, or some that are unstable."),
    MT_F_TEXT("text", text, "In words, without a full stop."),
};
static const mt_record BETWEEN = MT_F_RECORD_OF(
    BETWEEN_FIELDS, "response_between", "The number of a goal over the positions of a drive.");
#undef THIS

#define THIS mt_recommendation
static const mt_field DESIGN_FIELDS[] = {
    MT_F_COUNT("rank", rank, 0, "From 1; the original design has 0."),
    MT_F_FLAG("feasible", feasible, "Every goal is met."),
    MT_F_TEXT_OR_NULL(
        "grade", grade,
        "In words: \"feasible and proven\", \"feasible\", \"fitted\" (all goals are weighted: "
        "the least misfit found), \"local minimum\" (of the misfit, another one), \"not "
        "converged\" (to a least misfit), \"compromise\", \"infeasible\", \"not verified\" (a "
        "fresh analysis disagrees with the search: do not use it)."),
    MT_F_NUMBER_OR_NULL(
        "score", score,
        "What it is ranked by: the value of the first objective; null where a goal is missed."),
    MT_F_LIST("objectives", objectives, n_objectives, mt_design_objective, REACHED,
              "Values of all objectives, in the study's order, whether the goals are met or "
              "not; at a point of a trade study followed by those of its front that are none "
              "of the study's."),
    MT_F_NUMBER_OR_NULL("change", change, "Size of the redesign (no unit)."),
    MT_F_NUMBER_OR_NULL("misfit", misfit, "Size of the weighted residuals (no unit)."),
    MT_F_NUMBER_OR_NULL("violation_percent", violation_percent,
                        "Greatest violation of a goal, in percent."),
    MT_F_NUMBER_OR_NULL(
        "clearance_percent", clearance_percent,
        "Least clearance of all modes from all bands without their margins, the greater of the "
        "two frequencies over the smaller less 1, in percent; null: no bands."),
    MT_F_NUMBER_OR_NULL("kkt_residual", kkt_residual,
                        "Relative KKT residual; null where the design is not an optimum."),
    MT_F_CHOICE_OR_NULL(
        "worst_case", worst_case, SURETIES,
        "How the worst over the tolerances of the variables is known: a proven corner, or "
        "corners, points within and descent; null: the variables have no tolerances."),
    MT_F_FLAG("singular", singular,
              "A double solution: the Jacobian of the goals is singular here."),
    MT_F_LIST("parameters", parameters, n_parameters, mt_result_parameter, PARAMETER,
              "The variables, in the study's order."),
    MT_F_LIST("frequencies", frequencies, n_frequencies, mt_result_frequency, FREQUENCY,
              "The frequencies that the goals ask about."),
    MT_F_LIST("mac_matrices", macs, n_macs, mt_result_mac, MAC,
              "For each reference whose shapes goals compare with those of a configuration: "
              "how much each of the first modes (those in \"frequencies\") has the shape of "
              "each of the reference's.",
              .later = true),
    MT_F_LIST("clearances", clearances, n_clearances, mt_result_clearance, CLEARANCE,
              "Distances of modes from forbidden bands."),
    MT_F_LIST_OR_NULL("gap_assignment", placements, n_placements, mt_result_mode_placement, GAP,
                      "Modes below each forbidden band; null: no bands."),
    MT_F_LIST("motion", motions, n_motions, mt_result_motion, MOTION,
              "Between the named positions of each drive that keeps clear of bands in several "
              "of them."),
    MT_F_OPTION("tolerance_box", tolerance_box, mt_tolerance_box, TOLERANCE_BOX,
                "Tolerances within which the bands, without their margin, are kept; null: not "
                "computed."),
    MT_F_LIST("goals", goals, n_goals, mt_result_goal, GOAL, "Every goal."),
    MT_F_LIST("responses", responses, n_responses, mt_result_response, RESPONSE,
              "What the goals of types \"response\" and \"vibration\" find, one for each goal "
              "and configuration.",
              .later = true),
    MT_F_LIST("responses_between", between, n_between, mt_result_between, BETWEEN,
              "What goals that limit a number (a frequency, a damping ratio, a MAC, a forced "
              "vibration) find between the positions of one drive, one for each goal and drive "
              "with several positions that the goal names.",
              .later = true),
    MT_F_LIST("curves", curves, n_curves, mt_design_curve, mt_design_curve_record,
              "Responses of this design, in the order of the result's; none at points of a "
              "trade study.",
              .later = true),
    MT_F_LIST("reasons", reasons, n_reasons, mt_reason, REASON,
              "Why this design is what it is."),
    MT_F_UNWRITTEN_TEXT(disagreement),
};
const mt_record mt_design_record = MT_F_RECORD_OF(DESIGN_FIELDS, "design", "A design, judged.");
#undef THIS

#define THIS mt_unchecked
static const mt_field UNCHECKED_FIELDS[] = {
    MT_F_TEXT("text", text, "Its values in the units that they are shown in."),
    MT_F_NUMBERS_BY_VARIABLE("values", values, "By variable, in SI."),
};
static const mt_record UNCHECKED =
    MT_F_RECORD_OF(UNCHECKED_FIELDS, "unchecked", "A design that was not analysed again.");
#undef THIS

#define THIS mt_unidentifiable_direction
static const mt_field UNIDENTIFIABLE_FIELDS[] = {
    MT_F_TEXT("direction", text, "In words: \"K_T2\" or \"0.71 ln a - 0.71 ln b\"."),
    MT_F_NUMBER_OR_NULL("effect_percent", effect_percent,
                        "Greatest change of a goal, in percent of its demand, when the bounds "
                        "are crossed along it."),
    MT_F_BY_VARIABLE("components", direction,
                     "Unit vector by variable, in ln(parameter) or parameter/scale."),
};
static const mt_record UNIDENTIFIABLE =
    MT_F_RECORD_OF(UNIDENTIFIABLE_FIELDS, "undetermined",
                   "A direction in which the variables may move without any goal noticing.");
#undef THIS

#define THIS mt_result_weight_sensitivity
static const mt_field WEIGHT_SENSITIVITY_FIELDS[] = {
    MT_F_TEXT("parameter", parameter, "Its name."),
    MT_F_TEXT_OR_NULL("unit", unit, "Its unit."),
    SHOWN_FIELDS,
    MT_F_NUMBER_OR_NULL("value", value, "With the weights as given."),
    MT_F_NUMBER_OR_NULL("low", low, "The smallest of all solutions."),
    MT_F_NUMBER_OR_NULL("low_percent", low_percent, "Against value."),
    MT_F_TEXT_OR_NULL(
        "low_goal", low_goal,
        "Whose weight was changed, as a JSON pointer; null: no change goes there."),
    MT_F_NUMBER_OR_NULL("low_weight_factor", low_factor, "What it was multiplied with."),
    MT_F_NUMBER_OR_NULL("high", high, "The greatest."),
    MT_F_NUMBER_OR_NULL("high_percent", high_percent, "Against value."),
    MT_F_TEXT_OR_NULL("high_goal", high_goal, "Whose weight was changed."),
    MT_F_NUMBER_OR_NULL("high_weight_factor", high_factor, "What it was multiplied with."),
};
static const mt_record WEIGHT_SENSITIVITY =
    MT_F_RECORD_OF(WEIGHT_SENSITIVITY_FIELDS, "spread",
                   "Where a variable of the best design moves when the weight of one goal at a "
                   "time is changed.");
#undef THIS

#define THIS mt_certificate
static const mt_field CERTIFICATE_FIELDS[] = {
    MT_F_TEXT("kind", kind, "\"infeasible\", \"range\", ..."),
    MT_F_TEXT("text", text, "In words."),
    MT_F_FLAG("proven", proven, "true: a proof; false: sampled."),
    MT_F_TEXT_OR_NULL("pointer", pointer,
                      "The goal that it speaks of (JSON pointer); null: all of them."),
    MT_F_NUMBER_OR_NULL(
        "reachable_lower_hz", reachable_lower_hz,
        "The goal's mode reaches no lower within the bounds; null: not applicable."),
    MT_F_NUMBER_OR_NULL(
        "reachable_upper_hz", reachable_upper_hz,
        "The goal's mode reaches no higher within the bounds; null: not applicable."),
};
static const mt_record CERTIFICATE = MT_F_RECORD_OF(
    CERTIFICATE_FIELDS, "certificate", "A statement about all designs within the bounds.");
#undef THIS

#define THIS mt_relaxation
static const char *const RELAXATIONS[] = {"bound", "band", "goal"};
static const mt_field RELAXATION_FIELDS[] = {
    MT_F_CHOICE("kind", kind, RELAXATIONS, "What is moved."),
    MT_F_TEXT("pointer", pointer, "What it belongs to (JSON pointer into the study)."),
    MT_F_TEXT("what", what, "In words: \"upper bound of k1\"."),
    MT_F_TEXT_OR_NULL("unit", unit, "Of from and to; null: none."),
    SHOWN_FIELDS,
    MT_F_NUMBER("from", from, "As asked."),
    MT_F_NUMBER("to", to, "With this a design exists."),
    MT_F_NUMBER_OR_NULL("change_percent", change_percent, "Of |from|; null where that is 0."),
    MT_F_NUMBERS_BY_VARIABLE(
        "design", design, "Variables of the design of least change with that move, by name."),
    MT_F_TEXT("text", text, "As a sentence."),
};
static const mt_record RELAXATION =
    MT_F_RECORD_OF(RELAXATION_FIELDS, "relaxation",
                   "One number of the question whose change, with everything else as it is, "
                   "lets a design meet all goals. That it suffices is verified; that a smaller "
                   "change would not is sampled.");
#undef THIS

#define THIS mt_trade_vary
static const mt_field VARY_FIELDS[] = {
    MT_F_TEXT("quantity", text, "In words: \"upper bound of M_SAU\"."),
    MT_F_TEXT("pointer", pointer, "Where the study says so (JSON pointer)."),
    MT_F_TEXT_OR_NULL("unit", unit, "Of its values."),
    SHOWN_FIELDS,
};
static const mt_record VARY = MT_F_RECORD_OF(VARY_FIELDS, NULL, "A quantity.");
#undef THIS

#define THIS mt_trade_point
static const mt_field POINT_FIELDS[] = {
    MT_F_NUMBERS("values", values, n_values, "Of what varies."),
    MT_F_ENUM("status", status, mt_result_status, STATUSES, "As of a study."),
    MT_F_TEXT_OR_NULL("status_text", status_text, "In one sentence."),
    MT_F_FLAG(
        "pareto", pareto,
        "No other point is better in one of the two objectives and not worse in the other."),
    MT_F_RECORD_FLAT("best", best, mt_recommendation, mt_design_record, "The best design."),
};
static const mt_record POINT = MT_F_RECORD_OF(POINT_FIELDS, NULL, "A point.");
#undef THIS

#define THIS mt_trade_result
static const mt_field TRADE_FIELDS[] = {
    MT_F_LIST("vary", vary, n_vary, mt_trade_vary, VARY, "What varies.",
              .rules = "\"minItems\": 1, \"maxItems\": 2"),
    MT_F_TEXTS("objectives", objectives, n_objectives,
               "The two objectives of the Pareto front; empty: none asked for."),
    MT_F_LIST("points", points, n_points, mt_trade_point, POINT,
              "One per value, or per pair of values, the second varying faster."),
};
static const mt_record TRADE =
    MT_F_RECORD_OF(TRADE_FIELDS, "trade", "A trade study: the best design of every point.");
#undef THIS

#define THIS mt_result_order
static const mt_field ORDER_FIELDS[] = {
    MT_F_TEXT("label", label, "As the study writes it; of which gear."),
    MT_F_NUMBER("order", order, "Events per turn."),
};
static const mt_record ORDER = MT_F_RECORD_OF(ORDER_FIELDS, NULL, "Frequency over speed.");
#undef THIS

#define THIS mt_result_excitation
static const mt_field EXCITATION_FIELDS[] = {
    MT_F_TEXT("name", name, "What the study calls it."),
    MT_F_TEXT("pointer", pointer, "The goal that avoids it, as JSON pointer into the study."),
    MT_F_NUMBER("speed_lower_hz", speed_lower_hz, "Least speed [1/s]."),
    MT_F_NUMBER("speed_upper_hz", speed_upper_hz, "Greatest speed [1/s]."),
    MT_F_NUMBER("margin_percent", margin_percent,
                "Separation margin on both sides of its bands, in percent of their edges."),
    MT_F_NUMBER_OR_NULL("up_to_hz", up_to_hz,
                        "Frequencies beyond it do not count; null: all do.", .later = true),
    MT_F_TEXTS("configurations", configurations, n_configurations,
               "Configurations that the goal keeps clear of it."),
    MT_F_LIST("orders", orders, n_orders, mt_result_order, ORDER, "Its lines."),
};
static const mt_record EXCITATION =
    MT_F_RECORD_OF(EXCITATION_FIELDS, "excitation",
                   "Something that turns and excites at multiples of its speed.");
#undef THIS

#define THIS mt_result_published
static const char *const PUBLISHED_KINDS[] = {"parameter", "quantity", "frequency", "mac",
                                              "status"};
static const char *const ROLES[] = {"verifies", "calibrates", "not_comparable"};
static const mt_field PUBLISHED_FIELDS[] = {
    MT_F_TEXT_OR_NULL("label", label, "What tables call it."),
    MT_F_CHOICE("kind", kind, PUBLISHED_KINDS, "What was published."),
    MT_F_TEXT("pointer", pointer, "Where the study says so (JSON pointer)."),
    MT_F_CHOICE("role", role, ROLES, "What the value is for."),
    MT_F_VALUE_OR_NULL("published", published, published_text,
                       "The published value or limit; a status in words."),
    MT_F_VALUE_OR_NULL("computed", computed, computed_text, "Ours, in the same unit."),
    MT_F_NUMBER_OR_NULL("difference", difference, "Computed minus published."),
    MT_F_NUMBER_OR_NULL("difference_percent", difference_percent,
                        "The same in percent of the published value."),
    MT_F_TEXT_OR_NULL("demand", requirement, "How it is judged: \"within 0.1 %\"."),
    MT_F_TEXT_OR_NULL("display_unit", display_unit,
                      "What people are shown a parameter's numbers in; null: in SI units.",
                      .later = true),
    MT_F_NUMBER_OR_NULL(
        "display_factor", display_factor,
        "How much of the SI unit that is: value / display_factor is shown; null: the value.",
        .later = true),
    MT_F_FLAG("holds", holds, "It is met."),
    MT_F_TEXT_OR_NULL("source", source, "Where it was published."),
};
static const mt_record PUBLISHED = MT_F_RECORD_OF(
    PUBLISHED_FIELDS, "published", "A published value against the computed one.");
#undef THIS

#define THIS mt_warning
static const mt_field WARNING_FIELDS[] = {
    MT_F_TEXT("kind", kind, "A short name that does not change: \"margin\", \"free_motion\"."),
    MT_F_TEXT("text", text, "In words."),
    MT_F_TEXT_OR_NULL("configuration", configuration,
                      "Null: of the study, or of several configurations."),
    MT_F_TEXT_OR_NULL("file", file,
                      "As the study names it, without folders for the study itself."),
    MT_F_COUNT_OR_NULL("line", line, 1, "From 1; null: not known."),
    MT_F_COUNT_OR_NULL("column", column, 1, "From 1, in characters; null: not known."),
    MT_F_TEXT_OR_NULL("pointer", pointer, "JSON pointer in that file."),
};
const mt_record mt_warning_record =
    MT_F_RECORD_OF(WARNING_FIELDS, "doubt",
                   "A fact or a doubt, with its place in a file where that is known.");
#undef THIS

#define THIS mt_result_digest
#define DIGEST_FIELD                                     \
    MT_F_TEXT("sha256", sha256, "SHA-256, hexadecimal.", \
              .rules = "\"pattern\": \"^[0-9a-f]{64}$\"")
static const mt_field INPUT_FIELDS[] = {
    MT_F_TEXT("file", file, "Relative to the study's folder."),
    DIGEST_FIELD,
};
static const mt_record INPUT =
    MT_F_RECORD_OF(INPUT_FIELDS, NULL, "A file and the digest of its bytes.");
static const mt_field OUTPUT_FIELDS[] = {
    MT_F_TEXT("file", file, "Its name, in the folder of this one."),
    DIGEST_FIELD,
};
static const mt_record OUTPUT =
    MT_F_RECORD_OF(OUTPUT_FIELDS, NULL, "A file and the digest of its bytes.");
#undef THIS

#define THIS mt_result_build
static const mt_field BUILD_FIELDS[] = {
    MT_F_TEXT("commit", commit,
              "As git describes it, \"-dirty\" where files differed; \"unknown\": the sources "
              "were no repository."),
    MT_F_TEXT("compiler", compiler, "Name and version."),
};
static const mt_record BUILD =
    MT_F_RECORD_OF(BUILD_FIELDS, "build", "Sources and compiler of the program.");
#undef THIS

#define THIS mt_result_work_counters
static const mt_field WORK_COUNTERS_FIELDS[] = {
    MT_F_LONG("search", search, "Looking for designs.", .later = true),
    MT_F_LONG("positions", positions,
              "Positions of drives between the named ones, wherever a design was followed.",
              .later = true),
    MT_F_LONG("descriptions", descriptions,
              "Repeated analyses of the original design and of those recommended.",
              .later = true),
    MT_F_LONG("spread", weight_sensitivity, "The best design under other weights.",
              .later = true),
    MT_F_LONG("relaxations", relaxations, "What would let a design exist.", .later = true),
    MT_F_LONG("trade", trade, "All points of the trade study, whatever for.", .later = true),
    MT_F_LONG("multiplications", multiplications,
              "Of proofs by branch and bound and of tolerance boxes, about.", .later = true),
};
static const mt_record WORK_COUNTERS = MT_F_RECORD_OF(WORK_COUNTERS_FIELDS, NULL, NULL);
#undef THIS

#define THIS mt_result_override
static const char *const OVERRIDES[] = {"parameter", "search"};
static const mt_field OVERRIDE_FIELDS[] = {
    MT_F_CHOICE("kind", kind, OVERRIDES,
                "\"parameter\": of the model; \"search\": member of the study's \"search\"."),
    MT_F_TEXT("name", name, "Of the parameter or member."),
    MT_F_TEXT_OR_NULL("unit", unit, "SI unit of both values; null: none given."),
    SHOWN_FIELDS,
    MT_F_NUMBER("value", value, "What counted."),
    MT_F_NUMBER_OR_NULL("original", original, "What the files say; null: nothing."),
};
static const mt_record OVERRIDE = MT_F_RECORD_OF(OVERRIDE_FIELDS, NULL, "One of them.");
#undef THIS

#define THIS mt_result_step
static const mt_field STEP_FIELDS[] = {
    MT_F_COUNT(
        "objective", objective, 1,
        "Which of the study's objectives is made least, from 1; those before it are held."),
    MT_F_COUNT("round", round, 1,
               "From 1. A later one begins where designs that counted before turned out not to "
               "hold (over tolerances, between positions of a drive) or are judged more "
               "closely: its values may be worse."),
    MT_F_LONG("evaluations", evaluations, "Of designs, up to this one."),
    MT_F_NUMBER_OR_NULL("value", value,
                        "Of the objective, in its unit; null where the design has none."),
    MT_F_NUMBER_OR_NULL(
        "violation", violation,
        "The most that a goal is missed by, of its tolerance; null where that is not known.",
        .rules = "\"minimum\": 0"),
    MT_F_FLAG("feasible", feasible, "All goals are met: the violation is 1 or less."),
};
static const mt_record STEP =
    MT_F_RECORD_OF(STEP_FIELDS, NULL, "A design that was better than all before it.");
#undef THIS

#define THIS mt_result_run
static const char *const CAUSES[] = {"interrupt", "time limit"};
static const char *const PHASES[] = {"search",      "recommendations", "spread", "certificates",
                                     "relaxations", "published",       "trade"};
static const mt_field RUN_FIELDS[] = {
    MT_F_TEXT_OR_NULL("modetune", modetune_version, "Version."),
    MT_F_RECORD("build", build, mt_result_build, BUILD, "What it was made from."),
    MT_F_TEXT_OR_NULL("blas", blas, "BLAS library."),
    MT_F_TEXT_OR_NULL("nlopt", nlopt_version, "Version of NLopt."),
    MT_F_TEXT_OR_NULL("gsl", gsl_version, "Version of GSL."),
    MT_F_LONG("seed", seed, "Seed of the search."),
    MT_F_COUNT("starts", starts, 0, "Local searches made."),
    MT_F_COUNT_OR_NULL("distinct_designs", distinct_designs, 0,
                       "Distinct designs that they found; null for searches over mode "
                       "placements or catalogues."),
    MT_F_COUNT_OR_NULL("found_once", singletons, 0,
                       "Of them, those that one start only ended at."),
    MT_F_NUMBER_OR_NULL(
        "estimated_missing", estimated_unseen,
        "Where the targets leave isolated designs: how many more are to be expected at least, "
        "from what was found once and twice (Chao); else null.",
        .rules = "\"minimum\": 0"),
    MT_F_LIST(
        "history", history, n_history, mt_result_step, STEP,
        "How the search came to its designs: those that were better than all before them (one "
        "that meets all goals is better than one that does not, then the objective decides, of "
        "those that miss something what is missed), local search by local search in their "
        "fixed order, as if one worker had done all of it, and what it ended with; at most "
        "some hundred. The same for any number of workers, for a run in parts and for one that "
        "was resumed. Empty where nothing was searched or an interrupt cut the search.",
        .later = true),
    MT_F_LONG("evaluations", evaluations,
              "Evaluations of the model: of a design in all configurations, or of one more "
              "position of a drive."),
    MT_F_LONG(
        "modal_solutions", modal_solutions,
        "Modal solutions that the evaluations and the judgement of designs over tolerances "
        "took: of one configuration at one design, one position of a drive or one corner of "
        "the tolerances each. Not counted: what following named modes takes between designs, "
        "and proofs. The same for any number of workers, and for a run that was resumed.",
        .later = true),
    MT_F_RECORD("spent", spent, mt_result_work_counters, WORK_COUNTERS,
                "What evaluations were for; all but the last add up to \"evaluations\". The "
                "same for any number of workers, and for a run that was resumed.",
                .later = true),
    MT_F_CHOICES("incomplete", incomplete, n_incomplete, PHASES,
                 "Parts of the answer that an interrupt or the time limit cut, or that were "
                 "not begun because of it; empty where the run was not interrupted. They are "
                 "left out, but designs that were complete by then, and points of the trade "
                 "study, which have their own status."),
    MT_F_CHOICE_OR_NULL("cut_by", cut_by, CAUSES,
                        "What cut them: \"interrupt\" (a signal, or whoever asked the "
                        "library), \"time limit\" (--time); null: nothing did.",
                        .later = true),
    MT_F_LIST("overrides", overrides, n_overrides, mt_result_override, OVERRIDE,
              "Numbers that were asked for on the command line instead of what the files say "
              "(--set, --seed, --starts, --max-evaluations, --proof); the answer is that of "
              "files that say so.",
              .later = true),
    MT_F_LIST("inputs", inputs, n_inputs, mt_result_digest, INPUT, "Files read."),
    MT_F_LIST("outputs", outputs, n_outputs, mt_result_digest, OUTPUT,
              "Files written beside this one: a folder whose files are others is refused. "
              "Empty where the result stands alone (on standard output)."),
};
static const mt_record RUN =
    MT_F_RECORD_OF(RUN_FIELDS, "run", "What ran: no time, path or number of workers.");
#undef THIS

#define THIS                          mt_result_objective
#define OBJECTIVE_NAME(id, name, ...) #name,
static const char *const OBJECTIVE_TYPES[] = {MT_OBJECTIVE_LIST(OBJECTIVE_NAME)};
#undef OBJECTIVE_NAME
static const mt_field OBJECTIVE_FIELDS[] = {
    MT_F_CHOICE("type", type, OBJECTIVE_TYPES, "As the study calls it."),
    MT_F_TEXT("text", text, "The type, \"mass of bar*\", or the expression."),
    MT_F_TEXT_OR_NULL("unit", unit,
                      "Of its values; empty: none; null: that of the expression."),
};
static const mt_record OBJECTIVE =
    MT_F_RECORD_OF(OBJECTIVE_FIELDS, NULL, "An objective of the study.");
#undef THIS

#define THIS mt_result_source
static const mt_field SOURCE_FIELDS[] = {
    MT_F_TEXT_OR_NULL("name", name, "What the file calls itself."),
    MT_F_TEXT("file", file, "Where it is, relative to the study's folder."),
};
static const mt_record SOURCE = MT_F_RECORD_OF(SOURCE_FIELDS, "file", "A file that was read.");
#undef THIS

#define THIS mt_result_study
static const mt_field STUDY_FIELDS[] = {
    MT_F_TEXT_OR_NULL("name", name, "What the study calls itself."),
    MT_F_TEXT("file", file, "Its own file name, without folder."),
    MT_F_TEXT_OR_NULL("author", author, "Who asked, as the study says it.", .later = true),
    MT_F_TEXT_OR_NULL("revision", revision, "Issue of the question, as the study says it.",
                      .later = true),
    MT_F_TEXT_OR_NULL("date", date, "Date of the question, as the study says it.",
                      .later = true),
};
static const mt_record STUDY = MT_F_RECORD_OF(STUDY_FIELDS, NULL, NULL);
#undef THIS

#define THIS mt_result_assumption
static const mt_field ASSUMPTION_FIELDS[] = {
    MT_F_TEXT("parameter", parameter, "Its name in the model."),
    MT_F_TEXT_OR_NULL("unit", unit, "Of its value; null: none given."),
    SHOWN_FIELDS,
    MT_F_NUMBER("value", value, "As the model has it."),
    MT_F_TEXT_OR_NULL("source", source,
                      "Where the model says that it comes from; null: nowhere."),
    MT_F_FLAG("variable", variable, "The study may change it."),
};
static const mt_record ASSUMPTION =
    MT_F_RECORD_OF(ASSUMPTION_FIELDS, NULL, "An assumed value.");
#undef THIS

#define THIS mt_result
static const mt_field RESULT_FIELDS[] = {
    MT_F_FORMAT("format", "modetune-result/1", "Kind and version of this file."),
    MT_F_RECORD("study", study, mt_result_study, STUDY, "The question."),
    MT_F_RECORD("model", model, mt_result_source, SOURCE, NULL),
    MT_F_ENUM("status", status, mt_result_status, STATUSES,
              "\"solved\": every goal is met; \"fitted\": all goals are weighted, and the "
              "search converged to a least misfit; \"compromise\": the nearest that was found; "
              "\"infeasible\": proven impossible; \"interrupted\", \"time_limit\": the best so "
              "far, see run.incomplete; after the time limit a run goes on with --resume."),
    MT_F_TEXT_OR_NULL("status_text", status_text, "The status in one sentence."),
    MT_F_LIST("doubts", doubts, n_doubts, mt_warning, mt_warning_record,
              "Warnings: values of study and model that are allowed but suspicious. They stand "
              "before the answer and change no grade."),
    MT_F_LIST("facts", facts, n_facts, mt_warning, mt_warning_record,
              "What to know of the configurations that the goals name before reading any "
              "number: free motions, unstable directions, redundant joints, joints off their "
              "links, gaps that were closed."),
    MT_F_LIST("assumptions", assumptions, n_assumptions, mt_result_assumption, ASSUMPTION,
              "Parameters of the model whose origin is \"assumed\": the answer stands on them.",
              .later = true),
    MT_F_TEXTS("variables", variables, n_variables,
               "Names of the variables, in the study's order."),
    MT_F_LIST(
        "objectives", objectives, n_objectives, mt_result_objective, OBJECTIVE,
        "The objectives, in order of priority; each design has their values; empty: none."),
    MT_F_RECORD("baseline", baseline, mt_recommendation, mt_design_record,
                "The original design."),
    MT_F_LIST("recommendations", recommendations, n_recommendations, mt_recommendation,
              mt_design_record,
              "Designs, best first; of designs that are as good that of less change."),
    MT_F_LIST(
        "unchecked", unchecked, n_unchecked, mt_unchecked, UNCHECKED,
        "Designs of a search that was cut, best first, which there was no time to analyse "
        "again: nothing is verified of them, and none of them is a recommendation.",
        .later = true),
    MT_F_LIST_OR_NULL(
        "undetermined", unidentifiable, n_unidentifiable, mt_unidentifiable_direction,
        UNIDENTIFIABLE,
        "What the goals leave open; null: an interrupt came before it was known."),
    MT_F_LIST_OR_NULL("spread", weight_sensitivity, n_weight_sensitivity,
                      mt_result_weight_sensitivity, WEIGHT_SENSITIVITY,
                      "Where the best design moves when single weights of the misfit are "
                      "changed (a sensitivity to the weights, no uncertainty); empty where the "
                      "study does not ask; null: an interrupt cut it."),
    MT_F_LIST_OR_NULL("certificates", certificates, n_certificates, mt_certificate, CERTIFICATE,
                      "What is known of all designs; null: an interrupt cut the proofs."),
    MT_F_LIST_OR_NULL("relaxations", relaxations, n_relaxations, mt_relaxation, RELAXATION,
                      "What would let a design exist, one change of the question at a time, "
                      "least first, equal ones in the order of the question; empty where one "
                      "exists; null: an interrupt cut it."),
    MT_F_LIST(
        "excitations", excitations, n_excitations, mt_result_excitation, EXCITATION,
        "Rotors and machines that the goals avoid: the lines of their Campbell diagrams."),
    MT_F_LIST("curves", curves, n_curves, mt_result_curve, mt_curve_record,
              "Frequency responses that are shown of every design.", .later = true),
    MT_F_OPTION("trade", trade, mt_trade_result, TRADE,
                "The trade study; null: the study has none."),
    MT_F_LIST_OR_NULL("published", published, n_published, mt_result_published, PUBLISHED,
                      "Published against computed; null: an interrupt cut it."),
    MT_F_TEXTS("warnings", warnings, n_warnings, "In sentences."),
    MT_F_RECORD("run", run, mt_result_run, RUN, NULL),
};
const mt_record mt_result_record = MT_F_RECORD_OF(
    RESULT_FIELDS, NULL,
    "What a study answers. SI units; frequencies in Hz; null stands for \"not applicable\".");
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
