/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The commands that read results: explain, apply and diff. */
#include "modetune/version.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"
#include "model/expand.h"
#include "report/explain.h"
#include "report/table.h"
#include "result/diff.h"
#include "result/write.h"

/* The recommendation of a rank; NULL: there is none. */
static const mt_recommendation *find_recommendation(const mt_result *result, int rank)
{
    for (int i = 0; i < result->n_recommendations; i++) {
        if (result->recommendations[i].rank == rank) {
            return &result->recommendations[i];
        }
    }
    return NULL;
}

static mt_status fail_without_rank(const mt_args *args, const mt_result *result, mt_err *err)
{
    const int n = result->n_recommendations;
    return mt_fail(err, MT_E_USAGE, "%s has %d recommendation%s: there is no rank %d",
                   args->operands[0], n, n == 1 ? "" : "s", args->rank);
}

/* modetune explain: what moves each goal of a design, what holds it, and the price. */

static void print_json(const mt_result *result, const mt_recommendation *r, mt_json_writer *w)
{
    static const char *const members[] = {"rank", "grade", "parameters", "goals", "reasons"};
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "study", result->study.file);
    for (int i = 0; i < MT_COUNT(members); i++) {
        mt_design_put_member(w, members[i], result, r);
    }
    mt_json_close(w);
}

/* The design asked for; without --rank the best, and where none is recommended the original. */
static mt_status choose_explained_design(const mt_args *args, const mt_result *result,
                                         const mt_recommendation **out, mt_err *err)
{
    if (!args->given[MT_OPT_RANK] && result->n_recommendations == 0) {
        *out = &result->baseline;
        return MT_OK;
    }
    *out = find_recommendation(result, args->rank);
    return *out != NULL ? MT_OK : fail_without_rank(args, result, err);
}

static int print(const mt_args *args, const mt_result *result, mt_text *out)
{
    const mt_recommendation *r = NULL;
    mt_json_writer w = mt_json_writer_default(out);
    mt_err err = {.code = MT_OK};
    const mt_status rc = choose_explained_design(args, result, &r, &err);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    if (args->format == MT_FORMAT_JSON) {
        print_json(result, r, &w);
        return mt_cli_json_done(&w);
    }
    if (args->format == MT_FORMAT_CSV) {
        mt_table t = mt_report_movers(r);
        mt_table_csv(&t, out);
        mt_table_free(&t);
    } else {
        mt_report_explain(result, r, mt_terminal_width(), out);
    }
    return MT_EXIT_DONE;
}

static int run_explain(const mt_args *args, mt_text *out)
{
    const mt_io_options opt = mt_cli_io(args);
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_result *result = NULL;
    const mt_status rc = mt_result_load(args->operands[0], &opt, &result, &messages, &err);
    int code = mt_cli_loaded(rc, &messages, &err);
    code = rc == MT_OK ? print(args, result, out) : code;
    mt_result_delete(result);
    return code;
}

const mt_command mt_command_explain = {
    .name = "explain",
    .operands = "RESULT.json",
    .least = 1,
    .most = 1,
    .summary = "what moves each goal, what limits the design, at what price",
    .details =
        "Prints for each goal of a recommendation the parameters that move it, the "
        "strongest first: the effect of 1 % more of each, and how far it may still go "
        "within its bounds. The bounds, bands and limits that hold the design follow, with "
        "their prices. It needs the result, or its folder, alone and solves nothing. "
        "--format csv has one row for each goal and parameter.",
    .run = run_explain,
};

/*
 * modetune apply: the model's own text with the recommended numbers put in, and those that the
 * study was asked with instead of the model's own, each in the unit that the model gives it in:
 * a number that reads as the same value, or as one next to it (expr/units.h).
 */

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
    const char *bytes = file->bytes;
    size_t length = file->length;
    if (mt_json_member(doc, MT_JSON_ROOT, "include") != MT_NO_ADDR) {
        /* its parameters stand in several files: the whole model is one that needs no other */
        rc = mt_model_expand(doc, path, NULL, NULL, err);
        rc = rc == MT_E_INPUT ? mt_json_status(doc, path, err) : rc;
        bytes = mt_json_text(doc, &length);
    }
    rc = rc == MT_OK ? find_places(r, run, doc, path, list, &n, err) : rc;
    size_t at = 0;
    for (int i = 0; rc == MT_OK && i < n; i++) {
        char number[MT_JSON_NUMBER_SIZE];
        mt_text_add_n(out, bytes + at, list[i].begin - at);
        mt_text_add(out, mt_json_format_shortest(list[i].value, number));
        at = list[i].end;
    }
    if (rc == MT_OK) {
        mt_text_add_n(out, bytes + at, length - at);
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
    const mt_recommendation *const chosen = find_recommendation(result, args->rank);
    mt_file file = {.bytes = NULL};
    char *model_path = NULL;
    if (chosen == NULL) {
        return fail_without_rank(args, result, err);
    }
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

static int run_apply(const mt_args *args, mt_text *out)
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

const mt_command mt_command_apply = {
    .name = "apply",
    .operands = "RESULT.json",
    .least = 1,
    .most = 1,
    .summary = "the model with the recommended values",
    .details =
        "Prints the model file with the recommended values; the rest of its text stays as it "
        "is, but a model that includes other files is written out whole. The model is found "
        "from the result, or its folder, and must be the one that was "
        "solved (same SHA-256) unless --model names it. A result.json whose neighbours were "
        "changed or belong to another run is refused; a copy by itself is read.",
    .run = run_apply,
};

/* modetune diff: what two results say differently. */

enum { DIGITS = 6, CHANGE_DIGITS = 3, SIDES = 2 };

/* In per cent of the first; NaN where that says nothing. */
static double change_of(const mt_difference *d)
{
    const mt_reported *const t = d->told;
    const bool numbers = t[0].type == MT_JSON_NUMBER && t[1].type == MT_JSON_NUMBER;
    const bool percent = d->unit != NULL && strcmp(d->unit, "%") == 0;
    return numbers && !percent && !d->provenance && t[0].number != 0.0
               ? 100.0 * ((t[1].number - t[0].number) / fabs(t[0].number))
               : nan("");
}

/* A difference. */
typedef struct difference_row {
    const char *part;
    const char *what;
    const char *member;
    const char *unit;
    double a; /* of a truth value 1 or 0; NaN: null */
    double b;
    const char *text_a; /* NULL: a number */
    const char *text_b;
    bool truth_a;
    bool truth_b;
    double change_percent;
    const char *pointer_a;
    const char *pointer_b;
    bool derived;
} difference_row;

#define THIS difference_row
static const mt_field difference_fields[] = {
    MT_F_TEXT("part", part, "Part of the result: \"recommendation 1\", \"answer\"."),
    MT_F_TEXT("what", what, "Item of that part: \"frequency upright mode 1\"; \"\": none."),
    MT_F_TEXT_OR_NULL("member", member,
                      "Member of the item, as in the result; null: one result lacks the item."),
    MT_F_TEXT_OR_NULL("unit", unit, "Unit of both values."),
    MT_F_VALUE_OR_NULL("a", a, text_a,
                       "Value in A, a number in the unit that `unit` names; null: it lacks it, "
                       "or has a list or an object.",
                       MT_F_TRUTH(truth_a)),
    MT_F_VALUE_OR_NULL("b", b, text_b,
                       "Value in B, a number in the unit that `unit` names; null: it lacks it, "
                       "or has a list or an object.",
                       MT_F_TRUTH(truth_b)),
    MT_F_NUMBER_OR_NULL("change_percent", change_percent,
                        "B - A in per cent of A; null where that says nothing."),
    MT_F_TEXT_OR_NULL("pointer_a", pointer_a, "JSON pointer into A; null: A lacks it."),
    MT_F_TEXT_OR_NULL("pointer_b", pointer_b, "JSON pointer into B; null: B lacks it."),
    MT_F_FLAG("derived", derived,
              "It follows from other members of its part: an error, a change, a slope."),
};
static const mt_record difference_record = MT_F_RECORD_OF(
    difference_fields, "difference", "A member that two results tell otherwise.");
static const mt_record_column difference_columns[] = {
    MT_R_COLUMN(part, "part", 0, MT_IN_CSV), /* a heading of texts */
    MT_R_COLUMN(what, "what", 0, MT_IN_TABLES),
    MT_R_COLUMN(member, "member", 0, MT_IN_TABLES),
    MT_R_COLUMN(unit, "unit", 0, MT_IN_TABLES),
    MT_R_RIGHT(a, "A", DIGITS, MT_IN_TABLES),
    MT_R_RIGHT(b, "B", DIGITS, MT_IN_TABLES),
    MT_R_CHANGE(change_percent, "change [%]", NULL, CHANGE_DIGITS, MT_IN_TABLES),
};
static const mt_record_table difference_rows =
    MT_R_TABLE_OF(difference_record, difference_columns);
#undef THIS

/* All differences of two results. */
typedef struct diff_row {
    const char *a;
    const char *b;
    double rel_tol;
    double abs_tol;
    bool same;
    int n_made_by;
    difference_row *made_by;
    int n_differences;
    difference_row *differences;
} diff_row;

#define THIS diff_row
static const mt_field diff_fields[] = {
    MT_F_TEXT("a", a, "The first result."),
    MT_F_TEXT("b", b, "The second result."),
    MT_F_NUMBER("rel_tol", rel_tol, "Part of its number by which a value may differ."),
    MT_F_NUMBER("abs_tol", abs_tol,
                "Number by which a value may differ, in the unit of that value."),
    MT_F_FLAG("same", same, "The answers are the same."),
    MT_F_LIST("made_by", made_by, n_made_by, difference_row, difference_record,
              "What differs in how the answers were made."),
    MT_F_LIST("differences", differences, n_differences, difference_row, difference_record,
              "What differs in the answers."),
};
static const mt_record diff_record = MT_F_RECORD_OF(diff_fields, NULL, NULL);
#undef THIS

/* The word of tables for a value that is no number, or, without a unit, for a count; NULL: it
 * is shown as a number. */
static const char *word_of(const mt_reported *told, const char *unit, mt_arena *mem)
{
    static const double LARGEST_COUNT = 1e15;
    const double x = told->number;
    switch (told->type) {
    case MT_JSON_NUMBER:
        return unit == NULL && x == floor(x) && fabs(x) < LARGEST_COUNT
                   ? mt_arena_printf(mem, "%lld", (long long)x)
                   : NULL;
    case MT_JSON_STRING:
        return told->text;
    case MT_JSON_BOOL:
        return x != 0.0 ? "true" : "false";
    case MT_JSON_NULL:
        return NULL;
    case MT_JSON_ARRAY:
    case MT_JSON_OBJECT:
        return "there";
    }
    return "missing";
}

static double number_of(const mt_reported *told)
{
    return told->type == MT_JSON_NUMBER || told->type == MT_JSON_BOOL ? told->number : nan("");
}

static const char *text_of(const mt_reported *told)
{
    return told->type == MT_JSON_STRING ? told->text : NULL;
}

/* in_words: of tables, which say what is no number; words lie in mem. */
static difference_row difference_row_of(const mt_difference *d, bool in_words, mt_arena *mem)
{
    const mt_reported *const a = &d->told[0];
    const mt_reported *const b = &d->told[1];
    return (difference_row){
        .part = d->part,
        .what = in_words && d->what[0] == '\0' ? NULL : d->what,
        .member = d->member[0] == '\0' ? NULL : d->member,
        .unit = d->unit,
        .a = number_of(a),
        .b = number_of(b),
        .text_a = in_words ? word_of(a, d->unit, mem) : text_of(a),
        .text_b = in_words ? word_of(b, d->unit, mem) : text_of(b),
        .truth_a = a->type == MT_JSON_BOOL,
        .truth_b = b->type == MT_JSON_BOOL,
        .change_percent = change_of(d),
        .pointer_a = d->pointer[0],
        .pointer_b = d->pointer[1],
        .derived = d->derived,
    };
}

static void add_difference(mt_table *t, const mt_difference *d, unsigned in)
{
    const difference_row row = difference_row_of(d, true, &t->mem);
    mt_table_record_row(t, &difference_rows, in, &row);
    t->failed = t->failed || mt_arena_failed(&t->mem);
}

/* Those of one part, numbers first .. last - 1, as a section; what follows from others only
 * where there are no others. Returns how many it leaves out. */
static int print_part(const mt_difference *items, int first, int last, bool provenance,
                      mt_text *out)
{
    int left_out = 0;
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &difference_rows, MT_IN_TEXT);
    for (int pass = 0; pass < 2 && mt_table_rows(&t) == 0; pass++) {
        left_out = 0;
        for (int i = first; i < last; i++) {
            const bool shown = pass == 1 || !items[i].derived;
            if (items[i].provenance == provenance && shown) {
                add_difference(&t, &items[i], MT_IN_TEXT);
            }
            left_out += items[i].provenance == provenance && !shown ? 1 : 0;
        }
    }
    if (mt_table_rows(&t) > 0) {
        mt_text_addf(out, "\n%s\n", provenance ? "made by" : items[first].part);
        mt_table_print(&t, 2, mt_terminal_width(), out);
    }
    out->failed = out->failed || t.failed;
    mt_table_free(&t);
    return left_out;
}

static int end_of_part(const mt_result_diff *diff, int first)
{
    int last = first;
    while (last < diff->n && strcmp(diff->items[last].part, diff->items[first].part) == 0) {
        last++;
    }
    return last;
}

static void print_text(const mt_args *args, const mt_result_diff *diff, mt_text *out)
{
    mt_text_addf(out, "A  %s\nB  %s\n", args->operands[0], args->operands[1]);
    (void)print_part(diff->items, 0, diff->n, true, out);
    int left_out = 0;
    for (int first = 0; first < diff->n; first = end_of_part(diff, first)) {
        left_out += print_part(diff->items, first, end_of_part(diff, first), false, out);
    }
    if (diff->of_answer == 0) {
        mt_text_add(out, "\nThe answers are the same.\n");
        return;
    }
    mt_text_addf(out, "\nThe answers differ in %d member%s", diff->of_answer,
                 diff->of_answer == 1 ? "" : "s");
    if (left_out > 0) {
        mt_text_addf(out, "; %d of them follow from the others and are left out here",
                     left_out);
    }
    mt_text_add(out, ".\n");
}

static mt_status diff_row_of(const mt_args *args, const mt_result_diff *diff, mt_arena *mem,
                             diff_row *out, mt_err *err)
{
    const int n_made_by = diff->n - diff->of_answer;
    *out = (diff_row){
        .a = args->operands[0],
        .b = args->operands[1],
        .rel_tol = args->rel_tol,
        .abs_tol = args->abs_tol,
        .same = diff->of_answer == 0,
        .made_by = mt_arena_alloc(mem, (size_t)n_made_by, sizeof *out->made_by),
        .differences = mt_arena_alloc(mem, (size_t)diff->of_answer, sizeof *out->differences),
    };
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < diff->n; i++) {
        const mt_difference *const d = &diff->items[i];
        difference_row *const to = d->provenance ? &out->made_by[out->n_made_by++]
                                                 : &out->differences[out->n_differences++];
        *to = difference_row_of(d, false, mem);
    }
    return MT_OK;
}

static int print_diff_json(const mt_args *args, const mt_result_diff *diff, mt_text *out)
{
    mt_json_writer w = mt_json_writer_default(out);
    mt_arena mem = {.first = NULL};
    mt_err err = {.code = MT_OK};
    diff_row row;
    mt_status rc = mt_arena_init(&mem, 0, &err);
    rc = rc == MT_OK ? diff_row_of(args, diff, &mem, &row, &err) : rc;
    int code = MT_EXIT_DONE;
    if (rc == MT_OK) {
        mt_record_put_object(&w, NULL, &diff_record, &row, 0, NULL);
        code = mt_cli_json_done(&w);
    } else {
        code = mt_cli_failed(rc, &err);
    }
    mt_arena_free(&mem);
    return code;
}

static int print_differences(const mt_args *args, const mt_result_diff *diff, mt_text *out)
{
    if (args->format == MT_FORMAT_JSON) {
        return print_diff_json(args, diff, out);
    }
    if (args->format == MT_FORMAT_CSV) {
        mt_table t = mt_table_default();
        mt_table_record_columns(&t, &difference_rows, MT_IN_CSV);
        for (int i = 0; i < diff->n; i++) {
            add_difference(&t, &diff->items[i], MT_IN_CSV);
        }
        mt_table_csv(&t, out);
        mt_table_free(&t);
    } else {
        print_text(args, diff, out);
    }
    return MT_EXIT_DONE;
}

static int run_diff(const mt_args *args, mt_text *out)
{
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_result_diff diff = {.n = 0};
    const char *const paths[SIDES] = {args->operands[0], args->operands[1]};
    const mt_diff_tolerance tol = {args->rel_tol, args->abs_tol};
    const mt_status rc =
        mt_result_diff_find(paths, tol, args->value[MT_OPT_ROOT], &diff, &messages, &err);
    int code = mt_cli_loaded(rc, &messages, &err);
    if (rc == MT_OK) {
        const bool same = diff.of_answer == 0;
        code = mt_exit_worse(same ? MT_EXIT_DONE : MT_EXIT_GOALS,
                             print_differences(args, &diff, out));
    }
    mt_result_diff_free(&diff);
    return code;
}

const mt_command mt_command_diff = {
    .name = "diff",
    .operands = "RESULT RESULT",
    .least = 2,
    .most = 2,
    .summary = "differences between two results",
    .details =
        "Compares two results (each a result.json or its folder), also of different studies or "
        "versions of the program: status, designs with their parameters, objectives, "
        "frequencies, MAC and goals, certificates and all else. It lists what only one of them "
        "has. How the answers were made (versions, seed, evaluations, digests of the files) is "
        "listed but does not count as a difference; sentences and measures of rounding are not "
        "compared.\n"
        "The text omits what follows from what it shows (errors, derivatives, changes); JSON "
        "and CSV have everything, with JSON pointers into both files. The exit status is 0 if "
        "the answers are equal, 1 if they differ, and 2 or more if they cannot be compared.",
    .answer = {&diff_record, MT_ANSWER_ONE},
    .run = run_diff,
};
