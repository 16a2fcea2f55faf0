/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The lowest modes of mechanisms with loops, in coordinates of their bodies: stacks of
 * platforms, each hung by as many rods, with weights or without, as leave it swinging, which
 * meet, drawn on, on the axis that all weights stand on, whence the drawing is at rest.
 * Weights, forces, stretched springs along the axis, bodies fixed aside, and springs and rods
 * without load anywhere.
 *     Loaded ones against the dense way; slopes of others against differences of frequencies.
 * MT_STRESS_ROUNDS=N: N times as many.
 */
#include <float.h>
#include <stdlib.h>

#include "analysis/lowest.h"
#include "mechanics/mech.h"
#include "mt_random.h"
#include "stress/table.h"

enum { TEXT = 80000, STACKS = 300, SLOPES = 25, MOST_LEVELS = 4, COUNT = 5, INPUTS = 5 };

static const char *const INPUT[INPUTS] = {"m", "k", "W", "L", "a"};
static const int PARAMETER[INPUTS] = {0, 1, 2, 3, 4};
static const double AT[INPUTS] = {1.0, 1.0, 1.0, 1.0, 1.0};

/* Roundings of a shape, of which the strains of the stiffest springs feel the most. */
static const double SHAPE_ULPS = 16.0;

static const char *const ROD[] = {"a", "b", "c"};

typedef struct stack {
    mt_random r;
    char *text;
    size_t used;
    int dimension;
    bool loaded;
    int levels;
    double height[MOST_LEVELS]; /* of centres */
    double apex[MOST_LEVELS];   /* above it, where the lines of its rods meet */
    double start[MOST_LEVELS];  /* where around it they begin */
    bool heavy[MOST_LEVELS];    /* have the rods a weight? */
    int items;                  /* of the list that is being written */
} stack;

#define ADD(s, ...) \
    ((s)->used += (size_t)snprintf((s)->text + (s)->used, TEXT - (s)->used, __VA_ARGS__))

static double in(stack *s, double low, double high)
{
    return mt_random_in(&s->r, low, high);
}

/* A place: across by W, along the axis by L. */
static void add_place(stack *s, const double x[3])
{
    ADD(s, "[\"%.17g*W\", ", x[0]);
    if (s->dimension == 3) {
        ADD(s, "\"%.17g*W\", ", x[1]);
    }
    ADD(s, "\"%.17g*L\"]", x[2]);
}

static void add_platform(stack *s, int level)
{
    if (level < 0) {
        ADD(s, "\"ground\"");
    } else {
        ADD(s, "\"p%d\"", level);
    }
}

static void add_item(stack *s, const char *type, int from, int to)
{
    ADD(s, "%s{\"name\": \"i%d\", \"type\": \"%s\", \"bodies\": [", s->items > 0 ? ", " : "",
        s->items, type);
    add_platform(s, from);
    ADD(s, ", ");
    add_platform(s, to);
    ADD(s, "], \"at\": ");
    s->items++;
}

static void add_between(stack *s, const char *type, int from, int to, const double a[3],
                        const double b[3])
{
    add_item(s, type, from, to);
    ADD(s, "[");
    add_place(s, a);
    ADD(s, ", ");
    add_place(s, b);
    ADD(s, "]");
}

static void write_body(stack *s, const char *name, int level, const char *which, double mass,
                       const double x[3])
{
    ADD(s, "%s{\"name\": \"%s%d%s\", \"mass_kg\": \"%.17g*m\", \"centre\": ",
        s->items++ > 0 ? ", " : "", name, level, which, mass);
    add_place(s, x);
    if (s->dimension == 2) {
        ADD(s, ", \"inertia_kg_m2\": %.17g}", in(s, 0.02, 0.5));
    } else {
        ADD(s, ", \"inertia_kg_m2\": [%.17g, %.17g, %.17g, %.17g, 0, 0.01]}", in(s, 0.3, 0.5),
            in(s, 0.3, 0.5), in(s, 0.3, 0.5), in(s, -0.05, 0.05));
    }
}

/* Axes of a universal joint. */
static const char *crossed(const stack *s)
{
    return s->dimension == 2 ? "" : "\"axis\": [1, 0, 0], \"axis_b\": [0, 1, 0], ";
}

/* The ends of rod k of those that a platform hangs on: on lines through one point of the axis,
 * those with a weight as far apart as can be. */
static void place_rod(stack *s, int level, int k, double high[3], double low[3])
{
    const bool even = s->heavy[level];
    const double turn =
        s->start[level] + (2.0 * MECH_PI * k / s->dimension) + (even ? 0.0 : in(s, -0.3, 0.3));
    const double out = even ? 0.5 : in(s, 0.3, 0.8);
    const double part = even ? 0.4 : in(s, 0.2, 0.6);
    const double apex = s->height[level] + s->apex[level];
    low[0] = s->dimension == 3 ? out * cos(turn) : k == 0 ? -out : out;
    low[1] = s->dimension == 3 ? out * sin(turn) : 0.0;
    low[2] = s->height[level] + (even ? 0.1 : in(s, -0.3, 0.3));
    high[0] = (1.0 - part) * low[0];
    high[1] = (1.0 - part) * low[1];
    high[2] = low[2] + (part * (apex - low[2]));
}

/* A platform, two bodies aside that are fixed to it, or not, and one that hangs below. */
static void write_bodies(stack *s, const bool *sides, const bool *bob)
{
    s->items = 0;
    ADD(s, "\"bodies\": [");
    for (int i = 0; i < s->levels; i++) {
        const double mass = in(s, 0.2, 2.0);
        const double x[3] = {0.0, 0.0, s->height[i]};
        double aside[3] = {in(s, 0.2, 0.6), in(s, -0.6, 0.6), s->height[i] + in(s, -0.3, 0.3)};
        write_body(s, "p", i, "", in(s, 0.5, 3.0), x);
        for (int side = 0; side < 2 && sides[i]; side++) {
            write_body(s, "q", i, ROD[side], mass, aside);
            aside[0] = -aside[0];
            aside[1] = -aside[1];
        }
        for (int k = 0; k < s->dimension && s->heavy[i]; k++) {
            double end[2][3];
            place_rod(s, i, k, end[0], end[1]);
            for (int c = 0; c < 3; c++) {
                end[0][c] = 0.5 * (end[0][c] + end[1][c]);
            }
            write_body(s, "t", i, ROD[k % 3], 0.5 * mass, end[0]);
        }
        if (bob[i]) {
            write_body(s, "r", i, "", mass, (const double[3]){0.0, 0.0, s->height[i] - 0.7});
        }
    }
    ADD(s, "]");
}

/* A rod with a weight is a body on two joints. */
static void write_heavy_rod(stack *s, int level, int k, const double high[3],
                            const double low[3])
{
    ADD(s, "%s{\"name\": \"u%d%d\", \"type\": \"%s\", \"bodies\": [",
        s->items++ > 0 ? ", " : "", level, k, s->dimension == 2 ? "revolute" : "universal");
    add_platform(s, level - 1);
    ADD(s, ", \"t%d%s\"], %s\"at\": ", level, ROD[k % 3], crossed(s));
    add_place(s, high);
    ADD(s, "}, {\"name\": \"v%d%d\", \"type\": \"%s\", \"bodies\": [\"t%d%s\", ", level, k,
        s->dimension == 2 ? "revolute" : "spherical", level, ROD[k % 3]);
    add_platform(s, level);
    ADD(s, "], \"at\": ");
    add_place(s, low);
    ADD(s, "}");
}

static void write_rods(stack *s, int level)
{
    for (int k = 0; k < s->dimension; k++) {
        double high[3];
        double low[3];
        place_rod(s, level, k, high, low);
        if (s->heavy[level]) {
            write_heavy_rod(s, level, k, high, low);
        } else {
            add_between(s, "distance", level - 1, level, high, low);
            ADD(s, "}");
        }
    }
}

static void write_joints(stack *s, const bool *sides, const bool *bob)
{
    s->items = 0;
    ADD(s, ", \"joints\": [");
    for (int i = 0; i < s->levels; i++) {
        write_rods(s, i);
        for (int side = 0; side < 2 && sides[i]; side++) {
            ADD(s, ", {\"name\": \"f%d%d\", \"type\": \"fixed\", \"bodies\": [\"p%d\", ", i,
                side, i);
            ADD(s, "\"q%d%s\"], \"at\": ", i, ROD[side]);
            add_place(s, (const double[3]){0.1, 0.2, s->height[i]});
            ADD(s, "}");
        }
        if (bob[i]) {
            ADD(s, ", {\"name\": \"h%d\", \"type\": \"%s\", \"bodies\": [\"p%d\", \"r%d\"], %s",
                i, s->dimension == 2 ? "revolute" : "universal", i, i, crossed(s));
            ADD(s, "\"at\": ");
            add_place(s, (const double[3]){0.0, 0.0, s->height[i] - 0.2});
            ADD(s, "}");
        }
        if (mt_random_int(&s->r, 4) == 0) { /* a rod that nothing strains */
            add_between(s, "distance", -1, i, (const double[3]){1.5, -0.9, in(s, -1.0, 1.0)},
                        (const double[3]){0.4, 0.3, s->height[i]});
            ADD(s, "}");
        }
    }
    ADD(s, "]");
}

static void write_springs(stack *s)
{
    s->items = 0;
    ADD(s, ", \"springs\": [");
    for (int i = 0; i < s->levels; i++) {
        for (int k = 0; k < s->dimension; k++) { /* not strained */
            const int to = mt_random_int(&s->r, i + 1) - 1;
            const double a[3] = {in(s, -1.0, 1.0), in(s, -1.0, 1.0), in(s, -1.0, 1.0)};
            const double b[3] = {in(s, -1.0, 1.0), in(s, -1.0, 1.0), s->height[i] + 0.1};
            add_between(s, "axial", to, i, a, b);
            ADD(s, ", \"stiffness_n_per_m\": \"%.17g*%c\"}", pow(10.0, in(s, 1.0, 5.0)),
                k == 0 ? 'a' : 'k');
        }
        if (s->loaded && mt_random_int(&s->r, 2) == 0) { /* on the axis, stretched */
            const double length = 1.0 + in(s, 0.0, 1.0);
            const double b[3] = {0.0, 0.0, s->height[i] + 0.2};
            const double a[3] = {0.0, 0.0, b[2] + length};
            add_between(s, "axial", i - 1, i, a, b);
            if (mt_random_int(&s->r, 2) == 0) {
                ADD(s, ", \"stiffness_n_per_m\": %.17g, \"free_length_m\": %.17g}",
                    in(s, 1.0, 50.0), length - in(s, -0.1, 0.4));
            } else {
                ADD(s, ", \"stiffness_n_per_m\": %.17g, \"preload_n\": %.17g}",
                    in(s, 1.0, 500.0), in(s, -2.0, 10.0));
            }
        }
    }
    ADD(s, "]");
}

static void write_stack(stack *s, uint64_t seed, bool loaded)
{
    bool sides[MOST_LEVELS];
    bool bob[MOST_LEVELS];
    s->r = mt_random_seed(seed);
    s->used = 0;
    s->loaded = loaded;
    s->dimension = 2 + mt_random_int(&s->r, 2);
    s->levels = 1 + mt_random_int(&s->r, MOST_LEVELS);
    for (int i = 0; i < s->levels; i++) {
        s->height[i] = -1.5 * i;
        s->apex[i] = in(s, 1.0, 4.0);
        s->start[i] = in(s, 0.0, 1.0);
        s->heavy[i] = mt_random_int(&s->r, 2) == 0;
        sides[i] = mt_random_int(&s->r, 2) == 0;
        bob[i] = mt_random_int(&s->r, 3) == 0;
    }
    ADD(s, "{\"format\": \"modetune-model/1\", \"dimension\": %d, \"parameters\": {",
        s->dimension);
    for (int k = 0; k < INPUTS; k++) {
        ADD(s, "%s\"%s\": {\"value\": 1}", k == 0 ? "" : ", ", INPUT[k]);
    }
    ADD(s, "}, ");
    if (loaded) {
        ADD(s,
            "\"gravity_m_per_s2\": [0, %s\"-9.81\"], \"loads\": [{\"name\": \"l\", \"on\": "
            "\"p0\", \"at\": ",
            s->dimension == 2 ? "" : "0, ");
        add_place(s, (const double[3]){0.0, 0.0, -0.35});
        ADD(s, ", \"force_n\": [0, %s%.17g]}], ", s->dimension == 2 ? "" : "0, ",
            in(s, -20.0, 3.0));
    }
    write_bodies(s, sides, bob);
    write_joints(s, sides, bob);
    write_springs(s);
    ADD(s, "}");
}

static mt_lowest *lowest_at(mt_test *t, const mt_model *model, const double *at)
{
    mt_err err = {.text = ""};
    mt_lowest *l = NULL;
    const mt_lowest_want want = {.count = COUNT, .shapes = true};
    if (!CHECK_INT(t,
                   mt_lowest_new(
                       &(mt_system_def){
                           .model = model, .n_inputs = INPUTS, .inputs = PARAMETER, .at = at},
                       want, &l, &err),
                   MT_OK)) {
        (void)fprintf(stderr, "%s\n", err.text);
    }
    return l;
}

static void lowest__of_loaded_mechanisms_with_loops_are_those_of_the_dense_way(mt_test *t)
{
    const int stacks = rounds() * STACKS;
    stack s = {.text = malloc(TEXT)};
    int found = 0;
    int refused = 0;
    REQUIRE(t, s.text != NULL);
    for (int i = 0; i < stacks; i++) {
        mech dense;
        write_stack(&s, (uint64_t)i + 1, true);
        mt_test_row(t, "seed %d", i + 1);
        const bool told = mech_open(t, mech_parse(t, s.text), NULL, "m k W L a", &dense);
        mt_lowest *const l = dense.model == NULL ? NULL : lowest_at(t, dense.model, AT);
        const bool stable =
            told && (dense.a->modes.count == 0 || dense.a->modes.lambda[0] > 0.0);
        if (l != NULL && l->way == MT_LOWEST_SPARSE && CHECK(t, stable)) {
            const mt_modes *const got = &l->found.modes;
            const mt_modes *const want = &dense.a->modes;
            found++;
            CHECK_INT(t, got->n, want->n);
            CHECK_INT(t, got->count, want->count < COUNT ? want->count : COUNT);
            for (int k = 0; k < got->count && k < want->count; k++) {
                CHECK(t,
                      fabs(got->lambda[k] - want->lambda[k]) <= got->error[k] + want->error[k]);
                CHECK(t, got->error[k] <= 1e-6 * got->lambda[k]);
            }
        } else {
            refused += stable && l != NULL && l->way == MT_LOWEST_NONE ? 1 : 0;
        }
        mt_lowest_delete(l);
        mech_free(&dense);
    }
    mt_test_row(t, "all");
    CHECK(t, found >= stacks / 2);
    CHECK(t, refused <= stacks / 100);
    free(s.text);
}

/* Frequencies at a point; false where the way is another. */
static bool frequencies(mt_test *t, const mt_model *model, const double *at, int n, double *hz,
                        double *error)
{
    mt_lowest *const l = lowest_at(t, model, at);
    const bool is = l != NULL && l->way == MT_LOWEST_SPARSE &&
                    l->found.modes.count - l->found.modes.n_rigid >= n;
    for (int i = 0; i < n && is; i++) {
        const mt_modes *const m = &l->found.modes;
        const int k = m->n_rigid + i;
        hz[i] = mt_modal_hz(m, k);
        error[i] = hz[i] * 0.5 * m->error[k] / m->lambda[k];
    }
    mt_lowest_delete(l);
    return is;
}

/* Differences over 2 h, h and h/2, extrapolated to h^6; open: by the step before, and what the
 * stated errors of the frequencies make of the last. */
static bool differences(mt_test *t, const mt_model *model, int input, int n, double *slope,
                        double *open)
{
    double d[3][COUNT];
    double part[2 * COUNT];
    double hz[2 * COUNT];
    for (int s = 0; s < 3; s++) {
        const double h = ldexp(1.0, -6 - s);
        for (int side = 0; side < 2; side++) {
            double at[INPUTS];
            memcpy(at, AT, sizeof at);
            at[input] += side == 0 ? -h : h;
            if (!frequencies(t, model, at, n, hz + ((ptrdiff_t)side * n),
                             part + ((ptrdiff_t)side * n))) {
                return false;
            }
        }
        for (int i = 0; i < n; i++) {
            d[s][i] = (hz[n + i] - hz[i]) / (2.0 * h);
            open[i] = (part[n + i] + part[i]) / h;
        }
    }
    for (int i = 0; i < n; i++) {
        const double a = d[1][i] + ((d[1][i] - d[0][i]) / 3.0);
        const double b = d[2][i] + ((d[2][i] - d[1][i]) / 3.0);
        slope[i] = b + ((b - a) / 15.0);
        open[i] += fabs(slope[i] - b);
    }
    return true;
}

/* The largest K_ii/M_ii. */
static double highest(const mt_absolute *o)
{
    const mt_squares *const of[2] = {&o->k, &o->m};
    double *const sum = calloc((size_t)o->n * 2, sizeof *sum);
    double most = 0.0;
    for (int kind = 0; kind < 2 && sum != NULL; kind++) {
        const mt_rows *const row = &of[kind]->row;
        for (int r = 0; r < row->n_rows; r++) {
            for (int q = row->start[r]; q < row->start[r + 1]; q++) {
                sum[(2 * row->index[q]) + kind] +=
                    fabs(of[kind]->c[r]) * row->value[q] * row->value[q];
            }
        }
    }
    for (ptrdiff_t j = 0; j < o->n && sum != NULL; j++) {
        most = fmax(most, sum[2 * j] / sum[(2 * j) + 1]);
    }
    free(sum);
    return most;
}

/* Modes up to the first that has another too near to be told from it along a step. */
static int apart(const mt_modes *m)
{
    int n = 0;
    while (n < COUNT - 1 && m->n_rigid + n + 1 < m->count &&
           m->lambda[m->n_rigid + n + 1] > 1.3 * m->lambda[m->n_rigid + n]) {
        n++;
    }
    return n;
}

static void lowest__slopes_of_mechanisms_with_loops_are_limits_of_differences(mt_test *t)
{
    stack s = {.text = malloc(TEXT)};
    int told = 0;
    REQUIRE(t, s.text != NULL);
    for (int i = 0; i < rounds() * SLOPES; i++) {
        char why[MT_TREE_WHY] = "";
        double slope[COUNT * INPUTS];
        double want[COUNT];
        double open[COUNT];
        mt_err err = {.text = ""};
        write_stack(&s, (uint64_t)i + 1, false);
        mt_test_row(t, "seed %d", i + 1);
        mt_model *const model = mech_parse(t, s.text);
        mt_lowest *const l = model == NULL ? NULL : lowest_at(t, model, AT);
        const bool sparse = l != NULL && l->way == MT_LOWEST_SPARSE;
        const int n = sparse ? apart(&l->found.modes) : 0;
        if (n > 0) {
            CHECK_INT(t, mt_lowest_sensitivity(l, n, slope, why, &err), MT_OK);
        }
        for (int k = 0; k < INPUTS && n > 0 && why[0] == '\0'; k++) {
            mt_test_row(t, "seed %d by %s", i + 1, INPUT[k]);
            if (!differences(t, model, k, n, want, open)) {
                continue;
            }
            told++;
            for (int j = 0; j < n; j++) {
                const double hz = mt_modal_hz(&l->found.modes, l->found.modes.n_rigid + j);
                const double lambda = l->found.modes.lambda[l->found.modes.n_rigid + j];
                const double part =
                    SHAPE_ULPS * DBL_EPSILON * (1.0 + (highest(&l->bodies) / lambda));
                CHECK_NEAR_ABS(t, slope[j + (n * k)], want[j],
                               open[j] + (part * (hz + fabs(want[j]))));
            }
        }
        mt_lowest_delete(l);
        mt_model_delete(model);
    }
    mt_test_row(t, "all");
    CHECK(t, told >= rounds() * SLOPES);
    free(s.text);
}

MT_TEST_MAIN(MT_TEST(lowest__slopes_of_mechanisms_with_loops_are_limits_of_differences),
             MT_TEST(lowest__of_loaded_mechanisms_with_loops_are_those_of_the_dense_way))
