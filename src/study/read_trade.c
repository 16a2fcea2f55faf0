/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "trade": what varies over which values, and the objectives of the Pareto front. */
#include "study/read_priv.h"

#include <string.h>

#define TRADE_KEYS(X)                                       \
    X(TRADE_VARY, "vary", MT_KEY_LIST, true)                \
    X(TRADE_OBJECTIVES, "objectives", MT_KEY_LIST, false)   \
    X(TRADE_DESCRIPTION, "description", MT_KEY_TEXT, false) \
    X(TRADE_SOURCE, "source", MT_KEY_TEXT, false)
enum { TRADE_KEYS(MT_STUDY_KEY_ENUM) TRADE_KEY_COUNT };
static const mt_key TRADE[] = {TRADE_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_trade_keys = {"trade", TRADE, TRADE_KEY_COUNT};

#define VARY_KEYS(X)                                              \
    X(VARY_VARIABLE, "variable", MT_KEY_TEXT, false)              \
    X(VARY_GOAL, "goal", MT_KEY_COUNT, false, WHOLE)              \
    X(VARY_PARAMETER, "parameter", MT_KEY_TEXT, false)            \
    X(VARY_BOUND, "bound", MT_KEY_TEXT, false)                    \
    X(VARY_MEMBER, "member", MT_KEY_TEXT, false)                  \
    X(VARY_VALUES, "values", MT_KEY_LIST_OR_OBJECT, true, VARIED) \
    X(VARY_DESCRIPTION, "description", MT_KEY_TEXT, false)        \
    X(VARY_SOURCE, "source", MT_KEY_TEXT, false)
enum { VARY_KEYS(MT_STUDY_KEY_ENUM) VARY_KEY_COUNT };
static const mt_key VARY[] = {VARY_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_vary_keys = {"vary", VARY, VARY_KEY_COUNT};

#define SPAN_KEYS(X)                                  \
    X(SPAN_FROM, "from", MT_KEY_NUMBER, true, VARIED) \
    X(SPAN_TO, "to", MT_KEY_NUMBER, true, VARIED)     \
    X(SPAN_COUNT, "count", MT_KEY_COUNT, true, WHOLE)
enum { SPAN_KEYS(MT_STUDY_KEY_ENUM) SPAN_KEY_COUNT };
static const mt_key SPAN[] = {SPAN_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_span_keys = {"span", SPAN, SPAN_KEY_COUNT};

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
    mt_study_object o;
    if (!mt_read_study_object(s, value, &mt_study_span_keys, &o)) {
        return;
    }
    const double from = read_value(s, o.found[SPAN_FROM], v);
    const double to = read_value(s, o.found[SPAN_TO], v);
    const int n = mt_reader_count(&s->r, o.found[SPAN_COUNT], 2, MT_MAX_TRADE_POINTS, 0);
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
static void pair(mt_study_reader *s, const mt_study_object *o, int first, int second)
{
    const bool one = mt_read_study_has(s, o, first);
    const bool other = mt_read_study_has(s, o, second);
    if (one != other) {
        mt_diag_structure(s->r.diags, o->addr, "\"%s\" and \"%s\" go together",
                          o->table->keys[first].name, o->table->keys[second].name);
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
        for (int k = 0; k < kind->n; k++) {
            const mt_goal_member *const m = &kind->members[k];
            bool known = !mt_goal_may_vary(m);
            for (int j = 0; j < n && !known; j++) {
                known = strcmp(names[j], m->name) == 0;
            }
            if (!known) {
                names[n++] = m->name;
            }
        }
    }
    return n;
}

static void read_vary(mt_study_reader *s, mt_addr value, mt_addr goals, mt_vary *v)
{
    static const char *const bounds[] = {"lower", "upper"};
    const char *members[MT_GOAL_TYPE_COUNT * MT_MAX_KEYS];
    const int n_members = varying_members(members);
    mt_study_object o;
    *v = mt_vary_default(MT_VARY_PARAMETER, value);
    if (!mt_read_study_object(s, value, &mt_study_vary_keys, &o)) {
        return;
    }
    const int which = mt_read_study_one_of(s, &o, VARY_VARIABLE, 3);
    pair(s, &o, VARY_VARIABLE, VARY_BOUND);
    pair(s, &o, VARY_GOAL, VARY_MEMBER);
    const int bound =
        mt_reader_choice(&s->r, o.found[VARY_BOUND], "bound", bounds, MT_COUNT(bounds));
    const int member =
        mt_reader_choice(&s->r, o.found[VARY_MEMBER], "member", members, n_members);
    v->kind = which == VARY_VARIABLE ? MT_VARY_BOUND
              : which == VARY_GOAL   ? MT_VARY_GOAL
                                     : MT_VARY_PARAMETER;
    v->name = mt_reader_ref(&s->r, which == VARY_VARIABLE ? o.found[VARY_VARIABLE]
                                                          : o.found[VARY_PARAMETER]);
    v->upper = bound == 1;
    v->member = member == MT_ABSENT ? NULL : members[member];
    v->goal = goal_of(s, o.found[VARY_GOAL], goals);
    read_values(s, o.found[VARY_VALUES], v);
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
    mt_study_object o;
    if (value == MT_NO_ADDR || !mt_read_study_object(s, value, &mt_study_trade_keys, &o)) {
        return;
    }
    trade->addr = value;
    read_front(s, o.found[TRADE_OBJECTIVES], trade);
    const mt_addr list = o.found[TRADE_VARY];
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
