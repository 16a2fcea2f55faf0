/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/read_priv.h"

#include <string.h>

#include "io/synonyms.h"

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
static void read_minimise(mt_study_reader *s, mt_addr value, mt_objective *o)
{
    o->type = MT_OBJECTIVE_EXPRESSION;
    if (value == MT_NO_ADDR) {
        return;
    }
    const char *const text = mt_json_string(s->r.doc, value);
    for (int i = 0; i < MT_OBJECTIVE_TYPE_COUNT; i++) {
        const mt_objective_type type = (mt_objective_type)i;
        const char *const name = mt_objective_kind_of(type)->name;
        if (!mt_objective_is(type, MT_WORD) || strcmp(text, name) != 0) {
            continue;
        }
        if (mt_objective_is(type, MT_MAXIMISED)) {
            mt_diag_error(s->r.diags, value, "a %s is maximised: {\"maximise\": \"%s\"}", name,
                          name);
        }
        o->type = mt_objective_is(type, MT_MAXIMISED) ? MT_OBJECTIVE_EXPRESSION : type;
        return;
    }
    if (!is_other_word(s, value, text)) {
        mt_read_study_expr(s, value, &o->expression, &o->expression_text);
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
    if (which == 0) {
        read_minimise(mt_study_reader_of(r), mt_object_value(o, "minimise"), objective);
    } else if (which == 1) {
        read_maximise(mt_study_reader_of(r), mt_object_value(o, "maximise"), objective);
    }
    if (mt_object_has(r, o, "of") && !mt_objective_is(objective->type, MT_OF_ITEMS)) {
        mt_diag_error(r->diags, mt_object_place(r, o, "of"),
                      "\"of\" goes with the objective \"mass\"");
    }
}

#define THIS mt_objective
static const mt_key OBJECTIVE[] = {
    MT_M_FREE(
        "minimise",
        "\"change\": the total change (no unit); \"mass\": of the items in \"of\", all where "
        "it is not given, in the configuration that the first goal names, with its overrides "
        "[kg]; \"misfit\": of the weighted goals (no unit); \"vibration\": the largest part of "
        "its limit that any goal of type \"response\" or \"vibration\" with at_most (and no "
        "at_least) takes [%]: these limits are the scale then, and no constraints; the first "
        "objective; anything else is an expression of parameters.",
        .examples = "[\"change\", \"mass\", \"misfit\", \"vibration\"]"),
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
