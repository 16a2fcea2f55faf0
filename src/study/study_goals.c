/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/study_check.h"

static void resolve_configurations(mt_study_check *c, mt_goal *goal)
{
    const mt_name_list *const names = &goal->configuration_names;
    const int n = names->count > 0 ? names->count : 1;
    goal->configurations = mt_arena_int(&c->study->mem, (size_t)n);
    if (goal->configurations == NULL) {
        c->out_of_memory = true;
        return;
    }
    goal->n_configurations = n;
    if (names->count == 0) {
        goal->configurations[0] = goal->configurations_addr == goal->addr
                                      ? mt_check_only_configuration(c, c->model, goal->addr)
                                      : MT_ABSENT; /* a wrong member has been noted */
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

typedef struct demands {
    const char *equal; /* the member that asks for a value; NULL: none does */
    bool at_least;
    bool at_most;
} demands;

/* An equality excludes limits, limits must leave room. `choices` names the members that ask for
 * a value. */
static void check_demands(mt_study_check *c, const mt_goal *goal, demands d,
                          const char *choices, const char *unit)
{
    if (d.equal != NULL && (d.at_least || d.at_most)) {
        mt_diag_error(c->diags, goal->addr, "\"%s\" excludes \"%s%s\"", d.equal,
                      d.at_least ? "at_least" : "at_most", unit);
    } else if (d.equal == NULL && !d.at_least && !d.at_most) {
        mt_diag_error(c->diags, goal->addr,
                      "the goal demands nothing: give %s, \"at_least%s\" or \"at_most%s\"",
                      choices, unit, unit);
    }
    if (goal->at_least >= goal->at_most) {
        mt_diag_error(c->diags, goal->at_most_addr,
                      "at_most%s (%g) is not above at_least%s (%g)", unit, goal->at_most, unit,
                      goal->at_least);
    }
}

static demands demands_of(const mt_goal *goal)
{
    const char *equal = NULL;
    if (goal->type == MT_GOAL_LIMIT) {
        equal = mt_check_given(goal->equals, goal->equals_addr, goal->addr) ? "equals" : NULL;
    } else if (mt_check_given(goal->target_hz, goal->target_addr, goal->addr)) {
        equal = "target_hz";
    } else if (goal->reference_name.addr != goal->addr) {
        equal = "reference";
    }
    return (demands){
        .equal = equal,
        .at_least = mt_check_given(goal->at_least, goal->at_least_addr, goal->addr),
        .at_most = mt_check_given(goal->at_most, goal->at_most_addr, goal->addr),
    };
}

static void check_frequency(mt_study_check *c, mt_goal *goal, int index)
{
    const demands d = demands_of(goal);
    const bool target = mt_check_given(goal->target_hz, goal->target_addr, goal->addr);
    goal->reference = mt_check_reference(c, goal->reference_name);
    mt_check_reference_mode(c, goal->reference, goal->reference_mode, index, false, goal->addr);
    if (target && goal->reference_name.addr != goal->addr) {
        mt_diag_error(c->diags, goal->addr, "\"target_hz\" excludes \"reference\"");
    }
    mt_check_positive(c, goal->target_hz, goal->target_addr, "target_hz");
    mt_check_positive(c, goal->at_least, goal->at_least_addr, "at_least_hz");
    mt_check_positive(c, goal->at_most, goal->at_most_addr, "at_most_hz");
    check_demands(c, goal, d, "\"target_hz\", \"reference\"", "_hz");
    if (MT_HAS(goal->weight) && d.equal == NULL && (d.at_least || d.at_most)) {
        mt_diag_error(
            c->diags, goal->weight_addr,
            "only a goal with \"target_hz\" or \"reference\" can be part of the misfit");
    }
}

static void check_compared(mt_study_check *c, mt_goal *goal, int index)
{
    goal->reference = mt_check_reference(c, goal->reference_name);
    mt_check_reference_mode(c, goal->reference, goal->reference_mode, index, true, goal->addr);
    mt_check_common_sensors(c, goal->reference, goal->reference_name.addr);
    if (goal->type == MT_GOAL_MAC && (goal->at_least <= 0.0 || goal->at_least > 1.0)) {
        mt_diag_error(c->diags, goal->at_least_addr,
                      "at_least (%g) must be above 0 and at most 1", goal->at_least);
    }
}

static void check_goal(mt_study_check *c, mt_goal *goal)
{
    mt_check_positive(c, goal->tolerance_percent, goal->tolerance_addr, "tolerance_percent");
    mt_check_positive(c, goal->weight, goal->weight_addr, "weight");
    if (goal->type == MT_GOAL_LIMIT) {
        check_demands(c, goal, demands_of(goal), "\"equals\"", "");
        return;
    }
    resolve_configurations(c, goal);
    if (goal->type == MT_GOAL_AVOID) {
        mt_study_check_avoid(c, goal);
        return;
    }
    const int index = mt_check_mode(c, &goal->mode);
    if (goal->type == MT_GOAL_FREQUENCY) {
        check_frequency(c, goal, index);
    } else if (goal->type == MT_GOAL_SHAPE || goal->type == MT_GOAL_MAC) {
        check_compared(c, goal, index);
    }
}

void mt_study_check_goals(mt_study_check *c)
{
    for (int i = 0; i < c->study->n_goals; i++) {
        check_goal(c, &c->study->goals[i]);
    }
}
