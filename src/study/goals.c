/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Goals: the members of each kind, how they are read, and what is wrong with them. */
#include "study/goals.h"

#include "study/read_priv.h"
#include "study/study_priv.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Kinds */

#define KIND(id, name, unit, measure) \
    {#name, unit, MT_MEASURE_##measure, &mt_goal_##name##_keys},
static const mt_goal_kind KINDS[] = {MT_GOAL_LIST(KIND)};
#undef KIND

const mt_goal_kind *mt_goal_kind_of(mt_goal_type type)
{
    return &KINDS[type];
}

bool mt_goal_has(const mt_goal_kind *kind, const char *member)
{
    for (int i = 0; i < kind->members->n; i++) {
        if (strcmp(kind->members->keys[i].name, member) == 0) {
            return true;
        }
    }
    return false;
}

const mt_key *mt_goal_member(const mt_goal_kind *kind, mt_goal_slot slot)
{
    static const size_t places[MT_SLOT_NONE] = {
        [MT_SLOT_EQUALS] = offsetof(mt_goal_parts, goal.equals),
        [MT_SLOT_AT_LEAST] = offsetof(mt_goal_parts, goal.at_least),
        [MT_SLOT_AT_MOST] = offsetof(mt_goal_parts, goal.at_most),
        [MT_SLOT_MARGIN] = offsetof(mt_goal_parts, avoid.source.margin_percent),
    };
    for (int i = 0; i < kind->members->n; i++) {
        const mt_key *const key = &kind->members->keys[i];
        if (key->read != NULL && key->at == places[slot]) {
            return key;
        }
    }
    return NULL;
}

const char *mt_goal_member_name(const mt_goal_kind *kind, mt_goal_slot slot)
{
    const mt_key *const key = mt_goal_member(kind, slot);
    return key == NULL ? NULL : key->name;
}

double mt_measure_unit(mt_goal_measure measure, double asked)
{
    return measure == MT_MEASURE_PART && fabs(asked) > 0.0 ? fabs(asked) : 1.0;
}

double mt_goal_tolerance(const mt_goal *goal)
{
    return goal->tolerance_percent / 100.0;
}

bool mt_goal_is_limit(const mt_goal *goal)
{
    return goal->response_limit != NULL && MT_HAS(goal->at_most) && !MT_HAS(goal->at_least);
}

/* Members that several kinds have */

void mt_goal_read_configurations(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_goal *const goal = &((mt_goal_parts *)item)->goal;
    if (mt_json_member(r->doc, goal->addr, "configuration") != MT_NO_ADDR &&
        mt_json_member(r->doc, goal->addr, "configurations") != MT_NO_ADDR) {
        return; /* mt_goal_finish notes it */
    }
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

void mt_goal_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_goal *const goal = &((mt_goal_parts *)item)->goal;
    (void)which;
    goal->tolerance_given = mt_object_has(r, o, "tolerance_percent");
    if (mt_object_has(r, o, "configuration") && mt_object_has(r, o, "configurations")) {
        (void)mt_object_one_of(r, o, "configuration", 2);
    }
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
    (void)which;
    goal->tolerance_given = mt_object_has(r, o, "tolerance_percent");
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

/* Reading */

/* Every optional member is "not given" (NaN, MT_ABSENT) or its default. */
static mt_goal new_goal(mt_goal_type type, mt_addr addr)
{
    return (mt_goal){
        .type = type,
        .mode = {.named = MT_ABSENT},
        .equals = nan(""),
        .at_least = nan(""),
        .at_most = nan(""),
        .tolerance_percent = MT_DEFAULT_TOLERANCE_PERCENT,
        .weight = nan(""),
        .length = nan(""),
        .reference_name = {.addr = addr},
        .reference = MT_ABSENT,
        .addr = addr,
    };
}

/* The kind of goal that an object says it is; MT_ABSENT (noted) where it says none. */
static int type_of(mt_reader *r, mt_addr value)
{
    const char *names[MT_GOAL_TYPE_COUNT];
    for (int i = 0; i < MT_GOAL_TYPE_COUNT; i++) {
        names[i] = KINDS[i].name;
    }
    if (!mt_reader_type(r, value, MT_KEY_OBJECT)) {
        return MT_ABSENT;
    }
    const mt_addr type = mt_json_member(r->doc, value, "type");
    if (type == MT_NO_ADDR) {
        mt_diag_structure(r->diags, value, "member \"type\" is missing");
    }
    return mt_reader_choice(r, type, "type of goal", names, MT_GOAL_TYPE_COUNT);
}

void mt_read_study_goals(mt_study_reader *s, mt_addr list)
{
    mt_study *const study = s->study;
    mt_items items = mt_reader_items(&s->r, list);
    study->goals = mt_reader_room(&s->r, &items, sizeof *study->goals);
    while (mt_items_next(&items)) {
        const int type = type_of(&s->r, items.at);
        if (type == MT_ABSENT) {
            continue;
        }
        mt_goal_parts parts = {.goal = new_goal((mt_goal_type)type, items.at)};
        if (mt_members_read(&s->r, items.at, KINDS[type].members, &parts)) {
            study->goals[study->n_goals++] = parts.goal;
        }
    }
}

/* Checks */

mt_addr mt_check_goal_addr(const mt_study_check *c, const mt_goal *goal, const char *member)
{
    const bool known = member != NULL && mt_goal_has(mt_goal_kind_of(goal->type), member);
    return mt_diag_member(c->diags, goal->addr, known ? member : NULL);
}

static void resolve_configurations(mt_study_check *c, mt_goal *goal)
{
    const mt_name_list *const names = &goal->configuration_names;
    const int n = names->count > 0 ? names->count : 1;
    goal->configurations = mt_arena_int(&c->study->mem, (size_t)n);
    if (goal->configurations == NULL) {
        return;
    }
    goal->n_configurations = n;
    if (names->count == 0) {
        const bool wrong = /* which has been noted */
            mt_diag_member(c->diags, goal->addr, "configuration") != goal->addr ||
            mt_diag_member(c->diags, goal->addr, "configurations") != goal->addr;
        goal->configurations[0] =
            wrong ? MT_ABSENT : mt_check_only_configuration(c, c->model, goal->addr);
        return;
    }
    for (int i = 0; i < n; i++) {
        const int found = mt_check_configuration(c, c->model, names->items[i]);
        for (int k = 0; k < i && found != MT_ABSENT; k++) {
            if (goal->configurations[k] == found) {
                mt_diag_error(c->diags, names->items[i].addr, "\"%s\" is named already",
                              names->items[i].s);
            }
        }
        goal->configurations[i] = found;
    }
}

static bool given(const mt_study_check *c, const mt_goal *goal, mt_goal_slot slot)
{
    const char *const member = mt_goal_member_name(mt_goal_kind_of(goal->type), slot);
    return MT_HAS(goal->number[slot]) || mt_check_goal_addr(c, goal, member) != goal->addr;
}

/* Check the requirements of a goal of a kind with values: an equality excludes another one and
 * limits, limits must leave a range, and only an equality has a residual. */
static void check_requirements(mt_study_check *c, const mt_goal *goal, const mt_goal_kind *kind)
{
    const bool value = given(c, goal, MT_SLOT_EQUALS);
    const bool refers = mt_goal_has(kind, "reference");
    const bool reference = goal->reference_name.s != NULL ||
                           mt_check_goal_addr(c, goal, "reference") != goal->addr;
    const bool least = given(c, goal, MT_SLOT_AT_LEAST);
    const bool most = given(c, goal, MT_SLOT_AT_MOST);
    const char *const equals = mt_goal_member_name(kind, MT_SLOT_EQUALS);
    /* the member that asks for a value, by its number or by a reference that gives it */
    const char *const equality = value ? equals : reference ? "reference" : NULL;
    const char *const at_least = mt_goal_member_name(kind, MT_SLOT_AT_LEAST);
    const char *const at_most = mt_goal_member_name(kind, MT_SLOT_AT_MOST);
    if (value && reference) {
        mt_diag_error(c->diags, goal->addr, "\"%s\" excludes \"reference\"", equals);
    }
    if (equality != NULL && (least || most)) {
        mt_diag_error(c->diags, goal->addr, "\"%s\" excludes \"%s\"", equality,
                      least ? at_least : at_most);
    } else if (equality == NULL && !least && !most) {
        mt_diag_error(c->diags, goal->addr,
                      "the goal demands nothing: give \"%s\", %s\"%s\" or \"%s\"", equals,
                      refers ? "\"reference\", " : "", at_least, at_most);
    }
    if (goal->at_least >= goal->at_most) {
        mt_diag_error(c->diags, mt_check_goal_addr(c, goal, at_most),
                      "%s (%g) is not above %s (%g)", at_most, goal->at_most, at_least,
                      goal->at_least);
    }
    if (MT_HAS(goal->weight) && equality == NULL && (least || most)) {
        mt_diag_error(c->diags, mt_check_goal_addr(c, goal, "weight"),
                      "only a goal with \"%s\"%s can be part of the misfit", equals,
                      refers ? " or \"reference\"" : "");
    }
}

static void check_goal(mt_study_check *c, mt_goal *goal)
{
    const mt_goal_kind *const kind = mt_goal_kind_of(goal->type);
    const bool values = mt_goal_member(kind, MT_SLOT_EQUALS) != NULL;
    int index = 0;
    if (mt_goal_has(kind, "configuration")) {
        resolve_configurations(c, goal);
    }
    if (mt_goal_has(kind, "bands_hz")) {
        mt_study_check_avoid(c, goal);
    }
    if (mt_goal_has(kind, "output")) {
        mt_study_check_response_limit(c, goal);
    }
    if (mt_goal_has(kind, "mode")) {
        index = mt_check_mode(c, &goal->mode);
    }
    if (mt_goal_has(kind, "reference")) {
        /* it gives a value, where the goal can ask for one, else a shape */
        goal->reference = mt_check_reference(c, goal->reference_name);
        mt_check_reference_mode(c, goal->reference, goal->reference_mode, index, !values,
                                goal->addr);
        if (!values) {
            mt_check_common_sensors(c, goal->reference, goal->reference_name.addr);
        }
    }
    if (values) {
        check_requirements(c, goal, kind);
    }
}

void mt_study_check_goals(mt_study_check *c)
{
    for (int i = 0; i < c->study->n_goals; i++) {
        check_goal(c, &c->study->goals[i]);
    }
}
