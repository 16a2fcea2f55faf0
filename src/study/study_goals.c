/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/study_priv.h"

mt_addr mt_check_goal_addr(const mt_study_check *c, const mt_goal *goal, mt_goal_slot slot)
{
    return mt_diag_member(c->diags, goal->addr,
                          mt_goal_member_name(mt_goal_kind_of(goal->type), slot));
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
    return MT_HAS(goal->number[slot]) || mt_check_goal_addr(c, goal, slot) != goal->addr;
}

/* Check the requirements of a goal of a kind with values: an equality excludes another one and
 * limits, limits must leave a range, and only an equality has a residual. */
static void check_requirements(mt_study_check *c, const mt_goal *goal, const mt_goal_kind *kind)
{
    const bool value = given(c, goal, MT_SLOT_EQUALS);
    const bool reference = goal->reference_name.addr != goal->addr;
    const bool least = given(c, goal, MT_SLOT_AT_LEAST);
    const bool most = given(c, goal, MT_SLOT_AT_MOST);
    const char *const equals = mt_goal_member_name(kind, MT_SLOT_EQUALS);
    /* the member that asks for a value, by its number or by a reference that gives it */
    const char *const equality = value       ? equals
                                 : reference ? mt_goal_member_name(kind, MT_SLOT_REFERENCE)
                                             : NULL;
    const char *const at_least = mt_goal_member_name(kind, MT_SLOT_AT_LEAST);
    const char *const at_most = mt_goal_member_name(kind, MT_SLOT_AT_MOST);
    const bool refers = mt_goal_member_at(kind, MT_SLOT_REFERENCE) >= 0;
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
        mt_diag_error(c->diags, mt_check_goal_addr(c, goal, MT_SLOT_AT_MOST),
                      "%s (%g) is not above %s (%g)", at_most, goal->at_most, at_least,
                      goal->at_least);
    }
    if (MT_HAS(goal->weight) && equality == NULL && (least || most)) {
        mt_diag_error(c->diags, mt_check_goal_addr(c, goal, MT_SLOT_WEIGHT),
                      "only a goal with \"%s\"%s can be part of the misfit", equals,
                      refers ? " or \"reference\"" : "");
    }
}

static void check_goal(mt_study_check *c, mt_goal *goal)
{
    const mt_goal_kind *const kind = mt_goal_kind_of(goal->type);
    const bool values = mt_goal_member_at(kind, MT_SLOT_EQUALS) >= 0;
    int index = 0;
    if (mt_goal_member_at(kind, MT_SLOT_CONFIGURATION) >= 0) {
        resolve_configurations(c, goal);
    }
    if (mt_goal_member_at(kind, MT_SLOT_BANDS) >= 0) {
        mt_study_check_avoid(c, goal);
    }
    if (mt_goal_member_at(kind, MT_SLOT_OUTPUT) >= 0) {
        mt_study_check_response_limit(c, goal);
    }
    if (mt_goal_member_at(kind, MT_SLOT_MODE) >= 0) {
        index = mt_check_mode(c, &goal->mode);
    }
    if (mt_goal_member_at(kind, MT_SLOT_REFERENCE) >= 0) {
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
