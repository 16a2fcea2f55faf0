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
        {"", "", 3, 0},
        {"", "abc", 3, 3},
        {"abc", "abc", 0, 0},
        {"weight", "wieght", 2, 1}, /* one swap of neighbours */
        {"ca", "abc", 9, 3},        /* no edit inside a swapped pair: 3, not 2 */
        {"kitten", "sitting", 9, 3},
        {"kitten", "sitting", 2, 3}, /* cut off */
        {"a", "abcdefg", 2, 3},      /* cut off by length alone */
        {"K_T9", "K_T8", 1, 1},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s / %s", rows[i].a, rows[i].b);
        CHECK_INT(t, mt_text_distance(rows[i].a, rows[i].b, rows[i].most), rows[i].want);
        CHECK_INT(t, mt_text_distance(rows[i].b, rows[i].a, rows[i].most), rows[i].want);
    }
}

/* The definition, all cells of it. */
static int distance_by_definition(const char *a, const char *b)
{
    int d[8][8];
    const int m = (int)strlen(a);
    const int n = (int)strlen(b);
    for (int i = 0; i <= m; i++) {
        for (int j = 0; j <= n; j++) {
            d[i][j] = i + j;
            if (i == 0 || j == 0) {
                continue;
            }
            const int replaced = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            const int longer = (d[i - 1][j] < d[i][j - 1] ? d[i - 1][j] : d[i][j - 1]) + 1;
            d[i][j] = replaced < longer ? replaced : longer;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
                d[i - 2][j - 2] + 1 < d[i][j]) {
                d[i][j] = d[i - 2][j - 2] + 1;
            }
        }
    }
    return d[m][n];
}

/* All words of up to five letters of two, against all, with every cut. */
static void text__distance_is_that_of_the_definition_wherever_it_is_cut(mt_test *t)
{
    char words[63][6];
    int n = 0;
    for (int length = 0; length <= 5; length++) {
        for (unsigned bits = 0; bits < 1U << (unsigned)length; bits++) {
            for (int k = 0; k < length; k++) {
                words[n][k] = (bits >> (unsigned)k & 1U) != 0U ? 'b' : 'a';
            }
            words[n++][length] = '\0';
        }
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            const int whole = distance_by_definition(words[i], words[j]);
            for (int most = 0; most <= 6; most++) {
                mt_test_row(t, "%s / %s, cut at %d", words[i], words[j], most);
                CHECK_INT(t, mt_text_distance(words[i], words[j], most),
                          whole < most + 1 ? whole : most + 1);
            }
        }
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
        {"wieght", "weight"}, {"K_T9", "K_T1"}, {"uper", "upper"},
        {"zzzzz", NULL},      {"b", NULL},      {"", NULL},
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
        {"bar*", "bar12", true},
        {"bar*", "bar", true},
        {"bar*", "crowbar", false},
        {"*bar", "crowbar", true},
        {"*", "", true},
        {"", "a", false},
        {"", "", true},
        {"k_?", "k_1", true},
        {"k_?", "k_", false},
        {"a*b*c", "aXbXbXXc", true},
        {"a*b*c", "aXbXXcX", false},
        {"*aaab*", "aaaaaaab", true}, /* needs to go back behind the star */
        {"**", "any", true},
        {"abc?*", "abc", false},
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
    /* less or equal */
    CHECK_INT(t,
              mt_text_width("a\xE2\x89\xA4"
                            "b"),
              3);
}

MT_TEST_MAIN(MT_TEST(text__grows_and_formats),
             MT_TEST(text__impossible_lengths_set_failed_and_keep_the_text),
             MT_TEST(text__distance_counts_edits_and_swaps),
             MT_TEST(text__distance_is_that_of_the_definition_wherever_it_is_cut),
             MT_TEST(text__very_long_names_are_only_compared),
             MT_TEST(text__nearest_name_is_offered_only_when_near),
             MT_TEST(text__patterns_match_whole_names), MT_TEST(text__width_counts_code_points))
