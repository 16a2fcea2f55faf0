/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The adjoint of an equilibrium: with x and y of
 *     H x + A^T y = pull,  A x = across,  t . x = pull_trim,
 * a force f on the states and a gap c of the equations change
 *     J = pull . q + across . lambda + pull_trim tau       by       -(x . f + y . c).
 * In closed form for a bead on a wire; else an input is such a force or gap, and the slope of J
 * along it, whose equilibria Newton finds anew, must be that number: a load P that pulls at a
 * state, f = -1 there; the length L of a rope, c = |d| - L; the place of a drive that a spring
 * holds, likewise.
 */
#include "mechanics/mech.h"
#include "mechanics/position.h"
#include "support/mt_random.h"
#include "support/mt_slope.h"

enum { STATES = 160, TEXT = 4000 };

/* Small against inputs on which equilibria bend; what Newton leaves of coordinates of a metre.
 */
static const double STEP = 1e-3;
static const double NOISE = 2e-14;
/* Slopes that are as wrong as this are told. */
static const double WRONG = 1e-5;

typedef struct adjoint {
    mt_arena mem;
    const mt_stage *stage;
    double x[STATES];
    double y[STATES];
} adjoint;

/* J + 1, which has the size that it is rounded by, and where it begins. */
typedef struct functional {
    mech *s;
    mt_pose base[STATES];
    double pull[STATES];
    double across[STATES];
    double pull_trim;
} functional;

static const mt_state *state_of(const mech *s)
{
    return mt_linear_position(s->a->lin);
}

static double value_of(const void *context, int n, const double *inputs)
{
    const functional *const j = context;
    const mt_system *const sys = j->s->a->sys;
    double way[STATES];
    mt_err err;
    (void)n;
    if (mt_linear_update(j->s->a->lin, inputs, false, &err) != MT_OK) {
        return nan("");
    }
    const mt_state *const at = state_of(j->s);
    double sum = 1.0 + (j->pull_trim * at->equilibrium.trim_force.of[0]);
    mt_poses_increment(sys, j->base, at->at.pose, way);
    for (int i = 0; i < sys->nq; i++) {
        sum += j->pull[i] * way[i];
    }
    for (int i = 0; i < at->equilibrium.m; i++) {
        sum += j->across[i] * at->equilibrium.lambda[i];
    }
    return sum;
}

static int state(const mt_system *sys, const char *body, int k)
{
    for (int i = 0; i < sys->n_bodies; i++) {
        if (strcmp(sys->bodies[i].name, body) == 0) {
            return sys->bodies[i].dof[k];
        }
    }
    return -1;
}

/* x and y at the equilibrium of s for what j asks. */
static bool solve(mt_test *t, const functional *j, adjoint *out)
{
    mt_err err = {.text = ""};
    out->stage = &state_of(j->s)->equilibrium;
    return CHECK(t, mt_arena_init(&out->mem, 0, &err) == MT_OK) &&
           CHECK(t, out->stage->active) &&
           CHECK(t, mt_newton_adjoint(out->stage, j->pull, j->across, &j->pull_trim, out->x,
                                      out->y, &out->mem, &err) == MT_OK);
}

static void check_slope(mt_test *t, functional *j, int input, double slope)
{
    double at[MECH_INPUTS];
    memcpy(at, j->s->at, sizeof at);
    const double step = STEP * fmax(fabs(at[input]), 1.0);
    CHECK(t, mt_slope_agrees(value_of, j, j->s->n, at, input, slope, step, NOISE));
    CHECK(t, !mt_slope_agrees(value_of, j, j->s->n, at, input, slope * (1.0 + WRONG), step,
                              NOISE));
    (void)value_of(j, j->s->n, at);
}

/* What J asks is drawn: each state and, where `forces`, each joint's force. */
static void draw(functional *j, mech *s, uint64_t seed, bool forces)
{
    const mt_state *const at = state_of(s);
    mt_random random = mt_random_seed(seed);
    *j = (functional){.s = s};
    memcpy(j->base, at->at.pose, (size_t)s->a->sys->n_bodies * sizeof *j->base);
    for (int i = 0; i < s->a->sys->nq; i++) {
        j->pull[i] = mt_random_in(&random, -1.0, 1.0);
    }
    for (int i = 0; i < at->equilibrium.m && forces; i++) {
        j->across[i] = mt_random_in(&random, -0.1, 0.1);
    }
    j->pull_trim = at->equilibrium.m > 0 && s->a->sys->n_trims > 0 ? 0.75 : 0.0;
}

static void adjoint__bead_on_a_wire_has_its_closed_form(mt_test *t)
{
    static const double K = 50.0;
    static const double TENSION = 3.0;
    mech s;
    functional j;
    adjoint a = {0};
    if (mech_must(t,
                  mech_parse(t,
                             "{\"format\": \"modetune-model/1\", \"dimension\": 2,"
                             "\"bodies\": [{\"name\": \"b\", \"mass_kg\": 1, \"centre\": [0, "
                             "0]}],"
                             "\"joints\": [{\"name\": \"wire\", \"type\": \"pin-in-slot\", "
                             "\"bodies\": [\"ground\", \"b\"], \"at\": [0, 0], \"axis\": [1, "
                             "0]}],"
                             "\"springs\": [{\"name\": \"s\", \"type\": \"axial\", \"bodies\": "
                             "[\"ground\", \"b\"], \"at\": [[-2, 0], [0, 0]], "
                             "\"stiffness_n_per_m\": 50, \"preload_n\": 3}],"
                             "\"loads\": [{\"name\": \"p\", \"on\": \"b\", \"force_n\": [3, "
                             "0]}]}"),
                  NULL, "", &s)) {
        draw(&j, &s, 1, true);
        if (solve(t, &j, &a) && CHECK_INT(t, a.stage->m, 1) && CHECK_INT(t, s.a->sys->nq, 2)) {
            const double sign = a.stage->a[1] > 0.0 ? 1.0 : -1.0; /* of the wire's equation */
            CHECK_NEAR(t, a.x[0], j.pull[0] / K, 1e-14);
            CHECK_NEAR(t, a.x[1], sign * j.across[0], 1e-14);
            CHECK_NEAR(t, a.y[0], sign * (j.pull[1] - (TENSION / 2.0 * a.x[1])), 1e-14);
        }
        mt_arena_free(&a.mem);
    }
    mech_free(&s);
}

/* Arm on a pin, rod on the arm, hung on a rope of length L; gravity, pull P, moment Q. */
static const char LINKAGE[] =
    "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [0, -9.75],"
    "\"parameters\": {\"P\": {\"value\": 4, \"unit\": \"N\"}, \"Q\": {\"value\": 3, \"unit\": "
    "\"N m\"}, \"L\": {\"value\": 1.8, \"unit\": \"m\"}, \"A\": {\"value\": 0.1, \"unit\": "
    "\"rad\"}},"
    "\"bodies\": [{\"name\": \"arm\", \"mass_kg\": 1, \"inertia_kg_m2\": 0.1, \"centre\": "
    "[0.5, "
    "0.125]}, {\"name\": \"rod\", \"mass_kg\": 2, \"inertia_kg_m2\": 0.2, \"centre\": [1.5, "
    "-0.25]}, {\"name\": \"bob\", \"mass_kg\": 0.5, \"centre\": [2.5, -1]}],"
    "\"joints\": [{\"name\": \"pin\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
    "\"arm\"], \"at\": [0, 0]},%s {\"name\": \"hinge\", \"type\": \"revolute\", \"bodies\": "
    "[\"arm\", \"rod\"], \"at\": [1, 0]}, {\"name\": \"rope\", \"type\": \"distance\", "
    "\"bodies\": [\"ground\", \"rod\"], \"at\": [[1.5, 2], [2, 0.25]], \"length_m\": \"L\"}],"
    "\"springs\": [{\"name\": \"coil\", \"type\": \"torsion\", \"joint\": \"pin\", "
    "\"stiffness_n_m_per_rad\": 40, \"free_angle_rad\": 0.05}, {\"name\": \"tie\", \"type\": "
    "\"axial\", \"bodies\": [\"rod\", \"bob\"], \"at\": [[2, -0.5], [2.5, -1]], "
    "\"stiffness_n_per_m\": 90, \"free_length_m\": 0.5}, {\"name\": \"stay\", \"type\": "
    "\"axial\", \"bodies\": [\"ground\", \"bob\"], \"at\": [[3, 0.5], [2.5, -1]], "
    "\"stiffness_n_per_m\": 70, \"free_length_m\": 1.25}],"
    "\"loads\": [{\"name\": \"p\", \"on\": \"bob\", \"force_n\": [\"P\", 0]}, {\"name\": "
    "\"q\", \"on\": \"rod\", \"moment_n_m\": \"Q\"}],"
    "\"configurations\": {\"loose\": {}, \"trimmed\": {\"drive\": {\"joint\": \"pin\", "
    "\"position_rad\": \"A\", \"hold\": {\"trim\": \"coil\"}}}, \"locked\": {\"drive\": "
    "{\"joint\": \"pin\", \"position_rad\": \"A\"}}}}";

static void adjoint__slopes_of_a_linkage_are_those_of_its_equilibria(mt_test *t)
{
    static const struct {
        const char *name;
        const char *configuration;
        const char *more; /* joints */
        bool forces;      /* are those of the joints determined? */
    } rows[] = {
        {"a rope and two pins", "loose", "", true},
        {"held by a spring", "trimmed", "", true},
        {"locked", "locked", "", true},
        {"held by a spring, a pin that is there twice", "trimmed",
         "{\"name\": \"again\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"arm\"], "
         "\"at\": [0, 0]},",
         false},
        {"a pin that is there twice", "loose",
         "{\"name\": \"again\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"arm\"], "
         "\"at\": [0, 0]},",
         false},
    };
    for (int r = 0; r < MT_COUNT(rows); r++) {
        char text[TEXT];
        mech s;
        functional j;
        adjoint a = {0};
        mt_test_row(t, "%s", rows[r].name);
        (void)snprintf(text, sizeof text, LINKAGE, rows[r].more);
        if (mech_must(t, mech_parse(t, text), rows[r].configuration, "P Q L A", &s)) {
            const mt_system *const sys = s.a->sys;
            draw(&j, &s, (uint64_t)r + 7, rows[r].forces);
            if (solve(t, &j, &a)) {
                const int rope = sys->joints[mt_system_find_joint(sys, "rope")].first;
                CHECK(t, !a.stage->solver.sparse);
                check_slope(t, &j, 0, a.x[state(sys, "bob", 0)]);
                check_slope(t, &j, 1, a.x[state(sys, "rod", 5)]);
                if (sys->driven) { /* from a reference position that L moves */
                    check_slope(t, &j, 3, a.y[sys->drives[0].constraint]);
                } else {
                    check_slope(t, &j, 2, a.y[rope]);
                }
            }
            mt_arena_free(&a.mem);
        }
        mech_free(&s);
    }
}

/* Hung, and with its first link held off the vertical by a spring there. */
static const char CHAIN[] =
    "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [0, -9.75],"
    "\"parameters\": {\"P\": {\"value\": 4, \"unit\": \"N\"}, \"Q\": {\"value\": 3, \"unit\": "
    "\"N m\"}, \"A\": {\"value\": 0.1, \"unit\": \"rad\"}},"
    "\"links\": [{\"name\": \"c\", \"from\": [0, 2], \"to\": [0.5, 0.5], \"elements\": 40, "
    "\"mass_kg\": 3, \"stiffness_n_m_per_rad\": 20}],"
    "\"joints\": [{\"name\": \"pin\", \"type\": \"revolute\", \"bodies\": [\"ground\", "
    "\"c.start\"], \"at\": [0, 2]}],"
    "\"springs\": [{\"name\": \"coil\", \"type\": \"torsion\", \"joint\": \"pin\", "
    "\"stiffness_n_m_per_rad\": 15}],"
    "\"loads\": [{\"name\": \"p\", \"on\": \"c.40\", \"force_n\": [\"P\", 0]}, {\"name\": "
    "\"q\", \"on\": \"c.20\", \"moment_n_m\": \"Q\"}],"
    "\"configurations\": {\"hung\": {}, \"held\": {\"drive\": {\"joint\": \"pin\", "
    "\"position_rad\": \"A\", \"hold\": {\"trim\": \"coil\"}}}}}";

static void adjoint__slopes_of_a_long_chain_are_found_sparse(mt_test *t)
{
    static const char *const configurations[] = {"hung", "held"};
    for (int i = 0; i < MT_COUNT(configurations); i++) {
        mech s;
        functional j;
        adjoint a = {0};
        mt_test_row(t, "%s", configurations[i]);
        if (mech_must(t, mech_parse(t, CHAIN), configurations[i], "P Q A", &s)) {
            const mt_system *const sys = s.a->sys;
            draw(&j, &s, 3, true);
            if (solve(t, &j, &a)) {
                CHECK(t, a.stage->solver.sparse);
                check_slope(t, &j, 0, a.x[state(sys, "c.40", 0)]);
                check_slope(t, &j, 1, a.x[state(sys, "c.20", 5)]);
                if (sys->driven) {
                    check_slope(t, &j, 2, a.y[sys->drives[0].constraint]);
                }
            }
            mt_arena_free(&a.mem);
        }
        mech_free(&s);
    }
}

MT_TEST_MAIN(MT_TEST(adjoint__bead_on_a_wire_has_its_closed_form),
             MT_TEST(adjoint__slopes_of_a_linkage_are_those_of_its_equilibria),
             MT_TEST(adjoint__slopes_of_a_long_chain_are_found_sparse))
