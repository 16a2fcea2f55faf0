/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Stiffnesses far apart with a load on top, K = B^T diag(c) B + G, against thirty digits: what
 * is asked for is n eps (|lambda| + |G|) with a moderate factor, however large c is.
 */
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "modal/modal.h"
#include "support/mt_quad.h"
#include "support/mt_random.h"
#include "support/mt_test.h"

enum { MOST = 10, ROWS = 16 };

/* Of |lambda| + |G|. */
static const double WANTED = 1e-12;

static mt_arena mem;

typedef struct loaded {
    int n;
    int rows;
    double b[ROWS * MOST];
    double c[ROWS];
    double g[MOST * MOST];
    double k[MOST * MOST];
    double g_size;
    mt_quad_pencil exact;
} loaded;

typedef enum load_kind { LIFTS, PULLS, NEITHER } load_kind;

/* K as it is assembled, in lower triangles; what must not be read is NaN. */
static void round_off(loaded *s)
{
    for (int j = 0; j < s->n; j++) {
        double sum = 0.0;
        for (int i = 0; i < s->n; i++) {
            const double nothing = nan("");
            sum += fabs(s->g[i + j * s->n]);
            s->k[i + j * s->n] = i < j ? nothing : (double)s->exact.k[i][i - j];
        }
        s->g_size = fmax(s->g_size, sum);
    }
    for (int j = 0; j < s->n; j++) {
        for (int i = 0; i < j; i++) {
            s->g[i + j * s->n] = nan("");
        }
    }
}

/* Small integers: rows of B, G and masses have no rounding of their own. */
static void draw(mt_random *r, load_kind kind, double decades, loaded *s)
{
    memset(s, 0, sizeof *s);
    s->n = 3 + mt_random_int(r, MOST - 3);
    s->rows = 1 + mt_random_int(r, s->n + 3);
    s->exact.n = s->n;
    s->exact.band = s->n - 1;
    int at[MOST];
    mt_quad f[MOST];
    for (int i = 0; i < s->n; i++) {
        at[i] = i;
        s->exact.m[i][0] = 1;
    }
    for (int t = 0; t < s->rows; t++) {
        s->c[t] = pow(10.0, mt_random_in(r, 0.0, decades));
        for (int i = 0; i < s->n; i++) {
            s->b[t + i * s->rows] = (double)mt_random_int(r, 7) - 3.0;
            f[i] = (mt_quad)s->b[t + i * s->rows];
        }
        mt_quad_add(s->exact.k, (mt_quad)s->c[t], s->n, at, f);
    }
    for (int t = 0; t < 2 * s->n; t++) {
        double c = kind == PULLS ? -1.0 : 1.0;
        c = kind == NEITHER && t % 2 == 0 ? -1.0 : c;
        for (int i = 0; i < s->n; i++) {
            f[i] = (mt_quad)((double)mt_random_int(r, 5) - 2.0);
        }
        mt_quad_add(s->exact.k, (mt_quad)c, s->n, at, f);
        for (int i = 0; i < s->n; i++) {
            for (int j = 0; j < s->n; j++) {
                s->g[i + j * s->n] += c * (double)f[i] * (double)f[j];
            }
        }
    }
    round_off(s);
}

static void compare(mt_test *t, loaded *s)
{
    const mt_stiffness_factor factor = {.rows = s->rows, .b = s->b, .c = s->c, .g = s->g};
    mt_modal_options opt = mt_modal_options_default();
    mt_mass_factor mass;
    mt_modes modes;
    opt.accuracy = MT_MODAL_ACCURACY;
    if (!CHECK(t, mt_modal_identity_mass(s->n, &mem, &mass, NULL) == MT_OK) ||
        !CHECK(t, mt_modal_solve(s->k, &mass, &factor, &opt, &mem, &modes, NULL) == MT_OK)) {
        return;
    }
    for (int i = 0; i < s->n; i++) {
        const double want = (double)mt_quad_eigenvalue(&s->exact, i);
        const double size = modes.from_factor ? s->g_size : modes.scale;
        CHECK_NEAR_ABS(t, modes.lambda[i], want, WANTED * (fabs(want) + size));
        CHECK_NEAR_ABS(t, modes.lambda[i], want, modes.error[i]);
    }
}

static void family(mt_test *t, load_kind kind, const char *name)
{
    static loaded s;
    for (int k = 0; k < 60; k++) {
        mt_random r = mt_random_seed((uint64_t)k + 1);
        const double decades = 3.0 + (double)(k % 6) * 3.0;
        mt_test_row(t, "%s, draw %d, %g decades", name, k, decades);
        draw(&r, kind, decades, &s);
        const mt_arena_mark mark = mt_arena_get_mark(&mem);
        compare(t, &s);
        mt_arena_rewind(&mem, mark);
    }
}

static void loaded__loads_that_stiffen_cost_no_digits(mt_test *t)
{
    family(t, LIFTS, "stiffening");
}

static void loaded__loads_that_soften_cost_no_digits(mt_test *t)
{
    family(t, PULLS, "softening");
}

static void loaded__loads_of_both_kinds_cost_no_digits(mt_test *t)
{
    family(t, NEITHER, "both");
}

/* Two masses on springs 1e12 and 1, a load of -1 on the soft one: lambda is exactly 0, and the
 * spring strained. Energies that say so leave it undecided; the same without strain is free. */
static void loaded__strained_zero_is_undecided(mt_test *t)
{
    for (int strained = 0; strained < 2; strained++) {
        double zero[2] = {0.0, 1e12};
        double one[2] = {1.0, 1.0};
        double stiffness_noise[2] = {1e-15, 1e-3};
        double mass_noise[2] = {0.0, 0.0};
        double given_noise[2] = {1e-15, 0.0};
        bool moves[2] = {strained == 1, true};
        mt_mode_energies e = {.stiffness = zero,
                              .mass = one,
                              .stiffness_noise = stiffness_noise,
                              .mass_noise = mass_noise,
                              .given_noise = given_noise,
                              .strained = moves,
                              .count = 2};
        const double k[4] = {0.0, 0.0, nan(""), 1e12};
        mt_modes modes;
        mt_mass_factor mass;
        mt_test_row(t, "strained: %d", strained);
        REQUIRE(t, mt_modal_identity_mass(2, &mem, &mass, NULL) == MT_OK);
        REQUIRE(t, mt_modal_solve(k, &mass, NULL, NULL, &mem, &modes, NULL) == MT_OK);
        CHECK(t, mt_modal_doubtful(&modes) > 0);
        mt_modal_judge(&e, -1, &modes);
        CHECK_INT(t, modes.kind[0], strained ? MT_MODE_UNDECIDED : MT_MODE_RIGID_BODY);
        CHECK_INT(t, modes.n_undecided, strained);
        CHECK_INT(t, modes.n_rigid, 1 - strained);
        CHECK_INT(t, mt_modal_indexed(&modes), !strained);
        CHECK_INT(t, mt_modal_flexible(&modes, 1), strained ? -1 : 1);
        CHECK(t, isnan(mt_modal_hz(&modes, 0)) == (strained == 1));
        CHECK(t, modes.error[0] < 1e-6);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(loaded__loads_that_stiffen_cost_no_digits),
        MT_TEST(loaded__loads_that_soften_cost_no_digits),
        MT_TEST(loaded__loads_of_both_kinds_cost_no_digits),
        MT_TEST(loaded__strained_zero_is_undecided),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
