/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How much work there is between two questions whether to stop: not more, of dense linear
 * algebra, than one analysis needs, whatever the phase, and however many configurations,
 * positions, starts or boxes there are. The linker leads every call of a kernel through here
 * (tests/CMakeLists.txt), where its multiplications are counted.
 */
#include "linalg/dense.h"
#include "study_kinds.h"

/*
 * In n^3, n the states of the largest configuration: a few decompositions (about 10 n^3 each)
 * are one unit of work; two units are more. What is counted for matrices of one or two rows is
 * their overhead, so that it says nothing of them.
 */
static const double MOST = 40.0;
enum { LEAST_ORDER = 6, EIG = 9, SVD = 20, QR = 2, SOLVE = 1 };

static double work;  /* since the last question */
static double worst; /* between two of one solve */
static int order;    /* of the largest matrix of this solve */

static void spend(double weight, int m, int n, int k)
{
    work += weight * (double)m * (double)n * (double)k;
    order = m > order ? m : order;
}

/* names are the linker's, parameters the kernels' */
/* NOLINTBEGIN(bugprone-reserved-identifier,cert-*,readability-function-size) */
#define WRAP(type, name, parameters, arguments, weight, m, n, k) \
    type __real_##name parameters;                               \
    type __wrap_##name parameters;                               \
    type __wrap_##name parameters                                \
    {                                                            \
        spend((weight), (m), (n), (k));                          \
        return __real_##name arguments;                          \
    }
WRAP(mt_status, mt_cholesky, (int n, double *a, int *bad, mt_err *err), (n, a, bad, err), SOLVE,
     n, n, n)
WRAP(mt_status, mt_eig_sym,
     (int n, double *a, double *w, bool vectors, mt_arena *scratch, mt_err *err),
     (n, a, w, vectors, scratch, err), EIG, n, n, n)
/* Cholesky and Jacobi's method, which the linker does not see within one file. */
WRAP(mt_status, mt_eig_graded, (int n, double *a, double *w, mt_arena *scratch, mt_err *err),
     (n, a, w, scratch, err), SOLVE + SVD, n, n, n)
WRAP(mt_status, mt_inertia,
     (int n, const double *a, const double *b, double shift, int count[3], double *gap,
      mt_arena *scratch, mt_err *err),
     (n, a, b, shift, count, gap, scratch, err), SOLVE, n, n, n)
WRAP(mt_status, mt_svd,
     (int m, int n, double *a, double *s, double *u, double *vt, mt_arena *scratch,
      mt_err *err),
     (m, n, a, s, u, vt, scratch, err), SVD, m, n, n)
WRAP(mt_status, mt_svd_jacobi,
     (int m, int n, double *a, double *s, double *v, mt_arena *scratch, mt_err *err),
     (m, n, a, s, v, scratch, err), SVD, m, n, n)

void __real_mt_gemm(bool ta, bool tb, int m, int n, int k, double alpha, const double *a,
                    int lda, const double *b, int ldb, double beta, double *c, int ldc);
void __wrap_mt_gemm(bool ta, bool tb, int m, int n, int k, double alpha, const double *a,
                    int lda, const double *b, int ldb, double beta, double *c, int ldc);
void __wrap_mt_gemm(bool ta, bool tb, int m, int n, int k, double alpha, const double *a,
                    int lda, const double *b, int ldb, double beta, double *c, int ldc)
{
    spend(1, m, n, k);
    __real_mt_gemm(ta, tb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc);
}

/* NOLINTEND(bugprone-reserved-identifier,cert-*,readability-function-size) */

static int ask(void *context)
{
    const double n = order > LEAST_ORDER ? (double)order : (double)LEAST_ORDER;
    (void)context;
    worst = fmax(worst, work / (n * n * n));
    work = 0.0;
    return MT_STOP_REQUEST_NONE;
}

static void judge(mt_test *t, const char *name, const mt_study *study)
{
    mt_solve_options opt = {.size = sizeof opt};
    mt_result *result = NULL;
    opt.stop = ask;
    work = worst = 0.0;
    order = 0;
    mt_test_row(t, "%s", name);
    CHECK_INT(t, mt_study_solve(study, &opt, &result, NULL), MT_OK);
    (void)ask(NULL); /* the end */
    if (getenv("MT_TEST_PRINT") != NULL) {
        (void)printf("%5.1f n^3 (n <= %d) %s\n", worst, order, name);
    }
    CHECK(t, worst > 0.0);
    CHECK(t, worst <= MOST);
    mt_result_delete(result);
}

static void questions__come_after_one_unit_of_work(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(study_kinds); i++) {
        study_case c;
        mt_test_row(t, "%s", study_kinds[i].name);
        if (study_load(t, study_kinds[i].model, study_kinds[i].members, &c)) {
            judge(t, study_kinds[i].name, c.study);
        }
        study_free(&c);
    }
}

static void questions__come_after_one_unit_of_work_in_studies_of_the_tree(mt_test *t)
{
    static const char *const names[] = {
        "beam_table_3",      "engine_orders",       "inceptor_catalogue", "inceptor_stick",
        "inceptor_tuning_1", "inceptor_prediction", "six_masses_bands"};
    for (int i = 0; i < MT_COUNT(names); i++) {
        char path[STUDY_PATH];
        mt_study *study = NULL;
        (void)snprintf(path, sizeof path, "%s/studies/%s.json", MT_TEST_SOURCE_DIR, names[i]);
        if (CHECK_INT(t, mt_study_read(path, NULL, &study, NULL), MT_OK)) {
            judge(t, names[i], study);
        }
        mt_study_delete(study);
    }
}

MT_TEST_MAIN(MT_TEST(questions__come_after_one_unit_of_work),
             MT_TEST(questions__come_after_one_unit_of_work_in_studies_of_the_tree))
