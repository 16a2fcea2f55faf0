/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The trade study: what varies, over which values, and the two objectives of its front. */
#include "study/trade.h"

#include <string.h>

#include "study/check.h"
#include "study/reader.h"

static const mt_key SPAN[] = {
    MT_M_JUST("from", NUMBER, true, VARIED, "The first."),
    MT_M_JUST("to", NUMBER, true, VARIED, "The last."),
    MT_M_JUST("count", COUNT, true, WHOLE, "How many, both included.",
              .schema = "\"type\": \"integer\", \"minimum\": 2, \"maximum\": 10000"),
};
const mt_key_table mt_study_span_keys = {
    .what = "span", .keys = SPAN, .n = MT_COUNT(SPAN), .says = "Values at equal distances."};

static const char *const BOUNDS[] = {"lower", "upper"};

/* The first three say what varies, in the order of mt_vary_kind. */
static const mt_key VARY[] = {
    MT_M_JUST("variable", TEXT, false, NONE, "A variable of the study; goes with \"bound\"."),
    MT_M_JUST("goal", COUNT, false, WHOLE,
              "A goal of the study, counted from 0; goes with \"member\".",
              .schema = "\"type\": \"integer\", \"minimum\": 0, \"maximum\": 100000"),
    MT_M_JUST("parameter", TEXT, false, NONE,
              "A parameter of the model that is not a variable."),
    {.name = "bound",
     .type = MT_KEY_TEXT,
     .choices = BOUNDS,
     .n_choices = MT_COUNT(BOUNDS),
     .says = "Which bound of the variable varies."},
    MT_M_JUST(
        "member", TEXT, false, NONE,
        "Which number of the goal varies. \"margin_percent\" replaces every margin of the "
        "goal, its rotors' too.",
        .schema =
            "\"type\": \"string\", \"enum\": [\"target_hz\", \"at_least_hz\", \"at_most_hz\", "
            "\"at_least\", \"target\", \"at_most\", \"equals\", \"margin_percent\", "
            "\"at_least_percent\", \"at_most_percent\"]"),
    MT_M_JUST("values", LIST_OR_OBJECT, true, VARIED,
              "The values, in the unit of what varies: a list, or a span.",
              .schema = "\"if\": {\"type\": \"array\"}, \"then\": {\"minItems\": 1, \"items\": "
                        "{\"$ref\": \"#/definitions/number\"}}, \"else\": {\"$ref\": "
                        "\"#/definitions/span\"}, \"type\": [\"array\", \"object\"]"),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
const mt_key_table mt_study_vary_keys = {
    .what = "vary",
    .keys = VARY,
    .n = MT_COUNT(VARY),
    .one_of = 3,
    .says =
        "A quantity that varies: a bound of a variable, a number of a goal, or a parameter.",
    .examples = "[{\"variable\": \"M_SAU\", \"bound\": \"upper\", \"values\": {\"from\": 5, "
                "\"to\": 10, \"count\": 11}}]",
    .rules = "\"dependencies\": {\"variable\": [\"bound\"], \"bound\": [\"variable\"], "
             "\"goal\": [\"member\"], \"member\": [\"goal\"]}"};

static const mt_key TRADE[] = {
    {.name = "vary",
     .type = MT_KEY_LIST,
     .required = true,
     .of = &mt_study_vary_keys,
     .least = 1,
     .most = MT_MAX_VARY,
     .says = "What varies: one quantity, or two in all pairs (at most 10000 points)."},
    MT_M_JUST("objectives", LIST, false, NONE,
              "Two objectives between which the Pareto front of all points is reported.",
              .examples = "[[\"change\", \"clearance\"]]",
              .schema = "\"type\": \"array\", \"minItems\": 2, \"maxItems\": 2, \"items\": "
                        "{\"type\": \"string\", \"enum\": [\"change\", \"mass\", \"misfit\", "
                        "\"clearance\", \"vibration\"]}"),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
const mt_key_table mt_study_trade_keys = {
    .what = "trade",
    .keys = TRADE,
    .n = MT_COUNT(TRADE),
    .says = "A trade study: one or two quantities take each of their values, and every such "
            "study is answered by its best design."};

mt_vary mt_vary_default(mt_vary_kind kind, mt_addr addr)
{
    return (mt_vary){
        .kind = kind,
        .variable = MT_ABSENT,
        .parameter = MT_ABSENT,
        .goal = MT_ABSENT,
        .addr = addr,
    };
}

/* One value of what varies: of a parameter, in its unit, or of a goal, whose expression may be
 * held against it. */
static double read_value(mt_study_reader *s, mt_addr value, const mt_vary *v)
{
    if (v->kind == MT_VARY_GOAL && v->goal != MT_ABSENT) {
        mt_read_study_check_requirement(s, &s->study->goals[v->goal].expression, value);
    }
    return v->kind == MT_VARY_GOAL ? mt_read_study_number(s, value)
                                   : mt_read_study_value(s, value, v->name.s);
}

static void read_span(mt_study_reader *s, mt_addr value, mt_vary *v)
{
    mt_object o;
    if (!mt_object_match(&s->r, value, &mt_study_span_keys, &o)) {
        return;
    }
    const double from = read_value(s, mt_object_value(&o, "from"), v);
    const double to = read_value(s, mt_object_value(&o, "to"), v);
    const int n =
        mt_reader_count(&s->r, mt_object_value(&o, "count"), 2, MT_MAX_TRADE_POINTS, 0);
    if (n < 2 || !MT_HAS(from) || !MT_HAS(to)) {
        return;
    }
    v->values = mt_arena_f64(&s->study->mem, (size_t)n, 1);
    if (v->values == NULL) {
        return;
    }
    v->n_values = n;
    for (int i = 0; i < n; i++) {
        const double fraction = (double)i / (double)(n - 1);
        v->values[i] = i == n - 1 ? to : from + fraction * (to - from);
    }
}

static void read_values(mt_study_reader *s, mt_addr value, mt_vary *v)
{
    if (value == MT_NO_ADDR) {
        return;
    }
    if (mt_json_type_of(s->r.doc, value) == MT_JSON_OBJECT) {
        read_span(s, value, v);
        return;
    }
    mt_items items = mt_reader_some_items(&s->r, value, "the list of values");
    v->values = mt_reader_room(&s->r, &items, sizeof *v->values);
    while (mt_items_next(&items)) {
        const double number = read_value(s, items.at, v);
        if (MT_HAS(number)) {
            v->values[v->n_values++] = number;
        }
    }
}

/* Two members that come together: a variable and its bound, a goal and its number. */
static void pair(mt_study_reader *s, const mt_object *o, const char *first, const char *second)
{
    if (mt_object_has(&s->r, o, first) != mt_object_has(&s->r, o, second)) {
        mt_diag_structure(s->r.diags, o->addr, "\"%s\" and \"%s\" go together", first, second);
    }
}

/* The goal that is item `index` of the file's list, as position in the study's; MT_ABSENT where
 * there is none (noted) or it is wrong. */
static int goal_of(mt_study_reader *s, mt_addr value, mt_addr goals)
{
    const int index = mt_reader_count(&s->r, value, 0, MT_MAX_LIST, MT_ABSENT);
    if (index == MT_ABSENT) {
        return MT_ABSENT;
    }
    mt_items items = mt_reader_items(&s->r, goals);
    if (index >= items.count) {
        mt_diag_error(s->r.diags, value, "there is no goal %d (the first is 0)", index);
        return MT_ABSENT;
    }
    for (int i = 0; i <= index; i++) {
        (void)mt_items_next(&items);
    }
    for (int i = 0; i < s->study->n_goals; i++) {
        if (s->study->goals[i].addr == items.at) {
            return i;
        }
    }
    return MT_ABSENT;
}

static bool is_listed(const char *const *names, int n, const char *name)
{
    for (int i = 0; i < n; i++) {
        if (strcmp(names[i], name) == 0) {
            return true;
        }
    }
    return false;
}

/* The numbers of goals of any kind that may vary, each name once. Returns how many. */
static int varying_members(const char **names)
{
    int n = 0;
    for (int i = 0; i < MT_GOAL_TYPE_COUNT * MT_SLOT_NONE; i++) {
        const mt_goal_kind *const kind = mt_goal_kind_of((mt_goal_type)(i / MT_SLOT_NONE));
        const char *const name = mt_goal_member_name(kind, (mt_goal_slot)(i % MT_SLOT_NONE));
        if (name != NULL && !is_listed(names, n, name)) {
            names[n++] = name;
        }
    }
    return n;
}

static void read_vary(mt_study_reader *s, mt_addr value, mt_addr goals, mt_vary *v)
{
    const char *members[MT_GOAL_TYPE_COUNT * MT_SLOT_NONE];
    const int n_members = varying_members(members);
    mt_object o;
    *v = mt_vary_default(MT_VARY_PARAMETER, value);
    if (!mt_object_match(&s->r, value, &mt_study_vary_keys, &o)) {
        return;
    }
    const int which = mt_object_one_of(&s->r, &o, "variable", 3);
    pair(s, &o, "variable", "bound");
    pair(s, &o, "goal", "member");
    const int bound = mt_reader_choice(&s->r, mt_object_value(&o, "bound"), "bound", BOUNDS,
                                       MT_COUNT(BOUNDS));
    const int member =
        mt_reader_choice(&s->r, mt_object_value(&o, "member"), "member", members, n_members);
    v->kind = which == MT_VARY_BOUND  ? MT_VARY_BOUND
              : which == MT_VARY_GOAL ? MT_VARY_GOAL
                                      : MT_VARY_PARAMETER;
    v->name = mt_reader_ref(&s->r, which == MT_VARY_BOUND ? mt_object_value(&o, "variable")
                                                          : mt_object_value(&o, "parameter"));
    v->upper = bound == 1;
    v->member = member == MT_ABSENT ? NULL : members[member];
    v->goal = goal_of(s, mt_object_value(&o, "goal"), goals);
    read_values(s, mt_object_value(&o, "values"), v);
}

static void read_front(mt_study_reader *s, mt_addr list, mt_trade *trade)
{
    mt_objective_type types[MT_OBJECTIVE_TYPE_COUNT];
    const char *names[MT_OBJECTIVE_TYPE_COUNT];
    const int n = mt_objectives_with(MT_FRONT, types, names);
    if (list == MT_NO_ADDR) {
        return;
    }
    mt_items items = mt_reader_items(&s->r, list);
    if (items.count != MT_COUNT(trade->objectives)) {
        mt_diag_structure(s->r.diags, list, "a front is between two objectives");
        return;
    }
    while (mt_items_next(&items)) {
        const int which = mt_reader_choice(&s->r, items.at, "objective", names, n);
        if (which != MT_ABSENT) {
            trade->objectives[trade->n_objectives++] = types[which];
        }
    }
}

void mt_read_study_trade(mt_study_reader *s, mt_addr value, mt_addr goals)
{
    mt_trade *const trade = &s->study->trade;
    mt_object o;
    if (value == MT_NO_ADDR || !mt_object_match(&s->r, value, &mt_study_trade_keys, &o)) {
        return;
    }
    trade->addr = value;
    read_front(s, mt_object_value(&o, "objectives"), trade);
    const mt_addr list = mt_object_value(&o, "vary");
    mt_items items = mt_reader_items(&s->r, list);
    if (list != MT_NO_ADDR && (items.count < 1 || items.count > MT_MAX_VARY)) {
        mt_diag_structure(s->r.diags, list, "one or two quantities can vary, not %d",
                          items.count);
        return;
    }
    while (mt_items_next(&items)) {
        if (mt_reader_type(&s->r, items.at, MT_KEY_OBJECT)) {
            read_vary(s, items.at, goals, &trade->vary[trade->n_vary++]);
        }
    }
}

/* Checks */

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
            const mt_goal_slot slot =
                i == MT_SLOT_AT_LEAST_HZ ? MT_SLOT_AT_LEAST : (mt_goal_slot)i;
            const bool none =
                slot < MT_GOAL_NUMBERS && (!MT_HAS(goal->number[slot]) ||
                                           strcmp(mt_goal_number_name(goal, slot), name) != 0);
            return none ? MT_SLOT_NONE : slot;
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
