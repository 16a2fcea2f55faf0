/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A study is compiled once, whatever is asked of it and by however many workers: candidates,
 * combinations, relaxations and recommendations are cases of one problem. The linker leads
 * every call that compiles through here (tests/CMakeLists.txt), where it is counted.
 */

#include <stdatomic.h>

#include "describe/describe.h"
#include "study_kinds.h"

enum { THREADS = 4 };

static atomic_int problems;
static atomic_int workspaces;
static atomic_int descriptions;
static atomic_int systems;
static atomic_int moving;   /* of them with a position as input: one drive's range of motion */
static atomic_int cuts;     /* of them at a position that is no configuration's */
static atomic_int verified; /* of them in descriptions, which build anew what they verify */
static _Thread_local int own_systems; /* of a thread: designs are described side by side */

/* names are the linker's, parameters the functions' */
/* NOLINTBEGIN(bugprone-reserved-identifier,cert-*,readability-function-size) */
#define WRAP(name, counter, parameters, arguments) \
    mt_status __real_##name parameters;            \
    mt_status __wrap_##name parameters;            \
    mt_status __wrap_##name parameters             \
    {                                              \
        (void)atomic_fetch_add(&(counter), 1);     \
        return __real_##name arguments;            \
    }
WRAP(mt_problem_new, problems,
     (const mt_study *study, const mt_run *run, mt_problem **out, mt_err *err),
     (study, run, out, err))
WRAP(mt_workspace_new, workspaces, (const mt_problem *p, mt_workspace **out, mt_err *err),
     (p, out, err))

mt_status __real_mt_system_new_of(const mt_system_def *def, mt_system **out, mt_err *err);
mt_status __wrap_mt_system_new_of(const mt_system_def *def, mt_system **out, mt_err *err);
mt_status __wrap_mt_system_new_of(const mt_system_def *def, mt_system **out, mt_err *err)
{
    const mt_system_drive *const drive = def->drive;
    own_systems++;
    (void)atomic_fetch_add(&systems, 1);
    (void)atomic_fetch_add(&moving, drive != NULL && !drive->fixed ? 1 : 0);
    (void)atomic_fetch_add(&cuts, drive != NULL && drive->fixed ? 1 : 0);
    return __real_mt_system_new_of(def, out, err);
}

mt_status __real_mt_describe_design(const mt_problem *p, const mt_design *design,
                                    const mt_recommendation *baseline, mt_result *result,
                                    mt_recommendation *rec, mt_err *err);
mt_status __wrap_mt_describe_design(const mt_problem *p, const mt_design *design,
                                    const mt_recommendation *baseline, mt_result *result,
                                    mt_recommendation *rec, mt_err *err);
mt_status __wrap_mt_describe_design(const mt_problem *p, const mt_design *design,
                                    const mt_recommendation *baseline, mt_result *result,
                                    mt_recommendation *rec, mt_err *err)
{
    const int before = own_systems;
    const mt_status rc = __real_mt_describe_design(p, design, baseline, result, rec, err);
    (void)atomic_fetch_add(&descriptions, 1);
    (void)atomic_fetch_add(&verified, own_systems - before);
    return rc;
}
/* NOLINTEND(bugprone-reserved-identifier,cert-*,readability-function-size) */

static mt_result *solve(mt_test *t, const mt_study *study, int threads)
{
    mt_solve_options opt = {.size = sizeof opt};
    mt_err err = {.text = ""};
    mt_result *r = NULL;
    atomic_int *const all[] = {&problems, &workspaces, &descriptions, &systems,
                               &moving,   &cuts,       &verified};
    opt.threads = threads;
    for (int i = 0; i < MT_COUNT(all); i++) {
        atomic_store(all[i], 0);
    }
    CHECK_INT(t, mt_study_solve(study, &opt, &r, &err), MT_OK);
    return r;
}

/* Drives whose motion is followed for bands or limits, as the original design says. */
static int motions_of(const mt_result *r)
{
    return r->baseline.n_motions + r->baseline.n_between;
}

/* One problem; a workspace for each worker, for the original design and for each design that is
 * described; one system for each motion. Of a trade study every point is a study, however
 * often it is answered. */
static void check(mt_test *t, const mt_study *study, int threads, int *first_systems,
                  int *first_cuts)
{
    mt_result *const r = solve(t, study, threads);
    if (!CHECK(t, r != NULL)) {
        return;
    }
    const int points = r->trade != NULL ? r->trade->n_points : 0;
    CHECK(t, points > 0 || study->trade.n_vary == 0);
    CHECK_INT(t, atomic_load(&problems), 1 + points);
    CHECK_INT(t, atomic_load(&moving), motions_of(r) * (1 + points));
    *first_systems = threads == 1 ? atomic_load(&systems) : *first_systems;
    *first_cuts = threads == 1 ? atomic_load(&cuts) : *first_cuts;
    CHECK_INT(t, atomic_load(&systems), *first_systems);
    CHECK_INT(t, atomic_load(&cuts), *first_cuts);
    if (points == 0 && r->status == MT_RESULT_SOLVED) {
        CHECK_INT(t, atomic_load(&workspaces), threads + 1 + r->n_recommendations);
    }
    if (points == 0) { /* of these, points are described side by side */
        int views = 0;
        for (int i = 0; i < r->baseline.n_frequencies; i++) {
            const mt_result_frequency *const f = &r->baseline.frequencies[i];
            views += i == 0 || strcmp(f[-1].configuration, f->configuration) != 0 ? 1 : 0;
        }
        CHECK_INT(t, atomic_load(&descriptions), 1 + r->n_recommendations);
        CHECK_INT(t, atomic_load(&verified), views * (1 + r->n_recommendations));
    }
    mt_result_delete(r);
}

static void every_kind__is_compiled_once(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(study_kinds); i++) {
        study_case c;
        int first_systems = 0;
        int first_cuts = 0;
        mt_test_row(t, "%s", study_kinds[i].name);
        if (study_load(t, study_kinds[i].model, study_kinds[i].members, &c)) {
            for (int threads = 1; threads <= THREADS; threads += THREADS - 1) {
                mt_test_row(t, "%s, %d threads", study_kinds[i].name, threads);
                check(t, c.study, threads, &first_systems, &first_cuts);
            }
        }
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(every_kind__is_compiled_once))
