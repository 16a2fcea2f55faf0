/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/workers.h"
#include "mt_alloc.h"
#include "support/mt_test.h"

enum { TASKS = 1000, RECORDS = 64 };

typedef struct job {
    int done[TASKS];
    int runs[TASKS];
    int worker_seen[MT_WORKERS_MOST];
    int fail_from;
    mt_interrupt *cut_at_5;
    bool inner; /* every task begins a list of its own */
} job;

static mt_status square(void *context, int worker, int task, mt_task_path *own, mt_err *err);

static void serialize_square(void *context, int task, mt_serializer *serializer)
{
    job *const j = context;
    int got = j->done[task];
    mt_serializer_int(serializer, &got, 0, TASKS * TASKS);
    if (!serializer->reads || mt_serializer_is_read(serializer)) {
        j->done[task] = got;
    }
}

static mt_status square(void *context, int worker, int task, mt_task_path *own, mt_err *err)
{
    job *const j = context;
    j->runs[task]++;
    j->done[task] = task * task;
    j->worker_seen[worker] = 1;
    if (j->cut_at_5 != NULL && task == 5) {
        mt_interrupt_cut(j->cut_at_5, 1);
    }
    if (j->inner) {
        job below = {.fail_from = 0};
        const mt_tasks tasks = {2, square, serialize_square, &below, "tasks"};
        MT_TRY(mt_workers_run(1, own, &tasks, err));
        MT_TRY(mt_workers_run(1, own, &tasks, err));
    }
    if (j->fail_from > 0 && task >= j->fail_from) {
        return mt_fail(err, MT_E_DOMAIN, "task %d", task);
    }
    return MT_OK;
}

/* A ledger in memory. */
typedef struct book {
    mt_checkpoint_store store;
    int n;
    char keys[RECORDS][MT_KEY_SIZE];
    uint64_t words[RECORDS][4];
    size_t counts[RECORDS];
} book;

static int at(const book *b, const char *key)
{
    int i = 0;
    while (i < b->n && strcmp(b->keys[i], key) != 0) {
        i++;
    }
    return i;
}

static const uint64_t *find(void *context, const char *key, size_t *n)
{
    const book *const b = context;
    const int i = at(b, key);
    *n = i < b->n ? b->counts[i] : 0;
    return i < b->n ? b->words[i] : NULL;
}

static void put(void *context, const char *key, const uint64_t *words, size_t n)
{
    book *const b = context;
    if (b->n < RECORDS && n <= 4) {
        (void)snprintf(b->keys[b->n], MT_KEY_SIZE, "%s", key);
        memcpy(b->words[b->n], words, n * sizeof *words);
        b->counts[b->n++] = n;
    }
}

static mt_task_path open_book(mt_test *t, book *b)
{
    *b = (book){.n = 0};
    CHECK_INT(t, mt_checkpoint_store_init(&b->store, NULL), MT_OK);
    b->store.find = find;
    b->store.put = put;
    b->store.context = b;
    return (mt_task_path){.store = &b->store, .path = "all"};
}

static void workers__every_task_is_done_once_whatever_their_number(mt_test *t)
{
    static const int counts[] = {1, 2, 8, 64, 1000};
    for (int c = 0; c < MT_COUNT(counts); c++) {
        job j = {0};
        const mt_tasks tasks = {TASKS, square, NULL, &j, "tasks"};
        int wrong = 0;
        mt_test_row(t, c == 0 ? "one" : "several");
        CHECK_INT(t, mt_workers_run(counts[c], NULL, &tasks, NULL), MT_OK);
        for (int i = 0; i < TASKS; i++) {
            wrong += j.done[i] != i * i || j.runs[i] != 1 ? 1 : 0;
        }
        CHECK_INT(t, wrong, 0);
    }
}

static void workers__the_lowest_failing_task_is_reported(mt_test *t)
{
    for (int round = 0; round < 20; round++) {
        job j = {.fail_from = 17};
        const mt_tasks tasks = {TASKS, square, NULL, &j, "tasks"};
        mt_err err = {0};
        CHECK_INT(t, mt_workers_run(4, NULL, &tasks, &err), MT_E_DOMAIN);
        CHECK_STR(t, err.text, "task 17");
        CHECK_INT(t, j.done[TASKS - 1], (TASKS - 1) * (TASKS - 1));
    }
}

static void workers__no_task_is_fine(mt_test *t)
{
    job j = {0};
    const mt_tasks tasks = {0, square, NULL, &j, "tasks"};
    CHECK_INT(t, mt_workers_run(4, NULL, &tasks, NULL), MT_OK);
}

/* Keys are places, whoever does the task; what is known is not done again, and a record that is
 * none is as good as missing. */
static void workers__what_is_known_is_not_done_again(mt_test *t)
{
    static book b;
    static job first;
    static job second;
    first = second = (job){.fail_from = 0};
    mt_task_path task_path = open_book(t, &b);
    const mt_tasks tasks = {8, square, serialize_square, &first, "tasks"};
    CHECK_INT(t, mt_workers_run(3, &task_path, &tasks, NULL), MT_OK);
    CHECK_INT(t, mt_workers_run(3, &task_path, &tasks, NULL), MT_OK);
    CHECK_INT(t, b.n, 16);
    CHECK(t, at(&b, "all/0/0") < b.n && at(&b, "all/1/7") < b.n);
    b.words[at(&b, "all/0/2")][0] = TASKS * TASKS + 1; /* out of its range */
    b.counts[at(&b, "all/0/3")] = 2;                   /* too long */
    b.counts[at(&b, "all/0/4")] = 0;                   /* too short */
    mt_task_path again = {.store = &b.store, .path = "all"};
    const mt_tasks same = {8, square, serialize_square, &second, "tasks"};
    CHECK_INT(t, mt_workers_run(2, &again, &same, NULL), MT_OK);
    for (int k = 0; k < 8; k++) {
        CHECK_INT(t, second.done[k], k * k);
        CHECK_INT(t, second.runs[k], k >= 2 && k <= 4 ? 1 : 0);
    }
    mt_checkpoint_store_free(&b.store);
}

/* A task that is kept as a whole keeps none of its parts; one that is not keeps them. */
static void workers__parts_of_a_task_have_keys_below_its_own(mt_test *t)
{
    static book b;
    static job j;
    for (int whole = 0; whole < 2; whole++) {
        j = (job){.inner = true};
        mt_task_path task_path = open_book(t, &b);
        const mt_tasks tasks = {2, square, whole ? serialize_square : NULL, &j, "tasks"};
        CHECK_INT(t, mt_workers_run(1, &task_path, &tasks, NULL), MT_OK);
        CHECK_INT(t, b.n, whole ? 2 : 8);
        CHECK(t, (at(&b, "all/0/1/1/0") < b.n) == (whole == 0));
        mt_checkpoint_store_free(&b.store);
    }
}

/* Parts together do all of it, each task once, and none that is inside of another. */
static void workers__parts_share_the_tasks(mt_test *t)
{
    static book b;
    static job j;
    for (int parts = 1; parts <= 11; parts += 5) {
        j = (job){.inner = true};
        mt_task_path task_path = open_book(t, &b);
        b.store.parts = parts;
        for (int part = 1; part <= parts; part++) {
            const mt_tasks tasks = {8, square, NULL, &j, "tasks"};
            b.store.part = part;
            CHECK_INT(t, mt_workers_run(2, &task_path, &tasks, NULL),
                      parts == 1 ? MT_OK : MT_E_INTERRUPTED);
        }
        for (int k = 0; k < 8; k++) {
            CHECK_INT(t, j.runs[k], 1);
        }
        mt_checkpoint_store_free(&b.store);
    }
}

/* What ends after something was cut may rest on it. */
static void workers__nothing_is_kept_after_a_cut(mt_test *t)
{
    static book b;
    static job j;
    mt_interrupt interrupt;
    mt_interrupt_init(&interrupt, NULL, NULL, NULL);
    j = (job){.cut_at_5 = &interrupt};
    mt_task_path task_path = open_book(t, &b);
    task_path.interrupt = &interrupt;
    const mt_tasks tasks = {8, square, serialize_square, &j, "tasks"};
    CHECK_INT(t, mt_workers_run(1, &task_path, &tasks, NULL), MT_OK);
    CHECK_INT(t, b.n, 5);
    mt_checkpoint_store_free(&b.store);
}

/* Beyond the room for a key nothing is known, and everything is done. */
/* A task that was done and has no room for its record would be missing where all seems well. */
static void workers__a_record_without_room_is_a_shortage(mt_test *t)
{
    enum { N = 3 };
    bool short_of = true;
    for (long nth = 0; mt_alloc_works() && short_of; nth++) {
        job j = {.fail_from = 0};
        book b;
        mt_err err = {.code = MT_OK};
        mt_task_path task_path = open_book(t, &b);
        const mt_tasks tasks = {N, square, serialize_square, &j, "tasks"};
        mt_test_row(t, "allocation %ld", nth);
        mt_alloc_fail_only(nth);
        const mt_status rc = mt_workers_run(1, &task_path, &tasks, &err);
        mt_alloc_fail_after(-1);
        short_of = rc != MT_OK;
        CHECK_INT(t, rc, short_of ? MT_E_MEMORY : MT_OK);
        CHECK_INT(t, err.code, rc);
        CHECK(t, short_of == (b.n < N));
        CHECK(t, nth > N || short_of); /* the list of what is left out, and each record */
        mt_checkpoint_store_free(&b.store);
    }
    CHECK(t, !mt_alloc_works() || !short_of);
}

static void workers__a_key_that_is_too_long_is_none(mt_test *t)
{
    static book b;
    static job j;
    mt_task_path task_path = open_book(t, &b);
    j = (job){.fail_from = 0};
    const mt_tasks tasks = {8, square, serialize_square, &j, "tasks"};
    for (int length = MT_KEY_SIZE - 4; length < MT_KEY_SIZE; length++) {
        memset(task_path.path, 'x', (size_t)length);
        task_path.path[length] = '\0';
        j = (job){.fail_from = 0};
        CHECK_INT(t, mt_workers_run(2, &task_path, &tasks, NULL), MT_OK);
        CHECK_INT(t, b.n, 0);
        CHECK_INT(t, j.done[7], 49);
    }
    mt_checkpoint_store_free(&b.store);
}

static uint64_t bits_of(double x)
{
    uint64_t bits = 0;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static void serialize__gives_back_what_was_written(mt_test *t)
{
    double x[] = {0.1, -0.0, nan(""), HUGE_VAL, 5e-324};
    const char *text = "eight...and more";
    const char *none = NULL;
    long far = -3;
    bool flag = true;
    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    mt_serializer serializer = {.words = NULL};
    mt_serializer_numbers(&serializer, MT_COUNT(x), x);
    mt_serializer_text(&serializer, &text, &mem);
    mt_serializer_text(&serializer, &none, &mem);
    mt_serializer_long(&serializer, &far, -9, 9);
    mt_serializer_flag(&serializer, &flag);
    CHECK(t, !serializer.failed);
    for (size_t n = 0; n <= serializer.n; n++) { /* cut anywhere, it is none */
        double y[MT_COUNT(x)];
        const char *got = NULL;
        const char *nothing = "";
        long away = 0;
        bool yes = false;
        mt_serializer back = mt_serializer_of(serializer.words, n);
        mt_serializer_numbers(&back, MT_COUNT(y), y);
        mt_serializer_text(&back, &got, &mem);
        mt_serializer_text(&back, &nothing, &mem);
        mt_serializer_long(&back, &away, -9, 9);
        mt_serializer_flag(&back, &yes);
        CHECK(t, mt_serializer_is_read(&back) == (n == serializer.n));
        if (n == serializer.n) {
            CHECK(t, nothing == NULL && away == -3 && yes);
            for (int i = 0; i < MT_COUNT(x); i++) {
                CHECK(t, serializer.words[i] == bits_of(y[i]));
            }
            CHECK_STR(t, got, text);
        }
    }
    mt_serializer_free(&serializer);
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(workers__every_task_is_done_once_whatever_their_number),
             MT_TEST(workers__the_lowest_failing_task_is_reported),
             MT_TEST(workers__no_task_is_fine),
             MT_TEST(workers__what_is_known_is_not_done_again),
             MT_TEST(workers__parts_of_a_task_have_keys_below_its_own),
             MT_TEST(workers__parts_share_the_tasks),
             MT_TEST(workers__nothing_is_kept_after_a_cut),
             MT_TEST(workers__a_record_without_room_is_a_shortage),
             MT_TEST(workers__a_key_that_is_too_long_is_none),
             MT_TEST(serialize__gives_back_what_was_written))
