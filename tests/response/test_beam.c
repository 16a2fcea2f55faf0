/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A clamped beam of Euler and Bernoulli against its exact dynamic stiffness. With beta^4 = rho
 * A w^2/(E I) and b = beta L the receptance at the free end is
 *     w(L)/F = (sin b cosh b - cos b sinh b) L^3/(E I b^3 (1 + cos b cosh b)),
 * (W. J. Duncan's receptances; from w'''' = beta^4 w with w(0) = w'(0) = w''(L) = 0, E I
 * w'''(L) = -F). A cubic element's error falls as the fourth power of its length.
 */
#include "mechanics/mech.h"
#include "response/response.h"

static const char BEAM[] =
    "{ \"format\": \"modetune-model/1\", \"name\": \"b\", \"dimension\": 2,"
    "  \"links\": [ { \"name\": \"b\", \"kind\": \"beam\", \"from\": [0, 0], \"to\": [2, 0],"
    "    \"elements\": %d, \"youngs_modulus_pa\": 7e10, \"density_kg_per_m3\": 2700,"
    "    \"section\": { \"shape\": \"rectangle\", \"width_m\": 0.05, \"height_m\": 0.02 } } ],"
    "  \"joints\": [ { \"name\": \"wall\", \"type\": \"fixed\", \"bodies\": [\"ground\","
    "    \"b.start\"], \"at\": [0, 0] } ],"
    "  \"sensors\": [ { \"name\": \"tip\", \"on\": \"b\", \"fraction\": 1, \"directions\":"
    "    [\"y\"] } ], \"configurations\": { \"c\": {} } }";

static double exact(double w)
{
    const double l = 2.0;
    const double ei = 7e10 * 0.05 * 0.02 * 0.02 * 0.02 / 12.0;
    const double b = l * pow(2700.0 * 0.05 * 0.02 * w * w / ei, 0.25);
    return ((sin(b) * cosh(b)) - (cos(b) * sinh(b))) * l * l * l /
           (ei * b * b * b * (1.0 + (cos(b) * cosh(b))));
}

/* Largest error over frequencies below 100 Hz that are not next to a resonance, in parts of
 * the value there. */
static double worst(mt_test *t, int elements)
{
    char text[1024];
    mech m = {.n = 0};
    mt_response r = {.a = NULL};
    mt_err err = {.text = ""};
    const char *const port = "tip.y";
    const mt_response_request request = {
        .n_in = 1, .inputs = &port, .n_out = 1, .outputs = &port};
    double most = 0.0;
    (void)snprintf(text, sizeof text, BEAM, elements);
    if (mech_must(t, mech_parse(t, text), NULL, "", &m) &&
        CHECK(t, mt_response_open(m.a, &request, &r, &err) == MT_OK)) {
        for (int i = 0; i < 27; i++) {
            const double hz = 0.5 + (3.7 * i);
            double complex h = 0.0;
            const mt_sample s = {.h = &h};
            const double want = exact(2.0 * MECH_PI * hz);
            CHECK(t, mt_transfer_at(r.chosen, 2.0 * MECH_PI * hz, &s, &r.mem, &err) == MT_OK);
            const double off = fabs(creal(h) - want) / fabs(want);
            most = off <= most ? most : off;
        }
    }
    mt_response_free(&r);
    mech_free(&m);
    return most;
}

static void beam__receptance_is_that_of_the_exact_stiffness(mt_test *t)
{
    const double coarse = worst(t, 24);
    const double middle = worst(t, 48);
    const double fine = worst(t, 96);
    CHECK(t, fine < 2e-5);
    CHECK(t, coarse / middle > 13.0 && coarse / middle < 19.0); /* 2^4 */
    CHECK(t, middle / fine > 13.0 && middle / fine < 19.0);
}

MT_TEST_MAIN(MT_TEST(beam__receptance_is_that_of_the_exact_stiffness))
