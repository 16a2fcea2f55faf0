/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>

#include "linalg/dense.h"
#include "modal/chain.h"
#include "modal/modal.h"
#include "support/mt_alloc.h"
#include "support/mt_random.h"
#include "support/mt_test.h"
#include "support/solve_pair.h"

/* Ratios of LAPACK's kind: one is perfect. */
static const double RATIO = 10.0;
/* Closed forms: eigenvalues spread over less than 1e3 here, n eps times that is 4e-13. */
static const double TOL = 1e-12;

static mt_arena mem;

static void check_quality(mt_test *t, const mt_modes *modes)
{
    for (int i = 0; i < modes->count; i++) {
        CHECK(t, modes->residual[i] <= RATIO * t->tol_scale);
        CHECK(t, modes->orthogonality[i] <= RATIO * t->tol_scale);
    }
}

static bool solve(mt_test *t, const chain *s, const mt_modal_options *opt, mt_modes *modes)
{
    mt_err err = {.text = ""};
    return CHECK(t, solve_pair(s->n, s->k, s->m, NULL, opt, &mem, modes, &err) == MT_OK);
}

static void modal__two_masses_on_a_wall_match_closed_form(mt_test *t)
{
    static const struct {
        const char *name;
        double m;
        double k;
    } rows[] = {{"unit", 1.0, 1.0}, {"steel", 7.3, 2.1e11}, {"soft", 1e-3, 1e-9}};
    for (int r = 0; r < MT_COUNT(rows); r++) {
        chain s;
        mt_modes modes;
        mt_test_row(t, "%s", rows[r].name);
        chain_line(&s, 2, rows[r].m, rows[r].k, 1);
        if (solve(t, &s, NULL, &modes)) {
            const double unit = rows[r].k / rows[r].m;
            CHECK_NEAR(t, modes.lambda[0], unit * (3.0 - sqrt(5.0)) / 2.0, TOL);
            CHECK_NEAR(t, modes.lambda[1], unit * (3.0 + sqrt(5.0)) / 2.0, TOL);
            CHECK_INT(t, modes.n_rigid + modes.n_unstable + modes.n_condensed, 0);
            check_quality(t, &modes);
        }
    }
}

static void modal__eight_masses_between_walls_match_closed_form(mt_test *t)
{
    chain s;
    mt_modes modes;
    chain_line(&s, 8, 10.0, 1e5, 2);
    REQUIRE(t, solve(t, &s, NULL, &modes));
    for (int j = 1; j <= 8; j++) {
        const double pi = acos(-1.0);
        mt_test_row(t, "mode %d", j);
        CHECK_INT(t, mt_modal_flexible(&modes, j), j - 1);
        CHECK_NEAR(t, mt_modal_hz(&modes, j - 1), sqrt(1e4) / pi * sin(j * pi / 18.0), TOL);
    }
    CHECK_INT(t, mt_modal_flexible(&modes, 9), -1);
    CHECK_INT(t, mt_modal_flexible(&modes, 0), -1);
    check_quality(t, &modes);
}

static void modal__free_chain_has_one_rigid_body_mode(mt_test *t)
{
    for (int n = 1; n <= CHAIN_MOST; n++) {
        chain s;
        mt_modes modes;
        mt_test_row(t, "n = %d", n);
        chain_line(&s, n, 3.0, 700.0, 0);
        if (!solve(t, &s, NULL, &modes)) {
            continue;
        }
        CHECK_INT(t, modes.n_rigid, 1);
        CHECK_INT(t, modes.kind[0], MT_MODE_RIGID_BODY);
        CHECK_NEAR(t, modes.lambda[0], 0.0, 0.0);
        CHECK_NEAR(t, mt_modal_hz(&modes, 0), 0.0, 0.0);
        for (int j = 1; j < n; j++) {
            const double half = sin(j * acos(-1.0) / (2.0 * n));
            CHECK_NEAR(t, modes.lambda[j], 4.0 * 700.0 / 3.0 * half * half, TOL);
            CHECK_INT(t, mt_modal_flexible(&modes, j), j);
        }
        for (int i = 0; i < n; i++) { /* positive, unit modal mass */
            CHECK_NEAR(t, modes.y[i], 1.0 / sqrt(3.0 * n), TOL);
        }
        check_quality(t, &modes);
    }
}

static void ring(chain *s, int n)
{
    chain_start(s, n, 1.0);
    for (int i = 0; i < n; i++) {
        chain_spring(s, i, (i + 1) % n, 1e4);
    }
}

static void modal__ring_of_six_has_two_pairs(mt_test *t)
{
    static const double want_hz[] = {0.0,           15.9154943092, 15.9154943092,
                                     27.5664447711, 27.5664447711, 31.8309886184};
    static const int cluster[] = {0, 1, 1, 2, 2, 3};
    chain s;
    mt_modes modes;
    ring(&s, 6);
    REQUIRE(t, solve(t, &s, NULL, &modes));
    CHECK_INT(t, modes.n_rigid, 1);
    for (int i = 0; i < 6; i++) {
        int size = 0;
        mt_test_row(t, "mode %d", i);
        /* printed with ten decimals: half a unit of the last */
        CHECK_NEAR_ABS(t, mt_modal_hz(&modes, i), want_hz[i], 5.1e-11);
        CHECK_INT(t, modes.cluster[i], cluster[i]);
        CHECK_INT(t, mt_modal_cluster(&modes, i, &size), i == 2 || i == 4 ? i - 1 : i);
        CHECK_INT(t, size, i >= 1 && i <= 4 ? 2 : 1);
    }
    check_quality(t, &modes);
}

static void modal__kinds_follow_the_sign_and_the_announced_number(mt_test *t)
{
    chain s;
    mt_modes modes;
    mt_modal_options opt = mt_modal_options_default();
    chain_line(&s, 3, 1.0, 100.0, 0);
    s.k[0] -= 30.0; /* a negative spring to ground at an end */
    REQUIRE(t, solve(t, &s, NULL, &modes));
    CHECK_INT(t, modes.n_unstable, 1);
    CHECK_INT(t, modes.kind[0], MT_MODE_UNSTABLE);
    CHECK(t, modes.lambda[0] < -5.0);
    CHECK(t, isnan(mt_modal_hz(&modes, 0)));
    CHECK_INT(t, mt_modal_flexible(&modes, 1), -1);

    mt_test_row(t, "a soft support, announced as rigid");
    chain_line(&s, 3, 1.0, 100.0, 0);
    s.k[0] += 1e-3;
    REQUIRE(t, solve(t, &s, NULL, &modes));
    CHECK_INT(t, modes.n_rigid, 0);
    opt.n_rigid = 1;
    REQUIRE(t, solve(t, &s, &opt, &modes));
    CHECK_INT(t, modes.kind[0], MT_MODE_RIGID_BODY);
    CHECK_NEAR(t, modes.lambda[0], 0.0, 0.0);

    mt_test_row(t, "a free chain, announced as supported");
    chain_line(&s, 3, 1.0, 100.0, 0);
    opt.n_rigid = 0;
    REQUIRE(t, solve(t, &s, &opt, &modes));
    CHECK_INT(t, modes.n_rigid + modes.n_unstable, 0);
    CHECK(t, modes.lambda[0] >= 0.0 && modes.lambda[0] <= modes.error_bound);
    CHECK_INT(t, mt_modal_flexible(&modes, 1), 0);

    mt_test_row(t, "an unstable mode beside an announced rigid one");
    chain_start(&s, 2, 1.0);
    s.k[0] = -1.0;
    opt.n_rigid = 1;
    REQUIRE(t, solve(t, &s, &opt, &modes));
    CHECK_INT(t, modes.kind[0], MT_MODE_UNSTABLE);
    CHECK_INT(t, modes.kind[1], MT_MODE_RIGID_BODY);
    opt.n_rigid = 5;
    REQUIRE(t, solve(t, &s, &opt, &modes));
    CHECK_INT(t, modes.n_rigid, 2);
}

/* Random K, random oblique M: K indefinite, all units mixed. */
static void random_system(mt_random *g, chain *s, int n)
{
    double root[CHAIN_MOST * CHAIN_MOST];
    s->n = n;
    mt_random_fill(g, n * n, s->k);
    mt_random_fill(g, n * n, root);
    mt_gemm(false, true, n, n, n, 1.0, root, n, root, n, 0.0, s->m, n);
    for (int j = 0; j < n; j++) {
        s->m[j + j * n] += 0.1;
        for (int i = 0; i < j; i++) {
            s->k[i + j * n] = nan("");
            s->m[i + j * n] = nan("");
        }
    }
}

static void modal__random_systems_have_small_residuals_and_keep_inputs(mt_test *t)
{
    mt_random g = mt_random_seed(21);
    for (int trial = 0; trial < 100; trial++) {
        chain s;
        mt_modes modes;
        const int n = 1 + mt_random_int(&g, CHAIN_MOST);
        mt_test_row(t, "trial %d, n = %d", trial, n);
        random_system(&g, &s, n);
        const chain before = s;
        if (!solve(t, &s, NULL, &modes)) {
            continue;
        }
        check_quality(t, &modes);
        for (int j = 0; j < n; j++) {
            for (int i = 0; i < n; i++) {
                const ptrdiff_t ij = i + (ptrdiff_t)j * n;
                const bool upper = i < j;
                CHECK(t, upper ? isnan(s.k[ij]) : s.k[ij] == before.k[ij]);
                CHECK(t, upper ? isnan(s.m[ij]) : s.m[ij] == before.m[ij]);
            }
        }
    }
}

/* Other units of rows, K -> S K S, M -> S M S: same eigenvalues, kinds and clusters; without
 * vectors, too. */
static void modal__units_of_rows_do_not_matter(mt_test *t)
{
    mt_random g = mt_random_seed(22);
    for (int trial = 0; trial < 30; trial++) {
        enum { N = 7 };
        chain s;
        chain scaled;
        mt_modes modes;
        mt_modes other;
        mt_modal_options opt = mt_modal_options_default();
        mt_test_row(t, "trial %d", trial);
        random_system(&g, &s, N);
        scaled = s;
        for (int j = 0; j < N; j++) {
            for (int i = j; i < N; i++) {
                const double unit = pow(10.0, 3 * ((i % 4) + (j % 4)) - 9);
                scaled.k[i + j * N] *= unit;
                scaled.m[i + j * N] *= unit;
            }
        }
        opt.vectors = trial % 2 == 0;
        if (!solve(t, &s, NULL, &modes) || !solve(t, &scaled, &opt, &other)) {
            continue;
        }
        for (int i = 0; i < N; i++) {
            CHECK_NEAR_ABS(t, other.lambda[i], modes.lambda[i], modes.error_bound);
            CHECK_INT(t, other.kind[i], modes.kind[i]);
            CHECK_INT(t, other.cluster[i], modes.cluster[i]);
        }
        CHECK(t, (other.y != NULL) == opt.vectors);
        if (opt.vectors) {
            check_quality(t, &other);
        }
    }
}

/* X^T K X with an oblique X: the noise on the zero eigenvalue follows |K_ii| (M^-1)_ii, not the
 * largest eigenvalue; a scale that forgets this calls the rigid-body mode flexible or unstable.
 */
static void modal__rigid_body_modes_stay_rigid_in_oblique_coordinates(mt_test *t)
{
    mt_random g = mt_random_seed(23);
    for (int trial = 0; trial < 500; trial++) {
        chain s;
        mt_modes modes;
        mt_modal_options opt = mt_modal_options_default();
        double x[CHAIN_MOST * CHAIN_MOST] = {0.0};
        const int n = 2 + mt_random_int(&g, CHAIN_MOST - 1);
        mt_test_row(t, "trial %d, n = %d", trial, n);
        chain_line(&s, n, 1.0, 5.0, 0);
        mt_random_fill(&g, n * n, x);
        chain_oblique(&s, x);
        opt.check = false; /* residuals are relative to terms that cancel */
        const mt_arena_mark mark = mt_arena_get_mark(&mem);
        if (solve(t, &s, &opt, &modes)) {
            CHECK_INT(t, modes.n_rigid, 1);
            CHECK_INT(t, modes.n_unstable, 0);
            CHECK_NEAR_ABS(t, modes.lambda[n - 1], 10.0 * (1.0 + cos(acos(-1.0) / n)),
                           modes.error_bound + 10.0 * modes.error_relative);
        }
        mt_arena_rewind(&mem, mark);
    }
}

static void modal__factored_and_identity_masses_give_the_same(mt_test *t)
{
    chain s;
    mt_modes modes;
    mt_modes other;
    mt_mass_factor mass;
    chain_line(&s, 5, 1.0, 10.0, 2);
    REQUIRE(t, solve(t, &s, NULL, &modes));
    REQUIRE(t, mt_modal_factor_mass(5, s.m, &mem, &mass, NULL) == MT_OK);
    CHECK_INT(t, mass.rank, 5);
    CHECK_NEAR(t, mass.condition, 1.0, 1e-15);
    for (int k = 0; k < 2; k++) {
        mt_test_row(t, k == 0 ? "factored" : "identity");
        CHECK_INT(t, mt_modal_solve(s.k, &mass, NULL, NULL, &mem, &other, NULL), MT_OK);
        for (int i = 0; i < 5; i++) {
            CHECK_NEAR(t, other.lambda[i], modes.lambda[i], TOL);
            for (int j = 0; j < 5; j++) {
                CHECK_NEAR_ABS(t, other.y[i + 5 * j], modes.y[i + 5 * j], TOL);
            }
        }
        check_quality(t, &other);
        REQUIRE(t, mt_modal_identity_mass(5, &mem, &mass, NULL) == MT_OK);
    }
}

static void modal__sign_rule_is_stable_under_rounding(mt_test *t)
{
    /* columns: mirror pair of opposite sign with either one larger by rounding, a clear largest
     * entry, zero */
    double phi[12] = {-0.5, 0.1,  0.5 + 1e-12, 0.5 + 1e-12, 0.1, -0.5,
                      0.1,  -0.2, 0.15,        0.0,         0.0, 0.0};
    mt_modal_fix_sign(3, 4, phi);
    CHECK(t, phi[0] > 0.0 && phi[2] < 0.0);
    CHECK(t, phi[3] > 0.0 && phi[5] < 0.0);
    CHECK(t, phi[6] < 0.0 && phi[7] > 0.0);
    CHECK_NEAR(t, phi[9], 0.0, 0.0);
}

static void modal__bad_matrices_are_errors(mt_test *t)
{
    chain s;
    mt_modes modes;
    mt_err err;
    const double bad[2] = {nan(""), HUGE_VAL};
    for (int r = 0; r < 2; r++) {
        mt_test_row(t, "%g", bad[r]);
        chain_line(&s, 3, 1.0, 1.0, 1);
        s.k[1] = bad[r];
        CHECK_INT(t, solve_pair(3, s.k, s.m, NULL, NULL, &mem, &modes, &err), MT_E_DOMAIN);
        CHECK_STR(t, err.text, "stiffness matrix: an entry is not a finite number");
        chain_line(&s, 3, 1.0, 1.0, 1);
        s.m[4] = bad[r];
        CHECK_INT(t, solve_pair(3, s.k, s.m, NULL, NULL, &mem, &modes, &err), MT_E_DOMAIN);
        CHECK_STR(t, err.text, "mass matrix: an entry is not a finite number");
    }
    CHECK_INT(t, solve_pair(0, NULL, NULL, NULL, NULL, &mem, &modes, &err), MT_OK);
    CHECK_INT(t, modes.count, 0);
}

static void modal__repeated_solves_do_not_touch_the_heap(mt_test *t)
{
    chain s;
    mt_modes modes;
    chain_line(&s, 11, 2.0, 5.0, 0);
    chain_factor(&s);
    const mt_stiffness_factor factor = {.rows = s.springs, .b = s.b, .c = s.c};
    mt_modal_options opt = mt_modal_options_default();
    opt.accuracy = MT_MODAL_ACCURACY;
    if (!mt_alloc_works()) {
        CHECK(t, !mt_alloc_works()); /* a sanitizer has the allocator */
        return;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&mem);
    long before = 0;
    for (int i = 0; i < 20; i++) {
        before = i == 1 ? mt_alloc_count() : before; /* the first call may fill the arena */
        REQUIRE(t, solve_pair(11, s.k, s.m, &factor, &opt, &mem, &modes, NULL) == MT_OK);
        CHECK(t, modes.from_factor);
        mt_arena_rewind(&mem, mark);
    }
    CHECK_INT(t, mt_alloc_count() - before, 0);
}

/* Everything that allocates, one after the other. */
static mt_status all_calls(const chain *condensed, const chain *graded, mt_arena *tiny)
{
    mt_modes modes;
    mt_mass_factor mass;
    const mt_stiffness_factor factor = {
        .rows = graded->springs, .b = graded->b, .c = graded->c};
    mt_modal_options opt = mt_modal_options_default();
    opt.accuracy = MT_MODAL_ACCURACY;
    MT_TRY(mt_modal_identity_mass(4, tiny, &mass, NULL));
    MT_TRY(
        solve_pair(condensed->n, condensed->k, condensed->m, NULL, NULL, tiny, &modes, NULL));
    MT_TRY(solve_pair(graded->n, graded->k, graded->m, &factor, &opt, tiny, &modes, NULL));
    opt.vectors = false;
    MT_TRY(solve_pair(graded->n, graded->k, graded->m, NULL, &opt, tiny, &modes, NULL));
    MT_TRY(solve_pair(graded->n, graded->k, graded->m, &factor, NULL, tiny, &modes, NULL));
    const mt_pencil pencil = {.n = graded->n, .k = graded->k, .m = graded->m};
    const mt_directions dir = {.np = 1, .dky = modes.y};
    double dy[CHAIN_MOST];
    double split[1];
    double cos2[1];
    const double *const y = modes.y + (ptrdiff_t)2 * modes.n;
    MT_TRY(mt_modal_dvector_by_modes(&modes, 2, &dir, dy, NULL, tiny, NULL));
    MT_TRY(mt_modal_dvector(&pencil, modes.lambda[2], y, &dir, dy, NULL, tiny, NULL));
    MT_TRY(mt_modal_dcluster(&modes, 2, 1, modes.y, NULL, split, tiny, NULL));
    return mt_mac_subspace(modes.n, 1, modes.y, 1, y, cos2, tiny, NULL);
}

static void modal__every_failing_allocation_is_reported(mt_test *t)
{
    enum { N = 16, BLOCK = 64 }; /* blocks so small that nearly each request needs one */
    chain condensed;
    chain graded;
    chain_line(&condensed, N, 2.0, 5.0, 1);
    condensed.m[0] = 0.0;
    chain_line(&graded, N, 2.0, 5.0, 0);
    chain_factor(&graded);
    mt_status rc = MT_E_MEMORY;
    for (long nth = 0; rc != MT_OK && nth < 1000; nth++) {
        mt_arena tiny;
        mt_test_row(t, "allocation %ld", nth);
        REQUIRE(t, mt_arena_init(&tiny, BLOCK, NULL) == MT_OK);
        mt_alloc_fail_after(mt_alloc_works() ? nth : -1);
        rc = all_calls(&condensed, &graded, &tiny);
        mt_alloc_fail_after(-1);
        mt_arena_free(&tiny);
        CHECK(t, rc == MT_OK || rc == MT_E_MEMORY);
        CHECK(t, !mt_alloc_works() || nth > 10 || rc == MT_E_MEMORY);
    }
    CHECK_INT(t, rc, MT_OK);
}

/* Two masses of 1 kg on springs of 50 and 90 N/m, the first uncertain by 60 and strained, the
 * second by 100 and not: undecided, and a rigid body's, which is at 0 and comes first. */
static void modal__judged_modes_ascend(mt_test *t)
{
    const double k[] = {50.0, 0.0, 0.0, 90.0};
    const double m[] = {1.0, 0.0, 0.0, 1.0};
    double stiffness[] = {50.0, 90.0};
    double mass[] = {1.0, 1.0};
    double stiffness_noise[] = {60.0, 100.0};
    double mass_noise[] = {0.0, 0.0};
    double given_noise[] = {60.0, 100.0};
    bool strained[] = {true, false};
    mt_mode_energies e = {stiffness, mass, stiffness_noise, mass_noise, given_noise, strained,
                          2,         NULL};
    mt_modes modes;
    REQUIRE(t, solve_pair(2, k, m, NULL, NULL, &mem, &modes, NULL) == MT_OK);
    mt_modal_judge(&e, -1, &modes);
    CHECK_INT(t, modes.kind[0], MT_MODE_RIGID_BODY);
    CHECK_INT(t, modes.kind[1], MT_MODE_UNDECIDED);
    CHECK_NEAR_ABS(t, modes.lambda[0], 0.0, 0.0);
    CHECK_NEAR(t, modes.lambda[1], 50.0, TOL);
    CHECK_NEAR_ABS(t, fabs(modes.y[0]), 0.0, TOL);
    CHECK_NEAR_ABS(t, fabs(modes.y[1]), 1.0, TOL);
}

/* Quotients are taken of the lowest modes, as many as there are energies of; the others stand
 * as they are. */
static void modal__modes_without_doubt_are_not_judged(mt_test *t)
{
    const double k[] = {1e-3, 0.0, 0.0, 0.0, 9e9, 0.0, 0.0, 0.0, 1e12};
    const double m[] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    double stiffness[] = {2e-3, nan(""), nan("")};
    double mass[] = {1.0, nan(""), nan("")};
    double stiffness_noise[] = {0.0, nan(""), nan("")};
    double mass_noise[] = {0.0, nan(""), nan("")};
    double given_noise[] = {0.0, nan(""), nan("")};
    bool strained[] = {true, false, false};
    mt_mode_energies e = {stiffness, mass, stiffness_noise, mass_noise, given_noise, strained,
                          0,         NULL};
    mt_modal_options opt = mt_modal_options_default();
    mt_modes modes;
    opt.n_rigid = 0;
    REQUIRE(t, solve_pair(3, k, m, NULL, &opt, &mem, &modes, NULL) == MT_OK);
    const double error = modes.error[1];
    e.count = mt_modal_doubtful(&modes);
    CHECK_INT(t, e.count, 1);
    mt_modal_judge(&e, 0, &modes);
    CHECK_NEAR(t, modes.lambda[0], 2e-3, TOL);
    CHECK_NEAR(t, modes.lambda[1], 9e9, TOL);
    CHECK_NEAR(t, modes.lambda[2], 1e12, TOL);
    CHECK_NEAR(t, modes.error[1], error, TOL);
    CHECK_INT(t, mt_modal_flexible(&modes, 3), 2);
}

/* Of two equal modes rounding may have turned the shapes: their quotients are eigenvalues up to
 * what couples the shapes, here given, and to the gap that the two have to the third. */
static void modal__equal_modes_are_known_to_their_coupling(mt_test *t)
{
    static const double couplings[] = {0.0, 1e-5, -1e-5, 1e-2};
    static const double KNOWN = 1e-3;
    const double k[] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 100.0};
    const double m[] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    for (int r = 0; r < MT_COUNT(couplings); r++) {
        const double c = couplings[r];
        double stiffness[] = {1.0, 1.0, 100.0, 1.0 + c};
        double mass[] = {1.0, 1.0, 1.0, 1.0};
        double none[] = {0.0, 0.0, 0.0, 0.0};
        bool strained[] = {true, true, true, true};
        double sum[3];
        int group[3];
        mt_modes modes;
        mt_test_row(t, "coupled by %g", c);
        REQUIRE(t, solve_pair(3, k, m, NULL, NULL, &mem, &modes, NULL) == MT_OK);
        modes.error[0] = KNOWN;
        modes.error[1] = KNOWN;
        CHECK_INT(t, mt_modal_groups(&modes, 3, group), 1);
        CHECK(t, group[0] == 0 && group[1] == 0 && group[2] == 2);
        mt_modal_pair_shapes(&modes, 3, group, sum);
        CHECK_NEAR(t, mt_dot(3, sum, sum), 1.0, TOL);
        CHECK_NEAR(t, fabs(sum[0] * sum[1]), 0.5, TOL);
        mt_mode_energies e = {stiffness, mass, none, none, none, strained, 3, group};
        mt_modal_judge(&e, -1, &modes);
        for (int i = 0; i < 2; i++) {
            const double beside = 2.0 * KNOWN * KNOWN / (99.0 - KNOWN);
            const double want = fabs(c) < KNOWN ? fabs(c) + beside : KNOWN;
            CHECK_NEAR(t, modes.error[i], want, 1e-6);
            CHECK_NEAR(t, modes.lambda[i], 1.0, TOL);
        }
    }
}

/* A spring that has become 0 leaves a mode at 0 Hz with no error at all, where rigid-body modes
 * were counted with the spring: whether it is strained is a question of energies. */
static int doubtful(double second, double error_of_third)
{
    double lambda[] = {0.0, second, 4.0};
    double error[] = {0.0, 0.0, error_of_third};
    mt_mode_kind kind[] = {MT_MODE_RIGID_BODY, MT_MODE_FLEXIBLE, MT_MODE_FLEXIBLE};
    const mt_modes modes = {.count = 3, .lambda = lambda, .error = error, .kind = kind};
    return mt_modal_doubtful(&modes);
}

static void modal__modes_at_zero_are_in_doubt(mt_test *t)
{
    CHECK_INT(t, doubtful(0.0, 1e-12), 2);
    CHECK_INT(t, doubtful(1.0, 1e-12), 1);
    CHECK_INT(t, doubtful(1.0, nan("")), 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        MT_TEST(modal__two_masses_on_a_wall_match_closed_form),
        MT_TEST(modal__eight_masses_between_walls_match_closed_form),
        MT_TEST(modal__free_chain_has_one_rigid_body_mode),
        MT_TEST(modal__ring_of_six_has_two_pairs),
        MT_TEST(modal__kinds_follow_the_sign_and_the_announced_number),
        MT_TEST(modal__random_systems_have_small_residuals_and_keep_inputs),
        MT_TEST(modal__units_of_rows_do_not_matter),
        MT_TEST(modal__rigid_body_modes_stay_rigid_in_oblique_coordinates),
        MT_TEST(modal__factored_and_identity_masses_give_the_same),
        MT_TEST(modal__sign_rule_is_stable_under_rounding),
        MT_TEST(modal__judged_modes_ascend),
        MT_TEST(modal__modes_without_doubt_are_not_judged),
        MT_TEST(modal__equal_modes_are_known_to_their_coupling),
        MT_TEST(modal__modes_at_zero_are_in_doubt),
        MT_TEST(modal__bad_matrices_are_errors),
        MT_TEST(modal__repeated_solves_do_not_touch_the_heap),
        MT_TEST(modal__every_failing_allocation_is_reported),
    };
    const int failed = mt_arena_init(&mem, 0, NULL) != MT_OK
                           ? 1
                           : cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL);
    mt_arena_free(&mem);
    return failed != 0;
}
