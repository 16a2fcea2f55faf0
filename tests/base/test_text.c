/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "base/text.h"
#include "support/mt_test.h"

static void text__grows_and_formats(mt_test *t)
{
    mt_text text = {0};
    mt_text_add(&text, "");
    CHECK_STR(t, text.s, "");
    for (int i = 0; i < 300; i++) {
        mt_text_addf(&text, "%02d,", i % 100);
    }
    mt_text_add_n(&text, "end of it", 3);
    CHECK_INT(t, text.length, 903);
    CHECK_INT(t, strlen(text.s), 903);
    CHECK_STR(t, text.s + 900, "end");
    CHECK(t, strncmp(text.s, "00,01,02,", 9) == 0);
    CHECK(t, !text.failed);
    mt_text_free(&text);
    mt_text_free(&text);
}

static void text__impossible_lengths_set_failed_and_keep_the_text(mt_test *t)
{
    mt_text text = {0};
    mt_text_add(&text, "kept");
    mt_text_add_n(&text, "x", SIZE_MAX - 2);
    CHECK(t, text.failed);
    mt_text_add(&text, " no more");
    CHECK_STR(t, text.s, "kept");
    mt_text_free(&text);
}

static void text__distance_counts_edits_and_swaps(mt_test *t)
{
    static const struct {
        const char *a;
        const char *b;
        int most;
        int want;
    } rows[] = {
        {      "",        "", 3, 0},
        {      "",     "abc", 3, 3},
        {   "abc",     "abc", 0, 0},
        {"weight",  "wieght", 2, 1}, /* one swap of neighbours */
        {    "ca",     "abc", 9, 3}, /* no edit inside a swapped pair: 3, not 2 */
        {"kitten", "sitting", 9, 3},
        {"kitten", "sitting", 2, 3}, /* cut off */
        {     "a", "abcdefg", 2, 3}, /* cut off by length alone */
        {  "K_T9",    "K_T8", 1, 1},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s / %s", rows[i].a, rows[i].b);
        CHECK_INT(t, mt_text_distance(rows[i].a, rows[i].b, rows[i].most), rows[i].want);
        CHECK_INT(t, mt_text_distance(rows[i].b, rows[i].a, rows[i].most), rows[i].want);
    }
}

static void text__very_long_names_are_only_compared(mt_test *t)
{
    char a[600];
    char b[600];
    memset(a, 'x', sizeof a - 1);
    a[sizeof a - 1] = '\0';
    memcpy(b, a, sizeof b);
    CHECK_INT(t, mt_text_distance(a, b, 5), 0);
    b[3] = 'y';
    CHECK_INT(t, mt_text_distance(a, b, 5), 6);
    const char *const names[] = {a};
    CHECK(t, mt_text_nearest(b, names, 1) == NULL);
}

static void text__nearest_name_is_offered_only_when_near(mt_test *t)
{
    static const char *const names[] = {"weight", "lower", "upper", "K_T1", "K_T8", "a"};
    static const struct {
        const char *name;
        const char *want;
    } rows[] = {
        {"wieght", "weight"},
        {  "K_T9",   "K_T1"},
        {  "uper",  "upper"},
        { "zzzzz",     NULL},
        {     "b",     NULL},
        {      "",     NULL},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "\"%s\"", rows[i].name);
        CHECK_STR(t, mt_text_nearest(rows[i].name, names, MT_COUNT(names)), rows[i].want);
    }
    CHECK(t, mt_text_nearest("weight", NULL, 0) == NULL);
}

static void text__patterns_match_whole_names(mt_test *t)
{
    static const struct {
        const char *pattern;
        const char *name;
        bool want;
    } rows[] = {
        {  "bar*",    "bar12",  true},
        {  "bar*",      "bar",  true},
        {  "bar*",  "crowbar", false},
        {  "*bar",  "crowbar",  true},
        {     "*",         "",  true},
        {      "",        "a", false},
        {      "",         "",  true},
        {   "k_?",      "k_1",  true},
        {   "k_?",       "k_", false},
        { "a*b*c", "aXbXbXXc",  true},
        { "a*b*c",  "aXbXXcX", false},
        {"*aaab*", "aaaaaaab",  true}, /* needs to go back behind the star */
        {    "**",      "any",  true},
        { "abc?*",      "abc", false},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s on %s", rows[i].pattern, rows[i].name);
        CHECK_INT(t, mt_text_matches(rows[i].pattern, rows[i].name), rows[i].want);
    }
}

static void text__width_counts_code_points(mt_test *t)
{
    CHECK_INT(t, mt_text_width(""), 0);
    CHECK_INT(t, mt_text_width("Hz"), 2);
    CHECK_INT(t, mt_text_width("\xCF\x89\xC2\xB2"), 2); /* omega squared */
    CHECK_INT(t,
              mt_text_width("a\xE2\x89\xA4"
                            "b"),
              3); /* less or equal */
}

MT_TEST_MAIN(MT_TEST(text__grows_and_formats),
             MT_TEST(text__impossible_lengths_set_failed_and_keep_the_text),
             MT_TEST(text__distance_counts_edits_and_swaps),
             MT_TEST(text__very_long_names_are_only_compared),
             MT_TEST(text__nearest_name_is_offered_only_when_near),
             MT_TEST(text__patterns_match_whole_names), MT_TEST(text__width_counts_code_points))
