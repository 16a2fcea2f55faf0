/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/file.h"
#include "mt_refusals.h"

enum { LIMIT = 1000 };

/* FIPS 180-4's examples ("abc", 448 bits, 896 bits), the empty text, and lengths around the
 * padding's edges against sha256sum. */
static void file__sha256_matches_the_standard(mt_test *t)
{
    static const struct {
        const char *text;
        const char *hash;
    } rows[] = {
        {"", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
        {"abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
        {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
         "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
        {"abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmno"
         "pqrlmnopqrsmnopqrstnopqrstu",
         "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1"},
    };
    char hash[MT_SHA256_TEXT];
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%zu bytes", strlen(rows[i].text));
        mt_sha256(rows[i].text, strlen(rows[i].text), hash);
        CHECK_STR(t, hash, rows[i].hash);
    }
    /* lengths 0 .. 199: the hashes of all of them, hashed (the chain 0 .. 199 of "a" was made
     * by sha256sum) */
    char chain[200 * 64];
    char letters[200];
    memset(letters, 'a', sizeof letters);
    for (size_t n = 0; n < sizeof letters; n++) {
        mt_sha256(letters, n, hash);
        memcpy(chain + 64 * n, hash, 64);
    }
    mt_test_row(t, "lengths 0 to 199");
    mt_sha256(chain, sizeof chain, hash);
    CHECK_STR(t, hash, "019f2b9f1af27a53a1f046da7e98af2c179f431e4b5bebb000e74040917a4123");
    for (size_t n = 0; n < sizeof letters; n++) {
        char whole[MT_SHA256_TEXT];
        mt_test_row(t, "%zu bytes, of which 0 to all are begun with", n);
        mt_sha256(chain, n, whole);
        for (size_t begun = 0; begun <= n; begun++) {
            const mt_sha256_start start = mt_sha256_begin(chain, begun);
            mt_sha256_end(&start, chain, n, hash);
            CHECK_STR(t, hash, whole);
        }
    }
}

static void file__paths_are_joined_to_the_naming_file(mt_test *t)
{
    static const struct {
        const char *naming;
        const char *name;
        const char *joined;
    } rows[] = {
        {"studies/a.json", "../problems/b.json", "studies/../problems/b.json"},
        {"a.json", "b.json", "b.json"},
        {"/x/a.json", "b.json", "/x/b.json"},
        {"/x/a.json", "/y/b.json", "/y/b.json"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char *const joined = mt_file_join(rows[i].naming, rows[i].name);
        CHECK_STR(t, joined, rows[i].joined);
        free(joined);
    }
    char *folder = mt_file_folder("a.json");
    CHECK_STR(t, folder, ".");
    free(folder);
    folder = mt_file_folder("/a.json");
    CHECK_STR(t, folder, "/");
    free(folder);
    folder = mt_file_default_root("studies/a.json");
    CHECK_STR(t, folder, "studies/..");
    free(folder);
}

static bool write_file(const char *path, const char *text)
{
    FILE *const file = fopen(path, "w");
    return file != NULL && fputs(text, file) >= 0 && fclose(file) == 0;
}

/* A folder of the test's own, to be left by leave(). */
static bool enter(char *folder)
{
    return mkdtemp(folder) != NULL && chdir(folder) == 0;
}

static void file__only_regular_files_beneath_the_root_are_read(mt_test *t)
{
    char folder[] = "/tmp/modetune_test_XXXXXX";
    mt_file f = {0};
    mt_err err = {MT_OK, ""};
    REQUIRE(t, enter(folder));
    REQUIRE(t, mkdir("in", 0700) == 0 && mkdir("inside", 0700) == 0);
    CHECK(t, write_file("in/a", "a") && write_file("out", "b") && write_file("inside/c", "c"));
    CHECK(t, symlink("../out", "in/leads_out") == 0 && symlink("a", "in/leads_in") == 0 &&
                 symlink("in", "root") == 0 && symlink("loop", "in/loop") == 0 &&
                 mkfifo("in/pipe", 0600) == 0);
    static const struct {
        const char *path;
        mt_status rc;
    } rows[] = {
        {"in/a", MT_OK},          {"in/leads_in", MT_OK},    {"in/leads_out", MT_E_INPUT},
        {"out", MT_E_INPUT},      {"in/../out", MT_E_INPUT}, {"inside/c", MT_E_INPUT},
        {"in/pipe", MT_E_INPUT},  {"in", MT_E_INPUT},        {"in/none", MT_E_SYSTEM},
        {"in/loop", MT_E_SYSTEM}, {"root/a", MT_OK},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].path);
        CHECK_INT(t, mt_file_read(rows[i].path, "root", LIMIT, &f, &err), rows[i].rc);
        mt_file_free(&f);
    }
    mt_test_row(t, "absent");
    CHECK(t,
          mt_file_absent("in/none") && mt_file_absent("in/a/b") && mt_file_absent("in/loop"));
    CHECK(t, !mt_file_absent("in/a") && !mt_file_absent("in/pipe") && !mt_file_absent("in"));
    mt_test_row(t, "no such root");
    CHECK_INT(t, mt_file_read("in/a", "none", LIMIT, &f, &err), MT_E_INPUT);
    CHECK_STR(t, err.text, "none: there is no such folder");
    mt_test_row(t, "no root, limits");
    CHECK_INT(t, mt_file_read("in/leads_out", NULL, 1, &f, &err), MT_OK);
    mt_file_free(&f);
    CHECK_INT(t, mt_file_read("out", NULL, 0, &f, &err), MT_E_INPUT);
    CHECK_STR(t, err.text, "out: is longer than 0 bytes");
    CHECK_INT(t, mt_file_read("none", NULL, 0, &f, &err), MT_E_SYSTEM);
    CHECK_STR(t, err.text, "none: No such file or directory");
    static const char *const all[] = {"in/a",    "in/leads_out", "in/leads_in", "in/loop",
                                      "in/pipe", "in",           "inside/c",    "inside",
                                      "out",     "root"};
    for (int i = 0; i < MT_COUNT(all); i++) {
        CHECK(t, remove(all[i]) == 0);
    }
    CHECK(t, rmdir(folder) == 0);
}

static mt_status read_once(mt_test *t, const void *context)
{
    mt_file f = {0};
    const mt_status rc = mt_file_read("a", ".", LIMIT, &f, NULL);
    (void)t;
    (void)context;
    mt_file_free(&f);
    return rc;
}

static void file__every_failing_allocation_is_survived(mt_test *t)
{
    char folder[] = "/tmp/modetune_test_XXXXXX";
    REQUIRE(t, enter(folder));
    CHECK(t, write_file("a", "text"));
    mt_refuse_each(t, "read_once", read_once, NULL, MT_OK);
    (void)remove("a");
    CHECK(t, rmdir(folder) == 0);
}

MT_TEST_MAIN(MT_TEST(file__sha256_matches_the_standard),
             MT_TEST(file__paths_are_joined_to_the_naming_file),
             MT_TEST(file__only_regular_files_beneath_the_root_are_read),
             MT_TEST(file__every_failing_allocation_is_survived))
