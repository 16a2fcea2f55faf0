/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The lowest modes of random trees against the dense way, in the plane and in space: joints,
 * springs and bushings of every kind that a tree may have, point masses, free parts,
 * stiffnesses over decades; and hanging, or standing, along gravity, or each body pulled apart
 * by two forces in any direction; and under oblique gravity, where they settle. The same with
 * loops: more springs, and joints, between any two of the bodies, redundant ones among them.
 * MT_STRESS_ROUNDS=N: N times as many.
 */
#include <float.h>
#include <stdlib.h>

#include "analysis/analysis.h"
#include "analysis/lowest.h"
#include "mechanics/mech.h"
#include "mt_random.h"
#include "mt_writer.h"
#include "stress/table.h"

enum {
    TEXT = 80000,
    TREES = 500,
    LOOPED_ONES = 1200,
    PULLED_TREES = 300,
    MOST_BODIES = 9,
    COUNT = 6,
    INPUTS = 7
};

/* Parameters of every tree: masses, an inertia, stiffnesses, lengths along gravity and across,
 * where one joint sits, gravity. */
static const struct {
    const char *name;
    double at;
} INPUT[INPUTS] = {{"m", 1.0}, {"J", 1.0}, {"k", 1.0}, {"L", 1.0},
                   {"W", 1.0}, {"a", 0.0}, {"g", 1.0}};

/* Slopes of simple modes agree to this part of what scales them, */
static const double SLOPE_TOL = 1e-8;
/* and to the rounding of the dense way's shapes: of its stiffest mode, beside a soft one. */
static const double SHAPE_ULPS = 4.0;

typedef struct tree {
    mt_random r;
    int dimension;
    bool hung;    /* all on one line, which gravity lies along */
    bool looped;  /* with springs and joints across the branches */
    bool settles; /* elsewhere than it is drawn, under gravity in any direction */
    bool pulled;  /* at two points of each body, so that it rests as drawn */
    int n;
    double at[MOST_BODIES + 1][3]; /* centres; the last one is the ground's */
    bool point[MOST_BODIES + 1];
    int on[MOST_BODIES];            /* body, n: the ground, -1: nothing */
    const char *joint[MOST_BODIES]; /* NULL: springs alone */
} tree;

static void add_direction(mt_writer *w, const tree *m, const double *x)
{
    mt_write(w, m->dimension == 2 ? "[%.17g, %.17g]" : "[%.17g, %.17g, %.17g]", x[0], x[1],
             x[2]);
}

/* The last coordinate, which gravity lies along, by a parameter of its own; `more` on it. */
static void add_place_and(mt_writer *w, const tree *m, const double *x, const char *more)
{
    mt_write(w, "[");
    for (int k = 0; k < 3 && k < m->dimension; k++) {
        const bool last = k + 1 == m->dimension;
        mt_write(w, "\"%.17g*%s%s\"%s", x[k], last ? "L" : "W", last ? more : "",
                 last ? "]" : ", ");
    }
}

static void add_place(mt_writer *w, const tree *m, const double *x)
{
    add_place_and(w, m, x, "");
}

static void add_name(mt_writer *w, const tree *m, int body)
{
    if (body == m->n) {
        mt_write(w, "\"ground\"");
    } else {
        mt_write(w, "\"b%d\"", body);
    }
}

static double stiffness(tree *m)
{
    return pow(10.0, mt_random_in(&m->r, 0.0, 5.0));
}

/* What body i is on, by what joint (NULL: none). */
static void join(tree *m, int i)
{
    static const char *const plane[] = {"fixed", "revolute", "prismatic", "pin-in-slot",
                                        "distance"};
    static const char *const space[] = {
        "fixed",  "revolute",      "prismatic", "cylindrical",    "spherical",  "universal",
        "planar", "point-on-line", "distance",  "point-on-plane", "orientation"};
    const bool hung = m->hung;
    const int dice = mt_random_int(&m->r, 5);
    if (i == 0 || dice == 0) {
        m->on[i] = i == 0 && dice == 0 ? -1 : m->n;
    } else {
        m->on[i] = mt_random_int(&m->r, i);
    }
    /* what hangs rests as drawn where joints alone hold its weight */
    m->point[i] = m->point[i] && !hung;
    m->on[i] = (hung || m->settles) && m->on[i] < 0 ? m->n : m->on[i];
    const bool joined = m->on[i] >= 0 && !m->point[i] && !m->point[m->on[i]] &&
                        (hung || mt_random_int(&m->r, 6) != 0);
    m->joint[i] = !joined             ? NULL
                  : m->dimension == 2 ? plane[mt_random_int(&m->r, hung ? 4 : 5)]
                                      : space[mt_random_int(&m->r, hung ? 8 : 11)];
}

/* What sets the trees of a test apart. */
typedef enum kind { FREE, HUNG, SETTLES, PULLED, LOOPED } kind;

static void choose(tree *m, uint64_t seed, kind what)
{
    *m = (tree){.r = mt_random_seed(seed),
                .hung = what == HUNG,
                .settles = what == SETTLES,
                .looped = what == LOOPED,
                .pulled = what == PULLED};
    m->dimension = 2 + mt_random_int(&m->r, 2);
    m->n = 1 + mt_random_int(&m->r, MOST_BODIES);
    for (int i = 0; i < m->n; i++) {
        for (int k = 0; k < m->dimension; k++) {
            const double x = mt_random_in(&m->r, -1.0, 1.0);
            m->at[i][k] = m->hung && k + 1 < m->dimension ? 0.0 : x;
        }
        m->point[i] = mt_random_int(&m->r, 6) == 0;
        join(m, i);
    }
}

static void write_bodies(mt_writer *w, tree *m)
{
    mt_write(w, "\"bodies\": [");
    for (int i = 0; i < m->n; i++) {
        mt_write(w, "%s{\"name\": \"b%d\", \"mass_kg\": \"%.17g*m\", \"centre\": ",
                 i == 0 ? "" : ", ", i, mt_random_in(&m->r, 0.5, 3.0));
        add_place(w, m, m->at[i]);
        if (!m->point[i] && m->dimension == 2) {
            mt_write(w, ", \"inertia_kg_m2\": \"%.17g*J\"", mt_random_in(&m->r, 0.01, 0.5));
        } else if (!m->point[i]) {
            mt_write(w, ", \"inertia_kg_m2\": [\"%.17g*J\", %.17g, %.17g, %.17g, 0, 0.01]",
                     mt_random_in(&m->r, 0.3, 0.5), mt_random_in(&m->r, 0.3, 0.5),
                     mt_random_in(&m->r, 0.3, 0.5), mt_random_in(&m->r, -0.05, 0.05));
        }
        mt_write(w, "}");
    }
    mt_write(w, "]");
}

/* One joint sits where a parameter has it. */
static const char *aside(int joint)
{
    return joint == 0 ? " + a" : "";
}

/* Joints between any two bodies, as drawn. */
static void write_more_joints(mt_writer *w, tree *m, const char *between)
{
    for (int i = m->looped ? mt_random_int(&m->r, 3) : 0; i > 0 && m->n > 1; i--) {
        const int a = mt_random_int(&m->r, m->n);
        const int b = mt_random_int(&m->r, m->n + 1);
        if (a == b || m->point[a] || (b < m->n && m->point[b])) {
            continue;
        }
        const bool pin = mt_random_int(&m->r, 3) == 0;
        const double x[2][3] = {{0.3, -0.2 * i, 0.5}, {-0.7, 0.4, 0.1 * i}};
        mt_write(w, "%s{\"name\": \"x%d\", \"type\": \"%s\", \"bodies\": [", between, i,
                 !pin                ? "distance"
                 : m->dimension == 2 ? "revolute"
                                     : "spherical");
        add_name(w, m, a);
        mt_write(w, ", ");
        add_name(w, m, b);
        mt_write(w, pin ? "], \"at\": " : "], \"at\": [");
        add_place(w, m, x[0]);
        if (!pin) {
            mt_write(w, ", ");
            add_place(w, m, x[1]);
        }
        mt_write(w, pin ? "}" : "]}");
        between = ", ";
    }
}

/* The axis of a joint that has one, and the other one of a universal joint. */
static void write_axes(mt_writer *w, const tree *m, const char *type)
{
    const bool turns = strcmp(type, "revolute") == 0;
    const bool axis = strcmp(type, "fixed") != 0 && strcmp(type, "spherical") != 0 &&
                      strcmp(type, "distance") != 0 && strcmp(type, "orientation") != 0 &&
                      !(turns && m->dimension == 2);
    const bool normal = strcmp(type, "planar") == 0;
    if (axis && m->hung) {
        mt_write(w, ", \"axis\": %s",
                 m->dimension == 2 ? "[1, 0]"
                 : normal          ? "[0, 0, 1]"
                                   : "[1, 0, 0]");
    } else if (axis) {
        mt_write(w, ", \"axis\": ");
        add_direction(w, m,
                      m->dimension == 2 ? (const double[3]){0.6, 0.8, 0.0}
                                        : (const double[3]){0.6, 0.48, 0.64});
    }
    if (strcmp(type, "universal") == 0) {
        mt_write(w, ", \"axis_b\": %s", m->hung ? "[0, 1, 0]" : "[0.8, -0.36, -0.48]");
    }
}

static void write_joints(mt_writer *w, tree *m)
{
    const char *between = "";
    mt_write(w, ", \"joints\": [");
    for (int i = 0; i < m->n; i++) {
        const char *const type = m->joint[i];
        double x[2][3] = {{0.0}};
        if (type == NULL) {
            continue;
        }
        for (int k = 0; k < m->dimension; k++) {
            const bool off = m->hung && k + 1 < m->dimension;
            x[0][k] = off ? 0.0 : mt_random_in(&m->r, -1.0, 1.0);
            x[1][k] = off ? 0.0 : mt_random_in(&m->r, -1.0, 1.0);
        }
        mt_write(w, "%s{\"name\": \"j%d\", \"type\": \"%s\", \"bodies\": [", between, i, type);
        add_name(w, m, m->on[i]);
        mt_write(w, ", ");
        add_name(w, m, i);
        mt_write(w, "]");
        if (strcmp(type, "distance") == 0) {
            mt_write(w, ", \"at\": [");
            add_place(w, m, x[0]);
            mt_write(w, ", ");
            add_place(w, m, x[1]);
            mt_write(w, "]");
        } else if (strcmp(type, "orientation") != 0) {
            mt_write(w, ", \"at\": ");
            add_place_and(w, m, x[0], aside(i));
        }
        write_axes(w, m, type);
        mt_write(w, "}");
        between = ", ";
    }
    write_more_joints(w, m, between);
    mt_write(w, "]");
}

/* Between body i and what it hangs on; a point mass is held at its centre. */
static void write_axial(mt_writer *w, tree *m, int i, int k, const char *between)
{
    static const double far[3][3] = {{0.7, -0.4, 0.1}, {-0.5, -0.6, 0.3}, {0.2, 0.5, 0.8}};
    double from[3];
    for (int c = 0; c < 3; c++) {
        from[c] = m->point[m->on[i]] ? m->at[m->on[i]][c] : m->at[i][c] + far[k][c];
    }
    mt_write(w, "%s{\"name\": \"s%d_%d\", \"type\": \"axial\", \"bodies\": [", between, i, k);
    add_name(w, m, m->on[i]);
    mt_write(w, ", ");
    add_name(w, m, i);
    mt_write(w, "], \"at\": [");
    add_place(w, m, from);
    mt_write(w, ", ");
    add_place(w, m, m->at[i]);
    mt_write(w, "], \"stiffness_n_per_m\": \"%.17g*k\"}", stiffness(m));
}

static void write_bushing(mt_writer *w, tree *m, int i, const char *between)
{
    mt_write(w, "%s{\"name\": \"u%d\", \"type\": \"bushing\", \"bodies\": [", between, i);
    add_name(w, m, m->on[i]);
    mt_write(w, ", ");
    add_name(w, m, i);
    mt_write(w, "], \"at\": ");
    add_place(w, m, m->at[i]);
    mt_write(w,
             ", \"stiffness_n_per_m\": [%.17g, \"%.17g*k\"%s], \"stiffness_n_m_per_rad\": "
             "[%.17g%s]}",
             stiffness(m), stiffness(m), m->dimension == 2 ? "" : ", 31.5", stiffness(m),
             m->dimension == 2 ? "" : ", 70, 5.5");
}

/* Between any two of the bodies' centres. */
static void write_more_springs(mt_writer *w, tree *m, const char *between)
{
    for (int i = 1 + mt_random_int(&m->r, 4); i > 0 && m->n > 1; i--) {
        const int a = mt_random_int(&m->r, m->n);
        const int b = (a + 1 + mt_random_int(&m->r, m->n - 1)) % m->n;
        mt_write(w, "%s{\"name\": \"y%d\", \"type\": \"axial\", \"bodies\": [", between, i);
        add_name(w, m, a);
        mt_write(w, ", ");
        add_name(w, m, b);
        mt_write(w, "], \"at\": [");
        add_place(w, m, m->at[a]);
        mt_write(w, ", ");
        add_place(w, m, m->at[b]);
        mt_write(w, "], \"stiffness_n_per_m\": %.17g}", stiffness(m));
        between = ", ";
    }
}

static void write_springs(mt_writer *w, tree *m)
{
    const char *between = "";
    mt_write(w, ", \"springs\": [");
    for (int i = 0; i < m->n; i++) {
        if (m->on[i] < 0) {
            continue;
        }
        const bool turns = m->joint[i] != NULL && strcmp(m->joint[i], "revolute") == 0;
        const bool point = m->point[i] || m->point[m->on[i]];
        if (turns && mt_random_int(&m->r, 5) != 0) {
            mt_write(w,
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
    if (m->looped) {
        write_more_springs(w, m, between);
    }
    mt_write(w, "]");
}

static void write_force(mt_writer *w, int dimension, const double *x, const double *f, int end)
{
    mt_write(w, "\"at\": [");
    for (int k = 0; k < dimension; k++) {
        mt_write(w, "%s\"%.17g*%s - %.17g\"", k == 0 ? "" : ", ", x[k], k == 0 ? "W" : "L",
                 0.3 * end * f[k]);
    }
    mt_write(w, "], \"force_n\": [");
    for (int k = 0; k < dimension; k++) {
        mt_write(w, "%s\"%.17g*g\"", k == 0 ? "" : ", ", end == 0 ? f[k] : -f[k]);
    }
    mt_write(w, "]}");
}

/* A force at one point of a body and its opposite at another, a lever away against it: whatever
 * lengths and gravity are, their sum and their moment are 0. */
static void write_loads(mt_writer *w, tree *m)
{
    const char *between = "";
    mt_write(w, ", \"loads\": [");
    for (int i = 0; m->pulled && i < m->n; i++) {
        double f[3];
        double x[3];
        for (int k = 0; k < 3; k++) {
            f[k] = mt_random_in(&m->r, -3.0, 3.0);
            x[k] = mt_random_in(&m->r, -1.0, 1.0);
        }
        for (int end = 0; end < 2 && !m->point[i]; end++) {
            mt_write(w, "%s{\"name\": \"f%d_%d\", \"on\": \"b%d\", ", between, i, end, i);
            write_force(w, m->dimension, x, f, end);
            between = ", ";
        }
    }
    mt_write(w, "]");
}

/* Every mode is where the dense way has it, within the sum of the errors that both state.
 * *rough counts the trees whose residuals are far above rounding: where motions cancel. */
static void compare(mt_test *t, const mt_lowest *l, const mt_modes *want, int *rough)
{
    const mt_modes *const got = &l->found.modes;
    const bool edges = l->way == MT_LOWEST_TREE;
    double most = 0.0;
    const int count = want->n_rigid + COUNT < want->count ? want->n_rigid + COUNT : want->count;
    CHECK_INT(t, got->n_rigid, want->n_rigid);
    if (!CHECK_INT(t, got->count, count)) {
        return;
    }
    for (int i = 0; i < count; i++) {
        CHECK_INT(t, got->kind[i], want->kind[i]);
        CHECK(t, fabs(got->lambda[i] - want->lambda[i]) <= got->error[i] + want->error[i]);
        CHECK(t, got->error[i] <= (edges ? 1e-9 : 1e-6) * got->lambda[i]);
        most = !(got->residual[i] <= most) ? got->residual[i] : most;
    }
    *rough += edges && !(most <= 10.0) ? 1 : 0;
}

/* Slopes by every parameter; stiffest: lambda of the dense way's last mode; *told counts the
 * trees that have some. */
static void compare_slopes(mt_test *t, int seed, mt_lowest *l, mech *dense, double stiffest,
                           int *told)
{
    double got[COUNT * INPUTS];
    double want[COUNT];
    int position[COUNT];
    char why[MT_TREE_WHY];
    mt_err err = {.text = ""};
    mt_arena mem = {.first = NULL};
    mt_analysis_options opt = mt_analysis_options_default();
    const mt_modes *const m = &l->found.modes;
    const int n = m->count - m->n_rigid < COUNT ? m->count - m->n_rigid : COUNT;
    opt.gradient = true;
    for (int i = 0; i < n; i++) {
        position[i] = m->n_rigid + i;
    }
    CHECK_INT(t, mt_lowest_sensitivity(l, n, got, why, &err), MT_OK);
    if (why[0] == '\0' && CHECK_INT(t, mt_arena_init(&mem, 0, &err), MT_OK) &&
        CHECK_INT(t, mt_analysis_solve(dense->a, dense->at, &opt, &err), MT_OK)) {
        *told += 1;
        for (int k = 0; k < INPUTS; k++) {
            mt_independence why_not;
            mt_test_row(t, "seed %d, slope by %s", seed, INPUT[k].name);
            CHECK_INT(
                t,
                mt_analysis_sensitivity(dense->a, k, n, position, &mem, want, &why_not, &err),
                MT_OK);
            for (int i = 0; i < n; i++) {
                const double hz = mt_modal_hz(m, m->n_rigid + i);
                const double stiffer = stiffest / m->lambda[m->n_rigid + i];
                const double part = SLOPE_TOL + (SHAPE_ULPS * DBL_EPSILON * stiffer);
                CHECK_NEAR_ABS(t, got[i + (n * k)], want[i], part * (hz + fabs(want[i])));
            }
        }
    }
    mt_arena_free(&mem);
}

/* How many of the random trees: all with MT_EVERY=1, a tenth under valgrind. */
static int number_of_trees(kind what)
{
    const int number = rounds() * (what == LOOPED   ? LOOPED_ONES
                                   : what == PULLED ? PULLED_TREES
                                                    : TREES);
    const int part = getenv("MT_EVERY") != NULL ? 1 : 3;
    return number / (getenv("MT_TEST_LAUNCHED") != NULL ? 10 : part);
}

/* Is it free to move under its load, which other ways refuse? */
static bool is_adrift(kind what, const mech *dense)
{
    return (what == PULLED || what == SETTLES) && dense->a->modes.n_rigid > 0;
}

static void write_tree(mt_writer *w, tree *m, kind what)
{
    w->used = 0;
    mt_write(w, "{\"format\": \"modetune-model/1\", \"dimension\": %d, ", m->dimension);
    if (what == HUNG) {
        mt_write(w, "\"gravity_m_per_s2\": [0, %s\"-3.7*g\"], ",
                 m->dimension == 2 ? "" : "0, ");
    }
    if (what == SETTLES) {
        mt_write(w, "\"gravity_m_per_s2\": [\"0.4*g\", %s\"-0.7*g\"], ",
                 m->dimension == 2 ? "" : "\"0.3*g\", ");
    }
    mt_write(w, "\"parameters\": {");
    for (int k = 0; k < INPUTS; k++) {
        mt_write(w, "%s\"%s\": {\"value\": %g}", k == 0 ? "" : ", ", INPUT[k].name,
                 INPUT[k].at);
    }
    mt_write(w, "}, ");
    write_bodies(w, m);
    write_joints(w, m);
    write_springs(w, m);
    write_loads(w, m);
    mt_write(w, "}");
}

/* least: parts of a hundred that are answered. */
static void check_trees(mt_test *t, kind what, int least)
{
    mt_writer w = {.text = malloc(TEXT), .room = TEXT};
    static const int input[INPUTS] = {0, 1, 2, 3, 4, 5, 6};
    const int trees = number_of_trees(what);
    int found = 0;
    int refused = 0;
    int told = 0;
    int rough = 0;
    REQUIRE(t, w.text != NULL);
    for (int i = 0; i < trees; i++) {
        tree m;
        mech dense;
        mt_err err = {.text = ""};
        mt_lowest *l = NULL;
        choose(&m, (uint64_t)i + 1, what);
        write_tree(&w, &m, what);
        mt_test_row(t, "seed %d", i + 1);
        if (!mech_open(t, mech_parse(t, w.text), NULL, "m J k L W a g", &dense) ||
            is_adrift(what, &dense)) {
            mech_free(&dense);
            continue; /* a mechanism that the dense way refuses: a dead centre */
        }
        CHECK_INT(t,
                  mt_lowest_new(&(mt_system_def){.model = dense.model,
                                                 .n_inputs = INPUTS,
                                                 .inputs = input,
                                                 .at = dense.at},
                                (mt_lowest_want){.count = COUNT, .shapes = true}, &l, &err),
                  MT_OK);
        if (l != NULL && l->way != MT_LOWEST_NONE) {
            CHECK_INT(t, l->found.modes.n, dense.a->modes.n);
            compare(t, l, &dense.a->modes, &rough);
            found += (l->way == MT_LOWEST_SPARSE) == (what == LOOPED) ? 1 : 0;
        } else if (l != NULL) { /* with few freedoms and all of them asked for, some */
            refused += what == HUNG || what == SETTLES ? 0 : 1;
        }
        if (l != NULL && l->way != MT_LOWEST_NONE) {
            const mt_modes *const all = &dense.a->modes;
            const double stiffest = all->count > 0 ? all->lambda[all->count - 1] : 0.0;
            compare_slopes(t, i + 1, l, &dense, stiffest, &told);
        }
        mt_lowest_delete(l);
        mech_free(&dense);
    }
    mt_test_row(t, "all");
    CHECK(t, 100 * found >= least * trees);
    CHECK(t, rough <= trees / 1000);
    CHECK(t, refused <= (what == LOOPED ? trees / 200 : 0));
    /* where loads pull, only a parameter that leaves the drawing at rest has slopes here */
    CHECK(t, told >= (what == SETTLES  ? 0
                      : what == PULLED ? trees / 5
                                       : (least * trees / 100) - (10 * rounds())));
    free(w.text);
}

static void lowest__of_random_trees_are_those_of_the_dense_way(mt_test *t)
{
    check_trees(t, FREE, 80);
}

/* Of those whose springs let them rest as drawn, and hold them upright. */
static void lowest__of_random_trees_under_gravity_likewise(mt_test *t)
{
    check_trees(t, HUNG, 25);
}

/* Of those that have an equilibrium and that Newton's steps alone find: few are held in all
 * their freedoms. */
static void lowest__of_random_trees_that_settle_elsewhere_likewise(mt_test *t)
{
    check_trees(t, SETTLES, 15);
}

/* Under loads along all axes that leave them as drawn. */
static void lowest__of_random_trees_that_are_pulled_likewise(mt_test *t)
{
    check_trees(t, PULLED, 33);
}

/* Where they are no trees, in coordinates of their bodies. */
static void lowest__of_random_mechanisms_with_loops_likewise(mt_test *t)
{
    check_trees(t, LOOPED, 50);
}

MT_TEST_MAIN(MT_TEST(lowest__of_random_trees_are_those_of_the_dense_way),
             MT_TEST(lowest__of_random_trees_under_gravity_likewise),
             MT_TEST(lowest__of_random_trees_that_settle_elsewhere_likewise),
             MT_TEST(lowest__of_random_trees_that_are_pulled_likewise),
             MT_TEST(lowest__of_random_mechanisms_with_loops_likewise))
