/* SPDX-License-Identifier: GPL-3.0-or-later */
/* result.json: what is written, what `apply` reads back, and what damaged files say. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "io/file.h"
#include "io/json.h"
#include "mt_refusals.h"
#include "result/folder.h"
#include "result/read.h"
#include "result/result_sample.h"
#include "result/write.h"

/* A new file with this text; its path is in `path`, "" where that failed. */
static void write_file(const char *text, char path[64])
{
    (void)snprintf(path, 64, "/tmp/mt_result_XXXXXX");
    const int fd = mkstemp(path);
    const size_t length = strlen(text);
    if (fd < 0 || write(fd, text, length) != (ssize_t)length) {
        path[0] = '\0';
    }
    if (fd >= 0) {
        (void)close(fd);
    }
}

/* Points of a trade study that are read one by one. */
enum { MANY = 250 };

/* The sample written with so many times its point; heap (mt_text). */
static mt_text written_points(int n)
{
    static mt_trade_point points[MANY];
    sample s = {.result = NULL};
    mt_text all = {0};
    if (make_sample(&s)) {
        for (int i = 0; i < n; i++) {
            points[i] = s.point;
        }
        s.trade.points = points;
        s.trade.n_points = n;
        if (mt_result_write(s.result, &all, NULL) != MT_OK) {
            mt_text_free(&all);
        }
    }
    mt_result_delete(s.result);
    return all;
}

/* The same with one text replaced by another. */
static mt_text written(int n, const char *find, const char *replace)
{
    mt_text all = written_points(n);
    char *const at = find == NULL || all.s == NULL ? NULL : strstr(all.s, find);
    mt_text out = {0};
    if (find == NULL) {
        return all;
    }
    if (at != NULL) {
        mt_text_add_n(&out, all.s, (size_t)(at - all.s));
        mt_text_add(&out, replace);
        mt_text_add(&out, at + strlen(find));
    }
    mt_text_free(&all);
    return out;
}

/* Read and written again; the path may be gone by then. */
static void result_file__comes_back_whole(mt_test *t)
{
    char path[64];
    mt_text text = written(1, NULL, NULL);
    mt_diagnostics messages = {.count = 0};
    mt_text again = {0};
    mt_result *r = NULL;
    mt_err err = {.text = ""};
    REQUIRE(t, text.s != NULL);
    write_file(text.s, path);
    CHECK_INT(t, mt_result_load(path, NULL, &r, &messages, &err), MT_OK);
    (void)unlink(path);
    CHECK_STR(t, err.text, "");
    CHECK_STR(t, messages.lines.s, NULL);
    if (r != NULL) {
        CHECK_INT(t, mt_result_write(r, &again, NULL), MT_OK);
        CHECK_STR(t, again.s, text.s);
        CHECK(t, isnan(r->recommendations[0].misfit));
        CHECK(t, r->doubts[0].level == MT_LEVEL_WARNING && r->facts[0].level == MT_LEVEL_NOTE);
    }
    mt_result_delete(r);
    mt_text_free(&again);
    mt_diagnostics_free(&messages);
    mt_text_free(&text);
}

/* Many points are read one by one where their layout is that of the writer, and mean the same
 * otherwise. */
static void result_file__of_many_points_is_read_in_any_layout(mt_test *t)
{
    static const struct {
        const char *name;
        const char *find;
        const char *replace;
    } rows[] = {
        {"as written", "", ""},
        {"a list that begins otherwise", "\"points\": [", "\"points\":  ["},
        {"a point that begins otherwise", "      {\n        \"values\"", "      { \"values\""},
        {"a point that ends otherwise", "\n      },\n      {\n        \"values\"",
         "},\n      {\n        \"values\""},
        {"a list that ends otherwise", "\n    ]\n  }", "]\n  }"},
        {"the members in another order", "\"format\": \"modetune-result/1\",\n", ""},
    };
    mt_text want = written_points(MANY);
    REQUIRE(t, want.s != NULL);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char path[64];
        mt_text text = written(MANY, rows[i].find, rows[i].replace);
        mt_diagnostics messages = {.count = 0};
        mt_text again = {0};
        mt_result *r = NULL;
        mt_test_row(t, "%s", rows[i].name);
        if (i == MT_COUNT(rows) - 1 && text.s != NULL) { /* the format comes last */
            text.length = (size_t)(strrchr(text.s, '}') - text.s);
            mt_text_add(&text, ", \"format\": \"modetune-result/1\"}\n");
        }
        REQUIRE(t, text.s != NULL && !text.failed);
        write_file(text.s, path);
        CHECK_INT(t, mt_result_load(path, NULL, &r, &messages, NULL), MT_OK);
        CHECK_STR(t, messages.lines.s, NULL);
        (void)unlink(path);
        if (r != NULL) {
            CHECK_INT(t, mt_result_write(r, &again, NULL), MT_OK);
            CHECK_STR(t, again.s, want.s);
        }
        mt_result_delete(r);
        mt_text_free(&again);
        mt_diagnostics_free(&messages);
        mt_text_free(&text);
    }
    mt_text_free(&want);
}

/* A copy of all that it has borrowed: what it was copied from may go. */
static void result_file__is_its_own(mt_test *t)
{
    sample s = {.result = NULL};
    mt_text whole = written(1, NULL, NULL);
    mt_text text = {0};
    REQUIRE(t, whole.s != NULL && make_sample(&s));
    CHECK_INT(t, mt_result_own(s.result, NULL), MT_OK);
    CHECK(t, s.result->recommendations != &s.recommendation && s.result->trade != &s.trade);
    CHECK(t, s.result->trade->points[0].best.tolerance_box != &s.box);
    mt_result *const result = s.result;
    memset(&s, 0x5a, sizeof s);
    CHECK_INT(t, mt_result_write(result, &text, NULL), MT_OK);
    CHECK_STR(t, text.s, whole.s);
    mt_result_delete(result);
    mt_text_free(&text);
    mt_text_free(&whole);
}

static void result_file__holds_what_the_design_promises(mt_test *t)
{
    static const char *const members[] = {
        "\"status\": \"compromise\"",
        "\"grade\": \"feasible\"",
        "\"score\": 0.30000000000000004",
        "\"violation_percent\": 0",
        "\"target_hz\": 18",
        "\"error_percent\": 0",
        "\"K_T1\": 0.00125",
        "\"clearances\": []",
        "\"frequency_hz\": [5, 22.101235, 500]",
        "\"magnitude\": [0.333333, 48.1235, 2e-07]",
        "\"phase_deg\": [0, -90.3333, 180]",
        "\"magnitude\": null",
        "\"trouble\": \"nothing settles\"",
        "\"gap_assignment\": null",
        "\"motion\": []",
        "\"motion\": [",
        "\"least_clearance_percent\": 10.5",
        "\"tolerance_box\": null",
        "\"clearance_percent\": null",
        "\"clearance_percent\": 12.5",
        "\"side\": \"above\"",
        "\"modes_below\": 1",
        "\"all_percent\": 2.5",
        "\"per_variable\": [",
        "\"reachable_lower_hz\": null",
        "\"reachable_upper_hz\": 19.5",
        "\"values\": [10, 0.25]",
        "\"quantity\": \"upper bound of l\"",
        "\"display_unit\": \"in\"",
        "\"display_factor\": 0.025399999999999999",
        "\"display_factor\": null",
        "\"pareto\": true",
        "\"published\": \"solved\"",
        "\"computed\": \"compromise\"",
        "\"kkt_residual\": null",
        "\"direction\": \"M_SAU\"",
        "\"proven\": true",
        "\"seed\": 1",
        "\"relaxations\": [\n",
        "\"target\": 18,",
        "\"band_id\": 1",
        "\"commit\": \"0123456789ab\"",
    };
    mt_text text = written(1, NULL, NULL);
    REQUIRE(t, text.s != NULL);
    for (int i = 0; i < MT_COUNT(members); i++) {
        CHECK(t, strstr(text.s, members[i]) != NULL);
    }
    mt_text_free(&text);
}

static void result_file__writing_twice_gives_the_same_bytes(mt_test *t)
{
    mt_text a = written(1, NULL, NULL);
    mt_text b = written(1, NULL, NULL);
    CHECK(t, a.s != NULL);
    CHECK_STR(t, a.s, b.s);
    mt_text_free(&a);
    mt_text_free(&b);
}

/* Line of the first place of `what` in the text, from 1. */
static int line_of(const char *text, const char *what)
{
    const char *const at = strstr(text, what);
    int line = 1;
    for (const char *p = text; at != NULL && p < at; p++) {
        line += *p == '\n' ? 1 : 0;
    }
    return line;
}

/* From the JSON of its page, before and after its files are noted. */
static void result_file__is_the_same_by_way_of_its_page(mt_test *t)
{
    static const char *const names[] = {"a.csv", "report.html"};
    char digests[2][MT_SHA256_TEXT] = {"12", "ab"};
    sample s;
    mt_text page = {.s = NULL};
    const mt_text none = {.s = NULL};
    if (!CHECK(t, make_sample(&s))) {
        return;
    }
    CHECK_INT(t, mt_result_write_page(s.result, &page, NULL), MT_OK);
    for (int noted = 0; noted < 2; noted++) {
        for (int k = 0; k < 2; k++) {
            mt_text whole = {.s = NULL};
            mt_text after = {.s = NULL};
            mt_test_row(t, "noted %d, page %d", noted, k);
            CHECK_INT(t, mt_result_write(s.result, &whole, NULL), MT_OK);
            CHECK_INT(
                t, mt_result_write_after_page(s.result, k == 0 ? &none : &page, &after, NULL),
                MT_OK);
            CHECK_STR(t, after.s, whole.s);
            CHECK(t, (strcmp(whole.s, page.s) == 0) == (s.result->run.n_outputs == 0));
            mt_text_free(&whole);
            mt_text_free(&after);
        }
        CHECK_INT(t, mt_result_note_outputs(s.result, 2, names, digests, NULL), MT_OK);
    }
    mt_text_free(&page);
    mt_result_delete(s.result);
}

static void result_file__a_damaged_one_is_refused(mt_test *t)
{
    static const struct {
        const char *name;
        const char *find;
        const char *replace;
        const char *at;   /* what the message points at the line of */
        const char *want; /* the message behind path and line */
    } rows[] = {
        {"format", "modetune-result/1", "modetune-result/2", "modetune-result/2",
         "13: error: /format: the format is not \"modetune-result/1\": this is not a result\n"},
        {"member gone", "  \"status\": \"compromise\",\n", "", "{",
         "1: error: member \"status\" is missing\n"},
        {"rank", "\"rank\": 1", "\"rank\": 1.5", "\"rank\": 1.5",
         "15: error: /recommendations/0/rank: must be a whole number, 0 or more\n"},
        {"unknown member", "\"rank\": 1", "\"extra\": 0, \"rank\": 1",
         "\"extra\": 0, \"rank\": 1",
         "7: error: /recommendations/0: unknown member \"extra\"\n"},
        {"no such variable", "\"K_T1\": 0.00125", "\"K_T2\": 0.00125", "\"K_T2\": 0.00125",
         "11: error: /baseline/frequencies/0/sensitivity: \"K_T2\" is not a variable\n"},
        {"values of a point", "[10, 0.25]", "[10]", "\"values\": [10]",
         "19: error: /trade/points/0/values: must have 2 values, as many as vary\n"},
        {"side", "\"side\": \"above\"", "\"side\": \"beside\"", "\"side\": \"beside\"",
         "19: error: /recommendations/0/clearances/1/side: unknown side \"beside\"; did you "
         "mean \"inside\"?\n"},
        {"text for a number", "\"recommended\": 0.20000000000000001",
         "\"recommended\": \"0.2\"", "\"recommended\": \"0.2\"",
         "24: error: /baseline/parameters/1/recommended: must be a number or null, not a "
         "string\n"},
    };
    for (int k = 0; k < 2 * MT_COUNT(rows); k++) {
        const int i = k / 2;
        const int points = k % 2 == 0 ? 1 : MANY;
        char path[64];
        mt_test_row(t, "%s, %d points", rows[i].name, points);
        mt_text text = written(points, rows[i].find, rows[i].replace);
        mt_diagnostics messages = {.count = 0};
        mt_result *r = NULL;
        if (CHECK(t, text.s != NULL)) {
            write_file(text.s, path);
            CHECK_INT(t, mt_result_load(path, NULL, &r, &messages, NULL), MT_E_INPUT);
            CHECK(t, r == NULL);
            char want[300];
            (void)snprintf(want, sizeof want, "%s:%d:%s", path, line_of(text.s, rows[i].at),
                           rows[i].want);
            CHECK_STR(t, messages.lines.s, want);
            (void)unlink(path);
        }
        mt_diagnostics_free(&messages);
        mt_text_free(&text);
    }
}

static void result_file__no_file_is_a_system_failure(mt_test *t)
{
    mt_result *r = NULL;
    mt_err err = {.text = ""};
    CHECK_INT(t, mt_result_load("/nonexistent/result.json", NULL, &r, NULL, &err), MT_E_SYSTEM);
    CHECK(t, r == NULL);
    CHECK(t, strstr(err.text, "/nonexistent/result.json") != NULL);
}

static mt_status read_and_write_once(mt_test *t, const void *path)
{
    mt_result *r = NULL;
    mt_text again = {0};
    mt_diagnostics said = {.count = 0};
    sample s = {.result = NULL};
    mt_status rc = mt_result_load(path, NULL, &r, &said, NULL);
    if (rc == MT_OK) {
        rc = make_sample(&s) ? mt_result_write(s.result, &again, NULL) : MT_E_MEMORY;
    }
    (void)t;
    mt_result_delete(r);
    mt_result_delete(s.result);
    mt_text_free(&again);
    mt_diagnostics_free(&said);
    return rc;
}

static void result_file__every_failing_allocation_is_survived(mt_test *t)
{
    char path[64];
    mt_text text = written(1, NULL, NULL);
    REQUIRE(t, text.s != NULL);
    write_file(text.s, path);
    CHECK(t, path[0] != '\0');
    mt_refuse_each(t, "read_and_write_once", read_and_write_once, path, MT_OK);
    (void)unlink(path);
    mt_text_free(&text);
}

MT_TEST_MAIN(MT_TEST(result_file__comes_back_whole),
             MT_TEST(result_file__of_many_points_is_read_in_any_layout),
             MT_TEST(result_file__is_its_own),
             MT_TEST(result_file__holds_what_the_design_promises),
             MT_TEST(result_file__writing_twice_gives_the_same_bytes),
             MT_TEST(result_file__is_the_same_by_way_of_its_page),
             MT_TEST(result_file__a_damaged_one_is_refused),
             MT_TEST(result_file__no_file_is_a_system_failure),
             MT_TEST(result_file__every_failing_allocation_is_survived))
