/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/study_priv.h"

#include "base/text.h"

static bool matches_item(const mt_model *m, const char *pattern)
{
    for (int i = 0; i < m->n_bodies; i++) {
        if (mt_text_matches(pattern, m->bodies[i].name.s)) {
            return true;
        }
    }
    for (int i = 0; i < m->n_links; i++) {
        if (mt_text_matches(pattern, m->links[i].name.s)) {
            return true;
        }
    }
    for (int i = 0; i < m->n_springs; i++) {
        if (m->springs[i].type == MT_SPRING_BAR &&
            mt_text_matches(pattern, m->springs[i].name.s)) {
            return true;
        }
    }
    for (int i = 0; i < m->n_joints; i++) {
        if (m->joints[i].mass != MT_ABSENT && mt_text_matches(pattern, m->joints[i].name.s)) {
            return true;
        }
    }
    return false;
}

static void check_objective(mt_study_check *c, int which)
{
    const mt_study *const s = c->study;
    const mt_objective *const o = &s->objectives[which];
    for (int k = 0; k < which; k++) {
        if (mt_objective_is(o->type, MT_WORD) && s->objectives[k].type == o->type) {
            mt_diag_error(c->diags, o->addr, "this objective is given twice");
            break;
        }
    }
    for (int i = 0; i < o->of.count; i++) {
        if (!matches_item(c->model, o->of.items[i].s)) {
            mt_diag_error(c->diags, o->of.items[i].addr,
                          "no body, link, bar or rod matches \"%s\"", o->of.items[i].s);
        }
    }
}

/* The objective that has these properties. */
static const mt_objective *find_objective(const mt_study *s, unsigned properties)
{
    for (int i = 0; i < s->n_objectives; i++) {
        if (mt_objective_is(s->objectives[i].type, properties)) {
            return &s->objectives[i];
        }
    }
    return NULL;
}

/* Weighted goals are residuals of the misfit: one needs the other. */
static void check_misfit(mt_study_check *c)
{
    const mt_study *const s = c->study;
    const mt_objective *const misfit = find_objective(s, MT_RESIDUALS);
    bool weighted = false;
    for (int i = 0; i < s->n_goals; i++) {
        const mt_goal *const goal = &s->goals[i];
        const mt_addr weight = mt_check_goal_addr(c, goal, "weight");
        if (!MT_HAS(goal->weight) && weight == goal->addr) {
            continue;
        }
        weighted = true;
        if (misfit == NULL && s->n_variables > 0) {
            mt_diag_error(c->diags, weight,
                          "a weighted goal needs \"objective\": {\"minimise\": \"misfit\"}");
        }
    }
    if (misfit != NULL && !weighted) {
        mt_diag_error(c->diags, misfit->addr, "the misfit needs a goal with \"weight\"");
    }
}

/* Only a misfit has weights to change, and a factor of 1 changes none. */
static void check_weight_sensitivity(mt_study_check *c)
{
    const mt_weight_sensitivity *const weight_sensitivity = &c->study->weight_sensitivity;
    if (weight_sensitivity->addr == MT_NO_ADDR) {
        return;
    }
    const bool first = c->study->n_objectives > 0 &&
                       mt_objective_is(c->study->objectives[0].type, MT_RESIDUALS);
    if (!first) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, weight_sensitivity->addr, "factor"),
                      "a spread needs \"objective\": {\"minimise\": \"misfit\"}");
    }
}

/* The vibration must be the first objective: one before it would be searched without the goals
 * that the vibration consists of. */
static void check_vibration(mt_study_check *c)
{
    const mt_study *const s = c->study;
    const mt_objective *const vibration = find_objective(s, MT_SHAKES);
    if (vibration != NULL && vibration != s->objectives) {
        mt_diag_error(c->diags, vibration->addr,
                      "the vibration is the first objective, or none");
    } else if (vibration != NULL && !mt_study_has_limits(s)) {
        mt_diag_error(c->diags, vibration->addr,
                      "the vibration needs a goal of type \"response\" or \"vibration\" with "
                      "\"at_most\" alone");
    }
}

void mt_study_check_objectives(mt_study_check *c)
{
    mt_study *const s = c->study;
    for (int i = 0; i < s->n_objectives; i++) {
        check_objective(c, i);
    }
    check_misfit(c);
    check_weight_sensitivity(c);
    check_vibration(c);
    const mt_objective *const clearance = find_objective(s, MT_BANDS);
    if (clearance != NULL && !mt_study_has_bands(s)) {
        mt_diag_error(c->diags, clearance->addr,
                      "the clearance needs a goal of type \"avoid\"");
    }
    if (s->n_objectives > 0 || s->n_variables == 0) {
        return;
    }
    mt_objective *const list =
        mt_arena_grow(&s->mem, s->objectives, 0, &s->cap_objectives, sizeof *list);
    if (list != NULL) {
        list[0] = (mt_objective){.type = MT_OBJECTIVE_CHANGE, .addr = MT_NO_ADDR};
        s->objectives = list;
        s->n_objectives = 1;
    }
}
