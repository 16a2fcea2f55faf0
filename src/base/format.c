/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/format.h"

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/number.h"
#include "base/text.h"

enum {
    PRECISION_MOST = 40,
    NUMBER_SIZE = 400 /* the longest: %.40f of 1.8e308 */
};

typedef struct sink {
    char *out;
    size_t size;
    size_t length; /* of the whole text */
    char dropped;  /* the first byte without room */
} sink;

/* One conversion. */
typedef struct spec {
    bool plus, left, zero, point; /* flags + - 0 # */
    int width;
    int precision; /* below 0: none */
    char length;   /* 0, 'l', 'L' for ll, 'z' */
    char conversion;
} spec;

/* Of the caller; a va_list may be an array, which a function could not be handed the address
 * of. */
typedef struct arguments {
    va_list list;
} arguments;

static void append_text(sink *s, const char *text, size_t n)
{
    const size_t room = s->size > s->length ? s->size - s->length : 0; /* with the NUL */
    const size_t kept = n < room ? n : (room == 0 ? 0 : room - 1);
    if (kept > 0) {
        memcpy(s->out + s->length, text, kept);
    }
    if (kept < n && room > 0) {
        s->dropped = text[kept];
    }
    s->length += n;
}

static void put_padded(sink *s, const spec *f, const char *text, size_t n)
{
    const size_t width = (size_t)f->width;
    const size_t sign = f->zero && n > 0 && (*text == '-' || *text == '+') ? 1 : 0;
    append_text(s, text, sign);
    for (size_t i = n; !f->left && i < width; i++) {
        append_text(s, f->zero ? "0" : " ", 1);
    }
    append_text(s, text + sign, n - sign);
    for (size_t i = n; f->left && i < width; i++) {
        append_text(s, " ", 1);
    }
}

static void put_visible(sink *s, const char *text, size_t n)
{
    while (n > 0) {
        const size_t run = mt_visible_run(text, n, false);
        append_text(s, text, run);
        text += run;
        n -= run;
        if (n > 0) {
            char escape[MT_VISIBLE_SIZE];
            const size_t used = mt_visible_escape(text, n, escape);
            append_text(s, escape, strlen(escape));
            text += used;
            n -= used;
        }
    }
}

/* Number of bytes at the end of s[n] that begin an incomplete UTF-8 character. */
static size_t begun(const char *s, size_t n)
{
    size_t from = n;
    while (from > 0 && n - from < 3 && ((unsigned char)s[from - 1] & 0xC0U) == 0x80U) {
        from--;
    }
    const unsigned lead = from == 0 ? 0U : (unsigned char)s[from - 1];
    const size_t whole = lead >= 0xF0U ? 4 : lead >= 0xE0U ? 3 : lead >= 0xC0U ? 2 : 1;
    return from > 0 && n - (from - 1) < whole ? n - (from - 1) : 0;
}

/* At most `precision` bytes of the text, and no part of a character. */
static void put_string(sink *s, const spec *f, const char *text)
{
    const char *const given = text == NULL ? "(none)" : text;
    const size_t room = f->precision < 0 ? SIZE_MAX : (size_t)f->precision;
    size_t n = 0;
    while (n < room && given[n] != '\0') {
        n++;
    }
    n -= n == room ? begun(given, n) : 0;
    for (size_t i = n; !f->left && i < (size_t)f->width; i++) {
        append_text(s, " ", 1);
    }
    put_visible(s, given, n);
    for (size_t i = n; f->left && i < (size_t)f->width; i++) {
        append_text(s, " ", 1);
    }
}

/* The C library writes the decimal point of the locale, which may be several bytes: whatever is
 * no digit, sign or exponent becomes one point. */
static void make_point_plain(char *text)
{
    char *out = text;
    for (const char *s = text; *s != '\0'; s++) {
        if (strchr("0123456789+-e", *s) != NULL) {
            *out++ = *s;
        } else if (out == text || out[-1] != '.') {
            *out++ = '.';
        }
    }
    *out = '\0';
}

/* With a point, and the zeros at the end that make it so many digits. */
static size_t fill_up(char *text, size_t n, int digits)
{
    int known = 0;
    bool pointed = false;
    for (size_t i = 0; i < n; i++) {
        pointed = pointed || text[i] == '.';
        known += text[i] != '-' && text[i] != '.' && (known > 0 || text[i] != '0') ? 1 : 0;
    }
    if (!pointed) {
        text[n++] = '.';
    }
    for (; known < digits; known++) {
        text[n++] = '0';
    }
    return n;
}

static void put_real(sink *s, spec *f, double x)
{
    char text[NUMBER_SIZE];
    const double v = x == 0.0 ? 0.0 : x; /* -0 says no more than 0 */
    const char *const sign = f->plus && v >= 0.0 ? "+" : "";
    const int digits = f->precision < 0 ? 6 : f->precision;
    if (!isfinite(x)) {
        f->zero = false;
        const char *const word = isnan(x) ? "undefined" : x < 0.0 ? "-infinite" : "infinite";
        put_padded(s, f, word, strlen(word));
        return;
    }
    char decimal[1 + (2 * MT_DECIMAL_TEXT)] = "+";
    const size_t before = strlen(sign);
    const bool plain = f->conversion == 'g' && (!f->point || v != 0.0);
    size_t known = plain ? mt_decimal(v, digits, decimal + before) : 0;
    if (known > 0) {
        known = f->point ? fill_up(decimal + before, known, digits) : known;
        put_padded(s, f, decimal, before + known);
        return;
    }
    if (f->conversion == 'f') {
        (void)snprintf(text, sizeof text, "%s%.*f", sign, digits, v);
    } else if (f->conversion == 'e') {
        (void)snprintf(text, sizeof text, "%s%.*e", sign, digits, v);
    } else if (f->point) {
        (void)snprintf(text, sizeof text, "%s%#.*g", sign, digits, v);
    } else {
        (void)snprintf(text, sizeof text, "%s%.*g", sign, digits, v);
    }
    make_point_plain(text);
    put_padded(s, f, text, strlen(text));
}

/* Digits of x in that base, and before them the sign. */
static void put_whole(sink *s, const spec *f, const char *sign, unsigned long long x,
                      const char *letters, unsigned base)
{
    char text[NUMBER_SIZE];
    size_t at = sizeof text;
    do {
        text[--at] = letters[x % base];
        x /= base;
    } while (x > 0);
    if (*sign != '\0') {
        text[--at] = *sign;
    }
    put_padded(s, f, text + at, sizeof text - at);
}

static void put_signed(sink *s, const spec *f, long long x)
{
    const unsigned long long size = x < 0 ? 0U - (unsigned long long)x : (unsigned long long)x;
    put_whole(s, f, x < 0 ? "-" : f->plus ? "+" : "", size, "0123456789", 10);
}

static void put_unsigned(sink *s, const spec *f, unsigned long long x)
{
    const char *const letters = f->conversion == 'X' ? "0123456789ABCDEF" : "0123456789abcdef";
    put_whole(s, f, "", x, letters, f->conversion == 'u' ? 10U : 16U);
}

/* A count in the format: digits, or -1 for *. */
static int read_count(const char **at)
{
    int n = 0;
    if (**at == '*') {
        (*at)++;
        return -1;
    }
    for (; **at >= '0' && **at <= '9'; (*at)++) {
        n = n < INT_MAX / 16 ? (10 * n) + (**at - '0') : n;
    }
    return n;
}

static void read_flags(const char **at, spec *f)
{
    for (; **at != '\0' && strchr("+-0#", **at) != NULL; (*at)++) {
        f->plus = f->plus || **at == '+';
        f->left = f->left || **at == '-';
        f->zero = f->zero || **at == '0';
        f->point = f->point || **at == '#';
    }
}

static void read_length(const char **at, spec *f)
{
    if (**at == 'l' || **at == 'z') {
        f->length = *(*at)++;
    }
    if (f->length == 'l' && **at == 'l') {
        f->length = 'L';
        (*at)++;
    }
}

/* What follows a %: flags, width, precision, length, conversion. */
static spec read_spec(const char **at, arguments *from)
{
    spec f = {.precision = -1};
    read_flags(at, &f);
    f.width = read_count(at);
    if (f.width < 0) {
        f.width = va_arg(from->list, int);
        f.left = f.left || f.width < 0;
        f.width = f.width < 0 ? -f.width : f.width;
    }
    if (**at == '.') {
        (*at)++;
        f.precision = read_count(at);
        f.precision = f.precision < 0 ? va_arg(from->list, int) : f.precision;
    }
    read_length(at, &f);
    f.conversion = **at;
    *at += **at != '\0' ? 1 : 0;
    return f;
}

static long long next_signed(const spec *f, arguments *from)
{
    return f->length == 'L'   ? va_arg(from->list, long long)
           : f->length == 'l' ? va_arg(from->list, long)
           : f->length == 'z' ? va_arg(from->list, ptrdiff_t)
                              : va_arg(from->list, int);
}

static unsigned long long next_unsigned(const spec *f, arguments *from)
{
    return f->length == 'L'   ? va_arg(from->list, unsigned long long)
           : f->length == 'l' ? va_arg(from->list, unsigned long)
           : f->length == 'z' ? va_arg(from->list, size_t)
                              : va_arg(from->list, unsigned);
}

static bool convert(sink *s, spec *f, arguments *from)
{
    char c = '\0';
    switch (f->conversion) {
    case '%':
        append_text(s, "%", 1);
        return true;
    case 'd':
    case 'i':
        put_signed(s, f, next_signed(f, from));
        return true;
    case 'u':
    case 'x':
    case 'X':
        put_unsigned(s, f, next_unsigned(f, from));
        return true;
    case 'c':
        c = (char)va_arg(from->list, int);
        put_visible(s, &c, 1);
        return true;
    case 's':
        put_string(s, f, va_arg(from->list, const char *));
        return true;
    case 'e':
    case 'f':
    case 'g':
        put_real(s, f, va_arg(from->list, double));
        return true;
    default:
        return false;
    }
}

/* End the output; a character that does not fit whole is left out. */
static void terminate_output(sink *s)
{
    size_t n = s->length;
    if (n >= s->size) {
        n = s->size - 1;
        char cut = s->dropped;
        while (n > 0 && ((unsigned char)cut & 0xC0U) == 0x80U) {
            cut = s->out[--n];
        }
    }
    s->out[n] = '\0';
}

/* NOLINTNEXTLINE(readability-non-const-parameter): written through the sink */
int mt_vsnprintf(char *out, size_t size, const char *fmt, va_list args)
{
    sink s = {.out = out, .size = size};
    arguments from;
    va_copy(from.list, args);
    bool ok = true;
    for (const char *at = fmt; ok && *at != '\0';) {
        const size_t plain = strcspn(at, "%");
        append_text(&s, at, plain);
        at += plain;
        if (*at == '%') {
            at++;
            spec f = read_spec(&at, &from);
            ok = convert(&s, &f, &from);
        }
    }
    va_end(from.list);
    if (size > 0) {
        terminate_output(&s);
    }
    return ok && s.length <= INT_MAX ? (int)s.length : -1;
}

int mt_snprintf(char *out, size_t size, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    const int n = mt_vsnprintf(out, size, fmt, args);
    va_end(args);
    return n;
}
