/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A lever on a hinge, with a torsion spring k0 and an axial spring k at the distance L from the
 * hinge: omega^2 = (k0 + k L^2) / J. L shapes the geometry: modes are enclosed over the springs
 * and the inertia where L is held, at the value at which the analysis stands, and nowhere else.
 */
#include "mechanics/mech.h"
#include "prove/box.h"
#include "prove/enclosure.h"

static const char *const LEVER =
    "{\"format\": \"modetune-model/1\", \"name\": \"lever\", \"dimension\": 2,"
    "\"parameters\": {\"k0\": 200, \"k\": 1e4, \"J\": 0.5, \"L\": 0.2},"
    "\"bodies\": [{\"name\": \"lever\", \"mass_kg\": 1, \"inertia_kg_m2\": \"J\","
    "\"centre\": [0, 0]}],"
    "\"joints\": [{\"name\": \"hinge\", \"type\": \"revolute\", \"bodies\": [\"ground\","
    "\"lever\"], \"at\": [0, 0]}],"
    "\"springs\": [{\"name\": \"twist\", \"type\": \"torsion\", \"bodies\": [\"ground\","
    "\"lever\"], \"stiffness_n_m_per_rad\": \"k0\"}, {\"name\": \"rod\", \"type\": \"axial\","
    "\"bodies\": [\"ground\", \"lever\"], \"at\": [[1, \"L\"], [0, \"L\"]],"
    "\"stiffness_n_per_m\": \"k\"}],"
    "\"configurations\": {\"one\": {}}}";

enum { K0, K, J, L, INPUTS };

static double lambda_of(const double *x)
{
    return (x[K0] + (x[K] * x[L] * x[L])) / x[J];
}

static const double LOWER[INPUTS] = {100.0, 5e3, 0.25, 0.0};
static const double UPPER[INPUTS] = {400.0, 2e4, 1.0, 0.0};

static mt_enclosure *enclose(mt_test *t, const mech *s, double low, double high, char *reason)
{
    mt_err err = {.text = ""};
    mt_enclosure *e = NULL;
    double lower[INPUTS];
    double upper[INPUTS];
    memcpy(lower, LOWER, sizeof lower);
    memcpy(upper, UPPER, sizeof upper);
    lower[L] = low;
    upper[L] = high;
    CHECK_INT(t, mt_enclosure_new(s->a, lower, upper, &e, reason, &err), MT_OK);
    return e;
}

static void enclosure__a_length_is_held_where_the_analysis_stands(mt_test *t)
{
    static const double lengths[] = {0.2, 0.05, 0.31, 0.9};
    mech s;
    if (mech_must(t, mech_parse(t, LEVER), NULL, "k0 k J L", &s)) {
        bool shapes[INPUTS];
        mt_enclosure_shaping(s.a, shapes);
        CHECK(t, shapes[L] && !shapes[K0] && !shapes[K] && !shapes[J]);
    }
    for (int i = 0; i < MT_COUNT(lengths); i++) {
        const mt_analysis_options opt = mt_analysis_options_default();
        const double length = lengths[i];
        char reason[MT_REASON_SIZE] = "";
        double x[INPUTS];
        double lo[INPUTS];
        double hi[INPUTS];
        double low = 0.0;
        double high = 0.0;
        mt_test_row(t, "%g m", length);
        memcpy(x, s.at, sizeof x);
        memcpy(lo, LOWER, sizeof lo);
        memcpy(hi, UPPER, sizeof hi);
        x[L] = length;
        lo[L] = length;
        hi[L] = length;
        CHECK_INT(t, mt_analysis_solve(s.a, x, &opt, &s.err), MT_OK);
        mt_enclosure *const e = enclose(t, &s, length, length, reason);
        if (CHECK(t, e != NULL) && CHECK(t, mt_enclosure_set(e, lo, hi))) {
            CHECK_INT(t, mt_enclosure_ranges(e, &low, &high, &s.err), MT_OK);
            const double soft[INPUTS] = {lo[K0], lo[K], hi[J], length};
            const double stiff[INPUTS] = {hi[K0], hi[K], lo[J], length};
            CHECK_NEAR(t, mt_enclosure_lambda(low), lambda_of(soft), 1e-9);
            CHECK_NEAR(t, mt_enclosure_lambda(high), lambda_of(stiff), 1e-9);
            /* of another length nothing is known, nor of several */
            hi[L] = nextafter(length, 2.0);
            CHECK(t, !mt_enclosure_set(e, lo, hi));
            lo[L] = hi[L];
            CHECK(t, !mt_enclosure_set(e, lo, hi));
        }
        mt_enclosure_delete(e);
        const double others[][2] = {{0.9 * length, 0.9 * length},
                                    {length, 1.1 * length},
                                    {0.9 * length, length},
                                    {nan(""), nan("")}};
        for (int k = 0; k < MT_COUNT(others); k++) {
            CHECK(t, enclose(t, &s, others[k][0], others[k][1], reason) == NULL);
            CHECK_STR(t, reason, "parameter \"L\" shapes the geometry");
        }
    }
    mech_free(&s);
}

MT_TEST_MAIN(MT_TEST(enclosure__a_length_is_held_where_the_analysis_stands))
