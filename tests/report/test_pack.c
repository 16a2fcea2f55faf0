/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The form of packed JSON; that it says the same is held in cli/test_packed_pages.py. */
#define _XOPEN_SOURCE 700 /* strdup; NOLINT(cert-dcl37-c,cert-dcl51-cpp) */
#include <stdlib.h>
#include <string.h>

#include "mt_alloc.h"
#include "mt_test.h"
#include "report/page.h"

static void pack__says_once_what_is_said_twice(mt_test *t)
{
    static const struct {
        const char *name;
        const char *json;
        const char *want;
    } rows[] = {
        {"a number", "-1.5e3", "[[],[],-1.5e3]"},
        {"a text", "\"a\\\"[]{}\\\\\"", "[[],[],\"a\\\"[]{}\\\\\"]"},
        {"nothing twice", "{\"a\":[1,2],\"b\":{}}", "[[],[],{\"a\":[1,2],\"b\":{}}]"},
        {"a list", "[[1.25,2.25,3.25],[1.25,2.25,3.25]]",
         "[[],[[1.25,2.25,3.25]],[{\"#\":0},{\"#\":0}]]"},
        {"too short to be shared", "[[1,2],[1,2]]", "[[],[],[[1,2],[1,2]]]"},
        {"texts, however short", "[[\"\"],[\"\"]]", "[[],[[\"\"]],[{\"#\":0},{\"#\":0}]]"},
        {"names", "[{\"a\":1,\"b\":2},{\"a\":3,\"b\":4}]",
         "[[[\"a\",\"b\"]],[],[{\"~\":[0,1,2]},{\"~\":[0,3,4]}]]"},
        {"one within another", "[[[\"x\"],[\"y\"]],[\"x\"],[[\"x\"],[\"y\"]]]",
         "[[],[[{\"#\":1},[\"y\"]],[\"x\"]],[{\"#\":0},{\"#\":1},{\"#\":0}]]"},
        {"names of ours", "[{\"#\":0},{\"#\":0}]", "[[],[],[{\"#\":0},{\"#\":0}]]"},
        {"and the other", "{\"~\":[0]}", "[[],[],{\"~\":[0]}]"},
        {"white space", " [\n  {\n    \"a b\": [1, 2],\n    \"c\": {}\n  },\n  [ ]\n]\n",
         "[[],[],[{\"a b\":[1,2],\"c\":{}},[]]]"},
        {"the same, indented otherwise", "[[[\n  \"x\"\n]], [\n    \"x\"\n  ]]",
         "[[],[[\"x\"]],[[{\"#\":0}],{\"#\":0}]]"},
        {"what could end an element", "{\"</a>\":\"<\\\\<\"}",
         "[[],[],{\"\\u003c/a>\":\"\\u003c\\\\\\u003c\"}]"},
        {"names ahead of lists", "[{\"a\":[1],\"b\":\",\"},{\"a\":{},\"b\":[[2]]}]",
         "[[[\"a\",\"b\"]],[],[{\"~\":[0,[1],\",\"]},{\"~\":[0,{},[[2]]]}]]"},
        {"nothing within", "[{},{},[],[]]", "[[],[{}],[{\"#\":0},{\"#\":0},[],[]]]"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_text out = {.s = NULL};
        mt_test_row(t, "%s", rows[i].name);
        mt_dedupe_json(rows[i].json, &out);
        CHECK(t, !out.failed && out.s != NULL);
        CHECK_STR(t, out.s, rows[i].want);
        mt_text_free(&out);
    }
}

/* Every shortage is told. */
static void pack__survives_every_failing_allocation(mt_test *t)
{
    static const char json[] = "[{\"a\":[1.25,2.25,3.25]},{\"a\":[1.25,2.25,3.25]}]";
    const long before = mt_alloc_live();
    bool failed = true;
    for (long nth = 0; mt_alloc_works() && failed; nth++) {
        mt_text out = {.s = NULL};
        mt_alloc_fail_after(nth);
        mt_dedupe_json(json, &out);
        mt_alloc_fail_after(-1);
        failed = out.failed;
        mt_text_free(&out);
        CHECK(t, mt_alloc_live() == before);
    }
    CHECK(t, !mt_alloc_works() || !failed);
}

/* A text that memory cut, or that misses a byte, ends too, within itself. */
static void pack__ends_where_its_text_is_damaged(mt_test *t)
{
    static const char json[] = "[{\"a\":[1.25,2.25,3.25],\"b\":\"\\\"x\"},[[\"c\"],{},[]]]";
    char damaged[sizeof json];
    for (size_t i = 0; i < sizeof json - 1; i++) {
        for (int cut = 0; cut < 2; cut++) {
            mt_text out = {.s = NULL};
            memcpy(damaged, json, i);
            memcpy(damaged + i, cut ? "" : json + i + 1, cut ? 1 : sizeof json - i - 1);
            char *const own = strdup(damaged); /* so that a step beyond it shows */
            mt_test_row(t, "%s", damaged);
            mt_dedupe_json(own, &out);
            CHECK(t, own != NULL && !out.failed && out.length < 8 * sizeof json);
            free(own);
            mt_text_free(&out);
        }
    }
}

MT_TEST_MAIN(MT_TEST(pack__says_once_what_is_said_twice),
             MT_TEST(pack__ends_where_its_text_is_damaged),
             MT_TEST(pack__survives_every_failing_allocation))
