/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts that grow, and what of a text a terminal may show. */
#include "base/text.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"

void mt_text_free(mt_text *t)
{
    free(t->s);
    *t = (mt_text){0};
}

/* Room for n more bytes and the terminator. */
static bool reserve(mt_text *t, size_t n)
{
    enum { FIRST_CAPACITY = 256 };
    if (t->failed || n > SIZE_MAX / 4 || t->length > SIZE_MAX / 4) {
        t->failed = true;
        return false;
    }
    const size_t need = t->length + n + 1;
    if (need <= t->capacity) {
        return true;
    }
    size_t capacity = t->capacity == 0 ? FIRST_CAPACITY : 2 * t->capacity;
    capacity = capacity < need ? need : capacity;
    char *const s = realloc(t->s, capacity);
    if (s == NULL) {
        t->failed = true;
        return false;
    }
    t->s = s;
    t->capacity = capacity;
    return true;
}

void mt_text_reserve(mt_text *t, size_t n)
{
    (void)reserve(t, n);
}

void mt_text_add(mt_text *t, const char *s)
{
    mt_text_add_n(t, s, strlen(s));
}

void mt_text_add_n(mt_text *t, const char *s, size_t n)
{
    if (!reserve(t, n)) {
        return;
    }
    memcpy(t->s + t->length, s, n);
    t->length += n;
    t->s[t->length] = '\0';
}

void mt_text_add_uri(mt_text *t, const char *path)
{
    static const char plain[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
    static const char digits[] = "0123456789ABCDEF";
    for (const char *c = path; *c != '\0'; c++) {
        const unsigned byte = (unsigned char)*c;
        const char escape[] = {'%', digits[byte >> 4U], digits[byte & 15U]};
        const bool as_it_is = strchr(plain, *c) != NULL;
        mt_text_add_n(t, as_it_is ? c : escape, as_it_is ? 1 : sizeof escape);
    }
}

void mt_text_addf(mt_text *t, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    va_list again;
    va_copy(again, args);
    const bool ready = reserve(t, 0);
    const size_t room = ready ? t->capacity - t->length : 0; /* often enough */
    const int n = mt_vsnprintf(ready ? t->s + t->length : NULL, room, fmt, args);
    if (n < 0) {
        t->failed = true;
    } else if (reserve(t, (size_t)n)) {
        if ((size_t)n >= room) {
            (void)mt_vsnprintf(t->s + t->length, (size_t)n + 1, fmt, again);
        }
        t->length += (size_t)n;
    }
    if (t->s != NULL) {
        t->s[t->length] = '\0';
    }
    va_end(again);
    va_end(args);
}

static int lesser_of(int a, int b)
{
    return a < b ? a : b;
}

/* Optimal string alignment by rows: d(i, j) edits turn the first i bytes of a into the first j
 * of b,
 *   d(i, j) = min( d(i-1, j) + 1, d(i, j-1) + 1, d(i-1, j-1) + [a_i != b_j], d(i-2, j-2) + 1 if
 *   two neighbours are swapped ).
 * Only the last three rows are kept, and of them the cells |i - j| <= most: the others are
 * above `most`, which the cells beside these say; and so are all rows behind two that are. Row
 * i of them; returns its least cell. */
static int fill_row(const char *a, const char *b, int i, int n, int most,
                    int rows[3][MT_TEXT_DISTANCE_MAX + 2])
{
    const int *const before = rows[(i + 1) % 3];
    const int *const last = rows[(i + 2) % 3];
    int *const row = rows[i % 3];
    const int first = i > most ? i - most : 1;
    const int end = lesser_of(n, i + most);
    int nearest = lesser_of(i, most + 1);
    row[first - 1] = nearest;
    for (int j = first; j <= end; j++) {
        const int replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
        row[j] = lesser_of(replaced, lesser_of(last[j], row[j - 1]) + 1);
        if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
            row[j] = lesser_of(row[j], before[j - 2] + 1);
        }
        nearest = lesser_of(nearest, row[j]);
    }
    row[end + 1] = most + 1;
    return nearest;
}

int mt_text_distance(const char *a, const char *b, int most)
{
    const size_t la = strlen(a);
    const size_t lb = strlen(b);
    const size_t gap = la > lb ? la - lb : lb - la;
    if (most < 0 || la > MT_TEXT_DISTANCE_MAX || lb > MT_TEXT_DISTANCE_MAX) {
        return strcmp(a, b) == 0 ? 0 : most + 1;
    }
    if (gap > (size_t)most) {
        return most + 1;
    }
    const int m = (int)la;
    const int n = (int)lb;
    int rows[3][MT_TEXT_DISTANCE_MAX + 2] = {{0}};
    bool far = false; /* the whole last row is */
    for (int j = 0; j <= n; j++) {
        rows[0][j] = j;
    }
    for (int i = 1; i <= m; i++) {
        const bool beyond = fill_row(a, b, i, n, most, rows) > most;
        if (far && beyond) {
            return most + 1;
        }
        far = beyond;
    }
    return lesser_of(rows[m % 3][n], most + 1);
}

const char *mt_text_nearest(const char *name, const char *const *names, int n)
{
    const size_t length = strlen(name);
    if (length > MT_TEXT_DISTANCE_MAX) {
        return NULL;
    }
    int most = lesser_of(1 + (int)length / 4, (int)length - 1);
    const char *best = NULL;
    for (int i = 0; i < n && most >= 0; i++) {
        const int d = mt_text_distance(name, names[i], most);
        if (d <= most) {
            best = names[i];
            most = d - 1;
        }
    }
    return best;
}

const char *mt_text_base_name(const char *path)
{
    const char *const slash = path == NULL ? NULL : strrchr(path, '/');
    return slash == NULL ? path : slash + 1;
}

/* Greedy: at a mismatch give the last star one more character and go on behind it. O(length of
 * pattern * length of name). */
bool mt_text_matches(const char *pattern, const char *name)
{
    const char *star = NULL;
    const char *resume = name;
    while (*name != '\0') {
        if (*pattern == '*') {
            star = pattern++;
            resume = name;
        } else if (*pattern == '?' || *pattern == *name) {
            pattern++;
            name++;
        } else if (star != NULL) {
            pattern = star + 1;
            name = ++resume;
        } else {
            return false;
        }
    }
    while (*pattern == '*') {
        pattern++;
    }
    return *pattern == '\0';
}

/* Columns of a character, after Unicode's East Asian Width and general categories Mn and Me:
 * the ranges that matter most. */
static int columns_of_character(unsigned code)
{
    static const struct {
        unsigned first, last;
        int width;
    } ranges[] = {
        {0x300U, 0x36FU, 0}, /* combining marks */
        {0x483U, 0x489U, 0},     {0x591U, 0x5BDU, 0},
        {0x610U, 0x61AU, 0},     {0x64BU, 0x65FU, 0},
        {0x1100U, 0x115FU, 2}, /* Hangul */
        {0x1AB0U, 0x1AFFU, 0},   {0x1DC0U, 0x1DFFU, 0},
        {0x20D0U, 0x20FFU, 0},   {0x2E80U, 0x303EU, 2}, /* Chinese, Japanese, Korean */
        {0x3041U, 0xA4CFU, 2},   {0xAC00U, 0xD7A3U, 2},
        {0xF900U, 0xFAFFU, 2},   {0xFE00U, 0xFE0FU, 0}, /* variation selectors */
        {0xFE20U, 0xFE2FU, 0},   {0xFE30U, 0xFE6FU, 2},
        {0xFF00U, 0xFF60U, 2},                            /* full width */
        {0xFFE0U, 0xFFE6U, 2},   {0x1F300U, 0x1F64FU, 2}, /* pictures */
        {0x1F680U, 0x1F6FFU, 2}, {0x1F900U, 0x1F9FFU, 2},
        {0x20000U, 0x3FFFDU, 2},
    };
    for (int i = 0; code >= ranges[0].first && i < MT_COUNT(ranges); i++) {
        if (code >= ranges[i].first && code <= ranges[i].last) {
            return ranges[i].width;
        }
    }
    return 1;
}

int mt_text_width(const char *s)
{
    int width = 0;
    size_t left = strlen(s);
    while (left > 0) {
        const size_t length = mt_utf8_length(s, left);
        width += length == 0 ? 1 : columns_of_character(mt_utf8_code(s, length));
        s += length == 0 ? 1 : length;
        left -= length == 0 ? 1 : length;
    }
    return width;
}

/* Text made visible. */

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
