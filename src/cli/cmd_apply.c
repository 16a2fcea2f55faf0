/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * modetune apply: the model's own text with the recommended numbers put in, and those that the
 * study was asked with instead of the model's own, each in the unit that the model gives it in:
 * a number that reads as the same value, or as one next to it (expr/units.h).
 */
#include "modetune/version.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/find_model.h"

typedef struct replacement {
    size_t begin;
    size_t end;
    double value;
} replacement;

/* Ascending by begin. */
static int by_place(const void *a, const void *b)
{
    const replacement *const x = a;
    const replacement *const y = b;
    return (x->begin > y->begin) - (x->begin < y->begin);
}

/* The unit of this parameter's number in the model, its value having this SI unit; NULL: SI, or
 * none given. */
static const mt_unit *find_parameter_unit(const mt_json *doc, mt_addr parameter, const char *si)
{
    const mt_addr unit = mt_json_member(doc, parameter, "unit");
    const bool is_text = unit != MT_NO_ADDR && mt_json_type_of(doc, unit) == MT_JSON_STRING;
    return is_text ? mt_unit_find_of(mt_json_string(doc, unit), si) : NULL;
}

/* The text of a parameter's value in the model, and the number for it. The result is a file,
 * too, and may name a missing parameter (its reader has refused duplicates). */
static mt_status find_place(const mt_json *doc, const char *path, const char *name,
                            const char *si, double value, replacement *out, mt_err *err)
{
    const mt_addr parameters = mt_json_member(doc, MT_JSON_ROOT, "parameters");
    mt_addr at = parameters == MT_NO_ADDR ? MT_NO_ADDR : mt_json_member(doc, parameters, name);
    out->value = value;
    if (at != MT_NO_ADDR && mt_json_type_of(doc, at) == MT_JSON_OBJECT) {
        out->value = mt_unit_written(find_parameter_unit(doc, at, si), value);
        at = mt_json_member(doc, at, "value");
    }
    if (at == MT_NO_ADDR || !mt_json_span(doc, at, &out->begin, &out->end)) {
        return mt_fail(err, MT_E_INPUT, "%s: there is no parameter \"%s\"", path, name);
    }
    return isfinite(value)
               ? MT_OK
               : mt_fail(err, MT_E_INPUT, "the result recommends no value of \"%s\"", name);
}

/* Find the places of the recommended values and of the study's overrides. */
static mt_status find_places(const mt_recommendation *r, const mt_result_run *run,
                             const mt_json *doc, const char *path, replacement *list, int *n,
                             mt_err *err)
{
    *n = 0;
    for (int i = 0; i < r->n_parameters; i++) {
        const mt_result_parameter *const p = &r->parameters[i];
        MT_TRY(find_place(doc, path, p->name, p->unit, p->recommended, &list[(*n)++], err));
    }
    for (int i = 0; i < run->n_overrides; i++) {
        const mt_result_override *const o = &run->overrides[i];
        if (strcmp(o->kind, "parameter") == 0) {
            MT_TRY(find_place(doc, path, o->name, o->unit, o->value, &list[(*n)++], err));
        }
    }
    qsort(list, (size_t)*n, sizeof *list, by_place);
    for (int i = 1; i < *n; i++) {
        if (list[i].begin == list[i - 1].begin) {
            return mt_fail(err, MT_E_INPUT,
                           "the result has a parameter both recommended and set");
        }
    }
    return MT_OK;
}

static mt_status substitute(const mt_recommendation *r, const mt_result_run *run,
                            const mt_file *file, const char *path, mt_text *out, mt_err *err)
{
    mt_json *doc = NULL;
    replacement *const list =
        calloc((size_t)r->n_parameters + (size_t)run->n_overrides + 1, sizeof *list);
    int n = 0;
    if (list == NULL) {
        return mt_fail_memory(err);
    }
    mt_status rc = mt_json_parse(file->bytes, file->length, &doc, err);
    if (rc != MT_OK) {
        (void)mt_err_in(err, rc, "%s", path);
        goto done;
    }
    rc = find_places(r, run, doc, path, list, &n, err);
    size_t at = 0;
    for (int i = 0; rc == MT_OK && i < n; i++) {
        char number[MT_JSON_NUMBER_SIZE];
        mt_text_add_n(out, file->bytes + at, list[i].begin - at);
        mt_text_add(out, mt_json_format_shortest(list[i].value, number));
        at = list[i].end;
    }
    if (rc == MT_OK) {
        mt_text_add_n(out, file->bytes + at, file->length - at);
    }
done:
    mt_json_delete(doc);
    free(list);
    return rc;
}

static mt_status apply_recommendation(const mt_args *args, const mt_result *result,
                                      mt_text *out, mt_err *err)
{
    const char *const path = args->operands[0];
    const mt_recommendation *chosen = NULL;
    mt_file file = {.bytes = NULL};
    char *model_path = NULL;
    MT_TRY(mt_cli_recommendation(args, result, &chosen, err));
    mt_status rc = mt_find_model(args, result, &file, &model_path, err);
    if (rc == MT_OK) {
        rc = substitute(chosen, &result->run, &file, model_path, out, err);
    }
    const char *const version = result->run.modetune_version;
    if (rc == MT_OK && (version == NULL || strcmp(version, MT_VERSION_STRING) != 0)) {
        mt_terminal_warning(
            "%s was written by modetune %s, this is %s: its grades may differ today", path,
            version == NULL ? "of an unknown version" : version, MT_VERSION_STRING);
    }
    if (rc == MT_OK && !chosen->feasible) {
        mt_terminal_warning("recommendation %d does not meet all goals", chosen->rank);
    }
    free(model_path);
    mt_file_free(&file);
    return rc;
}

int mt_cmd_apply(const mt_args *args, mt_text *out)
{
    const mt_io_options opt = mt_cli_io(args);
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_result *result = NULL;
    mt_status rc = mt_result_load(args->operands[0], &opt, &result, &messages, &err);
    int code = mt_cli_loaded(rc, &messages, &err);
    if (rc == MT_OK) {
        rc = apply_recommendation(args, result, out, &err);
        code = rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
    }
    mt_result_delete(result);
    return code;
}
