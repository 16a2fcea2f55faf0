/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/read_priv.h"

#include <string.h>

#include "io/synonyms.h"

#define OBJECTIVE_KEYS(X)                                       \
    X(OBJECTIVE_MINIMISE, "minimise", MT_KEY_TEXT, false)       \
    X(OBJECTIVE_MAXIMISE, "maximise", MT_KEY_TEXT, false)       \
    X(OBJECTIVE_OF, "of", MT_KEY_LIST, false)                   \
    X(OBJECTIVE_DESCRIPTION, "description", MT_KEY_TEXT, false) \
    X(OBJECTIVE_SOURCE, "source", MT_KEY_TEXT, false)
enum { OBJECTIVE_KEYS(MT_STUDY_KEY_ENUM) OBJECTIVE_KEY_COUNT };
static const mt_key KEYS[] = {OBJECTIVE_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_objective_keys = {"objective", KEYS, OBJECTIVE_KEY_COUNT};

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

static bool read_objective(mt_study_reader *s, mt_addr value, mt_objective *objective)
{
    mt_study_object o;
    if (!mt_read_study_object(s, value, &mt_study_objective_keys, &o)) {
        return false;
    }
    *objective = (mt_objective){.addr = value};
    const int sense = mt_read_study_one_of(s, &o, OBJECTIVE_MINIMISE, 2);
    if (sense == OBJECTIVE_MINIMISE) {
        read_minimise(s, o.found[OBJECTIVE_MINIMISE], objective);
    } else if (sense == OBJECTIVE_MAXIMISE) {
        read_maximise(s, o.found[OBJECTIVE_MAXIMISE], objective);
    }
    objective->of = mt_reader_refs(&s->r, o.found[OBJECTIVE_OF]);
    if (mt_read_study_has(s, &o, OBJECTIVE_OF) &&
        !mt_objective_is(objective->type, MT_OF_ITEMS)) {
        mt_diag_error(s->r.diags, mt_read_study_place(s, &o, OBJECTIVE_OF),
                      "\"of\" goes with the objective \"mass\"");
    }
    return sense != MT_ABSENT;
}

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
        study->n_objectives += read_objective(s, items.at, o) ? 1 : 0;
    }
}
