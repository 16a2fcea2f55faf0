/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Damped modes of random trees, and of such with loops, from a few undamped ones against those
 * of all: each root within what is said of its error, and no other below the last.
 * MT_STRESS_ROUNDS=N: N times as many.
 */
#include <float.h>
#include <stdlib.h>

#include "analysis/damping.h"
#include "analysis/lowest_damped.h"
#include "mechanics/mech.h"
#include "support/random_tree.h"

enum { ROUNDS = 45, COUNT = 4, WANTED = 12, KINDS = TREE_KINDS + 1 };

/* The dense way's own error, relative to a root. */
static const double DENSE = 1e-11;
/* What each root's error is usually below. */
static const double USUALLY = 1e-10;

/* Below this part of a root its imaginary part is what rounding makes of a repeated real
 * one. */
static const double SPLIT = 1e-6;

/* What rounding makes there of the size of a root that repeats. */
static const double ORDER = 1e-8;

enum { MOST = 4 * TREE_BODIES };

/* Roots of all modes, by size; a real root that repeats, which the dense way splits into a pair
 * that it lists once, is there twice. */
typedef struct reference {
    int n;
    double re[MOST];
    double im[MOST];
} reference;

static void add_root(reference *r, double re, double im)
{
    if (r->n < MOST) {
        r->re[r->n] = re;
        r->im[r->n++] = im;
    }
}

static void read_reference(const mt_damped_modes *d, reference *r)
{
    r->n = 0;
    for (int i = 0; i < d->count; i++) {
        const bool split = d->im[i] > 0.0 && d->im[i] <= SPLIT * fabs(d->re[i]);
        for (int k = 0; k < (split ? 2 : 1); k++) {
            add_root(r, d->re[i], split ? 0.0 : d->im[i]);
        }
    }
}

static double distance(const mt_damped_modes *d, int i, const reference *r, int j)
{
    return hypot(d->re[i] - r->re[j], d->im[i] - r->im[j]);
}

/* As many roots as there are up to the last one of few, each beside one of few. */
static void compare(mt_test *t, const mt_lowest_damped *few, const reference *all)
{
    const mt_damped_modes *const d = &few->modes;
    if (!CHECK(t, d->count <= all->n)) {
        return;
    }
    for (int i = 0; i < d->count; i++) {
        int best = 0; /* roots of about the same size may be listed in another order */
        for (int j = 1; j < all->n; j++) {
            best = distance(d, i, all, j) < distance(d, i, all, best) ? j : best;
        }
        const double size = hypot(d->re[i], d->im[i]);
        const double of = hypot(all->re[i], all->im[i]);
        CHECK(t, distance(d, i, all, best) <= (few->error[i] + DENSE) * size);
        CHECK(t, few->error[i] <= USUALLY);
        CHECK(t, fabs(of - size) <= (few->error[i] + ORDER) * size);
    }
}

static void try_tree(mt_test *t, random_tree *r, char *text)
{
    const mt_lowest_want want = {.count = WANTED, .shapes = true};
    const mt_analysis_options opt = mt_analysis_options_default();
    const mt_damped_modes *all = NULL;
    char why[MT_LOWEST_DAMPED_WHY] = "";
    mt_arena mem = {.first = NULL};
    mt_lowest_damped few;
    mt_lowest *l = NULL;
    reference roots;
    bool is = false;
    mech m;
    mt_writer w = {text, TREE_TEXT, 0};
    random_tree_write(r, &w);
    const bool ok =
        mech_must(t, mech_parse(t, text), "c", "", &m) &&
        CHECK_INT(t, mt_arena_init(&mem, 0, &m.err), MT_OK) &&
        CHECK_INT(t, mt_analysis_solve(m.a, m.at, &opt, &m.err), MT_OK) &&
        CHECK_INT(t, mt_analysis_damped(m.a, &all, &m.err), MT_OK) &&
        CHECK_INT(t, mt_lowest_new(&(mt_system_def){.model = m.model}, want, &l, &m.err),
                  MT_OK) &&
        CHECK_INT(t, mt_lowest_damped_modes(l, COUNT, &mem, &few, &is, why, &m.err), MT_OK) &&
        CHECK(t, is);
    if (ok) {
        CHECK(t, few.enough);
        read_reference(all, &roots);
        compare(t, &few, &roots);
    }
    mt_lowest_delete(l);
    mt_arena_free(&mem);
    mech_free(&m);
}

static void try_all(mt_test *t, bool looped)
{
    const char *const more = getenv("MT_STRESS_ROUNDS");
    const int times = more == NULL ? 1 : (int)strtol(more, NULL, 10);
    char *const text = malloc(TREE_TEXT);
    for (int round = 0; round < times * ROUNDS && text != NULL; round++) {
        const int kind = round % KINDS;
        random_tree r = {.g = mt_random_seed((uint64_t)round + 1),
                         .kind = kind == TREE_KINDS ? TREE_DAMPERS : (tree_damping)kind,
                         .everywhere = kind == TREE_KINDS,
                         .looped = looped};
        r.axes = 2 + mt_random_int(&r.g, 2);
        r.hung = round / KINDS % 4 == 3;
        r.axes = r.hung ? 2 : r.axes;
        r.free = !r.hung && round / KINDS % 4 == 2;
        mt_test_row(t, "%s %d", looped ? "loops" : "tree", round);
        try_tree(t, &r, text);
    }
    free(text);
}

static void lowest_damped__trees_have_the_roots_of_all_modes(mt_test *t)
{
    try_all(t, false);
}

static void lowest_damped__loops_have_them_too(mt_test *t)
{
    try_all(t, true);
}

/*
 * Equal masses m in a row on springs k, one end held, each spring beside a damper b k, each
 * mass on a damper a m:
 *     s^2 + (a + b lambda_j) s + lambda_j = 0,
 *     lambda_j = 4 k/m sin^2((2 j - 1) pi/(4 n + 2)).
 * Written with proportional damping, and with every damper.
 */
enum { MASSES = 300, ROW_TEXT = 300000 };
static const double ROW_MASS = 0.5;
static const double ROW_STIFFNESS = 2000.0;
static const double ROW_A = 0.4;
static const double ROW_B = 2e-2;
/* Errors of closed forms, as parts of a root. */
static const double EXACT = 1e-12;

static void write_row_elements(mt_writer *w, const char *what, const char *value, double by,
                               bool to_ground, bool first)
{
    for (int i = 0; i < MASSES; i++) {
        mt_write(w, "%s{\"name\": \"%s%s%d\", \"type\": \"axial\", \"bodies\": [",
                 i > 0 || !first ? ", " : "", what, to_ground ? "g" : "", i);
        if (i == 0 || to_ground) {
            mt_write(w, "\"ground\", \"b%d\"], \"at\": [[%d, 0], [%d, 0]]", i, i, i + 1);
        } else {
            mt_write(w, "\"b%d\", \"b%d\"]", i - 1, i);
        }
        mt_write(w, ", \"%s\": %.17g}", value, by);
    }
}

static void write_row(mt_writer *w, bool dampers)
{
    mt_write(w, "{\"format\": \"modetune-model/1\", \"name\": \"r\", \"dimension\": 2, "
                "\"bodies\": [");
    for (int i = 0; i < MASSES; i++) {
        mt_write(w,
                 "%s{\"name\": \"b%d\", \"mass_kg\": %.17g, \"inertia_kg_m2\": 1, \"centre\": "
                 "[%d, 0]}",
                 i > 0 ? ", " : "", i, ROW_MASS, i + 1);
    }
    mt_write(w, "], \"joints\": [");
    for (int i = 0; i < MASSES; i++) {
        mt_write(w,
                 "%s{\"name\": \"j%d\", \"type\": \"prismatic\", \"bodies\": [\"ground\", "
                 "\"b%d\"], \"at\": [%d, 0], \"axis\": [1, 0]}",
                 i > 0 ? ", " : "", i, i, i + 1);
    }
    mt_write(w, "], \"springs\": [");
    write_row_elements(w, "s", "stiffness_n_per_m", ROW_STIFFNESS, false, true);
    if (dampers) {
        mt_write(w, "], \"dampers\": [");
        write_row_elements(w, "d", "damping_n_s_per_m", ROW_B * ROW_STIFFNESS, false, true);
        write_row_elements(w, "d", "damping_n_s_per_m", ROW_A * ROW_MASS, true, false);
        mt_write(w, "]");
    } else {
        mt_write(w, "], \"damping\": {\"mass_per_s\": %.17g, \"stiffness_s\": %.17g}", ROW_A,
                 ROW_B);
    }
    mt_write(w, ", \"configurations\": {\"c\": {}}}");
}

static void check_row(mt_test *t, const mt_lowest_damped *few)
{
    for (int j = 0; j < few->modes.count; j++) {
        const double turn = sin((2.0 * j + 1.0) * MECH_PI / (4.0 * MASSES + 2.0));
        const double lambda = 4.0 * ROW_STIFFNESS / ROW_MASS * turn * turn;
        const double half = 0.5 * (ROW_A + (ROW_B * lambda));
        const double im = sqrt(lambda - (half * half));
        const double told = (few->error[j] + EXACT) * sqrt(lambda);
        CHECK_INT(t, few->modes.kind[j], MT_DAMPED_OSCILLATING);
        CHECK(t, fabs(few->modes.re[j] + half) <= told);
        CHECK(t, fabs(few->modes.im[j] - im) <= told);
        CHECK(t, few->error[j] <= USUALLY);
    }
}

static void lowest_damped__rows_of_masses_have_their_closed_form(mt_test *t)
{
    const mt_lowest_want want = {.count = 2 * WANTED, .shapes = true};
    char *const text = malloc(ROW_TEXT);
    for (int dampers = 0; dampers < 2 && text != NULL; dampers++) {
        char why[MT_LOWEST_DAMPED_WHY] = "";
        mt_arena mem = {.first = NULL};
        mt_err err = {.text = ""};
        mt_lowest_damped few = {.shapes = 0};
        mt_lowest *l = NULL;
        bool is = false;
        mt_writer w = {text, ROW_TEXT, 0};
        mt_test_row(t, "%s", dampers ? "dampers" : "proportional");
        write_row(&w, dampers);
        mt_model *const model = mech_parse(t, text);
        const mt_system_def def = {.model = model};
        if (model != NULL && CHECK_INT(t, mt_arena_init(&mem, 0, &err), MT_OK) &&
            CHECK_INT(t, mt_lowest_new(&def, want, &l, &err), MT_OK) &&
            CHECK_INT(t, mt_lowest_damped_modes(l, WANTED, &mem, &few, &is, why, &err),
                      MT_OK) &&
            CHECK(t, is)) {
            CHECK_INT(t, few.modes.count, WANTED);
            CHECK_INT(t, dampers ? 0 : few.shapes, 0);
            check_row(t, &few);
        }
        mt_lowest_delete(l);
        mt_arena_free(&mem);
        mt_model_delete(model);
    }
    free(text);
}

MT_TEST_MAIN(MT_TEST(lowest_damped__trees_have_the_roots_of_all_modes),
             MT_TEST(lowest_damped__loops_have_them_too),
             MT_TEST(lowest_damped__rows_of_masses_have_their_closed_form))
