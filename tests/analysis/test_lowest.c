/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The lowest modes of trees against
 *   the dense way, on random trees in the plane and in space: joints, springs and bushings of
 *   every kind that a tree may have, point masses, beams, free parts, stiffnesses over decades;
 *   the transfer matrix of a chain of rigid links in thirty digits: every link with a length, a
 *   mass and a spring of its own;
 *   the continuous cantilever, as the number of links or elements grows.
 */
#include <stdlib.h>

#include "analysis/lowest.h"
#include "mechanics/mech.h"
#include "mt_quad.h"
#include "mt_random.h"

enum { TEXT = 400000, TREES = 300, MOST_BODIES = 9, COUNT = 6 };

typedef struct writer {
    char *text;
    size_t used;
} writer;

#define ADD(w, ...) \
    ((w)->used += (size_t)snprintf((w)->text + (w)->used, TEXT - (w)->used, __VA_ARGS__))

typedef struct tree {
    mt_random r;
    int dimension;
    int n;
    double at[MOST_BODIES + 1][3]; /* centres; the last one is the ground's */
    bool point[MOST_BODIES + 1];
    int on[MOST_BODIES];            /* body, n: the ground, -1: nothing */
    const char *joint[MOST_BODIES]; /* NULL: springs alone */
} tree;

static void add_place(writer *w, const tree *m, const double *x)
{
    ADD(w, m->dimension == 2 ? "[%.17g, %.17g]" : "[%.17g, %.17g, %.17g]", x[0], x[1], x[2]);
}

static void add_name(writer *w, const tree *m, int body)
{
    if (body == m->n) {
        ADD(w, "\"ground\"");
    } else {
        ADD(w, "\"b%d\"", body);
    }
}

static double stiffness(tree *m)
{
    return pow(10.0, mt_random_in(&m->r, 0.0, 5.0));
}

static void choose(tree *m, uint64_t seed)
{
    static const char *const plane[] = {"fixed", "revolute", "prismatic", "pin-in-slot",
                                        "distance"};
    static const char *const space[] = {
        "fixed",  "revolute",      "prismatic", "cylindrical",    "spherical",  "universal",
        "planar", "point-on-line", "distance",  "point-on-plane", "orientation"};
    *m = (tree){.r = mt_random_seed(seed)};
    m->dimension = 2 + mt_random_int(&m->r, 2);
    m->n = 1 + mt_random_int(&m->r, MOST_BODIES);
    for (int i = 0; i < m->n; i++) {
        for (int k = 0; k < m->dimension; k++) {
            m->at[i][k] = mt_random_in(&m->r, -1.0, 1.0);
        }
        m->point[i] = mt_random_int(&m->r, 6) == 0;
        const int dice = mt_random_int(&m->r, 5);
        m->on[i] = i == 0      ? (dice == 0 ? -1 : m->n)
                   : dice == 0 ? m->n
                               : mt_random_int(&m->r, i);
        const bool joined = m->on[i] >= 0 && !m->point[i] && !m->point[m->on[i]] &&
                            mt_random_int(&m->r, 6) != 0;
        m->joint[i] = !joined             ? NULL
                      : m->dimension == 2 ? plane[mt_random_int(&m->r, MT_COUNT(plane))]
                                          : space[mt_random_int(&m->r, MT_COUNT(space))];
    }
}

static void write_bodies(writer *w, tree *m)
{
    ADD(w, "\"bodies\": [");
    for (int i = 0; i < m->n; i++) {
        ADD(w, "%s{\"name\": \"b%d\", \"mass_kg\": %.17g, \"centre\": ", i == 0 ? "" : ", ", i,
            mt_random_in(&m->r, 0.5, 3.0));
        add_place(w, m, m->at[i]);
        if (!m->point[i] && m->dimension == 2) {
            ADD(w, ", \"inertia_kg_m2\": %.17g", mt_random_in(&m->r, 0.01, 0.5));
        } else if (!m->point[i]) {
            ADD(w, ", \"inertia_kg_m2\": [%.17g, %.17g, %.17g, %.17g, 0, 0.01]",
                mt_random_in(&m->r, 0.2, 0.5), mt_random_in(&m->r, 0.2, 0.5),
                mt_random_in(&m->r, 0.2, 0.5), mt_random_in(&m->r, -0.05, 0.05));
        }
        ADD(w, "}");
    }
    ADD(w, "]");
}

static void write_joints(writer *w, tree *m)
{
    const char *between = "";
    ADD(w, ", \"joints\": [");
    for (int i = 0; i < m->n; i++) {
        const char *const type = m->joint[i];
        double x[2][3] = {{0.0}};
        if (type == NULL) {
            continue;
        }
        for (int k = 0; k < m->dimension; k++) {
            x[0][k] = mt_random_in(&m->r, -1.0, 1.0);
            x[1][k] = mt_random_in(&m->r, -1.0, 1.0);
        }
        ADD(w, "%s{\"name\": \"j%d\", \"type\": \"%s\", \"bodies\": [", between, i, type);
        add_name(w, m, m->on[i]);
        ADD(w, ", ");
        add_name(w, m, i);
        ADD(w, "]");
        if (strcmp(type, "distance") == 0) {
            ADD(w, ", \"at\": [");
            add_place(w, m, x[0]);
            ADD(w, ", ");
            add_place(w, m, x[1]);
            ADD(w, "]");
        } else if (strcmp(type, "orientation") != 0) {
            ADD(w, ", \"at\": ");
            add_place(w, m, x[0]);
        }
        const bool turns = strcmp(type, "revolute") == 0;
        const bool axis = strcmp(type, "fixed") != 0 && strcmp(type, "spherical") != 0 &&
                          strcmp(type, "distance") != 0 && strcmp(type, "orientation") != 0 &&
                          !(turns && m->dimension == 2);
        if (axis) {
            ADD(w, ", \"axis\": ");
            add_place(w, m,
                      m->dimension == 2 ? (const double[3]){0.6, 0.8, 0.0}
                                        : (const double[3]){0.6, 0.48, 0.64});
        }
        if (strcmp(type, "universal") == 0) {
            ADD(w, ", \"axis_b\": [0.8, -0.36, -0.48]");
        }
        ADD(w, "}");
        between = ", ";
    }
    ADD(w, "]");
}

/* Between body i and what it hangs on; a point mass is held at its centre. */
static void write_axial(writer *w, tree *m, int i, int k, const char *between)
{
    static const double far[3][3] = {{0.7, -0.4, 0.1}, {-0.5, -0.6, 0.3}, {0.2, 0.5, 0.8}};
    double from[3];
    for (int c = 0; c < 3; c++) {
        from[c] = m->point[m->on[i]] ? m->at[m->on[i]][c] : m->at[i][c] + far[k][c];
    }
    ADD(w, "%s{\"name\": \"s%d_%d\", \"type\": \"axial\", \"bodies\": [", between, i, k);
    add_name(w, m, m->on[i]);
    ADD(w, ", ");
    add_name(w, m, i);
    ADD(w, "], \"at\": [");
    add_place(w, m, from);
    ADD(w, ", ");
    add_place(w, m, m->at[i]);
    ADD(w, "], \"stiffness_n_per_m\": %.17g}", stiffness(m));
}

static void write_bushing(writer *w, tree *m, int i, const char *between)
{
    ADD(w, "%s{\"name\": \"u%d\", \"type\": \"bushing\", \"bodies\": [", between, i);
    add_name(w, m, m->on[i]);
    ADD(w, ", ");
    add_name(w, m, i);
    ADD(w, "], \"at\": ");
    add_place(w, m, m->at[i]);
    ADD(w, ", \"stiffness_n_per_m\": [%.17g, %.17g%s], \"stiffness_n_m_per_rad\": [%.17g%s]}",
        stiffness(m), stiffness(m), m->dimension == 2 ? "" : ", 31.5", stiffness(m),
        m->dimension == 2 ? "" : ", 70, 5.5");
}

static void write_springs(writer *w, tree *m)
{
    const char *between = "";
    ADD(w, ", \"springs\": [");
    for (int i = 0; i < m->n; i++) {
        if (m->on[i] < 0) {
            continue;
        }
        const bool turns = m->joint[i] != NULL && strcmp(m->joint[i], "revolute") == 0;
        const bool point = m->point[i] || m->point[m->on[i]];
        if (turns && mt_random_int(&m->r, 5) != 0) {
            ADD(w,
                "%s{\"name\": \"t%d\", \"type\": \"torsion\", \"joint\": \"j%d\", "
                "\"stiffness_n_m_per_rad\": %.17g}",
                between, i, i, stiffness(m));
            between = ", ";
        }
        for (int k = 0; k < (m->point[m->on[i]] ? 1 : m->dimension); k++) {
            if (point || mt_random_int(&m->r, 4) == 0) {
                write_axial(w, m, i, k, between);
                between = ", ";
            }
        }
        if (!point && (m->joint[i] == NULL || mt_random_int(&m->r, 2) == 0)) {
            write_bushing(w, m, i, between);
            between = ", ";
        }
    }
    ADD(w, "]");
}

/* Every mode is where the dense way has it, within the sum of the errors that both state. */
static void compare(mt_test *t, const mt_modes *got, const mt_modes *want)
{
    const int count = want->n_rigid + COUNT < want->count ? want->n_rigid + COUNT : want->count;
    CHECK_INT(t, got->n_rigid, want->n_rigid);
    if (!CHECK_INT(t, got->count, count)) {
        return;
    }
    for (int i = 0; i < count; i++) {
        CHECK_INT(t, got->kind[i], want->kind[i]);
        CHECK(t, fabs(got->lambda[i] - want->lambda[i]) <= got->error[i] + want->error[i]);
        CHECK(t, got->error[i] <= 1e-9 * got->lambda[i]);
        CHECK(t, got->residual[i] <= 10.0);
    }
}

static void lowest__of_random_trees_are_those_of_the_dense_way(mt_test *t)
{
    writer w = {.text = malloc(TEXT)};
    int trees = 0;
    REQUIRE(t, w.text != NULL);
    for (int i = 0; i < TREES; i++) {
        tree m;
        mech dense;
        mt_err err = {.text = ""};
        mt_lowest *l = NULL;
        choose(&m, (uint64_t)i + 1);
        w.used = 0;
        ADD(&w, "{\"format\": \"modetune-model/1\", \"dimension\": %d, ", m.dimension);
        write_bodies(&w, &m);
        write_joints(&w, &m);
        write_springs(&w, &m);
        ADD(&w, "}");
        mt_test_row(t, "seed %d", i + 1);
        if (!mech_open(t, mech_parse(t, w.text), NULL, "", &dense)) {
            mech_free(&dense);
            continue; /* a mechanism that the dense way refuses: a dead centre */
        }
        CHECK_INT(t, mt_lowest_new(dense.model, 0, 0, NULL, NULL, COUNT, &l, &err), MT_OK);
        if (l != NULL && l->tree != NULL) {
            compare(t, &l->found.modes, &dense.a->modes);
            trees++;
        } else if (l != NULL) {
            (void)fprintf(stderr, "seed %d: %s\n", i + 1, l->why);
        }
        mt_lowest_delete(l);
        mech_free(&dense);
    }
    mt_test_row(t, "all");
    CHECK(t, trees >= TREES * 8 / 10);
    free(w.text);
}

/* A chain of rigid links on the x axis, clamped by the first spring. */
typedef struct chain {
    int n;
    double *k; /* [n] spring before link i */
    double *m;
    double *l;
} chain;

/*
 * Transfer matrix at lambda: w, theta of the link before, M and F, linear in F_0 and M_0;
 *     F' = F + lambda m (w + theta l/2),  M' = M - lambda J theta + l/2 (F + F'),
 *     theta' = theta + M'/k',  w' = w + l theta
 * with J = m l^2/12. A mode has M = F = 0 at the end: the determinant of both solutions.
 */
static mt_quad determinant(const chain *c, mt_quad lambda)
{
    mt_quad end[2][2];
    for (int s = 0; s < 2; s++) {
        mt_quad force = s == 0 ? 1 : 0;
        mt_quad moment = s == 0 ? 0 : 1;
        mt_quad w = 0;
        mt_quad theta = 0;
        for (int i = 0; i < c->n; i++) {
            const mt_quad l = c->l[i];
            const mt_quad m = c->m[i];
            theta += moment / (mt_quad)c->k[i];
            const mt_quad next = force + lambda * m * (w + theta * l / 2);
            moment += l / 2 * (force + next) - lambda * (m * l * l / 12) * theta;
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
    mt_quad a = lambda * (1.0 - 1e-9);
    mt_quad b = lambda * (1.0 + 1e-9);
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

static void write_list(writer *w, const char *name, int n, const double *list)
{
    ADD(w, ", \"%s\": [", name);
    for (int i = 0; i < n; i++) {
        ADD(w, "%s%.17g", i == 0 ? "" : ",", list[i]);
    }
    ADD(w, "]");
}

static mt_lowest *lowest_of(mt_test *t, const char *text, int count, mt_model **model)
{
    mt_err err = {.text = ""};
    mt_lowest *l = NULL;
    *model = mech_parse(t, text);
    if (*model != NULL &&
        !CHECK_INT(t, mt_lowest_new(*model, 0, 0, NULL, NULL, count, &l, &err), MT_OK)) {
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
    } rows[] = {
        {"ten, graded", 10, 3.0},          {"100, graded", 100, 2.0},
        {"300, nearly uniform", 300, 0.1}, {"3000, uneven", 3000, 0.5},
        {"3000, uniform", 3000, 0.0},
    };
    writer w = {.text = malloc(TEXT)};
    REQUIRE(t, w.text != NULL);
    for (int row = 0; row < MT_COUNT(rows); row++) {
        const int n = rows[row].n;
        mt_random r = mt_random_seed((uint64_t)row + 7);
        double *const lists = calloc((size_t)(3 * n), sizeof *lists);
        REQUIRE(t, lists != NULL);
        chain c = {.n = n, .k = lists, .m = lists + n, .l = lists + (2 * n)};
        double span = 0.0;
        for (int i = 0; i < n; i++) {
            c.k[i] =
                (double)n * pow(10.0, mt_random_in(&r, -rows[row].decades, rows[row].decades));
            c.m[i] = pow(10.0, mt_random_in(&r, -rows[row].decades, rows[row].decades)) / n;
            c.l[i] = (double)(64 + mt_random_int(&r, 64)) / 8192.0; /* sums are exact */
            span += c.l[i];
        }
        w.used = 0;
        ADD(&w,
            "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"points\": {\"a\": [0, 0], "
            "\"b\": [%.17g, 0]}, \"joints\": [{\"name\": \"root\", \"type\": \"revolute\", "
            "\"bodies\": [\"ground\", \"l.start\"], \"at\": \"a\"}], \"springs\": [{\"name\": "
            "\"s\", "
            "\"type\": \"torsion\", \"joint\": \"root\", \"stiffness_n_m_per_rad\": %.17g}], "
            "\"links\": [{\"name\": \"l\", \"from\": \"a\", \"to\": \"b\", \"elements\": %d",
            span, c.k[0], n);
        write_list(&w, "stiffness_n_m_per_rad", n - 1, c.k + 1);
        write_list(&w, "element_mass_kg", n, c.m);
        write_list(&w, "element_length_m", n, c.l);
        ADD(&w, "}]}");
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
        free(lists);
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
         "joint \"j\" is part of a loop"},
        {"\"gravity_m_per_s2\": [0, -9.81], \"joints\": [{\"name\": \"j\", \"type\": "
         "\"revolute\", "
         "\"bodies\": [\"a\", \"b\"], \"at\": [0, 1]}, {\"name\": \"k\", \"type\": \"fixed\", "
         "\"bodies\": [\"ground\", \"a\"], \"at\": [1, 0]}]",
         "it is loaded (gravity, a preload, a free length, a load)"},
        {"\"joints\": [{\"name\": \"j\", \"type\": \"revolute\", \"bodies\": [\"a\", \"b\"], "
         "\"at\": [0, 0]}], \"springs\": [{\"name\": \"s\", \"type\": \"torsion\", \"joint\": "
         "\"j\", \"stiffness_n_m_per_rad\": -1}]",
         "spring \"s\" has a negative stiffness"},
        {"\"joints\": [{\"name\": \"j\", \"type\": \"fixed\", \"bodies\": [\"a\", \"b\"], "
         "\"at\": [0, 0]}, {\"name\": \"k\", \"type\": \"revolute\", \"bodies\": [\"b\", "
         "\"a\"], "
         "\"at\": [1, 0]}]",
         "joints of \"b\" hold it twice"},
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

MT_TEST_MAIN(MT_TEST(lowest__of_random_trees_are_those_of_the_dense_way),
             MT_TEST(lowest__of_chains_are_those_of_their_transfer_matrix),
             MT_TEST(lowest__of_a_cantilever_tend_to_the_continuum),
             MT_TEST(lowest__say_what_is_no_tree))
