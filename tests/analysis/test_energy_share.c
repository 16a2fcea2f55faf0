/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shares of a mode's energy: closed forms, sums, slopes by order, modes of one frequency. */
#include <float.h>

#include "analysis/energy_share.h"
#include "mechanics/mech.h"
#include "support/mt_alloc.h"
#include "support/mt_slope.h"

static const double TOL = 1e-12;
/* A share is a product of entries of a shape: some n eps over the gap of the mode. */
static const double NOISE = 1e-12;
static const double STEP = 1e-3; /* of each input's value */

static bool solve(mech *s, const double *x, bool gradient)
{
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = gradient;
    return mt_analysis_solve(s->a, x, &opt, &s->err) == MT_OK;
}

/* One part of the energies of a mechanism. */
typedef struct asked {
    const char *name;
    mt_energy_kind kind;
    int direction;
    mt_energy_about about;
} asked;

static bool part_of(mech *s, const asked *q, mt_arena *mem, mt_energy_part *out)
{
    mt_energy_owners all;
    if (mt_energy_owners_find(s->a->sys, mem, &all, &s->err) != MT_OK) {
        return false;
    }
    const bool moves = q->kind == MT_ENERGY_MOTION;
    const mt_energy_owner *const list = moves ? all.bodies : all.springs;
    const int at = q->name == NULL ? 0
                                   : mt_energy_owner_named(moves ? all.n_bodies : all.n_springs,
                                                           list, q->name);
    return at >= 0 &&
           mt_energy_part_init(s->a->sys, q->kind, q->name == NULL ? NULL : &list[at],
                               q->direction, &q->about, mem, out, &s->err) == MT_OK;
}

/* Share of vibration mode `index` of the last solve; NaN where there is none. */
static double share_of(mech *s, const asked *q, int index, double *slope)
{
    mt_arena mem;
    mt_energy_part part;
    double share = nan("");
    if (mt_arena_init(&mem, 0, &s->err) != MT_OK) {
        return share;
    }
    const int pos = mt_modal_flexible(&s->a->modes, index);
    if (pos < 0 || !part_of(s, q, &mem, &part) ||
        mt_analysis_energy_share(s->a, pos, &part, &share, slope, &s->err) != MT_OK) {
        share = nan("");
    }
    mt_arena_free(&mem);
    return share;
}

#define CENTRE             \
    {                      \
        .point = MT_ABSENT \
    }
#define MOVES(body, k)                        \
    {                                         \
        (body), MT_ENERGY_MOTION, (k), CENTRE \
    }
#define STRAINS(spring)                               \
    {                                                 \
        (spring), MT_ENERGY_STRAIN, MT_ABSENT, CENTRE \
    }

/*
 * Masses m and 3 m on a line: ground - k - m - k - 3 m. With x = lambda m / k,
 *     3 x^2 - 7 x + 1 ... of (2 - x)(1 - 3 x) = 1:   x = (7 -+ sqrt 37) / 6,
 *     u = (1, 2 - x),   kinetic 1 : 3 (2 - x)^2,   strain 1 : (1 - x)^2.
 */
static void energy__two_masses_have_their_closed_form(mt_test *t)
{
    static const char *const model =
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"parameters\": {\"m\": 2,"
        " \"k\": 50}, \"bodies\": [{\"name\": \"a\", \"mass_kg\": \"m\", \"centre\": [0, 0]},"
        " {\"name\": \"b\", \"mass_kg\": \"3*m\", \"centre\": [1, 0]}], \"joints\": [{\"name\":"
        " \"ja\", \"type\": \"pin-in-slot\", \"bodies\": [\"ground\", \"a\"], \"at\": [0, 0],"
        " \"axis\": [1, 0]}, {\"name\": \"jb\", \"type\": \"pin-in-slot\", \"bodies\":"
        " [\"ground\", \"b\"], \"at\": [1, 0], \"axis\": [1, 0]}], \"springs\": [{\"name\":"
        " \"s\", \"type\": \"axial\", \"joint\": \"ja\", \"stiffness_n_per_m\": \"k\"},"
        " {\"name\": \"r\", \"type\": \"axial\", \"bodies\": [\"a\", \"b\"], \"at\": [[0, 0],"
        " [1, 0]], \"stiffness_n_per_m\": \"k\"}]}";
    static const asked a = MOVES("a", 0);
    static const asked b = MOVES("b", 0);
    static const asked across = MOVES("b", 1);
    static const asked s = STRAINS("s");
    static const asked r = STRAINS("r");
    mech m;
    if (mech_must(t, mech_parse(t, model), NULL, "", &m) && CHECK(t, solve(&m, m.at, false))) {
        for (int i = 1; i <= 2; i++) {
            const double x = (7.0 + (i == 1 ? -1.0 : 1.0) * sqrt(37.0)) / 6.0;
            const double moves = 1.0 / (1.0 + (3.0 * (2.0 - x) * (2.0 - x)));
            const double strains = 1.0 / (1.0 + ((1.0 - x) * (1.0 - x)));
            CHECK_NEAR(t, share_of(&m, &a, i, NULL), moves, TOL);
            CHECK_NEAR(t, share_of(&m, &b, i, NULL), 1.0 - moves, TOL);
            CHECK_NEAR_ABS(t, share_of(&m, &across, i, NULL), 0.0, TOL);
            CHECK_NEAR(t, share_of(&m, &s, i, NULL), strains, TOL);
            CHECK_NEAR(t, share_of(&m, &r, i, NULL), 1.0 - strains, TOL);
        }
    }
    mech_free(&m);
}

/* A body in space on one bushing: numbers of its inertia, its arm and its stiffness. */
#define ENGINE(inertia, at, stiffness)                                                         \
    "{\"format\": \"modetune-model/1\", \"dimension\": 3, \"parameters\": {\"m\": 180,"        \
    " \"j\": 6, \"p\": 0.9, \"k\": 2e5, \"c\": 3e4, \"d\": 0.05}, \"points\": {\"head\":"      \
    " [\"3*d\", 0.02, \"4*d\"]}, \"bodies\": [{\"name\": \"engine\", \"mass_kg\": \"m\","      \
    " \"inertia_kg_m2\": " inertia ", \"centre\": [0.1, 0, \"d\"]}], \"springs\": [{\"name\":" \
    " \"mount\", \"type\": \"bushing\", \"bodies\": [\"ground\", \"engine\"], \"at\": " at     \
    ", " stiffness "}]}"
#define DIAGONAL                                                                           \
    "\"stiffness_n_per_m\": [\"k\", \"2*k\", \"3*k\"], \"stiffness_n_m_per_rad\": [\"c\"," \
    " \"2.6*c\", \"3*c\"]"
#define COUPLED                                                                          \
    "\"stiffness_matrix\": [[\"k\", 1e4, 0, 500, 0, 0], [1e4, \"2*k\", 2e4, 0, 0, 900]," \
    " [0, 2e4, \"3*k\", 0, 0, 0], [500, 0, 0, \"c\", 0, 0], [0, 0, 0, 0, \"2*c\", 4e3]," \
    " [0, 900, 0, 0, 4e3, \"3*c\"]]"

/* K and M diagonal: each mode has all of one direction, and of one component of the mount. */
static void energy__decoupled_modes_have_all_of_one_direction(mt_test *t)
{
    mech m;
    if (mech_must(
            t,
            mech_parse(t, ENGINE("[\"j\", \"2*j\", \"2.5*j\"]", "[0.1, 0, \"d\"]", DIAGONAL)),
            NULL, "", &m) &&
        CHECK(t, solve(&m, m.at, false))) {
        for (int i = 1; i <= MT_ENERGY_DIRECTIONS; i++) {
            int whole = 0;
            for (int k = 0; k < MT_ENERGY_DIRECTIONS; k++) {
                const asked moves = MOVES("engine", k);
                const asked strains = {"mount", MT_ENERGY_STRAIN, k, CENTRE};
                const double share = share_of(&m, &moves, i, NULL);
                whole += share > 0.5 ? 1 : 0;
                CHECK_NEAR_ABS(t, share, share > 0.5 ? 1.0 : 0.0, TOL);
                CHECK_NEAR_ABS(t, share_of(&m, &strains, i, NULL), share, TOL);
            }
            CHECK_INT(t, whole, 1);
        }
    }
    mech_free(&m);
}

/* Kinetic and strain energies of every mode sum to one, whatever the point and the axes: of
 * links, gears, rods with mass, bushings, loaded and driven mechanisms. */
static void energy__shares_sum_to_one(mt_test *t)
{
    static const char *const files[] = {"damped_linkage", "space_frame",    "loaded_frame",
                                        "four_bar",       "rods",           "space_couplings",
                                        "couplings",      "space_stick",    "space_shear",
                                        "eight_masses",   "space_four_bar", "taut_string"};
    int sums = 0;
    for (int f = 0; f < MT_COUNT(files); f++) {
        mech m;
        mt_arena mem;
        mt_energy_owners all;
        if (!mech_must(t, mech_load(t, files[f]), NULL, "", &m) ||
            !CHECK(t, mt_arena_init(&mem, 0, &m.err) == MT_OK)) {
            mech_free(&m);
            continue;
        }
        CHECK(t, solve(&m, m.at, false));
        CHECK(t, mt_energy_owners_find(m.a->sys, &mem, &all, &m.err) == MT_OK);
        for (int axes = 0; axes < MT_ENERGY_AXES_COUNT; axes++) {
            const mt_energy_about about = {
                .point = axes > 0 && m.model->n_points > 0 ? 0 : MT_ABSENT,
                .axes = (mt_energy_axes)axes};
            for (int i = 0; i < m.a->modes.count; i++) {
                mt_energy_shares e;
                mt_test_row(t, "%s, axes %s, mode %d", files[f], mt_energy_axes_names[axes], i);
                CHECK(t, mt_analysis_energy_shares(m.a, i, &all, &about, &mem, &e, &m.err) ==
                             MT_OK);
                CHECK_NEAR(t, e.motion_sum, e.modes, 1e-11);
                if (m.a->modes.kind[i] == MT_MODE_FLEXIBLE) {
                    CHECK_NEAR(t, e.strain_sum, e.modes, 1e-8);
                    sums++;
                }
            }
        }
        mt_arena_free(&mem);
        mech_free(&m);
    }
    CHECK(t, sums > 300);
}

/* Slopes */

typedef struct probe {
    mech *s;
    const asked *q;
    int mode;
} probe;

static double probed(const void *ctx, int n, const double *x)
{
    const probe *const p = ctx;
    (void)n;
    return solve(p->s, x, false) ? share_of(p->s, p->q, p->mode, NULL) : nan("");
}

static void check_slopes(mt_test *t, mech *s, const char *name, const asked *q, int modes)
{
    double slope[MECH_INPUTS];
    double x[MECH_INPUTS];
    memcpy(x, s->at, sizeof x);
    for (int mode = 1; mode <= modes; mode++) {
        for (int i = 0; i < s->n; i++) {
            const probe p = {s, q, mode};
            CHECK(t, solve(s, x, true));
            mt_test_row(t, "%s, %s, direction %d, mode %d, input %d", name, q->name,
                        q->direction, mode, i);
            CHECK(t, MT_HAS(share_of(s, q, mode, slope)));
            CHECK(t, mt_slope_agrees(probed, &p, s->n, x, i, slope[i],
                                     STEP * (x[i] == 0.0 ? 1.0 : fabs(x[i])), NOISE));
        }
    }
}

/* Mass, moments, products, stiffness and places of a coupled engine; about its centre and a
 * point, along global, principal and torque roll axes. */
static void energy__shares_of_an_engine_have_exact_slopes(mt_test *t)
{
    static const asked rows[] = {
        MOVES("engine", 0),
        MOVES("engine", 3),
        {"engine", MT_ENERGY_MOTION, 4, {.point = 0}},
        {"engine", MT_ENERGY_MOTION, 0, {.point = 0, .axes = MT_ENERGY_AXES_PRINCIPAL}},
        {"engine", MT_ENERGY_MOTION, 5, {.point = MT_ABSENT, .axes = MT_ENERGY_AXES_PRINCIPAL}},
        {"engine", MT_ENERGY_MOTION, 3, {.point = 0, .axes = MT_ENERGY_AXES_TORQUE_ROLL_X}},
        {"engine",
         MT_ENERGY_MOTION,
         5,
         {.point = MT_ABSENT, .axes = MT_ENERGY_AXES_TORQUE_ROLL_Z}},
        {"mount", MT_ENERGY_STRAIN, 1, CENTRE},
        {"mount", MT_ENERGY_STRAIN, 5, CENTRE}};
    mech m;
    if (mech_must(t,
                  mech_parse(t, ENGINE("[\"j\", \"2*j\", \"2.5*j\", \"p\", \"-p/2\", 0.3]",
                                       "[0, 0.1, \"-d\"]", COUPLED)),
                  NULL, "m j p k c d", &m)) {
        for (int i = 0; i < MT_COUNT(rows); i++) {
            check_slopes(t, &m, "engine", &rows[i], 6);
        }
    }
    mech_free(&m);
}

/* Moments of inertia along axes of the body's own, which turn with an input. */
static void energy__axes_of_a_body_may_turn_with_inputs(mt_test *t)
{
    static const asked rows[] = {
        {"engine", MT_ENERGY_MOTION, 3, {.point = 0, .axes = MT_ENERGY_AXES_PRINCIPAL}},
        {"engine",
         MT_ENERGY_MOTION,
         4,
         {.point = MT_ABSENT, .axes = MT_ENERGY_AXES_TORQUE_ROLL_Y}},
        MOVES("engine", 5)};
    mech m;
    if (mech_must(t,
                  mech_parse(t, ENGINE("[\"j\", \"2*j\", \"2.5*j\", \"p\", \"-p/2\", 0.3],"
                                       " \"axes\": {\"angles_rad\": [\"4*d\", 0.2, \"j/20\"]}",
                                       "[0, 0.1, \"-d\"]", COUPLED)),
                  NULL, "j p d", &m)) {
        for (int i = 0; i < MT_COUNT(rows); i++) {
            check_slopes(t, &m, "turned", &rows[i], 3);
        }
    }
    mech_free(&m);
}

/* Loops that close elsewhere, gravity, a driven position, turning axes. */
static void energy__shares_of_a_linkage_have_exact_slopes(mt_test *t)
{
    static const char *const names[] = {"all", "driven"};
    for (int c = 0; c < MT_COUNT(names); c++) {
        mech s;
        if (mech_must(t, mech_load(t, "damped_linkage"), names[c], "a k m_c alpha lag", &s)) {
            const mt_energy_about at = {.point = s.model->n_points > 0 ? 0 : MT_ABSENT};
            const asked rows[] = {
                {s.model->bodies[0].name.s, MT_ENERGY_MOTION, 5, at},
                {s.model->bodies[s.model->n_bodies - 1].name.s, MT_ENERGY_MOTION, 0, at},
                STRAINS(s.model->springs[0].name.s),
                {NULL, MT_ENERGY_LOADS, MT_ABSENT, CENTRE}};
            for (int i = 0; i < MT_COUNT(rows); i++) {
                check_slopes(t, &s, names[c], &rows[i], 2);
            }
        }
        mech_free(&s);
    }
}

/* Many inputs that act through the forces at rest; directions without mass, where the modes are
 * fewer than the freedoms. */
static void energy__shares_under_load_and_without_mass_have_exact_slopes(mt_test *t)
{
    static const struct {
        const char *file;
        const char *configuration;
        const char *inputs;
        asked q;
        int modes;
    } rows[] = {
        {"loaded_frame", "loaded", "E h x P g rho k", MOVES("beam", 1), 2},
        {"loaded_frame", "loaded", "E h x P g rho k", STRAINS("post"), 2},
        {"loaded_frame", "loaded", "E h P", {NULL, MT_ENERGY_LOADS, MT_ABSENT, CENTRE}, 2},
        {"massless", "sprung", "m k1 k2", STRAINS("s1"), 1},
        {"space_stick", "geared", "k tilt l m ratio kb", MOVES("plate", MT_ABSENT), 2},
        {"space_stick", "geared", "k tilt l m ratio kb", STRAINS("mount"), 2},
    };
    for (int r = 0; r < MT_COUNT(rows); r++) {
        mech s;
        if (mech_must(t, mech_load(t, rows[r].file), rows[r].configuration, rows[r].inputs,
                      &s)) {
            check_slopes(t, &s, rows[r].file, &rows[r].q, rows[r].modes);
        }
        mech_free(&s);
    }
}

/* Modes of one frequency */

/* Two bodies that do not turn, on bushings that are as stiff along x as along y where e is
 * 0. */
static const char *const ISOTROPIC =
    "{\"format\": \"modetune-model/1\", \"dimension\": 3, \"parameters\": {\"m\": 2, \"k\": 50,"
    " \"e\": 0}, \"bodies\": [{\"name\": \"a\", \"mass_kg\": \"m\", \"inertia_kg_m2\": [1, 1, "
    "1],"
    " \"centre\": [0, 0, 0]}, {\"name\": \"b\", \"mass_kg\": 3, \"inertia_kg_m2\": [1, 1, 1],"
    " \"centre\": [0, 0, 0]}], \"joints\": [{\"name\": \"ja\", \"type\": \"orientation\","
    " \"bodies\": [\"ground\", \"a\"]}, {\"name\": \"jb\", \"type\": \"orientation\", "
    "\"bodies\":"
    " [\"ground\", \"b\"]}], \"springs\": [{\"name\": \"s\", \"type\": \"bushing\", \"bodies\":"
    " [\"ground\", \"a\"], \"at\": [0, 0, 0], \"stiffness_matrix\": [[\"k + e\", \"e\", 0, 0, "
    "0,"
    " 0], [\"e\", \"k\", 0, 0, 0, 0], [0, 0, 9e3, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0,"
    " 0], [0, 0, 0, 0, 0, 0]]}, {\"name\": \"r\", \"type\": \"bushing\", \"bodies\": [\"a\","
    " \"b\"], \"at\": [0, 0, 0], \"stiffness_n_per_m\": [70, 70, 9e3],"
    " \"stiffness_n_m_per_rad\": [0, 0, 0]}]}";

/* The sum over two modes, of one frequency or of two. */
static double both(const void *ctx, int n, const double *x)
{
    const probe *const p = ctx;
    double share = nan("");
    int size = 0;
    (void)n;
    if (solve(p->s, x, false)) {
        (void)mt_modal_cluster(&p->s->a->modes, p->mode - 1, &size);
        share = share_of(p->s, p->q, p->mode, NULL);
        share += size == 2 ? 0.0 : share_of(p->s, p->q, p->mode + 1, NULL);
    }
    return share;
}

static void energy__modes_of_one_frequency_share_together(mt_test *t)
{
    static const asked rows[] = {MOVES("a", 0),
                                 MOVES("a", MT_ABSENT),
                                 MOVES("b", 1),
                                 STRAINS("s"),
                                 {"r", MT_ENERGY_STRAIN, 0, CENTRE}};
    mech m;
    if (mech_must(t, mech_parse(t, ISOTROPIC), NULL, "m k e", &m) &&
        CHECK_INT(t, m.a->modes.count, 6)) {
        for (int r = 0; r < MT_COUNT(rows); r++) {
            for (int mode = 1; mode <= 3; mode += 2) {
                double slope[3];
                double x[3] = {m.at[0], m.at[1], m.at[2]};
                const probe p = {&m, &rows[r], mode};
                CHECK(t, solve(&m, x, true));
                const double share = share_of(&m, &rows[r], mode, slope);
                CHECK_NEAR(t, share, share_of(&m, &rows[r], mode + 1, NULL), TOL);
                for (int i = 0; i < 3; i++) {
                    mt_test_row(t, "%s, direction %d, mode %d, input %d", rows[r].name,
                                rows[r].direction, mode, i);
                    CHECK(t, mt_slope_agrees(both, &p, 3, x, i, slope[i],
                                             i == 2 ? 0.05 : STEP * x[i], NOISE));
                }
            }
        }
        const asked a = MOVES("a", 0);
        const asked b = MOVES("b", 0);
        CHECK(t, solve(&m, m.at, false));
        CHECK_NEAR(t, share_of(&m, &a, 1, NULL) + share_of(&m, &b, 1, NULL), 1.0, TOL);
    }
    mech_free(&m);
}

/* The mode that has most of a direction, whichever it is; the first of equal ones. */
static void energy__the_mode_with_most_is_found(mt_test *t)
{
    mech m;
    mt_arena mem;
    if (mech_must(t,
                  mech_parse(t, ENGINE("[\"j\", \"2*j\", \"2.5*j\", \"p\", \"-p/2\", 0.3]",
                                       "[0, 0.1, \"-d\"]", COUPLED)),
                  NULL, "", &m) &&
        CHECK(t, solve(&m, m.at, false)) && CHECK(t, mt_arena_init(&mem, 0, &m.err) == MT_OK)) {
        for (int k = 0; k < MT_ENERGY_DIRECTIONS; k++) {
            const asked q = MOVES("engine", k);
            mt_energy_part part;
            int most = -1;
            CHECK(t, part_of(&m, &q, &mem, &part));
            CHECK(t, mt_analysis_most_energy(m.a, &part, &most, &m.err) == MT_OK);
            for (int i = 1; i <= MT_ENERGY_DIRECTIONS; i++) {
                CHECK(t, share_of(&m, &q, most + 1, NULL) >= share_of(&m, &q, i, NULL));
            }
        }
        mt_arena_free(&mem);
    }
    mech_free(&m);
}

/* A free motion strains nothing: its share has no value, and that is said. */
static void energy__a_free_motion_strains_nothing(mt_test *t)
{
    mech m;
    mt_arena mem;
    mt_energy_part part;
    double share = 0.0;
    static const asked s = STRAINS("mount");
    if (mech_must(t,
                  mech_parse(t, ENGINE("[\"j\", \"2*j\", \"2.5*j\"]", "[0.1, 0, \"d\"]",
                                       "\"stiffness_n_per_m\": [0, 1e4, 1e4], "
                                       "\"stiffness_n_m_per_rad\": [1, 1, 1]")),
                  NULL, "", &m) &&
        CHECK(t, solve(&m, m.at, false)) && CHECK(t, mt_arena_init(&mem, 0, &m.err) == MT_OK)) {
        CHECK(t, part_of(&m, &s, &mem, &part));
        CHECK_INT(t, mt_analysis_energy_share(m.a, 0, &part, &share, NULL, &m.err),
                  MT_E_DOMAIN);
        CHECK(t, strstr(m.err.text, "strains nothing") != NULL);
        mt_arena_free(&mem);
    }
    mech_free(&m);
}

/* Equal moments of inertia have no axes of their own, and so no slope where they part. */
static void energy__equal_moments_have_no_principal_axes(mt_test *t)
{
    static const asked q = {
        "engine", MT_ENERGY_MOTION, 3, {.point = MT_ABSENT, .axes = MT_ENERGY_AXES_PRINCIPAL}};
    double slope[2];
    mech m;
    if (mech_must(t,
                  mech_parse(t, ENGINE("[\"2*j\", \"2*j\", \"2.5*j\", \"p - 0.9\", 0, 0]",
                                       "[0, 0.1, \"-d\"]", COUPLED)),
                  NULL, "m p", &m) &&
        CHECK(t, solve(&m, m.at, true))) {
        CHECK(t, isnan(share_of(&m, &q, 2, slope)));
        CHECK(t, strstr(m.err.text, "principal moments of inertia of \"engine\" are equal"));
    }
    mech_free(&m);
}

static void energy__failing_allocations_are_errors(mt_test *t)
{
    static const asked q = {
        "engine", MT_ENERGY_MOTION, 3, {.point = 0, .axes = MT_ENERGY_AXES_PRINCIPAL}};
    double slope[6];
    mech m;
    if (mech_must(t,
                  mech_parse(t, ENGINE("[\"j\", \"2*j\", \"2.5*j\", \"p\", \"-p/2\", 0.3]",
                                       "[0, 0.1, \"-d\"]", COUPLED)),
                  NULL, "m j p k c d", &m) &&
        CHECK(t, solve(&m, m.at, true))) {
        for (long nth = 0; mt_alloc_works(); nth++) {
            (void)solve(&m, m.at, true);
            mt_alloc_fail_after(nth);
            const double share = share_of(&m, &q, 2, slope);
            mt_alloc_fail_after(-1);
            if (MT_HAS(share)) {
                CHECK(t, nth > 0);
                break;
            }
            CHECK_INT(t, m.err.code, MT_E_MEMORY);
        }
    }
    mech_free(&m);
}

MT_TEST_MAIN(MT_TEST(energy__two_masses_have_their_closed_form),
             MT_TEST(energy__decoupled_modes_have_all_of_one_direction),
             MT_TEST(energy__shares_sum_to_one),
             MT_TEST(energy__shares_of_an_engine_have_exact_slopes),
             MT_TEST(energy__axes_of_a_body_may_turn_with_inputs),
             MT_TEST(energy__shares_of_a_linkage_have_exact_slopes),
             MT_TEST(energy__shares_under_load_and_without_mass_have_exact_slopes),
             MT_TEST(energy__modes_of_one_frequency_share_together),
             MT_TEST(energy__the_mode_with_most_is_found),
             MT_TEST(energy__a_free_motion_strains_nothing),
             MT_TEST(energy__equal_moments_have_no_principal_axes),
             MT_TEST(energy__failing_allocations_are_errors))
