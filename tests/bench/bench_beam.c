/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How long the nine-element beam takes, and how wrong the answer is, both against long double
 * (exact_beam.h).
 *     bench_beam          ours alone
 *     bench_beam FILE     beside the numbers that bench_beam.m printed into FILE
 * Evaluations are timed as the search makes them, springs moving from call to call; each time
 * is the best of several rounds, which is what the machine can do when nothing else disturbs
 * it.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "analysis/analysis.h"
#include "exact_beam.h"
#include "io/io.h"
#include "result/result.h"
#include "study/study.h"

enum { ROUNDS = 15, CALLS = 400, SOLVES = 9, FULL_SOLVES = 3 };

#define SYMMETRIC "tests/bench/beam_symmetric_study.json"
#define STUDY     "studies/beam_identification.json"

/* One side's numbers; NaN where it has none. */
typedef struct figures {
    double evaluation_s;     /* four frequencies */
    double gradient_s;       /* and their derivatives with respect to eight springs */
    double identification_s; /* four springs from four frequencies */
    double calls;            /* evaluations that this took */
    double hz[XB_MODES];
    double slope[XB_MODES * XB_SPRINGS]; /* row by row, one row per mode */
    double spring[XB_MODES];
} figures;

static double now_s(void)
{
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (1e-9 * (double)t.tv_nsec);
}

static void stop(const char *what, mt_status rc, const mt_err *err)
{
    if (rc != MT_OK) {
        (void)fprintf(stderr, "bench_beam: %s: %s\n", what, err->text);
        exit(EXIT_FAILURE);
    }
}

static void evaluate(mt_analysis *a, const double *k, bool with_gradient, figures *f)
{
    mt_err err = {.text = ""};
    const mt_analysis_options opt = {
        .gradient = with_gradient, .vectors = with_gradient, .accuracy = true};
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

/* Best time of one call; the last call is at k itself. */
static double time_evaluation(mt_analysis *a, const double *k, bool with_gradient, figures *f)
{
    double best = HUGE_VAL;
    for (int round = 0; round < ROUNDS; round++) {
        const double start = now_s();
        for (int call = CALLS - 1; call >= 0; call--) {
            double moved[XB_SPRINGS];
            for (int i = 0; i < XB_SPRINGS; i++) {
                moved[i] = k[i] * (1.0 + (1e-4 * (double)call));
            }
            evaluate(a, moved, with_gradient, f);
        }
        best = fmin(best, (now_s() - start) / CALLS);
    }
    return best;
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

/* Best time to answer the study: baseline, search, each design recomputed from scratch. Leaves
 * the last result. */
static double time_study(const mt_study *study, int solves, mt_result **result)
{
    double best = HUGE_VAL;
    mt_err err = {.text = ""};
    *result = NULL;
    for (int i = 0; i < solves; i++) {
        mt_result_delete(*result);
        const double start = now_s();
        stop("study", mt_study_solve(study, NULL, result, &err), &err);
        best = fmin(best, now_s() - start);
    }
    return best;
}

static void time_modes(const mt_study *study, figures *f, double *k)
{
    int inputs[XB_SPRINGS];
    mt_analysis *a = NULL;
    mt_err err = {.text = ""};
    for (int i = 0; i < XB_SPRINGS; i++) {
        inputs[i] = study->variables[i].parameter;
        k[i] = study->variables[i].original;
    }
    const int free_free = mt_model_find_configuration(study->model, "free_free");
    stop("model", mt_analysis_new(study->model, free_free, XB_SPRINGS, inputs, k, &a, &err),
         &err);
    f->evaluation_s = time_evaluation(a, k, false, f);
    f->gradient_s = time_evaluation(a, k, true, f);
    mt_analysis_delete(a);
}

static void time_springs(figures *f)
{
    mt_study *const study = load(SYMMETRIC);
    mt_result *result = NULL;
    f->identification_s = time_study(study, SOLVES, &result);
    f->calls = (double)result->run.evaluations;
    for (int i = 0; i < XB_MODES; i++) {
        f->spring[i] = result->recommendations[0].parameters[i].recommended;
    }
    mt_result_delete(result);
    mt_study_delete(study);
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
            f->evaluation_s = x;
        } else if (strcmp(name, "gradient_s") == 0) {
            f->gradient_s = x;
        } else if (strcmp(name, "identification_s") == 0) {
            f->identification_s = x;
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

/* Three digits, without an exponent. */
static void print_time(double seconds, int width)
{
    const double us = seconds * 1e6;
    printf(" %*.*f", width, us < 100.0 ? 1 : 0, us);
}

static void print_row(const char *what, double ours, double our_error, double theirs,
                      double their_error)
{
    printf("%-48s", what);
    print_time(ours, 9);
    printf(" %8.1e", our_error);
    if (theirs == theirs) {
        print_time(theirs, 9);
        printf(" %8.1e %7.0f", their_error, theirs / ours);
    }
    printf("\n");
}

static void print_head(const char *what, bool both)
{
    printf("%-48s %9s %8s", what, "modetune", "error");
    if (both) {
        printf(" %9s %8s %7s", "Octave", "error", "ratio");
    }
    printf("\n");
}

int main(int argc, char **argv)
{
    const bool both = argc > 1;
    mt_study *const study = load(STUDY);
    figures ours = {0};
    figures theirs = {
        .evaluation_s = nan(""), .gradient_s = nan(""), .identification_s = nan("")};
    double k[XB_SPRINGS];
    mt_result *result = NULL;
    if (both && !read_figures(argv[1], &theirs)) {
        (void)fprintf(stderr, "bench_beam: %s does not hold what bench_beam.m prints\n",
                      argv[1]);
        return EXIT_FAILURE;
    }
    time_modes(study, &ours, k);
    time_springs(&ours);
    const errors us = errors_of(&ours, k);
    const errors them = errors_of(&theirs, k);
    print_head("nine-element beam, times in microseconds", both);
    print_row("four frequencies", ours.evaluation_s, us.hz, theirs.evaluation_s, them.hz);
    print_row("four frequencies, gradient for 8 springs", ours.gradient_s, us.slope,
              theirs.gradient_s, them.slope);
    print_row("4 springs from 4 frequencies, one start", ours.identification_s, us.spring,
              theirs.identification_s, them.spring);
    printf("%-48s %9.0f", "  evaluations that this took", ours.calls);
    if (both) {
        printf(" %18.0f", theirs.calls);
    }
    const double full = time_study(study, FULL_SOLVES, &result);
    printf("\n%-48s", "8 springs, frequencies and shapes, whole study");
    print_time(full, 9);
    printf("\n%-48s %9ld\n", "  evaluations that this took", result->run.evaluations);
    mt_result_delete(result);
    mt_study_delete(study);
    return EXIT_SUCCESS;
}
