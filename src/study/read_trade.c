/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "trade": what varies over which values, and the objectives of the Pareto front. */
#include "study/read_priv.h"

#include <string.h>

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
            "\"at_least\", \"target\", \"at_most\", \"equals\", \"margin_percent\"]"),
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

/* The numbers of goals of any kind that may vary, each name once. Returns how many. */
static int varying_members(const char **names)
{
    int n = 0;
    for (int i = 0; i < MT_GOAL_TYPE_COUNT; i++) {
        const mt_goal_kind *const kind = mt_goal_kind_of((mt_goal_type)i);
        for (int k = 0; k < MT_SLOT_NONE; k++) {
            const char *const name = mt_goal_member_name(kind, (mt_goal_slot)k);
            bool known = name == NULL;
            for (int j = 0; j < n && !known; j++) {
                known = strcmp(names[j], name) == 0;
            }
            if (!known) {
                names[n++] = name;
            }
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
