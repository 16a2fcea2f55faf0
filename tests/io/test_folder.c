/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of a folder replaced as one, without faults but those that any user can bring about;
 * tests/io/test_folder_faults.c has the others. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/file.h"
#include "io/folder.h"
#include "mt_alloc.h"
#include "mt_test.h"

enum { FILES = 3, LIMIT = 100000 };

static char place[32];
static const char *const names[FILES] = {"a", "b", "z"};

/* Texts of the three files, "" where there shall be none. */
static mt_status replace(const char *folder, const char *const texts[FILES], mt_err *err)
{
    mt_folder_file files[FILES];
    for (int i = 0; i < FILES; i++) {
        files[i] =
            (mt_folder_file){names[i], texts[i][0] == '\0' ? NULL : texts[i], strlen(texts[i])};
    }
    return mt_folder_replace(folder, files, FILES, err);
}

static bool holds(const char *path, const char *text)
{
    mt_file f = {.bytes = NULL};
    if (text[0] == '\0') {
        return mt_file_absent(path);
    }
    const bool same =
        mt_file_read(path, NULL, LIMIT, &f, NULL) == MT_OK && strcmp(f.bytes, text) == 0;
    mt_file_free(&f);
    return same;
}

static bool write_file(const char *path, const char *text)
{
    FILE *const file = fopen(path, "w");
    return file != NULL && fputs(text, file) >= 0 && fclose(file) == 0;
}

static bool enter(void)
{
    (void)snprintf(place, sizeof place, "/tmp/mt_folder_XXXXXX");
    return mkdtemp(place) != NULL && chdir(place) == 0;
}

/* Whatever is left in the place, and itself; true where those were all. */
static bool leave(int n, const char *const *paths)
{
    bool ok = true;
    for (int i = 0; i < n; i++) {
        ok = remove(paths[i]) == 0 && ok;
    }
    return rmdir(place) == 0 && ok;
}

static const char *const ONE[FILES] = {"a of one", "", "z of one"};
static const char *const TWO[FILES] = {"a of two", "b of two", "z of two"};

static bool is_there(const char *folder, const char *const texts[FILES])
{
    bool all = true;
    for (int i = 0; i < FILES; i++) {
        char path[64];
        (void)snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        all = holds(path, texts[i]) && all;
    }
    return all;
}

static mode_t mode_of(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0 ? st.st_mode & 0777 : 0;
}

static void folder__files_come_and_go_as_one(mt_test *t)
{
    REQUIRE(t, enter());
    const mode_t before = umask(027);
    CHECK_INT(t, replace("x/y", ONE, NULL), MT_OK);
    CHECK(t, is_there("x/y", ONE));
    CHECK_INT(t, mode_of("x/y/a"), 0640);
    CHECK(t, write_file("x/y/mine", "left alone") && chmod("x/y/a", 0604) == 0);
    CHECK_INT(t, replace("x/y/", TWO, NULL), MT_OK);
    CHECK(t, is_there("x/y", TWO));
    CHECK_INT(t, mode_of("x/y/a"), 0604);
    CHECK_INT(t, mode_of("x/y/b"), 0640);
    CHECK_INT(t, replace("./x//y", ONE, NULL), MT_OK);
    CHECK(t, is_there("x/y", ONE) && holds("x/y/mine", "left alone"));
    (void)umask(before);
    /* of a name that is a link the link is replaced, not what it leads to */
    CHECK(t, remove("x/y/a") == 0 && symlink("mine", "x/y/a") == 0);
    CHECK_INT(t, replace("x/y", TWO, NULL), MT_OK);
    CHECK(t, is_there("x/y", TWO) && holds("x/y/mine", "left alone"));
    static const char *const all[] = {"x/y/mine", "x/y/a", "x/y/b", "x/y/z", "x/y", "x"};
    CHECK(t, leave(MT_COUNT(all), all));
}

static void folder__what_cannot_be_replaced_is_left_as_it_was(mt_test *t)
{
    static char large[20000];
    const char *const too_large[FILES] = {"a", "b", large};
    struct rlimit before;
    mt_err err = {MT_OK, ""};
    REQUIRE(t, enter());
    memset(large, 'x', sizeof large - 1);
    CHECK_INT(t, replace("x", ONE, NULL), MT_OK);
    mt_test_row(t, "a folder is in the way");
    CHECK(t, mkdir("x/b", 0700) == 0);
    CHECK_INT(t, replace("x", TWO, &err), MT_E_SYSTEM);
    CHECK_STR(t, err.text, "x/b: Is a directory");
    CHECK(t, rmdir("x/b") == 0 && is_there("x", ONE));
    mt_test_row(t, "a file is in the way");
    CHECK_INT(t, replace("x/a", TWO, &err), MT_E_SYSTEM);
    CHECK_STR(t, err.text, "x/a: Not a directory");
    CHECK_INT(t, replace("x/a/b", TWO, &err), MT_E_SYSTEM);
    CHECK_STR(t, err.text, "x/a/b: Not a directory");
    mt_test_row(t, "a limit of the system");
    if (CHECK(t, getrlimit(RLIMIT_FSIZE, &before) == 0)) {
        const struct rlimit small = {4096, before.rlim_max};
        void (*const handler)(int) = signal(SIGXFSZ, SIG_IGN);
        CHECK(t, setrlimit(RLIMIT_FSIZE, &small) == 0);
        const mt_status rc = replace("x", too_large, &err);
        CHECK(t, setrlimit(RLIMIT_FSIZE, &before) == 0);
        (void)signal(SIGXFSZ, handler);
        CHECK_INT(t, rc, MT_E_SYSTEM);
        CHECK_STR(t, err.text, "x/z: File too large");
    }
    CHECK(t, is_there("x", ONE));
    static const char *const all[] = {"x/a", "x/z", "x"};
    CHECK(t, leave(MT_COUNT(all), all));
}

static void folder__is_held_by_one_or_by_readers(mt_test *t)
{
    enum { PATIENCE_MS = 50 };
    int held = -1;
    int other = -1;
    mt_err err = {MT_OK, ""};
    REQUIRE(t, enter());
    CHECK_INT(t, mt_folder_lock(".", true, 0, &held, NULL), MT_OK);
    CHECK_INT(t, mt_folder_lock(place, true, 0, &other, NULL), MT_OK);
    mt_folder_unlock(other);
    CHECK_INT(t, mt_folder_lock(".", false, PATIENCE_MS, &other, &err), MT_E_SYSTEM);
    CHECK_STR(t, err.text, ".: another run has been writing there for 0 s");
    CHECK_INT(t, other, -1);
    mt_folder_unlock(held);
    CHECK_INT(t, mt_folder_lock(".", false, 0, &held, NULL), MT_OK);
    CHECK_INT(t, mt_folder_lock(".", true, PATIENCE_MS, &other, NULL), MT_E_SYSTEM);
    mt_folder_unlock(held);
    mt_folder_unlock(other); /* none: nothing happens */
    CHECK_INT(t, mt_folder_lock("none", true, PATIENCE_MS, &other, &err), MT_E_SYSTEM);
    CHECK_STR(t, err.text, "none: No such file or directory");
    CHECK(t, leave(0, NULL));
}

static void folder__that_was_cut_is_known(mt_test *t)
{
    REQUIRE(t, enter());
    CHECK_INT(t, replace("x", ONE, NULL), MT_OK);
    CHECK(t, !mt_folder_unfinished("x", "z"));
    CHECK(t, write_file("x/.modetune-new.z", "hal"));
    CHECK(t, mt_folder_unfinished("x", "z") && !mt_folder_unfinished("x", "a"));
    CHECK(t, rename("x/a", "x/.modetune-old.a") == 0 && write_file("x/a", "foreign"));
    CHECK(t, write_file("x/.modetune-none.b", "") && write_file("x/b", "foreign"));
    CHECK(t, mkdir("x/z.folder", 0700) == 0 && rename("x/z", "x/z.folder/z") == 0);
    CHECK(t, rename("x/z.folder", "x/z") == 0);
    mt_test_row(t, "a run that fails puts back");
    CHECK_INT(t, replace("x", TWO, NULL), MT_E_SYSTEM);
    CHECK(t, holds("x/a", ONE[0]) && holds("x/b", "") && holds("x/z/z", ONE[2]));
    static const char *const all[] = {"x/a", "x/z/z", "x/z", "x"};
    CHECK(t, leave(MT_COUNT(all), all));
}

static void folder__every_failing_allocation_is_survived(mt_test *t)
{
    mt_status rc = MT_E_MEMORY;
    REQUIRE(t, enter());
    CHECK_INT(t, replace("x", ONE, NULL), MT_OK);
    for (long nth = 0; rc == MT_E_MEMORY && mt_alloc_works(); nth++) {
        const long before = mt_alloc_live();
        mt_test_row(t, "allocation %ld", nth);
        mt_alloc_fail_after(nth);
        rc = replace("x", TWO, NULL);
        mt_alloc_fail_after(-1);
        CHECK(t, rc == MT_OK || rc == MT_E_MEMORY);
        CHECK_INT(t, mt_alloc_live(), before);
        CHECK(t, is_there("x", rc == MT_OK ? TWO : ONE));
    }
    CHECK_INT(t, replace("x", TWO, NULL), MT_OK);
    static const char *const all[] = {"x/a", "x/b", "x/z", "x"};
    CHECK(t, leave(MT_COUNT(all), all));
}

MT_TEST_MAIN(MT_TEST(folder__files_come_and_go_as_one),
             MT_TEST(folder__what_cannot_be_replaced_is_left_as_it_was),
             MT_TEST(folder__is_held_by_one_or_by_readers),
             MT_TEST(folder__that_was_cut_is_known),
             MT_TEST(folder__every_failing_allocation_is_survived))
