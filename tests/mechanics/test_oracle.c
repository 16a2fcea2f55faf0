/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The symmetric path against the paper's formulation. With xdd(q) the acceleration of Udwadia
 * and Kalaba at rest at a displaced position q, its Jacobian J, taken by differences, has over
 * all nq states the eigenvalues -lambda of the n modes and as many zeros as there are
 * independent constraints (a constraint that is violated does not act back). Stiff directions
 * bend the soft ones at second order, so differences are of sixth order, h = 3e-4: truncation ~
 * h^6, rounding ~ eps/h = 1e-12, both of the largest lambda, which lies up to 1e7 above the
 * lowest here.
 */
#include "mechanics/linear_priv.h"

#include "modetune/dynamics.h"

#include <stdlib.h>

#include "linalg/dense.h"
#include "mechanics/linear.h"
#include "mechanics/mech.h"
#include "mechanics/motion.h"

static const double STEP = 3e-4; /* model lengths, rad */
static const double TOL = 1e-6;
/* Where rigid-body modes make zero defective, rounding r of J appears in it as sqrt(r). */
static const double ZERO = 1e-5;

static mt_arena mem;

typedef struct motion {
    mt_linear *lin;
    double *m;
    double *q;
    double *a;
    double *b; /* zero */
    bool singular;
} motion;

static bool acceleration(const motion *s, const double *dq, double *xdd, mt_err *err)
{
    const int n = mt_linear_system(s->lin)->nq;
    if (mt_displaced_eval(s->lin, dq, s->m, s->q, s->a, NULL, err) != MT_OK) {
        return false;
    }
    return (s->singular ? mt_udwadia_phohomsiri(n, mt_linear_equations(s->lin), s->m, s->q,
                                                s->a, s->b, xdd, err)
                        : mt_udwadia_kalaba(n, mt_linear_equations(s->lin), s->m, s->q, s->a,
                                            s->b, xdd, err)) == MT_OK;
}

/* Bring dq back to where all constraints hold: least-norm steps, each wrong by |dq|
 * relative. */
static bool restore(const motion *s, double *dq, mt_err *err)
{
    enum { STEPS = 12 };
    const size_t n = (size_t)mt_linear_system(s->lin)->nq;
    const size_t m = (size_t)mt_linear_equations(s->lin);
    const mt_arena_mark mark = mt_arena_get_mark(&mem);
    double *const c = mt_arena_f64(&mem, m, 1);
    double *const pinv = mt_arena_f64(&mem, n, m);
    bool ok = true;
    for (int k = 0; k < STEPS && ok; k++) {
        ok = mt_displaced_eval(s->lin, dq, s->m, s->q, s->a, c, err) == MT_OK &&
             mt_pinv((int)m, (int)n, s->a, 1e-6, pinv, NULL, &mem, err) == MT_OK;
        mt_gemv(false, (int)n, (int)m, -1.0, pinv, (int)n, c, 1.0, dq);
    }
    mt_arena_rewind(&mem, mark);
    return ok;
}

/* Jacobian of the acceleration along the columns of `along` (nq x cols; NULL: all states), nq x
 * cols. Along given columns the displaced positions keep the constraints. */
static bool jacobian(const motion *s, int cols, const double *along, double *j, double *largest,
                     mt_err *err)
{
    static const double AT[] = {-3.0, -2.0, -1.0, 1.0, 2.0, 3.0};
    static const double WEIGHT[] = {-1.0 / 60.0, 9.0 / 60.0,  -45.0 / 60.0,
                                    45.0 / 60.0, -9.0 / 60.0, 1.0 / 60.0};
    const size_t n = (size_t)mt_linear_system(s->lin)->nq;
    const double h = STEP * mt_linear_system(s->lin)->length_m;
    double *const dq = mt_arena_f64(&mem, n, 1);
    double *const xdd = mt_arena_f64(&mem, n, 1);
    bool ok = acceleration(s, NULL, xdd, err);
    *largest = mt_max_abs((ptrdiff_t)n, xdd); /* at equilibrium: none */
    for (size_t c = 0; c < (size_t)cols && ok; c++) {
        for (int k = 0; k < MT_COUNT(AT) && ok; k++) {
            memset(dq, 0, n * sizeof *dq);
            if (along == NULL) {
                dq[c] = AT[k] * h;
            } else {
                mt_axpy((int)n, AT[k] * h, along + c * n, dq);
                ok = restore(s, dq, err);
            }
            ok = ok && acceleration(s, dq, xdd, err);
            mt_axpy((int)n, WEIGHT[k] / h, xdd, j + c * n);
        }
    }
    return ok;
}

static int by_size(const void *a, const void *b)
{
    const double x = fabs(*(const double *)a);
    const double y = fabs(*(const double *)b);
    return (x > y) - (x < y);
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

static void compare(mt_test *t, const mt_modes *modes, int order, double *wr, const double *wi)
{
    const int zeros = order - modes->count + modes->n_rigid;
    const double top = fabs(modes->lambda[modes->count - 1]);
    for (int i = 0; i < order; i++) {
        CHECK(t, fabs(wi[i]) <= ZERO * top);
        wr[i] = -wr[i];
    }
    qsort(wr, (size_t)order, sizeof *wr, by_size);
    for (int i = 0; i < zeros; i++) {
        CHECK(t, fabs(wr[i]) <= ZERO * top);
    }
    qsort(wr + zeros, (size_t)(order - zeros), sizeof *wr, by_value);
    for (int i = 0, k = zeros; i < modes->count; i++) {
        if (modes->kind[i] != MT_MODE_RIGID_BODY && k < order) {
            CHECK_NEAR_ABS(t, wr[k], modes->lambda[i],
                           TOL * fabs(modes->lambda[i]) + 1e-11 * top);
            k++;
        }
    }
}

/* Where constraints are redundant they are so only while they hold: then J acts along the
 * freedoms Z alone, J Z = Z J_r. */
static bool reduced_jacobian(const motion *x, double *j, double *rest, mt_err *err)
{
    const int nq = mt_linear_system(x->lin)->nq;
    const int n = mt_linear_freedoms(x->lin);
    const double *const z = x->lin->e.z;
    double *const jz = mt_arena_f64(&mem, (size_t)nq, (size_t)n);
    double *const zinv = mt_arena_f64(&mem, (size_t)n, (size_t)nq);
    if (!jacobian(x, n, z, jz, rest, err) ||
        mt_pinv(nq, n, z, 1e-12, zinv, NULL, &mem, err) != MT_OK) {
        return false;
    }
    mt_gemm(false, false, n, n, nq, 1.0, zinv, n, jz, nq, 0.0, j, n);
    return true;
}

static void check_system(mt_test *t, mech *s, bool singular)
{
    mt_linear *const lin = s->a->lin;
    const bool redundant = mt_linear_redundant(lin) > 0;
    const size_t n = (size_t)mt_linear_system(lin)->nq;
    const size_t m = (size_t)mt_linear_equations(lin);
    const mt_arena_mark mark = mt_arena_get_mark(&mem);
    const int order = redundant ? mt_linear_freedoms(lin) : mt_linear_system(lin)->nq;
    double *const j = mt_arena_f64(&mem, n, n);
    double *const wr = mt_arena_f64(&mem, n, 1);
    double *const wi = mt_arena_f64(&mem, n, 1);
    double rest = 0.0;
    const motion x = {.lin = lin,
                      .m = mt_arena_f64(&mem, n, n),
                      .q = mt_arena_f64(&mem, n, 1),
                      .a = mt_arena_f64(&mem, m, n),
                      .b = mt_arena_f64(&mem, m, 1),
                      .singular = singular};
    const bool ok = redundant ? reduced_jacobian(&x, j, &rest, &s->err)
                              : jacobian(&x, order, NULL, j, &rest, &s->err);
    if (CHECK(t, ok) &&
        CHECK(t, mt_eig_general(order, j, wr, wi, NULL, &mem, &s->err) == MT_OK)) {
        const mt_modes *const modes = &s->a->modes;
        CHECK(t, rest <= 1e-8 * fabs(modes->lambda[modes->count - 1]) *
                             mt_linear_system(lin)->length_m);
        compare(t, modes, order, wr, wi);
    }
    mt_arena_rewind(&mem, mark);
}

static const struct {
    const char *file;
    const char *configuration; /* NULL: all */
    bool singular;             /* mass matrix */
} SYSTEMS[] = {
    {"pendulum", NULL, false},         {"double_pendulum", "distances", false},
    {"double_pendulum", "rods", true}, {"eight_masses", NULL, false},
    {"nine_discs", NULL, false},       {"ring", NULL, false},
    {"taut_string", NULL, false},      {"driven_rod", NULL, false},
    {"four_bar", NULL, false},         {"space_body", NULL, false},
    {"space_four_bar", NULL, false},   {"space_stick", NULL, false},
    {"space_frame", NULL, false},      {"couplings", NULL, false},
    {"space_couplings", NULL, false},  {"loads", NULL, false},
    {"space_loads", NULL, false},      {"rods", "distances", false},
};

static void oracle__udwadia_kalaba_agrees_on_every_model(mt_test *t)
{
    mt_err err = {.text = ""};
    REQUIRE(t, mt_arena_init(&mem, 0, &err) == MT_OK);
    for (int i = 0; i < MT_COUNT(SYSTEMS); i++) {
        mt_model *const model = mech_load(t, SYSTEMS[i].file);
        /* valgrind: one of each is enough */
        const bool few = getenv("MT_TEST_LAUNCHED") != NULL;
        const int all = model == NULL ? 0 : model->n_configurations;
        const int n = few && SYSTEMS[i].configuration == NULL && all > 0 ? 1 : all;
        for (int c = 0; c < n; c++) {
            mech s;
            const char *const name = model->configurations[c].name.s;
            if (SYSTEMS[i].configuration != NULL &&
                strcmp(SYSTEMS[i].configuration, name) != 0) {
                continue;
            }
            mt_test_row(t, "%s, %s", SYSTEMS[i].file, name);
            if (mech_must(t, mech_load(t, SYSTEMS[i].file), name, "", &s) &&
                s.a->modes.count > 0) {
                check_system(t, &s, SYSTEMS[i].singular);
            }
            mech_free(&s);
        }
        mt_model_delete(model);
    }
    mt_arena_free(&mem);
}

/* x + y = 0 twice, unit masses, a force along x: half of it along (1, -1). */
static void oracle__redundant_constraints_are_no_trouble(mt_test *t)
{
    static const double mass[4] = {1.0, 0.0, 0.0, 1.0};
    static const double q[2] = {3.0, 0.0};
    static const double a[4] = {1.0, 1.0, 1.0, 1.0};
    static const double b[2] = {0.5, 0.5};
    mt_err err = {.text = ""};
    double xdd[2];
    REQUIRE(t, mt_udwadia_kalaba(2, 2, mass, q, a, b, xdd, &err) == MT_OK);
    CHECK_NEAR(t, xdd[0], 1.75, 1e-14);
    CHECK_NEAR(t, xdd[1], -1.25, 1e-14);
    REQUIRE(t, mt_udwadia_phohomsiri(2, 2, mass, q, a, b, xdd, &err) == MT_OK);
    CHECK_NEAR(t, xdd[0], 1.75, 1e-14);
    CHECK_NEAR(t, xdd[1], -1.25, 1e-14);
    REQUIRE(t, mt_udwadia_kalaba(2, 0, mass, q, NULL, NULL, xdd, &err) == MT_OK);
    CHECK_NEAR(t, xdd[0], 3.0, 1e-14);
}

/* x1 = x2 + const, only x1 has mass: Udwadia and Phohomsiri's case. Without the constraint x2
 * is not determined. */
static void oracle__singular_mass_needs_the_constraint(mt_test *t)
{
    static const double mass[4] = {2.0, 0.0, 0.0, 0.0};
    static const double q[2] = {3.0, 1.0};
    static const double a[2] = {1.0, -1.0};
    static const double b[1] = {0.0};
    mt_err err = {.text = ""};
    double xdd[2];
    REQUIRE(t, mt_udwadia_phohomsiri(2, 1, mass, q, a, b, xdd, &err) == MT_OK);
    CHECK_NEAR(t, xdd[0], 2.0, 1e-14);
    CHECK_NEAR(t, xdd[1], 2.0, 1e-14);
    CHECK(t, mt_udwadia_kalaba(2, 1, mass, q, a, b, xdd, &err) == MT_E_NOT_SPD);
    CHECK(t, mt_udwadia_phohomsiri(2, 0, mass, q, NULL, NULL, xdd, &err) == MT_E_SINGULAR);
    CHECK(t, mt_udwadia_kalaba(0, 1, mass, q, a, b, xdd, &err) == MT_E_USAGE);
    CHECK(t, mt_udwadia_phohomsiri(2, -1, mass, q, a, b, xdd, &err) == MT_E_USAGE);
}

static void oracle__numbers_that_are_not_finite_are_refused(mt_test *t)
{
    const double mass[1] = {nan("")};
    const double good[1] = {1.0};
    const double q[1] = {nan("")};
    mt_err err = {.text = ""};
    double xdd[1];
    CHECK(t, mt_udwadia_kalaba(1, 0, mass, good, NULL, NULL, xdd, &err) == MT_E_DOMAIN);
    CHECK(t, mt_udwadia_kalaba(1, 0, good, q, NULL, NULL, xdd, &err) == MT_E_DOMAIN);
    CHECK(t, mt_udwadia_phohomsiri(1, 0, mass, good, NULL, NULL, xdd, &err) == MT_E_DOMAIN);
    CHECK(t, mt_udwadia_phohomsiri(1, 0, good, q, NULL, NULL, xdd, &err) == MT_E_DOMAIN);
}

MT_TEST_MAIN(MT_TEST(oracle__udwadia_kalaba_agrees_on_every_model),
             MT_TEST(oracle__redundant_constraints_are_no_trouble),
             MT_TEST(oracle__singular_mass_needs_the_constraint),
             MT_TEST(oracle__numbers_that_are_not_finite_are_refused))
