/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Goals: their kinds, how they are read, and what is wrong with them. */
#include "study/goals.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "study/check.h"
#include "study/reader.h"

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
        [MT_SLOT_AT_LEAST_HZ] = offsetof(mt_goal_parts, goal.at_least_hz),
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

const char *mt_goal_number_name(const mt_goal *goal, mt_goal_slot slot)
{
    const bool in_hz = slot == MT_SLOT_AT_LEAST && MT_HAS(goal->at_least_hz);
    return mt_goal_member_name(mt_goal_kind_of(goal->type), in_hz ? MT_SLOT_AT_LEAST_HZ : slot);
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

bool mt_goal_is_most(const mt_goal *goal)
{
    return goal->energy != NULL && goal->energy->most;
}

int mt_goal_directions(const mt_goal *goal)
{
    return goal->energy != NULL && goal->energy->n_directions > 1 ? goal->energy->n_directions
                                                                  : 1;
}

bool mt_study_has_bands(const mt_study *study)
{
    for (int g = 0; g < study->n_goals; g++) {
        if (study->goals[g].avoid != NULL) {
            return true;
        }
    }
    return false;
}

bool mt_study_has_limits(const mt_study *study)
{
    for (int g = 0; g < study->n_goals; g++) {
        if (mt_goal_is_limit(&study->goals[g])) {
            return true;
        }
    }
    return false;
}

const char *mt_study_goal_unit(const mt_study *study, const mt_goal *goal)
{
    const mt_unit *const other = mt_study_requirement_unit(study, &goal->expression);
    if (goal->response_limit != NULL) {
        return goal->response_limit->unit;
    }
    if (goal->static_limit != NULL) {
        return goal->static_limit->unit;
    }
    if (MT_HAS(goal->at_least_hz)) {
        return "Hz";
    }
    return other != NULL ? other->si : mt_goal_kind_of(goal->type)->unit;
}

/* Reading */

/* Every optional member is "not given" (NaN, MT_ABSENT) or its default. */
static mt_goal new_goal(mt_goal_type type, mt_addr addr)
{
    return (mt_goal){
        .type = type,
        .mode = {.named = MT_ABSENT},
        .of = {.configuration = MT_ABSENT, .mode = {.named = MT_ABSENT}},
        .at_least_hz = nan(""),
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
        mt_goal_parts parts = {.goal = new_goal((mt_goal_type)type, items.at),
                               .energy = mt_energy_goal_default()};
        if (mt_members_read(&s->r, items.at, KINDS[type].members, &parts)) {
            study->goals[study->n_goals++] = parts.goal;
        }
    }
}

/* Checks */

/* The address of a member of the goal; the goal's own where it has none, or its kind knows
 * none. */
static mt_addr goal_addr(const mt_study_check *c, const mt_goal *goal, const char *member)
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
    return MT_HAS(goal->number[slot]) || goal_addr(c, goal, member) != goal->addr;
}

/* Check the requirements of a goal of a kind with values: an equality excludes another one and
 * limits, limits must leave a range, and only an equality has a residual. */
static void check_requirements(mt_study_check *c, const mt_goal *goal, const mt_goal_kind *kind)
{
    const bool value = given(c, goal, MT_SLOT_EQUALS);
    const bool refers = mt_goal_has(kind, "reference");
    const bool reference =
        goal->reference_name.s != NULL || goal_addr(c, goal, "reference") != goal->addr;
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
        mt_diag_error(c->diags, goal_addr(c, goal, at_most), "%s (%g) is not above %s (%g)",
                      at_most, goal->at_most, at_least, goal->at_least);
    }
    if (MT_HAS(goal->weight) && equality == NULL && (least || most)) {
        mt_diag_error(c->diags, goal_addr(c, goal, "weight"),
                      "only a goal with \"%s\"%s can be part of the misfit", equals,
                      refers ? " or \"reference\"" : "");
    }
}

static bool is_same_mode(const mt_mode_ref *a, const mt_mode_ref *b)
{
    return a->mode_name.s != NULL && b->mode_name.s != NULL
               ? strcmp(a->mode_name.s, b->mode_name.s) == 0
               : a->index > 0 && a->index == b->index;
}

/* The mode that a ratio is divided by. */
static void check_of(mt_study_check *c, mt_goal *goal)
{
    mt_goal_of *const of = &goal->of;
    (void)mt_check_mode(c, &of->mode);
    of->configuration = mt_check_configuration(c, c->model, of->configuration_name);
    for (int i = 0; i < goal->n_configurations; i++) {
        const bool same =
            of->configuration_name.s == NULL || of->configuration == goal->configurations[i];
        if (same && is_same_mode(&goal->mode, &of->mode)) {
            mt_diag_error(c->diags, goal_addr(c, goal, "of"),
                          "the ratio of a frequency to itself is 1 whatever the design: name "
                          "another mode or another configuration");
            return;
        }
    }
}

/* The modes that are to be apart: indices ascend, names occur once. */
static void check_modes(mt_study_check *c, mt_goal *goal)
{
    const mt_addr at = goal_addr(c, goal, "modes");
    for (int i = 0; i < goal->n_modes; i++) {
        mt_mode_ref *const mode = &goal->modes[i];
        (void)mt_check_mode(c, mode);
        for (int k = 0; k < i; k++) {
            const mt_mode_ref *const before = &goal->modes[k];
            if (is_same_mode(before, mode) && mode->index == 0) {
                mt_diag_error(c->diags, at, "mode \"%s\" is named twice", mode->mode_name.s);
            } else if (before->index > 0 && mode->index > 0 && before->index >= mode->index) {
                mt_diag_error(c->diags, at, "mode %d comes after mode %d: indices must ascend",
                              mode->index, before->index);
                return;
            }
        }
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
    if (goal->energy != NULL) {
        mt_study_check_energy(c, goal);
    }
    if (mt_goal_has(kind, "mode") && !mt_goal_is_most(goal)) {
        index = mt_check_mode(c, &goal->mode);
    }
    if (mt_goal_has(kind, "of")) {
        check_of(c, goal);
    }
    if (mt_goal_has(kind, "modes")) {
        check_modes(c, goal);
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
