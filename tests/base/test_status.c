/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "base/diagnostics.h"
#include "support/mt_test.h"

static void status__every_code_has_a_name_and_a_text(mt_test *t)
{
    for (int code = 0; code < MT_STATUS_COUNT; code++) {
        mt_test_row(t, "%d", code);
        CHECK(t, strncmp(mt_status_name((mt_status)code), "MT_", 3) == 0);
        CHECK(t, strcmp(mt_status_text((mt_status)code), "unknown status") != 0);
    }
    CHECK_STR(t, mt_status_name(MT_E_INPUT), "MT_E_INPUT");
    CHECK_STR(t, mt_status_text(MT_OK), "success");
    CHECK_STR(t, mt_status_text(MT_STATUS_COUNT), "unknown status");
    CHECK_STR(t, mt_status_name((mt_status)99), "MT_STATUS_UNKNOWN");
}

static void status__failures_carry_text_and_context(mt_test *t)
{
    mt_err err;
    CHECK_INT(t, mt_fail(&err, MT_E_INPUT, "lower %g is not below upper %g", 3.0, 2.0),
              MT_E_INPUT);
    CHECK_INT(t, mt_err_in(&err, MT_E_INPUT, "/variables/%d", 2), MT_E_INPUT);
    CHECK_INT(t, err.code, MT_E_INPUT);
    CHECK_STR(t, err.text, "/variables/2: lower 3 is not below upper 2");
    CHECK_INT(t, mt_fail(&err, MT_E_DOMAIN, "%s!", err.text), MT_E_DOMAIN);
    CHECK_STR(t, err.text, "/variables/2: lower 3 is not below upper 2!");
    CHECK_INT(t, mt_fail(NULL, MT_E_MEMORY, "%d", 1), MT_E_MEMORY);
    CHECK_INT(t, mt_err_in(NULL, MT_E_MEMORY, "%d", 1), MT_E_MEMORY);
    mt_err fine = {.text = ""};
    CHECK_INT(t, mt_err_in(&fine, MT_OK, "%d", 1), MT_OK);
    CHECK_STR(t, fine.text, "");
}

/* a string of n bytes: some ASCII, then only two-byte characters */
static void fill_omegas(char *s, size_t n, size_t ascii)
{
    memset(s, 'x', ascii);
    for (size_t i = ascii; i + 1 < n; i += 2) {
        memcpy(s + i, "\xCF\x89", 2);
    }
    s[n] = '\0';
}

static void status__long_text_is_cut_between_characters(mt_test *t)
{
    for (size_t ascii = 0; ascii < 2; ascii++) {
        mt_test_row(t, "%zu ascii bytes first", ascii);
        char longer[2000 + 2];
        fill_omegas(longer, 2000 + ascii, ascii);
        mt_err err;
        (void)mt_fail(&err, MT_E_INPUT, "%s", longer);
        const size_t n = strlen(err.text);
        CHECK_INT(t, n, ascii == 0 ? MT_ERR_TEXT_SIZE - 2 : MT_ERR_TEXT_SIZE - 1);
        CHECK_INT(t, (n - ascii) % 2, 0);
        CHECK(t, strncmp(err.text, longer, n) == 0);
        (void)mt_err_in(&err, MT_E_INPUT, "c"); /* three bytes more: cut again */
        const size_t m = strlen(err.text);
        CHECK(t, m < MT_ERR_TEXT_SIZE && (m - 3 - ascii) % 2 == 0);
        (void)mt_err_in(&err, MT_E_INPUT, "%s", longer); /* no room for the text at all */
        CHECK(t, strncmp(err.text, longer, n) == 0);
    }
}

static void diag__problems_are_kept_in_order(mt_test *t)
{
    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    mt_diags d = mt_diags_default(&mem);
    mt_diag_error(&d, 7, "unknown member \"%s\"", "wieght");
    mt_diag_warning(&d, MT_NO_ADDR, "no goal");
    CHECK_INT(t, d.count, 2);
    CHECK_INT(t, d.errors, 1);
    CHECK_STR(t, d.items[0].text, "unknown member \"wieght\"");
    CHECK_INT(t, d.items[0].addr, 7);
    CHECK_INT(t, d.items[1].severity, MT_SEVERITY_WARNING);
    mt_arena_free(&mem);
}

static void diag__beyond_the_limit_errors_are_only_counted(mt_test *t)
{
    mt_arena mem;
    REQUIRE(t, mt_arena_init(&mem, 0, NULL) == MT_OK);
    mt_diags d = mt_diags_default(&mem);
    for (int i = 0; i < 3 * MT_DIAG_LIMIT; i++) {
        mt_diag_error(&d, i, "problem %d", i);
        mt_diag_warning(&d, i, "hint %d", i);
    }
    CHECK_INT(t, d.count, MT_DIAG_LIMIT);
    CHECK_INT(t, d.errors, 3 * MT_DIAG_LIMIT);
    CHECK(t, !mt_arena_failed(&mem));
    mt_arena_free(&mem);
}

MT_TEST_MAIN(MT_TEST(status__every_code_has_a_name_and_a_text),
             MT_TEST(status__failures_carry_text_and_context),
             MT_TEST(status__long_text_is_cut_between_characters),
             MT_TEST(diag__problems_are_kept_in_order),
             MT_TEST(diag__beyond_the_limit_errors_are_only_counted))
