/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Every value of every shipped and every good file is replaced by every wrong thing, one at a
 * time: the file is read, or refused with places. Under sanitizers that is the test of every
 * reader of a list, an object, a number or a name with empty, wrong-typed, doubled, nested and
 * oversized input. MT_NODES: how many of the cases to take of each kind of file, evenly; 0: all
 * (a million, some minutes).
 */
#define _XOPEN_SOURCE 700 /* NOLINT(cert-dcl37-c,cert-dcl51-cpp): mkdtemp */

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "environment/aircraft.h"
#include "environment/vibration.h"
#include "io/file.h"
#include "io/json.h"
#include "io/options.h"
#include "model/read.h"
#include "mt_hostile.h"
#include "mt_test.h"
#include "result/read.h"
#include "result/result.h"
#include "result/write.h"
#include "study/read.h"
#include "study/study.h"

enum {
    MAX_NODES = 8192,
    MAX_FILES = 100,
    PATH_SIZE = 512,
    CASES = 2500,
    LARGE_EVERY = 40, /* one case in so many takes a large thing */
    MANY = 4000,
    DEEP = 61
};

/* What stands in for a value. Refused: no reader can accept it, wherever it stands. */
static const struct wrong {
    const char *text;
    bool refused;
} WRONGS[] = {
    {"{}", false},
    {"[]", false},
    {"null", false},
    {"true", false},
    {"false", false},
    {"\"\"", false},
    {"\"x\"", false},
    {"\"0 * 1\"", false},
    {"0", false},
    {"-0", false},
    {"1", false},
    {"-1", false},
    {"2.5", false},
    {"1e308", false},
    {"-1e308", false},
    {"1e-320", false},
    {"1e-400", false},
    {"2147483648", false},
    {"-2147483649", false},
    {"18446744073709551616", false},
    {"1e999", true},
    {"-1e999", true},
    {"[0]", false},
    {"[[]]", false},
    {"[{}]", false},
    {"[[0]]", false},
    {"[null]", false},
    {"[0, 0]", false},
    {"[0, 0, 0]", false},
    {"[\"a\", \"a\"]", false},
    {"[[0, 0], \"a\"]", false},
    {"[[0, 0], [1, 0], [2, 0]]", false},
    {"{\"\": {}}", false},
    {"{\"a\": {}}", false},
    {"{\"a\": []}", false},
    {"{\"a\": {}, \"a\": {}}", true},
    {"{\"a\": 1, \"\\u0061\": 1}", true},
    {"{\"name\": 0, \"name\": 0}", true},
    {"\"\\u0000\"", true},
    {"\"\\u0000\\u0000\\u0000\"", true},
    {"\"\\ud800\"", true},
    {"\"\\u001b[2J\\u0007\\r\"", false},
    {"\"\\u202e\\ud83d\\ude00\"", false},
    {"[0, ]", true},
    {"NaN", true},
};

typedef enum large {
    LARGE_ZEROS,
    LARGE_OBJECTS,
    LARGE_LISTS,
    LARGE_TEXTS,
    LARGE_MEMBERS,
    LARGE_TEXT,
    LARGE_DEPTH,
    LARGE_DIGITS,
    LARGE_COUNT
} large;

static void add_large(large which, mt_text *out)
{
    static const char *const items[] = {"0,", "{},", "[],", "\"a\","};
    if (which == LARGE_MEMBERS) {
        mt_text_add(out, "{");
        for (int i = 0; i < MANY; i++) {
            mt_text_addf(out, "\"m%d\":%d,", i, i);
        }
        mt_text_add(out, "\"m\":0}");
    } else if (which == LARGE_TEXT || which == LARGE_DIGITS) {
        mt_text_add(out, which == LARGE_TEXT ? "\"" : "1");
        for (int i = 0; i < MANY; i++) {
            mt_text_add(out, which == LARGE_TEXT ? "abcdefgh" : "00000000");
        }
        mt_text_add(out, which == LARGE_TEXT ? "\"" : ".5");
    } else if (which == LARGE_DEPTH) {
        for (int i = 0; i < DEEP; i++) {
            mt_text_add(out, "[");
        }
        for (int i = 0; i < DEEP; i++) {
            mt_text_add(out, "]");
        }
    } else {
        mt_text_add(out, "[");
        for (int i = 0; i < MANY; i++) {
            mt_text_add(out, items[which]);
        }
        mt_text_addf(out, "%.*s]", (int)strlen(items[which]) - 1, items[which]);
    }
}

/* What is done at a node: replaced by a wrong thing, and what only members or items can
 * suffer. */
enum {
    AT_DOUBLE = MT_COUNT(WRONGS),
    AT_DROP,
    AT_RENAME,
    AT_EMPTY_NAME,
    AT_LONG_NAME,
    AT_COUNT
};

typedef enum kind { MODEL, STUDY, AIRCRAFT, PROFILE, RESULT } kind;

static const char *const KIND_NAMES[] = {"model", "study", "aircraft", "profile", "result"};

typedef struct reading {
    mt_status rc;
    mt_diagnostics said;
} reading;

static reading read_back(kind k, const char *path)
{
    const mt_io_options opt = {.root = "/"};
    reading r = {.rc = MT_OK};
    mt_model *model = NULL;
    mt_study *study = NULL;
    mt_result *result = NULL;
    mt_vibration *profile = NULL;
    mt_arena mem = {0};
    mt_aircraft_list list = {0};
    switch (k) {
    case MODEL:
        r.rc = mt_model_load(path, &opt, &model, &r.said, NULL);
        break;
    case STUDY:
        r.rc = mt_study_load(path, &opt, &study, &r.said, NULL);
        break;
    case AIRCRAFT:
        r.rc = mt_aircraft_load(path, &opt, &mem, &list, &r.said, NULL);
        break;
    case PROFILE:
        r.rc = mt_vibration_load(path, &opt, &profile, &r.said, NULL);
        break;
    case RESULT:
        r.rc = mt_result_load(path, &opt, &result, &r.said, NULL);
        break;
    }
    mt_model_delete(model);
    mt_study_delete(study);
    mt_result_delete(result);
    mt_vibration_delete(profile);
    mt_arena_free(&mem);
    return r;
}

/* A good file with one thing wrong. */
typedef struct change {
    const mt_file *file;
    const mt_hostile_node *at;
    int what;
    large size; /* with `is_large` */
    bool is_large;
} change;

static void add_range(const mt_file *f, size_t begin, size_t end, mt_text *out)
{
    mt_text_add_n(out, f->bytes + begin, end - begin);
}

static bool is_member(const mt_hostile_node *at)
{
    return at->name_end > at->name_begin;
}

/* From `begin` to `end` of the file stands `text` instead. */
static void make_text(const change *c, mt_text *out)
{
    const mt_hostile_node *const at = c->at;
    size_t begin = at->begin;
    size_t end = at->end;
    mt_text text = {0};
    if (c->is_large) {
        add_large(c->size, &text);
    } else if (c->what < MT_COUNT(WRONGS)) {
        mt_text_add(&text, WRONGS[c->what].text);
    } else if (c->what == AT_DOUBLE) {
        begin = at->end;
        mt_text_add(&text, ",");
        add_range(c->file, at->name_begin, at->end, &text);
    } else if (c->what == AT_DROP) {
        begin = at->name_begin;
        mt_text_add(&text, is_member(at) ? "\"dropped\": 0" : "0");
    } else {
        begin = at->name_begin;
        end = is_member(at) ? at->name_end : at->begin;
        mt_text_add(&text, "\"");
        for (int i = 0; c->what == AT_LONG_NAME && i < MANY; i++) {
            mt_text_add(&text, "name");
        }
        mt_text_add(&text, c->what == AT_RENAME ? "\\u001b[0m\"" : "\"");
        mt_text_add(&text, is_member(at) ? "" : ",");
    }
    mt_text_add_n(out, c->file->bytes, begin);
    mt_text_add_n(out, text.s == NULL ? "" : text.s, text.length);
    add_range(c->file, end, c->file->length, out);
    mt_text_free(&text);
}

static bool must_be_refused(const change *c)
{
    return !c->is_large &&
           (c->what < MT_COUNT(WRONGS) ? WRONGS[c->what].refused
                                       : c->what == AT_DOUBLE && is_member(c->at));
}

typedef struct counts {
    long accepted;
    long refused;
} counts;

static bool write_text(const char *path, const mt_text *text)
{
    FILE *const f = fopen(path, "wb");
    return f != NULL && fwrite(text->s, 1, text->length, f) == text->length && fclose(f) == 0;
}

/* Later versions may add members to results: nothing is said of those that are not known, nor
 * of what is behind them. */
static void check_change(mt_test *t, kind k, const change *c, const char *path, counts *n)
{
    mt_text text = {0};
    make_text(c, &text);
    if (CHECK(t, !text.failed && write_text(path, &text))) {
        reading r = read_back(k, path);
        n->accepted += r.rc == MT_OK ? 1 : 0;
        n->refused += r.rc == MT_E_INPUT ? 1 : 0;
        bool good = r.rc == MT_OK ? !must_be_refused(c) : r.rc == MT_E_INPUT;
        good =
            good && (r.rc == MT_OK ? mt_hostile_visible(r.said.lines.s, r.said.lines.length)
                                   : mt_hostile_diagnosed(r.said.lines.s, r.said.lines.length));
        if (!CHECK(t, good)) {
            (void)fprintf(stderr, "%s: %s\n%.200s\n", mt_status_name(r.rc),
                          c->is_large || c->what >= MT_COUNT(WRONGS) ? ""
                                                                     : WRONGS[c->what].text,
                          r.said.lines.s == NULL ? "" : r.said.lines.s);
        }
        mt_diagnostics_free(&r.said);
    }
    mt_text_free(&text);
}

static long cases_wanted(void)
{
    const char *const s = getenv("MT_NODES");
    const long few = getenv("MT_EVERY") == NULL ? CASES / 4 : CASES;
    return s == NULL ? few : strtol(s, NULL, 10);
}

/* Files to start from. */
typedef struct sources {
    int n;
    mt_file files[MAX_FILES];
    char names[MAX_FILES][PATH_SIZE];
    mt_hostile_node *nodes[MAX_FILES];
    int n_nodes[MAX_FILES];
} sources;

static void add_source(mt_test *t, sources *s, const char *path)
{
    static mt_hostile_node room[MAX_NODES];
    mt_file *const f = &s->files[s->n];
    REQUIRE(t, s->n < MAX_FILES);
    REQUIRE(t, mt_file_read(path, NULL, MT_JSON_MAX_BYTES, f, NULL) == MT_OK);
    const int n = mt_hostile_nodes(f->bytes, f->length, MAX_NODES, room);
    s->nodes[s->n] = malloc((size_t)n * sizeof *room);
    REQUIRE(t, s->nodes[s->n] != NULL);
    memcpy(s->nodes[s->n], room, (size_t)n * sizeof *room);
    s->n_nodes[s->n] = n;
    (void)snprintf(s->names[s->n], PATH_SIZE, "%s", path);
    s->n++;
}

static int is_json(const struct dirent *entry)
{
    const size_t n = strlen(entry->d_name);
    return n > 5 && strcmp(entry->d_name + n - 5, ".json") == 0;
}

/* The files of a folder whose format is that of the kind. */
static void add_folder(mt_test *t, sources *s, kind k, const char *folder)
{
    char format[64];
    struct dirent **entries = NULL;
    const int n = scandir(folder, &entries, is_json, alphasort);
    (void)snprintf(format, sizeof format, "\"modetune-%s/1\"", KIND_NAMES[k]);
    CHECK(t, n > 0);
    for (int i = 0; i < n; i++) {
        char path[PATH_SIZE];
        mt_file f = {0};
        (void)snprintf(path, sizeof path, "%.200s/%.200s", folder, entries[i]->d_name);
        if (mt_file_read(path, NULL, MT_JSON_MAX_BYTES, &f, NULL) == MT_OK &&
            strstr(f.bytes, format) != NULL) {
            add_source(t, s, path);
        }
        mt_file_free(&f);
        free(entries[i]);
    }
    free(entries);
}

static void free_sources(sources *s)
{
    for (int i = 0; i < s->n; i++) {
        mt_file_free(&s->files[i]);
        free(s->nodes[i]);
    }
    free(s);
}

/* Evenly thinned; a prime step meets every kind of change. */
static long step_for(long all, long wanted)
{
    long step = wanted <= 0 || all <= wanted ? 1 : all / wanted;
    while (step % 2 == 0 || step % 3 == 0 || step % 5 == 0 || step % 7 == 0 ||
           AT_COUNT % step == 0) {
        if (step == 1) {
            break;
        }
        step++;
    }
    return step;
}

static void check_sources(mt_test *t, kind k, const sources *s, const char *path)
{
    counts n = {0, 0};
    long all = 0;
    long i = 0;
    long next = 0;
    long taken = 0;
    for (int f = 0; f < s->n; f++) {
        all += (long)s->n_nodes[f] * AT_COUNT;
    }
    const long step = step_for(all, cases_wanted());
    for (int f = 0; f < s->n; f++) {
        for (int at = 0; at < s->n_nodes[f]; at++) {
            for (int what = 0; what < AT_COUNT; what++, i++) {
                if (i != next) {
                    continue;
                }
                next += step;
                change c = {.file = &s->files[f], .at = &s->nodes[f][at], .what = what};
                mt_test_row(t, "%s, byte %zu, change %d", s->names[f], c.at->begin, what);
                check_change(t, k, &c, path, &n);
                if (taken++ % LARGE_EVERY == 0) {
                    c.is_large = true;
                    c.size = (large)(taken / LARGE_EVERY % LARGE_COUNT);
                    check_change(t, k, &c, path, &n);
                }
            }
        }
    }
    mt_test_row(t, "%s", KIND_NAMES[k]);
    CHECK(t, s->n > 0 && n.accepted > 0 && n.refused > 0);
    printf("%s: %d files, %ld of %ld cases, %ld accepted, %ld refused\n", KIND_NAMES[k], s->n,
           taken, all, n.accepted, n.refused);
}

/* A folder of our own: in memory where the system has such a place, for thousands of files are
 * written. */
static bool make_folder(char *folder, size_t size)
{
    (void)snprintf(folder, size, "%s/mt_nodes_XXXXXX",
                   access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
    return mkdtemp(folder) != NULL;
}

static void check_kind(mt_test *t, kind k, int n, const char *const *folders)
{
    char folder[40];
    char sub[64];
    char problems[64];
    char path[64];
    sources *const s = calloc(1, sizeof *s);
    REQUIRE(t, s != NULL);
    for (int i = 0; i < n; i++) {
        char from[PATH_SIZE];
        (void)snprintf(from, sizeof from, "%s/%s", MT_TEST_SOURCE_DIR, folders[i]);
        add_folder(t, s, k, from);
    }
    if (CHECK(t, make_folder(folder, sizeof folder))) {
        /* studies name "../problems/..." */
        (void)snprintf(sub, sizeof sub, "%s/s", folder);
        (void)snprintf(path, sizeof path, "%s/s/file.json", folder);
        (void)snprintf(problems, sizeof problems, "%s/problems", folder);
        CHECK(t,
              mkdir(sub, 0700) == 0 && symlink(MT_TEST_SOURCE_DIR "/problems", problems) == 0);
        check_sources(t, k, s, path);
        (void)unlink(path);
        (void)unlink(problems);
        (void)rmdir(sub);
        (void)rmdir(folder);
    }
    free_sources(s);
}

static void node__of_a_model_may_be_anything(mt_test *t)
{
    static const char *const folders[] = {"problems", "tests/models", "tests/schema"};
    check_kind(t, MODEL, MT_COUNT(folders), folders);
}

static void node__of_a_study_may_be_anything(mt_test *t)
{
    static const char *const folders[] = {"studies", "tests/documents/good"};
    check_kind(t, STUDY, MT_COUNT(folders), folders);
}

static void node__of_a_catalogue_may_be_anything(mt_test *t)
{
    static const char *const folders[] = {"problems", "tests/documents/good"};
    check_kind(t, AIRCRAFT, MT_COUNT(folders), folders);
}

static void node__of_a_profile_may_be_anything(mt_test *t)
{
    static const char *const folders[] = {"problems/profiles", "tests/documents/good"};
    check_kind(t, PROFILE, MT_COUNT(folders), folders);
}

/* A result of today: what a small study gives. */
static bool write_result(const char *path)
{
    const mt_io_options opt = {.root = "/"};
    mt_study *study = NULL;
    mt_result *result = NULL;
    mt_text text = {0};
    const bool done = mt_study_load(MT_TEST_SOURCE_DIR "/tests/install/pendulum_study.json",
                                    &opt, &study, NULL, NULL) == MT_OK &&
                      mt_study_solve(study, NULL, &result, NULL) == MT_OK &&
                      mt_result_write(result, &text, NULL) == MT_OK && write_text(path, &text);
    mt_text_free(&text);
    mt_result_delete(result);
    mt_study_delete(study);
    return done;
}

static void node__of_a_result_may_be_anything(mt_test *t)
{
    char folder[40];
    char path[64];
    sources *const s = calloc(1, sizeof *s);
    REQUIRE(t, s != NULL);
    if (CHECK(t, make_folder(folder, sizeof folder))) {
        (void)snprintf(path, sizeof path, "%s/result.json", folder);
        if (CHECK(t, write_result(path))) {
            add_source(t, s, path);
            check_sources(t, RESULT, s, path);
        }
        (void)unlink(path);
        (void)rmdir(folder);
    }
    free_sources(s);
}

MT_TEST_MAIN(MT_TEST(node__of_a_model_may_be_anything),
             MT_TEST(node__of_a_study_may_be_anything),
             MT_TEST(node__of_a_catalogue_may_be_anything),
             MT_TEST(node__of_a_profile_may_be_anything),
             MT_TEST(node__of_a_result_may_be_anything))
