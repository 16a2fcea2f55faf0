/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a model file becomes. The files of tests/schema use every member. */
#include "modetune/model.h"

#include <stdlib.h>
#include <string.h>

#include "io/json.h"
#include "model/read.h"
#include "mt_refusals.h"

static const char plane[] = MT_TEST_SOURCE_DIR "/tests/schema/plane.json";
static const char space[] = MT_TEST_SOURCE_DIR "/tests/schema/space.json";

/* Index of a body; MT_ABSENT. */
static int find_body(const mt_model *m, const char *name)
{
    for (int i = 0; i < m->n_bodies; i++) {
        if (strcmp(m->bodies[i].name.s, name) == 0) {
            return i;
        }
    }
    return MT_ABSENT;
}

/* Index of a link; MT_ABSENT. */
static int find_link(const mt_model *m, const char *name)
{
    for (int i = 0; i < m->n_links; i++) {
        if (strcmp(m->links[i].name.s, name) == 0) {
            return i;
        }
    }
    return MT_ABSENT;
}

/* The value of a number that is a constant; a NaN where it is not, so that checks fail. */
static double constant(const mt_model *m, mt_num num)
{
    double value = strtod("nan", NULL);
    if (num != MT_ABSENT && !mt_expr_is_constant(&m->nums[num].expr, &value)) {
        value = strtod("nan", NULL);
    }
    return value;
}

static void model__items_of_a_plane_model_are_read(mt_test *t)
{
    mt_model *m = NULL;
    REQUIRE(t, mt_model_load(plane, NULL, &m, NULL, NULL) == MT_OK);
    CHECK_STR(t, m->name, "Every member of a plane model");
    CHECK_INT(t, m->dimension, 2);
    CHECK_STR(t, m->path, plane);
    CHECK_INT(t, strlen(m->sha256), 64);
    CHECK_INT(t, m->n_parameters, 3);
    CHECK_STR(t, m->parameters[0].unit, "m/s^2");
    CHECK_INT(t, m->parameters[0].origin, MT_ORIGIN_ASSUMED);
    CHECK_NEAR(t, constant(m, m->parameters[0].value), 9.81, 0.0);
    int line = 0;
    int column = 0;
    CHECK(t, mt_model_locate(m, m->nums[m->parameters[2].value].addr, &line, &column));
    CHECK_INT(t, line, 12);
    CHECK_INT(t, column, 10);
    CHECK(t, !mt_model_locate(m, MT_NO_ADDR, &line, &column));
    CHECK_INT(t, mt_model_find_parameter(m, "k"), 2);
    CHECK_INT(t, mt_model_find_parameter(m, "K"), MT_ABSENT);
    const mt_body *const crank = &m->bodies[find_body(m, "crank")];
    CHECK(t, !crank->point_mass);
    CHECK_NEAR(t, constant(m, crank->inertia[0]), 1e-4, 0.0);
    CHECK_INT(t, crank->inertia[1], MT_ABSENT);
    CHECK(t, m->bodies[find_body(m, "bob")].point_mass);
    CHECK_INT(t, m->bodies[1].centre.point, 2);
    const mt_link *const beam = &m->links[find_link(m, "beam")];
    CHECK_INT(t, beam->n_stiffness, 2);
    CHECK_INT(t, beam->n_element_inertia, 1);
    CHECK_INT(t, beam->elements, 3);
    CHECK_INT(t, find_body(m, "beam"), MT_ABSENT);
    CHECK_INT(t, find_link(m, "crank"), MT_ABSENT);
    const mt_section *const tube = &m->links[1].section;
    CHECK_INT(t, tube->shape, MT_SECTION_TUBE);
    CHECK_NEAR(t, constant(m, tube->diameter), 0.02, 0.0);
    CHECK_NEAR(t, constant(m, tube->inner_diameter), 0.01, 0.0);
    mt_model_delete(m);
}

static void model__what_is_held_is_resolved(mt_test *t)
{
    mt_model *m = NULL;
    REQUIRE(t, mt_model_load(plane, NULL, &m, NULL, NULL) == MT_OK);
    const mt_joint *const pin = &m->joints[mt_model_find_joint(m, "pin")];
    CHECK_INT(t, pin->bodies[0].kind, MT_ATTACH_GROUND);
    CHECK_INT(t, pin->bodies[1].kind, MT_ATTACH_LINK_START);
    CHECK_INT(t, pin->n_at, 1);
    CHECK_INT(t, m->joints[mt_model_find_joint(m, "slide")].n_at, 2);
    const mt_joint *const slot = &m->joints[mt_model_find_joint(m, "slot")];
    CHECK_INT(t, slot->n_at, 2); /* two names of points are a pair */
    CHECK_INT(t, slot->at[1].point, 1);
    const mt_joint *const rod = &m->joints[mt_model_find_joint(m, "rod")];
    CHECK_INT(t, rod->bodies[1].kind, MT_ATTACH_LINK_NODE);
    CHECK_INT(t, rod->bodies[1].element, 2);
    CHECK_INT(t, rod->bodies[1].part, 1); /* the element that ends there */
    const mt_spring *const hinge = &m->springs[mt_model_find_spring(m, "hinge")];
    CHECK_INT(t, hinge->joint, MT_ABSENT);
    CHECK_INT(t, hinge->joint_link, 0);
    CHECK_INT(t, hinge->joint_hinge, 1);
    const mt_spring *const rubber = &m->springs[mt_model_find_spring(m, "rubber")];
    CHECK_NEAR(t, constant(m, rubber->translation[1]), 2.0, 0.0);
    CHECK_NEAR(t, constant(m, rubber->rotation[2]), 3.0, 0.0);
    CHECK_INT(t, rubber->rotation[0], MT_ABSENT);
    CHECK(t, m->springs[mt_model_find_spring(m, "oil")].damper);
    CHECK_INT(t, m->sensors[0].directions, 2 | 32);
    CHECK_INT(t, m->sensors[1].directions, 1 | 2);
    CHECK_INT(t, m->sensors[2].element, 1);
    CHECK_INT(t, m->modes[0].configuration, mt_model_find_configuration(m, "a"));
    mt_model_delete(m);
}

static void model__configurations_inherit_what_they_are_like(mt_test *t)
{
    static const char text[] =
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"gravity_m_per_s2\": [0, -1],"
        "\"parameters\": {\"p\": 1, \"q\": 2},"
        "\"bodies\": [{\"name\": \"b\", \"centre\": [0, 0], \"in\": [\"base\"]}],"
        "\"configurations\": {\"leaf\": {\"like\": \"middle\", \"parameters\": {\"q\": 30}},"
        "\"middle\": {\"like\": \"base\", \"parameters\": {\"p\": 10, \"q\": 20}, "
        "\"gravity_m_per_s2\": [0, -2]},"
        "\"base\": {}, \"other\": {}}}";
    mt_json *doc = NULL;
    mt_model *m = NULL;
    REQUIRE(t, mt_json_parse(text, strlen(text), &doc, NULL) == MT_OK);
    if (CHECK_INT(t, mt_model_from_json(doc, "text", &m, NULL), MT_OK)) {
        const mt_configuration *const leaf = &m->configurations[0];
        CHECK_INT(t, leaf->n_overrides, 2);
        CHECK_INT(t, leaf->overrides[0].parameter, 1);
        CHECK_NEAR(t, constant(m, leaf->overrides[0].value), 30.0, 0.0);
        CHECK_NEAR(t, constant(m, leaf->overrides[1].value), 10.0, 0.0);
        CHECK_INT(t, leaf->like, 1);
        CHECK(t, m->configurations[2].has_gravity);
        CHECK_INT(t, m->configurations[2].gravity[1], m->gravity[1]);
        CHECK_INT(t, leaf->gravity[1], m->configurations[1].gravity[1]);
        CHECK(t,
              mt_model_present(&m->bodies[0].in, 0) && mt_model_present(&m->bodies[0].in, 1));
        CHECK(t,
              mt_model_present(&m->bodies[0].in, 2) && !mt_model_present(&m->bodies[0].in, 3));
    }
    mt_model_delete(m);
    mt_json_delete(doc);
}

static void model__without_configurations_has_one(mt_test *t)
{
    mt_model *m = NULL;
    REQUIRE(t, mt_model_read(space, NULL, &m, NULL) == MT_OK);
    CHECK_INT(t, mt_model_configuration_count(m), 1);
    CHECK_STR(t, mt_model_configuration_name(m, 0), "default");
    CHECK_STR(t, mt_model_configuration_name(m, 1), NULL);
    CHECK_STR(t, mt_model_title(m), NULL);
    CHECK_INT(t, mt_model_dimension(m), 3);
    CHECK_STR(t, mt_model_parameter_name(m, 0), "a");
    CHECK_STR(t, mt_model_parameter_name(m, mt_model_parameter_count(m)), NULL);
    CHECK_INT(t, m->joints[mt_model_find_joint(m, "j7")].gear_joint[1], 1);
    CHECK(t, m->springs[1].matrix != NULL);
    CHECK_INT(t, m->springs[1].n_at, 2);
    mt_model_delete(m);
}

static void model__errors_name_the_first_problem_and_count_the_others(mt_test *t)
{
    mt_model *m = NULL;
    mt_err err = {MT_OK, ""};
    CHECK_INT(
        t, mt_model_read(MT_TEST_SOURCE_DIR "/tests/documents/wrong/like.json", NULL, &m, &err),
        MT_E_INPUT);
    CHECK(t, m == NULL);
    CHECK(t, strstr(err.text, "like.json:3:56: error: /configurations/b/like: ") != NULL);
    CHECK(t, strstr(err.text, "(and 2 more)") != NULL);
    CHECK_INT(t, mt_model_read("/nowhere/x.json", NULL, &m, &err), MT_E_SYSTEM);
    CHECK_STR(t, err.text, "/nowhere/x.json: No such file or directory");
}

/* A chain of parameters as long as a file allows neither overflows a stack nor takes quadratic
 * time. */
static void model__a_long_chain_of_parameters_is_no_problem(mt_test *t)
{
    enum { LENGTH = 50000 };
    mt_text text = {0};
    mt_json *doc = NULL;
    mt_model *m = NULL;
    mt_text_add(
        &text,
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"parameters\": {\"p0\": 1");
    for (int i = 1; i < LENGTH; i++) {
        mt_text_addf(&text, ", \"p%d\": \"p%d + 1\"", i, i - 1);
    }
    mt_text_add(&text, "}}");
    REQUIRE(t, !text.failed);
    CHECK_INT(t, mt_json_parse(text.s, text.length, &doc, NULL), MT_OK);
    CHECK_INT(t, mt_model_from_json(doc, "text", &m, NULL), MT_OK);
    CHECK_INT(t, mt_model_parameter_count(m), LENGTH);
    mt_model_delete(m);
    mt_json_delete(doc);
    mt_text_free(&text);
}

static mt_status load_once(mt_test *t, const void *path)
{
    mt_model *m = NULL;
    mt_diagnostics said = {.count = 0};
    const mt_status rc = mt_model_load(path, NULL, &m, &said, NULL);
    CHECK(t, (rc == MT_OK) == (m != NULL));
    mt_model_delete(m);
    mt_diagnostics_free(&said);
    return rc;
}

static void model__every_failing_allocation_is_survived(mt_test *t)
{
    static const char *const paths[] = {plane, space};
    for (int i = 0; i < MT_COUNT(paths); i++) {
        mt_refuse_each(t, paths[i], load_once, paths[i], MT_OK);
    }
}

MT_TEST_MAIN(MT_TEST(model__items_of_a_plane_model_are_read),
             MT_TEST(model__what_is_held_is_resolved),
             MT_TEST(model__configurations_inherit_what_they_are_like),
             MT_TEST(model__without_configurations_has_one),
             MT_TEST(model__errors_name_the_first_problem_and_count_the_others),
             MT_TEST(model__a_long_chain_of_parameters_is_no_problem),
             MT_TEST(model__every_failing_allocation_is_survived))
