/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models made in memory. What files can have wrong is in tests/documents/wrong. */
#include "modetune/model.h"

#include <stdio.h>
#include <string.h>

#include "model/model.h"
#include "model/read.h"
#include "mt_test.h"

static void names__all_are_found_again(mt_test *t)
{
    enum { COUNT = 1000, NAME = 16 };
    static char names[COUNT][NAME];
    mt_arena mem = {0};
    mt_names table = {0};
    bool taken = true;
    bool found = true;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    CHECK_INT(t, mt_names_find(&table, "x", 1, &found), MT_ABSENT);
    CHECK(t, !found);
    int wrong = 0;
    for (int i = 0; i < COUNT; i++) {
        (void)snprintf(names[i], NAME, "k_%d", i);
        mt_names_add(&table, &mem, names[i], i, &taken);
        wrong += taken;
    }
    for (int i = 0; i < COUNT; i++) {
        wrong += mt_names_find(&table, names[i], strlen(names[i]), &found) != i || !found;
    }
    CHECK_INT(t, wrong, 0);
    mt_names_add(&table, &mem, "k_7", 99, &taken);
    CHECK(t, taken);
    CHECK_INT(t, mt_names_find(&table, "k_77", 3, &found), 7); /* the first three bytes */
    CHECK_INT(t, mt_names_find(&table, "k_", 2, &found), MT_ABSENT);
    mt_arena_free(&mem);
}

/* A parameter given by an expression. */
static bool add_parameter(mt_model *m, const char *name, const char *text)
{
    mt_expr expr;
    const int at = mt_model_lookup(m, name, strlen(name));
    if (mt_expr_parse(text, &(mt_expr_scope){.lookup = mt_model_lookup, .context = m}, &m->mem,
                      &expr, NULL) != MT_OK) {
        return false;
    }
    m->parameters[at].value = mt_model_add_num(m, expr, MT_NO_ADDR);
    return m->parameters[at].value != MT_ABSENT;
}

static void finish__finds_problems_without_a_file(mt_test *t)
{
    mt_model *m = NULL;
    REQUIRE(t, mt_model_new(&m, NULL) == MT_OK);
    mt_parameter parameters[] = {{.name = {"a", MT_NO_ADDR}}, {.name = {"b", MT_NO_ADDR}}};
    mt_drive drive = {
        .joint_name = {"pin", MT_NO_ADDR}, .addr = MT_NO_ADDR, .position = MT_ABSENT};
    mt_configuration configuration = {
        .name = {"up", MT_NO_ADDR}, .like = MT_ABSENT, .drives = &drive, .n_drives = 1};
    mt_diags diags = mt_diags_default(&m->mem);
    m->dimension = 2;
    m->parameters = parameters;
    m->n_parameters = 2;
    m->configurations = &configuration;
    m->n_configurations = 1;
    CHECK(t, add_parameter(m, "a", "b") && add_parameter(m, "b", "2*a"));
    CHECK_INT(t, mt_model_resolve(m, &diags, NULL), MT_E_INPUT);
    if (CHECK_INT(t, diags.count, 2)) {
        CHECK_STR(t, diags.items[0].text, "unknown joint \"pin\"");
        CHECK_STR(t, diags.items[1].text,
                  "parameters refer to each other in a circle: a -> b -> a");
    }
    CHECK_INT(t, diags.structural, 0);
    mt_model_delete(m);
}

static void finish__fails_where_memory_ran_out_before(mt_test *t)
{
    mt_model *m = NULL;
    REQUIRE(t, mt_model_new(&m, NULL) == MT_OK);
    mt_diags diags = mt_diags_default(&m->mem);
    const mt_arena_mark before = mt_arena_get_mark(&m->mem);
    m->dimension = 2;
    mt_arena_fail(&m->mem);
    CHECK_INT(t, mt_model_resolve(m, &diags, NULL), MT_E_MEMORY);
    CHECK_INT(t, mt_model_resolve(m, &diags, NULL), MT_E_MEMORY);
    mt_arena_rewind(&m->mem, before); /* who was told begins anew */
    CHECK_INT(t, mt_model_resolve(m, &diags, NULL), MT_OK);
    CHECK_STR(t, mt_model_configuration_name(m, 0), "default");
    mt_model_delete(m);
    mt_model_delete(NULL);
}

MT_TEST_MAIN(MT_TEST(names__all_are_found_again),
             MT_TEST(finish__finds_problems_without_a_file),
             MT_TEST(finish__fails_where_memory_ran_out_before))
