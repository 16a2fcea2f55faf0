/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The rows of base/possible.h, driven from both sides: in every model of the tree each number
 * is replaced by one just inside and one just outside each edge of its member's row. What is
 * impossible is an error at its place and what is implausible a warning there, what lies inside
 * neither. Every row of models that has an edge is driven somewhere (others:
 * test_possible_files.c). What a number can be beside others is driven by
 * tests/cli/test_possible.py and tests/cli/test_doubts.py.
 */
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/file.h"
#include "io/json.h"
#include "model/read.h"
#include "mt_test.h"

enum { FILE_LIMIT = 1 << 20, PATH_SIZE = 512, NUMBER_SIZE = 40, EVERY = 7 };

/* What a reading said of one address. */
typedef struct said {
    bool impossible;
    bool implausible;
    bool read;
} said;

typedef struct subject {
    mt_test *t;
    const char *text;
    size_t length;
    bool driven[MT_POSSIBLE_COUNT];
} subject;

static bool has(const mt_diags *d, mt_addr addr, mt_severity severity, const char *text)
{
    for (int i = 0; text != NULL && i < d->count; i++) {
        const mt_diag *const item = &d->items[i];
        if (item->addr == addr && item->severity == severity &&
            strstr(item->text, text) != NULL) {
            return true;
        }
    }
    return false;
}

/* The file with `value` in the place of the token at `offset`. */
static said read_with(const subject *s, size_t offset, size_t token, mt_addr addr,
                      const mt_possible *row, double value)
{
    char number[NUMBER_SIZE];
    said out = {.read = false};
    (void)snprintf(number, sizeof number, "%.17g", value);
    const size_t n = strlen(number);
    char *const text = malloc(s->length + n + 1);
    mt_json *doc = NULL;
    mt_model *model = NULL;
    if (text == NULL) {
        return out;
    }
    memcpy(text, s->text, offset);
    memcpy(text + offset, number, n); /* NOLINT(bugprone-not-null-terminated-result) */
    memcpy(text + offset + n, s->text + offset + token, s->length - offset - token);
    if (mt_json_parse(text, s->length - token + n, &doc, NULL) == MT_OK) {
        (void)mt_model_from_json(doc, "text", &model, NULL);
        const mt_diags *const d = mt_json_diags(doc);
        out.read = true;
        out.impossible = has(d, addr, MT_SEVERITY_ERROR, row->impossible);
        out.implausible = has(d, addr, MT_SEVERITY_WARNING, row->below) ||
                          has(d, addr, MT_SEVERITY_WARNING, row->beyond);
    }
    mt_model_delete(model);
    mt_json_delete(doc);
    free(text);
    return out;
}

static size_t token_length(const char *at)
{
    size_t n = 1;
    if (*at != '"') {
        return strspn(at, "+-.0123456789eE");
    }
    while (at[n] != '"') {
        n++;
    }
    return n + 1;
}

/* The next number below (-1) or above (1), seen from an edge of any size. */
static double beside(double edge, double way)
{
    return edge + (way * 1e-9 * fmax(fabs(edge), 1e-3));
}

static void drive_number(subject *s, const mt_model *m, mt_num num, size_t offset)
{
    const mt_number *const number = &m->nums[num];
    const mt_possible *const row = &mt_possible_of[number->possible];
    const size_t token = token_length(s->text + offset);
    const struct {
        double value;
        bool impossible;
        bool implausible; /* of what is possible */
    } trials[] = {
        {row->above ? row->least : beside(row->least, -1.0), true, false},
        {row->above ? beside(row->least, 1.0) : row->least, false, row->least < row->low},
        {beside(row->most, 1.0), true, false},
        {row->most, false, row->most > row->high},
        {beside(row->low, -1.0), false, true},
        {row->low, false, false},
        {row->at_high ? row->high : beside(row->high, 1.0), false, true},
        {row->at_high ? beside(row->high, -1.0) : row->high, false, false},
    };
    for (int i = 0; i < MT_COUNT(trials); i++) {
        if (!isfinite(trials[i].value)) {
            continue;
        }
        mt_test_row(s->t, "row %d, %.17g at character %zu", (int)number->possible,
                    trials[i].value, offset);
        const said got = read_with(s, offset, token, number->addr, row, trials[i].value);
        CHECK(s->t, got.read);
        CHECK(s->t, got.impossible == trials[i].impossible);
        CHECK(s->t, got.impossible || got.implausible == trials[i].implausible);
        s->driven[number->possible] = true;
    }
}

/* Products of inertia may be negative. */
static bool is_product(const mt_model *m, mt_num num)
{
    for (int i = 0; i < m->n_bodies; i++) {
        for (int k = 3; k < 6; k++) {
            if (m->bodies[i].inertia[k] == num) {
                return true;
            }
        }
    }
    return false;
}

static void drive_file(mt_test *t, subject *s, const char *path)
{
    mt_file file = {0};
    mt_json *doc = NULL;
    mt_model *m = NULL;
    REQUIRE(t, mt_file_read(path, NULL, FILE_LIMIT, &file, NULL) == MT_OK);
    s->text = file.bytes;
    s->length = file.length;
    if (mt_json_parse(file.bytes, file.length, &doc, NULL) == MT_OK &&
        mt_json_member(doc, MT_JSON_ROOT, "dimension") != MT_NO_ADDR &&
        mt_model_from_json(doc, path, &m, NULL) == MT_OK) {
        int of_row[MT_POSSIBLE_COUNT] = {0};
        for (mt_num i = 0; i < m->n_nums; i++) {
            int line = 0;
            int column = 0;
            const char *at = file.bytes;
            /* a few of each kind in each file */
            if (is_product(m, i) || of_row[m->nums[i].possible]++ % EVERY != 0 ||
                !mt_model_locate(m, m->nums[i].addr, &line, &column)) {
                continue;
            }
            for (int k = 1; k < line; k++) {
                at = strchr(at, '\n') + 1;
            }
            drive_number(s, m, i, (size_t)(at - file.bytes) + (size_t)column - 1);
        }
    }
    mt_model_delete(m);
    mt_json_delete(doc);
    mt_file_free(&file);
}

static void drive_folder(mt_test *t, subject *s, const char *name)
{
    char path[PATH_SIZE];
    (void)snprintf(path, sizeof path, "%s/%s", MT_TEST_SOURCE_DIR, name);
    DIR *const folder = opendir(path);
    REQUIRE(t, folder != NULL);
    for (const struct dirent *e = readdir(folder); e != NULL; e = readdir(folder)) {
        const size_t n = strlen(e->d_name);
        if (n > 5 && strcmp(e->d_name + n - 5, ".json") == 0) {
            (void)snprintf(path, sizeof path, "%s/%s/%s", MT_TEST_SOURCE_DIR, name, e->d_name);
            drive_file(t, s, path);
        }
    }
    (void)closedir(folder);
}

static void possible__every_row_is_driven_from_both_sides(mt_test *t)
{
    subject s = {.t = t};
    drive_folder(t, &s, "tests/models");
    drive_folder(t, &s, "tests/schema");
    drive_folder(t, &s, "problems");
    bool of_models[MT_POSSIBLE_COUNT] = {false};
    int n = 0;
    const mt_key_table *const *const tables = mt_model_key_tables(&n);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < tables[i]->n; k++) {
            of_models[tables[i]->keys[k].possible] = true;
        }
    }
    for (int i = 0; i < MT_POSSIBLE_COUNT; i++) {
        const mt_possible *const row = &mt_possible_of[i];
        const bool edge = isfinite(row->least) || isfinite(row->most) || isfinite(row->low) ||
                          isfinite(row->high);
        mt_test_row(t, "row %d", i);
        CHECK(t, s.driven[i] == (edge && of_models[i]));
        CHECK(t, (row->impossible != NULL) == (isfinite(row->least) || isfinite(row->most)));
        CHECK(t, (row->warning != NULL) == (isfinite(row->low) || isfinite(row->high)));
    }
}

MT_TEST_MAIN(MT_TEST(possible__every_row_is_driven_from_both_sides))
