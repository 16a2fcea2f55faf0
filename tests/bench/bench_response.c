/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A thousand frequencies of a response: the inceptor's, all sensors by a force at its grip, and
 * chains of n masses (m_i = 1 + i/10, k_i = 1e4 (1 + i/20), each spring with a damper of 1e-4
 * k_i or, "coupled", the last one alone with 1e-2), all masses by a force on the last. Errors
 * against long double, in parts of the largest value of any mass; of the inceptor against the
 * direct way. "weighted slopes" are those of a sum over these frequencies of one response of
 * the inceptor, damped, with respect to six parameters, at once and one by one; error in parts
 * of the sum of their magnitudes.
 *     bench_response [--quick]
 *     bench_response N 0|1 FILE     the chain (1: coupled) as a peer solved it: of each line of
 *                                   FILE w and then re, im of every mass; prints the error
 * CSV: problem,freedoms,outputs,way,frequencies,cpu_s,spread_s,error
 */
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model/read.h"
#include "response/response.h"
#include "timing.h"

enum { FREQUENCIES = 1000, PATH_LENGTH = 4096 };

typedef struct job {
    const mt_transfer *t;
    mt_arena *mem;
    const double *w;
    double complex *h; /* outputs x FREQUENCIES */
} job;

static void run(void *context, int call)
{
    const job *const j = context;
    mt_err err = {.text = ""};
    (void)call;
    for (int i = 0; i < FREQUENCIES; i++) {
        const mt_sample s = {.h = j->h + ((ptrdiff_t)i * j->t->n_out)};
        stop("response", mt_transfer_at(j->t, j->w[i], &s, j->mem, &err), &err);
    }
}

typedef struct chain {
    int n;
    mt_arena mem;
    double *k;
    double *m;
    double *c;
    double *s;
    mt_forced f;
    mt_mass_factor mass;
    mt_modes modes;
    mt_basis basis;
    mt_transfer direct;
} chain;

/* Between mass i and the one before it, or the ground. */
static void add_spring(ptrdiff_t n, ptrdiff_t i, double k, double *a)
{
    a[i + (i * n)] += k;
    if (i > 0) {
        a[i - 1 + ((i - 1) * n)] += k;
        a[i + ((i - 1) * n)] -= k;
        a[i - 1 + (i * n)] -= k;
    }
}

static void chain_make(chain *p, int n, bool coupled)
{
    mt_err err = {.text = ""};
    *p = (chain){.n = n};
    stop("memory", mt_arena_init(&p->mem, 0, &err), &err);
    const size_t size = (size_t)n;
    p->k = mt_arena_f64(&p->mem, size, size);
    p->m = mt_arena_f64(&p->mem, size, size);
    p->c = mt_arena_f64(&p->mem, size, size);
    p->s = mt_arena_f64(&p->mem, size, size);
    stop("memory", mt_arena_check(&p->mem, &err), &err);
    for (ptrdiff_t i = 0; i < n; i++) {
        const double k = 1e4 * (1.0 + (0.05 * (double)i));
        const double lone = i == n - 1 ? 1e-2 * k : 0.0;
        p->m[i + (i * n)] = 1.0 + (0.1 * (double)i);
        p->s[i + (i * n)] = 1.0;
        add_spring(n, i, k, p->k);
        add_spring(n, i, coupled ? lone : 1e-4 * k, p->c);
    }
    p->f = (mt_forced){.n = n, .k = p->k, .m = p->m, .c = p->c, .n_in = 1, .n_out = n};
    p->f.b[0] = p->s + ((ptrdiff_t)(n - 1) * n);
    p->f.s[0] = p->s;
    stop("mass", mt_modal_factor_mass(n, p->m, &p->mem, &p->mass, &err), &err);
    stop("modes", mt_modal_solve(p->k, &p->mass, NULL, NULL, &p->mem, &p->modes, &err), &err);
    const mt_basis_problem problem = {.f = &p->f, .mass = &p->mass, .modes = &p->modes};
    stop("basis", mt_basis_make(&problem, &p->mem, &p->basis, &err), &err);
    stop("direct", mt_transfer_direct(&p->f, &p->mem, &p->direct, &err), &err);
}

/* The chain's D(w) x = e_n in long double: elimination from the first mass on. */
static void exact(const chain *p, long double w, long double complex *x)
{
    const ptrdiff_t n = p->n;
    const long double complex i_unit = (long double complex)I;
    long double complex *const d = calloc((size_t)n, sizeof *d);
    long double complex *const off = calloc((size_t)n, sizeof *off);
    if (d == NULL || off == NULL) {
        exit(EXIT_FAILURE);
    }
    for (ptrdiff_t i = 0; i < n; i++) {
        d[i] = (long double)p->k[i + (i * n)] - (w * w * (long double)p->m[i + (i * n)]) +
               (i_unit * w * (long double)p->c[i + (i * n)]);
        if (i > 0) {
            off[i] = (long double)p->k[i + ((i - 1) * n)] +
                     (i_unit * w * (long double)p->c[i + ((i - 1) * n)]);
            d[i] -= off[i] * off[i] / d[i - 1];
        }
    }
    x[n - 1] = 1.0L / d[n - 1];
    for (ptrdiff_t i = n - 1; i > 0; i--) {
        x[i - 1] = -off[i] * x[i] / d[i - 1];
    }
    free(d);
    free(off);
}

static void print(const char *problem, int freedoms, int outputs, const timed *t, double error)
{
    (void)printf("%s,%d,%d,%s,%d,%.4g,%.2g,%.3g\n", problem, freedoms, outputs, t->what,
                 (int)FREQUENCIES, t->median_s, t->spread_s, error);
}

static double *grid(mt_arena *mem, double from, double to)
{
    mt_err err = {.text = ""};
    double *const w = mt_arena_f64(mem, FREQUENCIES, 1);
    stop("memory", mt_arena_check(mem, &err), &err);
    for (int i = 0; i < FREQUENCIES; i++) {
        w[i] = from + ((to - from) * i / (FREQUENCIES - 1));
    }
    return w;
}

static void bench_chain(const timing *how, int n, bool coupled)
{
    chain p;
    chain_make(&p, n, coupled);
    mt_err err = {.text = ""};
    const size_t size = (size_t)n * FREQUENCIES;
    double *const w = grid(&p.mem, 0.1, 200.0);
    job jobs[2] = {{.t = &p.basis.t, .mem = &p.mem, .w = w},
                   {.t = &p.direct, .mem = &p.mem, .w = w}};
    timed things[2] = {{.what = "modes", .run = run, .context = &jobs[0]},
                       {.what = "direct", .run = run, .context = &jobs[1]}};
    long double complex *const want = calloc((size_t)n, sizeof *want);
    jobs[0].h = mt_arena_alloc(&p.mem, size, sizeof *jobs[0].h);
    jobs[1].h = mt_arena_alloc(&p.mem, size, sizeof *jobs[1].h);
    stop("memory", want == NULL ? MT_E_MEMORY : mt_arena_check(&p.mem, &err), &err);
    timing_side_by_side(how, things, 2);
    double error[2] = {0.0, 0.0};
    for (ptrdiff_t i = 0; i < FREQUENCIES; i++) {
        double largest = 0.0;
        exact(&p, (long double)w[i], want);
        for (int o = 0; o < n; o++) {
            largest = fmax(largest, (double)cabsl(want[o]));
        }
        for (ptrdiff_t o = 0; o < n; o++) {
            for (int way = 0; way < 2; way++) {
                const double off =
                    cabs(jobs[way].h[o + (i * n)] - (double complex)want[o]) / largest;
                error[way] = off <= error[way] ? error[way] : off;
            }
        }
    }
    for (int way = 0; way < 2; way++) {
        print(coupled ? "coupled chain" : "chain", n, n, &things[way], error[way]);
    }
    free(want);
    mt_arena_free(&p.mem);
}

enum { INPUTS = 6 };

/* Sum over frequencies of weight times slope. */
typedef struct weighted {
    mt_response *r;
    bool at_once;
    const double *w;
    double complex *weight; /* [FREQUENCIES] */
    double slope[INPUTS];
    double size[INPUTS]; /* of the sum one by one */
} weighted;

static void run_weighted(void *context, int call)
{
    weighted *const j = context;
    double complex dh[INPUTS];
    mt_err err = {.text = ""};
    (void)call;
    memset(j->slope, 0, sizeof j->slope);
    memset(j->size, 0, sizeof j->size);
    if (j->at_once) {
        stop("weighted slopes",
             mt_response_weighted_slopes(j->r, 0, 0, FREQUENCIES, j->w, j->weight, j->slope,
                                         &err),
             &err);
    }
    for (int i = 0; i < FREQUENCIES && !j->at_once; i++) {
        stop("slopes", mt_response_slopes_at(j->r, j->w[i], dh, &err), &err);
        for (int p = 0; p < INPUTS; p++) {
            j->slope[p] += creal(j->weight[i] * dh[p]);
            j->size[p] += cabs(j->weight[i] * dh[p]);
        }
    }
}

static void bench_weighted(const timing *how, const mt_model *model)
{
    static const char *const names[INPUTS] = {"K_T1", "M_SAU", "m_1", "m_u", "l_a", "k_servo"};
    static const char *const grip = "grip.y";
    const mt_response_request request = {
        .n_in = 1, .inputs = &grip, .n_out = 1, .outputs = &grip};
    mt_analysis_options opt = mt_analysis_options_default();
    double at[INPUTS];
    int input[INPUTS];
    mt_err err = {.text = ""};
    mt_analysis *a = NULL;
    mt_response r = {.a = NULL};
    for (int p = 0; p < INPUTS; p++) {
        input[p] = mt_model_find_parameter(model, names[p]);
        at[p] = model->parameters[input[p]].value;
    }
    opt.gradient = true;
    const int c = mt_model_find_configuration(model, "shaken");
    stop("inceptor", mt_analysis_new(model, c, INPUTS, input, at, &a, &err), &err);
    stop("inceptor", mt_analysis_solve(a, at, &opt, &err), &err);
    stop("inceptor", mt_response_open(a, &request, &r, &err), &err);
    weighted jobs[2] = {{.r = &r, .at_once = true}, {.r = &r}};
    timed things[2] = {{.what = "at once", .run = run_weighted, .context = &jobs[0]},
                       {.what = "one by one", .run = run_weighted, .context = &jobs[1]}};
    double complex *const weight = mt_arena_alloc(&r.mem, FREQUENCIES, sizeof *weight);
    double *const w = grid(&r.mem, 1.0, 1000.0);
    for (int i = 0; i < FREQUENCIES; i++) {
        weight[i] = cexp(mt_complex(0.0, 0.37 * i));
    }
    jobs[0].w = jobs[1].w = w;
    jobs[0].weight = jobs[1].weight = weight;
    timing_side_by_side(how, things, 2);
    double error = 0.0;
    for (int p = 0; p < INPUTS; p++) {
        const double off = fabs(jobs[0].slope[p] - jobs[1].slope[p]) / jobs[1].size[p];
        error = off <= error ? error : off;
    }
    for (int way = 0; way < 2; way++) {
        print("weighted slopes", r.f.n, 1, &things[way], error);
    }
    mt_response_free(&r);
    mt_analysis_delete(a);
}

static void bench_inceptor(const timing *how)
{
    static const char *const grip = "e3.y";
    const char *const source = getenv("SOURCE_DIR");
    char path[PATH_LENGTH];
    mt_err err = {.text = ""};
    mt_model *model = NULL;
    mt_analysis *a = NULL;
    mt_response r = {.a = NULL};
    const mt_response_request request = {.n_in = 1, .inputs = &grip};
    (void)snprintf(path, sizeof path, "%s/problems/inceptor.json",
                   source == NULL ? "." : source);
    stop(path, mt_model_load(path, NULL, &model, NULL, &err), &err);
    const int c = mt_model_find_configuration(model, "installed");
    stop(path, mt_analysis_new(model, c, 0, NULL, NULL, &a, &err), &err);
    stop(path, mt_response_open(a, &request, &r, &err), &err);
    const size_t size = (size_t)r.ports.n_out * FREQUENCIES;
    double *const w = grid(&r.mem, 1.0, 1000.0);
    job jobs[2] = {{.t = &r.basis.t, .mem = &r.mem, .w = w},
                   {.t = &r.direct, .mem = &r.mem, .w = w}};
    timed things[2] = {{.what = "modes", .run = run, .context = &jobs[0]},
                       {.what = "direct", .run = run, .context = &jobs[1]}};
    jobs[0].h = mt_arena_alloc(&r.mem, size, sizeof *jobs[0].h);
    jobs[1].h = mt_arena_alloc(&r.mem, size, sizeof *jobs[1].h);
    stop("memory", mt_arena_check(&r.mem, &err), &err);
    timing_side_by_side(how, things, 2);
    double error = 0.0;
    double largest = 0.0;
    for (size_t i = 0; i < size; i++) {
        const double off = cabs(jobs[0].h[i] - jobs[1].h[i]);
        largest = fmax(largest, cabs(jobs[1].h[i]));
        error = off <= error ? error : off;
    }
    for (int way = 0; way < 2; way++) {
        print("inceptor", r.f.n, r.ports.n_out, &things[way], error / largest);
    }
    mt_response_free(&r);
    mt_analysis_delete(a);
    bench_weighted(how, model);
    mt_model_delete(model);
}

/* The next number of a peer's file; NaN: there is none. */
static double next(FILE *file)
{
    char word[64];
    char *end = NULL;
    if (fscanf(file, "%63s", word) != 1) {
        return nan("");
    }
    const double x = strtod(word, &end);
    return *end == '\0' ? x : nan("");
}

/* What a peer says of a chain. */
static void judge(int n, bool coupled, FILE *file, long double complex *want)
{
    chain p;
    chain_make(&p, n, coupled);
    double worst = 0.0;
    double w = next(file);
    while (!isnan(w)) {
        double largest = 0.0;
        double most = 0.0;
        exact(&p, (long double)w, want);
        for (int o = 0; o < n; o++) {
            const double re = next(file) - (double)creall(want[o]);
            const double off = hypot(re, next(file) - (double)cimagl(want[o]));
            largest = fmax(largest, (double)cabsl(want[o]));
            most = off <= most ? most : off;
        }
        worst = most / largest <= worst ? worst : most / largest;
        w = next(file);
    }
    mt_arena_free(&p.mem);
    (void)printf("error\n%.3g\n", worst);
}

int main(int argc, char *argv[])
{
    if (argc == 4) {
        const int n = (int)strtol(argv[1], NULL, 10);
        FILE *const file = fopen(argv[3], "r");
        long double complex *const want = calloc(n > 0 ? (size_t)n : 1, sizeof *want);
        const bool ready = file != NULL && want != NULL;
        if (ready) {
            judge(n, argv[2][0] == '1', file, want);
        }
        if (file != NULL) {
            (void)fclose(file);
        }
        free(want);
        return ready ? EXIT_SUCCESS : EXIT_FAILURE;
    }
    const timing *const how =
        argc > 1 && strcmp(argv[1], "--quick") == 0 ? &TIMING_QUICK : &TIMING_FULL;
    (void)printf("problem,freedoms,outputs,way,frequencies,cpu_s,spread_s,error\n");
    bench_inceptor(how);
    for (int n = 10; n <= 40; n *= 4) {
        bench_chain(how, n, false);
        bench_chain(how, n, true);
    }
    return EXIT_SUCCESS;
}
