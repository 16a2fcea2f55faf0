/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Directions that the goals do not settle, in closed form: which there are, in which basis they
 * are told, and whose they are. Random problems are in test_nlp_undetermined.c.
 */
#include "nlp_problem.h"

/* eq = (t0 - t1) at a corner: t0 + t1 is not settled, wherever solution and origin are. */
static void difference(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    change(c, t, out);
    out->eq[0] = t[0] - t[1] - c->target[0];
    out->deq[0] = 1;
    out->deq[1] = -1;
}

static void nlp_directions__a_combination_through_a_corner_is_still_found(mt_test *t)
{
    nlp_case c = {0};
    /* origin (0, 0): no room along (1, 1) in one direction */
    case_begin(&c, 2, difference, 0, 1);
    c.nlp.n_eq = 1;
    REQUIRE(t, case_solve(&c, NULL) == MT_OK);
    REQUIRE(t, c.result.n_solutions == 1 && c.result.n_unidentifiable == 1);
    CHECK_NEAR(t, fabs(c.result.unidentifiable[0]), sqrt(0.5), 1e-12);
    CHECK_NEAR(t, c.result.unidentifiable[0], c.result.unidentifiable[1], 1e-12);
    CHECK_NEAR_ABS(t, c.result.solutions[0].t[0], 0, 1e-12);
    mt_arena_free(&c.mem);
}

/* At (1, 0), the only point with t0 - t1 = 1, nothing can move along (1, 1); rounding of a
 * bound is no room. */
static void nlp_directions__no_room_at_the_solution_is_no_direction(mt_test *t)
{
    static const double SHORT[] = {0, 1e-15, 1e-12, 1e-4};
    for (int k = 0; k < MT_COUNT(SHORT); k++) {
        nlp_case c = {0};
        case_begin(&c, 2, difference, 0, 1);
        c.nlp.n_eq = 1;
        c.eq_tol[0] = 1e-9;
        c.target[0] = 1 - SHORT[k];
        mt_test_row(t, "%g short of the corner", SHORT[k]);
        REQUIRE(t, case_solve(&c, NULL) == MT_OK);
        REQUIRE(t, c.result.n_solutions == 1);
        CHECK_INT(t, c.result.n_unidentifiable, SHORT[k] > 1e-6);
        mt_arena_free(&c.mem);
    }
}

/* t0 is asked to be what a bound or the origin is to a few units of rounding. */
static void value_asked(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    change(c, t, out);
    out->eq[0] = t[0] - c->target[0];
    out->deq[0] = 1;
    out->deq[1] = 0;
}

static void nlp_directions__what_is_on_a_bound_to_rounding_is_put_on_it(mt_test *t)
{
    static const double AT[] = {0.1, 0.9, 0.3}; /* lower, upper, origin */
    for (int k = 0; k < MT_COUNT(AT); k++) {
        for (int off = -4; off <= 4; off++) {
            nlp_case c = {0};
            case_begin(&c, 2, value_asked, AT[0], AT[1]);
            c.origin[0] = AT[2];
            c.origin[1] = AT[2];
            c.nlp.n_eq = 1;
            c.target[0] = AT[k] + off * 0x1p-53;
            mt_test_row(t, "%g and %d", AT[k], off);
            REQUIRE(t, case_solve(&c, NULL) == MT_OK);
            REQUIRE(t, c.result.n_solutions == 1);
            CHECK(t, c.result.solutions[0].t[0] == AT[k]);
            mt_arena_free(&c.mem);
        }
    }
}

/* r_i = w_i (t0 + t1 + t2 - 0.5), its slopes as several processors have them. w: target[3 ...].
 */
static void plane(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    const int n_res = c->nlp.n_res;
    out->f = 0.0;
    for (int i = 0; i < n_res; i++) {
        const double w = c->target[3 + i];
        out->r[i] = -0.5 * w;
        for (int j = 0; j < 3; j++) {
            const double slope = w * (1.0 + c->target[j]);
            out->dr[i + (j * n_res)] = slope;
            out->r[i] += slope * t[j];
        }
        out->f += 0.5 * out->r[i] * out->r[i];
    }
}

/* Two directions are open, and any two that span the plane would do: the projections of the
 * first two variables, (2, -1, -1) and (0, 1, -1), whatever rounding the slopes have, and
 * however often the same is said, which leaves singular values of rounding. */
static void nlp_directions__a_plane_has_one_basis(mt_test *t)
{
    static const double rounding[][3] = {
        {0.0, 0.0, 0.0}, {1e-16, -2e-16, 0.0}, {-3e-16, 2e-16, 4e-16}, {5e-16, 0.0, -5e-16}};
    const double wanted[] = {2.0 / sqrt(6.0), -1.0 / sqrt(6.0), -1.0 / sqrt(6.0), 0.0,
                             1.0 / sqrt(2.0), -1.0 / sqrt(2.0)};
    for (int i = 0; i < 4 * MT_COUNT(rounding); i++) {
        static const double WEIGHT[] = {1.0, 0.7, 1.0 / 3.0, 1.9};
        nlp_case c = {0};
        mt_nlp_options opt = mt_nlp_options_default();
        case_begin(&c, 3, plane, -2.0, 2.0);
        c.nlp.n_res = 1 + (i / MT_COUNT(rounding));
        memcpy(c.target, rounding[i % MT_COUNT(rounding)], sizeof rounding[0]);
        memcpy(c.target + 3, WEIGHT, sizeof WEIGHT);
        mt_test_row(t, "rounding %d, said %d times", i % MT_COUNT(rounding), c.nlp.n_res);
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        REQUIRE(t, c.result.n_unidentifiable == 2);
        for (int k = 0; k < MT_COUNT(wanted); k++) {
            mt_test_row(t, "rounding %d, said %d times, entry %d", i % MT_COUNT(rounding),
                        c.nlp.n_res, k);
            CHECK(t, fabs(c.result.unidentifiable[k] - wanted[k]) <= 1e-12);
        }
        mt_arena_free(&c.mem);
    }
}

/* f = target[0] + t0 + target[1] t1, least at the lower bound of t0. */
static void slope_only(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    out->f = c->target[0] + t[0] + (c->target[1] * t[1]);
    out->df[0] = 1.0;
    out->df[1] = c->target[1];
}

/* What an objective sees is told by its size, |f| and what it changes by across the bounds: 0
 * at the solution is no objective that sees nothing. Crossing t1 changes f by its slope, which
 * counts from 1e-6 of 1 + slope + |f(solution)| on. */
static void nlp_directions__an_objective_of_0_sees_what_it_changes_with(mt_test *t)
{
    static const struct {
        double f;     /* at the solution */
        double slope; /* by t1 */
        int n;        /* directions: t1 */
    } rows[] = {{0.0, 0.0, 1},   {0.0, 1e-9, 1},    {0.0, 5e-7, 1},   {0.0, 2e-6, 0},
                {0.0, 0.1, 0},   {-3.0, 2e-6, 1},   {-3.0, 5e-6, 0},  {1e-9, 5e-7, 1},
                {1e-9, 2e-6, 0}, {1000.0, 5e-4, 1}, {1000.0, 2e-3, 0}};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        nlp_case c = {0};
        mt_nlp_options opt = mt_nlp_options_default();
        opt.least_change = false;
        case_begin(&c, 2, slope_only, 0.0, 1.0);
        c.origin[0] = 0.7;
        c.target[0] = rows[i].f;
        c.target[1] = rows[i].slope;
        mt_test_row(t, "f %g, slope %g", rows[i].f, rows[i].slope);
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        REQUIRE(t, c.result.n_solutions >= 1);
        CHECK(t, c.result.solutions[0].t[0] == 0.0);
        if (CHECK_INT(t, c.result.n_unidentifiable, rows[i].n) && rows[i].n == 1) {
            CHECK(t, c.result.unidentifiable[0] == 0.0 && c.result.unidentifiable[1] == 1.0);
        }
        mt_arena_free(&c.mem);
    }
}

/* f = 1 + 1/2 sum of k_j (t_j - middle_j)^2, k_j = target[j], middle_j = target[3 + j] or,
 * where that is 0, 0.5. */
static void bowls(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    out->f = 1.0;
    for (int j = 0; j < c->nlp.n; j++) {
        const double d = t[j] - (c->target[3 + j] > 0.0 ? c->target[3 + j] : 0.5);
        out->f += 0.5 * c->target[j] * d * d;
        out->df[j] = c->target[j] * d;
    }
}

/* f = 1 + 1/2 (t0 + t1 - 1)^2 k0 + 1/2 k2 (t2 - 0.5)^2 */
static void trough(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    const double d = t[0] + t[1] - 1.0;
    const double d2 = t[2] - 0.5;
    out->f = 1.0 + (0.5 * c->target[0] * d * d) + (0.5 * c->target[2] * d2 * d2);
    out->df[0] = c->target[0] * d;
    out->df[1] = out->df[0];
    out->df[2] = c->target[2] * d2;
}

/* A solution is called flat for what is open beside single variables, which are put back to the
 * origin: along a trough, of whose bottom slopes do not tell the direction. */
static void nlp_directions__flat_is_what_is_open_beside_single_variables(mt_test *t)
{
    static const struct {
        const char *name;
        nlp_rows at;
        double curvature[3];
        int n; /* directions */
        bool flat;
    } rows[] = {
        {"a bowl", bowls, {1.0, 2.0, 3.0}, 0, false},
        {"one variable in nothing", bowls, {1.0, 2.0, 0.0}, 1, false},
        {"two variables in nothing", bowls, {1.0, 0.0, 0.0}, 2, false},
        {"a trough", trough, {1.0, 1.0, 2.0}, 0, true},
        {"a trough, one variable in nothing", trough, {1.0, 1.0, 0.0}, 1, true},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        nlp_case c = {0};
        mt_nlp_options opt = mt_nlp_options_default();
        opt.least_change = false;
        case_begin(&c, 3, rows[i].at, 0.0, 1.0);
        memcpy(c.target, rows[i].curvature, sizeof rows[i].curvature);
        c.origin[0] = 0.25;
        c.origin[1] = 0.375;
        c.origin[2] = 0.75;
        mt_test_row(t, "%s", rows[i].name);
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        REQUIRE(t, c.result.n_solutions >= 1);
        CHECK_INT(t, c.result.n_unidentifiable, rows[i].n);
        CHECK_INT(t, c.result.solutions[0].flat, rows[i].flat);
        mt_arena_free(&c.mem);
    }
}

/* The same bowls where rows bound t0 and t1 from below: in_i = t_i - 0.3. */
static void bowls_above(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    bowls(c, t, out);
    for (int i = 0; i < c->nlp.n_in; i++) {
        out->in[i] = t[i] - 0.3;
        for (int j = 0; j < c->nlp.n; j++) {
            out->din[i + (j * c->nlp.n_in)] = i == j ? 1.0 : 0.0;
        }
    }
}

/* A row that holds the design and presses with nothing leaves the side beyond it open: t0, and
 * t1, which are in nothing, come from 0.1 to 0.3 and would do as well above. Where they have a
 * bowl below 0.3 that presses, nothing is open. */
static void nlp_directions__a_row_without_a_multiplier_leaves_a_side_open(mt_test *t)
{
    static const struct {
        const char *name;
        double curvature[3];
        double middle[2]; /* of the bowls of t0 and t1, as targets[3 ...] */
        int n_in;
        bool flat;
    } rows[] = {
        {"one row, pressed", {1.0, 1.0, 1.0}, {0.1, 0.6}, 1, false},
        {"one row, not pressed", {0.0, 1.0, 1.0}, {0.1, 0.6}, 1, true},
        {"two rows, pressed", {1.0, 1.0, 1.0}, {0.1, 0.1}, 2, false},
        {"two rows, the first not pressed", {0.0, 1.0, 1.0}, {0.1, 0.1}, 2, true},
        {"two rows, the second not pressed", {1.0, 0.0, 1.0}, {0.1, 0.1}, 2, true},
        {"two rows, both not pressed", {0.0, 0.0, 1.0}, {0.1, 0.1}, 2, true},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        nlp_case c = {0};
        mt_nlp_options opt = mt_nlp_options_default();
        opt.least_change = false;
        case_begin(&c, 3, bowls_above, 0.0, 1.0);
        memcpy(c.target, rows[i].curvature, sizeof rows[i].curvature);
        memcpy(c.target + 3, rows[i].middle, sizeof rows[i].middle);
        c.nlp.n_in = rows[i].n_in;
        c.origin[0] = 0.1;
        c.origin[1] = 0.1;
        c.origin[2] = 0.75;
        mt_test_row(t, "%s", rows[i].name);
        REQUIRE(t, case_solve(&c, &opt) == MT_OK);
        REQUIRE(t, c.result.n_solutions >= 1 && c.result.solutions[0].feasible);
        CHECK_INT(t, c.result.solutions[0].flat, rows[i].flat);
        mt_arena_free(&c.mem);
    }
}

/* f = sum of k_j (exp(d_j) - d_j), d_j = t_j - 0.5 - j/10, a bowl that no parabola is. */
static void steep_bowl(const nlp_case *c, const double *t, mt_nlp_values *out)
{
    out->f = 0.0;
    for (int j = 0; j < c->nlp.n; j++) {
        const double d = t[j] - 0.5 - (0.1 * j);
        out->f += c->target[j] * (exp(d) - d);
        out->df[j] = c->target[j] * expm1(d);
    }
    for (int j = 0; j < c->nlp.n && c->nlp.n_eq > 0; j++) { /* t0 t1 t2 = 0.2 */
        out->eq[0] = (t[0] * t[1] * t[2]) - 0.2;
        out->deq[j] = t[(j + 1) % 3] * t[(j + 2) % 3];
    }
}

/* A bowl is not flat, wherever the search for its bottom is cut off: what was not looked at is
 * not told. */
static void nlp_directions__a_bowl_is_not_flat_whatever_the_budget(mt_test *t)
{
    static const double curvature[] = {1.0, 2.0, 3.0};
    for (int n_eq = 0; n_eq < 2; n_eq++) {
        bool done = false;
        for (long most = 1; most < 1000 && !done; most++) {
            nlp_case c = {0};
            mt_nlp_options opt = mt_nlp_options_default();
            opt.least_change = false;
            opt.max_evals = most;
            case_begin(&c, 3, steep_bowl, 0.0, 1.0);
            memcpy(c.target, curvature, sizeof curvature);
            c.nlp.n_eq = n_eq;
            mt_test_row(t, "%d equations, %ld evaluations", n_eq, most);
            REQUIRE(t, case_solve(&c, &opt) == MT_OK);
            for (int i = 0; i < c.result.n_solutions; i++) {
                CHECK(t, !c.result.solutions[i].flat);
            }
            done = c.result.stop == MT_STOP_DONE;
            mt_arena_free(&c.mem);
        }
        CHECK(t, done);
    }
}

/* Two valleys: 1 + |t0 - 0.2| has a kink, where no search comes to rest, and is the lower one;
 * beyond 0.6 it is 1.1 + 10/3 (t0 - 0.9)^2 + (t0 - 0.6)^2 (t1 - 0.5)^2. */
static mt_status valleys(void *context, const double *t, bool with_gradient, mt_nlp_values *out,
                         mt_err *err)
{
    const double d = t[0] - 0.9;
    const double g = t[0] - 0.6;
    const double d1 = t[1] - 0.5;
    (void)context;
    (void)with_gradient;
    (void)err;
    if (g <= 0.0) {
        out->f = 1.0 + fabs(t[0] - 0.2);
        out->df[0] = t[0] < 0.2 ? -1.0 : 1.0;
        out->df[1] = 0.0;
        return MT_OK;
    }
    out->f = 1.1 + (10.0 / 3.0 * d * d) + (g * g * d1 * d1);
    out->df[0] = (20.0 / 3.0 * d) + (2.0 * g * d1 * d1);
    out->df[1] = 2.0 * g * g * d1;
    return MT_OK;
}

/* Directions are those of the solution that is the best one, and not of the one that came to
 * rest first, where t1 counts. */
static void nlp_directions__directions_are_the_best_solutions(mt_test *t)
{
    nlp_case c = {0};
    mt_nlp_options opt = mt_nlp_options_default();
    opt.least_change = false;
    case_begin(&c, 2, NULL, 0.0, 1.0);
    c.nlp.eval = valleys;
    c.origin[0] = 0.3;
    c.origin[1] = 0.75;
    REQUIRE(t, case_solve(&c, &opt) == MT_OK);
    REQUIRE(t, c.result.n_solutions >= 1);
    CHECK_NEAR_ABS(t, c.result.solutions[0].f, 1.0, 1e-3);
    REQUIRE(t, c.result.n_unidentifiable == 1);
    CHECK(t, c.result.unidentifiable[0] == 0.0 && c.result.unidentifiable[1] == 1.0);
    CHECK(t, c.result.solutions[0].t[1] == 0.75);
    mt_arena_free(&c.mem);
}

MT_TEST_MAIN(MT_TEST(nlp_directions__a_combination_through_a_corner_is_still_found),
             MT_TEST(nlp_directions__no_room_at_the_solution_is_no_direction),
             MT_TEST(nlp_directions__what_is_on_a_bound_to_rounding_is_put_on_it),
             MT_TEST(nlp_directions__a_plane_has_one_basis),
             MT_TEST(nlp_directions__an_objective_of_0_sees_what_it_changes_with),
             MT_TEST(nlp_directions__flat_is_what_is_open_beside_single_variables),
             MT_TEST(nlp_directions__a_row_without_a_multiplier_leaves_a_side_open),
             MT_TEST(nlp_directions__a_bowl_is_not_flat_whatever_the_budget),
             MT_TEST(nlp_directions__directions_are_the_best_solutions))
