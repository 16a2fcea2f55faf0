/* SPDX-License-Identifier: GPL-3.0-or-later */
/* When there is no certificate, and why; corners; what touches an edge exactly. */
#include <stdlib.h>

#include "mechanics/mech.h"
#include "prove/band_count.h"
#include "prove/certify.h"
#include "prove/tolerance.h"

/* Two masses on rails, one spring to the ground, one between them. The texts in place: where
 * the first mass is, the masses, the first spring and more members of it, the second. */
static const char *const PAIR =
    "{\"format\": \"modetune-model/1\", \"name\": \"pair\", \"dimension\": 2,"
    "\"parameters\": {\"k1\": 1e4, \"k2\": 2e4, \"m1\": 2, \"m2\": 1, \"L\": 1, \"F\": 0},"
    "\"points\": {\"p\": [\"%s\", 0]},"
    "\"bodies\": [{\"name\": \"a\", \"mass_kg\": \"%s\", \"centre\": \"p\"},"
    "{\"name\": \"b\", \"mass_kg\": \"%s\", \"centre\": [2, 0]}],"
    "\"springs\": [{\"name\": \"s1\", \"type\": \"axial\", \"bodies\": [\"ground\", \"a\"],"
    "\"at\": [[0, 0], \"p\"], \"stiffness_n_per_m\": \"%s\" %s},"
    "{\"name\": \"s2\", \"type\": \"axial\", \"bodies\": [\"a\", \"b\"],"
    "\"stiffness_n_per_m\": \"%s\"}],"
    "\"joints\": [{\"name\": \"ra\", \"type\": \"pin-in-slot\", \"bodies\": [\"ground\", "
    "\"a\"],"
    "\"at\": \"p\", \"axis\": [1, 0]}, {\"name\": \"rb\", \"type\": \"pin-in-slot\","
    "\"bodies\": [\"ground\", \"b\"], \"at\": [2, 0], \"axis\": [1, 0]}],"
    "\"configurations\": {\"one\": {}}}";

typedef struct pair_text {
    const char *mass_a;
    const char *mass_b;
    const char *at;
    const char *spring_1;
    const char *extra;
    const char *spring_2;
} pair_text;

enum { TEXT = 2048, INPUTS = 4 };

typedef struct rig {
    mech s;
    mt_enclosure *e;
    char reason[MT_REASON_SIZE];
} rig;

static void end(rig *r)
{
    mt_enclosure_delete(r->e);
    mech_free(&r->s);
}

/* Enclose a model over the original values times low .. high. */
static bool enclose(mt_test *t, mt_model *model, const char *configuration, const char *inputs,
                    const double *share, rig *r)
{
    mt_err err = {.text = ""};
    double lower[MECH_INPUTS];
    double upper[MECH_INPUTS];
    *r = (rig){0};
    if (!mech_must(t, model, configuration, inputs, &r->s)) {
        return false;
    }
    for (int i = 0; i < r->s.n; i++) {
        lower[i] = r->s.at[i] * share[0];
        upper[i] = r->s.at[i] * share[1];
    }
    return CHECK(t, mt_enclosure_new(r->s.a, lower, upper, &r->e, r->reason, &err) == MT_OK);
}

static bool enclose_pair(mt_test *t, const pair_text *p, const char *inputs,
                         const double *share, rig *r)
{
    char text[TEXT];
    (void)snprintf(text, sizeof text, PAIR, p->at, p->mass_a, p->mass_b, p->spring_1, p->extra,
                   p->spring_2);
    return enclose(t, mech_parse(t, text), NULL, inputs, share, r);
}

static const double WIDE[2] = {0.5, 2.0};

static void enclosure__conditions_are_checked_and_named(mt_test *t)
{
    static const struct {
        const char *name;
        pair_text p;
        const char *inputs;
        double share[2];
        const char *reason; /* NULL: a certificate */
    } rows[] = {
        {"plain", {"m1", "m2", "L", "k1", "", "k2"}, "k1 k2 m1 m2", {0.5, 2.0}, NULL},
        {"springs may go to zero", {"m1", "m2", "L", "k1", "", "k2"}, "k1", {0.0, 2.0}, NULL},
        {"a length",
         {"m1", "m2", "L", "k1", "", "k2"},
         "k1 L",
         {0.5, 2.0},
         "parameter \"L\" shapes the geometry"},
        {"a length that is no input",
         {"m1", "m2", "L", "k1*L", "", "k2"},
         "k1",
         {0.5, 2.0},
         NULL},
        {"a preload",
         {"m1", "m2", "L", "k1", ", \"preload_n\": \"F\"", "k2"},
         "k1",
         {0.5, 2.0},
         "spring \"s1\" is preloaded"},
        {"a stiffness below zero",
         {"m1", "m2", "L", "k1 - 4000", "", "k2"},
         "k1",
         {0.25, 2.0},
         "stiffness of \"s1\" may be negative within the bounds"},
        {"a stiffness that may be anything",
         {"m1", "m2", "L", "1e8/(k1 - 5e3)", "", "k2"},
         "k1",
         {0.5, 2.0},
         "stiffness of \"s1\" may be negative within the bounds"},
        {"a stiffness that overflows",
         {"m1", "m2", "L", "exp(k1/13 - 760)", "", "k2"},
         "k1",
         {0.5, 2.0},
         "stiffness of \"s1\" may be without limit within the bounds"},
        {"a mass that is negative",
         {"m1", "m2 - 0.7", "L", "k1", "", "k2"},
         "m2",
         {0.5, 2.0},
         "mass of \"b\" may be negative within the bounds"},
        {"a mass that vanishes",
         {"m1", "m2", "L", "k1", "", "k2"},
         "m2",
         {0.0, 2.0},
         "mass of \"b\" may vanish within the bounds"},
        {"a massless body on varying springs",
         {"0", "m2", "L", "k1", "", "k2"},
         "k1 m2",
         {0.5, 2.0},
         "spring \"s1\" acts on a massless freedom"},
        {"a massless body on fixed springs",
         {"0", "m2", "L", "k1", "", "k2"},
         "m2",
         {0.5, 2.0},
         NULL},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        rig r;
        mt_test_row(t, "%s", rows[i].name);
        if (enclose_pair(t, &rows[i].p, rows[i].inputs, rows[i].share, &r)) {
            CHECK(t, (r.e != NULL) == (rows[i].reason == NULL));
            CHECK_STR(t, r.reason, rows[i].reason == NULL ? "" : rows[i].reason);
        }
        end(&r);
    }
}

static void enclosure__a_hanging_double_pendulum_gets_no_certificate(mt_test *t)
{
    static const double hz[3] = {0.767, 0.921, 1.164};
    static const double mass[3] = {0.5, 1.0, 2.0};
    static const char *const configurations[2] = {"distances", "rods"};
    for (int c = 0; c < 2; c++) {
        rig r;
        mt_test_row(t, "%s", configurations[c]);
        if (enclose(t, mech_load(t, "double_pendulum"), configurations[c], "m2", WIDE, &r)) {
            const mt_analysis_options opt = mt_analysis_options_default();
            mt_err err;
            CHECK(t, r.e == NULL);
            CHECK_STR(t, r.reason, "gravity loads the mechanism");
            /* the reason why: raising the lower mass raises the second frequency */
            for (int i = 0; i < 3; i++) {
                CHECK(t, mt_analysis_solve(r.s.a, &mass[i], &opt, &err) == MT_OK);
                CHECK_NEAR_ABS(t, mech_hz(&r.s, 2), hz[i], 5e-4);
            }
        }
        end(&r);
    }
}

static void enclosure__a_coupling_of_either_sign_is_bounded_or_named(mt_test *t)
{
    rig r;
    static const char *const text =
        "{\"format\": \"modetune-model/1\", \"name\": \"bushing\", \"dimension\": 3,"
        "\"parameters\": {\"k\": 1e3, \"c\": 100},"
        "\"bodies\": [{\"name\": \"body\", \"mass_kg\": 1, \"inertia_kg_m2\": [1, 2, 3],"
        "\"centre\": [0, 0, 0]}],"
        "\"springs\": [{\"name\": \"soft\", \"type\": \"bushing\", \"bodies\": [\"ground\","
        "\"body\"], \"at\": [0, 0, 0], \"stiffness_matrix\": [[\"k\", \"c\", 0, 0, 0, 0],"
        "[\"c\", \"k\", 0, 0, 0, 0], [0, 0, \"k\", 0, 0, 0], [0, 0, 0, \"k\", 0, 0],"
        "[0, 0, 0, 0, \"k\", 0], [0, 0, 0, 0, 0, \"k\"]]}],"
        "\"configurations\": {\"one\": {}}}";
    if (enclose(t, mech_parse(t, text), NULL, "c", WIDE, &r) && CHECK(t, r.e != NULL)) {
        /* x and y: k + c and k - c over m = 1, modes 6 and 3 beside k/3, k/2, k, k; sum and
         * difference of x and y are these modes, so the bounds are tight */
        static const double lo[1] = {80.0};
        static const double hi[1] = {120.0};
        double low[6];
        double high[6];
        mt_err err;
        CHECK(t, mt_enclosure_set(r.e, lo, hi));
        CHECK(t, mt_enclosure_ranges(r.e, low, high, &err) == MT_OK);
        CHECK_NEAR(t, mt_enclosure_lambda(low[2]), 880.0, 1e-6);
        CHECK_NEAR(t, mt_enclosure_lambda(high[2]), 920.0, 1e-6);
        CHECK_NEAR(t, mt_enclosure_lambda(low[5]), 1080.0, 1e-6);
        CHECK_NEAR(t, mt_enclosure_lambda(high[5]), 1120.0, 1e-6);
    }
    end(&r);
    static const double over_k[2] = {0.5, 12.0};
    if (enclose(t, mech_parse(t, text), NULL, "c", over_k, &r)) {
        CHECK_STR(t, r.reason,
                  "spring \"soft\" couples two directions with a stiffness that varies");
    }
    end(&r);
    if (enclose(t, mech_parse(t, text), NULL, "k", WIDE, &r)) {
        const double over[1] = {2500.0};
        const double under[1] = {400.0};
        CHECK(t, r.e != NULL); /* the coupling is fixed */
        /* but K0 alone is indefinite: nothing is said beyond the bounds */
        CHECK(t, r.e != NULL && mt_enclosure_set(r.e, over, over));
        CHECK(t, r.e != NULL && !mt_enclosure_set(r.e, under, under));
    }
    end(&r);
    static const double deep[2] = {0.05, 2.0};
    if (enclose(t, mech_parse(t, text), NULL, "k", deep, &r)) {
        CHECK_STR(t, r.reason, "the mechanism may be unstable within the bounds");
    }
    end(&r);
}

static int compare_numbers(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* A coupling of x and y that is a part r of the stiffness itself, k = p q u, whichever way it
 * is written, beside a fixed one: k [1, r; r, 1] + [500, 300; 300, 500] has the eigenvalues
 * 800 + (1 + r) k and 200 + (1 - r) k, m = 1, and those of z and of rotations are k, k, k/2 and
 * k/3. All rise with k, so the bounds over k are those at its ends. */
static void enclosure__a_coupling_in_proportion_is_tight_however_written(mt_test *t)
{
    static const struct {
        const char *text;
        double r;
    } couplings[] = {
        {"0.4*p*q*u", 0.4},         {"u*q*p/2.5", 0.4},          {"-0.4*q*u*p", -0.4},
        {"-(0.4*u*p*q)", -0.4},     {"0.4*p*(-q)*u", -0.4},      {"-p*u*q*0.4", -0.4},
        {"-u*q*p/2.5", -0.4},       {"u*(q*p)/(-2.5)", -0.4},    {"0.4*p*p*q*u/(-p)", -0.4},
        {"-(-(-u))*p*q*0.4", -0.4}, {"-(-p)*u*q*0.4", 0.4},      {"(-p)*(-0.4)*q*u", 0.4},
        {"-(q*u*p/(-2.5))", 0.4},   {"0.4*u*q*(-u)*p/u", -0.4},  {"0.4/(-(1/(p*q*u)))", -0.4},
        {"-0.4*q*p*q*u/(-q)", 0.4}, {"-(2*u)*p/(-5)*(-q)", -0.4}};
    static const double range[2][3] = {{8.0, 10.0, 10.0}, {12.5, 10.0, 10.0}};
    for (int i = 0; i < MT_COUNT(couplings); i++) {
        rig r;
        char text[TEXT];
        const char *const c = couplings[i].text;
        (void)snprintf(
            text, sizeof text,
            "{\"format\": \"modetune-model/1\", \"name\": \"bushing\", \"dimension\": 3, "
            "\"parameters\": {\"p\": 10, \"q\": 10, \"u\": 10}, \"bodies\": [{\"name\": "
            "\"body\", \"mass_kg\": 1, "
            "\"inertia_kg_m2\": [1, 2, 3], \"centre\": [0, 0, 0]}], \"springs\": [{\"name\": "
            "\"soft\", \"type\": \"bushing\", \"bodies\": [\"ground\", \"body\"], \"at\": [0, "
            "0, 0], \"stiffness_matrix\": [[\"p*q*u\", \"%s\", 0, 0, 0, 0], [\"%s\", "
            "\"p*q*u\", 0, 0, "
            "0, 0], [0, 0, \"p*q*u\", 0, 0, 0], [0, 0, 0, \"p*q*u\", 0, 0], [0, 0, 0, 0, "
            "\"p*q*u\", 0], "
            "[0, 0, 0, 0, 0, \"p*q*u\"]]}, {\"name\": \"fixed\", \"type\": \"bushing\", "
            "\"bodies\": [\"ground\", \"body\"], \"at\": [0, 0, 0], \"stiffness_matrix\": "
            "[[500, 300, 0, 0, 0, 0], [300, 500, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, "
            "0, 0], [0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]]}], \"configurations\": {\"one\": "
            "{}}}",
            c, c);
        mt_test_row(t, "%s", c);
        if (enclose(t, mech_parse(t, text), NULL, "p q u", WIDE, &r) && CHECK(t, r.e != NULL)) {
            double bound[2][6];
            mt_err err;
            CHECK(t, mt_enclosure_set(r.e, range[0], range[1]));
            CHECK(t, mt_enclosure_ranges(r.e, bound[0], bound[1], &err) == MT_OK);
            for (int end_of = 0; end_of < 2; end_of++) {
                const double *const at = range[end_of];
                const double k = at[0] * at[1] * at[2];
                double lambda[6] = {800.0 + ((1.0 + couplings[i].r) * k),
                                    200.0 + ((1.0 - couplings[i].r) * k),
                                    k,
                                    k,
                                    k / 2.0,
                                    k / 3.0};
                qsort(lambda, 6, sizeof lambda[0], compare_numbers);
                for (int mode = 0; mode < 6; mode++) {
                    CHECK_NEAR(t, mt_enclosure_lambda(bound[end_of][mode]), lambda[mode], 1e-9);
                }
            }
        }
        end(&r);
    }
}

/* Stiffnesses that lie 1e10 apart: the slack is that of the stiff ones, and bounds stay
 * bounds. */
static void enclosure__stiffnesses_far_apart_stay_enclosed(mt_test *t)
{
    rig r;
    static const pair_text one = {"m1", "m2", "L", "k1", "", "k2*1e9"};
    static const double narrow[2] = {0.999, 1.001};
    if (enclose_pair(t, &one, "k1 k2 m1 m2", narrow, &r) && CHECK(t, r.e != NULL)) {
        double low[2];
        double high[2];
        mt_err err;
        CHECK(t, mt_enclosure_set(r.e, r.s.at, r.s.at));
        CHECK(t, mt_enclosure_ranges(r.e, low, high, &err) == MT_OK);
        for (int k = 0; k < 2; k++) {
            const double f = mech_hz(&r.s, k + 1);
            CHECK(t, low[k] <= f && f <= high[k]);
            CHECK(t, high[k] - low[k] <= 2e-2 * f); /* and not useless */
            CHECK_INT(t, mt_enclosure_most_below(r.e, mt_enclosure_lambda(0.9 * f)), k);
            CHECK_INT(t, mt_enclosure_least_below(r.e, mt_enclosure_lambda(1.1 * f)), k + 1);
            CHECK(t, mt_enclosure_most_below(r.e, mt_enclosure_lambda(f)) > k);
            CHECK(t, mt_enclosure_least_below(r.e, mt_enclosure_lambda(f)) <= k);
        }
    }
    end(&r);
}

/* A design on an edge: feasible, and without any room. */
static void enclosure__an_edge_that_is_touched_exactly(mt_test *t)
{
    rig r;
    static const pair_text one = {"m1", "m2", "L", "k1", "", "k2"};
    if (enclose_pair(t, &one, "k1 k2 m1 m2", WIDE, &r) && CHECK(t, r.e != NULL)) {
        const double f1 = mech_hz(&r.s, 1);
        const double f2 = mech_hz(&r.s, 2);
        mt_arena mem = {0};
        mt_err err;
        const double off = f1 * (1.0 + 1e-6);
        static const int below_1[1] = {1};
        static const int below_0[1] = {0};
        CHECK(t, mt_arena_init(&mem, 0, &err) == MT_OK);
        const struct {
            const char *name;
            mt_certify_band band;
            const int *assignment;
            double hz;
            int mode;
            bool zero; /* percentage zero, at this edge */
            bool above;
        } rows[] = {
            {"mode 1 on the lower edge",
             {0, f1, 0.5 * (f1 + f2), 0.0},
             below_1,
             f1,
             1,
             true,
             false},
            {"mode 1 on the upper edge", {0, 0.5 * f1, f1, 0.0}, below_0, f1, 1, true, true},
            {"mode 2 on the upper edge",
             {0, 0.5 * (f1 + f2), f2, 0.0},
             below_1,
             f2,
             2,
             true,
             true},
            {"just off the lower edge",
             {0, off, 0.5 * (f1 + f2), 0.0},
             below_1,
             off,
             1,
             false,
             false},
        };
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            mt_tolerance all;
            mt_tolerance each[INPUTS];
            mt_certify c = {
                .n_views = 1, .views = &r.e, .n_bands = 1, .bands = &rows[i].band, .n = r.s.n};
            const mt_tolerance_question q = {r.s.at, NULL, rows[i].assignment, 50.0, 0};
            mt_test_row(t, "%s", rows[i].name);
            CHECK(t, mt_certify_tolerance(&c, &q, &mem, &all, each, &err) == MT_OK);
            CHECK_INT(t, all.end, MT_TOLERANCE_EDGE);
            CHECK(t, rows[i].zero ? all.percent == 0.0 : all.percent > 1e-5);
            CHECK_INT(t, all.edge.mode, rows[i].mode);
            CHECK(t, all.edge.hz == rows[i].hz);
            CHECK(t, all.edge.above == rows[i].above);
            for (int k = 0; k < r.s.n; k++) {
                CHECK(t, each[k].percent >= all.percent);
                CHECK(t, !rows[i].zero || each[k].percent == 0.0);
            }
            /* touching is feasible: the assignment is never excluded, not even in the box that
             * is this one design */
            mt_verdict verdict;
            c.lower = r.s.at;
            c.upper = r.s.at;
            CHECK(t, mt_certify_possible(&c, rows[i].assignment, &mem, &verdict, NULL, NULL,
                                         &err) == MT_OK);
            CHECK(t, verdict != MT_VERDICT_IMPOSSIBLE);
        }
        mt_arena_free(&mem);
    }
    end(&r);
}

/* All stiffnesses together and all masses together: f goes with sqrt(k/m), so the largest
 * percentage is known: ((1 + p)/(1 - p))^(1/2) = edge / f. */
static void enclosure__a_tolerance_box_is_as_large_as_it_can_be(mt_test *t)
{
    rig r;
    static const pair_text one = {"m1", "m2", "L", "k1", "", "k2"};
    if (enclose_pair(t, &one, "k1 k2 m1 m2", WIDE, &r) && CHECK(t, r.e != NULL)) {
        const double f1 = mech_hz(&r.s, 1);
        const double edge = 1.2 * f1;
        const mt_certify_band band = {0, edge, edge * 1.01, 1e-6};
        const mt_certify_limit limit = {0, 1, 0.9 * f1, nan(""), 1e-6};
        static const int below[1] = {1};
        mt_tolerance all;
        mt_tolerance each[INPUTS];
        mt_arena mem = {0};
        mt_err err;
        mt_certify c = {.n_views = 1, .views = &r.e, .n_bands = 1, .bands = &band, .n = r.s.n};
        const mt_tolerance_question q = {r.s.at, NULL, below, 90.0, 0};
        CHECK(t, mt_arena_init(&mem, 0, &err) == MT_OK);
        CHECK(t, mt_certify_tolerance(&c, &q, &mem, &all, each, &err) == MT_OK);
        /* (1 + p)/(1 - p) = 1.44 */
        CHECK_NEAR(t, all.percent, 100.0 * 0.44 / 2.44, 2e-4);
        CHECK_INT(t, all.edge.band, 0);
        c.n_bands = 0;
        c.n_limits = 1;
        c.limits = &limit;
        CHECK(t, mt_certify_tolerance(&c, &q, &mem, &all, NULL, &err) == MT_OK);
        /* (1 - p)/(1 + p) = 0.81 */
        CHECK_NEAR(t, all.percent, 100.0 * 0.19 / 1.81, 2e-4);
        CHECK_INT(t, all.edge.limit, 0);
        CHECK(t, all.edge.above);
        c.n_limits = 0;
        CHECK(t, mt_certify_tolerance(&c, &q, &mem, &all, NULL, &err) == MT_OK);
        CHECK_INT(t, all.end, MT_TOLERANCE_MOST);
        const mt_tolerance_question far = {r.s.at, NULL, below, 150.0, 0};
        CHECK(t, mt_certify_tolerance(&c, &far, &mem, &all, NULL, &err) == MT_OK);
        CHECK_INT(t, all.end, MT_TOLERANCE_DOMAIN); /* a mass of zero */
        CHECK_NEAR(t, all.percent, 100.0, 2e-4);
        mt_arena_free(&mem);
    }
    end(&r);
}

/* All stiffnesses follow from one input and all masses from another, in both orders: alone,
 *     1 + p = 1.44 of the stiffness,   1/(1 - p) = 1.44 of the mass. */
static void enclosure__a_tolerance_box_of_each_input_alone(mt_test *t)
{
    static const pair_text one = {"m1", "0.5*m1", "L", "k1", "", "2*k1"};
    static const char *const inputs[] = {"k1 m1", "m1 k1"};
    for (int order = 0; order < 2; order++) {
        rig r;
        mt_test_row(t, "%s", inputs[order]);
        if (enclose_pair(t, &one, inputs[order], WIDE, &r) && CHECK(t, r.e != NULL)) {
            const double edge = 1.2 * mech_hz(&r.s, 1);
            const mt_certify_band band = {0, edge, edge * 1.01, 1e-6};
            static const int below[1] = {1};
            mt_tolerance all;
            mt_tolerance each[INPUTS];
            mt_arena mem = {0};
            mt_err err;
            mt_certify c = {
                .n_views = 1, .views = &r.e, .n_bands = 1, .bands = &band, .n = r.s.n};
            const mt_tolerance_question q = {r.s.at, NULL, below, 90.0, 0};
            CHECK(t, mt_arena_init(&mem, 0, &err) == MT_OK);
            CHECK(t, mt_certify_tolerance(&c, &q, &mem, &all, each, &err) == MT_OK);
            CHECK_NEAR(t, all.percent, 100.0 * 0.44 / 2.44, 2e-4);
            CHECK_NEAR(t, each[order].percent, 44.0, 2e-4);
            CHECK_NEAR(t, each[1 - order].percent, 100.0 * 0.44 / 1.44, 2e-4);
            mt_arena_free(&mem);
        }
        end(&r);
    }
}

static void enclosure__corners_are_where_modes_are_lowest_and_highest(mt_test *t)
{
    rig r;
    static const pair_text plain = {"m1", "m2", "L", "k1", "", "k2"};
    static const pair_text both = {"m1", "m2*k1/1e4", "L", "k1", "", "k2"};
    static const pair_text mixed = {"m1", "m2", "L", "k1", "", "2e8/k1"};
    static const pair_text ratio = {"m1", "m2*1e4/k1", "L", "k1", "", "k2"};
    double soft[INPUTS];
    double stiff[INPUTS];
    char reason[MT_REASON_SIZE] = "";
    if (enclose_pair(t, &plain, "k1 k2 m1 m2", WIDE, &r) && CHECK(t, r.e != NULL)) {
        static const double lo[INPUTS] = {9e3, 1.8e4, 1.8, 0.9};
        static const double hi[INPUTS] = {1.1e4, 2.2e4, 2.2, 1.1};
        CHECK(t, mt_enclosure_corners(r.e, r.s.model, r.s.a->sys->inputs, lo, hi, soft, stiff,
                                      reason));
        for (int i = 0; i < INPUTS; i++) {
            CHECK(t, soft[i] == (i < 2 ? lo[i] : hi[i]));
            CHECK(t, stiff[i] == (i < 2 ? hi[i] : lo[i]));
        }
    }
    end(&r);
    static const double lo[1] = {9e3};
    static const double hi[1] = {1.1e4};
    if (enclose_pair(t, &both, "k1", WIDE, &r) && CHECK(t, r.e != NULL)) {
        CHECK(t, !mt_enclosure_corners(r.e, r.s.model, r.s.a->sys->inputs, lo, hi, soft, stiff,
                                       reason));
        CHECK_STR(t, reason, "parameter \"k1\" enters both stiffness and mass");
        CHECK(t, mt_enclosure_corners(r.e, r.s.model, r.s.a->sys->inputs, lo, lo, soft, stiff,
                                      reason));
        CHECK(t, soft[0] == lo[0] && stiff[0] == lo[0]);
    }
    end(&r);
    if (enclose_pair(t, &mixed, "k1", WIDE, &r) && CHECK(t, r.e != NULL)) {
        CHECK(t, !mt_enclosure_corners(r.e, r.s.model, r.s.a->sys->inputs, lo, hi, soft, stiff,
                                       reason));
        CHECK_STR(t, reason, "parameter \"k1\" stiffens in one place and softens in another");
    }
    end(&r);
    if (enclose_pair(t, &ratio, "k1", WIDE, &r) && CHECK(t, r.e != NULL)) {
        CHECK(t, mt_enclosure_corners(r.e, r.s.model, r.s.a->sys->inputs, lo, hi, soft, stiff,
                                      reason)); /* stiffens and takes mass off: still one way */
        CHECK(t, soft[0] == lo[0] && stiff[0] == hi[0]);
    }
    end(&r);
}

static void enclosure__bands_are_counted_by_inertia_alone(mt_test *t)
{
    mech s;
    mt_err err;
    mt_arena mem = {0};
    if (mech_must(t, mech_load(t, "eight_masses"), "guided", "", &s)) {
        CHECK(t, mt_arena_init(&mem, 0, &err) == MT_OK);
        const double f3 = mech_hz(&s, 3);
        const struct {
            const char *name;
            double lower_hz;
            double upper_hz;
            int below;
            int inside;
        } rows[] = {
            {"none", f3 * 1.01, f3 * 1.02, 3, 0},
            {"one", f3 * 0.99, f3 * 1.01, 2, 1},
            {"on the low edge", f3, f3 * 1.01, 3, 0},
            {"on the top edge", f3 * 0.99, f3, 2, 0},
            {"from zero", 0.0, f3 * 1.01, 0, 3},
            {"everything", f3 / 1000000.0, f3 * 1000000.0, 0, 8},
        };
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            mt_band_count n;
            mt_test_row(t, "%s", rows[i].name);
            CHECK(t, mt_certify_count(s.a->lin, s.a->n_rigid, rows[i].lower_hz,
                                      rows[i].upper_hz, 1e-6, &mem, &n, &err) == MT_OK);
            CHECK_INT(t, n.below, rows[i].below);
            CHECK_INT(t, n.inside, rows[i].inside);
            CHECK(t, n.sure);
        }
        mt_arena_free(&mem);
    }
    mech_free(&s);
}

MT_TEST_MAIN(MT_TEST(enclosure__conditions_are_checked_and_named),
             MT_TEST(enclosure__a_hanging_double_pendulum_gets_no_certificate),
             MT_TEST(enclosure__a_coupling_of_either_sign_is_bounded_or_named),
             MT_TEST(enclosure__a_coupling_in_proportion_is_tight_however_written),
             MT_TEST(enclosure__stiffnesses_far_apart_stay_enclosed),
             MT_TEST(enclosure__an_edge_that_is_touched_exactly),
             MT_TEST(enclosure__a_tolerance_box_is_as_large_as_it_can_be),
             MT_TEST(enclosure__a_tolerance_box_of_each_input_alone),
             MT_TEST(enclosure__corners_are_where_modes_are_lowest_and_highest),
             MT_TEST(enclosure__bands_are_counted_by_inertia_alone))
