/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A design's record as words, as a journal keeps it. What is read is believed in nothing: words
 * that are cut, or changed one at a time, are refused, or are those of another design, which
 * says the same words again.
 */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "result/record.h"
#include "result/result.h"
#include "support/mt_test.h"

enum { VARIABLES = 2 };

static mt_result_tolerance tolerances[VARIABLES];
static mt_tolerance_box box = {.all_percent = 2.5,
                               .edge = "mode 2 at the lower edge",
                               .proven = true,
                               .n_variables = VARIABLES,
                               .variables = tolerances};
static mt_result_parameter parameters[VARIABLES];
static mt_result_mode_placement placements[1] = {
    {.id = 1, .configuration = "held", .band = "4P", .upper_hz = 3.5, .modes_below = 2}};
static mt_reason reasons[1] = {{"change", NULL, "k rises by 3 %."}};

static double slopes[VARIABLES] = {0.25, -1.5};
static mt_result_frequency frequencies[1];

static mt_recommendation design(bool with_box)
{
    mt_recommendation r = mt_recommendation_default();
    for (int i = 0; i < VARIABLES; i++) {
        parameters[i].name = i == 0 ? "k" : "mass of the end";
        parameters[i].recommended = 1.25 * i;
        tolerances[i].name = parameters[i].name;
    }
    frequencies[0] = mt_result_frequency_default();
    frequencies[0].configuration = "held";
    frequencies[0].sensitivity = slopes;
    r.frequencies = frequencies;
    r.n_frequencies = 1;
    r.rank = 3;
    r.feasible = true;
    r.grade = "feasible";
    r.worst_case = "sampled";
    r.score = nan("");
    r.parameters = parameters;
    r.n_parameters = VARIABLES;
    r.tolerance_box = with_box ? &box : NULL;
    r.placements = placements;
    r.n_placements = 1;
    r.reasons = reasons;
    r.n_reasons = 1;
    return r;
}

/* Its words; to be freed. */
static mt_serializer written(mt_recommendation *r)
{
    mt_serializer serializer = {.words = NULL};
    mt_record_serialize(&mt_design_record, r, VARIABLES, &serializer, NULL);
    return serializer;
}

/* Are these words refused, or those of the design that is read of them? */
static bool are_honest(const uint64_t *words, size_t n, bool *read)
{
    mt_recommendation r = mt_recommendation_default();
    mt_arena mem = {0};
    bool honest = mt_arena_init(&mem, 0, NULL) == MT_OK;
    mt_serializer serializer = mt_serializer_of(words, n);
    mt_record_serialize(&mt_design_record, &r, VARIABLES, &serializer, &mem);
    *read = mt_serializer_is_read(&serializer);
    if (*read) {
        mt_serializer again = written(&r);
        honest = honest && !again.failed && again.n == n &&
                 memcmp(again.words, words, n * sizeof *words) == 0;
        mt_serializer_free(&again);
    }
    mt_arena_free(&mem);
    return honest;
}

static void record_tape__reads_what_was_written_and_nothing_else(mt_test *t)
{
    for (int with_box = 0; with_box < 2; with_box++) {
        bool read = false;
        mt_recommendation r = design(with_box == 1);
        mt_serializer serializer = written(&r);
        mt_test_row(t, "%s box", with_box == 1 ? "a" : "no");
        REQUIRE(t, !serializer.failed && serializer.n > 50);
        CHECK(t, are_honest(serializer.words, serializer.n, &read) && read);
        for (size_t n = 0; n < serializer.n; n++) {
            mt_test_row(t, "cut behind word %d", (int)n);
            CHECK(t, are_honest(serializer.words, n, &read) && !read);
        }
        mt_serializer_free(&serializer);
    }
}

static void record_tape__changed_words_are_refused_or_another_design(mt_test *t)
{
    static const uint64_t values[] = {
        0, 1, 2, 3, 7, 1000, INT_MAX, (uint64_t)INT_MAX + 1, UINT64_C(1) << 40, UINT64_MAX};
    for (int with_box = 0; with_box < 2; with_box++) {
        mt_recommendation r = design(with_box == 1);
        mt_serializer serializer = written(&r);
        int refused = 0;
        REQUIRE(t, !serializer.failed);
        for (size_t i = 0; i < serializer.n; i++) {
            const uint64_t was = serializer.words[i];
            for (int k = 0; k < MT_COUNT(values) + 2; k++) {
                bool read = false;
                serializer.words[i] = k < MT_COUNT(values)    ? values[k]
                                      : k == MT_COUNT(values) ? was + 1
                                                              : was ^ 1;
                mt_test_row(t, "%s box, word %d: %llx in place of %llx",
                            with_box == 1 ? "a" : "no", (int)i,
                            (unsigned long long)serializer.words[i], (unsigned long long)was);
                CHECK(t, are_honest(serializer.words, serializer.n, &read));
                refused += !read;
            }
            serializer.words[i] = was;
        }
        CHECK(t, refused > 100);
        mt_serializer_free(&serializer);
    }
}

/* Where there is an option there is one: neither none nor two of it. */
static void record_tape__of_an_option_there_is_one(mt_test *t)
{
    mt_recommendation r = design(false);
    mt_serializer without = written(&r);
    r = design(true);
    mt_serializer with = written(&r);
    size_t flag = 0;
    REQUIRE(t, !without.failed && !with.failed && with.n > without.n);
    while (flag < without.n && with.words[flag] == without.words[flag]) {
        flag++;
    }
    const size_t own = with.n - without.n - 1; /* words of the box, behind flag and count */
    for (uint64_t count = 0; count < 4; count++) {
        uint64_t words[1024];
        size_t n = flag + 2;
        bool read = false;
        REQUIRE(t, (size_t)count * own + with.n < MT_COUNT(words));
        memcpy(words, with.words, flag * sizeof *words);
        words[flag] = 1;
        words[flag + 1] = count;
        for (uint64_t k = 0; k < count; k++, n += own) {
            memcpy(words + n, with.words + flag + 2, own * sizeof *words);
        }
        memcpy(words + n, without.words + flag + 1, (without.n - flag - 1) * sizeof *words);
        n += without.n - flag - 1;
        mt_test_row(t, "%d of it", (int)count);
        CHECK(t, are_honest(words, n, &read));
        CHECK(t, read == (count == 1));
    }
    mt_serializer_free(&without);
    mt_serializer_free(&with);
}

MT_TEST_MAIN(MT_TEST(record_tape__reads_what_was_written_and_nothing_else),
             MT_TEST(record_tape__changed_words_are_refused_or_another_design),
             MT_TEST(record_tape__of_an_option_there_is_one))
