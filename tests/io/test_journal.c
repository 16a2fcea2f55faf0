/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A journal gives back what was put, or nothing. Every byte of one is changed and it is cut
 * behind every byte: no record may come back with other words. MT_EVERY=1: every bit of every
 * byte.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/file.h"
#include "io/journal.h"
#include "mt_test.h"

enum { KEYS = 12, WORDS = 5 };

static const char IDENTITY[] = "{\n  \"seed\": 1,\n  \"inputs\": \"abc\"\n}\n";
static char path[64];
static char old[sizeof path + sizeof MT_JOURNAL_OLD];

static uint64_t word_of(int key, int i)
{
    return i == 0 ? UINT64_MAX - (uint64_t)key : (uint64_t)(key * 1000 + i) >> (key % 3 * 8);
}

static void key_of(int k, char *out)
{
    (void)snprintf(out, MT_KEY_SIZE, "search/%d/%d", k / 5, k);
}

static mt_journal *opened(mt_test *t, const char *identity)
{
    mt_journal *j = NULL;
    CHECK_INT(t, mt_journal_new(identity, &j, NULL), MT_OK);
    return j;
}

static void put(mt_journal *j, int key, int changed)
{
    uint64_t words[WORDS];
    char name[MT_KEY_SIZE];
    mt_checkpoint_store *const store = mt_journal_checkpoint_store(j, 0, 0);
    for (int i = 0; i < WORDS; i++) {
        words[i] = word_of(key, i) + (uint64_t)changed;
    }
    key_of(key, name);
    store->put(store->context, name, words, (size_t)(key % (WORDS + 1)));
}

/* What was there; -1 where it failed. */
static int write_to(mt_journal *j, bool adds)
{
    mt_journal_place place = MT_JOURNAL_NEW;
    return mt_journal_write_to(j, path, adds, &place, NULL) == MT_OK ? (int)place : -1;
}

static void write_keys(mt_test *t, int from, int to, bool adds)
{
    mt_journal *const j = opened(t, IDENTITY);
    REQUIRE(t, !adds || mt_journal_read(j, path, NULL, NULL) == MT_OK);
    REQUIRE(t, write_to(j, adds) >= 0);
    for (int k = from; k < to; k++) {
        put(j, k, 0);
    }
    CHECK_INT(t, mt_journal_count(j).written, to - from);
    CHECK_INT(t, mt_journal_end(j, false, NULL), MT_OK);
    mt_journal_delete(j);
}

/* How many records come back as they were put; -1 where one is another. */
static int intact(mt_journal *j)
{
    const mt_checkpoint_store *const store = mt_journal_checkpoint_store(j, 0, 0);
    int found = 0;
    for (int k = 0; k < KEYS; k++) {
        char name[MT_KEY_SIZE];
        size_t n = 0;
        key_of(k, name);
        const uint64_t *const words = store->find(store->context, name, &n);
        if (words == NULL) {
            continue;
        }
        if (n != (size_t)(k % (WORDS + 1))) {
            return -1;
        }
        for (size_t i = 0; i < n; i++) {
            if (words[i] != word_of(k, (int)i)) {
                return -1;
            }
        }
        found++;
    }
    return found;
}

static void overwrite(mt_test *t, const char *bytes, size_t n)
{
    FILE *const f = fopen(path, "wb");
    REQUIRE(t, f != NULL);
    CHECK_INT(t, (long)fwrite(bytes, 1, n, f), (long)n);
    CHECK_INT(t, fclose(f), 0);
}

static void begin(mt_test *t)
{
    (void)snprintf(path, sizeof path, "/tmp/journal_%ld.d/a.journal", (long)getpid());
    (void)snprintf(old, sizeof old, "%s" MT_JOURNAL_OLD, path);
    write_keys(t, 0, KEYS, false);
}

static void end(void)
{
    (void)unlink(path);
    (void)unlink(old);
    *strrchr(path, '/') = '\0';
    (void)rmdir(path);
}

static void journal__gives_back_what_was_put(mt_test *t)
{
    begin(t);
    mt_journal *j = opened(t, IDENTITY);
    CHECK_INT(t, mt_journal_read(j, path, NULL, NULL), MT_OK);
    CHECK_INT(t, intact(j), KEYS);
    CHECK_INT(t, mt_journal_count(j).ignored, 0);
    CHECK_INT(t, mt_journal_count(j).used, KEYS);
    mt_journal_delete(j);
    write_keys(t, 0, 4, false); /* begins anew */
    write_keys(t, 4, KEYS, true);
    j = opened(t, IDENTITY);
    CHECK_INT(t, mt_journal_read(j, path, NULL, NULL), MT_OK);
    CHECK_INT(t, mt_journal_read(j, path, NULL, NULL), MT_OK); /* twice the same is the same */
    CHECK_INT(t, intact(j), KEYS);
    CHECK_INT(t, mt_journal_count(j).known, KEYS);
    CHECK_INT(t, write_to(j, true), MT_JOURNAL_CONTINUED);
    CHECK_INT(t, mt_journal_end(j, true, NULL), MT_OK);
    CHECK(t, mt_file_absent(path));
    mt_journal_delete(j);
    end();
}

/* How many records the file has. */
static long known_of(mt_test *t, const char *file)
{
    mt_journal *const j = opened(t, IDENTITY);
    const long n =
        mt_journal_read(j, file, NULL, NULL) == MT_OK ? mt_journal_count(j).known : -1;
    mt_journal_delete(j);
    return n;
}

/* What a run that was not finished knew stays when the next one begins anew. */
static void journal__of_an_unfinished_run_is_kept(mt_test *t)
{
    begin(t);
    mt_journal *const j = opened(t, IDENTITY);
    CHECK_INT(t, write_to(j, false), MT_JOURNAL_KEPT);
    CHECK(t, mt_file_absent(path));
    CHECK_INT(t, known_of(t, old), KEYS);
    put(j, 0, 0);
    CHECK_INT(t, mt_journal_end(j, true, NULL), MT_OK);
    CHECK(t, mt_file_absent(path));
    CHECK_INT(t, known_of(t, old), KEYS);
    mt_journal_delete(j);
    end();
}

/* Of two runs at the same time one has the journal, the other writes and removes nothing. */
static void journal__belongs_to_one_run(mt_test *t)
{
    static const struct {
        const char *name;
        bool made; /* before the other one begins */
        bool adds;
    } rows[] = {
        {"made", true, false}, {"made, and resumed", true, true}, {"made later", false, false}};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].name);
        begin(t);
        (void)unlink(path);
        mt_journal *const first = opened(t, IDENTITY);
        mt_journal *const second = opened(t, IDENTITY);
        CHECK_INT(t, write_to(first, false), MT_JOURNAL_NEW);
        if (rows[i].made) {
            put(first, 1, 0);
        }
        CHECK_INT(t, write_to(second, rows[i].adds),
                  rows[i].made ? MT_JOURNAL_HELD : MT_JOURNAL_NEW);
        put(first, 2, 0);
        put(second, 3, 0);
        CHECK_INT(t, mt_journal_count(second).written, 0);
        CHECK_INT(t, mt_journal_end(second, true, NULL), MT_OK);
        CHECK_INT(t, known_of(t, path), rows[i].made ? 2 : 1);
        CHECK_INT(t, mt_journal_end(first, true, NULL), MT_OK);
        CHECK(t, mt_file_absent(path) && mt_file_absent(old));
        mt_journal_delete(first);
        mt_journal_delete(second);
        end();
    }
}

/* A link, a second name, a pipe and a folder are left as they are. */
static void journal__is_a_regular_file_of_its_own(mt_test *t)
{
    enum { LINK, NOWHERE, NAMES, PIPE, FOLDER, COUNT };
    static const char *const names[COUNT] = {"link", "link to nothing", "two names", "pipe",
                                             "folder"};
    for (int i = 0; i < 2 * COUNT; i++) {
        const int kind = i / 2;
        const bool adds = i % 2 == 1;
        mt_test_row(t, "%s%s", names[kind], adds ? ", resumed" : "");
        begin(t);
        /* NOLINTNEXTLINE(readability-suspicious-call-argument): it becomes the old one */
        REQUIRE(t, rename(path, old) == 0);
        /* NOLINTNEXTLINE(readability-suspicious-call-argument): the old journal is linked to */
        const int made = kind == LINK      ? symlink(old, path)
                         : kind == NOWHERE ? symlink("nothing", path)
                         : kind == NAMES   ? link(old, path)
                         : kind == PIPE    ? mkfifo(path, 0600)
                                           : mkdir(path, 0700);
        REQUIRE(t, made == 0);
        mt_journal *const j = opened(t, IDENTITY);
        /* a name is taken away from where it stands without a byte of the file changing */
        const bool kept = kind == NAMES && !adds;
        CHECK_INT(t, write_to(j, adds), kept ? MT_JOURNAL_KEPT : MT_JOURNAL_FAILED);
        put(j, 1, 0);
        CHECK_INT(t, mt_journal_count(j).written, kept ? 1 : 0);
        CHECK_INT(t, mt_journal_end(j, true, NULL), kept ? MT_OK : MT_E_SYSTEM);
        CHECK_INT(t, known_of(t, old), KEYS);
        mt_journal_delete(j);
        (void)remove(path);
        end();
    }
}

/* A part that was ended before its first task leaves none; one that is done and had no task
 * does. */
static void journal__is_a_file_from_its_first_record_on(mt_test *t)
{
    for (int done = 0; done <= 1; done++) {
        begin(t);
        (void)remove(path);
        mt_journal *const j = opened(t, IDENTITY);
        CHECK_INT(t, write_to(j, false), MT_JOURNAL_NEW);
        (void)mt_journal_checkpoint_store(j, 1, 2);
        if (done == 1) {
            mt_journal_begin(j);
        }
        CHECK_INT(t, mt_journal_end(j, false, NULL), MT_OK);
        CHECK(t, mt_file_absent(path) == (done == 0));
        mt_journal_delete(j);
        end();
    }
}

static void journal__of_another_question_is_refused(mt_test *t)
{
    static const struct {
        const char *name;
        const char *identity;
        const char *says;
    } rows[] = {
        {"another file", "{\n  \"seed\": 1,\n  \"inputs\": \"abd\"\n}\n",
         "it has `  \"inputs\": \"abc\"` where this run has `  \"inputs\": \"abd\"`"},
        {"one line less", "{\n  \"seed\": 1,\n}\n",
         "it has `  \"inputs\": \"abc\"` where this run has `}`"},
    };
    begin(t);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_err err = {.code = MT_OK};
        mt_test_row(t, "%s", rows[i].name);
        mt_journal *const j = opened(t, rows[i].identity);
        CHECK_INT(t, mt_journal_read(j, path, NULL, &err), MT_E_INPUT);
        CHECK(t, strstr(err.text, rows[i].says) != NULL);
        mt_journal_delete(j);
    }
    end();
}

/* Of two records of one key neither can be believed. */
static void journal__contradictions_count_for_nothing(mt_test *t)
{
    begin(t);
    mt_journal *j = opened(t, IDENTITY);
    CHECK_INT(t, mt_journal_read(j, path, NULL, NULL), MT_OK);
    CHECK_INT(t, write_to(j, true), MT_JOURNAL_CONTINUED);
    put(j, 4, 1);
    CHECK_INT(t, mt_journal_end(j, false, NULL), MT_OK);
    mt_journal_delete(j);
    j = opened(t, IDENTITY);
    CHECK_INT(t, mt_journal_read(j, path, NULL, NULL), MT_OK);
    CHECK_INT(t, intact(j), KEYS - 1);
    CHECK_INT(t, mt_journal_count(j).ignored, 1);
    mt_journal_delete(j);
    end();
}

static void look(mt_test *t, const char *bytes, size_t n, bool head, int least)
{
    mt_journal *const j = opened(t, IDENTITY);
    overwrite(t, bytes, n);
    const mt_status rc = mt_journal_read(j, path, NULL, NULL);
    const int found = rc == MT_OK ? intact(j) : 0;
    CHECK(t, rc == MT_OK || (head && rc == MT_E_INPUT));
    CHECK(t, found >= (rc == MT_OK ? least : 0));
    mt_journal_delete(j);
}

static void journal__damage_loses_records_and_changes_none(mt_test *t)
{
    mt_file whole = {.bytes = NULL};
    const bool every = getenv("MT_EVERY") != NULL;
    begin(t);
    REQUIRE(t, mt_file_read(path, NULL, 1 << 20, &whole, NULL) == MT_OK);
    const size_t head = (size_t)(strstr(whole.bytes, "| }\n") - whole.bytes) + 4;
    char *const bytes = malloc(whole.length);
    REQUIRE(t, bytes != NULL);
    for (size_t i = 0; i < whole.length; i++) {
        for (int bit = every ? 0 : (int)(i % 8); bit < (every ? 8 : (int)(i % 8) + 1); bit++) {
            memcpy(bytes, whole.bytes, whole.length);
            bytes[i] = (char)(bytes[i] ^ (1 << bit));
            look(t, bytes, whole.length, i < head, KEYS - 2);
        }
        look(t, whole.bytes, i, false, 0);
        if (i == head - 1 || i == head || every) { /* and what is added to it can be read */
            write_keys(t, 0, 2, true);
            mt_journal *const j = opened(t, IDENTITY);
            CHECK_INT(t, mt_journal_read(j, path, NULL, NULL), MT_OK);
            CHECK(t, intact(j) >= 2);
            mt_journal_delete(j);
        }
    }
    free(bytes);
    mt_file_free(&whole);
    end();
}

MT_TEST_MAIN(MT_TEST(journal__gives_back_what_was_put),
             MT_TEST(journal__is_a_file_from_its_first_record_on),
             MT_TEST(journal__of_an_unfinished_run_is_kept),
             MT_TEST(journal__belongs_to_one_run),
             MT_TEST(journal__is_a_regular_file_of_its_own),
             MT_TEST(journal__of_another_question_is_refused),
             MT_TEST(journal__contradictions_count_for_nothing),
             MT_TEST(journal__damage_loses_records_and_changes_none))
