/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/visible.h"

#include <stdio.h>
#include <string.h>

size_t mt_utf8_length(const char *s, size_t n)
{
    const unsigned char *const u = (const unsigned char *)s;
    if (n == 0 || u[0] < 0x80U) {
        return n == 0 ? 0 : 1;
    }
    if (u[0] < 0xC2U || u[0] > 0xF4U) {
        return 0;
    }
    const size_t length = u[0] < 0xE0U ? 2 : u[0] < 0xF0U ? 3 : 4;
    const unsigned low = u[0] == 0xE0U ? 0xA0U : u[0] == 0xF0U ? 0x90U : 0x80U;
    const unsigned high = u[0] == 0xEDU ? 0x9FU : u[0] == 0xF4U ? 0x8FU : 0xBFU;
    if (n < length || u[1] < low || u[1] > high) {
        return 0;
    }
    for (size_t i = 2; i < length; i++) {
        if ((u[i] & 0xC0U) != 0x80U) {
            return 0;
        }
    }
    return length;
}

unsigned mt_utf8_code(const char *s, size_t length)
{
    static const unsigned char lead[] = {0, 0x7FU, 0x1FU, 0x0FU, 0x07U};
    unsigned code = (unsigned char)s[0] & (unsigned)lead[length];
    for (size_t i = 1; i < length; i++) {
        code = (code << 6U) | ((unsigned char)s[i] & 0x3FU);
    }
    return code;
}

/* Control characters, and format characters (general category Cf, Zl, Zp) that show nothing of
 * themselves. */
static bool is_hidden(unsigned code)
{
    static const unsigned ranges[][2] = {
        {0x0U, 0x1FU},      {0x7FU, 0x9FU},     {0xADU, 0xADU},       {0x61CU, 0x61CU},
        {0x180EU, 0x180EU}, {0x200BU, 0x200FU}, /* zero-width space to right-to-left mark */
        {0x2028U, 0x202EU}, /* separators, embeddings and overrides of direction */
        {0x2060U, 0x206FU}, /* word joiner, isolates */
        {0xFEFFU, 0xFEFFU}, {0xFFF9U, 0xFFFBU}, {0xE0000U, 0xE007FU}, /* tags */
    };
    for (int i = 0; i < MT_COUNT(ranges); i++) {
        if (code >= ranges[i][0] && code <= ranges[i][1]) {
            return true;
        }
    }
    return false;
}

static bool is_layout(const char *s, size_t n)
{
    return *s == '\n' || *s == '\t' || (*s == '\r' && n > 1 && s[1] == '\n');
}

size_t mt_visible_run(const char *s, size_t n, bool lines)
{
    size_t at = 0;
    while (at < n) {
        const char *const c = s + at;
        if (*c >= ' ' && *c < 0x7F) {
            at++;
            continue;
        }
        const size_t length = mt_utf8_length(c, n - at);
        if (!(lines && is_layout(c, n - at)) &&
            (length == 0 || is_hidden(mt_utf8_code(c, length)))) {
            break;
        }
        at += length;
    }
    return at;
}

size_t mt_visible_escape(const char *s, size_t n, char out[MT_VISIBLE_SIZE])
{
    const size_t length = mt_utf8_length(s, n);
    const unsigned code = length == 0 ? 0 : mt_utf8_code(s, length);
    if (length == 0) {
        (void)snprintf(out, MT_VISIBLE_SIZE, "\\x%02x", (unsigned)(unsigned char)*s);
    } else if (code < 0x10000U) {
        (void)snprintf(out, MT_VISIBLE_SIZE, "\\u%04x", code);
    } else {
        const unsigned high = 0xD800U + ((code - 0x10000U) >> 10U);
        const unsigned low = 0xDC00U + (code & 0x3FFU);
        (void)snprintf(out, MT_VISIBLE_SIZE, "\\u%04x\\u%04x", high, low);
    }
    return length == 0 ? 1 : length;
}

void mt_text_add_visible(mt_text *t, const char *s)
{
    size_t left = strlen(s);
    while (left > 0) {
        const size_t run = mt_visible_run(s, left, false);
        mt_text_add_n(t, s, run);
        s += run;
        left -= run;
        if (left > 0) {
            char escape[MT_VISIBLE_SIZE];
            const size_t used = mt_visible_escape(s, left, escape);
            mt_text_add(t, escape);
            s += used;
            left -= used;
        }
    }
}
