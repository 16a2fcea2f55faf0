/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune info: what files hold that are not models: their kind and format, who wrote them,
 * what is in them as one list of items, the files that they name, and what is odd. */
#include "cli/file_info.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/base.h"
#include "cli/cli.h"
#include "io/journal.h"
#include "io/json.h"
#include "io/universal.h"
#include "io/write_json.h"
#include "measurement/read.h"
#include "report/table.h"
#include "result/record.h"

enum { DIGITS = 6 };
/* Something that the file holds, a line of a table. Numbers are in `unit`; unknown ones NaN. */
typedef struct held_item {
    const char *part; /* "variable", "goal", ... */
    const char *name;
    double value;
    double lower;
    double upper;
    const char *unit;
    double lower_hz;
    double upper_hz;
    int count; /* of its own lines, values, modes; -1: none */
    const char *text;
} held_item;

/* A file that the file names. */
typedef struct named_file {
    const char *what;
    const char *file;
    const char *state;
} named_file;

typedef struct held_file {
    const char *file;
    const char *kind;
    const char *format;
    long bytes;
    const char *sha256;
    const char *name;
    const char *description;
    const char *author;
    const char *revision;
    const char *date;
    const char *source;
    const char *modetune; /* the program that wrote it */
    const char *commit;
    const char *status;
    int n_items;
    held_item *items;
    int n_files;
    named_file *files;
    int n_warnings;
    const char **warnings;
    int cap_items;
    int cap_files;
    int cap_warnings;
    held_item spare; /* where memory is out */
    mt_arena mem;
    bool partly;      /* it is wrong, and what it says of itself is told */
    const char *root; /* of the files that it names; NULL: their default */
} held_file;

static const char *const STATES[] = {"found", "changed", "not found", "part of the program"};
enum { FOUND, CHANGED, NOT_FOUND, OWN };

#define THIS held_item
static const mt_field item_fields[] = {
    MT_F_TEXT("part", part, "What this is: a variable, a goal, a response."),
    MT_F_TEXT_OR_NULL(
        "name", name,
        "Its name, the JSON pointer of a goal, the source of a random part; null: none."),
    MT_F_NUMBER_OR_NULL("value", value,
                        "Its number, in the unit that `unit` names: of a variable the original "
                        "value, of a goal the target."),
    MT_F_NUMBER_OR_NULL("lower", lower, "Lower bound, or limit, in the same unit."),
    MT_F_NUMBER_OR_NULL("upper", upper, "Upper bound, or limit, in the same unit."),
    MT_F_TEXT_OR_NULL(
        "unit", unit,
        "Unit of these three numbers, as the file shows them; null: they have none."),
    MT_F_NUMBER_OR_NULL("lower_hz", lower_hz, "Lowest frequency."),
    MT_F_NUMBER_OR_NULL("upper_hz", upper_hz, "Highest frequency."),
    MT_F_COUNT_OR_NULL("count", count, 0, "Number of its lines, values, modes or records."),
    MT_F_TEXT_OR_NULL("text", text, "What else there is to say, in words."),
};
static const mt_record item_record =
    MT_F_RECORD_OF(item_fields, "item", "Something that the file holds.");
static const mt_record_column item_columns[] = {
    MT_R_COLUMN(part, "part", 0, MT_IN_CSV),
    MT_R_COLUMN(name, "name", 0, MT_IN_TABLES),
    MT_R_COLUMN(value, "value", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(lower, "from", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(upper, "to", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(unit, "unit", 0, MT_IN_TABLES),
    MT_R_COLUMN(lower_hz, "from [Hz]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(upper_hz, "to [Hz]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(count, "count", 0, MT_IN_TABLES),
    MT_R_COLUMN(text, "what", 0, MT_IN_TABLES),
};
static const mt_record_table item_rows = MT_R_TABLE_OF(item_record, item_columns);
#undef THIS

#define THIS named_file
static const mt_field named_fields[] = {
    MT_F_TEXT("what", what, "What the file is to this one."),
    MT_F_TEXT("file", file, "Its name, as this file has it."),
    MT_F_CHOICE("state", state, STATES,
                "\"changed\": it is there, and has other bytes than those that this file names "
                "by their SHA-256. \"not found\": not there, not readable, or outside --root."),
};
static const mt_record named_record =
    MT_F_RECORD_OF(named_fields, "named_file", "A file that this one names.");
#undef THIS

#define THIS held_file
static const mt_field held_fields[] = {
    MT_F_TEXT("file", file, "The file, as the command line names it."),
    MT_F_TEXT("kind", kind, "What it is: study, result, profile, measurement, ..."),
    MT_F_TEXT("format", format, "Its format, with its version where it has one."),
    MT_F_LONG("bytes", bytes, "Its size."),
    MT_F_TEXT("sha256", sha256, "SHA-256 of its bytes."),
    MT_F_TEXT_OR_NULL("name", name, "Name that it gives itself."),
    MT_F_TEXT_OR_NULL("description", description, "Its text for people."),
    MT_F_TEXT_OR_NULL("author", author, "Its author."),
    MT_F_TEXT_OR_NULL("revision", revision, "Its revision."),
    MT_F_TEXT_OR_NULL("date", date, "Its date."),
    MT_F_TEXT_OR_NULL("source", source, "Where its numbers come from."),
    MT_F_TEXT_OR_NULL("modetune", modetune, "Version of the program that wrote it."),
    MT_F_TEXT_OR_NULL("commit", commit, "Commit of that program."),
    MT_F_TEXT_OR_NULL("status", status, "Its outcome, in words."),
    MT_F_LIST("items", items, n_items, held_item, item_record, "What it holds."),
    MT_F_LIST("refers_to", files, n_files, named_file, named_record, "Files that it names."),
    MT_F_TEXTS("doubts", warnings, n_warnings, "What is odd or not confirmed about it."),
};
const mt_record mt_held_file_record = MT_F_RECORD_OF(
    held_fields, "held_file", "What a file holds that does not describe a model.");
#undef THIS

/* Another item, which is valid until the next one. */
static held_item *add_item(held_file *h, const char *part, const char *name)
{
    held_item *const items =
        mt_arena_grow(&h->mem, h->items, h->n_items, &h->cap_items, sizeof *items);
    held_item *const item = items == NULL ? &h->spare : &items[h->n_items];
    *item = (held_item){.part = part,
                        .name = name,
                        .value = nan(""),
                        .lower = nan(""),
                        .upper = nan(""),
                        .lower_hz = nan(""),
                        .upper_hz = nan(""),
                        .count = -1};
    if (items != NULL) {
        h->items = items;
        h->n_items++;
    }
    return item;
}

/* text: NULL where memory was out. */
static void add_warning(held_file *h, const char *text)
{
    const char **const warnings = (const char **)mt_arena_grow(
        &h->mem, (void *)h->warnings, h->n_warnings, &h->cap_warnings, sizeof *warnings);
    if (warnings != NULL) {
        h->warnings = warnings;
    }
    if (warnings != NULL && text != NULL) {
        h->warnings[h->n_warnings++] = text;
    }
}

/* The state of a file that `naming` names; sha256: what it should have, NULL: not known. */
static int state_of(held_file *h, const char *naming, const char *name, const char *sha256)
{
    char *const path = mt_file_join(naming, name);
    char *const folder = mt_file_default_root(naming);
    mt_file file = {.bytes = NULL};
    mt_status rc = path == NULL || folder == NULL ? MT_E_MEMORY : MT_OK;
    rc = rc == MT_OK ? mt_file_read(path, h->root == NULL ? folder : h->root, MT_JSON_MAX_BYTES,
                                    &file, NULL)
                     : rc;
    const bool differs = rc == MT_OK && sha256 != NULL && strcmp(sha256, file.sha256) != 0;
    if (rc == MT_E_MEMORY) {
        mt_arena_fail(&h->mem);
    }
    mt_file_free(&file);
    free(folder);
    free(path);
    return rc != MT_OK ? NOT_FOUND : differs ? CHANGED : FOUND;
}

/* name: NULL where memory was out. */
static void add_file(held_file *h, const char *what, const char *naming, const char *name,
                     const char *sha256)
{
    static const char own[] = " of modetune";
    const size_t length = name == NULL ? 0 : strlen(name);
    const bool is_own =
        length >= sizeof own - 1 && strcmp(name + length - (sizeof own - 1), own) == 0;
    for (int i = 0; i < h->n_files && name != NULL; i++) {
        if (strcmp(h->files[i].file, name) == 0 && strcmp(h->files[i].what, what) == 0) {
            return;
        }
    }
    named_file *const files =
        mt_arena_grow(&h->mem, h->files, h->n_files, &h->cap_files, sizeof *files);
    if (files != NULL) {
        h->files = files;
    }
    if (files != NULL && name != NULL) {
        files[h->n_files++] =
            (named_file){what, name, STATES[is_own ? OWN : state_of(h, naming, name, sha256)]};
    }
}

/* Parse a text that need not be JSON: NULL where it is not, or where memory is out. */
static mt_json *parse(held_file *h, const char *text, size_t length)
{
    mt_json *doc = NULL;
    const mt_status rc = mt_json_parse(text, length, &doc, NULL);
    if (rc != MT_OK) {
        mt_json_delete(doc);
        doc = NULL;
    }
    if (rc == MT_E_MEMORY) {
        mt_arena_fail(&h->mem);
    }
    return doc;
}

/* The text of a member; NULL: there is none. */
static const char *text_at(const mt_json *doc, mt_addr object, const char *member)
{
    const mt_addr at = mt_json_member(doc, object, member);
    return at != MT_NO_ADDR && mt_json_type_of(doc, at) == MT_JSON_STRING
               ? mt_json_string(doc, at)
               : NULL;
}

static double number_at(const mt_json *doc, mt_addr object, const char *member)
{
    const mt_addr at = mt_json_member(doc, object, member);
    return at != MT_NO_ADDR && mt_json_type_of(doc, at) == MT_JSON_NUMBER
               ? mt_json_number(doc, at)
               : nan("");
}

static int count_at(const mt_json *doc, mt_addr object, const char *member)
{
    const mt_addr at = mt_json_member(doc, object, member);
    return at == MT_NO_ADDR ? 0 : mt_json_items(doc, at).count;
}

static const char *kept(held_file *h, const char *text)
{
    return text == NULL ? NULL : mt_arena_strdup(&h->mem, text);
}

/* A study. */

/* Files that the items of a list or an object name by a member. */
static void add_files_of(held_file *h, const mt_json *doc, const char *list, const char *member,
                         const char *what)
{
    const mt_addr at = mt_json_member(doc, MT_JSON_ROOT, list);
    for (mt_items i = mt_json_items(doc, at); mt_items_next(&i);) {
        const char *const name = text_at(doc, i.at, member);
        if (name != NULL) {
            add_file(h, what, h->file, kept(h, name), NULL);
        }
    }
}

/* What a study says of itself where it, or a file that it names, is wrong. False: nothing. */
static bool hold_wrong_study(held_file *h, const mt_file *file)
{
    static const char *const one[] = {"model", "aircraft"};
    mt_json *const doc = parse(h, file->bytes, file->length);
    if (doc == NULL) {
        return false;
    }
    h->name = kept(h, text_at(doc, MT_JSON_ROOT, "name"));
    h->description = kept(h, text_at(doc, MT_JSON_ROOT, "description"));
    for (int i = 0; i < MT_COUNT(one); i++) {
        const char *const name = text_at(doc, MT_JSON_ROOT, one[i]);
        if (name != NULL) {
            add_file(h, one[i], h->file, kept(h, name), NULL);
        }
    }
    add_files_of(h, doc, "references", "model", "reference");
    add_files_of(h, doc, "measurements", "file", "measurement");
    mt_json_delete(doc);
    return true;
}

static const char *join_names(held_file *h, const mt_name_list *names)
{
    const char *text = "";
    for (int i = 0; i < names->count && text != NULL; i++) {
        text = mt_arena_printf(&h->mem, "%s%s\"%s\"", text, i == 0 ? " in " : ", ",
                               names->items[i].s);
    }
    return text;
}

static const char *mode_text(held_file *h, const mt_mode_ref *mode)
{
    return mode->mode_name.s != NULL
               ? mt_arena_printf(&h->mem, "mode \"%s\"", mode->mode_name.s)
           : mode->index > 0 ? mt_arena_printf(&h->mem, "mode %d", mode->index)
                             : "";
}

/* "mode 2 to mode 1 of "free"", "mode 1, mode 2, mode 3 apart"; of one mode its own. */
static const char *modes_text(held_file *h, const mt_goal *g)
{
    const char *text = mode_text(h, &g->mode);
    const char *const of = mode_text(h, &g->of.mode);
    const mt_name where = g->of.configuration_name;
    if (of != NULL && of[0] != '\0') {
        return where.s == NULL
                   ? mt_arena_printf(&h->mem, "%s to %s", text, of)
                   : mt_arena_printf(&h->mem, "%s to %s of \"%s\"", text, of, where.s);
    }
    for (int i = 0; i < g->n_modes && text != NULL; i++) {
        text = mt_arena_printf(&h->mem, "%s%s%s", text, i == 0 ? "" : ", ",
                               mode_text(h, &g->modes[i]));
    }
    return text;
}

static void hold_goal(held_file *h, const mt_study *study, int index)
{
    const mt_goal *const g = &study->goals[index];
    held_item *const item = add_item(h, "goal", mt_arena_printf(&h->mem, "/goals/%d", index));
    const char *const where = join_names(h, &g->configuration_names);
    const char *about = g->expression_text == NULL ? "" : g->expression_text;
    if (g->mode.mode_name.s != NULL || g->mode.index > 0 || g->n_modes > 0) {
        about = modes_text(h, g);
    } else if (g->response_limit != NULL && g->response_limit->output.s != NULL) {
        about = mt_arena_printf(
            &h->mem, "%s by %s", g->response_limit->output.s,
            g->response_limit->input.s == NULL ? "the ground" : g->response_limit->input.s);
    }
    if (g->static_limit != NULL && g->static_limit->output.s != NULL) {
        about = g->static_limit->output.s;
    }
    if (g->energy != NULL) {
        const bool moves = g->energy->body_name.s != NULL;
        about = mt_arena_printf(&h->mem, "%s, %s \"%s\"", about, moves ? "body" : "spring",
                                moves ? g->energy->body_name.s : g->energy->spring_name.s);
    }
    item->value = g->equals;
    item->lower = g->at_least;
    item->upper = g->at_most;
    item->unit = kept(h, mt_study_goal_unit(study, g));
    if (g->avoid != NULL) {
        item->count = g->avoid->bands.n;
    }
    if (g->response_limit != NULL) {
        item->lower_hz = g->response_limit->lower_hz;
        item->upper_hz = g->response_limit->upper_hz;
    }
    item->text = mt_arena_printf(
        &h->mem, "%s%s%s%s%s%s%s", mt_goal_kind_of(g->type)->name,
        about == NULL || *about == '\0' ? "" : " of ", about == NULL ? "" : about,
        where == NULL ? "" : where, MT_HAS(g->weight) ? ", weighted" : "",
        g->description == NULL ? "" : ": ", g->description == NULL ? "" : g->description);
}

static void hold_variables(held_file *h, const mt_study *study)
{
    for (int i = 0; i < study->n_variables; i++) {
        const mt_variable *const v = &study->variables[i];
        const char *const si = study->model->parameters[v->parameter].unit;
        const bool listed = v->n_catalogue > 0;
        held_item *const item = add_item(h, "variable", kept(h, v->parameter_name.s));
        item->value = mt_unit_from_si(v->shown, v->original);
        item->lower = mt_unit_from_si(v->shown, listed ? v->catalogue[0] : v->lower);
        item->upper =
            mt_unit_from_si(v->shown, listed ? v->catalogue[v->n_catalogue - 1] : v->upper);
        item->unit = kept(h, mt_unit_name(v->shown, si));
        if (listed) {
            item->count = v->rows != NULL ? v->rows->n_rows : v->n_catalogue;
            item->text = v->rows != NULL ? "rows of a catalogue of parts, chosen together"
                                         : "values of a catalogue";
        }
    }
}

/* What a file that the study reads is to it. */
static const char *use_of(const mt_study *study, const char *name)
{
    const char *what = strcmp(name, study->model_path.s) == 0 ? "model" : "input";
    for (int i = 0; i < study->n_references; i++) {
        const char *const model = study->references[i].model_path.s;
        const bool is = model != NULL && strcmp(name, model) == 0;
        what = is && strcmp(what, "input") == 0 ? "reference" : what;
    }
    for (int i = 0; i < study->n_measurements; i++) {
        what = strcmp(name, study->measurements[i].path.s) == 0 ? "measurement" : what;
    }
    for (int i = 0; i < study->n_profiles; i++) {
        what = strcmp(name, study->profiles[i].name.s) == 0 ? "profile" : what;
    }
    return study->aircraft_path.s != NULL && strcmp(name, study->aircraft_path.s) == 0
               ? "aircraft"
               : what;
}

static void hold_study(held_file *h, const mt_study *study)
{
    h->name = kept(h, study->name);
    h->description = kept(h, study->description);
    h->author = kept(h, study->author);
    h->revision = kept(h, study->revision);
    h->date = kept(h, study->date);
    hold_variables(h, study);
    for (int i = 0; i < study->n_goals; i++) {
        hold_goal(h, study, i);
    }
    for (int i = 0; i < study->n_objectives; i++) {
        const mt_objective *const o = &study->objectives[i];
        (void)add_item(h, "objective",
                       kept(h, o->expression_text == NULL ? mt_objective_kind_of(o->type)->name
                                                          : o->expression_text));
    }
    for (int i = 0; i < study->n_references; i++) {
        const mt_reference *const r = &study->references[i];
        held_item *const item = add_item(h, "reference", kept(h, r->name.s));
        item->count = r->model_path.s == NULL ? r->n_modes : -1;
        item->text = r->model_path.s == NULL ? "measured modes" : kept(h, r->model_path.s);
    }
    for (int i = 0; i < study->n_measurements; i++) {
        held_item *const item =
            add_item(h, "measurement", kept(h, study->measurements[i].name.s));
        item->count = study->measurements[i].n_responses;
        item->text = kept(h, study->measurements[i].path.s);
    }
    for (int i = 0; i < study->n_responses; i++) {
        const mt_study_response *const r = &study->responses[i];
        held_item *const item =
            add_item(h, "response", mt_arena_printf(&h->mem, "/responses/%d", i));
        item->lower_hz = r->response_limit.lower_hz;
        item->upper_hz = r->response_limit.upper_hz;
        item->text = mt_arena_printf(
            &h->mem, "%s by %s", r->response_limit.output.s,
            r->response_limit.input.s == NULL ? "the ground" : r->response_limit.input.s);
    }
    for (int i = 0; i < study->trade.n_vary; i++) {
        add_item(h, "trade", kept(h, study->trade.vary[i].text))->count =
            study->trade.vary[i].n_values;
    }
    if (study->n_published > 0) {
        add_item(h, "published", "values")->count = study->n_published;
    }
    for (int i = 0; i < study->warning_list.n; i++) {
        add_warning(h, kept(h, study->warning_list.items[i].text));
    }
    for (int i = 0; i < study->n_warnings; i++) {
        add_warning(h, kept(h, study->warnings[i]));
    }
    for (int i = 0; i < study->n_inputs; i++) {
        const mt_input_file *const f = &study->inputs[i];
        if (i > 0) { /* the first one is the study itself */
            add_file(h, use_of(study, f->name), h->file, kept(h, f->name), f->sha256);
        }
    }
}

/* A result. */

static const char *design_name(held_file *h, const mt_recommendation *d)
{
    return d->rank == 0 ? "original" : mt_arena_printf(&h->mem, "design %d", d->rank);
}

static void hold_design(held_file *h, const mt_recommendation *d)
{
    held_item *const item = add_item(h, "design", design_name(h, d));
    int met = 0;
    for (int i = 0; i < d->n_goals; i++) {
        met += d->goals[i].met ? 1 : 0;
    }
    item->value = d->change;
    item->text = mt_arena_printf(&h->mem, "%s; %d of %d goals met", d->grade, met, d->n_goals);
}

static void hold_frequencies(held_file *h, const mt_recommendation *d)
{
    const char *const name = design_name(h, d);
    for (int i = 0; i < d->n_frequencies && name != NULL; i++) {
        const mt_result_frequency *const f = &d->frequencies[i];
        held_item *const item = add_item(
            h, "frequency",
            mt_arena_printf(&h->mem, "%s, %s, mode %d%s%s", name, f->configuration, f->mode,
                            f->name == NULL ? "" : ", ", f->name == NULL ? "" : f->name));
        item->value = f->recommended_hz;
        item->lower = f->at_least_hz;
        item->upper = f->at_most_hz;
        item->unit = "Hz";
    }
}

/* Where the study of a result is, by the timing.json beside it; NULL: not known. */
static mt_status find_study(held_file *h, const char **out, mt_err *err)
{
    mt_text timing = {.s = NULL};
    *out = NULL;
    const mt_status rc = mt_result_read_timing(h->file, h->sha256, &timing, err);
    mt_json *const doc =
        rc == MT_OK && timing.s != NULL ? parse(h, timing.s, timing.length) : NULL;
    if (doc != NULL) {
        *out = kept(h, text_at(doc, MT_JSON_ROOT, "study_path"));
    }
    mt_json_delete(doc);
    mt_text_free(&timing);
    return rc;
}

static mt_status hold_result(held_file *h, const mt_result *r, mt_err *err)
{
    const char *study = NULL;
    MT_TRY(find_study(h, &study, err));
    h->name = kept(h, r->study.name);
    h->author = kept(h, r->study.author);
    h->revision = kept(h, r->study.revision);
    h->date = kept(h, r->study.date);
    h->modetune = kept(h, r->run.modetune_version);
    h->commit = kept(h, r->run.build.commit);
    h->status = mt_arena_printf(&h->mem, "%s: %s", mt_result_status_name(r->status),
                                r->status_text == NULL ? "" : r->status_text);
    for (int i = 0; i < r->baseline.n_parameters; i++) {
        const mt_result_parameter *const p = &r->baseline.parameters[i];
        const double factor = p->display_factor;
        held_item *const item = add_item(h, "variable", kept(h, p->name));
        item->value = mt_result_shown(p->original, factor);
        item->lower = mt_result_shown(p->lower, factor);
        item->upper = mt_result_shown(p->upper, factor);
        item->unit = kept(h, p->display_unit == NULL ? p->unit : p->display_unit);
    }
    for (int i = 0; i < r->n_objectives; i++) {
        add_item(h, "objective", kept(h, r->objectives[i].text))->unit =
            kept(h, r->objectives[i].unit);
    }
    hold_design(h, &r->baseline);
    for (int i = 0; i < r->n_recommendations; i++) {
        hold_design(h, &r->recommendations[i]);
    }
    hold_frequencies(h, &r->baseline);
    for (int i = 0; i < r->n_recommendations; i++) {
        hold_frequencies(h, &r->recommendations[i]);
    }
    if (r->trade != NULL) {
        add_item(h, "trade", "points")->count = r->trade->n_points;
    }
    const char *warning = NULL;
    for (int i = 0; (warning = mt_result_warning(r, i)) != NULL; i++) {
        add_warning(h, kept(h, warning));
    }
    for (int i = 0; i < r->n_warnings; i++) {
        add_warning(h, kept(h, r->warnings[i]));
    }
    for (int i = 0; i < r->run.n_inputs; i++) {
        const mt_result_digest *const f = &r->run.inputs[i];
        add_file(h, i == 0 ? "study" : "input", study == NULL ? h->file : study,
                 kept(h, f->file), f->sha256);
    }
    for (int i = 0; i < r->run.n_outputs; i++) {
        add_file(h, "output", h->file, kept(h, r->run.outputs[i].file),
                 r->run.outputs[i].sha256);
    }
    return MT_OK;
}

/* Files that the program writes beside results. */

static void hold_index(held_file *h, const mt_json *doc)
{
    const mt_addr list = mt_json_member(doc, MT_JSON_ROOT, "studies");
    h->modetune = kept(h, text_at(doc, MT_JSON_ROOT, "modetune"));
    for (mt_items i = mt_json_items(doc, list); mt_items_next(&i);) {
        const char *const status = text_at(doc, i.at, "status");
        const char *const state = text_at(doc, i.at, "state");
        const char *const folder = text_at(doc, i.at, "folder");
        held_item *const item = add_item(h, "study", kept(h, text_at(doc, i.at, "file")));
        item->value = number_at(doc, i.at, "change");
        item->text = mt_arena_printf(&h->mem, "%s%s%s", state == NULL ? "" : state,
                                     status == NULL ? "" : ", ", status == NULL ? "" : status);
        if (folder != NULL && text_at(doc, i.at, "result_sha256") != NULL) {
            const char *const result = mt_arena_printf(
                &h->mem, "%s/%s", folder, mt_result_file_name(MT_RESULT_FILE_RESULT));
            if (result != NULL) {
                add_file(h, "result", h->file, result, text_at(doc, i.at, "result_sha256"));
            }
        }
    }
}

static void hold_timing(held_file *h, const mt_json *doc)
{
    const char *const study = text_at(doc, MT_JSON_ROOT, "study_path");
    static const char *const numbers[][2] = {
        {"solve_s", "s"}, {"evaluations", NULL}, {"threads", NULL}};
    for (int i = 0; i < MT_COUNT(numbers); i++) {
        held_item *const item = add_item(h, "number", numbers[i][0]);
        item->value = number_at(doc, MT_JSON_ROOT, numbers[i][0]);
        item->unit = numbers[i][1];
    }
    if (study != NULL) {
        add_file(h, "study", study, kept(h, study), NULL);
    }
    add_file(h, "result", h->file, mt_result_file_name(MT_RESULT_FILE_RESULT),
             text_at(doc, MT_JSON_ROOT, "result_sha256"));
}

static void hold_scene(held_file *h, const mt_json *doc)
{
    const mt_addr designs = mt_json_member(doc, MT_JSON_ROOT, "designs");
    h->name = kept(h, text_at(doc, MT_JSON_ROOT, "model"));
    for (mt_items i = mt_json_items(doc, designs); mt_items_next(&i);) {
        const mt_addr views = mt_json_member(doc, i.at, "configurations");
        add_item(h, "design", kept(h, text_at(doc, i.at, "label")))->count =
            mt_json_items(doc, views).count;
        for (mt_items v = mt_json_items(doc, views); mt_items_next(&v);) {
            const char *const error = text_at(doc, v.at, "error");
            held_item *const item =
                add_item(h, "configuration", kept(h, text_at(doc, v.at, "name")));
            item->count = count_at(doc, v.at, "modes");
            item->text = error == NULL ? "modes" : kept(h, error);
        }
    }
}

/* The lines of --progress json: of each file its last one. */
static void hold_progress(held_file *h, const char *bytes)
{
    int lines = 0;
    for (const char *at = bytes; *at != '\0';) {
        const size_t length = strcspn(at, "\n");
        mt_json *const doc = *at == '{' ? parse(h, at, length) : NULL;
        if (doc != NULL) {
            const char *const file = text_at(doc, MT_JSON_ROOT, "file");
            const char *const phase = text_at(doc, MT_JSON_ROOT, "phase");
            const char *const state = text_at(doc, MT_JSON_ROOT, "state");
            held_item *const last = h->n_items > 0 ? &h->items[h->n_items - 1] : NULL;
            const bool same = last != NULL && file != NULL && last->name != NULL &&
                              strcmp(last->name, file) == 0;
            held_item *const item = same ? last : add_item(h, "file", kept(h, file));
            lines = same ? lines + 1 : 1;
            item->count = lines;
            item->value = number_at(doc, MT_JSON_ROOT, "share");
            item->text = mt_arena_printf(&h->mem, "%s, %s", state == NULL ? "" : state,
                                         phase == NULL ? "" : phase);
        }
        mt_json_delete(doc);
        at += length;
        at += *at == '\n' ? 1 : 0;
    }
}

/* The identity of a journal: lines that begin with "| ". */
static mt_status read_identity(const char *bytes, mt_text *out, mt_err *err)
{
    for (const char *at = bytes; *at != '\0'; at += strcspn(at, "\n") + 1) {
        const size_t length = strcspn(at, "\n");
        if (length >= 2 && strncmp(at, "| ", 2) == 0) {
            mt_text_add_n(out, at + 2, length - 2);
            mt_text_add(out, "\n");
        }
        if (at[length] == '\0') {
            break;
        }
    }
    return out->failed ? mt_fail_memory(err) : MT_OK;
}

static mt_status hold_journal(held_file *h, const char *bytes, mt_err *err)
{
    mt_text identity = {.s = NULL};
    mt_journal *journal = NULL;
    mt_status rc = read_identity(bytes, &identity, err);
    rc = rc == MT_OK ? mt_journal_new(identity.s == NULL ? "" : identity.s, &journal, err) : rc;
    rc = rc == MT_OK ? mt_journal_read(journal, h->file, NULL, err) : rc;
    if (rc == MT_OK) {
        const mt_journal_counts counts = mt_journal_count(journal);
        held_item *const records = add_item(h, "records", "of tasks that are done");
        records->count = (int)counts.known;
        add_item(h, "records", "lines that are not records")->count = (int)counts.ignored;
    }
    mt_json *const doc =
        rc == MT_OK && identity.s != NULL ? parse(h, identity.s, identity.length) : NULL;
    if (doc != NULL) {
        const mt_addr run = mt_json_member(doc, MT_JSON_ROOT, "run");
        const mt_addr inputs = mt_json_member(doc, run, "inputs");
        h->modetune = kept(h, text_at(doc, run, "modetune"));
        h->commit = kept(h, text_at(doc, mt_json_member(doc, run, "build"), "commit"));
        for (mt_items i = mt_json_items(doc, inputs); mt_items_next(&i);) {
            const char *const name = text_at(doc, i.at, "file");
            if (name != NULL) { /* a journal does not say where its study is */
                add_item(h, "input", kept(h, name))->text =
                    kept(h, text_at(doc, i.at, "sha256"));
            }
        }
    }
    mt_json_delete(doc);
    mt_journal_delete(journal);
    mt_text_free(&identity);
    return rc;
}

/* What shakes a mechanism, and what was measured on it. */

static void hold_profile(held_file *h, const mt_vibration *v)
{
    static const char *const axes[] = {"x", "y", "z"};
    h->name = kept(h, v->name);
    h->description = kept(h, v->description);
    h->source = kept(h, v->source);
    add_item(h, "axis", v->axis >= 0 && v->axis < 3 ? axes[v->axis] : "any");
    for (int i = 0; i < v->n_random; i++) {
        const mt_vibration_random *const r = &v->random[i];
        held_item *const item = add_item(h, "random", kept(h, r->origin.source));
        item->value = r->rms;
        item->unit = "m/s^2";
        item->lower_hz = r->psd.hz[0];
        item->upper_hz = r->psd.hz[r->psd.n - 1];
        item->count = r->psd.n;
        item->text = "RMS, by breakpoints";
    }
    for (int i = 0; i < v->n_tones; i++) {
        held_item *const item = add_item(h, "tone", kept(h, v->tones[i].label));
        item->value = v->tones[i].level;
        item->unit = "m/s^2";
        item->lower_hz = v->tones[i].lower_hz;
        item->upper_hz = v->tones[i].upper_hz;
    }
    for (int i = 0; i < v->n_marks; i++) {
        add_warning(h, kept(h, v->marks[i]));
    }
    if (v->aircraft_name == mt_aircraft_own_name) {
        add_file(h, "aircraft", h->file, mt_aircraft_own_name, NULL);
    } else if (v->aircraft_name != NULL) {
        add_file(h, "aircraft", h->file, kept(h, v->aircraft_name), v->aircraft.sha256);
    }
}

static void hold_rotor(held_file *h, const mt_aircraft *a, const char *what,
                       const mt_aircraft_rotor *r)
{
    held_item *const item =
        add_item(h, "rotor", mt_arena_printf(&h->mem, "%s, %s", a->name.s, what));
    item->value = r->speed.value;
    item->unit = "Hz";
    item->count = (int)r->blades.value;
    item->text = mt_arena_printf(&h->mem, "%s, %s blades%s", r->speed.text, r->blades.text,
                                 r->speed.confirmed && r->blades.confirmed
                                     ? ""
                                     : "; not confirmed in a public document");
}

static void hold_aircraft(held_file *h, const mt_aircraft_list *list)
{
    for (int i = 0; i < list->n; i++) {
        hold_rotor(h, &list->items[i], "main rotor", &list->items[i].main_rotor);
        if (list->items[i].has_tail) {
            hold_rotor(h, &list->items[i], "tail rotor", &list->items[i].tail_rotor);
        }
    }
}

/* "x3.x:acceleration by x1.x", or by the nodes of a universal file. */
static const char *name_of_response(held_file *h, const mt_measured_response *r)
{
    if (r->dataset > 0) {
        return mt_arena_printf(
            &h->mem, "dataset %d: node %d, direction %d, by node %d, direction %d", r->dataset,
            r->response.node, r->response.direction, r->reference.node, r->reference.direction);
    }
    return r->output == NULL ? NULL
                             : mt_arena_printf(&h->mem, "%s by %s", r->output,
                                               r->input == NULL ? "?" : r->input);
}

static bool is_coherent(const mt_measured_response *r)
{
    for (int k = 0; k < r->n_lines; k++) {
        if (!MT_HAS(r->lines[k].coherence)) {
            return false;
        }
    }
    return r->n_lines > 0;
}

static void hold_measurement(held_file *h, const mt_measurement *m)
{
    for (int i = 0; i < m->n_responses; i++) {
        const mt_measured_response *const r = &m->responses[i];
        const bool responds = mt_measured_is_response(r);
        held_item *const item = add_item(h, "response", name_of_response(h, r));
        item->unit = kept(h, r->unit);
        item->count = r->n_lines;
        if (r->n_lines > 0) {
            item->lower_hz = r->lines[0].frequency_hz;
            item->upper_hz = r->lines[r->n_lines - 1].frequency_hz;
        }
        item->text = mt_arena_printf(&h->mem, "%s%s%s%s",
                                     responds ? "frequency response" : "no frequency response",
                                     r->configuration == NULL ? "" : ", configuration ",
                                     r->configuration == NULL ? "" : r->configuration,
                                     is_coherent(r) ? ", with coherence" : "");
        if (r->dataset > 0 && responds && !MT_HAS(r->si)) {
            add_warning(h, mt_arena_printf(&h->mem, "dataset %d: the factor to SI is not known",
                                           r->dataset));
        }
    }
}

/* The command. */

typedef enum held_kind {
    KIND_STUDY,
    KIND_RESULT,
    KIND_PROFILE,
    KIND_AIRCRAFT,
    KIND_INDEX,
    KIND_TIMING,
    KIND_SCENE,
    KIND_PROGRESS,
    KIND_JOURNAL,
    KIND_UNIVERSAL,
    KIND_TABLE,
    KIND_MODEL,
    KIND_NONE
} held_kind;

static const struct {
    const char *kind;
    const char *format;
} kinds[KIND_NONE] = {
    [KIND_STUDY] = {"study", "modetune-study/1"},
    [KIND_RESULT] = {"result", "modetune-result/1"},
    [KIND_PROFILE] = {"profile", "modetune-profile/1"},
    [KIND_AIRCRAFT] = {"aircraft", "modetune-aircraft/1"},
    [KIND_INDEX] = {"index", "modetune-index/1"},
    [KIND_TIMING] = {"timing", "modetune-timing/1"},
    [KIND_SCENE] = {"scene", "modetune-scene/1"},
    [KIND_PROGRESS] = {"progress", "modetune-progress/1"},
    [KIND_JOURNAL] = {"journal", "modetune-journal/1"},
    [KIND_UNIVERSAL] = {"measurement", "universal file, datasets 58"},
    [KIND_TABLE] = {"measurement", "CSV table"},
    [KIND_MODEL] = {"model", "modetune-model/1"},
};

/* Whether the bytes have "format" with this value: where and how the member stands is for the
 * readers. */
static bool has_format(const char *bytes, const char *format)
{
    static const char member[] = "\"format\"";
    const size_t length = strlen(format);
    for (const char *at = bytes; (at = strstr(at, member)) != NULL;) {
        at += sizeof member - 1;
        at += strspn(at, " \t\r\n");
        if (*at == ':') {
            at++;
            at += strspn(at, " \t\r\n");
            return *at == '"' && strncmp(at + 1, format, length) == 0 && at[1 + length] == '"';
        }
    }
    return false;
}

/* The kind of a file by its bytes, of which one is no more than begun like a table. */
static held_kind kind_of(const mt_file *file)
{
    static const char mark[] = "\xef\xbb\xbf"; /* of UTF-8 */
    const char *at = file->bytes;
    if (strncmp(at, kinds[KIND_JOURNAL].format, strlen(kinds[KIND_JOURNAL].format)) == 0) {
        return KIND_JOURNAL;
    }
    if (mt_universal_begins(at, file->length)) {
        return KIND_UNIVERSAL;
    }
    at += strncmp(at, mark, sizeof mark - 1) == 0 ? sizeof mark - 1 : 0;
    at += strspn(at, " \t\r\n");
    for (held_kind k = 0; k < KIND_NONE; k++) {
        if ((*at == '{' || k == KIND_PROGRESS) && has_format(at, kinds[k].format)) {
            return k;
        }
    }
    /* a line of names with a separator, and the name that a table of responses has */
    const size_t line = strcspn(at, "\r\n");
    for (const char *name = at; *at != '{' && name < at + line; name++) {
        if (strncasecmp(name, "frequency_hz", strlen("frequency_hz")) == 0) {
            return KIND_TABLE;
        }
    }
    return *at == '#' && strstr(at, "frequency_hz") != NULL ? KIND_TABLE : KIND_NONE;
}

/* The failure of a file of no kind, with what it was held against. */
static mt_status refuse_file(const char *path, mt_err *err)
{
    mt_text all = {.s = NULL};
    for (int k = 0; k < KIND_NONE; k++) {
        if (k != KIND_UNIVERSAL && k != KIND_TABLE && k != KIND_JOURNAL) {
            mt_text_addf(&all, "%s\"%s\"", all.s == NULL ? "" : ", ", kinds[k].format);
        }
    }
    const mt_status rc =
        all.failed ? mt_fail_memory(err)
                   : mt_fail(err, MT_E_INPUT,
                             "%s: not a file that modetune reads: no JSON whose \"format\" is "
                             "one of %s; no journal, which begins with \"modetune-journal/1\"; "
                             "no universal file, which begins with a line \"-1\"; no table "
                             "(CSV) with a column frequency_hz",
                             path, all.s);
    mt_text_free(&all);
    return rc;
}

/* Read the file by its kind, with the reader of that kind. */
static mt_status hold_file(held_file *h, held_kind kind, const mt_file *file,
                           const mt_io_options *opt, mt_diagnostics *messages, mt_err *err)
{
    mt_study *study = NULL;
    mt_result *result = NULL;
    mt_vibration *profile = NULL;
    mt_json *doc = NULL;
    mt_aircraft_list aircraft = {0};
    mt_measurement measured = mt_measurement_default((mt_name){.s = h->file}, MT_NO_ADDR);
    char sha256[MT_SHA256_TEXT];
    mt_status rc = MT_OK;
    switch (kind) {
    case KIND_STUDY:
        rc = mt_study_load(h->file, opt, &study, messages, err);
        if (rc == MT_OK) {
            hold_study(h, study);
        } else if (rc == MT_E_INPUT) {
            h->partly = hold_wrong_study(h, file);
        }
        break;
    case KIND_RESULT:
        rc = mt_result_load(h->file, opt, &result, messages, err);
        rc = rc == MT_OK ? hold_result(h, result, err) : rc;
        break;
    case KIND_PROFILE:
        rc = mt_vibration_load(h->file, opt, &profile, messages, err);
        if (rc == MT_OK) {
            hold_profile(h, profile);
        }
        break;
    case KIND_AIRCRAFT:
        rc = mt_aircraft_load(h->file, opt, &h->mem, &aircraft, messages, err);
        if (rc == MT_OK) {
            hold_aircraft(h, &aircraft);
        }
        break;
    case KIND_UNIVERSAL:
    case KIND_TABLE:
        rc = mt_measurement_load(h->file, opt, &h->mem, &measured, sha256, messages, err);
        if (rc == MT_OK) {
            hold_measurement(h, &measured);
        }
        break;
    case KIND_PROGRESS:
        hold_progress(h, file->bytes);
        break;
    case KIND_JOURNAL:
        rc = hold_journal(h, file->bytes, err);
        break;
    case KIND_INDEX:
    case KIND_TIMING:
    case KIND_SCENE:
        rc = mt_json_parse(file->bytes, file->length, &doc, err);
        if (rc == MT_E_INPUT) {
            mt_json_report(doc, h->file, messages);
        } else if (rc == MT_OK) {
            (kind == KIND_INDEX    ? hold_index
             : kind == KIND_TIMING ? hold_timing
                                   : hold_scene)(h, doc);
        }
        break;
    case KIND_MODEL:
    case KIND_NONE:
        break;
    }
    mt_study_delete(study);
    mt_result_delete(result);
    mt_vibration_delete(profile);
    mt_json_delete(doc);
    return rc == MT_OK || mt_arena_failed(&h->mem) ? mt_arena_check(&h->mem, err) : rc;
}

/* Warnings of the reader, of which those that are doubts already are left out. */
static void hold_messages(held_file *h, const mt_diagnostics *messages)
{
    const int n = h->n_warnings;
    for (int i = 0; i < mt_diagnostics_count(messages); i++) {
        const char *const text = mt_diagnostics_message(messages, i);
        bool known = false;
        for (int k = 0; k < n && !known; k++) {
            known = strncmp(h->warnings[k], text, strlen(text)) == 0;
        }
        if (!known) {
            add_warning(h, kept(h, text));
        }
    }
}

static void write_line(const char *what, const char *text, mt_text *out)
{
    if (text != NULL && *text != '\0') {
        mt_text_addf(out, "  %-12s%s\n", what, text);
    }
}

/* Items of one part after the other, each with its table. */
static void write_items(const held_file *h, mt_text *out)
{
    for (int i = 0; i < h->n_items;) {
        mt_table t = mt_table_default();
        int n = 0;
        mt_table_record_columns(&t, &item_rows, MT_IN_TEXT);
        for (; i + n < h->n_items && strcmp(h->items[i + n].part, h->items[i].part) == 0; n++) {
            mt_table_record_row(&t, &item_rows, MT_IN_TEXT, &h->items[i + n]);
        }
        mt_text_addf(out, "\n%s (%d)\n", h->items[i].part, n);
        mt_table_print(&t, 2, mt_terminal_width(), out);
        mt_table_free(&t);
        i += n;
    }
}

static void write_text(const held_file *h, mt_text *out)
{
    mt_text_addf(out, "%s: %s (%s), %ld bytes\n", h->file, h->kind, h->format, h->bytes);
    write_line("name", h->name, out);
    write_line("description", h->description, out);
    write_line("author", h->author, out);
    write_line("revision", h->revision, out);
    write_line("date", h->date, out);
    write_line("source", h->source, out);
    if (h->modetune != NULL) {
        mt_text_addf(out, "  %-12smodetune %s%s%s\n", "written by", h->modetune,
                     h->commit == NULL ? "" : ", commit ", h->commit == NULL ? "" : h->commit);
    }
    write_line("outcome", h->status, out);
    write_line("SHA-256", h->sha256, out);
    for (int i = 0; i < h->n_warnings; i++) {
        mt_text_addf(out, "  %-12s%s\n", i == 0 ? "warnings" : "", h->warnings[i]);
    }
    for (int i = 0; i < h->n_files; i++) {
        mt_text_addf(out, "  %-12s%s %s: %s\n", i == 0 ? "refers to" : "", h->files[i].what,
                     h->files[i].file, h->files[i].state);
    }
    write_items(h, out);
}

static void write_csv(const held_file *h, mt_text *out)
{
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &item_rows, MT_IN_CSV);
    for (int i = 0; i < h->n_items; i++) {
        mt_table_record_row(&t, &item_rows, MT_IN_CSV, &h->items[i]);
    }
    mt_table_csv(&t, out);
    mt_table_free(&t);
}

static int write_held(const mt_args *args, const held_file *h, mt_text *out)
{
    mt_json_writer w = mt_json_writer_default(out);
    switch (args->format) {
    case MT_FORMAT_JSON:
        mt_json_open(&w, NULL, '{');
        mt_record_put(&w, &mt_held_file_record, h);
        mt_json_close(&w);
        return mt_cli_json_done(&w);
    case MT_FORMAT_CSV:
        write_csv(h, out);
        return MT_EXIT_DONE;
    case MT_FORMAT_HTML:  /* of report alone */
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        write_text(h, out);
        return MT_EXIT_DONE;
    }
    return MT_EXIT_DONE;
}

static mt_status check_options(const mt_args *args, const char *path, held_kind kind,
                               mt_err *err)
{
    static const int of_models[] = {MT_OPT_SET, MT_OPT_CONFIGURATION};
    for (int i = 0; i < MT_COUNT(of_models); i++) {
        if (args->given[of_models[i]]) {
            return mt_fail(err, MT_E_USAGE, "--%s needs a model, and %s holds none (%s)",
                           mt_options[of_models[i]].name, path, kinds[kind].format);
        }
    }
    return MT_OK;
}

int mt_file_info(const mt_args *args, bool *is_model, mt_text *out)
{
    const mt_io_options opt = mt_cli_io(args);
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_file file = {.bytes = NULL};
    held_file h = {.root = args->value[MT_OPT_ROOT]};
    held_kind kind = KIND_NONE;
    char *path = NULL;
    int code = MT_EXIT_DONE;
    mt_status rc = mt_result_path(args->operands[0], &path, &err);
    rc = rc == MT_OK ? mt_file_read(path, NULL, MT_JSON_MAX_BYTES, &file, &err) : rc;
    kind = rc == MT_OK ? kind_of(&file) : kind;
    *is_model = kind == KIND_MODEL;
    if (rc != MT_OK || kind == KIND_MODEL) {
        goto done;
    }
    rc = kind == KIND_NONE ? refuse_file(path, &err) : check_options(args, path, kind, &err);
    rc = rc == MT_OK ? mt_arena_init(&h.mem, 0, &err) : rc;
    if (rc != MT_OK) {
        goto done;
    }
    h.file = path;
    h.kind = kinds[kind].kind;
    h.format = kinds[kind].format;
    h.bytes = (long)file.length;
    h.sha256 = file.sha256;
    rc = hold_file(&h, kind, &file, &opt, &messages, &err);
done:
    if (!*is_model && rc == MT_OK) {
        hold_messages(&h, &messages);
        rc = mt_arena_check(&h.mem, &err);
    }
    if (rc == MT_OK) {
        mt_diagnostics_free(&messages); /* they are doubts now */
    }
    if (!*is_model) {
        code = mt_cli_loaded(rc, &messages, &err);
    }
    if (!*is_model && (rc == MT_OK || h.partly)) {
        code = mt_exit_worse(code, write_held(args, &h, out));
    }
    mt_diagnostics_free(&messages);
    mt_arena_free(&h.mem);
    mt_file_free(&file);
    free(path);
    return code;
}
