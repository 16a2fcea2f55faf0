/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The lowest modes of trees against
 *   the transfer matrix of a chain of rigid links in thirty digits: every link with a length, a
 *   mass and a spring of its own;
 *   the continuous cantilever, as the number of links or elements grows.
 */
#include <stdlib.h>

#include "analysis/lowest.h"
#include "mechanics/mech.h"
#include "mt_quad.h"
#include "mt_random.h"
#include "mt_writer.h"

enum { TEXT = 400000, COUNT = 6, LONGEST = 3000 };

/* A chain of rigid links on a line, clamped by the first spring, hanging along it where g is
 * not 0. */
typedef struct chain {
    int n;
    double g;
    double k[LONGEST]; /* [n] spring before link i */
    double m[LONGEST];
    double l[LONGEST];
} chain;

/*
 * Transfer matrix at lambda: w, theta of the link before, M and F, linear in F_0 and M_0;
 *     F' = F + lambda m (w + theta l/2),  M' = M - lambda J theta + l/2 (F + F'),
 *     theta' = theta + M'/k',  w' = w + l theta
 * with J = m l^2/12; the tensions T of a hanging chain add l/2 (T + T') theta to M'. A mode has
 * M = F = 0 at the end: the determinant of both solutions.
 */
static mt_quad determinant(const chain *c, mt_quad lambda)
{
    mt_quad end[2][2];
    for (int s = 0; s < 2; s++) {
        mt_quad force = s == 0 ? 1 : 0;
        mt_quad moment = s == 0 ? 0 : 1;
        mt_quad w = 0;
        mt_quad theta = 0;
        mt_quad tension = 0;
        for (int i = 0; i < c->n; i++) {
            tension += (mt_quad)c->g * (mt_quad)c->m[i];
        }
        for (int i = 0; i < c->n; i++) {
            const mt_quad l = (mt_quad)c->l[i];
            const mt_quad m = (mt_quad)c->m[i];
            theta += moment / (mt_quad)c->k[i];
            const mt_quad next = force + lambda * m * (w + theta * l / 2);
            const mt_quad less = tension - (mt_quad)c->g * m;
            moment += l / 2 * (force + next) - lambda * (m * l * l / 12) * theta;
            moment += l / 2 * (tension + less) * theta;
            tension = less;
            force = next;
            w += l * theta;
        }
        end[s][0] = force;
        end[s][1] = moment;
    }
    return end[0][0] * end[1][1] - end[0][1] * end[1][0];
}

/* The root next to lambda, by secants. */
static double exact(const chain *c, double lambda)
{
    mt_quad a = (mt_quad)(lambda * (1.0 - 1e-9));
    mt_quad b = (mt_quad)(lambda * (1.0 + 1e-9));
    mt_quad fa = determinant(c, a);
    for (int i = 0; i < 12; i++) {
        const mt_quad fb = determinant(c, b);
        if (fb == fa) {
            break;
        }
        const mt_quad next = b - fb * (b - a) / (fb - fa);
        a = b;
        fa = fb;
        b = next;
        const double step = (double)((b - a) / b);
        if (fabs(step) < 1e-22) {
            break;
        }
    }
    return (double)b;
}

static void write_list(mt_writer *w, const char *name, int n, const double *list)
{
    mt_write(w, ", \"%s\": [", name);
    for (int i = 0; i < n; i++) {
        mt_write(w, "%s%.17g", i == 0 ? "" : ",", list[i]);
    }
    mt_write(w, "]");
}

static mt_lowest *lowest_of(mt_test *t, const char *text, int count, mt_model **model)
{
    mt_err err = {.text = ""};
    mt_lowest *l = NULL;
    *model = mech_parse(t, text);
    if (*model != NULL && !CHECK_INT(t,
                                     mt_lowest_new(&(mt_system_def){.model = *model},
                                                   (mt_lowest_want){.count = count}, &l, &err),
                                     MT_OK)) {
        (void)fprintf(stderr, "%s\n", err.text);
    }
    return l;
}

static void lowest__of_chains_are_those_of_their_transfer_matrix(mt_test *t)
{
    static const struct {
        const char *name;
        int n;
        double decades; /* of stiffness and mass, either way */
        double g;
        double k; /* stiffness, of that of a beam */
    } rows[] = {
        {"ten, graded", 10, 3.0, 0.0, 1.0},          {"100, graded", 100, 2.0, 0.0, 1.0},
        {"300, nearly uniform", 300, 0.1, 0.0, 1.0}, {"3000, uneven", 3000, 0.5, 0.0, 1.0},
        {"3000, uniform", 3000, 0.0, 0.0, 1.0},      {"ten, hanging", 10, 2.0, 9.81, 1.0},
        {"200, hanging, soft", 200, 0.5, 9.81, 0.1}, {"3000, hanging", 3000, 0.5, 9.81, 0.1},
    };
    static chain c;
    mt_writer w = {.text = malloc(TEXT), .room = TEXT};
    REQUIRE(t, w.text != NULL);
    for (int row = 0; row < MT_COUNT(rows); row++) {
        const int n = rows[row].n;
        mt_random r = mt_random_seed((uint64_t)row + 7);
        c.n = n;
        c.g = rows[row].g;
        double span = 0.0;
        for (int i = 0; i < n; i++) {
            c.k[i] = rows[row].k * n *
                     pow(10.0, mt_random_in(&r, -rows[row].decades, rows[row].decades));
            c.m[i] = pow(10.0, mt_random_in(&r, -rows[row].decades, rows[row].decades)) / n;
            c.l[i] = (double)(64 + mt_random_int(&r, 64)) / 8192.0; /* sums are exact */
            span += c.l[i];
        }
        w.used = 0;
        mt_write(&w, "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"points\": "
                     "{\"a\": [0, 0], ");
        mt_write(&w, c.g > 0.0 ? "\"b\": [0, %.17g]}, " : "\"b\": [%.17g, 0]}, ",
                 c.g > 0.0 ? -span : span);
        mt_write(
            &w,
            "\"gravity_m_per_s2\": [0, %.17g], \"joints\": [{\"name\": \"root\", \"type\": "
            "\"revolute\", \"bodies\": [\"ground\", \"l.start\"], \"at\": \"a\"}], "
            "\"springs\": [{\"name\": \"s\", \"type\": \"torsion\", \"joint\": \"root\", "
            "\"stiffness_n_m_per_rad\": %.17g}], \"links\": [{\"name\": \"l\", \"from\": "
            "\"a\", \"to\": \"b\", \"elements\": %d",
            -c.g, c.k[0], n);
        write_list(&w, "stiffness_n_m_per_rad", n - 1, c.k + 1);
        write_list(&w, "element_mass_kg", n, c.m);
        write_list(&w, "element_length_m", n, c.l);
        mt_write(&w, "}]}");
        mt_test_row(t, "%s", rows[row].name);
        mt_model *model = NULL;
        mt_lowest *const l = lowest_of(t, w.text, COUNT, &model);
        if (l != NULL && CHECK(t, l->tree != NULL) &&
            CHECK_INT(t, l->found.modes.count, COUNT)) {
            for (int i = 0; i < COUNT; i++) {
                const double lambda = l->found.modes.lambda[i];
                const double want = exact(&c, lambda);
                CHECK_NEAR(t, lambda, want, 1e-11);
                CHECK(t, fabs(lambda - want) <= l->found.modes.error[i]);
            }
        }
        mt_lowest_delete(l);
        mt_model_delete(model);
    }
    free(w.text);
}

/* (beta l)^2 of the clamped and free beam: cos(x) cosh(x) = -1. */
static const double CANTILEVER[] = {1.87510406871196115, 4.69409113297417458,
                                    7.85475743823761296, 10.9955407348754670};

/* The discretisation's error falls with the square of the links, or the fourth power of the
 * elements, until it is gone; what is left at the end is below the error that is stated, and a
 * stiffness that grows with n^4 against the first mode's costs nothing. */
static void lowest__of_a_cantilever_tend_to_the_continuum(mt_test *t)
{
    static const struct {
        const char *name;
        const char *form; /* elements, elements, ... */
        int n;
        double error;
    } rows[] = {
        {"links", "", 1000, 4e-5},         {"links", "", 10000, 4e-7},
        {"links", "", 100000, 4e-9},       {"elements", "beam", 100, 2e-7},
        {"elements", "beam", 1000, 2e-11}, {"elements", "beam", 20000, 1e-10},
    };
    for (int row = 0; row < MT_COUNT(rows); row++) {
        char text[1200];
        const int n = rows[row].n;
        const bool beam = rows[row].form[0] != '\0';
        if (n > 10000 && getenv("MT_EVERY") == NULL) {
            continue; /* more than a second */
        }
        (void)snprintf(
            text, sizeof text,
            "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"points\": "
            "{\"a\": [0, 0], \"b\": [1, 0]}, \"joints\": [{\"name\": \"root\", "
            "\"type\": \"%s\", \"bodies\": [\"ground\", \"l.start\"], \"at\": \"a\"}], "
            "\"springs\": [%s%.17g%s], \"links\": [{\"name\": \"l\", \"from\": \"a\", "
            "\"to\": \"b\", \"elements\": %d, \"mass_kg\": 1, %s%.17g}]}",
            beam ? "fixed" : "revolute",
            beam ? "{\"name\": \"s\", \"type\": \"axial\", \"bodies\": [\"ground\", "
                   "\"l.start\"], \"at\": [[-1, 0], [0, 0]], \"stiffness_n_per_m\": "
                 : "{\"name\": \"s\", \"type\": \"torsion\", \"joint\": \"root\", "
                   "\"stiffness_n_m_per_rad\": ",
            2.0 * n, "}", n,
            beam ? "\"kind\": \"beam\", \"section\": {\"shape\": \"general\", \"area_m2\": 1, "
                   "\"second_moment_m4\": 1e-6}, \"youngs_modulus_pa\": "
                 : "\"stiffness_n_m_per_rad\": ",
            beam ? 1e6 : (double)n);
        mt_test_row(t, "%d %s", n, rows[row].name);
        mt_model *model = NULL;
        mt_lowest *const l = lowest_of(t, text, MT_COUNT(CANTILEVER), &model);
        if (l != NULL && CHECK(t, l->tree != NULL) &&
            CHECK_INT(t, l->found.modes.count, MT_COUNT(CANTILEVER))) {
            for (int i = 0; i < MT_COUNT(CANTILEVER); i++) {
                const double want = pow(CANTILEVER[i], 4.0);
                CHECK_NEAR(t, l->found.modes.lambda[i], want,
                           rows[row].error * (i + 1) * (i + 1));
            }
        }
        mt_lowest_delete(l);
        mt_model_delete(model);
    }
}

/* omega = j/2 sqrt(g/l), j the zeros of the Bessel function J0. */
static void lowest__of_a_hanging_chain_tend_to_bessel(mt_test *t)
{
    static const double zeros[] = {2.40482555769577277, 5.52007811028631064,
                                   8.65372791291101222};
    static const struct {
        int n;
        double error;
    } rows[] = {{100, 1e-4}, {1000, 1e-6}, {30000, 2e-9}};
    for (int row = 0; row < MT_COUNT(rows); row++) {
        char text[1000];
        mt_model *model = NULL;
        (void)snprintf(text, sizeof text,
                       "{\"format\": \"modetune-model/1\", \"dimension\": 2, "
                       "\"gravity_m_per_s2\": [0, -9.81], \"points\": {\"a\": [0, 0], \"b\": "
                       "[0, -1]}, \"joints\": [{\"name\": \"root\", \"type\": \"revolute\", "
                       "\"bodies\": [\"ground\", \"l.start\"], \"at\": \"a\"}], \"links\": "
                       "[{\"name\": \"l\", \"from\": \"a\", \"to\": \"b\", \"elements\": %d, "
                       "\"mass_kg\": 1, \"stiffness_n_m_per_rad\": 0}]}",
                       rows[row].n);
        mt_test_row(t, "%d", rows[row].n);
        mt_lowest *const l = lowest_of(t, text, MT_COUNT(zeros), &model);
        if (l != NULL && CHECK(t, l->tree != NULL) &&
            CHECK_INT(t, l->found.modes.count, MT_COUNT(zeros))) {
            for (int i = 0; i < MT_COUNT(zeros); i++) {
                const double want = 0.25 * zeros[i] * zeros[i] * 9.81;
                CHECK_NEAR(t, l->found.modes.lambda[i], want,
                           rows[row].error * (i + 1) * (i + 1));
            }
        }
        mt_lowest_delete(l);
        mt_model_delete(model);
    }
}

/* What is no tree is said to be none, with the reason. */
static void lowest__say_what_is_no_tree(mt_test *t)
{
    static const struct {
        const char *parts;
        const char *why;
    } rows[] = {
        {"\"joints\": [{\"name\": \"j\", \"type\": \"revolute\", \"bodies\": [\"a\", \"b\"], "
         "\"at\": [0, 0]}, {\"name\": \"k\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
         "\"a\"], \"at\": [1, 0]}], \"springs\": [{\"name\": \"s\", \"type\": \"axial\", "
         "\"bodies\": [\"ground\", \"b\"], \"at\": [[3, 0], [1, 1]], \"stiffness_n_per_m\": "
         "1}]",
         "joint \"j\" is part of a loop"},
        {"\"joints\": [{\"name\": \"j\", \"type\": \"revolute\", \"bodies\": [\"a\", \"b\"], "
         "\"at\": [0, 0]}, {\"name\": \"k\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
         "\"a\"], \"at\": [1, 0]}, {\"name\": \"l\", \"type\": \"pin-in-slot\", \"bodies\": "
         "[\"ground\", \"b\"], \"at\": [2, 0], \"axis\": [1, 0]}]",
         "joint \"j\" is part of a loop; nor the sparse one, as nothing in it has a "
         "stiffness"},
        {"\"gravity_m_per_s2\": [0, -9.81], \"joints\": [{\"name\": \"j\", \"type\": "
         "\"revolute\", "
         "\"bodies\": [\"a\", \"b\"], \"at\": [0, 1]}, {\"name\": \"k\", \"type\": \"fixed\", "
         "\"bodies\": [\"ground\", \"a\"], \"at\": [1, 0]}]",
         "\"b\" is not drawn at rest under its load; nor the sparse one, as without dense "
         "matrices no place is found where it settles"},
        {"\"gravity_m_per_s2\": [0, 9.81], \"joints\": [{\"name\": \"j\", \"type\": "
         "\"revolute\", \"bodies\": [\"a\", \"b\"], \"at\": [1, 2]}, {\"name\": \"k\", "
         "\"type\": \"fixed\", \"bodies\": [\"ground\", \"a\"], \"at\": [1, 0]}]",
         "it is free to move, or not stable, under its load; nor the sparse one, as a motion "
         "without stiffness has no mass, the mechanism is unstable, or sixteen digits do not "
         "resolve all of its motions"},
        {"\"gravity_m_per_s2\": [0, -9.81], \"joints\": [{\"name\": \"j\", \"type\": "
         "\"revolute\", \"bodies\": [\"a\", \"b\"], \"at\": [1, 2]}, {\"name\": \"k\", "
         "\"type\": \"fixed\", \"bodies\": [\"ground\", \"a\"], \"at\": [1, 0]}]",
         ""},
        {"\"joints\": [{\"name\": \"j\", \"type\": \"revolute\", \"bodies\": [\"a\", \"b\"], "
         "\"at\": [0, 0]}], \"springs\": [{\"name\": \"s\", \"type\": \"torsion\", \"joint\": "
         "\"j\", \"stiffness_n_m_per_rad\": -1}]",
         "spring \"s\" has a negative stiffness; nor the sparse one, as a motion without "
         "stiffness has no mass, the mechanism is unstable, or sixteen digits do not resolve "
         "all of its motions"},
        {"\"joints\": [{\"name\": \"j\", \"type\": \"fixed\", \"bodies\": [\"a\", \"b\"], "
         "\"at\": [0, 0]}, {\"name\": \"k\", \"type\": \"revolute\", \"bodies\": [\"b\", "
         "\"a\"], "
         "\"at\": [1, 0]}]",
         "joints of \"b\" hold it twice; nor the sparse one, as nothing in it has a stiffness"},
        {"\"joints\": [{\"name\": \"j\", \"type\": \"fixed\", \"bodies\": [\"a\", \"b\"], "
         "\"at\": [0, 0]}], \"configurations\": {\"x\": {}}",
         ""},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        char text[2000];
        (void)snprintf(
            text, sizeof text,
            "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"bodies\": "
            "[{\"name\": \"a\", \"mass_kg\": 1, \"inertia_kg_m2\": 1, \"centre\": [0, "
            "0]}, {\"name\": \"b\", \"mass_kg\": 1, \"inertia_kg_m2\": 1, \"centre\": "
            "[1, 1]}], %s}",
            rows[i].parts);
        mt_model *model = NULL;
        mt_test_row(t, "%d", i);
        mt_lowest *const l = lowest_of(t, text, 1, &model);
        if (l != NULL) {
            CHECK_STR(t, l->why, rows[i].why);
            CHECK(t, (l->tree != NULL) == (rows[i].why[0] == '\0'));
        }
        mt_lowest_delete(l);
        mt_model_delete(model);
    }
}

MT_TEST_MAIN(MT_TEST(lowest__of_chains_are_those_of_their_transfer_matrix),
             MT_TEST(lowest__of_a_cantilever_tend_to_the_continuum),
             MT_TEST(lowest__of_a_hanging_chain_tend_to_bessel),
             MT_TEST(lowest__say_what_is_no_tree))
