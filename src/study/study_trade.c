/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The trade study: what varies, over which values, and the two objectives of its front. */
#include "study/study_priv.h"

#include <string.h>

/* True where two varied quantities limit one number from its two sides. */
static bool opposite(const mt_vary *a, const mt_vary *b)
{
    if (a->kind != b->kind || a == b) {
        return false;
    }
    switch (a->kind) {
    case MT_VARY_BOUND:
        return a->upper != b->upper && a->name.s != NULL && b->name.s != NULL &&
               strcmp(a->name.s, b->name.s) == 0;
    case MT_VARY_GOAL:
        return a->goal == b->goal &&
               ((a->slot == MT_SLOT_AT_LEAST && b->slot == MT_SLOT_AT_MOST) ||
                (a->slot == MT_SLOT_AT_MOST && b->slot == MT_SLOT_AT_LEAST));
    case MT_VARY_PARAMETER:
        break;
    }
    return false;
}

/* The varied quantity on the other side; NULL: that side is fixed. */
static const mt_vary *other_side(const mt_study_check *c, const mt_vary *v)
{
    const mt_trade *const trade = &c->study->trade;
    for (int i = 0; i < trade->n_vary; i++) {
        if (opposite(v, &trade->vary[i])) {
            return &trade->vary[i];
        }
    }
    return NULL;
}

static const char *side_name(const mt_vary *v)
{
    return v->kind == MT_VARY_GOAL ? v->member : (v->upper ? "upper bound" : "lower bound");
}

/* Where both sides vary, every value of one must be compatible with every value of the
 * other. */
static void check_sides(mt_study_check *c, const mt_vary *v)
{
    const mt_vary *const other = other_side(c, v);
    if (other == NULL || other > v) {
        return; /* told at the second of them */
    }
    const bool lower = v->kind == MT_VARY_GOAL ? v->slot == MT_SLOT_AT_LEAST : !v->upper;
    const mt_unit *const shown = v->kind == MT_VARY_BOUND && v->variable != MT_ABSENT
                                     ? c->study->variables[v->variable].shown
                                     : NULL;
    for (int i = 0; i < v->n_values; i++) {
        for (int k = 0; k < other->n_values; k++) {
            const double low = lower ? v->values[i] : other->values[k];
            const double high = lower ? other->values[k] : v->values[i];
            if (!(low < high)) {
                mt_diag_error(c->diags, mt_diag_member(c->diags, v->addr, "values"),
                              "%s %g is not %s %s %g, which varies, too", side_name(v),
                              mt_unit_from_si(shown, v->values[i]), lower ? "below" : "above",
                              side_name(other), mt_unit_from_si(shown, other->values[k]));
                return;
            }
        }
    }
}

static void vary_bound(mt_study_check *c, mt_vary *v)
{
    mt_study *const s = c->study;
    for (int i = 0; i < s->n_variables && v->name.s != NULL; i++) {
        if (s->variables[i].parameter_name.s != NULL &&
            strcmp(s->variables[i].parameter_name.s, v->name.s) == 0) {
            v->variable = i;
        }
    }
    if (v->variable == MT_ABSENT) {
        if (v->name.s != NULL) {
            mt_diag_error(c->diags, v->name.addr, "\"%s\" is not a variable of the study",
                          v->name.s);
        }
        return;
    }
    const mt_variable *const variable = &s->variables[v->variable];
    if (variable->n_catalogue > 0) {
        mt_diag_error(c->diags, v->name.addr, "\"%s\" has a catalogue, not bounds", v->name.s);
        return;
    }
    const double other = v->upper ? variable->lower : variable->upper;
    for (int i = 0; i < v->n_values && other_side(c, v) == NULL; i++) {
        if (v->upper ? v->values[i] <= other : v->values[i] >= other) {
            mt_diag_error(c->diags, mt_diag_member(c->diags, v->addr, "values"),
                          "%s bound %g is not %s %s bound (%g)", v->upper ? "upper" : "lower",
                          mt_unit_from_si(variable->shown, v->values[i]),
                          v->upper ? "above the" : "below the", v->upper ? "lower" : "upper",
                          mt_unit_from_si(variable->shown, other));
        }
    }
}

/* The number of the goal that varies; MT_SLOT_NONE where the goal has none of this name, or no
 * number there to begin with. */
static mt_goal_slot slot_of(const mt_goal *goal, const char *name)
{
    const mt_goal_kind *const kind = mt_goal_kind_of(goal->type);
    for (int i = 0; i < MT_SLOT_NONE; i++) {
        const char *const member = mt_goal_member_name(kind, (mt_goal_slot)i);
        if (member != NULL && strcmp(member, name) == 0) {
            const bool none = i < MT_GOAL_NUMBERS && !MT_HAS(goal->number[i]);
            return none ? MT_SLOT_NONE : (mt_goal_slot)i;
        }
    }
    return MT_SLOT_NONE;
}

static void vary_goal(mt_study_check *c, const mt_vary *v)
{
    if (v->goal < 0 || v->goal >= c->study->n_goals || v->member == NULL) {
        return; /* noted by who filled the study */
    }
    const mt_goal *const goal = &c->study->goals[v->goal];
    if (v->slot == MT_SLOT_NONE) {
        mt_diag_error(c->diags, v->addr, "the goal has no \"%s\" that could vary", v->member);
        return;
    }
    const mt_key *const m = mt_goal_member(mt_goal_kind_of(goal->type), v->slot);
    for (int i = 0; i < v->n_values; i++) {
        /* limits on both sides must leave room, whichever of them varies; both: check_sides */
        const bool crosses = (v->slot == MT_SLOT_AT_LEAST && v->values[i] >= goal->at_most) ||
                             (v->slot == MT_SLOT_AT_MOST && v->values[i] <= goal->at_least);
        if (!mt_possible_is(&mt_possible_of[m->possible], v->values[i]) ||
            (crosses && other_side(c, v) == NULL)) {
            mt_diag_error(c->diags, mt_diag_member(c->diags, v->addr, "values"),
                          "%s cannot be %g", v->member, v->values[i]);
        }
    }
}

static void vary_parameter(mt_study_check *c, mt_vary *v)
{
    v->parameter = mt_check_parameter(c, v->name);
    mt_check_unset(c, v->name, v->parameter);
    for (int i = 0; i < c->study->n_variables; i++) {
        if (v->parameter != MT_ABSENT && c->study->variables[i].parameter == v->parameter) {
            mt_diag_error(c->diags, v->name.addr,
                          "\"%s\" is a variable: vary one of its bounds", v->name.s);
        }
    }
}

static void check_values(mt_study_check *c, const mt_vary *v)
{
    for (int i = 1; i < v->n_values; i++) {
        for (int k = 0; k < i; k++) {
            if (v->values[k] == v->values[i]) {
                mt_diag_error(c->diags, mt_diag_member(c->diags, v->addr, "values"),
                              "%.17g is listed twice", v->values[i]);
                return;
            }
        }
    }
}

static void check_vary(mt_study_check *c, mt_vary *v)
{
    mt_arena *const mem = &c->study->mem;
    check_values(c, v);
    check_sides(c, v);
    switch (v->kind) {
    case MT_VARY_BOUND:
        vary_bound(c, v);
        v->text = mt_arena_printf(mem, "%s bound of %s", v->upper ? "upper" : "lower",
                                  v->name.s == NULL ? "?" : v->name.s);
        break;
    case MT_VARY_GOAL:
        vary_goal(c, v);
        v->text = mt_arena_printf(mem, "%s of /goals/%d", v->member == NULL ? "?" : v->member,
                                  v->goal);
        break;
    case MT_VARY_PARAMETER:
        vary_parameter(c, v);
        v->text = v->name.s;
        break;
    }
}

static bool is_same_vary(const mt_vary *a, const mt_vary *b)
{
    return a->kind == b->kind && a->variable == b->variable && a->upper == b->upper &&
           a->parameter == b->parameter && a->goal == b->goal && a->slot == b->slot;
}

static bool has_objective(const mt_study *s, mt_objective_type type)
{
    for (int i = 0; i < s->n_objectives; i++) {
        if (s->objectives[i].type == type) {
            return true;
        }
    }
    return false;
}

static void check_front(mt_study_check *c)
{
    const mt_study *const s = c->study;
    const mt_trade *const trade = &s->trade;
    for (int i = 0; i < trade->n_objectives; i++) {
        const mt_objective_type type = trade->objectives[i];
        if (mt_objective_is(type, MT_BANDS) && !mt_study_has_bands(s)) {
            mt_diag_error(c->diags, mt_diag_member(c->diags, trade->addr, "objectives"),
                          "the clearance needs a goal of type \"avoid\"");
        } else if (mt_objective_is(type, MT_SHAKES) && !mt_study_has_limits(s)) {
            mt_diag_error(c->diags, mt_diag_member(c->diags, trade->addr, "objectives"),
                          "the vibration needs a goal of type \"response\" or \"vibration\" "
                          "with \"at_most\" alone");
        } else if (mt_objective_is(type, MT_OF_STUDY) && !has_objective(s, type)) {
            mt_diag_error(c->diags, mt_diag_member(c->diags, trade->addr, "objectives"),
                          "\"%s\" is not an objective of the study",
                          mt_objective_kind_of(type)->name);
        }
    }
    if (trade->n_objectives == 2 && trade->objectives[0] == trade->objectives[1]) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, trade->addr, "objectives"),
                      "the two objectives are the same");
    }
}

void mt_study_check_trade(mt_study_check *c)
{
    const mt_study *const s = c->study;
    mt_trade *const trade = &c->study->trade;
    double points = 1.0;
    if (trade->n_vary == 0) {
        return;
    }
    if (s->n_variables == 0) {
        mt_diag_error(c->diags, trade->addr, "a trade study needs variables");
    }
    for (int i = 0; i < trade->n_vary; i++) { /* before anything is compared */
        mt_vary *const v = &trade->vary[i];
        const bool known = v->goal >= 0 && v->goal < s->n_goals && v->member != NULL;
        v->slot = known ? slot_of(&s->goals[v->goal], v->member) : MT_SLOT_NONE;
    }
    for (int i = 0; i < trade->n_vary; i++) {
        check_vary(c, &trade->vary[i]);
        points *= (double)trade->vary[i].n_values;
    }
    if (trade->n_vary == 2 && is_same_vary(&trade->vary[0], &trade->vary[1])) {
        mt_diag_error(c->diags, trade->vary[1].addr, "both vary the same");
    }
    if (points > (double)MT_MAX_TRADE_POINTS) {
        mt_diag_error(c->diags, trade->addr, "%g points are more than %d", points,
                      MT_MAX_TRADE_POINTS);
    }
    check_front(c);
}
