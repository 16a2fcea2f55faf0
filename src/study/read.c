/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/read.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/file.h"
#include "io/json.h"
#include "io/reader.h"
#include "model/values.h"
#include "study/check.h"
#include "study/reader.h"

enum { MAX_RECOMMENDATIONS = 1000, DEFAULT_RECOMMENDATIONS = 5, DEFAULT_SEED = 1 };

#define THIS mt_search
static const mt_key SEARCH[] = {
    MT_M_ULONG("seed", seed, 0, INT_MAX,
               "Seed of the starting points: the same seed gives the same answer, to the byte.",
               .otherwise = "1"),
    MT_M_COUNT("starts", false, starts, 1, MT_STARTS_MOST,
               "Local searches from different starting points. Absent: chosen by the number of "
               "variables."),
    MT_M_LONG("max_evaluations", false, max_evaluations, 1, INT_MAX,
              "Most evaluations of the model for the whole answer (of a trade study: for each "
              "point, and for the study itself): searches, positions of drives, the repeated "
              "analyses of the original design and of at least one other, other weights, "
              "relaxations. Absent: as many as it takes."),
    MT_M_LONG("max_modal_solutions", false, max_modal_solutions, 1, INT_MAX,
              "Most modal solutions for the whole answer, beside or instead of "
              "max_evaluations: an evaluation takes one for each configuration, each position "
              "of a drive and each corner of the tolerances that it is held at, judging a "
              "design over its tolerances some hundred more. What has begun when they are "
              "spent is finished: a judgement may go beyond. Absent: as many as it takes."),
    MT_S_NUMBER("proof_s", false, proof_s, PROOF,
                "Most work of each proof, in nominal seconds of 1e9 multiplications, about one "
                "of a core: counted, not timed, so that the same is proven on any machine with "
                "any number of workers. What a proof leaves open when it ends is said, never "
                "claimed. 0: no proof; from 0 to 1e6. Proofs are: of the mode placements, of "
                "what no combination of catalogues exceeds, that no design meets the limits, "
                "of each design's tolerance box. Absent: 5.",
                .examples = "[30]"),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_study_search_keys = {
    .what = "search", .keys = SEARCH, .n = MT_COUNT(SEARCH), .says = "How the search runs."};

#define THIS mt_weight_sensitivity
static const mt_key WEIGHT_SENSITIVITY[] = {
    MT_S_NUMBER("factor", true, factor, WEIGHT_SENSITIVITY, "Above 1.", .examples = "[4]"),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_study_weight_sensitivity_keys = {
    .what = "spread",
    .keys = WEIGHT_SENSITIVITY,
    .n = MT_COUNT(WEIGHT_SENSITIVITY),
    .says = "How far the best design of a misfit moves under other weights: each weighted "
            "goal's weight is multiplied and divided by the factor in turn and the misfit "
            "minimised again. It is a sensitivity to the weights, not an uncertainty: repeated "
            "noisy tests may scatter many times more."};

/* In the order of mt_dimension. */
static const mt_key UNITS[] = {
    {.name = "length",
     .type = MT_KEY_TEXT,
     .choices = mt_length_names,
     .n_choices = MT_COUNT(mt_length_names),
     .says = "Unit of parameters that are lengths. Absent: each in its own."},
    {.name = "angle",
     .type = MT_KEY_TEXT,
     .choices = mt_angle_names,
     .n_choices = MT_COUNT(mt_angle_names),
     .says = "Unit of parameters that are angles. Absent: each in its own."},
    {.name = "speed",
     .type = MT_KEY_TEXT,
     .choices = mt_speed_names,
     .n_choices = MT_COUNT(mt_speed_names),
     .says = "Unit of parameters in Hz, such as speeds of rotors. Absent: each in its own."},
};
const mt_key_table mt_study_units_keys = {
    .what = "units",
    .keys = UNITS,
    .n = MT_COUNT(UNITS),
    .says =
        "Units of numbers that are values of parameters (bounds, catalogues, scales, values of "
        "a trade study, published values) and that people are shown them in. Absent: of each "
        "parameter's own unit in the model. Members that end in a unit stay in that. "
        "Expressions (strings) are always in SI units: \"150*mm\", \"10*deg\" say otherwise."};

static const char *const FORMATS[] = {"modetune-study/1"};

/* Rows without a place are read by read_study_root, in the order in which files are loaded. */
#define THIS mt_study
static const mt_key STUDY[] = {
    MT_M_FREE("$schema", "This schema, for the editor."),
    MT_M_FORMAT(FORMATS),
    MT_M_TEXT("name", name, "What the study is called. Absent: the file's name."),
    MT_M_TEXT("description", description, "Free text for people."),
    MT_M_FREE("source", "Where it comes from: a table, a page, a test report."),
    MT_M_TEXT("author", author, "Who asks: stands in the report's title block.",
              .examples = "[\"A. Engineer, Dynamics\"]"),
    MT_M_TEXT("revision", revision,
              "Issue of the question: stands in the report's title block.",
              .examples = "[\"B\"]"),
    MT_M_TEXT("date", date,
              "Date of the question, as it is to be read: stands in the report's title block.",
              .examples = "[\"2026-03-02\"]"),
    {.name = "accepted",
     .type = MT_KEY_LIST,
     .choices = mt_warning_names,
     .n_choices = MT_COUNT(mt_warning_names),
     .says = "Names of warnings that you know and accept, those of the model included: they "
             "become notes.",
     .examples = "[[\"density\"]]"},
    MT_M_JUST("model", TEXT, true, NONE, "Model file, relative to this file.",
              .examples = "[\"../problems/inceptor.json\"]"),
    MT_M_OBJECT("units", mt_study_units_keys),
    MT_M_JUST("catalogues", OBJECT, false, NONE,
              "Parts whose numbers come together, by name: variables take a row of one.",
              .schema = "\"type\": \"object\", \"propertyNames\": {\"pattern\": "
                        "\"^[A-Za-z_][A-Za-z0-9_+-]*$\"}, \"additionalProperties\": {\"$ref\": "
                        "\"#/definitions/parts\"}"),
    MT_M_LIST_OF("variables", mt_study_variable_keys,
                 "What may change. Without variables the study only verifies."),
    MT_M_JUST("goals", LIST, false, NONE, "The goals.",
              .schema = "\"type\": \"array\", \"items\": {\"$ref\": \"#/definitions/goal\"}"),
    MT_M_JUST("objective", OBJECT_OR_LIST, false, NONE,
              "What decides between designs that meet the goals: one objective, or a list in "
              "order of priority, each of which is made best while the earlier ones are held. "
              "Among designs that are equal in all of them the one of least change is "
              "reported. Absent: the least change.",
              .schema = "\"if\": {\"type\": \"array\"}, \"then\": {\"minItems\": 1, \"items\": "
                        "{\"$ref\": \"#/definitions/objective\"}}, \"else\": {\"$ref\": "
                        "\"#/definitions/objective\"}, \"type\": [\"object\", \"array\"]"),
    MT_M_JUST("references", OBJECT, false, NONE, "Modes to compare with, by name.",
              .schema = "\"type\": \"object\", \"propertyNames\": {\"pattern\": "
                        "\"^[A-Za-z_][A-Za-z0-9_+-]*$\"}, \"additionalProperties\": {\"$ref\": "
                        "\"#/definitions/reference\"}"),
    MT_M_JUST("measurements", OBJECT, false, NONE,
              "Measured frequency responses to compare with, by name.",
              .schema = "\"type\": \"object\", \"propertyNames\": {\"pattern\": "
                        "\"^[A-Za-z_][A-Za-z0-9_+-]*$\"}, \"additionalProperties\": {\"$ref\": "
                        "\"#/definitions/measurement\"}"),
    MT_M_COUNT("recommendations", false, recommendations, 1, MAX_RECOMMENDATIONS,
               "Most designs to recommend.", .otherwise = "5"),
    MT_M_OBJECT("search", mt_study_search_keys),
    MT_M_OBJECT("spread", mt_study_weight_sensitivity_keys),
    MT_M_JUST("aircraft", TEXT, false, NONE,
              "Catalogue of aircraft that rotors are looked up in, relative to this file. "
              "Absent: aircraft.json beside the model, or else the one that is part of the "
              "program, where a rotor names an aircraft.",
              .examples = "[\"../problems/aircraft.json\"]"),
    MT_M_OBJECT("trade", mt_study_trade_keys),
    MT_M_LIST_OF(
        "responses", mt_study_response_keys,
        "Frequency responses that the result shows of the original design and of every design "
        "recommended: their curves, peaks and antiresonances. They are shown, not judged."),
    MT_M_LIST_OF("published", mt_study_published_keys,
                 "Published values that `modetune run --verify` and `modetune compare` judge."),
};
#undef THIS
const mt_key_table mt_study_keys = {
    .what = "",
    .keys = STUDY,
    .n = MT_COUNT(STUDY),
    .says = "A question asked of a mechanism: which parameters may change, which natural "
            "frequencies and shapes are wanted, what is known already."};

const mt_key_table *const *mt_study_key_tables(int *n)
{
#define GOAL_KEYS(id, name, ...) &mt_goal_##name##_keys,
    static const mt_key_table *const tables[] = {&mt_study_keys,
                                                 &mt_study_units_keys,
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
                                                 &mt_study_parts_keys,
                                                 &mt_study_trade_keys,
                                                 &mt_study_vary_keys,
                                                 &mt_study_span_keys,
                                                 &mt_study_objective_keys,
                                                 &mt_study_response_keys,
                                                 &mt_study_published_keys,
                                                 &mt_study_published_frequency_keys,
                                                 &mt_study_published_mac_keys,
                                                 &mt_study_goal_of_keys,
                                                 MT_GOAL_LIST(GOAL_KEYS)};
#undef GOAL_KEYS
    *n = MT_COUNT(tables);
    return tables;
}

const mt_schema_type *mt_study_types(int *n)
{
    static const mt_schema_type types[] = {
        {.name = "number",
         .says = "A number in the unit that the member names, of a parameter in the study's "
                 "units or its own, else SI; or an expression of the model's parameters as a "
                 "string, in SI units (\"2*m\", \"10*deg\", \"150*mm\", \"258*rpm\"), "
                 "evaluated at the original design.",
         .schema = "\"type\": [\"number\", \"string\"]"},
        {.name = "index",
         .says =
             "A vibration mode, counted from 1 by ascending frequency; rigid-body modes have "
             "no index. All designs of a study are counted alike: where a stiffness that the "
             "variables can raise is 0, the mode that it lets go is a vibration of 0 Hz.",
         .schema = "\"type\": \"integer\", \"minimum\": 1, \"maximum\": 100000"},
        {.name = "mode",
         .says = "A vibration mode: its index, counted from 1 by ascending frequency without "
                 "the rigid-body modes, or the name of one of the model's named modes, which "
                 "is tracked by its shape.",
         .schema = "\"type\": [\"integer\", \"string\"], \"minimum\": 1, \"maximum\": 100000"},
        {.name = "pair",
         .says = "Lower and upper bound.",
         .schema = "\"type\": \"array\", \"minItems\": 2, \"maxItems\": 2, \"items\": "
                   "{\"$ref\": \"#/definitions/number\"}"},
    };
    *n = MT_COUNT(types);
    return types;
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
    s->r.curves = study->model->curves;
    s->r.n_curves = study->model->n_curves;
    const mt_status rc =
        mt_model_original_values(study->model, &study->mem, values, NULL, NULL);
    if (rc == MT_E_MEMORY) {
        mt_arena_fail(&study->mem); /* it was told, and rewound */
    }
    study->original = rc == MT_OK ? values : NULL; /* check_study says what is wrong */
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

/* A list of the root: structs of a table, and their number. */
static void *read_list(mt_study_reader *s, const mt_object *o, const char *member,
                       const mt_key_table *of, int *n)
{
    void *list = NULL;
    const mt_addr value = mt_object_value(o, member);
    if (value != MT_NO_ADDR) {
        list = mt_members_list(&s->r, value, NULL, of, n);
    }
    return list;
}

static void read_study_root(mt_study_reader *s)
{
    mt_study *const study = s->study;
    mt_object o;
    if (!mt_reader_format(&s->r, "modetune-study/1", "study file") ||
        !mt_object_match(&s->r, MT_JSON_ROOT, &mt_study_keys, &o)) {
        return;
    }
    const mt_addr sensitivity = mt_object_value(&o, "spread");
    const mt_addr search = mt_object_value(&o, "search");
    mt_object_read(&s->r, &o, study);
    study->accepted = mt_reader_accepted(&s->r, mt_object_value(&o, "accepted"));
    study->alternatives = mt_object_value(&o, "recommendations") != MT_NO_ADDR;
    read_model(s, mt_object_value(&o, "model"));
    mt_read_units(&s->r, mt_object_value(&o, "units"), &mt_study_units_keys, study->units);
    note_settings(s);
    if (search != MT_NO_ADDR) {
        (void)mt_members_read(&s->r, search, &mt_study_search_keys, &study->search);
    }
    ask_search(s);
    study->catalogues =
        mt_read_study_catalogues(s, mt_object_value(&o, "catalogues"), &study->n_catalogues);
    study->variables =
        read_list(s, &o, "variables", &mt_study_variable_keys, &study->n_variables);
    mt_read_study_references(s, mt_object_value(&o, "references"),
                             mt_object_value(&o, "measurements"));
    mt_read_study_goals(s, mt_object_value(&o, "goals"));
    mt_read_study_aircraft(s, mt_object_value(&o, "aircraft"));
    mt_read_study_objectives(s, mt_object_value(&o, "objective"));
    if (sensitivity != MT_NO_ADDR &&
        mt_members_read(&s->r, sensitivity, &mt_study_weight_sensitivity_keys,
                        &study->weight_sensitivity)) {
        study->weight_sensitivity.addr = sensitivity;
    }
    mt_read_study_trade(s, mt_object_value(&o, "trade"), mt_object_value(&o, "goals"));
    study->responses =
        read_list(s, &o, "responses", &mt_study_response_keys, &study->n_responses);
    study->published =
        read_list(s, &o, "published", &mt_study_published_keys, &study->n_published);
}

/* Values at the original design, once: variables start from them. */
static mt_status evaluate_original(mt_study_check *c, mt_err *err)
{
    mt_study *const s = c->study;
    if (s->original != NULL) {
        return MT_OK;
    }
    double *const values = mt_arena_f64(&s->mem, (size_t)c->model->n_parameters, 1);
    MT_TRY(mt_arena_check(&s->mem, err));
    mt_err why = {.code = MT_OK};
    const mt_status rc = mt_model_original_values(c->model, &s->mem, values, NULL, &why);
    if (rc == MT_E_DOMAIN || rc == MT_E_INPUT) {
        mt_diag_error(c->diags, s->model_path.addr, "%s: %s", s->model_path.s, why.text);
        return MT_E_INPUT;
    }
    s->original = rc == MT_OK ? values : NULL;
    return rc == MT_OK ? rc : mt_fail(err, rc, "%s", why.text);
}

/*
 * Resolve names and check the study, noting all problems at once: unknown names with "did you
 * mean", bounds in the wrong order, catalogue and bounds together, duplicate variables, goals
 * without a requirement, weights without the objective "misfit" and the reverse, a variable
 * overridden in every configuration that the goals name, references without a common sensor,
 * mode indices below 1, ... Fill in defaults (configuration: the model's only one; objective:
 * change; range of a variable), sort catalogues, look up aircraft, make the bands, set
 * `original` and `warnings`. study->model is already set and finished. Bounds at or below 0 are
 * allowed for a positive parameter (problem.h defines its change then). Returns MT_E_INPUT
 * where diags holds errors, MT_E_MEMORY.
 */
static mt_status check_study(mt_study *study, mt_diags *diags, mt_err *err)
{
    mt_study_check c = {.study = study, .model = study->model, .diags = diags};
    const mt_status rc = evaluate_original(&c, err);
    if (rc != MT_OK && rc != MT_E_INPUT) {
        return rc;
    }
    mt_study_check_references(&c);
    mt_study_check_variables(&c);
    mt_study_check_goals(&c);
    mt_study_check_overrides(&c);
    mt_study_check_objectives(&c);
    mt_study_check_published(&c);
    mt_study_check_responses(&c);
    mt_study_check_trade(&c);
    if (study->recommendations < 1) {
        mt_diag_error(diags, mt_diag_member(diags, MT_JSON_ROOT, "recommendations"),
                      "recommendations (%d) must be above 0", study->recommendations);
    }
    if (!mt_arena_failed(&study->mem)) {
        mt_study_check_warnings(&c);
    }
    mt_study_check_bounds(&c);
    MT_TRY(mt_arena_check(&study->mem, err));
    MT_TRY(mt_arena_check(diags->mem, err));
    if (diags->errors > 0) {
        return mt_fail(err, MT_E_INPUT, "%s",
                       diags->count > 0 ? diags->items[0].text : "the study has errors");
    }
    return MT_OK;
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
        const mt_status rc = check_study(study, s->r.diags, err);
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

/* NULL: out of memory. */
static mt_study *new_study(void)
{
    mt_study *const study = calloc(1, sizeof *study);
    if (study == NULL || mt_arena_init(&study->mem, 0, NULL) != MT_OK) {
        free(study);
        return NULL;
    }
    study->warning_list = mt_warning_list_default(&study->mem);
    study->recommendations = DEFAULT_RECOMMENDATIONS;
    study->search = (mt_search){.seed = DEFAULT_SEED, .proof_s = nan("")};
    study->weight_sensitivity = (mt_weight_sensitivity){.factor = nan(""), .addr = MT_NO_ADDR};
    return study;
}

mt_status mt_study_load(const char *path, const mt_io_options *opt, mt_study **out,
                        mt_diagnostics *messages, mt_err *err)
{
    mt_file file = {0};
    char *root = NULL;
    mt_study_reader s = {.study = new_study(), .failed = MT_OK};
    *out = NULL;
    if (s.study == NULL) {
        return mt_fail_memory(err);
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
    mt_status rc = mt_arena_check(&s.study->mem, err);
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
