/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/read.h"

#include "study/read_priv.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/file.h"
#include "io/json_print.h"
#include "io/read_units.h"
#include "model/values.h"

#define STUDY_KEYS(X)                                                       \
    X(STUDY_SCHEMA, "$schema", MT_KEY_TEXT, false)                          \
    X(STUDY_FORMAT, "format", MT_KEY_TEXT, true)                            \
    X(STUDY_NAME, "name", MT_KEY_TEXT, false)                               \
    X(STUDY_DESCRIPTION, "description", MT_KEY_TEXT, false)                 \
    X(STUDY_SOURCE, "source", MT_KEY_TEXT, false)                           \
    X(STUDY_AUTHOR, "author", MT_KEY_TEXT, false)                           \
    X(STUDY_REVISION, "revision", MT_KEY_TEXT, false)                       \
    X(STUDY_DATE, "date", MT_KEY_TEXT, false)                               \
    X(STUDY_ACCEPTED, "accepted", MT_KEY_LIST, false)                       \
    X(STUDY_MODEL, "model", MT_KEY_TEXT, true)                              \
    X(STUDY_UNITS, "units", MT_KEY_OBJECT, false)                           \
    X(STUDY_VARIABLES, "variables", MT_KEY_LIST, false)                     \
    X(STUDY_GOALS, "goals", MT_KEY_LIST, false)                             \
    X(STUDY_OBJECTIVE, "objective", MT_KEY_OBJECT_OR_LIST, false)           \
    X(STUDY_REFERENCES, "references", MT_KEY_OBJECT, false)                 \
    X(STUDY_MEASUREMENTS, "measurements", MT_KEY_OBJECT, false)             \
    X(STUDY_RECOMMENDATIONS, "recommendations", MT_KEY_COUNT, false, WHOLE) \
    X(STUDY_SEARCH, "search", MT_KEY_OBJECT, false)                         \
    X(STUDY_WEIGHT_SENSITIVITY, "spread", MT_KEY_OBJECT, false)             \
    X(STUDY_AIRCRAFT, "aircraft", MT_KEY_TEXT, false)                       \
    X(STUDY_TRADE, "trade", MT_KEY_OBJECT, false)                           \
    X(STUDY_RESPONSES, "responses", MT_KEY_LIST, false)                     \
    X(STUDY_PUBLISHED, "published", MT_KEY_LIST, false)
enum { STUDY_KEYS(MT_STUDY_KEY_ENUM) STUDY_KEY_COUNT };
static const mt_key KEYS[] = {STUDY_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_keys = {"", KEYS, STUDY_KEY_COUNT};

#define SEARCH_KEYS(X)                                                         \
    X(SEARCH_SEED, "seed", MT_KEY_COUNT, false, WHOLE)                         \
    X(SEARCH_STARTS, "starts", MT_KEY_COUNT, false, WHOLE)                     \
    X(SEARCH_MAX_EVALUATIONS, "max_evaluations", MT_KEY_COUNT, false, WHOLE)   \
    X(SEARCH_MAX_SOLUTIONS, "max_modal_solutions", MT_KEY_COUNT, false, WHOLE) \
    X(SEARCH_PROOF, "proof_s", MT_KEY_NUMBER, false, PROOF)                    \
    X(SEARCH_DESCRIPTION, "description", MT_KEY_TEXT, false)                   \
    X(SEARCH_SOURCE, "source", MT_KEY_TEXT, false)
enum { SEARCH_KEYS(MT_STUDY_KEY_ENUM) SEARCH_KEY_COUNT };
static const mt_key SEARCH[] = {SEARCH_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_search_keys = {"search", SEARCH, SEARCH_KEY_COUNT};

#define WEIGHT_SENSITIVITY_KEYS(X)                                                  \
    X(WEIGHT_SENSITIVITY_FACTOR, "factor", MT_KEY_NUMBER, true, WEIGHT_SENSITIVITY) \
    X(WEIGHT_SENSITIVITY_DESCRIPTION, "description", MT_KEY_TEXT, false)            \
    X(WEIGHT_SENSITIVITY_SOURCE, "source", MT_KEY_TEXT, false)
enum { WEIGHT_SENSITIVITY_KEYS(MT_STUDY_KEY_ENUM) WEIGHT_SENSITIVITY_KEY_COUNT };
static const mt_key WEIGHT_SENSITIVITY[] = {WEIGHT_SENSITIVITY_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_weight_sensitivity_keys = {"spread", WEIGHT_SENSITIVITY,
                                                       WEIGHT_SENSITIVITY_KEY_COUNT};

enum { MAX_RECOMMENDATIONS = 1000 };

const mt_key_table *const *mt_study_key_tables(int *n)
{
#define GOAL_KEYS(id, ...) &mt_study_goal_keys[MT_GOAL_##id],
    static const mt_key_table *const tables[] = {&mt_study_keys,
                                                 &mt_units_keys,
                                                 &mt_study_search_keys,
                                                 &mt_study_weight_sensitivity_keys,
                                                 &mt_study_variable_keys,
                                                 &mt_study_reference_keys,
                                                 &mt_study_measured_keys,
                                                 &mt_study_measurement_keys,
                                                 &mt_study_rotor_keys,
                                                 &mt_study_tail_keys,
                                                 &mt_study_machine_keys,
                                                 &mt_study_gear_keys,
                                                 &mt_study_catalogue_keys,
                                                 &mt_study_trade_keys,
                                                 &mt_study_vary_keys,
                                                 &mt_study_span_keys,
                                                 &mt_study_objective_keys,
                                                 &mt_study_response_keys,
                                                 &mt_study_published_keys,
                                                 &mt_study_published_frequency_keys,
                                                 &mt_study_published_mac_keys,
                                                 MT_GOAL_LIST(GOAL_KEYS)};
#undef GOAL_KEYS
    *n = MT_COUNT(tables);
    return tables;
}

void mt_read_study_note_input(mt_study_reader *s, const char *name, const char *sha256)
{
    mt_study *const study = s->study;
    mt_input_file *const inputs =
        mt_arena_alloc(&study->mem, (size_t)study->n_inputs + 1, sizeof *inputs);
    if (inputs == NULL) {
        return;
    }
    for (int i = 0; i < study->n_inputs; i++) {
        inputs[i] = study->inputs[i];
    }
    mt_input_file *const added = &inputs[study->n_inputs];
    added->name = mt_arena_strdup(&study->mem, name);
    added->sha256 = mt_arena_strdup(&study->mem, sha256);
    study->inputs = inputs;
    study->n_inputs++;
}

void mt_read_study_note_failure(mt_study_reader *s, mt_name path, const char *file,
                                mt_status rc, const mt_err *why, bool told)
{
    if (mt_is_final(rc) || (rc == MT_E_SYSTEM && !mt_files_lack(&s->files.files, file))) {
        s->failed = rc;
        s->why = *why;
        return;
    }
    if (!told) {
        mt_diag_error(s->r.diags, path.addr, "%s", why->text);
    }
    if (s->failed == MT_OK) {
        s->failed = MT_E_INPUT;
        s->why = *why;
    }
}

/* Load a model; overrides apply to the study's own only. */
static mt_model *load_model(mt_study_reader *s, mt_name path)
{
    const mt_name own = s->study->model_path;
    mt_io_options opt = s->files;
    opt.asked = own.s != NULL && strcmp(own.s, path.s) == 0 ? opt.asked : NULL;
    mt_err why = {.code = MT_OK};
    mt_model *model = NULL;
    const int told = s->model_messages->count;
    char *const joined = mt_file_join(s->study->path, path.s);
    if (joined == NULL) {
        mt_arena_fail(s->r.mem);
        return NULL;
    }
    const mt_status rc = mt_model_load(joined, &opt, &model, s->model_messages, &why);
    if (rc == MT_OK) {
        mt_read_study_note_input(s, path.s, model->sha256);
    } else if (rc == MT_E_USAGE) { /* of what is asked for: of no file */
        s->failed = rc;
        s->why = why;
    } else {
        mt_read_study_note_failure(s, path, joined, rc, &why, s->model_messages->count > told);
    }
    free(joined);
    return model;
}

const mt_model *mt_read_study_model(mt_study_reader *s, mt_name path)
{
    mt_study *const study = s->study;
    if (path.s == NULL) {
        return NULL;
    }
    for (int i = 0; i < s->n_read; i++) {
        if (strcmp(s->read[i].path.s, path.s) == 0) {
            return s->read[i].model;
        }
    }
    mt_study_file *const read =
        mt_arena_grow(&study->mem, s->read, s->n_read, &s->cap_read, sizeof *read);
    mt_model **const models = mt_arena_grow(&study->mem, study->models, study->n_models,
                                            &study->cap_models, sizeof(mt_model *));
    if (read == NULL || models == NULL) {
        return NULL;
    }
    study->models = models;
    models[study->n_models] = load_model(s, path);
    read[s->n_read] = (mt_study_file){path, models[study->n_models]};
    study->n_models += models[study->n_models] != NULL ? 1 : 0;
    s->read = read;
    return s->read[s->n_read++].model;
}

/* The study's own model, the names that expressions may use, and the parameters' values, before
 * anything that is measured in them. */
static void read_model(mt_study_reader *s, mt_addr value)
{
    mt_study *const study = s->study;
    study->model_path = mt_reader_ref(&s->r, value);
    study->model = mt_read_study_model(s, study->model_path);
    if (study->model == NULL) {
        return;
    }
    const size_t n = (size_t)study->model->n_parameters;
    const char **const names = mt_arena_alloc(&study->mem, n, sizeof *names);
    double *const values = mt_arena_f64(&study->mem, n, 1);
    if (mt_arena_failed(&study->mem)) {
        return;
    }
    for (size_t i = 0; i < n; i++) {
        names[i] = study->model->parameters[i].name.s;
    }
    s->r.lookup = mt_model_lookup;
    s->r.context = study->model;
    s->r.kinds = mt_model_kind;
    s->r.names = names;
    s->r.n_names = study->model->n_parameters;
    const mt_status rc =
        mt_model_original_values(study->model, &study->mem, values, NULL, NULL);
    if (rc == MT_E_MEMORY) {
        mt_arena_fail(&study->mem); /* it was told, and rewound */
    }
    study->original = rc == MT_OK ? values : NULL; /* mt_study_finish says what is wrong */
}

static void note_asked(mt_study_reader *s, const mt_requested_number *number)
{
    mt_study *const study = s->study;
    mt_requested_number *const all = mt_arena_grow(&study->mem, study->asked, study->n_asked,
                                                   &study->cap_asked, sizeof *all);
    if (all != NULL) {
        all[study->n_asked++] = *number;
        study->asked = all;
    }
}

static void note_settings(mt_study_reader *s)
{
    const mt_model *const m = s->study->model;
    for (int i = 0; m != NULL && i < m->n_settings; i++) {
        const mt_setting *const set = &m->settings[i];
        const mt_parameter *const p = &m->parameters[set->parameter];
        note_asked(s, &(mt_requested_number){.kind = "parameter",
                                             .name = p->name.s,
                                             .unit = p->unit,
                                             .shown = mt_study_unit(s->study, set->parameter),
                                             .value = set->value,
                                             .original = set->original});
    }
}

/* A number of the search, overridden or as in the study; `none`: neither. */
static long override_search_number(mt_study_reader *s, const char *name, long said, long asked,
                                   long none)
{
    if (asked == none) {
        return said;
    }
    note_asked(s, &(mt_requested_number){.kind = "search",
                                         .name = name,
                                         .value = (double)asked,
                                         .original = said == none ? nan("") : (double)said});
    return asked;
}

static void ask_search(mt_study_reader *s)
{
    const mt_overrides *const asked = s->files.asked;
    mt_search *const search = &s->study->search;
    if (asked != NULL) {
        search->seed = (unsigned long)override_search_number(s, "seed", (long)search->seed,
                                                             asked->seed, -1);
        search->starts =
            (int)override_search_number(s, "starts", search->starts, asked->starts, 0);
        search->max_evaluations = override_search_number(
            s, "max_evaluations", search->max_evaluations, asked->max_evaluations, 0);
        search->max_modal_solutions =
            override_search_number(s, "max_modal_solutions", search->max_modal_solutions,
                                   asked->max_modal_solutions, 0);
        if (MT_HAS(asked->proof_s)) {
            note_asked(s, &(mt_requested_number){.kind = "search",
                                                 .name = "proof_s",
                                                 .value = asked->proof_s,
                                                 .original = search->proof_s});
            search->proof_s = asked->proof_s;
        }
    }
}

static void read_search(mt_study_reader *s, mt_addr value)
{
    mt_search *const search = &s->study->search;
    mt_study_object o;
    if (value == MT_NO_ADDR || !mt_read_study_object(s, value, &mt_study_search_keys, &o)) {
        return;
    }
    search->seed = (unsigned long)mt_reader_count(&s->r, o.found[SEARCH_SEED], 0, INT_MAX,
                                                  (int)search->seed);
    search->starts = mt_reader_count(&s->r, o.found[SEARCH_STARTS], 1, MT_STARTS_MOST, 0);
    search->max_evaluations =
        mt_reader_count(&s->r, o.found[SEARCH_MAX_EVALUATIONS], 1, INT_MAX, 0);
    search->max_modal_solutions =
        mt_reader_count(&s->r, o.found[SEARCH_MAX_SOLUTIONS], 1, INT_MAX, 0);
    search->proof_s = mt_read_study_number(s, o.found[SEARCH_PROOF]);
}

static void read_weight_sensitivity(mt_study_reader *s, mt_addr value)
{
    mt_study_object o;
    if (value != MT_NO_ADDR &&
        mt_read_study_object(s, value, &mt_study_weight_sensitivity_keys, &o)) {
        mt_weight_sensitivity *const weight_sensitivity = &s->study->weight_sensitivity;
        weight_sensitivity->factor =
            mt_read_study_number(s, o.found[WEIGHT_SENSITIVITY_FACTOR]);
        weight_sensitivity->addr = value;
    }
}

static void read_study_root(mt_study_reader *s)
{
    mt_study *const study = s->study;
    mt_study_object o;
    if (!mt_reader_format(&s->r, "modetune-study/1", "study file") ||
        !mt_read_study_object(s, MT_JSON_ROOT, &mt_study_keys, &o)) {
        return;
    }
    study->name = mt_reader_text(&s->r, o.found[STUDY_NAME]);
    study->description = mt_reader_text(&s->r, o.found[STUDY_DESCRIPTION]);
    study->author = mt_reader_text(&s->r, o.found[STUDY_AUTHOR]);
    study->revision = mt_reader_text(&s->r, o.found[STUDY_REVISION]);
    study->date = mt_reader_text(&s->r, o.found[STUDY_DATE]);
    study->accepted = mt_reader_accepted(&s->r, o.found[STUDY_ACCEPTED]);
    study->recommendations = mt_reader_count(&s->r, o.found[STUDY_RECOMMENDATIONS], 1,
                                             MAX_RECOMMENDATIONS, study->recommendations);
    study->alternatives = o.found[STUDY_RECOMMENDATIONS] != MT_NO_ADDR;
    read_model(s, o.found[STUDY_MODEL]);
    mt_read_units(&s->r, o.found[STUDY_UNITS], study->units);
    note_settings(s);
    read_search(s, o.found[STUDY_SEARCH]);
    ask_search(s);
    mt_read_study_variables(s, o.found[STUDY_VARIABLES]);
    mt_read_study_references(s, o.found[STUDY_REFERENCES]);
    mt_read_study_measurements(s, o.found[STUDY_MEASUREMENTS]);
    mt_read_study_goals(s, o.found[STUDY_GOALS]);
    mt_read_study_aircraft(s, o.found[STUDY_AIRCRAFT]);
    mt_read_study_objectives(s, o.found[STUDY_OBJECTIVE]);
    read_weight_sensitivity(s, o.found[STUDY_WEIGHT_SENSITIVITY]);
    mt_read_study_trade(s, o.found[STUDY_TRADE], o.found[STUDY_GOALS]);
    mt_read_study_responses(s, o.found[STUDY_RESPONSES]);
    mt_read_study_published(s, o.found[STUDY_PUBLISHED]);
}

static mt_status read_document(mt_study_reader *s, mt_err *err)
{
    mt_study *const study = s->study;
    read_study_root(s);
    if (study->name == NULL) { /* "beam" of "studies/beam.json" */
        const char *const file = mt_text_base_name(study->path);
        const char *const dot = strrchr(file, '.');
        const size_t length = dot == NULL || dot == file ? strlen(file) : (size_t)(dot - file);
        study->name = mt_arena_strndup(&study->mem, file, length);
    }
    MT_TRY(mt_arena_check(s->r.mem, err));
    if (s->failed != MT_OK && s->failed != MT_E_INPUT) {
        return mt_fail(err, s->failed, "%s", s->why.text);
    }
    if (study->model != NULL) {
        const mt_status rc = mt_study_finish(study, s->r.diags, err);
        if (rc != MT_OK && rc != MT_E_INPUT) {
            return rc;
        }
    }
    const mt_status rc = mt_reader_status(&s->r, study->path, err);
    if (rc == MT_OK && s->failed != MT_OK) {
        return mt_fail(err, s->failed, "%s", s->why.text);
    }
    return rc;
}

/* Parse and read the study's text; the document's diagnostics go to messages, before those of
 * the models. */
static mt_status read_study_text(mt_study_reader *s, const mt_file *file,
                                 mt_diagnostics *messages, mt_err *err)
{
    mt_json *doc = NULL;
    mt_diagnostics model_messages = {.count = 0};
    mt_status rc = mt_json_parse(file->bytes, file->length, &doc, err);
    if (doc == NULL) {
        return rc;
    }
    s->study->document = doc; /* deleted with it */
    s->r.doc = doc;
    s->r.diags = mt_json_diags(doc);
    s->model_messages = &model_messages;
    int *const structural = s->files.structural;
    s->files.structural = NULL; /* counts this file, not the models */
    rc = rc == MT_OK ? read_document(s, err) : mt_json_status(doc, s->study->path, err);
    if (structural != NULL) {
        *structural = s->r.diags->structural;
    }
    if (messages != NULL) {
        mt_json_report(doc, s->study->path, messages);
        mt_diagnostics_append(messages, &model_messages);
    }
    if (model_messages.lines.failed || (messages != NULL && messages->lines.failed)) {
        rc = mt_fail_memory(err);
    }
    s->model_messages = NULL;
    mt_diagnostics_free(&model_messages);
    return rc;
}

mt_status mt_study_load(const char *path, const mt_io_options *opt, mt_study **out,
                        mt_diagnostics *messages, mt_err *err)
{
    mt_file file = {0};
    char *root = NULL;
    mt_study_reader s = {.failed = MT_OK};
    *out = NULL;
    mt_status rc = mt_study_new(&s.study, err);
    if (rc != MT_OK) {
        return rc;
    }
    const mt_io_options none = {0};
    s.files = opt == NULL ? none : *opt;
    s.r.mem = &s.study->mem;
    s.r.warning_list = &s.study->warning_list;
    s.study->path = mt_arena_strdup(&s.study->mem, path);
    root = s.files.root == NULL ? mt_file_default_root(path) : NULL;
    if (root == NULL && s.files.root == NULL) {
        mt_arena_fail(&s.study->mem);
    }
    rc = mt_arena_check(&s.study->mem, err);
    if (rc != MT_OK) {
        goto done;
    }
    s.files.root = root == NULL ? s.files.root : root;
    const size_t limit = s.files.max_bytes == 0 ? MT_JSON_MAX_BYTES : s.files.max_bytes;
    rc = mt_files_read(&s.files.files, path, NULL, limit, &file, err);
    if (rc != MT_OK) {
        goto done;
    }
    mt_read_study_note_input(&s, mt_text_base_name(path), file.sha256);
    rc = read_study_text(&s, &file, messages, err);
done:
    mt_file_free(&file);
    free(root);
    if (rc != MT_OK) {
        mt_study_delete(s.study);
        return rc;
    }
    *out = s.study;
    return MT_OK;
}
