/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How long the nine-element beam takes, and how wrong the answer is, against long double
 * (exact_beam.h), as CSV: what,way,cpu_s,spread_s,error,evaluations.
 *     bench_beam [--quick]     ours, and a bare dsyevd
 *     bench_beam FILE          what bench_beam.m printed into FILE
 * Evaluations are timed as the search makes them, springs moving from call to call.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/analysis.h"
#include "bare.h"
#include "exact.h"
#include "exact_beam.h"
#include "io/options.h"
#include "result/result.h"
#include "study/read.h"
#include "study/study.h"
#include "timing.h"

#define SYMMETRIC "tests/bench/beam_symmetric_study.json"
#define STUDY     "studies/beam_identification.json"

/* In the plane, along the beam too. */
enum { ORDER = XB_N + 1, ENTRIES = ORDER * ORDER };

typedef struct duration {
    double median_s;
    double spread_s;
} duration;

/* One side's numbers. */
typedef struct figures {
    duration evaluation;     /* four frequencies */
    duration gradient;       /* and their derivatives with respect to eight springs */
    duration identification; /* four springs from four frequencies */
    double calls;            /* evaluations that this took */
    double hz[XB_MODES];
    double slope[XB_MODES * XB_SPRINGS]; /* row by row, one row per mode */
    double spring[XB_MODES];
} figures;

/* The design of a call, and the analysis that is asked. */
typedef struct asked {
    mt_analysis *analysis;
    const double *k;
    figures *out;
    bool with_gradient;
} asked;

/* What the least of answers by dense matrices takes: L^-1 K L^-T, rounded. */
typedef struct bare {
    double a[ENTRIES];
    double work[ENTRIES];
    double lambda[ORDER];
    mt_arena mem;
} bare;

static void evaluate(mt_analysis *a, const double *k, bool with_gradient, figures *f)
{
    mt_err err = {.text = ""};
    const mt_analysis_options opt = {
        .modes.first = XB_MODES, .gradient = with_gradient, .accuracy = MT_MODAL_ACCURACY};
    stop("solve", mt_analysis_solve(a, k, &opt, &err), &err);
    for (int mode = 0; mode < XB_MODES; mode++) {
        const int pos = mt_modal_flexible(&a->modes, mode + 1);
        double *const row = f->slope + (ptrdiff_t)mode * XB_SPRINGS;
        f->hz[mode] = mt_modal_hz(&a->modes, pos);
        if (with_gradient) {
            stop("gradient", mt_analysis_dlambda(a, pos, row, NULL, &err), &err);
        }
        for (int i = 0; with_gradient && i < XB_SPRINGS; i++) { /* d lambda = 8 pi^2 f df */
            row[i] /= 8.0 * (double)(XB_PI * XB_PI) * f->hz[mode];
        }
    }
}

/* The first call of a round is at k itself, and so is the last that is made at all. */
static void run_asked(void *context, int call)
{
    const asked *const q = context;
    double moved[XB_SPRINGS];
    for (int i = 0; i < XB_SPRINGS; i++) {
        moved[i] = q->k[i] * (1.0 + (1e-4 * (double)(call % 1000)));
    }
    evaluate(q->analysis, moved, q->with_gradient, q->out);
}

static void run_bare(void *context, int call)
{
    bare *const b = context;
    mt_err err = {.text = ""};
    (void)call;
    mt_arena_clear(&b->mem);
    memcpy(b->work, b->a, sizeof b->work);
    stop("dsyevd", bare_dsyevd(ORDER, b->work, b->lambda, &b->mem, &err), &err);
}

/* A study of the source tree, which SOURCE_DIR names (absent: the current folder). */
static mt_study *load(const char *name)
{
    enum { PATH_LENGTH = 4096 };
    const char *const tree = getenv("SOURCE_DIR");
    char path[PATH_LENGTH];
    mt_study *study = NULL;
    mt_err err = {.text = ""};
    const mt_io_options opt = {.root = tree == NULL ? "." : tree};
    (void)snprintf(path, sizeof path, "%s/%s", opt.root, name);
    stop(path, mt_study_load(path, &opt, &study, NULL, &err), &err);
    return study;
}

/* A whole study: baseline, search, each design recomputed from scratch. The result stays. */
typedef struct solved {
    const mt_study *study;
    mt_result *result;
} solved;

static void run_study(void *context, int call)
{
    solved *const q = context;
    mt_err err = {.text = ""};
    (void)call;
    mt_result_delete(q->result);
    stop("study", mt_study_solve(q->study, NULL, &q->result, &err), &err);
}

static duration duration_of(const timed *t)
{
    return (duration){t->median_s, t->spread_s};
}

static void print_row(const char *what, const char *way, duration d, double error,
                      double evaluations)
{
    printf("\"%s\",%s,%.4g,%.2g,%.2g,", what, way, d.median_s, d.spread_s, error);
    printf(isnan(evaluations) ? "\n" : "%.0f\n", evaluations);
}

/* The least of answers by dense matrices, and how wrong its eigenvalues are. */
static void open_bare(const mt_linear *lin, bare *b, long double *lambda)
{
    mt_err err = {.text = ""};
    long double *const exact = exact_standard(lin);
    if (exact == NULL || mt_linear_freedoms(lin) != ORDER) {
        (void)fprintf(stderr, "bench_beam: no matrix of order %d\n", ORDER);
        exit(EXIT_FAILURE);
    }
    for (int i = 0; i < ENTRIES; i++) {
        b->a[i] = (double)exact[i];
    }
    exact_eigenvalues(ORDER, exact);
    for (int i = 0; i < ORDER; i++) {
        lambda[i] = exact[(ptrdiff_t)i * (ORDER + 1)];
    }
    free(exact);
    stop("dsyevd", mt_arena_init(&b->mem, 0, &err), &err);
}

/* Of the four lowest frequencies behind the three rigid-body motions. */
static double bare_error(const bare *b, const long double *lambda)
{
    double worst = 0.0;
    for (int i = ORDER - XB_SPRINGS; i < ORDER - XB_SPRINGS + XB_MODES; i++) {
        worst = fmax(worst, (double)fabsl(sqrtl((long double)b->lambda[i] / lambda[i]) - 1.0L));
    }
    return worst;
}

/* "name value" lines, as bench_beam.m prints them; repeated names fill an array. */
static bool read_figures(const char *path, figures *f)
{
    FILE *const file = fopen(path, "r");
    char name[32];
    char value[40];
    int hz = 0;
    int slope = 0;
    int spring = 0;
    if (file == NULL) {
        return false;
    }
    while (fscanf(file, "%31s %39s", name, value) == 2) {
        const double x = strtod(value, NULL);
        if (strcmp(name, "evaluation_s") == 0) {
            f->evaluation.median_s = x;
        } else if (strcmp(name, "evaluation_spread_s") == 0) {
            f->evaluation.spread_s = x;
        } else if (strcmp(name, "gradient_s") == 0) {
            f->gradient.median_s = x;
        } else if (strcmp(name, "gradient_spread_s") == 0) {
            f->gradient.spread_s = x;
        } else if (strcmp(name, "identification_s") == 0) {
            f->identification.median_s = x;
        } else if (strcmp(name, "identification_spread_s") == 0) {
            f->identification.spread_s = x;
        } else if (strcmp(name, "calls") == 0) {
            f->calls = x;
        } else if (strcmp(name, "hz") == 0 && hz < XB_MODES) {
            f->hz[hz++] = x;
        } else if (strcmp(name, "slope") == 0 && slope < XB_MODES * XB_SPRINGS) {
            f->slope[slope++] = x;
        } else if (strcmp(name, "spring") == 0 && spring < XB_MODES) {
            f->spring[spring++] = x;
        }
    }
    (void)fclose(file);
    return hz == XB_MODES && slope == XB_MODES * XB_SPRINGS && spring == XB_MODES;
}

/* Largest relative errors of frequencies, gradient (to the largest of its row) and springs. */
typedef struct errors {
    double hz;
    double slope;
    double spring;
} errors;

static errors errors_of(const figures *f, const double *k)
{
    static const long double target[XB_MODES] = {1.704L, 4.697L, 9.208L, 15.22L};
    long double at[XB_SPRINGS];
    xb_modes exact;
    errors e = {0.0, 0.0, 0.0};
    for (int i = 0; i < XB_SPRINGS; i++) {
        at[i] = (long double)k[i];
    }
    xb_solve(at, &exact);
    for (int mode = 0; mode < XB_MODES; mode++) {
        double largest = 0.0;
        double worst = 0.0;
        for (int i = 0; i < XB_SPRINGS; i++) {
            const double want = (double)exact.gradient[mode][i];
            largest = fmax(largest, fabs(want));
            worst = fmax(worst, fabs(f->slope[(mode * XB_SPRINGS) + i] - want));
        }
        e.slope = fmax(e.slope, worst / largest);
        e.hz = fmax(e.hz, (double)fabsl((long double)f->hz[mode] / exact.hz[mode] - 1.0L));
    }
    xb_identify(target, at);
    for (int i = 0; i < XB_MODES; i++) {
        e.spring = fmax(e.spring, (double)fabsl((long double)f->spring[i] / at[i] - 1.0L));
    }
    return e;
}

/* Of the frequencies of a design, to their targets. */
static double target_error(const mt_recommendation *r)
{
    double worst = 0.0;
    for (int i = 0; i < r->n_frequencies; i++) {
        if (!isnan(r->frequencies[i].target_hz)) {
            worst = fmax(
                worst,
                fabs(r->frequencies[i].recommended_hz / r->frequencies[i].target_hz - 1.0));
        }
    }
    return worst;
}

static const char *const WHAT[] = {"four frequencies", "four frequencies, slopes for 8 springs",
                                   "4 springs from 4 frequencies, one start"};

static void print_figures(const char *way, const figures *f, const errors *e)
{
    print_row(WHAT[0], way, f->evaluation, e->hz, nan(""));
    print_row(WHAT[1], way, f->gradient, e->slope, nan(""));
    print_row(WHAT[2], way, f->identification, e->spring, f->calls);
}

static void print_ours(const timing *how, const mt_study *study, const double *k)
{
    int inputs[XB_SPRINGS];
    figures f = {.calls = 0.0};
    bare b = {.lambda = {0.0}};
    long double lambda[ORDER];
    mt_analysis *a = NULL;
    mt_err err = {.text = ""};
    mt_study *const symmetric = load(SYMMETRIC);
    solved one = {.study = symmetric};
    solved whole = {.study = study};
    for (int i = 0; i < XB_SPRINGS; i++) {
        inputs[i] = study->variables[i].parameter;
    }
    const int free_free = mt_model_find_configuration(study->model, "free_free");
    stop("model", mt_analysis_new(study->model, free_free, XB_SPRINGS, inputs, k, &a, &err),
         &err);
    open_bare(a->lin, &b, lambda);
    asked values = {a, k, &f, false};
    asked slopes = {a, k, &f, true};
    timed t[] = {{.run = run_asked, .context = &values},
                 {.run = run_asked, .context = &slopes},
                 {.run = run_bare, .context = &b},
                 {.run = run_study, .context = &one},
                 {.run = run_study, .context = &whole}};
    timing_side_by_side(how, t, (int)(sizeof t / sizeof *t));
    run_asked(&slopes, 0);
    f.evaluation = duration_of(&t[0]);
    f.gradient = duration_of(&t[1]);
    f.identification = duration_of(&t[3]);
    f.calls = (double)one.result->run.evaluations;
    for (int i = 0; i < XB_MODES; i++) {
        f.spring[i] = one.result->recommendations[0].parameters[i].recommended;
    }
    const errors e = errors_of(&f, k);
    print_figures("modetune", &f, &e);
    print_row("a bare dsyevd with vectors of the same order", "LAPACK", duration_of(&t[2]),
              bare_error(&b, lambda), nan(""));
    print_row("8 springs, frequencies and shapes, whole study", "modetune", duration_of(&t[4]),
              target_error(&whole.result->recommendations[0]),
              (double)whole.result->run.evaluations);
    mt_result_delete(one.result);
    mt_result_delete(whole.result);
    mt_study_delete(symmetric);
    mt_arena_free(&b.mem);
    mt_analysis_delete(a);
}

int main(int argc, char **argv)
{
    const bool quick = argc > 1 && strcmp(argv[1], "--quick") == 0;
    mt_study *const study = load(STUDY);
    double k[XB_SPRINGS];
    for (int i = 0; i < XB_SPRINGS; i++) {
        k[i] = study->variables[i].original;
    }
    printf("what,way,cpu_s,spread_s,error,evaluations\n");
    if (argc > 1 && !quick) {
        figures theirs = {.calls = 0.0};
        if (!read_figures(argv[1], &theirs)) {
            (void)fprintf(stderr, "bench_beam: %s does not hold what bench_beam.m prints\n",
                          argv[1]);
            mt_study_delete(study);
            return EXIT_FAILURE;
        }
        const errors e = errors_of(&theirs, k);
        print_figures("Octave", &theirs, &e);
    } else {
        print_ours(quick ? &TIMING_QUICK : &TIMING_FULL, study, k);
    }
    mt_study_delete(study);
    return EXIT_SUCCESS;
}
