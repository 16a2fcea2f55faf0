/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One model's lowest frequencies by several ways, timed side by side:
 *     bench_eigen [--quick] MODEL WAY...
 * evaluation  as a search asks: K and M at a new design, then the modes
 * plain       all modes of K and M with their shapes (Cholesky, dsyevd)
 * accurate    the same with K as a sum of squares at hand, used where plain loses digits
 * few         as accurate, four modes alone
 * lowest      the lowest alone, by structure, from the model (analysis/lowest.h)
 * CSV, for each configuration: configuration,freedoms,way,cpu_s,spread_s, and four frequencies
 * with all their digits. The model's first parameter is what moves from call to call.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/analysis.h"
#include "analysis/lowest.h"
#include "model/read.h"
#include "model/values.h"
#include "timing.h"

enum { MODES = 4, MOST_WAYS = 5 };

typedef struct bench {
    const mt_model *model;
    int configuration;
    int input;
    double at;
    mt_analysis *a; /* NULL until one is needed */
    mt_arena mem;
} bench;

typedef struct way {
    const char *name;
    void (*run)(void *context, int call);
    bool dense;
    void (*read)(bench *b, double *hz);
} way;

static void read_modes(const mt_modes *modes, double *hz)
{
    for (int i = 0; i < MODES; i++) {
        const int pos = mt_modal_flexible(modes, i + 1);
        hz[i] = pos < 0 ? nan("") : mt_modal_hz(modes, pos);
    }
}

static void run_evaluation(void *context, int call)
{
    const bench *const b = context;
    const mt_analysis_options opt = {.modes.first = MODES, .accuracy = MT_MODAL_ACCURACY};
    const double at = b->at * (1.0 + (1e-4 * (double)(call % 1000)));
    mt_err err = {.text = ""};
    stop("evaluation", mt_analysis_solve(b->a, &at, &opt, &err), &err);
}

static void read_evaluation(bench *b, double *hz)
{
    run_evaluation(b, 0);
    read_modes(&b->a->modes, hz);
}

static void solve_dense(bench *b, bool accurate, int first, mt_modes *modes)
{
    const mt_reduced r = mt_linear_reduced(b->a->lin);
    const mt_stiffness_factor factor = {
        .rows = r.rows, .b = r.b, .c = r.c, .noise = r.noise, .g = r.g};
    mt_modal_options opt = mt_modal_options_default();
    mt_mass_factor mass;
    mt_err err = {.text = ""};
    opt.n_rigid = b->a->n_rigid;
    opt.modes.first = first;
    opt.accuracy = accurate ? MT_MODAL_ACCURACY : 0.0;
    mt_arena_clear(&b->mem);
    stop("mass", mt_modal_factor_mass(r.n, r.m, &b->mem, &mass, &err), &err);
    stop("modes",
         mt_modal_solve(r.k, &mass, accurate ? &factor : NULL, &opt, &b->mem, modes, &err),
         &err);
}

static void run_plain(void *context, int call)
{
    mt_modes modes;
    (void)call;
    solve_dense(context, false, 0, &modes);
}

static void run_accurate(void *context, int call)
{
    mt_modes modes;
    (void)call;
    solve_dense(context, true, 0, &modes);
}

static void run_few(void *context, int call)
{
    mt_modes modes;
    (void)call;
    solve_dense(context, true, MODES, &modes);
}

static void read_plain(bench *b, double *hz)
{
    mt_modes modes;
    solve_dense(b, false, 0, &modes);
    read_modes(&modes, hz);
}

static void read_accurate(bench *b, double *hz)
{
    mt_modes modes;
    solve_dense(b, true, 0, &modes);
    read_modes(&modes, hz);
}

static void read_few(bench *b, double *hz)
{
    mt_modes modes;
    solve_dense(b, true, MODES, &modes);
    read_modes(&modes, hz);
}

static mt_lowest *solve_lowest(const bench *b)
{
    mt_lowest *l = NULL;
    mt_err err = {.text = ""};
    stop("lowest modes",
         mt_lowest_new(&(mt_system_def){.model = b->model,
                                        .configuration = b->configuration,
                                        .n_inputs = 1,
                                        .inputs = &b->input,
                                        .at = &b->at},
                       (mt_lowest_want){.count = MODES}, &l, &err),
         &err);
    if (l->way == MT_LOWEST_NONE) {
        stop("lowest modes", mt_fail(&err, MT_E_INPUT, "%s", l->why), &err);
    }
    return l;
}

static void run_lowest(void *context, int call)
{
    (void)call;
    mt_lowest_delete(solve_lowest(context));
}

static void read_lowest(bench *b, double *hz)
{
    mt_lowest *const l = solve_lowest(b);
    read_modes(&l->found.modes, hz);
    mt_lowest_delete(l);
}

static const way WAYS[MOST_WAYS] = {
    {"evaluation", run_evaluation, true, read_evaluation},
    {"plain", run_plain, true, read_plain},
    {"accurate", run_accurate, true, read_accurate},
    {"few", run_few, true, read_few},
    {"lowest", run_lowest, false, read_lowest},
};

static const way *find_way(const char *name)
{
    for (int i = 0; i < MOST_WAYS; i++) {
        if (strcmp(WAYS[i].name, name) == 0) {
            return &WAYS[i];
        }
    }
    (void)fprintf(stderr, "bench_eigen: %s: no such way\n", name);
    exit(EXIT_FAILURE);
}

static void print_configuration(const timing *how, bench *b, int n, char *const *names)
{
    const way *ways[MOST_WAYS] = {NULL};
    timed t[MOST_WAYS] = {{.calls = 0}};
    mt_err err = {.text = ""};
    for (int i = 0; i < n; i++) {
        ways[i] = find_way(names[i]);
        t[i].run = ways[i]->run;
        t[i].context = b;
        if (ways[i]->dense && b->a == NULL) {
            stop("model",
                 mt_analysis_new(b->model, b->configuration, 1, &b->input, &b->at, &b->a, &err),
                 &err);
        }
    }
    timing_side_by_side(how, t, n);
    for (int i = 0; i < n; i++) {
        double hz[MODES];
        ways[i]->read(b, hz);
        printf("%s,", b->model->configurations[b->configuration].name.s);
        if (ways[i]->dense) {
            printf("%d", mt_linear_freedoms(b->a->lin));
        }
        printf(",%s,%.4g,%.2g", names[i], t[i].median_s, t[i].spread_s);
        for (int j = 0; j < MODES; j++) {
            printf(",%.17g", hz[j]);
        }
        printf("\n");
        (void)fflush(stdout);
    }
    mt_analysis_delete(b->a);
    b->a = NULL;
}

int main(int argc, char **argv)
{
    const bool quick = argc > 1 && strcmp(argv[1], "--quick") == 0;
    const int first = quick ? 2 : 1;
    mt_model *model = NULL;
    bench b = {.a = NULL};
    mt_err err = {.text = ""};
    if (argc < first + 2 || argc > first + 1 + MOST_WAYS) {
        (void)fprintf(stderr, "bench_eigen [--quick] MODEL WAY...\n");
        return EXIT_FAILURE;
    }
    stop(argv[first], mt_model_load(argv[first], NULL, &model, NULL, &err), &err);
    stop("memory", mt_arena_init(&b.mem, 0, &err), &err);
    if (model == NULL || model->n_parameters == 0) {
        stop(argv[first], mt_fail(&err, MT_E_INPUT, "no parameter to move"), &err);
        return EXIT_FAILURE;
    }
    b.model = model;
    b.input = 0;
    double *const original = mt_arena_f64(&b.mem, (size_t)model->n_parameters, 1);
    stop("memory", mt_arena_check(&b.mem, &err), &err);
    stop("parameters", mt_model_original_values(model, &b.mem, original, NULL, &err), &err);
    b.at = original[0];
    printf("configuration,freedoms,way,cpu_s,spread_s,hz_1,hz_2,hz_3,hz_4\n");
    for (b.configuration = 0; b.configuration < model->n_configurations; b.configuration++) {
        print_configuration(quick ? &TIMING_QUICK : &TIMING_FULL, &b, argc - first - 1,
                            argv + first + 1);
    }
    mt_arena_free(&b.mem);
    mt_model_delete(model);
    return EXIT_SUCCESS;
}
