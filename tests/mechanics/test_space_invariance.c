/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What must not matter in space: where the whole model stands, in which order its parts are
 * listed, joints given twice, units of length and mass. The model: servo shaft with crank, a
 * rod between ball joints (its spin is a rigid-body mode), a stick on an oblique pivot, a head
 * on the stick held by springs; in gravity.
 */
#include <float.h>

#include "mechanics/linear.h"
#include "mechanics/mech.h"
#include "mt_writer.h"

enum { TEXT = 8000, PARTS = 4, MODES = 4 };

static const double TOL = 1e-10;

typedef struct setting {
    const char *name;
    double turn[3]; /* rotation vector of the whole */
    double shift[3];
    double length; /* what is written for one metre */
    double mass;   /* for one kilogram */
    int order[PARTS];
    int hinges; /* how often the pivot is given */
} setting;

static const setting PLAIN = {"plain", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1.0, 1.0, {0, 1, 2, 3},
                              1};

typedef struct writer {
    const setting *s;
    mt_writer out;
} writer;

#define put(w, ...) mt_write(&(w)->out, __VA_ARGS__)

/* Rodrigues. */
static void rotation(const double turn[3], double r[9])
{
    const double angle = sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
    const double unit = angle > 0.0 ? angle : 1.0;
    const double n[3] = {turn[0] / unit, turn[1] / unit, turn[2] / unit};
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        for (int c = 0; c < 3; c++) {
            r[i + 3 * c] = (1.0 - cos(angle)) * n[i] * n[c] + (i == c ? cos(angle) : 0.0);
        }
        r[i + 3 * j] -= n[k] * sin(angle);
        r[i + 3 * k] += n[j] * sin(angle);
    }
}

static void put_vector(writer *w, double x, double y, double z, double scale, bool moved)
{
    const double v[3] = {x, y, z};
    double r[9];
    double out[3];
    rotation(w->s->turn, r);
    for (int i = 0; i < 3; i++) {
        out[i] = moved ? w->s->shift[i] : 0.0;
        for (int c = 0; c < 3; c++) {
            out[i] += r[i + 3 * c] * v[c];
        }
    }
    put(w, "[%.17g, %.17g, %.17g]", scale * out[0], scale * out[1], scale * out[2]);
}

static void put_point(writer *w, const double p[3])
{
    put_vector(w, p[0], p[1], p[2], w->s->length, true);
}

/* R J R^T of a tensor xx yy zz xy xz yz. */
static void put_inertia(writer *w, const double j[6])
{
    static const int PAIR[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    const double full[9] = {j[0], j[3], j[4], j[3], j[1], j[5], j[4], j[5], j[2]};
    double r[9];
    rotation(w->s->turn, r);
    put(w, "[");
    for (int k = 0; k < 6; k++) {
        double sum = 0.0;
        for (int a = 0; a < 3; a++) {
            for (int b = 0; b < 3; b++) {
                sum += r[PAIR[k][0] + 3 * a] * full[a + 3 * b] * r[PAIR[k][1] + 3 * b];
            }
        }
        put(w, "%s%.17g", k == 0 ? "" : ", ", sum * w->s->mass * w->s->length * w->s->length);
    }
    put(w, "]");
}

static const struct {
    const char *name;
    double mass;
    double inertia[6];
    double centre[3];
} BODIES[PARTS] = {
    {"crank", 0.2, {1e-4, 1e-4, 2e-4, 1e-5, 0.0, 0.0}, {0.01, 0.0, 0.005}},
    {"rod", 0.1, {1.2e-4, 2e-4, 3e-4, 2e-5, 0.0, 1e-5}, {0.075, 0.1, 0.06}},
    {"stick", 1.0, {0.01, 0.01, 0.002, 0.0, 1e-3, 0.0}, {0.1, 0.2, 0.35}},
    {"head", 0.5, {1e-3, 2e-3, 1.5e-3, 0.0, 0.0, 2e-4}, {0.11, 0.19, 0.55}},
};

static const struct {
    const char *name;
    const char *type;
    const char *a;
    const char *b;
    double at[3];
    double axis[3];
} JOINTS[PARTS + 1] = {
    {"shaft", "revolute", "ground", "crank", {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}},
    {"port", "spherical", "crank", "rod", {0.05, 0.0, 0.02}, {0.0, 0.0, 0.0}},
    {"starboard", "spherical", "rod", "stick", {0.1, 0.2, 0.1}, {0.0, 0.0, 0.0}},
    {"pivot", "revolute", "ground", "stick", {0.1, 0.2, 0.3}, {3.0, 0.0, 4.0}},
    {"neck", "spherical", "stick", "head", {0.1, 0.2, 0.5}, {0.0, 0.0, 0.0}},
};

static void put_joint(writer *w, int i, int again)
{
    put(w, "%s{ \"name\": \"%s%d\", \"type\": \"%s\", \"bodies\": [\"%s\", \"%s\"], \"at\": ",
        w->out.text[w->out.used - 1] == '[' ? "" : ", ", JOINTS[i].name, again, JOINTS[i].type,
        JOINTS[i].a, JOINTS[i].b);
    put_point(w, JOINTS[i].at);
    if (JOINTS[i].type[0] == 'r') {
        put(w, ", \"axis\": ");
        put_vector(w, JOINTS[i].axis[0], JOINTS[i].axis[1], JOINTS[i].axis[2], 1.0, false);
    }
    put(w, " }");
}

static void put_springs(writer *w)
{
    static const double END[3][2][3] = {
        {{0.16, 0.19, 0.6}, {0.6, 0.2, 0.7}},
        {{0.11, 0.24, 0.6}, {0.0, 0.7, 0.6}},
        {{0.08, 0.15, 0.6}, {0.1, -0.3, 0.4}},
    };
    const double square = w->s->length * w->s->length;
    put(w,
        "], \"springs\": [{ \"name\": \"servo\", \"type\": \"torsion\", \"joint\": \"shaft0\", "
        "\"stiffness_n_m_per_rad\": %.17g }",
        50.0 * w->s->mass * square);
    for (int i = 0; i < 3; i++) {
        put(w,
            ", { \"name\": \"s%d\", \"type\": \"axial\", \"bodies\": [\"head\", \"ground\"], "
            "\"stiffness_n_per_m\": %.17g, \"preload_n\": %.17g, \"at\": [",
            i, (i + 1) * 400.0 * w->s->mass, 3.0 * w->s->mass * w->s->length);
        put_point(w, END[i][0]);
        put(w, ", ");
        put_point(w, END[i][1]);
        put(w, "] }");
    }
}

static mt_model *make(mt_test *t, const setting *s)
{
    static char text[TEXT];
    writer w = {.s = s, .out = {text, sizeof text, 0}};
    put(&w, "{ \"format\": \"modetune-model/1\", \"dimension\": 3, \"gravity_m_per_s2\": ");
    put_vector(&w, 0.0, 0.0, -9.81, s->length, false);
    put(&w, ", \"bodies\": [");
    for (int i = 0; i < PARTS; i++) {
        const int b = s->order[i];
        put(&w,
            "%s{ \"name\": \"%s\", \"mass_kg\": %.17g, \"inertia_kg_m2\": ", i == 0 ? "" : ", ",
            BODIES[b].name, BODIES[b].mass * s->mass);
        put_inertia(&w, BODIES[b].inertia);
        put(&w, ", \"centre\": ");
        put_point(&w, BODIES[b].centre);
        put(&w, " }");
    }
    put(&w, "], \"joints\": [");
    put_joint(&w, 4, 0);
    for (int i = 0; i < PARTS; i++) {
        put_joint(&w, s->order[i], 0);
    }
    for (int i = 1; i < s->hinges; i++) {
        put_joint(&w, 3, i);
    }
    put_springs(&w);
    put(&w, "], \"configurations\": { \"free\": {}, \"locked\": { \"drive\": { \"joint\": "
            "\"shaft0\", \"position_rad\": 0.3, \"hold\": \"lock\" } }, \"trimmed\": { "
            "\"drive\": { \"joint\": \"shaft0\", \"position_rad\": 0.3, \"hold\": { \"trim\": "
            "\"servo\" } } } } }");
    return mech_parse(t, w.out.text);
}

static const setting SETTINGS[] = {
    {"turned", {0.4, -0.9, 1.7}, {0.0, 0.0, 0.0}, 1.0, 1.0, {0, 1, 2, 3}, 1},
    {"turned and moved", {-2.0, 0.5, -0.3}, {3.0, -1.0, 2.0}, 1.0, 1.0, {0, 1, 2, 3}, 1},
    {"reordered", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1.0, 1.0, {3, 1, 0, 2}, 1},
    {"reordered again", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1.0, 1.0, {2, 3, 1, 0}, 1},
    {"pivot doubled", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1.0, 1.0, {0, 1, 2, 3}, 2},
    {"pivot tripled", {0.4, -0.9, 1.7}, {0.0, 0.0, 0.0}, 1.0, 1.0, {3, 1, 0, 2}, 3},
    {"millimetres", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1e3, 1.0, {0, 1, 2, 3}, 1},
    {"grams", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1.0, 1e3, {0, 1, 2, 3}, 1},
    {"inches and slugs", {0.1, 0.2, 0.3}, {1.0, 1.0, 1.0}, 39.37, 0.0685, {0, 1, 2, 3}, 1},
};

/* 1e-10, or what rounding of the highest mode does to a low one: 4 eps n (f_max/f)^2. */
static double tolerance(const mt_modes *m, int pos)
{
    const double ratio = m->lambda[m->count - 1] / m->lambda[pos];
    return fmax(TOL, 4.0 * DBL_EPSILON * m->n * ratio);
}

static void compare(mt_test *t, const mech *plain, const mech *other, int redundant)
{
    const mt_modes *const a = &plain->a->modes;
    const mt_modes *const b = &other->a->modes;
    CHECK_INT(t, b->count, a->count);
    CHECK_INT(t, b->n_rigid, a->n_rigid);
    CHECK_INT(t, a->n_rigid, 1); /* the rod's spin */
    CHECK_INT(t, b->n_unstable, 0);
    CHECK_INT(t, mt_linear_redundant(other->a->lin), redundant);
    for (int i = 1; i <= a->count - a->n_rigid; i++) {
        const double tol = tolerance(a, mt_modal_flexible(a, i));
        CHECK_NEAR(t, mech_hz(other, i), mech_hz(plain, i), tol);
    }
}

static void space__frequencies_do_not_depend_on_how_it_is_written(mt_test *t)
{
    static const char *const configurations[] = {"free", "locked", "trimmed"};
    for (int c = 0; c < MT_COUNT(configurations); c++) {
        mech plain;
        mt_test_row(t, "%s", configurations[c]);
        if (!mech_must(t, make(t, &PLAIN), configurations[c], "", &plain)) {
            mech_free(&plain);
            continue;
        }
        CHECK_INT(t, plain.a->modes.count - plain.a->modes.n_rigid, c == 1 ? MODES - 1 : MODES);
        for (int i = 0; i < MT_COUNT(SETTINGS); i++) {
            mech other;
            mt_test_row(t, "%s, %s", configurations[c], SETTINGS[i].name);
            if (mech_must(t, make(t, &SETTINGS[i]), configurations[c], "", &other)) {
                compare(t, &plain, &other, 5 * (SETTINGS[i].hinges - 1));
            }
            mech_free(&other);
        }
        mech_free(&plain);
    }
}

MT_TEST_MAIN(MT_TEST(space__frequencies_do_not_depend_on_how_it_is_written))
