/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A result's folder is replaced by a child whose k-th call to the system fails or is its last,
 * for every k. Afterwards the folder is the old result or the new one, whole, or its readers
 * refuse it; what fails leaves the old one and nothing else (unless it is the removal that
 * fails); the next run mends it, also where it comes to nothing itself. Then pairs of faults,
 * and runs at the same time. MT_FAULTS_EVERY=1: every fault at every call, not one of them in
 * turn; MT_FAULTS_PAIRS=N and MT_FAULTS_SEED=S: pairs; MT_FAULTS_ROUNDS=N: rounds of runs at
 * the same time.
 */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/file.h"
#include "io/folder.h"
#include "mt_faults.h"
#include "mt_random.h"
#include "mt_test.h"
#include "result/folder.h"
#include "result/read.h"
#include "result/write.h"

enum { LENGTH = 200, CHILD_MEMORY = 77, OTHERS = 8 };

static char place[32];
static char folder[64];
static char path[96];

static long knob(const char *name, long otherwise)
{
    const char *const text = getenv(name);
    return text == NULL ? otherwise : strtol(text, NULL, 10);
}

/* A result that calls itself `version`, and its files; without a trade study its folder has no
 * trade.csv. */
typedef struct unit {
    const char *version;
    mt_text texts[MT_RESULT_FILE_COUNT];
    bool trade;
    bool ok;
} unit;

static void make(unit *u, const char *version, bool trade)
{
    static const char *const words[] = {"designs", "trade", "curves", "report"};
    const char *names[MT_RESULT_FILE_COUNT] = {NULL};
    char sha256[MT_RESULT_FILE_COUNT][MT_SHA256_TEXT];
    int n = 0;
    *u = (unit){.version = version, .trade = trade};
    for (int i = 0; i < MT_COUNT(words); i++) {
        for (int k = 0;
             k < LENGTH && (trade || (i != MT_RESULT_FILE_TRADE && i != MT_RESULT_FILE_CURVES));
             k++) {
            mt_text_addf(&u->texts[i], "%s of %s\n", words[i], version);
        }
        if (u->texts[i].s != NULL) {
            names[n] = mt_result_file_name((mt_result_file)i);
            mt_sha256(u->texts[i].s, u->texts[i].length, sha256[n++]);
        }
    }
    mt_text *const result = &u->texts[MT_RESULT_FILE_RESULT];
    mt_result *r = NULL;
    u->ok = mt_result_new(&r, NULL) == MT_OK;
    if (u->ok) {
        r->study.file = "s.json";
        r->run.build = (mt_result_build){"unknown", "none"};
        r->model.file = "m.json";
        r->status_text = version;
        u->ok = mt_result_note_outputs(r, n, names, sha256, NULL) == MT_OK &&
                mt_result_write(r, result, NULL) == MT_OK;
        mt_result_delete(r);
    }
    if (u->ok) {
        char digest[MT_SHA256_TEXT];
        mt_sha256(result->s, result->length, digest);
        mt_text_addf(&u->texts[MT_RESULT_FILE_TIMING],
                     "{ \"result_sha256\": \"%s\", \"by\": \"%s\" }", digest, version);
    }
}

static void release(unit *u)
{
    for (int i = 0; i < MT_RESULT_FILE_COUNT; i++) {
        mt_text_free(&u->texts[i]);
    }
}

static mt_status save(const unit *u, mt_err *err)
{
    mt_folder_file files[MT_RESULT_FILE_COUNT];
    for (int i = 0; i < MT_RESULT_FILE_COUNT; i++) {
        files[i] = (mt_folder_file){mt_result_file_name((mt_result_file)i), u->texts[i].s,
                                    u->texts[i].length};
    }
    return mt_folder_replace(folder, files, MT_RESULT_FILE_COUNT, err);
}

/* A child that saves with this fault; its status as of waitpid: exited with 0 or 1, or
 * killed. */
static int save_with_fault(const unit *u, long k, mt_fault fault, int error)
{
    (void)fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        mt_faults_at(k, fault, error);
        const mt_status rc = save(u, NULL);
        _exit(rc == MT_OK ? 0 : rc == MT_E_SYSTEM ? 1 : 2);
    }
    int status = -1;
    return child > 0 && waitpid(child, &status, 0) == child ? status : -1;
}

static long calls_to_save(const unit *u)
{
    mt_faults_at(0, MT_FAULT_NONE, 0);
    const mt_status rc = save(u, NULL);
    return rc == MT_OK ? mt_faults_count() : -1;
}

/* Does the file hold exactly this text, or, where that is none, is it absent? */
static bool holds(const char *name, const mt_text *text)
{
    char file_path[160];
    mt_file f = {.bytes = NULL};
    (void)snprintf(file_path, sizeof file_path, "%s/%s", folder, name);
    if (text->s == NULL) {
        return mt_file_absent(file_path);
    }
    const bool same = mt_file_read(file_path, NULL, 1 << 20, &f, NULL) == MT_OK &&
                      f.length == text->length && memcmp(f.bytes, text->s, f.length) == 0;
    mt_file_free(&f);
    return same;
}

static bool is_whole(const unit *u)
{
    for (int i = 0; i < MT_RESULT_FILE_COUNT; i++) {
        if (!holds(mt_result_file_name((mt_result_file)i), &u->texts[i])) {
            return false;
        }
    }
    return true;
}

/* Files of the folder whose names begin with ".modetune", or all. */
static int count_files(bool ours_only)
{
    DIR *const d = opendir(folder);
    int n = 0;
    for (const struct dirent *e = d == NULL ? NULL : readdir(d); e != NULL; e = readdir(d)) {
        n += ours_only ? strncmp(e->d_name, ".modetune", 9) == 0 : e->d_name[0] != '.';
    }
    if (d != NULL) {
        (void)closedir(d);
    }
    return n;
}

static void empty_folder(void)
{
    DIR *const d = opendir(folder);
    for (const struct dirent *e = d == NULL ? NULL : readdir(d); e != NULL; e = readdir(d)) {
        (void)unlinkat(dirfd(d), e->d_name, 0);
    }
    if (d != NULL) {
        (void)closedir(d);
    }
    (void)rmdir(folder);
}

/* What a reader takes it for: the version, "refused", "nothing", or what else went wrong. The
 * text stays until the next call. */
static const char *reader(void)
{
    static char version[32];
    mt_result *r = NULL;
    const mt_status rc = mt_result_load(path, NULL, &r, NULL, NULL);
    if (rc == MT_OK) {
        (void)snprintf(version, sizeof version, "%s", r->status_text);
    }
    mt_result_delete(r);
    return rc == MT_OK            ? version
           : rc == MT_E_INPUT     ? "refused"
           : mt_file_absent(path) ? "nothing"
                                  : mt_status_name(rc);
}

/* The folder as the old unit (NULL: none). */
static void start_with(mt_test *t, const unit *old)
{
    empty_folder();
    if (old != NULL) {
        CHECK_INT(t, save(old, NULL), MT_OK);
    }
}

/* Whatever happened: old, new or refused, and no reader is deceived. Returns whether it is
 * broken. */
static bool check_state(mt_test *t, const unit *old, const unit *new)
{
    const char *const said = reader();
    if (strcmp(said, new->version) == 0) {
        CHECK(t, is_whole(new));
        return false;
    }
    if (old != NULL && strcmp(said, old->version) == 0) {
        CHECK(t, is_whole(old));
        return false;
    }
    CHECK_STR(t, said, old == NULL ? "nothing" : "refused");
    return old != NULL || count_files(false) > 0;
}

/* A run that comes to nothing, because it may write no byte, has put back what was there. */
static int save_without_room(const unit *u)
{
    (void)fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        const struct rlimit none = {0, 0};
        (void)signal(SIGXFSZ, SIG_IGN);
        (void)setrlimit(RLIMIT_FSIZE, &none);
        _exit(save(u, NULL) == MT_E_SYSTEM ? 1 : 2);
    }
    int status = -1;
    return child > 0 && waitpid(child, &status, 0) == child ? status : -1;
}

static bool exited_with(int status, int code)
{
    return WIFEXITED(status) && WEXITSTATUS(status) == code;
}

/* The next runs: one that fails puts back a whole result, one that succeeds writes its own. */
static void check_mending(mt_test *t, const unit *old, const unit *new, const unit *next)
{
    CHECK(t, exited_with(save_without_room(next), 1));
    CHECK(t, !check_state(t, old, new));
    CHECK_INT(t, count_files(true), 0);
    CHECK_INT(t, save(next, NULL), MT_OK);
    CHECK(t, is_whole(next));
    CHECK_STR(t, reader(), next->version);
    CHECK_INT(t, count_files(true), 0);
}

typedef struct variant {
    const char *name;
    const unit *old;
    const unit *new;
    const unit *next;
} variant;

static unit units[4];

/* Is the i-th of n faults tried at call k? Instrumented builds, where a child is dear, try a
 * fifth of the calls. */
static bool is_turn(long k, int i, int n)
{
    const long stride = getenv("MT_INSTRUMENTED") != NULL ? 5 : 1;
    return knob("MT_FAULTS_EVERY", 0) != 0 || (k % n == i && k / n % stride == 0);
}

static const variant *variants(void)
{
    static const variant list[] = {
        {"a new folder", NULL, &units[1], &units[0]},
        {"a trade study is added", &units[0], &units[1], &units[2]},
        {"a trade study has gone", &units[1], &units[2], &units[0]},
        {"all are replaced", &units[3], &units[1], &units[2]},
    };
    return list;
}

enum { VARIANTS = 4 };

static bool prepare(mt_test *t)
{
    static const char *const versions[] = {"plain", "trade", "plain2", "trade2"};
    if (folder[0] != '\0') {
        return true;
    }
    /* in memory, where there is such a place: a disk takes milliseconds to flush */
    (void)snprintf(place, sizeof place, "/dev/shm/mt_folder_XXXXXX");
    if (mkdtemp(place) == NULL) {
        (void)snprintf(place, sizeof place, "/tmp/mt_folder_XXXXXX");
        if (!CHECK(t, mkdtemp(place) != NULL)) {
            return false;
        }
    }
    (void)snprintf(folder, sizeof folder, "%s/results", place);
    (void)snprintf(path, sizeof path, "%s/result.json", folder);
    bool ok = true;
    for (int i = 0; i < MT_COUNT(versions); i++) {
        make(&units[i], versions[i], i % 2 == 1);
        ok = CHECK(t, units[i].ok) && ok;
    }
    return ok;
}

/* One call that fails: what was there stays, or the new files are there (only the last flush
 * tells of it then), and nothing else. */
static void check_failure(mt_test *t, const variant *v, int status, const char *function)
{
    const bool removal = strcmp(function, "unlinkat") == 0;
    if (exited_with(status, 0)) {
        CHECK(t, is_whole(v->new));
    } else if (CHECK(t, exited_with(status, 1))) {
        const bool old = v->old == NULL ? mt_file_absent(path) : is_whole(v->old);
        CHECK(t, old || (strcmp(function, "fsync") == 0 && is_whole(v->new)));
    }
    CHECK(t, removal || count_files(true) == 0);
    CHECK(t, !check_state(t, v->old, v->new));
}

static void folder_faults__a_failing_call_leaves_a_whole_result(mt_test *t)
{
    static const int errors[] = {EIO, ENOSPC, EMFILE, EDQUOT, EINTR, EACCES};
    REQUIRE(t, prepare(t));
    for (int i = 0; i < VARIANTS; i++) {
        const variant *const v = &variants()[i];
        start_with(t, v->old);
        const long n = calls_to_save(v->new);
        CHECK(t, n > 50 && n < 200);
        for (long k = 0; k < n; k++) {
            for (int e = 0; e < MT_COUNT(errors); e++) {
                if (!is_turn(k, e, MT_COUNT(errors))) {
                    continue;
                }
                start_with(t, v->old);
                const char *const function = mt_faults_name(k);
                mt_test_row(t, "%s: call %ld, %s: %s", v->name, k, function,
                            strerror(errors[e]));
                check_failure(t, v, save_with_fault(v->new, k, MT_FAULT_FAIL, errors[e]),
                              function);
            }
        }
    }
}

static void folder_faults__a_killed_run_is_noticed_and_mended(mt_test *t)
{
    static const mt_fault deaths[] = {MT_FAULT_KILL, MT_FAULT_TEAR};
    int broken = 0;
    REQUIRE(t, prepare(t));
    for (int i = 0; i < VARIANTS; i++) {
        const variant *const v = &variants()[i];
        start_with(t, v->old);
        const long n = calls_to_save(v->new);
        for (long k = 0; k < n; k++) {
            for (int d = 0; d < MT_COUNT(deaths); d++) {
                if (!is_turn(k, d, MT_COUNT(deaths))) {
                    continue;
                }
                start_with(t, v->old);
                mt_test_row(t, "%s: %s call %ld, %s", v->name, d == 0 ? "before" : "after", k,
                            mt_faults_name(k));
                const int status = save_with_fault(v->new, k, deaths[d], 0);
                CHECK(t, WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
                broken += check_state(t, v->old, v->new) ? 1 : 0;
                check_mending(t, v->old, v->new, v->next);
            }
        }
    }
    mt_test_row(t, "some of them are broken");
    CHECK(t, broken > 3);
}

/* A disk that goes on failing: even then no reader is deceived, and the next run that can mends
 * it. */
static void folder_faults__what_fails_for_good_deceives_nobody(mt_test *t)
{
    REQUIRE(t, prepare(t));
    for (int i = 0; i < VARIANTS; i++) {
        const variant *const v = &variants()[i];
        start_with(t, v->old);
        const long n = calls_to_save(v->new);
        for (long k = 0; k < n; k++) {
            if (!is_turn(k, i, VARIANTS)) {
                continue;
            }
            start_with(t, v->old);
            mt_test_row(t, "%s: from call %ld on, %s", v->name, k, mt_faults_name(k));
            const int status = save_with_fault(v->new, k, MT_FAULT_EVER, EIO);
            CHECK(t, exited_with(status, 0) || exited_with(status, 1));
            const bool refused = check_state(t, v->old, v->new);
            CHECK(t, !(refused && exited_with(status, 0)));
            check_mending(t, v->old, v->new, v->next);
        }
    }
}

/* The run that finds a broken folder dies, too. */
static void folder_faults__of_pairs_one_result_remains(mt_test *t)
{
    static const mt_fault faults[] = {MT_FAULT_KILL, MT_FAULT_TEAR, MT_FAULT_FAIL,
                                      MT_FAULT_EVER};
    mt_random random = mt_random_seed((uint64_t)knob("MT_FAULTS_SEED", 1));
    REQUIRE(t, prepare(t));
    for (long pair = knob("MT_FAULTS_PAIRS", 30); pair > 0; pair--) {
        const variant *const v = &variants()[mt_random_int(&random, VARIANTS)];
        const long first = mt_random_int(&random, 110);
        const long second = mt_random_int(&random, 140);
        const mt_fault fault = faults[mt_random_int(&random, MT_COUNT(faults))];
        start_with(t, v->old);
        mt_test_row(t, "%s: calls %ld and %ld, fault %d", v->name, first, second, (int)fault);
        (void)save_with_fault(
            v->new, first, mt_random_int(&random, 2) == 0 ? MT_FAULT_KILL : MT_FAULT_TEAR, 0);
        const char *const between = reader();
        const unit *const old = strcmp(between, v->new->version) == 0 ? v->new : v->old;
        (void)save_with_fault(v->next, second, fault, EIO);
        (void)check_state(t, old, v->next);
        check_mending(t, old, v->next, v->new);
    }
}

/* Children that save and read at the same time; a reader meets whole results only, since it
 * waits for who writes. */
static void concurrent_round(mt_test *t, int children, bool same)
{
    pid_t child[OTHERS];
    start_with(t, &units[0]);
    (void)fflush(NULL);
    for (int i = 0; i < children; i++) {
        child[i] = fork();
        if (child[i] == 0) {
            bool ok = true;
            for (int k = 0; k < 4; k++) {
                ok = ok && save(&units[same ? 1 : (i + k) % VARIANTS], NULL) == MT_OK;
                const char *const said = reader();
                ok = ok && strcmp(said, "refused") != 0 && strcmp(said, "nothing") != 0;
            }
            _exit(ok ? 0 : 1);
        }
    }
    for (int i = 0; i < children; i++) {
        int status = -1;
        CHECK(t, child[i] > 0 && waitpid(child[i], &status, 0) == child[i] &&
                     exited_with(status, 0));
    }
    bool whole = false;
    for (int i = 0; i < VARIANTS; i++) {
        whole = whole || (is_whole(&units[i]) && strcmp(reader(), units[i].version) == 0);
    }
    CHECK(t, whole);
    CHECK_INT(t, count_files(true), 0);
}

static void folder_faults__runs_at_the_same_time_leave_one_result(mt_test *t)
{
    REQUIRE(t, prepare(t));
    for (long round = knob("MT_FAULTS_ROUNDS", 1); round > 0; round--) {
        for (int children = 2; children <= OTHERS; children += 3) {
            mt_test_row(t, "%d runs", children);
            concurrent_round(t, children, true);
            concurrent_round(t, children, false);
        }
    }
}

/* Last: nothing stays. */
static void folder_faults__leaves_nothing(mt_test *t)
{
    empty_folder();
    CHECK(t, folder[0] != '\0' && rmdir(place) == 0);
    for (int i = 0; i < MT_COUNT(units); i++) {
        release(&units[i]);
    }
}

MT_TEST_MAIN(MT_TEST(folder_faults__a_failing_call_leaves_a_whole_result),
             MT_TEST(folder_faults__a_killed_run_is_noticed_and_mended),
             MT_TEST(folder_faults__what_fails_for_good_deceives_nobody),
             MT_TEST(folder_faults__of_pairs_one_result_remains),
             MT_TEST(folder_faults__runs_at_the_same_time_leave_one_result),
             MT_TEST(folder_faults__leaves_nothing))
