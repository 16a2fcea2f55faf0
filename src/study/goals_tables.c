/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The members of goals about modes and about expressions, and what goals have in common. Those
 * of bands to avoid are in avoid.c, those between ports in response_limit.c. */
#include "study/goals.h"
#include "study/reader.h"

/* Members that several kinds have */

void mt_goal_read_configurations(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    ((mt_goal_parts *)item)->goal.configuration_names = mt_reader_one_or_refs(r, key, value);
}

void mt_goal_check(mt_reader *r, mt_object *o)
{
    if (mt_object_has(r, o, "configuration") && mt_object_has(r, o, "configurations")) {
        (void)mt_object_one_of(r, o, "configuration", 2);
        mt_object_leave_out(o, "configuration", 2);
    }
}

void mt_goal_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    (void)which;
    ((mt_goal_parts *)item)->goal.tolerance_given = mt_object_has(r, o, "tolerance_percent");
}

#define THIS           mt_goal_parts
#define MODE_ROW(says) MT_S_MODE("mode", goal.mode, says)
#define REFERENCE_MODE_ROW                            \
    MT_S_INDEX("reference_mode", goal.reference_mode, \
               "Mode of the reference. Absent: the same index as \"mode\".")
#define REFERENCE_ROWS                                                                        \
    MT_M_REF("reference", true, goal.reference_name,                                          \
             "Name of one of the study's references."),                                       \
        REFERENCE_MODE_ROW,                                                                   \
        MT_S_NUMBER("length_m", false, goal.length, POSITIVE,                                 \
                    "Where sensors of displacements and of rotations are compared together: " \
                    "the length [m] at which a rotation counts as its arc, above 0. Absent: " \
                    "the model's length, with a warning.")

/* "frequency" */

static const mt_key FREQUENCY[] = {
    MT_GOAL_ROWS(MT_GOAL_TOLERANCE),
    MT_GOAL_CONFIGURATION_ROWS,
    MODE_ROW("Which mode: index from 1 or name."),
    MT_S_NUMBER("target_hz", false, goal.equals, ASKED,
                "Wanted frequency [Hz]; excludes the limits."),
    MT_M_REF("reference", false, goal.reference_name,
             "Name of one of the study's references: the wanted frequency is that of its mode. "
             "Excludes \"target_hz\" and the limits."),
    REFERENCE_MODE_ROW,
    MT_S_NUMBER("at_least_hz", false, goal.at_least, ASKED, "Lower limit [Hz]."),
    MT_S_NUMBER("at_most_hz", false, goal.at_most, ASKED, "Upper limit [Hz]."),
    MT_S_NUMBER("weight", false, goal.weight, POSITIVE,
                "With a weight the goal is a residual of the objective \"misfit\", "
                "ln(frequency/target), instead of a constraint."),
};

static void frequency_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_goal_finish(r, o, which, item);
    if (mt_object_has(r, o, "reference_mode") && !mt_object_has(r, o, "reference")) {
        mt_diag_structure(r->diags, mt_object_place(r, o, "reference_mode"),
                          "\"reference_mode\" goes with \"reference\"");
    }
}

const mt_key_table mt_goal_frequency_keys = {
    .what = "goal_frequency",
    .keys = FREQUENCY,
    .n = MT_COUNT(FREQUENCY),
    .check = mt_goal_check,
    .finish = frequency_finish,
    .says =
        "A natural frequency: equal to a target or to that of a reference, or within limits.",
    .rules =
        "\"dependencies\": {\"reference_mode\": [\"reference\"]}, " MT_GOAL_ONE_OR_SEVERAL};

/* "shape", "mac" */

static const mt_key SHAPE[] = {
    MT_GOAL_ROWS(MT_GOAL_TOLERANCE),
    MT_GOAL_CONFIGURATION_ROWS,
    MODE_ROW("Which mode: index from 1 or name."),
    REFERENCE_ROWS,
    MT_S_NUMBER("weight", true, goal.weight, POSITIVE,
                "Weight of the residuals (no unit), above 0."),
};
const mt_key_table mt_goal_shape_keys = {
    .what = "goal_shape",
    .keys = SHAPE,
    .n = MT_COUNT(SHAPE),
    .check = mt_goal_check,
    .finish = mt_goal_finish,
    .says = "A mode shape close to a reference's: a residual of the objective \"misfit\" "
            "(difference of unit vectors at the common sensors).",
    .rules = MT_GOAL_ONE_OR_SEVERAL};

static const mt_key MAC[] = {
    MT_GOAL_ROWS(MT_GOAL_TOLERANCE),
    MT_GOAL_CONFIGURATION_ROWS,
    MODE_ROW("Which mode: index from 1 or name."),
    REFERENCE_ROWS,
    MT_S_NUMBER("at_least", true, goal.at_least, SHARE, "Least MAC, above 0 and at most 1."),
};
const mt_key_table mt_goal_mac_keys = {
    .what = "goal_mac",
    .keys = MAC,
    .n = MT_COUNT(MAC),
    .check = mt_goal_check,
    .finish = mt_goal_finish,
    .says = "A modal assurance criterion with a reference's shape.",
    .rules = MT_GOAL_ONE_OR_SEVERAL};

/* "damping" */

static const mt_key DAMPING[] = {
    MT_GOAL_ROWS(MT_GOAL_TOLERANCE),
    MT_GOAL_CONFIGURATION_ROWS,
    MODE_ROW("Which mode: index from 1 of those that oscillate with damping, by their natural "
             "frequency, or name: the one with most of that mode in its shape."),
    MT_S_NUMBER("target", false, goal.equals, SHARE,
                "Wanted ratio, above 0 and at most 1; excludes the limits."),
    MT_S_NUMBER("at_least", false, goal.at_least, SHARE, "Least ratio, above 0 and at most 1."),
    MT_S_NUMBER("at_most", false, goal.at_most, SHARE,
                "Greatest ratio, above 0 and at most 1."),
    MT_S_NUMBER("weight", false, goal.weight, POSITIVE,
                "With a weight the goal is a residual of the objective \"misfit\", (ratio - "
                "target)/target, instead of a constraint."),
};
const mt_key_table mt_goal_damping_keys = {
    .what = "goal_damping",
    .keys = DAMPING,
    .n = MT_COUNT(DAMPING),
    .check = mt_goal_check,
    .finish = mt_goal_finish,
    .says = "The damping ratio of a complex mode: at a target, or within limits. No proof "
            "covers it.",
    .rules = MT_GOAL_ONE_OR_SEVERAL};

/* "ratio" */

static const mt_key OF[] = {
    MT_S_MODE("mode", goal.of.mode, "Which mode: index from 1 or name."),
    MT_M_REF("configuration", false, goal.of.configuration_name,
             "Configuration of the model that it is taken in. Absent: that of the goal."),
};
const mt_key_table mt_study_goal_of_keys = {
    .what = "goal_of",
    .keys = OF,
    .n = MT_COUNT(OF),
    .says = "The mode whose frequency a ratio is divided by."};

static const mt_key RATIO[] = {
    MT_GOAL_ROWS(MT_GOAL_TOLERANCE),
    MT_GOAL_CONFIGURATION_ROWS,
    MODE_ROW("Whose frequency: index from 1 or name."),
    {.name = "of",
     .type = MT_KEY_OBJECT,
     .required = true,
     .read = mt_read_inner,
     .of = &mt_study_goal_of_keys},
    MT_S_NUMBER("target", false, goal.equals, POSITIVE,
                "Wanted ratio, above 0; excludes the limits."),
    MT_S_NUMBER("at_least", false, goal.at_least, POSITIVE, "Least ratio, above 0."),
    MT_S_NUMBER("at_most", false, goal.at_most, POSITIVE, "Greatest ratio, above 0."),
    MT_S_NUMBER("weight", false, goal.weight, POSITIVE,
                "With a weight the goal is a residual of the objective \"misfit\", "
                "ln(ratio/target), instead of a constraint."),
};
const mt_key_table mt_goal_ratio_keys = {
    .what = "goal_ratio",
    .keys = RATIO,
    .n = MT_COUNT(RATIO),
    .check = mt_goal_check,
    .finish = mt_goal_finish,
    .says = "The frequency of a mode divided by that of another mode, or of a mode in another "
            "configuration: at a target, or within limits.",
    .rules = MT_GOAL_ONE_OR_SEVERAL};

/* "apart" */

static void read_modes(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_goal *const goal = &((mt_goal_parts *)item)->goal;
    mt_items items = mt_reader_items(r, value);
    (void)key;
    if (value != MT_NO_ADDR && items.count < 2) {
        mt_diag_structure(r->diags, value, "must name at least two modes");
    }
    goal->modes = mt_reader_room(r, &items, sizeof *goal->modes);
    while (mt_items_next(&items)) {
        const mt_key one = {.type = MT_KEY_TEXT_OR_COUNT};
        mt_mode_ref *const mode = &goal->modes[goal->n_modes];
        *mode = (mt_mode_ref){.named = MT_ABSENT};
        if (mt_reader_type(r, items.at, MT_KEY_TEXT_OR_COUNT)) {
            mt_study_mode(r, &one, items.at, mode);
            goal->n_modes++;
        }
    }
}

/* Neighbouring modes that one goal keeps apart. */
enum { MT_MAX_APART = 1000 };

static const mt_key APART[] = {
    MT_GOAL_ROWS(MT_GOAL_TOLERANCE),
    MT_GOAL_CONFIGURATION_ROWS,
    {.name = "modes",
     .type = MT_KEY_LIST,
     MT_M_ROW(WHOLE),
     MT_M_TO(read_modes, mt_mode_ref *, goal.modes),
     .says = "Two modes or more, by ascending index from 1 or by name: each is apart from the "
             "one before it in this list.",
     .examples = "[[1, 2]]",
     .schema = "\"type\": \"array\", \"minItems\": 2, \"items\": {\"$ref\": "
               "\"#/definitions/mode\"}"},
    MT_M_COUNT("up_to_mode", false, goal.up_to_mode, 2, MT_MAX_APART,
               "All neighbouring modes from the first to this index are apart, instead of "
               "\"modes\"."),
    MT_S_NUMBER("at_least_percent", false, goal.at_least, POSITIVE,
                "The higher frequency exceeds the lower one by at least this, in percent of "
                "the lower one."),
    MT_S_NUMBER("at_least_hz", false, goal.at_least_hz, POSITIVE,
                "The two frequencies differ by at least this [Hz]."),
};

static void apart_check(mt_reader *r, mt_object *o)
{
    mt_goal_check(r, o);
    (void)mt_object_one_of(r, o, "modes", 2);
    (void)mt_object_one_of(r, o, "at_least_percent", 2);
}

/* A distance in Hz is the goal's number; all neighbours are the list of modes. */
static void apart_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_goal *const goal = &((mt_goal_parts *)item)->goal;
    mt_goal_finish(r, o, which, item);
    goal->at_least = MT_HAS(goal->at_least_hz) ? goal->at_least_hz : goal->at_least;
    if (goal->up_to_mode > 1 && goal->n_modes == 0) {
        goal->modes = mt_arena_alloc(r->mem, (size_t)goal->up_to_mode, sizeof *goal->modes);
        goal->n_modes = goal->modes == NULL ? 0 : goal->up_to_mode;
    }
    for (int i = 0; i < goal->n_modes && goal->up_to_mode > 1; i++) {
        goal->modes[i] = (mt_mode_ref){.index = i + 1, .named = MT_ABSENT};
    }
}

const mt_key_table mt_goal_apart_keys = {
    .what = "goal_apart",
    .keys = APART,
    .n = MT_COUNT(APART),
    .check = apart_check,
    .finish = apart_finish,
    .says = "Modes of one configuration whose frequencies are apart.",
    .rules = "\"allOf\": [{\"oneOf\": [{\"required\": [\"modes\"]}, {\"required\": "
             "[\"up_to_mode\"]}]}, {\"oneOf\": [{\"required\": [\"at_least_percent\"]}, "
             "{\"required\": [\"at_least_hz\"]}]}], " MT_GOAL_ONE_OR_SEVERAL};

/* "limit" */

static const mt_key LIMIT[] = {
    MT_GOAL_ROWS("The goal is met within this, in percent of the demand; of a demand of 0 in "
                 "percent of what the expression changes by at the original design where "
                 "every variable changes by 1 in its coordinate (a logarithm by a factor of "
                 "e), whatever the units."),
    MT_S_EXPR("expression", true, goal.expression, goal.expression_text,
              "Expression of the model's parameters, evaluated at every design.",
              .examples = "[\"M_SAU + m_crank\"]"),
    MT_S_NUMBER("at_least", false, goal.at_least, LIMIT,
                "Lower limit, in the unit of the expression."),
    MT_S_NUMBER("at_most", false, goal.at_most, LIMIT,
                "Upper limit, in the unit of the expression."),
    MT_S_NUMBER("equals", false, goal.equals, ANY,
                "Wanted value, in the unit of the expression; excludes the limits."),
};
#undef THIS

static void limit_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    static const char *const held_against[] = {"equals", "at_least", "at_most"};
    mt_goal *const goal = &((mt_goal_parts *)item)->goal;
    mt_goal_finish(r, o, which, item);
    for (int i = 0; i < MT_COUNT(held_against); i++) {
        mt_read_study_check_requirement(mt_study_reader_of(r), &goal->expression,
                                        mt_object_value(o, held_against[i]));
    }
}

const mt_key_table mt_goal_limit_keys = {.what = "goal_limit",
                                         .keys = LIMIT,
                                         .n = MT_COUNT(LIMIT),
                                         .finish = limit_finish,
                                         .says = "A limit on an expression of the parameters."};
