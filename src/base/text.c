/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/text.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

void mt_text_addf(mt_text *t, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    va_list again;
    va_copy(again, args);
    const int n = vsnprintf(NULL, 0, fmt, args);
    if (n < 0) {
        t->failed = true;
    } else if (reserve(t, (size_t)n)) {
        (void)vsnprintf(t->s + t->length, (size_t)n + 1, fmt, again);
        t->length += (size_t)n;
    }
    va_end(again);
    va_end(args);
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

/* Optimal string alignment by rows: d(i, j) edits turn the first i bytes of a into the first j of b,
 *   d(i, j) = min( d(i-1, j) + 1, d(i, j-1) + 1, d(i-1, j-1) + [a_i != b_j], d(i-2, j-2) + 1 if two neighbours are swapped ).
 * Only the last three rows are kept. */
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
    int rows[3][MT_TEXT_DISTANCE_MAX + 1];
    for (int j = 0; j <= n; j++) {
        rows[0][j] = j;
    }
    for (int i = 1; i <= m; i++) {
        const int *const before = rows[(i + 1) % 3];
        const int *const last = rows[(i + 2) % 3];
        int *const row = rows[i % 3];
        row[0] = i;
        for (int j = 1; j <= n; j++) {
            const int replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = least(replaced, least(last[j], row[j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = least(row[j], before[j - 2] + 1);
            }
        }
    }
    return least(rows[m % 3][n], most + 1);
}

const char *mt_text_nearest(const char *name, const char *const *names, int n)
{
    const size_t length = strlen(name);
    if (length > MT_TEXT_DISTANCE_MAX) {
        return NULL;
    }
    int most = least(1 + (int)length / 4, (int)length - 1);
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

/* Greedy: at a mismatch give the last star one more character and go on behind it. O(length of pattern * length of name). */
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

int mt_text_width(const char *s)
{
    int width = 0;
    for (; *s != '\0'; s++) {
        /* bytes 10xxxxxx continue a code point */
        width += ((unsigned char)*s & 0xC0U) != 0x80U;
    }
    return width;
}
