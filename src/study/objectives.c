/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Objectives: their kinds, how they are read, and what they need of the goals. */
#include "study/objectives.h"

#include <string.h>

#include "base/text.h"
#include "io/synonyms.h"
#include "study/check.h"
#include "study/reader.h"

/* Kinds */

#define KIND(id, name, unit, properties) {#name, unit, properties},
static const mt_objective_kind KINDS[] = {MT_OBJECTIVE_LIST(KIND)};

const mt_objective_kind *mt_objective_kind_of(mt_objective_type type)
{
    return &KINDS[type];
}

bool mt_objective_is(mt_objective_type type, unsigned properties)
{
    return (KINDS[type].properties & properties) == properties;
}

int mt_objectives_with(unsigned properties, mt_objective_type *types, const char **names)
{
    int n = 0;
    for (int i = 0; i < MT_OBJECTIVE_TYPE_COUNT; i++) {
        if (mt_objective_is((mt_objective_type)i, properties)) {
            types[n] = (mt_objective_type)i;
            names[n++] = KINDS[i].name;
        }
    }
    return n;
}

bool mt_study_is_scale(const mt_study *study, const mt_goal *goal)
{
    const bool shakes =
        study->n_objectives > 0 && mt_objective_is(study->objectives[0].type, MT_SHAKES);
    return shakes && mt_goal_is_limit(goal);
}

bool mt_study_is_fit(const mt_study *study)
{
    bool fit = study->n_goals > 0 && study->n_objectives > 0 &&
               mt_objective_is(study->objectives[0].type, MT_RESIDUALS);
    for (int i = 0; i < study->n_goals; i++) {
        fit = fit && MT_HAS(study->goals[i].weight);
    }
    return fit;
}

/* Reading */

/* True where it is another word for one of the objectives ("weight"), and no parameter.
 * Noted. */
static bool is_other_word(mt_study_reader *s, mt_addr value, const char *text)
{
    mt_objective_type types[MT_OBJECTIVE_TYPE_COUNT];
    const char *names[MT_OBJECTIVE_TYPE_COUNT];
    const mt_model *const m = s->study->model;
    const int n = mt_objectives_with(MT_WORD, types, names);
    const char *const meant = mt_synonym(text, names, n);
    if (meant == NULL || (m != NULL && mt_model_find_parameter(m, text) != MT_ABSENT)) {
        return false;
    }
    mt_diag_error(s->r.diags, value, "unknown name \"%s\"; did you mean \"%s\"?", text, meant);
    return true;
}

/* What is minimised: the word of an objective, else an expression of parameters. */
static void read_minimise(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_objective *const o = item;
    if (mt_json_member(r->doc, o->addr, "maximise") != MT_NO_ADDR) {
        return; /* one of them is too many, which is noted */
    }
    o->type = MT_OBJECTIVE_EXPRESSION;
    const char *const text = mt_json_string(r->doc, value);
    for (int i = 0; i < MT_OBJECTIVE_TYPE_COUNT; i++) {
        const mt_objective_type type = (mt_objective_type)i;
        const char *const name = mt_objective_kind_of(type)->name;
        if (!mt_objective_is(type, MT_WORD) || strcmp(text, name) != 0) {
            continue;
        }
        if (mt_objective_is(type, MT_MAXIMISED)) {
            mt_diag_error(r->diags, value, "a %s is maximised: {\"maximise\": \"%s\"}", name,
                          name);
        }
        o->type = mt_objective_is(type, MT_MAXIMISED) ? MT_OBJECTIVE_EXPRESSION : type;
        return;
    }
    if (!is_other_word(mt_study_reader_of(r), value, text)) {
        mt_study_expr(r, key, value, item);
    }
}

/* Read what is maximised: one of the words. */
static void read_maximise(mt_study_reader *s, mt_addr value, mt_objective *o)
{
    mt_objective_type types[MT_OBJECTIVE_TYPE_COUNT];
    const char *names[MT_OBJECTIVE_TYPE_COUNT];
    const int n = mt_objectives_with(MT_WORD | MT_MAXIMISED, types, names);
    const int choice = mt_reader_choice(&s->r, value, "objective", names, n);
    o->type = choice == MT_ABSENT ? MT_OBJECTIVE_NONE : types[choice];
}

static void objective_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    *(mt_objective *)item = (mt_objective){.addr = addr};
}

static void objective_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_objective *const objective = item;
    if (which == 1) {
        read_maximise(mt_study_reader_of(r), mt_object_value(o, "maximise"), objective);
    }
    if (mt_object_has(r, o, "of") && !mt_objective_is(objective->type, MT_OF_ITEMS)) {
        mt_diag_error(r->diags, mt_object_place(r, o, "of"),
                      "\"of\" goes with the objective \"mass\"");
    }
}

#define THIS mt_objective
static const mt_key OBJECTIVE[] = {
    {.name = "minimise",
     .type = MT_KEY_TEXT,
     MT_M_TO(read_minimise, mt_expr, expression),
     .other = MT_M_PLACE(const char *, expression_text),
     .says =
         "\"change\": the total change (no unit); \"mass\": of the items in \"of\", all where "
         "it is not given, in the configuration that the first goal names, with its overrides "
         "[kg]; \"misfit\": of the weighted goals (no unit); \"vibration\": the largest part "
         "of "
         "its limit that any goal of type \"response\" or \"vibration\" with at_most (and no "
         "at_least) takes [%]: these limits are the scale then, and no constraints; the first "
         "objective; anything else is an expression of parameters.",
     .examples = "[\"change\", \"mass\", \"misfit\", \"vibration\"]"},
    {.name = "maximise",
     .type = MT_KEY_TEXT,
     .says = "\"clearance\": the least distance of a mode from a forbidden band with its "
             "margin, the greater of the two frequencies over the smaller less 1 [%].",
     .schema = "\"type\": \"string\", \"enum\": [\"clearance\"]"},
    MT_M_REFS("of", of,
              "Names of bodies, links and bars whose mass counts; * stands for any characters, "
              "? for one. Absent: all."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_study_objective_keys = {
    .what = "objective",
    .keys = OBJECTIVE,
    .n = MT_COUNT(OBJECTIVE),
    .one_of = 2,
    .size = sizeof(mt_objective),
    .defaults = objective_defaults,
    .finish = objective_finish,
    .says = "What decides between designs that meet the goals."};

void mt_read_study_objectives(mt_study_reader *s, mt_addr value)
{
    mt_study *const study = s->study;
    mt_items items = mt_reader_one_or_items(&s->r, value);
    if (value != MT_NO_ADDR && items.count == 0) {
        mt_diag_structure(s->r.diags, value, "the list of objectives is empty");
    }
    study->objectives = mt_reader_room(&s->r, &items, sizeof *study->objectives);
    while (mt_items_next(&items)) {
        mt_objective *const o = &study->objectives[study->n_objectives];
        study->n_objectives +=
            mt_members_read(&s->r, items.at, &mt_study_objective_keys, o) ? 1 : 0;
    }
}

/* Checks */

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
        const bool takes_weight = mt_goal_has(mt_goal_kind_of(goal->type), "weight");
        const mt_addr weight =
            mt_diag_member(c->diags, goal->addr, takes_weight ? "weight" : NULL);
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
