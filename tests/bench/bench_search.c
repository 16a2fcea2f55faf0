/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How near a search comes to the best known answer, against evaluations and CPU time: ours
 * beside NLopt's methods as they are and beside the paper's way, all on the same compiled
 * study, from the same starts, through one callback that counts and judges.
 *     bench_search [--quick] [STUDY...]
 * CSV, a line for each run and distance: study,method,start,distance,evaluations,cpu_s; cpu_s
 * is nan where the run did not come so near.
 * The distance of a design from the best known answer f* is
 *     max(greatest violation of a row, |f - f*| / max(|f*|, 0.001)),  0 for f below f*;
 * with residuals r: sqrt((|r|^2 - |r*|^2) / n_res). Rows are relative (ln of a ratio): 1e-4 is
 * a hundredth of a per cent. In a study with bands all searches are told the gap that the best
 * answer lies in, which is most of the work. A run has reached a distance at its first design
 * that is so near.
 */
#include <nlopt.h>

#include <gsl/gsl_multifit_nlinear.h>
#include <gsl/gsl_qrng.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/options.h"
#include "problem/evaluate.h"
#include "problem/problem.h"
#include "problem/workspace.h"
#include "result/result.h"
#include "search/mode_placements.h"
#include "study/read.h"
#include "timing.h"

enum { LEVELS = 11, STARTS = 9, QUICK_STARTS = 2, MOST = 64 };

typedef struct reached {
    long evaluations;
    double cpu_s; /* NaN: not reached */
} reached;

typedef struct race {
    mt_nlp nlp;
    double best_f;
    long evaluations;
    double began_s;
    double most_s;
    double nearest;
    reached level[LEVELS]; /* distance 10^-k */
    mt_nlp_values at;      /* of the last point t */
    mt_nlp_values near;    /* for differences */
    double *t;
    double *moved;
    nlopt_opt opt;
    bool differences; /* gradients by differences */
    bool has_values;
    bool has_slopes;
} race;

typedef struct method {
    const char *name;
    mt_status (*run)(race *r, const struct method *m, const double *start, mt_err *err);
    nlopt_algorithm algorithm;
    bool differences;
    bool local;  /* of an augmented Lagrangian where there are constraints */
    bool global; /* one run, or few */
} method;

static double worst_row(const mt_nlp *nlp, const mt_nlp_values *v)
{
    double worst = 0.0;
    for (int i = 0; i < nlp->n_eq; i++) {
        worst = fmax(worst, fabs(v->eq[i]));
    }
    for (int i = 0; i < nlp->n_in; i++) {
        worst = fmax(worst, -v->in[i]);
    }
    return worst;
}

static double objective(const mt_nlp *nlp, const mt_nlp_values *v)
{
    double sum = 0.0;
    for (int i = 0; i < nlp->n_res; i++) {
        sum += v->r[i] * v->r[i];
    }
    return nlp->n_res > 0 ? 0.5 * sum : v->f;
}

static double distance(const race *r, const mt_nlp_values *v)
{
    const double more = fmax(objective(&r->nlp, v) - r->best_f, 0.0);
    const double gap = r->nlp.n_res > 0 ? sqrt(2.0 * more / (double)r->nlp.n_res)
                                        : more / fmax(fabs(r->best_f), 1e-3);
    return fmax(worst_row(&r->nlp, v), gap);
}

static bool spent(const race *r)
{
    return timing_now_s() - r->began_s > r->most_s;
}

/* One evaluation: counted, and judged. */
static mt_status look(race *r, const double *t, bool slopes, mt_nlp_values *v, mt_err *err)
{
    r->evaluations++;
    MT_TRY(r->nlp.eval(r->nlp.context, t, slopes, v, err));
    const double d = distance(r, v);
    r->nearest = d < r->nearest ? d : r->nearest;
    for (int k = 0; k < LEVELS; k++) {
        if (d <= pow(10.0, -k) && isnan(r->level[k].cpu_s)) {
            r->level[k] = (reached){r->evaluations, timing_now_s() - r->began_s};
        }
    }
    return MT_OK;
}

/* What our own search sees. */
static mt_status look_through(void *context, const double *t, bool slopes, mt_nlp_values *out,
                              mt_err *err)
{
    race *const r = context;
    if (spent(r)) {
        return mt_fail(err, MT_E_INTERRUPTED, "time is up");
    }
    return look(r, t, slopes, out, err);
}

static void difference(double *slope, const double *there, const double *here, int rows, int j,
                       double step)
{
    for (int i = 0; i < rows; i++) {
        slope[(ptrdiff_t)j * rows + i] = (there[i] - here[i]) / step;
    }
}

static mt_status by_differences(race *r, mt_err *err)
{
    const mt_nlp *const p = &r->nlp;
    for (int j = 0; j < p->n; j++) {
        const double step = r->t[j] + 1e-7 <= p->upper[j] ? 1e-7 : -1e-7;
        memcpy(r->moved, r->t, (size_t)p->n * sizeof *r->t);
        r->moved[j] += step;
        MT_TRY(look(r, r->moved, false, &r->near, err));
        difference(r->at.dr, r->near.r, r->at.r, p->n_res, j, step);
        difference(r->at.deq, r->near.eq, r->at.eq, p->n_eq, j, step);
        difference(r->at.din, r->near.in, r->at.in, p->n_in, j, step);
        r->at.df[j] = (r->near.f - r->at.f) / step;
    }
    return MT_OK;
}

/* r->at is at t afterwards: a method that asks for objective and constraints one by one pays
 * once. */
static void come(race *r, const double *t, bool slopes)
{
    const mt_nlp *const p = &r->nlp;
    mt_err err = {.text = ""};
    if (!r->has_values || memcmp(t, r->t, (size_t)p->n * sizeof *t) != 0) {
        r->has_values = r->has_slopes = false;
    }
    if (r->has_values && (r->has_slopes || !slopes)) {
        return;
    }
    for (int j = 0; j < p->n; j++) {
        r->t[j] = fmin(fmax(t[j], p->lower[j]), p->upper[j]);
    }
    mt_status rc = MT_OK;
    if (!r->has_values || !r->differences) {
        rc = look(r, r->t, slopes && !r->differences, &r->at, &err);
    }
    if (rc == MT_OK && slopes && r->differences) {
        rc = by_differences(r, &err);
    }
    r->has_values = rc == MT_OK;
    r->has_slopes = r->has_values && slopes;
    if ((rc != MT_OK || spent(r)) && r->opt != NULL) {
        (void)nlopt_force_stop(r->opt);
    }
}

static double nlopt_objective(unsigned n, const double *t, double *slope, void *context)
{
    race *const r = context;
    come(r, t, slope != NULL);
    for (unsigned j = 0; slope != NULL && j < n; j++) {
        slope[j] = r->nlp.n_res > 0 ? 0.0 : r->at.df[j];
        for (int i = 0; i < r->nlp.n_res; i++) {
            slope[j] += r->at.dr[(ptrdiff_t)j * r->nlp.n_res + i] * r->at.r[i];
        }
    }
    return objective(&r->nlp, &r->at);
}

static void rows(unsigned m, double *out, double *slope, unsigned n, const double *v,
                 const double *dv, double sign, double shift)
{
    for (unsigned i = 0; i < m; i++) {
        out[i] = sign * v[i] + shift;
        for (unsigned j = 0; slope != NULL && j < n; j++) {
            slope[(size_t)i * n + j] = sign * dv[(size_t)j * m + i];
        }
    }
}

static void nlopt_equal(unsigned m, double *out, unsigned n, const double *t, double *slope,
                        void *context)
{
    race *const r = context;
    come(r, t, slope != NULL);
    rows(m, out, slope, n, r->at.eq, r->at.deq, 1.0, 0.0);
}

static void nlopt_inside(unsigned m, double *out, unsigned n, const double *t, double *slope,
                         void *context)
{
    race *const r = context;
    come(r, t, slope != NULL);
    rows(m, out, slope, n, r->at.in, r->at.din, -1.0, 0.0);
}

/* |eq| <= a tenth of its tolerance */
static void nlopt_above(unsigned m, double *out, unsigned n, const double *t, double *slope,
                        void *context)
{
    race *const r = context;
    come(r, t, slope != NULL);
    rows(m, out, slope, n, r->at.eq, r->at.deq, 1.0, -0.1 * r->nlp.eq_tol[0]);
}

static void nlopt_below(unsigned m, double *out, unsigned n, const double *t, double *slope,
                        void *context)
{
    race *const r = context;
    come(r, t, slope != NULL);
    rows(m, out, slope, n, r->at.eq, r->at.deq, -1.0, -0.1 * r->nlp.eq_tol[0]);
}

static nlopt_opt nlopt_method(const race *r, const method *m)
{
    const unsigned n = (unsigned)r->nlp.n;
    if (!m->local || r->nlp.n_eq + r->nlp.n_in == 0) {
        return nlopt_create(m->algorithm, n);
    }
    nlopt_opt whole = nlopt_create(NLOPT_AUGLAG, n);
    nlopt_opt inner = nlopt_create(m->algorithm, n);
    (void)nlopt_set_xtol_rel(inner, 1e-9);
    (void)nlopt_set_maxeval(inner, 2000);
    (void)nlopt_set_local_optimizer(whole, inner);
    nlopt_destroy(inner);
    return whole;
}

static mt_status run_nlopt(race *r, const method *m, const double *start, mt_err *err)
{
    const mt_nlp *const p = &r->nlp;
    const unsigned n_eq = (unsigned)p->n_eq;
    double f = 0.0;
    double t[MOST];
    (void)err;
    memcpy(t, start, (size_t)p->n * sizeof *t);
    r->opt = nlopt_method(r, m);
    (void)nlopt_set_lower_bounds(r->opt, p->lower);
    (void)nlopt_set_upper_bounds(r->opt, p->upper);
    (void)nlopt_set_min_objective(r->opt, nlopt_objective, r);
    (void)nlopt_set_xtol_rel(r->opt, 1e-14);
    (void)nlopt_set_maxtime(r->opt, r->most_s);
    nlopt_srand(1);
    if (n_eq > 0 && m->algorithm == NLOPT_LD_MMA) {
        (void)nlopt_add_inequality_mconstraint(r->opt, n_eq, nlopt_above, r, NULL);
        (void)nlopt_add_inequality_mconstraint(r->opt, n_eq, nlopt_below, r, NULL);
    } else if (n_eq > 0) {
        (void)nlopt_add_equality_mconstraint(r->opt, n_eq, nlopt_equal, r, NULL);
    }
    if (p->n_in > 0) {
        (void)nlopt_add_inequality_mconstraint(r->opt, (unsigned)p->n_in, nlopt_inside, r,
                                               NULL);
    }
    (void)nlopt_optimize(r->opt, t, &f);
    nlopt_destroy(r->opt);
    r->opt = NULL;
    return MT_OK;
}

static int gsl_equations(const gsl_vector *t, void *context, gsl_vector *out)
{
    race *const r = context;
    const size_t n_res = (size_t)r->nlp.n_res;
    come(r, t->data, false);
    for (size_t i = 0; i < out->size && r->has_values; i++) {
        gsl_vector_set(out, i, i < n_res ? r->at.r[i] : r->at.eq[i - n_res]);
    }
    return r->has_values && !spent(r) ? GSL_SUCCESS : GSL_FAILURE;
}

/* Levenberg and Marquardt on the equations alone, slopes by central differences, no bounds:
 * what fsolve does in the paper. As many equations as variables, or more. */
static mt_status run_paper(race *r, const method *m, const double *start, mt_err *err)
{
    const mt_nlp *const p = &r->nlp;
    const size_t rows_of = (size_t)p->n_res + (size_t)p->n_eq;
    gsl_multifit_nlinear_parameters options = gsl_multifit_nlinear_default_parameters();
    (void)m;
    (void)err;
    options.fdtype = GSL_MULTIFIT_NLINEAR_CTRDIFF;
    options.h_df = 1e-5;
    gsl_multifit_nlinear_fdf fdf = {
        .f = gsl_equations, .n = rows_of, .p = (size_t)p->n, .params = r};
    gsl_multifit_nlinear_workspace *const w =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &options, rows_of, (size_t)p->n);
    const gsl_vector_const_view from = gsl_vector_const_view_array(start, (size_t)p->n);
    int why = 0;
    if (gsl_multifit_nlinear_init(&from.vector, &fdf, w) == GSL_SUCCESS) {
        (void)gsl_multifit_nlinear_driver(200, 1e-14, 1e-14, 0.0, NULL, NULL, &why, w);
    }
    gsl_multifit_nlinear_free(w);
    return MT_OK;
}

static mt_status run_ours(race *r, const method *m, const double *start, mt_err *err)
{
    mt_nlp nlp = r->nlp;
    mt_nlp_options opt = mt_nlp_options_default();
    mt_nlp_result out = {0};
    mt_arena mem;
    MT_TRY(mt_arena_init(&mem, 0, err));
    nlp.eval = look_through;
    nlp.context = r;
    if (!m->global) {
        nlp.origin = start;
        nlp.hint = NULL;
        opt.starts = 1;
    }
    const mt_status rc = mt_nlp_solve(&nlp, &opt, &mem, &out, err);
    mt_arena_free(&mem);
    return rc;
}

static const method METHODS[] = {
    {"modetune, all its starts", run_ours, NLOPT_NUM_ALGORITHMS, false, false, true},
    {"modetune, one start", run_ours, NLOPT_NUM_ALGORITHMS, false, false, false},
    {"SLSQP", run_nlopt, NLOPT_LD_SLSQP, false, false, false},
    {"SLSQP, differences", run_nlopt, NLOPT_LD_SLSQP, true, false, false},
    {"MMA", run_nlopt, NLOPT_LD_MMA, false, false, false},
    {"BOBYQA", run_nlopt, NLOPT_LN_BOBYQA, false, true, false},
    {"ISRES", run_nlopt, NLOPT_GN_ISRES, false, false, true},
    {"DIRECT", run_nlopt, NLOPT_GN_DIRECT_L, false, true, true},
    {"the paper's way", run_paper, NLOPT_NUM_ALGORITHMS, false, false, false},
};
enum { N_METHODS = sizeof METHODS / sizeof METHODS[0] };

typedef struct bench {
    bool quick;
    const char *study;
    race race; /* as each run finds it */
    mt_arena mem;
    mt_workspace *ws;
    mt_subproblem in_gap;
    double *starts; /* n x STARTS */
} bench;

static void print_runs(const bench *b, const method *m, const race *runs, int n)
{
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < LEVELS; k++) {
            const reached *const at = &runs[i].level[k];
            printf("%s,\"%s\",%d,1e-%02d,%ld,%.4g\n", b->study, m->name, i + 1, k,
                   at->evaluations, at->cpu_s);
        }
    }
    (void)fflush(stdout);
}

static void compete(bench *b, const method *m)
{
    const mt_nlp *const p = &b->race.nlp;
    const int starts = b->quick ? QUICK_STARTS : STARTS;
    const int n = m->global ? 1 : starts;
    race runs[STARTS];
    mt_err err = {.text = ""};
    if (m->run == run_paper && p->n_res + p->n_eq < p->n) { /* which fsolve asks for */
        return;
    }
    for (int i = 0; i < n; i++) {
        race *const r = &runs[i];
        *r = b->race;
        r->differences = m->differences;
        r->nearest = HUGE_VAL;
        for (int k = 0; k < LEVELS; k++) {
            r->level[k] = (reached){0, nan("")};
        }
        r->began_s = timing_now_s();
        const mt_status rc = m->run(r, m, b->starts + (ptrdiff_t)i * p->n, &err);
        if (rc != MT_E_INTERRUPTED) {
            stop(m->name, rc, &err);
        }
    }
    print_runs(b, m, runs, n);
}

/* The best answer: what a whole run recommends, and what its objective is there. */
static void best_answer(bench *b, const mt_study *study)
{
    mt_result *result = NULL;
    mt_err err = {.text = ""};
    double *const t = mt_arena_f64(&b->mem, (size_t)b->ws->p->n, 1);
    int *const below = mt_arena_int(&b->mem, (size_t)b->ws->p->n_bands + 1);
    double violation = 0.0;
    stop(b->study, mt_study_solve(study, NULL, &result, &err), &err);
    stop(b->study, mt_arena_check(&b->mem, &err), &err);
    for (int j = 0; j < b->ws->p->n; j++) {
        t[j] = mt_problem_t(b->ws->p, j, result->recommendations[0].parameters[j].recommended);
    }
    mt_result_delete(result);
    if (b->ws->p->n_bands > 0) {
        stop(b->study, mt_mode_placement_assignment(b->ws, t, below, &violation, &err), &err);
        stop(b->study,
             mt_subproblem_in_placement(b->ws->c, below, 0, NULL, b->ws, &b->mem, &b->in_gap,
                                        &err),
             &err);
        mt_workspace_back(b->ws, &b->in_gap);
    }
    b->race.nlp = mt_workspace_nlp(b->ws);
    stop(b->study, mt_subproblem_values_init(b->ws->c, &b->mem, &b->race.at, &err), &err);
    stop(b->study, mt_subproblem_values_init(b->ws->c, &b->mem, &b->race.near, &err), &err);
    stop(b->study, mt_workspace_eval(b->ws, t, false, &b->race.at, &err), &err);
    b->race.best_f = objective(&b->race.nlp, &b->race.at);
}

/* The original design, then a Halton sequence within the bounds. */
static void choose_starts(bench *b)
{
    const mt_nlp *const p = &b->race.nlp;
    gsl_qrng *const q = gsl_qrng_alloc(gsl_qrng_halton, (unsigned)p->n);
    mt_err err = {.text = ""};
    double unit[MOST];
    b->starts = mt_arena_f64(&b->mem, (size_t)p->n, STARTS);
    b->race.t = mt_arena_f64(&b->mem, (size_t)p->n, 1);
    b->race.moved = mt_arena_f64(&b->mem, (size_t)p->n, 1);
    stop(b->study, mt_arena_check(&b->mem, &err), &err);
    for (int i = 0; i < STARTS; i++) {
        double *const t = b->starts + (ptrdiff_t)i * p->n;
        (void)gsl_qrng_get(q, unit);
        for (int j = 0; j < p->n; j++) {
            const double within = p->lower[j] + (unit[j] * (p->upper[j] - p->lower[j]));
            t[j] = i > 0 ? within : fmin(fmax(p->origin[j], p->lower[j]), p->upper[j]);
        }
    }
    gsl_qrng_free(q);
}

static void bench_study(bench *b)
{
    const char *const tree = getenv("SOURCE_DIR");
    char path[4096];
    mt_study *study = NULL;
    mt_problem *p = NULL;
    mt_err err = {.text = ""};
    const mt_io_options opt = {.root = tree == NULL ? "." : tree};
    (void)snprintf(path, sizeof path, "%s/studies/%s.json", opt.root, b->study);
    stop(path, mt_study_load(path, &opt, &study, NULL, &err), &err);
    stop(path, mt_problem_new(study, NULL, &p, &err), &err);
    stop(path, mt_workspace_new(p, &b->ws, &err), &err);
    stop(path, mt_arena_init(&b->mem, 0, &err), &err);
    b->race = (race){.most_s = b->quick ? 0.1 : 1.0};
    best_answer(b, study);
    choose_starts(b);
    for (size_t i = 0; i < N_METHODS; i++) {
        compete(b, &METHODS[i]);
    }
    mt_workspace_delete(b->ws);
    mt_problem_delete(p);
    mt_study_delete(study);
    mt_arena_free(&b->mem);
}

int main(int argc, char **argv)
{
    static const char *const STUDIES[] = {"beam_identification", "inceptor_identification",
                                          "inceptor_tuning_1",   "inceptor_tuning_2",
                                          "inceptor_rotor",      "six_masses_bands",
                                          "truss_10bar_E69_8",   "truss_72bar"};
    bench b = {.quick = argc > 1 && strcmp(argv[1], "--quick") == 0};
    const int first = b.quick ? 2 : 1;
    gsl_set_error_handler_off();
    printf("study,method,start,distance,evaluations,cpu_s\n");
    for (int i = first; i < argc; i++) {
        b.study = argv[i];
        bench_study(&b);
    }
    for (size_t i = 0; first >= argc && i < sizeof STUDIES / sizeof STUDIES[0]; i++) {
        b.study = STUDIES[i];
        bench_study(&b);
    }
    return EXIT_SUCCESS;
}
