/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Rigid-body modes that are counted by the mechanism and that its stiffness holds all the same:
 * how many, of matrices alone. What is not above the solver's own error is none.
 */
#include "modal/modal.h"
#include "mt_test.h"

enum { N = 5 };

/* K = Q diag(d) Q, Q = I - 2 u u^T / (u^T u), u = (1, 2, ...). */
static void matrix(const double *d, double *k)
{
    double square = 0.0;
    double q[N][N];
    for (int i = 0; i < N; i++) {
        square += (i + 1.0) * (i + 1.0);
    }
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            q[i][j] = (i == j ? 1.0 : 0.0) - (2.0 * (i + 1.0) * (j + 1.0) / square);
        }
    }
    for (int i = 0; i < N; i++) {
        for (int j = 0; j < N; j++) {
            k[i + ((ptrdiff_t)j * N)] = 0.0;
            for (int r = 0; r < N; r++) {
                k[i + ((ptrdiff_t)j * N)] += q[i][r] * d[r] * q[r][j];
            }
        }
    }
}

static void held__counts_rigid_body_modes_that_stiffness_holds(mt_test *t)
{
    static const struct {
        double d[N];
        int counted;
        int held;
    } rows[] = {
        {{0, 0, 4, 9, 25}, 2, 0}, {{0, 3, 4, 9, 25}, 2, 1},    {{1, 3, 4, 9, 25}, 2, 2},
        {{0, 0, 4, 9, 25}, 1, 0}, {{0, 1e-6, 4, 9, 25}, 2, 1}, {{0, 1e-17, 4, 9, 25}, 2, 0},
        {{0, 0, 0, 9, 25}, 3, 0}, {{0, 0, 1, 9, 25}, 3, 1},    {{0, 2, 1, 9, 25}, 3, 2},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        double k[N * N];
        mt_arena mem = {0};
        mt_mass_factor mass;
        mt_modes modes = {0};
        mt_modal_options opt = mt_modal_options_default();
        matrix(rows[i].d, k);
        opt.n_rigid = rows[i].counted;
        mt_test_row(t, "row %d", i);
        if (CHECK_INT(t, mt_arena_init(&mem, 0, NULL), MT_OK) &&
            CHECK_INT(t, mt_modal_identity_mass(N, &mem, &mass, NULL), MT_OK) &&
            CHECK_INT(t, mt_modal_solve(k, &mass, NULL, &opt, &mem, &modes, NULL), MT_OK)) {
            CHECK_INT(t, modes.n_rigid, rows[i].counted);
            CHECK_INT(t, modes.n_held, rows[i].held);
        }
        mt_arena_free(&mem);
    }
}

MT_TEST_MAIN(MT_TEST(held__counts_rigid_body_modes_that_stiffness_holds))
