/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Mutants of JSON by node, also of broken texts.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/fuzz.h"

enum { MAX_NODES = 4096, TEXT_SIZE = 4096 };

fuzz_random fuzz_random_seed(uint64_t seed)
{
    return (fuzz_random){seed * 2654435761U + 88172645463325252U};
}

size_t fuzz_below(fuzz_random *r, size_t n)
{
    r->state ^= r->state >> 12;
    r->state ^= r->state << 25;
    r->state ^= r->state >> 27;
    return (size_t)((r->state * 2685821657736338717U >> 11) % (n == 0 ? 1 : n));
}

typedef mt_hostile_node node;

/* The values of a text. */
typedef struct scan {
    int count;
    node nodes[MAX_NODES];
} scan;

static bool is_space(uint8_t c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static void find_nodes(scan *sc, const uint8_t *s, size_t n)
{
    sc->count = mt_hostile_nodes((const char *)s, n, MAX_NODES, sc->nodes);
}

/* data[begin..end) := text; the new size, or the old one where it would not fit. */
static size_t put(uint8_t *data, size_t size, size_t max, size_t begin, size_t end,
                  const uint8_t *text, size_t length)
{
    if (size - (end - begin) + length > max) {
        return size;
    }
    memmove(data + begin + length, data + end, size - end);
    memcpy(data + begin, text, length);
    return size - (end - begin) + length;
}

static const char *const EXTREMES[] = {
    "{}",
    "[]",
    "null",
    "true",
    "\"\"",
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "0.5",
    "3",
    "1e999",
    "1e308",
    "-1e308",
    "1e-320",
    "1e-400",
    "1e15",
    "1e16",
    "1e-16",
    "4294967296",
    "2147483647",
    "-2147483648",
    "1000000",
    "0.30000000000000004",
    "\"1/0\"",
    "\"sqrt(0-1)\"",
    "\"1e308*10\"",
    "\"ground\"",
    "\"\\u001b]0;x\\u0007\"",
    "\"=1+1\"",
    "\"\\u00e4\\ud83d\\ude00\"",
    "[[]]",
    "[{}]",
    "{\"\": 0}",
    "[0, 0]",
    "[1, 0]",
    "[0, 0, 1]",
    "[null]",
    "[\"a\", \"b\"]",
    "\"change\"",
    "[[1, 2], [2, 3]]",
};

static size_t extreme(fuzz_random *r, uint8_t *text)
{
    const char *const s = EXTREMES[fuzz_below(r, MT_COUNT(EXTREMES))];
    return (size_t)snprintf((char *)text, TEXT_SIZE, "%s", s);
}

/* A number that is near the one there, or far away; another extreme where there is no
 * number. */
static size_t number(fuzz_random *r, const uint8_t *s, size_t n, uint8_t *text)
{
    static const double factors[] = {-1.0,        0.0, 0.5,  2.0, 10.0, 0.1,
                                     1.0 + 1e-15, 1e3, 1e-3, 1e9, 1e-9, 0.999};
    char copy[64] = "";
    char *end = copy;
    memcpy(copy, s, n < sizeof copy ? n : sizeof copy - 1);
    const double x = strtod(copy, &end);
    if (end == copy) {
        return extreme(r, text);
    }
    const double y = fuzz_below(r, 4) == 0 ? x + (double)fuzz_below(r, 5) - 2.0
                                           : x * factors[fuzz_below(r, MT_COUNT(factors))];
    const int length = snprintf((char *)text, TEXT_SIZE, "%.17g", y);
    return length > 0 ? (size_t)length : 0;
}

/* Take a value away, with its name and one of the commas beside it. */
static size_t drop(uint8_t *data, size_t size, const node *a)
{
    size_t begin = a->name_begin;
    size_t end = a->end;
    while (end < size && is_space(data[end])) {
        end++;
    }
    if (end < size && data[end] == ',') {
        end++;
    } else {
        while (begin > 0 && is_space(data[begin - 1])) {
            begin--;
        }
        begin -= begin > 0 && data[begin - 1] == ',' ? 1 : 0;
    }
    memmove(data + begin, data + end, size - end);
    return size - (end - begin);
}

/* The same once more behind a comma: an item doubled, a member given twice (or, by other, under
 * another name). */
static size_t double_up(uint8_t *data, size_t size, size_t max, const node *a, const uint8_t *s,
                        const node *b)
{
    uint8_t text[TEXT_SIZE];
    const size_t length = b->end - b->name_begin;
    if (length + 1 > sizeof text || s == NULL) {
        return size;
    }
    text[0] = ',';
    memcpy(text + 1, s + b->name_begin, length);
    return put(data, size, max, a->end, a->end, text, length + 1);
}

/* Values a and b change places (one inside the other: a is put in b's place). */
static size_t exchange(uint8_t *data, size_t size, size_t max, const node *a, const node *b)
{
    const node *const first = a->begin < b->begin ? a : b;
    const node *const second = first == a ? b : a;
    uint8_t text[TEXT_SIZE];
    const size_t n = first->end - first->begin;
    const size_t m = second->end - second->begin;
    if (n > sizeof text / 2 || m > sizeof text / 2) {
        return size;
    }
    if (first->end > second->begin) {
        memcpy(text, data + second->begin, m);
        return put(data, size, max, first->begin, first->end, text, m);
    }
    memcpy(text, data + first->begin, n);
    memcpy(text + n, data + second->begin, m);
    size = put(data, size, max, second->begin, second->end, text, n);
    return put(data, size, max, first->begin, first->end, text + n, m);
}

static size_t wrap(fuzz_random *r, uint8_t *data, size_t size, size_t max, const node *a)
{
    uint8_t text[TEXT_SIZE];
    const size_t n = a->end - a->begin;
    static const char *const opens[] = {"[", "{\"a\":", "[[", "[0,"};
    static const char *const closes[] = {"]", "}", "]]", "]"};
    const size_t k = fuzz_below(r, MT_COUNT(opens));
    const int length = n > sizeof text / 2
                           ? -1
                           : snprintf((char *)text, sizeof text, "%s%.*s%s", opens[k], (int)n,
                                      (const char *)data + a->begin, closes[k]);
    return length < 0 ? size : put(data, size, max, a->begin, a->end, text, (size_t)length);
}

/* One byte of a string, or of a name, becomes another. */
static void touch(fuzz_random *r, uint8_t *data, size_t begin, size_t end)
{
    static const char bytes[] = "abxyz019+-*/^().,_ \\\"{}[]:e\x01\x7F";
    if (end > begin) {
        const size_t at = begin + fuzz_below(r, end - begin);
        data[at] = fuzz_below(r, 8) == 0 ? (uint8_t)fuzz_below(r, 256)
                                         : (uint8_t)bytes[fuzz_below(r, sizeof bytes - 1)];
    }
}

static size_t replace_by(uint8_t *data, size_t size, size_t max, const node *a,
                         const uint8_t *s, size_t begin, size_t end)
{
    uint8_t text[TEXT_SIZE];
    if (end - begin > sizeof text || s == NULL) {
        return size;
    }
    memcpy(text, s + begin, end - begin);
    return put(data, size, max, a->begin, a->end, text, end - begin);
}

/* One change at node a; b: another node of the same text, c: one of the other text o (b's where
 * there is none). */
static size_t change(fuzz_random *r, uint8_t *data, size_t size, size_t max, const node *a,
                     const node *b, const uint8_t *o, const node *c)
{
    uint8_t text[TEXT_SIZE];
    size_t n = 0;
    switch (fuzz_below(r, 12)) {
    case 0:
        n = extreme(r, text);
        return put(data, size, max, a->begin, a->end, text, n);
    case 1:
    case 2:
        n = number(r, data + a->begin, a->end - a->begin, text);
        return put(data, size, max, a->begin, a->end, text, n);
    case 3:
        return drop(data, size, a);
    case 4:
        return double_up(data, size, max, a, data, a);
    case 5:
        return exchange(data, size, max, a, b);
    case 6:
        return wrap(r, data, size, max, a);
    case 7:
        return replace_by(data, size, max, a, data, b->begin, b->end);
    case 8:
        return replace_by(data, size, max, a, o, c->begin, c->end);
    case 9:
        return double_up(data, size, max, a, o, c);
    case 10: /* another name */
        n = b->name_end - b->name_begin;
        if (a->name_end > a->name_begin && n > 0 && n <= sizeof text) {
            memcpy(text, data + b->name_begin, n);
            return put(data, size, max, a->name_begin, a->name_end, text, n);
        }
        return drop(data, size, a);
    default:
        touch(r, data, a->begin, a->end);
        return size;
    }
}

size_t fuzz_mutate(fuzz_random *r, uint8_t *data, size_t size, size_t max, const uint8_t *other,
                   size_t other_size)
{
    scan *const sc = malloc(sizeof *sc);
    scan *const from = malloc(sizeof *from);
    const size_t rounds = 1 + (fuzz_below(r, 3) == 0 ? fuzz_below(r, 4) : 0);
    if (sc == NULL || from == NULL) {
        abort();
    }
    find_nodes(from, other, other == NULL ? 0 : other_size);
    for (size_t i = 0; i < rounds; i++) {
        find_nodes(sc, data, size);
        if (sc->count == 0) {
            static const uint8_t empty[] = "{}";
            size = size + 2 > max ? size : put(data, size, max, size, size, empty, 2);
            continue;
        }
        const node a = sc->nodes[fuzz_below(r, (size_t)sc->count)];
        const node b = sc->nodes[fuzz_below(r, (size_t)sc->count)];
        const bool taken = from->count > 0;
        const node c = taken ? from->nodes[fuzz_below(r, (size_t)from->count)] : b;
        size = change(r, data, size, max, &a, &b, taken ? other : data, &c);
    }
    free(sc);
    free(from);
    return size;
}
