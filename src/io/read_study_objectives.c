/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/read_study_priv.h"

#include <string.h>

#define OBJECTIVE_KEYS(X)                                       \
    X(OBJECTIVE_MINIMISE, "minimise", MT_KEY_TEXT, false)       \
    X(OBJECTIVE_MAXIMISE, "maximise", MT_KEY_TEXT, false)       \
    X(OBJECTIVE_OF, "of", MT_KEY_LIST, false)                   \
    X(OBJECTIVE_DESCRIPTION, "description", MT_KEY_TEXT, false) \
    X(OBJECTIVE_SOURCE, "source", MT_KEY_TEXT, false)
enum { OBJECTIVE_KEYS(MT_STUDY_KEY_ENUM) OBJECTIVE_KEY_COUNT };
static const mt_key KEYS[] = {OBJECTIVE_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_objective_keys = {"objective", KEYS, OBJECTIVE_KEY_COUNT};

/* What is minimised: one of these words, else an expression of parameters. */
static void read_minimise(mt_study_reader *s, mt_addr value, mt_objective *o)
{
    static const struct {
        const char *name;
        mt_objective_type type;
    } words[] = {
        {"change", MT_OBJECTIVE_CHANGE},
        {"mass", MT_OBJECTIVE_MASS},
        {"misfit", MT_OBJECTIVE_MISFIT},
    };
    o->type = MT_OBJECTIVE_EXPRESSION;
    if (value == MT_NO_ADDR) {
        return;
    }
    const char *const text = mt_json_string(s->r.doc, value);
    for (int i = 0; i < MT_COUNT(words); i++) {
        if (strcmp(text, words[i].name) == 0) {
            o->type = words[i].type;
            return;
        }
    }
    if (strcmp(text, "clearance") == 0) {
        mt_diag_error(s->r.diags, value,
                      "a clearance is maximised: {\"maximise\": \"clearance\"}");
    } else {
        mt_read_study_expr(s, value, &o->expression, &o->expression_text);
    }
}

static bool read_objective(mt_study_reader *s, mt_addr value, mt_objective *objective)
{
    static const char *const maximised[] = {"clearance"};
    mt_study_object o;
    if (!mt_read_study_object(s, value, &mt_study_objective_keys, &o)) {
        return false;
    }
    *objective = (mt_objective){.addr = value};
    const int sense = mt_read_study_one_of(s, &o, OBJECTIVE_MINIMISE, 2);
    if (sense == OBJECTIVE_MINIMISE) {
        read_minimise(s, o.found[OBJECTIVE_MINIMISE], objective);
    } else if (sense == OBJECTIVE_MAXIMISE) {
        const int choice = mt_reader_choice(&s->r, o.found[OBJECTIVE_MAXIMISE], "objective",
                                            maximised, MT_COUNT(maximised));
        objective->type = choice == MT_ABSENT ? MT_OBJECTIVE_NONE : MT_OBJECTIVE_CLEARANCE;
    }
    objective->of = mt_reader_refs(&s->r, o.found[OBJECTIVE_OF]);
    if (mt_read_study_has(s, &o, OBJECTIVE_OF) && objective->type != MT_OBJECTIVE_MASS) {
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
