/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <string.h>

#include "base/run.h"
#include "base/workers.h"
#include "support/mt_test.h"

enum { TASKS = 200, WORKERS = 4 };

static void progress__nobody_listens(mt_test *t)
{
    mt_progress_phase(NULL, "search", true);
    CHECK(t, !mt_progress_begin(NULL, "starts", 3));
    mt_progress_done(NULL, true);
    mt_progress_share(NULL, true, 0.5);
    mt_progress_end(NULL, true);
    mt_progress_evaluated(NULL);
    mt_progress_boxed(NULL);
    mt_progress_found(NULL, "change", 1.0, 1.0);
    mt_progress_proved(NULL);
    CHECK(t, !mt_progress_seeks(NULL));
}

static void progress__counts_the_outermost_step_only(mt_test *t)
{
    mt_progress p;
    CHECK_INT(t, mt_progress_init(&p, NULL), MT_OK);
    mt_progress_view v = mt_progress_read(&p);
    CHECK(t, v.phase == NULL && v.step == 0 && isnan(v.share));
    mt_progress_phase(&p, "search", true);
    const bool outer = mt_progress_begin(&p, "starts", 4);
    const bool inner = mt_progress_begin(&p, "boxes", 2);
    CHECK(t, outer && !inner);
    mt_progress_done(&p, outer);
    mt_progress_done(&p, inner);
    mt_progress_share(&p, inner, 0.9);
    mt_progress_end(&p, inner);
    mt_progress_phase(&p, "trade", false); /* a part of the step, too */
    mt_progress_boxed(&p);
    mt_progress_evaluated(&p);
    v = mt_progress_read(&p);
    CHECK(t, strcmp(v.phase, "search") == 0 && strcmp(v.unit, "starts") == 0);
    CHECK(t, v.step == 2 && v.done == 1 && v.total == 4 && !v.ended);
    CHECK(t, v.share == 0.25);
    CHECK(t, v.boxes == 1 && v.evaluations == 1);
    mt_progress_end(&p, outer);
    v = mt_progress_read(&p);
    CHECK(t, v.ended);
    CHECK(t, v.share == 1.0);
    mt_progress_phase(&p, "trade", false);
    v = mt_progress_read(&p);
    CHECK(t, strcmp(v.phase, "trade") == 0 && v.step == 3 && v.unit == NULL && v.done == 0);
    CHECK(t, isnan(v.share) && v.evaluations == 1 && !mt_progress_seeks(&p));
    mt_progress_free(&p);
}

/* Who looks seldom may see the first step of a phase, and next the first of the same phase
 * where it comes again. */
static void progress__a_step_never_comes_again(mt_test *t)
{
    mt_progress p;
    long last = 0;
    CHECK_INT(t, mt_progress_init(&p, NULL), MT_OK);
    for (int round = 1; round <= 3; round++) {
        mt_progress_phase(&p, "recommendations", false);
        const bool told = mt_progress_begin(&p, "designs", round);
        const mt_progress_view v = mt_progress_read(&p);
        CHECK(t, v.total == round && v.step > last);
        last = v.step;
        mt_progress_end(&p, told);
    }
    mt_progress_free(&p);
}

static void progress__a_share_never_becomes_less(mt_test *t)
{
    mt_progress p;
    CHECK_INT(t, mt_progress_init(&p, NULL), MT_OK);
    const bool told = mt_progress_begin(&p, "designs decided", 0);
    CHECK(t, isnan(mt_progress_read(&p).share));
    const double given[] = {0.25, 0.125, 2.0};
    const double shown[] = {0.25, 0.25, 1.0};
    for (int i = 0; i < MT_COUNT(given); i++) {
        mt_progress_share(&p, told, given[i]);
        CHECK(t, mt_progress_read(&p).share == shown[i]);
    }
    mt_progress_end(&p, told);
    CHECK(t, mt_progress_begin(&p, "designs decided", 0));
    CHECK(t, isnan(mt_progress_read(&p).share)); /* of the next step nothing is known */
    mt_progress_free(&p);
}

static void progress__the_best_is_the_least(mt_test *t)
{
    mt_progress p;
    CHECK_INT(t, mt_progress_init(&p, NULL), MT_OK);
    mt_progress_phase(&p, "search", true);
    CHECK(t, mt_progress_seeks(&p) && mt_progress_read(&p).what == NULL);
    mt_progress_found(&p, "clearance", -2.0, 2.0);
    mt_progress_found(&p, "clearance", nan(""), 5.0);
    mt_progress_found(&p, "clearance", -1.0, 1.0);
    CHECK(t, strcmp(mt_progress_read(&p).what, "clearance") == 0);
    CHECK(t, mt_progress_read(&p).best == 2.0);
    mt_progress_free(&p);
}

static double now_s;

static double watch(void)
{
    return now_s;
}

/* When a first design was known, and the best but for its last digits; a proof. */
static void progress__marks_say_when(mt_test *t)
{
    static const struct {
        double value;
        double first_s;
        double best_s;
    } rows[] = {
        /* nothing is found */
        {0, 0, 0},   {5.0, 2, 2}, {5.0 - 4e-6, 2, 2}, {5.0 - 8e-6, 2, 4},
        {6.0, 2, 4}, {4.0, 2, 6}, {4.0 - 3e-6, 2, 6}, {4.0 - 3e-6, 2, 6},
    };
    mt_progress p;
    CHECK_INT(t, mt_progress_init(&p, NULL), MT_OK);
    p.clock = watch;
    mt_progress_phase(&p, "search", true);
    for (int i = 0; i < MT_COUNT(rows); i++) {
        now_s = (double)i + 1.0;
        mt_progress_evaluated(&p);
        if (i > 0) {
            mt_progress_found(&p, "change", rows[i].value, rows[i].value);
        }
        const mt_progress_view v = mt_progress_read(&p);
        mt_test_row(t, "row %d", i);
        CHECK(t, i == 0
                     ? isnan(v.first.cpu_s) && isnan(v.best_at.cpu_s)
                     : v.first.cpu_s == rows[i].first_s && v.best_at.cpu_s == rows[i].best_s);
        CHECK(t, i == 0 || v.best_at.evaluations == (long)rows[i].best_s);
        CHECK(t, isnan(v.proof.cpu_s));
    }
    mt_progress_proved(&p);
    CHECK(t, mt_progress_read(&p).proof.cpu_s == now_s);
    mt_progress_free(&p);
}

static mt_status count(void *context, int worker, int task, mt_task_path *own, mt_err *err)
{
    mt_progress *const p = context;
    (void)worker;
    (void)task;
    const mt_tasks none = {0, count, NULL, context, "inner"};
    MT_TRY(mt_workers_run(1, own, &none, err));
    mt_progress_evaluated(p);
    return MT_OK;
}

static void progress__a_list_of_tasks_is_a_step(mt_test *t)
{
    mt_progress p;
    CHECK_INT(t, mt_progress_init(&p, NULL), MT_OK);
    mt_task_path task_path = {.progress = &p};
    const mt_tasks tasks = {TASKS, count, NULL, &p, "tasks"};
    /* no ledger, and yet told */
    mt_task_path inside = mt_task_path_enter(&task_path, "search");
    for (int i = 1; i <= 2; i++) {
        CHECK_INT(t, mt_workers_run(WORKERS, &inside, &tasks, NULL), MT_OK);
        const mt_progress_view v = mt_progress_read(&p);
        CHECK(t, v.step == i && v.done == TASKS && v.total == TASKS && v.ended);
        CHECK(t, strcmp(v.unit, "tasks") == 0 && v.evaluations == (long)i * TASKS);
    }
    mt_progress_free(&p);
}

MT_TEST_MAIN(MT_TEST(progress__nobody_listens),
             MT_TEST(progress__counts_the_outermost_step_only),
             MT_TEST(progress__a_step_never_comes_again),
             MT_TEST(progress__a_share_never_becomes_less),
             MT_TEST(progress__the_best_is_the_least), MT_TEST(progress__marks_say_when),
             MT_TEST(progress__a_list_of_tasks_is_a_step))
