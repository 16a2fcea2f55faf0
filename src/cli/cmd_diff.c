/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune diff: what two results say differently. */
#include <math.h>
#include <string.h>

#include "cli/cli.h"
#include "io/result_diff.h"
#include "report/table.h"

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

/* Integers without a unit are counts. */
static void add_number(mt_table *t, double x, const char *unit)
{
    static const double LARGEST_COUNT = 1e15;
    if (unit == NULL && x == floor(x) && fabs(x) < LARGEST_COUNT) {
        mt_table_integer(t, (long long)x);
    } else {
        mt_table_number(t, x, DIGITS);
    }
}

static void add_value(mt_table *t, const mt_reported *told, const char *unit)
{
    switch (told->type) {
    case MT_JSON_NUMBER:
        add_number(t, told->number, unit);
        return;
    case MT_JSON_STRING:
        mt_table_text(t, told->text);
        return;
    case MT_JSON_BOOL:
        mt_table_text(t, told->number != 0.0 ? "true" : "false");
        return;
    case MT_JSON_NULL:
        mt_table_text(t, NULL);
        return;
    case MT_JSON_ARRAY:
    case MT_JSON_OBJECT:
        mt_table_text(t, "there");
        return;
    }
    mt_table_text(t, "missing");
}

static mt_table make_difference_columns(bool with_part)
{
    mt_table t = mt_table_default();
    if (with_part) {
        mt_table_column(&t, "part", "part", MT_ALIGN_LEFT);
    }
    mt_table_column(&t, "what", "what", MT_ALIGN_LEFT);
    mt_table_column(&t, "member", "member", MT_ALIGN_LEFT);
    mt_table_column(&t, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&t, "A", "a", MT_ALIGN_RIGHT);
    mt_table_column(&t, "B", "b", MT_ALIGN_RIGHT);
    mt_table_column(&t, "change [%]", "change_percent", MT_ALIGN_POINT);
    return t;
}

static void add_difference_row(mt_table *t, const mt_difference *d, bool with_part)
{
    if (with_part) {
        mt_table_text(t, d->part);
    }
    mt_table_text(t, d->what[0] == '\0' ? NULL : d->what);
    mt_table_text(t, d->member[0] == '\0' ? NULL : d->member);
    mt_table_text(t, d->unit);
    add_value(t, &d->told[0], d->unit);
    add_value(t, &d->told[1], d->unit);
    mt_table_change(t, change_of(d), CHANGE_DIGITS);
}

/* Those of one part, numbers first .. last - 1, as a section; what follows from others only
 * where there are no others. Returns how many it leaves out. */
static int print_part(const mt_difference *items, int first, int last, bool provenance,
                      mt_text *out)
{
    int left_out = 0;
    mt_table t = make_difference_columns(false);
    for (int pass = 0; pass < 2 && mt_table_rows(&t) == 0; pass++) {
        left_out = 0;
        for (int i = first; i < last; i++) {
            const bool shown = pass == 1 || !items[i].derived;
            if (items[i].provenance == provenance && shown) {
                add_difference_row(&t, &items[i], false);
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

static void put_value(mt_json_writer *w, const char *name, const mt_reported *t)
{
    if (t->type == MT_JSON_NUMBER) {
        mt_json_put_number(w, name, t->number);
    } else if (t->type == MT_JSON_STRING) {
        mt_json_put_string(w, name, t->text);
    } else if (t->type == MT_JSON_BOOL) {
        mt_json_put_bool(w, name, t->number != 0.0);
    } else {
        mt_json_put_null(w, name);
    }
}

static void put_differences(mt_json_writer *w, const char *name, const mt_result_diff *diff,
                            bool provenance)
{
    mt_json_open(w, name, '[');
    for (int i = 0; i < diff->n; i++) {
        const mt_difference *const d = &diff->items[i];
        if (d->provenance != provenance) {
            continue;
        }
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "part", d->part);
        mt_json_put_string(w, "what", d->what);
        mt_json_put_string(w, "member", d->member[0] == '\0' ? NULL : d->member);
        mt_json_put_string(w, "unit", d->unit);
        put_value(w, "a", &d->told[0]);
        put_value(w, "b", &d->told[1]);
        mt_json_put_number(w, "change_percent", change_of(d));
        mt_json_put_string(w, "pointer_a", d->pointer[0]);
        mt_json_put_string(w, "pointer_b", d->pointer[1]);
        mt_json_put_bool(w, "derived", d->derived);
        mt_json_close(w);
    }
    mt_json_close(w);
}

static int print(const mt_args *args, const mt_result_diff *diff, mt_text *out)
{
    if (args->format == MT_FORMAT_JSON) {
        mt_json_writer w = mt_json_writer_default(out);
        mt_json_open(&w, NULL, '{');
        mt_json_put_string(&w, "a", args->operands[0]);
        mt_json_put_string(&w, "b", args->operands[1]);
        mt_json_put_number(&w, "rel_tol", args->rel_tol);
        mt_json_put_number(&w, "abs_tol", args->abs_tol);
        mt_json_put_bool(&w, "same", diff->of_answer == 0);
        put_differences(&w, "made_by", diff, true);
        put_differences(&w, "differences", diff, false);
        mt_json_close(&w);
        return mt_cli_json_done(&w);
    }
    if (args->format == MT_FORMAT_CSV) {
        mt_table t = make_difference_columns(true);
        for (int i = 0; i < diff->n; i++) {
            add_difference_row(&t, &diff->items[i], true);
        }
        mt_table_csv(&t, out);
        mt_table_free(&t);
    } else {
        print_text(args, diff, out);
    }
    return MT_EXIT_DONE;
}

int mt_cmd_diff(const mt_args *args, mt_text *out)
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
        code = mt_exit_worse(same ? MT_EXIT_DONE : MT_EXIT_GOALS, print(args, &diff, out));
    }
    mt_result_diff_free(&diff);
    return code;
}
