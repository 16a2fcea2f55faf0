/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the build knows of pages is what a page has. */
#include <stdio.h>
#include <string.h>

#include "base/base.h"
#include "mt_test.h"
#include "report/page.h"
#include "report/page_heads.h"

/* Base 64 (RFC 4648) of the digest of text[length], by its definition. */
static void digest_of(const char *text, size_t length, char out[45])
{
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    static const char digits[] = "0123456789abcdef";
    char hex[MT_SHA256_TEXT];
    int bits[258] = {0};
    mt_sha256(text, length, hex);
    for (int i = 0; i < 256; i++) {
        const int digit = (int)(strchr(digits, hex[i / 4]) - digits);
        bits[i] = (digit >> (3 - (i % 4))) % 2;
    }
    for (int i = 0; i < 43; i++) {
        int letter = 0;
        for (int k = 0; k < 6; k++) {
            letter = 2 * letter + bits[6 * i + k];
        }
        out[i] = letters[letter];
    }
    memcpy(out + 43, "=", sizeof "=");
}

/* The policy allows the element's text, and there is one such element. */
static void check_element(mt_test *t, const char *page, const char *open, const char *close,
                          const char *source)
{
    const char *const begin = strstr(page, open);
    const char *const end = begin == NULL ? NULL : strstr(begin, close);
    char digest[45];
    char policy[128];
    if (CHECK(t, end != NULL)) {
        const char *const text = begin + strlen(open);
        digest_of(text, (size_t)(end - text), digest);
        (void)snprintf(policy, sizeof policy, "%s 'sha256-%s'", source, digest);
        const char *const found = strstr(page, policy);
        CHECK(t, found != NULL && found < begin);
        CHECK(t, strstr(end, open) == NULL);
    }
}

static void page__of_every_kind_allows_its_style_and_script(mt_test *t)
{
    const mt_page_data data[] = {{"data", "{}"}};
    for (int kind = 0; kind < MT_PAGE_KINDS; kind++) {
        mt_text page = {.s = NULL};
        mt_test_row(t, "kind %d", kind);
        mt_page_begin((mt_page_kind)kind, "A & B", &page);
        mt_page_end(MT_COUNT(data), data, &page);
        if (CHECK(t, page.s != NULL && !page.failed)) {
            CHECK_INT(t, page.length, strlen(page.s));
            check_element(t, page.s, "<style>", "</style>", "style-src");
            if (kind != MT_PAGE_PLAIN) {
                check_element(t, page.s, "<script>", "</script>", "script-src");
            }
            CHECK(t, (strstr(page.s, "<script>") == NULL) == (kind == MT_PAGE_PLAIN));
            CHECK(t, (strstr(page.s, "script-src") == NULL) == (kind == MT_PAGE_PLAIN));
            CHECK(t, (strstr(page.s, "window.mt.show =") != NULL ||
                      strstr(page.s, "mt.show = show") != NULL) ==
                         (kind == MT_PAGE_REPORT_SCENE || kind == MT_PAGE_SHOW));
            CHECK(t, strstr(page.s, "<title>A &amp; B</title>") != NULL);
        }
        mt_text_free(&page);
    }
}

/* Of pages of any length, of what is only nearly one, and of any other text. */
static void page__has_the_digest_of_all_its_bytes(mt_test *t)
{
    char got[MT_SHA256_TEXT];
    char want[MT_SHA256_TEXT];
    for (int kind = 0; kind < MT_PAGE_KINDS; kind++) {
        const mt_page_head *const head = &mt_page_heads[kind];
        mt_text text = {.s = NULL};
        mt_text_add_n(&text, head->text, head->length);
        for (int more = 0; more < 66 && CHECK(t, text.s != NULL); more++) {
            mt_test_row(t, "kind %d and %d bytes", kind, more);
            mt_sha256(text.s, text.length, want);
            mt_page_sha256(text.s, text.length, got);
            CHECK_STR(t, got, want);
            mt_text_add(&text, "x");
        }
        for (size_t at = 0; at < head->length && text.s != NULL; at += head->length - 1) {
            mt_test_row(t, "kind %d, another byte at %zu", kind, at);
            text.s[at] = '#';
            mt_sha256(text.s, text.length, want);
            mt_page_sha256(text.s, text.length, got);
            CHECK_STR(t, got, want);
            text.s[at] = head->text[at];
        }
        mt_test_row(t, "kind %d, one byte less", kind);
        mt_sha256(head->text, head->length - 1, want);
        mt_page_sha256(head->text, head->length - 1, got);
        CHECK_STR(t, got, want);
        mt_text_free(&text);
    }
    mt_sha256("", 0, want);
    mt_page_sha256("", 0, got);
    CHECK_STR(t, got, want);
}

MT_TEST_MAIN(MT_TEST(page__of_every_kind_allows_its_style_and_script),
             MT_TEST(page__has_the_digest_of_all_its_bytes))
