/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Bodies in space: what is kept (energy, momentum, moment of momentum), and what is known in
 * closed form. A heavy symmetric or free body goes through all orientations: no chart may show.
 */
#include "simulate/motions.h"

static const char FREE[] =
    "{\"format\": \"modetune-model/1\", \"name\": \"free\", \"dimension\": 3,"
    " \"gravity_m_per_s2\": [0, 0, 0],"
    " \"bodies\": [{\"name\": \"top\", \"mass_kg\": 1.5,"
    " \"inertia_kg_m2\": [0.05, 0.04, 0.03, 0.004, -0.003, 0.002], \"centre\": [0.1, 0, 0]}],"
    " \"sensors\": [{\"name\": \"s\", \"on\": \"top\", \"at\": [0.5, 0.2, -0.1]}],"
    " \"configurations\": {\"c\": {}}}";

/* Principal inertias 1 : 2 : 3, spun about the middle one: it turns over, again and again. */
static const char FLIP[] =
    "{\"format\": \"modetune-model/1\", \"name\": \"flip\", \"dimension\": 3,"
    " \"gravity_m_per_s2\": [0, 0, 0],"
    " \"bodies\": [{\"name\": \"top\", \"mass_kg\": 1, \"inertia_kg_m2\": [0.01, 0.02, 0.03],"
    " \"centre\": [0, 0, 0]}],"
    " \"sensors\": [{\"name\": \"s\", \"on\": \"top\", \"at\": [0, 1, 0]}],"
    " \"configurations\": {\"c\": {}}}";

static const char SPHERICAL[] =
    "{\"format\": \"modetune-model/1\", \"name\": \"spherical pendulum\", \"dimension\": 3,"
    " \"gravity_m_per_s2\": [0, 0, -9.81],"
    " \"bodies\": [{\"name\": \"bob\", \"mass_kg\": 2, \"inertia_kg_m2\": [0, 0, 0],"
    " \"centre\": [0, 0, -0.8]}],"
    " \"joints\": [{\"name\": \"string\", \"type\": \"distance\", \"bodies\": [\"ground\", "
    "\"bob\"], \"at\": [[0, 0, 0], [0, 0, -0.8]]}],"
    " \"sensors\": [{\"name\": \"s\", \"on\": \"bob\", \"directions\": [\"x\", \"y\", \"z\"]}],"
    " \"configurations\": {\"c\": {}}}";

/* Momenta at a place. */
typedef struct momenta {
    double turn[3]; /* sum of J omega + m x cross v */
    double push[3];
} momenta;

static momenta momenta_of(const motion *m, const mt_placement *at, const double *v)
{
    momenta p = {{0.0}, {0.0}};
    mt_motion o;
    mt_arena mem = {0};
    (void)mt_arena_init(&mem, 0, NULL);
    (void)mt_motion_init(&o, m->lin, &mem, NULL);
    mt_motion_eval(&o, at, v);
    double *const mv = mt_arena_f64(&mem, (size_t)m->sys->nq, 1);
    mt_gemv(false, m->sys->nq, m->sys->nq, 1.0, o.mass, m->sys->nq, v, 0.0, mv);
    for (int b = 0; b < m->sys->n_bodies; b++) {
        const int *const dof = m->sys->bodies[b].dof;
        double x[3];
        double q[3];
        for (int k = 0; k < 3; k++) {
            x[k] = creal(at->pose[b].x[k]);
            q[k] = mv[dof[k]];
            p.push[k] += q[k];
            p.turn[k] += dof[3 + k] >= 0 ? mv[dof[3 + k]] : 0.0;
        }
        p.turn[0] += (x[1] * q[2]) - (x[2] * q[1]);
        p.turn[1] += (x[2] * q[0]) - (x[0] * q[2]);
        p.turn[2] += (x[0] * q[1]) - (x[1] * q[0]);
    }
    mt_arena_free(&mem);
    return p;
}

static double difference(const double a[3], const double b[3])
{
    double d = 0.0;
    double size = 0.0;
    for (int k = 0; k < 3; k++) {
        d = fmax(d, fabs(a[k] - b[k]));
        size = fmax(size, fabs(a[k]));
    }
    return d / size;
}

/* Momenta at the end are those at the start. */
static void keeps_momenta(mt_test *t, const char *text, const double *v, double duration)
{
    motion m;
    if (motion_open(t, mech_parse(t, text), NULL, &m)) {
        memcpy(m.start.v, v, (size_t)m.sys->nq * sizeof *v);
        const momenta before = momenta_of(&m, &m.start.at, m.start.v);
        m.opt.end = &m.start; /* where it ends becomes where it starts */
        if (motion_run(t, &m, duration, 0.1 * duration)) {
            const momenta after = momenta_of(&m, &m.start.at, m.start.v);
            CHECK(t, difference(before.turn, after.turn) < 1e-9);
            CHECK(t, difference(before.push, after.push) < 1e-9);
            CHECK(t, m.r.energy_error_j < 1e-9 * m.r.energy_scale_j);
        }
    }
    motion_free(&m);
}

static void simulate__free_bodies_keep_momentum_and_energy(mt_test *t)
{
    static const double tumble[] = {0.3, -0.1, 0.2, 5.0, 3.0, -4.0};
    static const double flip[] = {0.1, 0.0, 0.0, 1e-3, 10.0, 0.0};
    mt_test_row(t, "tumbling");
    keeps_momenta(t, FREE, tumble, 20.0);
    mt_test_row(t, "over the middle axis");
    keeps_momenta(t, FLIP, flip, 20.0);
}

/*
 * Euler's equations in the body: J1 w1' = (J2 - J3) w2 w3, ... with J = 1 : 2 : 3 and w1 = e at
 * w2 = w: about the unstable axis w1 grows, and the body has turned over when the elliptic
 * functions come round, after
 *     T/2 = 2 K(q)/kappa   (Landau and Lifshitz, Mechanics, 37), with M^2, E of the start.
 * The middle axis, on which the sensor sits a metre out, then points the other way.
 */
static void simulate__a_body_turns_over_about_its_middle_axis(mt_test *t)
{
    const double j[3] = {0.01, 0.02, 0.03};
    const double w[3] = {0.2, 10.0, 0.0};
    const double e2 = (j[0] * w[0] * w[0]) + (j[1] * w[1] * w[1]);
    const double m2 = (j[0] * j[0] * w[0] * w[0]) + (j[1] * j[1] * w[1] * w[1]);
    /* M^2 < 2 E J2: the roles of 1 and 3 change */
    const double kappa = sqrt((j[1] - j[0]) * (e2 * j[2] - m2) / (j[0] * j[1] * j[2]));
    const double q2 = (j[2] - j[1]) * (m2 - (e2 * j[0])) / ((j[1] - j[0]) * ((e2 * j[2]) - m2));
    double a = 1.0;
    double b = sqrt(1.0 - q2);
    for (int i = 0; i < 12; i++) {
        const double mean = 0.5 * (a + b);
        b = sqrt(a * b);
        a = mean;
    }
    const double half = MECH_PI / (a * kappa); /* 2 K/kappa */
    motion m;
    if (motion_open(t, mech_parse(t, FLIP), NULL, &m)) {
        for (int k = 0; k < 3; k++) {
            m.start.v[3 + k] = w[k];
        }
        m.opt.end = &m.start;
        if (motion_run(t, &m, half, 0.1 * half)) {
            /* omega . e2 of the body changes its sign */
            const mt_pose *const pose = &m.start.at.pose[0];
            double along = 0.0;
            for (int k = 0; k < 3; k++) {
                along += creal(pose->r[3 + k]) * m.start.v[3 + k];
            }
            CHECK_NEAR(t, along, -10.0, 1e-8);
        }
    }
    motion_free(&m);
}

/* Energy, moment about the vertical, and the period of the swing between the turning points of
 * the height, by quadrature: z'^2 = 2 (E - g z)(L^2 - z^2)/L^2 - (h/L)^2. */
static void simulate__spherical_pendulum_swings_between_its_turning_points(mt_test *t)
{
    enum { NODES = 400 };
    const double length = 0.8;
    const double g = 9.81;
    const double v = 1.7;
    motion m;
    if (!motion_open(t, mech_parse(t, SPHERICAL), NULL, &m)) {
        motion_free(&m);
        return;
    }
    /* at 60 degrees, horizontally across: the higher turning point, or the lower one */
    const double z0 = -0.5 * length;
    const double r0 = length * sqrt(0.75);
    m.start.at.pose[0].x[0] = r0;
    m.start.at.pose[0].x[2] = z0;
    m.start.v[0] = 0.0;
    m.start.v[1] = v;
    const double e = (0.5 * v * v) + (g * z0);
    /* cubic 2 (e - g z)(L^2 - z^2) - h^2 has the root z0; the others by the quadratic */
    const double b = (z0 * g * 2.0) - (2.0 * e);
    const double c = (z0 * b) - (2.0 * g * length * length);
    const double z1 = (-b - sqrt((b * b) - (8.0 * g * c))) / (4.0 * g);
    const double z2 = (-b + sqrt((b * b) - (8.0 * g * c))) / (4.0 * g);
    /* the two within the sphere; the third lies outside */
    const double other = fabs(z1) < length ? z1 : z2;
    const double outside = fabs(z1) < length ? z2 : z1;
    const double low = fmin(z0, other);
    const double high = fmax(z0, other);
    double period = 0.0; /* z = mean + half width cos: a smooth periodic integrand */
    for (int i = 0; i < NODES; i++) {
        const double angle = MECH_PI * (i + 0.5) / NODES;
        const double z = (0.5 * (low + high)) + (0.5 * (high - low) * cos(angle));
        period += length / sqrt(2.0 * g * fabs(z - outside));
    }
    period *= 2.0 * MECH_PI / NODES;
    motion_watch(t, &m, "s.z");
    m.opt.turning = true;
    const momenta before = momenta_of(&m, &m.start.at, m.start.v);
    m.opt.end = &m.start;
    if (motion_run(t, &m, 5.5 * period, period)) {
        const momenta after = momenta_of(&m, &m.start.at, m.start.v);
        const mt_ring ring = mt_ring_read(&m.r.turnings[0]);
        CHECK(t, ring.periods >= 4);
        CHECK_NEAR(t, ring.hz * period, 1.0, 1e-9);
        CHECK_NEAR(t, ring.amplitude, 0.5 * (high - low), 1e-9);
        CHECK_NEAR(t, after.turn[2], before.turn[2], 1e-10);
        CHECK(t, m.r.energy_error_j < 1e-9 * m.r.energy_scale_j);
        CHECK(t, m.r.gap_m < 1e-10);
    }
    motion_free(&m);
}

MT_TEST_MAIN(MT_TEST(simulate__free_bodies_keep_momentum_and_energy),
             MT_TEST(simulate__a_body_turns_over_about_its_middle_axis),
             MT_TEST(simulate__spherical_pendulum_swings_between_its_turning_points))
