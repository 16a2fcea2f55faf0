/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A tuned mass damper: 1 kg on 1 N/m, and an absorber of mu kg on k2 and c2. With the tuning f
 * = 1/(1 + mu), k2 = mu f^2, c2 = 2 zeta_a mu f, both modes have one damping ratio zeta:
 * comparing the characteristic polynomial with
 *     (s^2 + 2 zeta w1 s + w1^2)(s^2 + 2 zeta w2 s + w2^2)
 * gives w1 w2 = f, zeta (w1 + w2) = zeta_a and
 *     zeta_a^2 = zeta^2 (1 + 3 f - 4 zeta^2 f)
 * up to where the frequencies meet, zeta_a^2 = mu/(1 + mu), zeta = sqrt(mu)/2, the most that
 * both modes can have.
 */
#include "study_fixture.h"

#define MU 0.05
#define ABSORBER                                                                        \
    "{'format': 'modetune-model/1', 'dimension': 2,"                                    \
    "'parameters': {'mu': 0.05, 'k2': 'mu/(1 + mu)^2', 'c2': 0.001},"                   \
    "'bodies': [{'name': 'main', 'mass_kg': 1, 'inertia_kg_m2': 1, 'centre': [1, 0]},"  \
    " {'name': 'absorber', 'mass_kg': 'mu', 'inertia_kg_m2': 1, 'centre': [2, 0]}],"    \
    "'joints': [{'name': 's', 'type': 'prismatic', 'bodies': ['ground', 'main'],"       \
    " 'at': [1, 0], 'axis': [1, 0]}, {'name': 't', 'type': 'prismatic',"                \
    " 'bodies': ['main', 'absorber'], 'at': [2, 0], 'axis': [1, 0]}],"                  \
    "'springs': [{'name': 'k', 'type': 'axial', 'joint': 's', 'stiffness_n_per_m': 1}," \
    " {'name': 'k2', 'type': 'axial', 'joint': 't', 'stiffness_n_per_m': 'k2'}],"       \
    "'dampers': [{'name': 'c', 'type': 'axial', 'joint': 't', 'damping_n_s_per_m': 'c2'}]}"
#define BOTH(ratio)                                                    \
    "'goals': [{'type': 'damping', 'mode': 1, 'at_least': " ratio "}," \
    "{'type': 'damping', 'mode': 2, 'at_least': " ratio "}]"
#define TUNE                                                          \
    "'variables': [{'parameter': 'c2', 'lower': 1e-4, 'upper': 0.1}," \
    " {'parameter': 'k2', 'lower': 0.01, 'upper': 0.1}],"

static double parameter(const study_case *c, const char *name)
{
    const mt_recommendation *const rec = &c->result->recommendations[0];
    for (int i = 0; i < rec->n_parameters; i++) {
        if (strcmp(rec->parameters[i].name, name) == 0) {
            return rec->parameters[i].recommended;
        }
    }
    return nan("");
}

static void damping__least_damper_has_its_closed_form(mt_test *t)
{
    static const double RATIO = 0.1;
    study_case c;
    if (study_solve(t, ABSORBER,
                    "'variables': [{'parameter': 'c2', 'lower': 1e-4, 'upper': 0.1}]," BOTH(
                        "0.1") ", 'objective': {'minimise': 'c2'}",
                    &c)) {
        const double f = 1.0 / (1.0 + MU);
        const double zeta = RATIO * sqrt(1.0 + (3.0 * f) - (4.0 * RATIO * RATIO * f));
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
        CHECK_NEAR(t, parameter(&c, "c2"), 2.0 * zeta * MU * f, 1e-6);
        for (int i = 0; i < 2; i++) {
            const mt_result_goal *const g = &c.result->recommendations[0].goals[i];
            CHECK_NEAR(t, g->value, RATIO, 1e-6);
            CHECK(t, strcmp(g->type, "damping") == 0 && g->met);
        }
    }
    study_free(&c);
}

/* Just below the greatest ratio that both modes can have a design exists, above none; the
 * nearest has the optimal tuning. */
static void damping__of_both_modes_ends_at_half_the_root_of_mu(mt_test *t)
{
    const double most = 0.5 * sqrt(MU);
    const double f = 1.0 / (1.0 + MU);
    study_case c;
    if (study_solve(t, ABSORBER, TUNE BOTH("0.1118"), &c)) { /* 0.111803... */
        CHECK_INT(t, c.result->status, MT_RESULT_SOLVED);
    }
    study_free(&c);
    if (study_solve(t, ABSORBER, TUNE BOTH("0.115"), &c)) {
        CHECK(t, c.result->status != MT_RESULT_SOLVED);
        CHECK_NEAR(t, c.result->recommendations[0].goals[0].value, most, 1e-4);
        CHECK_NEAR(t, c.result->recommendations[0].goals[1].value, most, 1e-4);
        CHECK_NEAR(t, parameter(&c, "k2"), MU * f * f, 1e-3);
        CHECK_NEAR(t, parameter(&c, "c2"), 2.0 * sqrt(MU / (1.0 + MU)) * MU * f, 1e-3);
    }
    study_free(&c);
}

MT_TEST_MAIN(MT_TEST(damping__least_damper_has_its_closed_form),
             MT_TEST(damping__of_both_modes_ends_at_half_the_root_of_mu))
