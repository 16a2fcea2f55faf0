/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The members of goals about modes and about expressions, and what goals have in common. Those
 * of bands to avoid are in avoid.c, those between ports in response_limit.c. */
#include "study/goals.h"
#include "study/reader.h"

/* Members that several kinds have */

void mt_goal_read_configurations(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_goal *const goal = &((mt_goal_parts *)item)->goal;
    if (key->type == MT_KEY_LIST) {
        (void)mt_reader_some_items(r, value, key->what);
        goal->configuration_names = mt_reader_refs(r, value);
        return;
    }
    mt_name *const name = mt_arena_alloc(r->mem, 1, sizeof *name);
    if (name != NULL) {
        *name = mt_reader_ref(r, value);
        goal->configuration_names = (mt_name_list){name->s == NULL ? 0 : 1, name};
    }
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
