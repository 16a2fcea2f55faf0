/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What one evaluation of a study costs, as the search makes it: all configurations that goals
 * name, all rows and their gradients, designs moving from call to call. Beside it, in the same
 * run, a bare dsyevd with vectors of each configuration's order, the least that an answer by
 * dense matrices takes; and how wrong the frequencies are, against long double (exact.h).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "exact.h"
#include "io/io.h"
#include "linalg/eig.h"
#include "problem/workspace.h"

enum { ROUNDS = 7, PATH_LENGTH = 4096, COLUMN = 24 };

/* CPU time of a round [s]. */
static const double ROUND_S = 0.02;
/* Designs of a round lie within this of the first, in the coordinates of the search. */
static const double SPREAD = 1e-3;

static double now_s(void)
{
    struct timespec t;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + (1e-9 * (double)t.tv_nsec);
}

static void stop(const char *what, mt_status rc, const mt_err *err)
{
    if (rc != MT_OK) {
        (void)fprintf(stderr, "bench_evaluation: %s: %s\n", what, err->text);
        exit(EXIT_FAILURE);
    }
}

/* What is timed: called with the number of the call in its round. */
typedef void timed(void *context, int call);

/* Median of the times of one call [s]. */
static double time_calls(timed *run, void *context)
{
    double time[ROUNDS] = {0.0};
    int calls = 1;
    for (int round = -1; round < ROUNDS;) {
        const double start = now_s();
        for (int call = 0; call < calls; call++) {
            run(context, call);
        }
        const double spent = now_s() - start;
        if (round < 0) { /* how many calls make a round */
            calls *= spent < ROUND_S ? 2 : 1;
            round = spent < ROUND_S ? -1 : 0;
            continue;
        }
        int at = round;
        for (; at > 0 && time[at - 1] > spent; at--) {
            time[at] = time[at - 1];
        }
        time[at] = spent;
        round++;
    }
    return time[ROUNDS / 2] / calls;
}

typedef struct bench {
    mt_study *study;
    mt_problem *problem;
    mt_workspace *w;
    mt_nlp_values out;
    double *t; /* the design of the last call */
    bool with_gradient;
    mt_arena mem;
} bench;

/* No design comes twice in a row. */
static void evaluate(void *context, int call)
{
    bench *const b = context;
    mt_err err = {.text = ""};
    const mt_nlp nlp = mt_workspace_nlp(b->w);
    for (int i = 0; i < nlp.n; i++) {
        const double room = fmin(nlp.upper[i] - nlp.origin[i], nlp.origin[i] - nlp.lower[i]);
        const double step = fmin(SPREAD, fmax(room, 0.0));
        b->t[i] = nlp.origin[i] + (step * sin((double)(call + 1) * (double)(i + 1)));
    }
    stop("evaluation", mt_workspace_eval(b->w, b->t, b->with_gradient, &b->out, &err), &err);
}

typedef struct bare {
    int n;
    double *k;
    double *a;
    double *lambda;
    mt_arena mem;
} bare;

static void solve_bare(void *context, int call)
{
    bare *const b = context;
    mt_err err = {.text = ""};
    (void)call;
    mt_arena_clear(&b->mem);
    memcpy(b->a, b->k, (size_t)b->n * (size_t)b->n * sizeof *b->a);
    stop("dsyevd", mt_eig_sym(b->n, b->a, b->lambda, true, &b->mem, &err), &err);
}

/* Of the configurations together: the time of dsyevd, freedoms, the greatest relative error of
 * a frequency. */
typedef struct figures {
    double bare_s;
    int n;
    double error;
} figures;

static void measure_view(const mt_analysis *a, figures *f)
{
    const mt_reduced r = mt_linear_reduced(a->lin);
    const size_t n = (size_t)r.n;
    mt_err err = {.text = ""};
    bare b = {.n = r.n};
    mt_arena mem;
    stop("memory", mt_arena_init(&mem, 0, &err), &err);
    stop("memory", mt_arena_init(&b.mem, 0, &err), &err);
    b.a = mt_arena_f64(&mem, n, n);
    b.k = mt_arena_f64(&mem, n, n);
    b.lambda = mt_arena_f64(&mem, n, 1);
    stop("memory", mt_arena_check(&mem, &err), &err);
    /* A = L^-1 K L^-T, the matrix whose eigenvalues are asked for; rounded, as it costs the
     * same */
    long double *const exact = exact_standard(a->lin);
    if (exact == NULL) {
        stop("memory", MT_E_MEMORY, &err);
    }
    for (size_t i = 0; i < n * n; i++) {
        b.k[i] = (double)exact[i];
    }
    f->bare_s += time_calls(solve_bare, &b);
    f->n += r.n;
    exact_eigenvalues(r.n, exact);
    for (int i = 0; i < a->modes.count; i++) {
        const long double want = exact[(ptrdiff_t)i * (r.n + 1)];
        if (a->modes.kind[i] == MT_MODE_FLEXIBLE && want > 0.0L) {
            f->error = fmax(
                f->error, (double)fabsl(sqrtl((long double)a->modes.lambda[i] / want) - 1.0L));
        }
    }
    free(exact);
    mt_arena_free(&mem);
    mt_arena_free(&b.mem);
}

static void load(const char *name, bench *b)
{
    char path[PATH_LENGTH];
    mt_err err = {.text = ""};
    const char *const tree = getenv("SOURCE_DIR");
    const mt_io_options opt = {.root = tree == NULL ? "." : tree};
    (void)snprintf(path, sizeof path, "%s/studies/%s.json", opt.root, name);
    stop(path, mt_study_load(path, &opt, &b->study, NULL, &err), &err);
    stop(path, mt_problem_new(b->study, &b->problem, &err), &err);
    stop(path, mt_workspace_new(b->problem, &b->w, &err), &err);
    stop(path, mt_arena_init(&b->mem, 0, &err), &err);
    stop(path, mt_case_values_init(b->w->c, &b->mem, &b->out, &err), &err);
    b->t = mt_arena_f64(&b->mem, (size_t)mt_workspace_nlp(b->w).n, 1);
    stop(path, mt_arena_check(&b->mem, &err), &err);
}

static void print_us(double seconds)
{
    const double us = seconds * 1e6;
    printf(" %9.*f", us < 100.0 ? 1 : 0, us);
}

static void print_study(const char *name)
{
    bench b = {.with_gradient = false};
    figures f = {.n = 0};
    load(name, &b);
    const double values_s = time_calls(evaluate, &b);
    b.with_gradient = true;
    const double gradient_s = time_calls(evaluate, &b);
    for (int i = 0; i < b.problem->n_views; i++) {
        measure_view(b.w->views[i].analysis, &f);
    }
    printf("%-*s %5d %5d", COLUMN, name, b.problem->n_views, f.n);
    print_us(values_s);
    print_us(gradient_s);
    print_us(f.bare_s);
    printf(" %7.2f %7.2f %8.1e\n", values_s / f.bare_s, gradient_s / f.bare_s, f.error);
    mt_workspace_delete(b.w);
    mt_problem_delete(b.problem);
    mt_study_delete(b.study);
    mt_arena_free(&b.mem);
}

/* Studies to measure; none: those below. */
int main(int argc, char **argv)
{
    static const char *const shipped[] = {
        "beam_identification",     "truss_10bar_E68_9", "truss_72bar",  "six_masses_bands",
        "inceptor_identification", "inceptor_stick",    "engine_orders"};
    const int n = argc > 1 ? argc - 1 : (int)(sizeof shipped / sizeof *shipped);
    printf("One evaluation, medians of CPU time in microseconds; dsyevd with vectors, of each "
           "configuration\n%-*s %5s %5s %9s %9s %9s %7s %7s %8s\n",
           COLUMN, "study", "conf.", "n", "values", "gradient", "dsyevd", "ratio", "ratio",
           "error");
    for (int i = 0; i < n; i++) {
        print_study(argc > 1 ? argv[i + 1] : shipped[i]);
    }
    return EXIT_SUCCESS;
}
