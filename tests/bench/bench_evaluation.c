/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What one evaluation of a study costs, as the search makes it: all configurations that goals
 * name, all rows and their gradients, designs moving from call to call. Beside it, in the same
 * run, a bare dsyevd with vectors of each configuration's order, the least that an answer by
 * dense matrices takes; and how wrong the frequencies are, against long double (exact.h).
 *     bench_evaluation [--quick] STUDY...
 * CSV: study,variables,configurations,freedoms,way,cpu_s,spread_s,per_second,ratio,error; the
 * ratio is to dsyevd. A study is a file, or the name of a shipped one.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bare.h"
#include "exact.h"
#include "io/options.h"
#include "problem/evaluate.h"
#include "problem/workspace.h"
#include "study/read.h"
#include "timing.h"

enum { PATH_LENGTH = 4096, MOST_VIEWS = 16 };

/* Designs of a round lie within this of the first, in the coordinates of the search. */
static const double SPREAD = 1e-3;

typedef struct bench {
    mt_study *study;
    mt_problem *problem;
    mt_workspace *w;
    mt_nlp_values out;
    double *t; /* the design of the last call */
    mt_arena mem;
} bench;

/* No design comes twice in a row. */
static void evaluate(bench *b, int call, bool slopes)
{
    mt_err err = {.text = ""};
    const mt_nlp nlp = mt_workspace_nlp(b->w);
    for (int i = 0; i < nlp.n; i++) {
        const double room = fmin(nlp.upper[i] - nlp.origin[i], nlp.origin[i] - nlp.lower[i]);
        const double step = fmin(SPREAD, fmax(room, 0.0));
        b->t[i] = nlp.origin[i] + (step * sin((double)(call + 1) * (double)(i + 1)));
    }
    stop("evaluation", mt_workspace_eval(b->w, b->t, slopes, &b->out, &err), &err);
}

static void run_values(void *context, int call)
{
    evaluate(context, call, false);
}

static void run_slopes(void *context, int call)
{
    evaluate(context, call, true);
}

/* dsyevd on L^-1 K L^-T of one configuration, whose eigenvalues are asked for; rounded, as it
 * costs the same. */
typedef struct bare {
    int n;
    double *k;
    double *a;
    double *lambda;
    mt_arena mem;
} bare;

typedef struct bares {
    int n;
    bare view[MOST_VIEWS];
} bares;

static void run_bares(void *context, int call)
{
    const bares *const all = context;
    mt_err err = {.text = ""};
    (void)call;
    for (int i = 0; i < all->n; i++) {
        bare b = all->view[i];
        mt_arena_clear(&b.mem);
        memcpy(b.a, b.k, (size_t)b.n * (size_t)b.n * sizeof *b.a);
        stop("dsyevd", bare_dsyevd(b.n, b.a, b.lambda, &b.mem, &err), &err);
    }
}

/* Room for one view, and its matrix; returns the greatest relative error of a frequency. */
static double open_bare(const mt_analysis *a, mt_arena *mem, bare *b)
{
    const size_t n = (size_t)mt_linear_freedoms(a->lin);
    double error = 0.0;
    mt_err err = {.text = ""};
    *b = (bare){.n = (int)n};
    stop("memory", mt_arena_init(&b->mem, 0, &err), &err);
    b->a = mt_arena_f64(mem, n, n);
    b->k = mt_arena_f64(mem, n, n);
    b->lambda = mt_arena_f64(mem, n, 1);
    stop("memory", mt_arena_check(mem, &err), &err);
    long double *const exact = exact_standard(a->lin);
    if (exact == NULL) {
        stop("memory", mt_fail(&err, MT_E_MEMORY, "no memory"), &err);
    }
    for (size_t i = 0; i < n * n; i++) {
        b->k[i] = (double)exact[i];
    }
    exact_eigenvalues((int)n, exact);
    for (int i = 0; i < a->modes.count; i++) {
        const long double want = exact[(ptrdiff_t)i * ((ptrdiff_t)n + 1)];
        if (a->modes.kind[i] == MT_MODE_FLEXIBLE && want > 0.0L) {
            error = fmax(error,
                         (double)fabsl(sqrtl((long double)a->modes.lambda[i] / want) - 1.0L));
        }
    }
    free(exact);
    return error;
}

static void load(const char *name, bench *b)
{
    char path[PATH_LENGTH];
    mt_err err = {.text = ""};
    const char *const tree = getenv("SOURCE_DIR");
    mt_io_options opt = {.root = NULL};
    if (strchr(name, '/') == NULL) {
        opt.root = tree == NULL ? "." : tree;
        (void)snprintf(path, sizeof path, "%s/studies/%s.json", opt.root, name);
    } else {
        (void)snprintf(path, sizeof path, "%s", name);
    }
    stop(path, mt_study_load(path, &opt, &b->study, NULL, &err), &err);
    stop(path, mt_problem_new(b->study, NULL, &b->problem, &err), &err);
    stop(path, mt_workspace_new(b->problem, &b->w, &err), &err);
    stop(path, mt_arena_init(&b->mem, 0, &err), &err);
    stop(path, mt_subproblem_values_init(b->w->c, &b->mem, &b->out, &err), &err);
    b->t = mt_arena_f64(&b->mem, (size_t)mt_workspace_nlp(b->w).n, 1);
    stop(path, mt_arena_check(&b->mem, &err), &err);
}

/* The file's name without its folder and ending. */
static void print_name(const char *path)
{
    const char *const slash = strrchr(path, '/');
    const char *const name = slash == NULL ? path : slash + 1;
    const char *const end = strrchr(name, '.');
    printf("%.*s", (int)(end == NULL ? strlen(name) : (size_t)(end - name)), name);
}

static void print_study(const timing *how, const char *name)
{
    bench b = {.study = NULL};
    bares least = {.n = 0};
    double error = 0.0;
    int freedoms = 0;
    load(name, &b);
    timed t[] = {{.what = "values", .run = run_values, .context = &b},
                 {.what = "values and slopes", .run = run_slopes, .context = &b},
                 {.what = "dsyevd", .run = run_bares, .context = &least}};
    enum { WAYS = sizeof t / sizeof *t };
    evaluate(&b, 0, true);
    for (int i = 0; i < b.problem->n_views && i < MOST_VIEWS; i++) {
        bare *const view = &least.view[least.n++];
        error = fmax(error, open_bare(b.w->views[i].analysis, &b.mem, view));
        freedoms += view->n;
    }
    timing_side_by_side(how, t, WAYS);
    for (int i = 0; i < WAYS; i++) {
        print_name(name);
        printf(",%d,%d,%d,%s,%.4g,%.2g,%.4g,%.3g,", mt_workspace_nlp(b.w).n, least.n, freedoms,
               t[i].what, t[i].median_s, t[i].spread_s, 1.0 / t[i].median_s,
               t[i].median_s / t[WAYS - 1].median_s);
        if (i < WAYS - 1) {
            printf("%.2g", error);
        }
        printf("\n");
    }
    for (int i = 0; i < least.n; i++) {
        mt_arena_free(&least.view[i].mem);
    }
    mt_workspace_delete(b.w);
    mt_problem_delete(b.problem);
    mt_study_delete(b.study);
    mt_arena_free(&b.mem);
}

int main(int argc, char **argv)
{
    const bool quick = argc > 1 && strcmp(argv[1], "--quick") == 0;
    printf(
        "study,variables,configurations,freedoms,way,cpu_s,spread_s,per_second,ratio,error\n");
    for (int i = quick ? 2 : 1; i < argc; i++) {
        print_study(quick ? &TIMING_QUICK : &TIMING_FULL, argv[i]);
    }
    return EXIT_SUCCESS;
}
