/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the readers of all parts share: files that a study names; values of members, and the
 * units they are in: numbers of a study are values of the model's parameters, or are held
 * against expressions of them. */
#include "study/reader.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/file.h"
#include "io/reader.h"
#include "model/values.h"

mt_study_reader *mt_study_reader_of(mt_reader *r)
{
    return (mt_study_reader *)(void *)r;
}

/* Files */

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

/* Files that the model includes are read for the study, too. */
static void note_included(mt_study_reader *s, const char *path, const mt_model *model)
{
    for (int i = 0; i < model->n_included; i++) {
        char *const joined = mt_file_join(path, model->included[i].name);
        const char *const name =
            joined == NULL ? NULL : mt_arena_strdup(&s->study->mem, joined);
        free(joined);
        if (name == NULL) {
            mt_arena_fail(&s->study->mem);
            return;
        }
        mt_read_study_note_input(s, name, model->included[i].sha256);
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
        note_included(s, path.s, model);
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

/* Values */

static double read_expr_number(mt_study_reader *s, mt_addr value)
{
    if (value == MT_NO_ADDR || !mt_reader_type(&s->r, value, MT_KEY_NUMBER)) {
        return nan("");
    }
    if (mt_json_type_of(s->r.doc, value) == MT_JSON_NUMBER) {
        return mt_json_number(s->r.doc, value);
    }
    const mt_model *const model = s->study->model;
    mt_expr e = {0};
    if (model == NULL || s->study->original == NULL || !mt_reader_expr(&s->r, value, &e)) {
        return nan(""); /* without a model nothing can be said about its parameters */
    }
    double number = nan("");
    const mt_status rc =
        mt_model_expr_value(model, s->study->original, &e, &s->study->mem, &number, NULL);
    if (rc == MT_E_MEMORY) {
        mt_arena_fail(s->r.mem); /* it was told, and rewound */
    } else if (rc != MT_OK) {
        mt_diag_error(s->r.diags, value, "\"%s\" has no finite value at the original design",
                      mt_json_string(s->r.doc, value));
    }
    return rc == MT_OK ? number : nan("");
}

double mt_read_study_number(mt_study_reader *s, mt_addr value)
{
    const double number = read_expr_number(s, value);
    mt_reader_check_range(&s->r, value, value, number);
    return number;
}

/* A place in the struct. */
static void *place(void *item, size_t at)
{
    return (char *)item + at;
}

void mt_study_number(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    double *const at = place(item, key->at);
    const double number = mt_read_study_number(mt_study_reader_of(r), value);
    *at = MT_HAS(number) ? number : *at;
}

void mt_study_value(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    double *const at = place(item, key->at);
    const mt_name *const parameter = place(item, key->other);
    const double number = mt_read_study_value(mt_study_reader_of(r), value, parameter->s);
    *at = MT_HAS(number) ? number : *at;
}

void mt_study_pair(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    double *const out[] = {place(item, key->at), place(item, key->other)};
    mt_addr ends[MT_COUNT(out)];
    if (!mt_reader_type(r, value, MT_KEY_LIST)) {
        return;
    }
    if (mt_reader_pair(r, value, &ends[0], &ends[1]) != MT_COUNT(out)) {
        mt_diag_structure(r->diags, value, "must be two numbers: [lower, upper]");
        return;
    }
    for (int i = 0; i < MT_COUNT(out); i++) {
        *out[i] = read_expr_number(mt_study_reader_of(r), ends[i]);
        mt_reader_check_range_of(r, key->name, ends[i], *out[i], key->possible);
    }
}

void mt_study_expr(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    const char *const text = mt_reader_text(r, value);
    *(mt_expr *)place(item, key->at) = (mt_expr){0};
    *(const char **)place(item, key->other) = text;
    if (text != NULL && mt_study_reader_of(r)->study->model != NULL) {
        (void)mt_reader_expr_text(r, value, text, place(item, key->at));
    }
}

void mt_study_mode(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_mode_ref *const mode = place(item, key->at);
    if (mt_json_type_of(r->doc, value) == MT_JSON_STRING) {
        mode->mode_name = mt_reader_ref(r, value);
    } else {
        mode->index = mt_reader_count(r, value, 1, MT_MAX_LIST, 0);
    }
}

static int parameter_of(const mt_study_reader *s, const char *name)
{
    const mt_model *const m = s->study->model;
    return m == NULL || name == NULL ? MT_ABSENT : mt_model_find_parameter(m, name);
}

static bool is_bare(const mt_study_reader *s, mt_addr value)
{
    return value != MT_NO_ADDR && mt_json_type_of(s->r.doc, value) == MT_JSON_NUMBER &&
           mt_json_number(s->r.doc, value) != 0.0;
}

/* True where the study gives units other than SI. */
static bool says_units(const mt_study *study)
{
    bool says = false;
    for (int d = 0; d < MT_DIMENSION_COUNT; d++) {
        says = says || (study->units[d] != NULL && !mt_unit_is_si(study->units[d]));
    }
    return says;
}

/* Note a bare number for a parameter of unknown unit: it is not known whether the study's units
 * apply to it. */
static void check_known(mt_study_reader *s, mt_addr value, int parameter)
{
    const mt_parameter *const p = &s->study->model->parameters[parameter];
    if (p->unit == NULL && says_units(s->study) && is_bare(s, value)) {
        mt_diag_error(s->r.diags, value,
                      "the model does not say which unit \"%s\" has, so that it is not known "
                      "whether \"units\" hold for this number: say it there (\"1\": none), or "
                      "write the number as an expression, \"%.10g\", which is in SI units",
                      p->name.s, mt_json_number(s->r.doc, value));
    }
}

double mt_read_study_value(mt_study_reader *s, mt_addr value, const char *parameter)
{
    const int p = parameter_of(s, parameter);
    const double number = mt_read_study_number(s, value);
    if (p == MT_ABSENT || !MT_HAS(number)) {
        return number;
    }
    const mt_unit *const unit = mt_study_unit(s->study, p);
    if (mt_json_type_of(s->r.doc, value) == MT_JSON_NUMBER) {
        check_known(s, value, p);
        return mt_unit_to_si(unit, number);
    }
    mt_expr e = {0};
    if (mt_reader_expr(&s->r, value, &e)) {
        mt_reader_check_kind(&s->r, value, &e, unit);
    }
    return number;
}

void mt_read_study_check_requirement(mt_study_reader *s, const mt_expr *of, mt_addr value)
{
    const mt_unit *const unit =
        s->study->model == NULL ? NULL : mt_study_requirement_unit(s->study, of);
    if (unit == NULL || value == MT_NO_ADDR) {
        return;
    }
    if (is_bare(s, value)) {
        char text[MT_KIND_TEXT];
        mt_kind_bare_text(mt_json_number(s->r.doc, value), unit,
                          "expressions and what they are held against", text, sizeof text);
        mt_diag_error(s->r.diags, value, "%s", text);
        return;
    }
    mt_expr e = {0};
    if (mt_json_type_of(s->r.doc, value) == MT_JSON_STRING &&
        mt_reader_expr(&s->r, value, &e)) {
        mt_reader_check_kind(&s->r, value, &e, unit);
    }
}
