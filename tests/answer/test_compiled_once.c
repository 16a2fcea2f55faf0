/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A study is compiled once, whatever is asked of it and by however many workers: candidates,
 * combinations, relaxations and recommendations are cases of one problem. The linker leads
 * every call that compiles through here (tests/CMakeLists.txt), where it is counted.
 */
#include <stdatomic.h>

#include "problem/workspace.h"
#include "study_kinds.h"

enum { THREADS = 4 };

/* Of one solve, its trade study included. */
typedef struct calls {
    int solves;
    int problems;
    int workspaces;
    int systems;
} calls;

static atomic_int solves;
static atomic_int problems;
static atomic_int workspaces;
static atomic_int systems;

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
WRAP(mt_study_solve, solves,
     (const mt_study *study, const mt_solve_options *opt, mt_result **out, mt_err *err),
     (study, opt, out, err))
WRAP(mt_problem_new, problems, (const mt_study *study, mt_problem **out, mt_err *err),
     (study, out, err))
WRAP(mt_workspace_new, workspaces, (const mt_problem *p, mt_workspace **out, mt_err *err),
     (p, out, err))
WRAP(mt_system_new_driven, systems,
     (const mt_model *model, int configuration, const mt_system_drive *drive, int n_inputs,
      const int *inputs, const double *at, mt_system **out, mt_err *err),
     (model, configuration, drive, n_inputs, inputs, at, out, err))
/* NOLINTEND(bugprone-reserved-identifier,cert-*,readability-function-size) */

static calls count(mt_test *t, const mt_study *study, int threads, mt_result **out)
{
    mt_solve_options opt = {.size = sizeof opt};
    mt_err err = {.text = ""};
    opt.threads = threads;
    atomic_store(&solves, 0);
    atomic_store(&problems, 0);
    atomic_store(&workspaces, 0);
    atomic_store(&systems, 0);
    CHECK_INT(t, mt_study_solve(study, &opt, out, &err), MT_OK);
    return (calls){atomic_load(&solves), atomic_load(&problems), atomic_load(&workspaces),
                   atomic_load(&systems)};
}

/* One problem; a workspace for each worker, for the original design and for each design that is
 * described. Of a trade study every point is a study, and is compiled once more where its
 * neighbours are tried. */
static void check(mt_test *t, const mt_study *study, int threads, int *first_systems)
{
    mt_result *r = NULL;
    const calls n = count(t, study, threads, &r);
    if (!CHECK(t, r != NULL)) {
        return;
    }
    if (study->trade.n_vary > 0) {
        const int points = r->trade != NULL ? r->trade->n_points : 0;
        CHECK(t, points > 0 && n.solves > points);
        CHECK(t, n.problems >= n.solves && n.problems <= n.solves + points);
    } else {
        CHECK_INT(t, n.solves, 1);
        CHECK_INT(t, n.problems, 1);
        if (r->status == MT_RESULT_SOLVED) {
            CHECK_INT(t, n.workspaces, threads + 1 + r->n_recommendations);
        }
        *first_systems = threads == 1 ? n.systems : *first_systems;
        CHECK_INT(t, n.systems, *first_systems);
    }
    mt_result_delete(r);
}

static void every_kind__is_compiled_once(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(study_kinds); i++) {
        study_case c;
        int first_systems = 0;
        mt_test_row(t, "%s", study_kinds[i].name);
        if (study_load(t, study_kinds[i].model, study_kinds[i].members, &c)) {
            for (int threads = 1; threads <= THREADS; threads++) {
                mt_test_row(t, "%s, %d threads", study_kinds[i].name, threads);
                check(t, c.study, threads, &first_systems);
            }
        }
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(every_kind__is_compiled_once))
