/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The scanner against a recogniser of the test's own that follows the grammar of RFC 8259 and
 * shares nothing with it: all sequences of a few tokens, all short numbers, all bytes in all
 * positions, all \u escapes, all short sequences of UTF-8, all cuts of a document.
 * MT_JSON_LENGTH: of the sequences (default 4, 5 for numbers).
 */
#include "io/json_verdict.h"
#include "mt_test.h"

/*
 * The test's own recogniser: the grammar of RFC 8259, and beyond it what io/json.h says (no
 * U+0000, numbers within the range of a double). Names given twice do not occur in what it is
 * asked. Each function takes a position and gives the one behind what it recognised, or FAIL.
 */
static const size_t FAIL = (size_t)-1;

typedef struct text {
    const unsigned char *s;
    size_t n;
} text;

static size_t value(const text *x, size_t i);

static int at(const text *x, size_t i)
{
    return i < x->n ? x->s[i] : -1;
}

static size_t space(const text *x, size_t i)
{
    while (at(x, i) == 0x20 || at(x, i) == 0x09 || at(x, i) == 0x0A || at(x, i) == 0x0D) {
        i++;
    }
    return i;
}

static size_t digits(const text *x, size_t i)
{
    const size_t start = i;
    while (at(x, i) >= '0' && at(x, i) <= '9') {
        i++;
    }
    return i > start ? i : FAIL;
}

static size_t number(const text *x, size_t i)
{
    char copy[64] = "";
    const size_t start = i;
    i += at(x, i) == '-' ? 1 : 0;
    i = at(x, i) == '0' ? i + 1 : digits(x, i);
    if (i != FAIL && at(x, i) == '.') {
        i = digits(x, i + 1);
    }
    if (i != FAIL && (at(x, i) == 'e' || at(x, i) == 'E')) {
        i++;
        i += at(x, i) == '+' || at(x, i) == '-' ? 1 : 0;
        i = digits(x, i);
    }
    if (i == FAIL || i - start >= sizeof copy) {
        return FAIL;
    }
    memcpy(copy, x->s + start, i - start);
    return isfinite(strtod(copy, NULL)) ? i : FAIL;
}

/* A code point by arithmetic: its bits are put together and it must need as many bytes as it
 * has. */
static size_t code_point(const text *x, size_t i)
{
    static const long least[] = {0, 0, 0x80, 0x800, 0x10000};
    const int lead = at(x, i);
    const size_t length = lead < 0x80   ? 1
                          : lead < 0xC0 ? 0
                          : lead < 0xE0 ? 2
                          : lead < 0xF0 ? 3
                          : lead < 0xF8 ? 4
                                        : 0;
    if (length < 2) {
        return length == 1 ? i + 1 : FAIL;
    }
    long code = lead & (0x7F >> length);
    for (size_t k = 1; k < length; k++) {
        const int c = at(x, i + k);
        if (c < 0 || (c & 0xC0) != 0x80) {
            return FAIL;
        }
        code = 64 * code + (c & 0x3F);
    }
    const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
    return code < least[length] || code > 0x10FFFF || surrogate ? FAIL : i + length;
}

static long hex(const text *x, size_t i)
{
    char copy[5] = "";
    for (size_t k = 0; k < 4; k++) {
        const int c = at(x, i + k);
        if (c <= 0 || strchr("0123456789abcdefABCDEF", c) == NULL) {
            return -1;
        }
        copy[k] = (char)c;
    }
    return strtol(copy, NULL, 16);
}

static size_t escape(const text *x, size_t i)
{
    const int c = at(x, i + 1);
    if (c != 'u') {
        return c > 0 && strchr("\"\\/bfnrt", c) != NULL ? i + 2 : FAIL;
    }
    const long code = hex(x, i + 2);
    if (code <= 0 || (code >= 0xDC00 && code <= 0xDFFF)) {
        return FAIL;
    }
    if (code < 0xD800 || code > 0xDFFF) {
        return i + 6;
    }
    const long low = at(x, i + 6) == '\\' && at(x, i + 7) == 'u' ? hex(x, i + 8) : -1;
    return low >= 0xDC00 && low <= 0xDFFF ? i + 12 : FAIL;
}

static size_t string(const text *x, size_t i)
{
    if (at(x, i) != '"') {
        return FAIL;
    }
    for (i++; i != FAIL && at(x, i) != '"';) {
        if (at(x, i) < 0x20) {
            return FAIL; /* the end of the text, too */
        }
        i = at(x, i) == '\\' ? escape(x, i) : code_point(x, i);
    }
    return i == FAIL ? FAIL : i + 1;
}

/* What stands between brackets, from behind the opening one. */
static size_t items(const text *x, size_t i, bool object, int close)
{
    i = space(x, i);
    if (at(x, i) == close) {
        return i + 1;
    }
    for (;;) {
        if (object) {
            i = string(x, space(x, i));
            i = i == FAIL ? FAIL : space(x, i);
            if (i == FAIL || at(x, i) != ':') {
                return FAIL;
            }
            i++;
        }
        i = value(x, space(x, i));
        if (i == FAIL) {
            return FAIL;
        }
        i = space(x, i);
        if (at(x, i) != ',') {
            return at(x, i) == close ? i + 1 : FAIL;
        }
        i++;
    }
}

static size_t value(const text *x, size_t i)
{
    static const char *const literals[] = {"true", "false", "null"};
    for (int k = 0; k < MT_COUNT(literals); k++) {
        const size_t length = strlen(literals[k]);
        if (i + length <= x->n && memcmp(x->s + i, literals[k], length) == 0) {
            return i + length;
        }
    }
    switch (at(x, i)) {
    case '{':
        return items(x, i + 1, true, '}');
    case '[':
        return items(x, i + 1, false, ']');
    case '"':
        return string(x, i);
    default:
        return number(x, i);
    }
}

static bool recognised(const char *s, size_t n)
{
    const text x = {(const unsigned char *)s, n};
    const size_t end = value(&x, space(&x, 0));
    return end != FAIL && space(&x, end) == n;
}

typedef struct tally {
    mt_test *t;
    long asked;
    long accepted;
} tally;

/* The scanner and the recogniser agree about a text. */
static void compare(tally *y, const char *s, size_t n)
{
    const verdict v = judge(s, n);
    const bool wanted = recognised(s, n);
    y->asked++;
    y->accepted += wanted ? 1 : 0;
    if (v.accepted != wanted || (!wanted && v.place[0] == '\0')) {
        mt_test_row(y->t, "%.60s", s);
        CHECK(y->t, v.accepted == wanted);
        CHECK(y->t, wanted || v.place[0] != '\0');
    }
}

/* Both verdicts have been seen, or the comparison could not fail. */
static void conclude(const tally *y)
{
    mt_test_row(y->t, "%ld texts, %ld of them JSON", y->asked, y->accepted);
    CHECK(y->t, y->accepted > 0 && y->accepted < y->asked);
}

/* s[used] := part; the new end. */
static size_t append(char *s, size_t used, const char *part)
{
    while (*part != '\0') {
        s[used++] = *part++;
    }
    return used;
}

/* All sequences of up to `most` of the parts, each between two texts. */
static void all_sequences(tally *y, int n, const char *const *parts, int most,
                          const char *before, const char *after)
{
    long count = 1;
    for (int length = 1; length <= most; length++) {
        count *= n;
        for (long number_of = 0; number_of < count; number_of++) {
            char s[256];
            size_t used = append(s, 0, before);
            long rest = number_of;
            for (int k = 0; k < length; k++) {
                used = append(s, used, parts[rest % n]);
                rest /= n;
            }
            used = append(s, used, after);
            compare(y, s, used);
        }
    }
}

static int longest(int usual)
{
    const char *const s = getenv("MT_JSON_LENGTH");
    return s == NULL ? usual : (int)strtol(s, NULL, 10);
}

static void grammar__all_short_sequences_of_tokens(mt_test *t)
{
    static const char *const tokens[] = {"{", "}", "[", "]", ",", ":", "\"a\"", "1", "true"};
    tally y = {.t = t};
    all_sequences(&y, MT_COUNT(tokens), tokens, longest(4), "", "");
    all_sequences(&y, MT_COUNT(tokens), tokens, longest(4), "{\"b\":[", "]}");
    all_sequences(&y, MT_COUNT(tokens), tokens, longest(4), "[{\"b\":1,", "}]");
    conclude(&y);
}

static void grammar__all_short_numbers(mt_test *t)
{
    static const char *const parts[] = {"0", "7", "-", "+", ".", "e", "E"};
    tally y = {.t = t};
    all_sequences(&y, MT_COUNT(parts), parts, longest(5), "", "");
    all_sequences(&y, MT_COUNT(parts), parts, longest(4), "[", "]");
    all_sequences(&y, MT_COUNT(parts), parts, longest(4), "{\"a\":", ",\"b\":0}");
    conclude(&y);
}

static void grammar__every_byte_in_every_position(mt_test *t)
{
    static const char *const frames[][2] = {
        {"", ""},
        {" ", " "},
        {"[", "]"},
        {"[1", "]"},
        {"[1,", "2]"},
        {"[0", "0]"},
        {"[-1", "5]"},
        {"[tru", "]"},
        {"{", "\"a\":1}"},
        {"{\"a\"", ":1}"},
        {"{\"a\":", "1}"},
        {"{\"a\":1", "}"},
        {"\"", "\""},
        {"\"a", "b\""},
        {"\"\\", "\""},
        {"\"\\u0", "11\""},
        {"\"\\ud800", "\\udc00\""},
        {"[]", ""},
        {"[]\n", ""},
        {"\"\xC3", "\""},
        {"\"\xE2", "\xAC\""},
    };
    tally y = {.t = t};
    for (int i = 0; i < MT_COUNT(frames); i++) {
        for (int byte = 0; byte < 256; byte++) {
            char s[64];
            const size_t before = strlen(frames[i][0]);
            const size_t after = strlen(frames[i][1]);
            memcpy(s, frames[i][0], before);
            s[before] = (char)byte;
            memcpy(s + before + 1, frames[i][1], after + 1);
            compare(&y, s, before + 1 + after);
        }
    }
    conclude(&y);
}

static void grammar__all_escapes_and_pairs_of_them(mt_test *t)
{
    static const unsigned codes[] = {0x0000, 0x0001, 0x0041, 0xD7FF, 0xD800, 0xD801,
                                     0xDBFF, 0xDC00, 0xDC01, 0xDFFF, 0xE000, 0xFFFF};
    tally y = {.t = t};
    char s[64];
    for (unsigned code = 0; code <= 0xFFFF; code++) {
        const int n =
            snprintf(s, sizeof s, code % 2 == 0 ? "\"\\u%04x\"" : "\"\\u%04X\"", code);
        compare(&y, s, (size_t)n);
    }
    for (int i = 0; i < MT_COUNT(codes); i++) {
        for (int k = 0; k < MT_COUNT(codes); k++) {
            for (int j = 0; j < MT_COUNT(codes); j++) {
                const int n = snprintf(s, sizeof s, "\"\\u%04X\\u%04x\\u%04X\"", codes[i],
                                       codes[k], codes[j]);
                compare(&y, s, (size_t)n);
            }
        }
    }
    conclude(&y);
}

static void grammar__all_short_sequences_of_utf8(mt_test *t)
{
    static const unsigned char edges[] = {0x00, 0x22, 0x5C, 0x7F, 0x80, 0x8F, 0x90,
                                          0x9F, 0xA0, 0xBF, 0xC0, 0xF4, 0xFF};
    tally y = {.t = t};
    for (int a = 0x20; a < 0x100; a++) {
        for (int b = 0; b < 0x100; b++) {
            const char two[] = {'"', (char)a, (char)b, '"'};
            compare(&y, two, sizeof two);
            for (int i = 0; a >= 0xDF && i < MT_COUNT(edges); i++) {
                const char three[] = {'"', (char)a, (char)b, (char)edges[i], '"'};
                compare(&y, three, sizeof three);
                for (int k = 0; a >= 0xEF && b >= 0x7F && b <= 0xC0 && k < MT_COUNT(edges);
                     k += 3) {
                    const char four[] = {'"', (char)a, (char)b, (char)edges[i], (char)edges[k],
                                         '"'};
                    compare(&y, four, sizeof four);
                }
            }
        }
    }
    conclude(&y);
}

/* A document with everything in it: cut after every byte, without every byte, with every byte
 * doubled. */
static void grammar__every_cut_of_a_document(mt_test *t)
{
    static const char whole[] =
        " {\"a\": [1, -2.5e+3, true, null],\r\n\t\"\\u00e4\\n\": {\"\xE2\x82\xAC\": "
        "\"\\ud83d\\ude00\", \"\": []}, \"b\": [[{}], false, 0.1E-2]} \n";
    const size_t n = sizeof whole - 1;
    tally y = {.t = t};
    char s[sizeof whole + 1];
    compare(&y, whole, n);
    for (size_t i = 0; i < n; i++) {
        compare(&y, whole, i);
        memcpy(s, whole, i);
        memcpy(s + i, whole + i + 1, n - i);
        compare(&y, s, n - 1);
        memcpy(s, whole, i + 1);
        memcpy(s + i + 1, whole + i, n - i + 1);
        compare(&y, s, n + 1);
    }
    conclude(&y);
}

MT_TEST_MAIN(MT_TEST(grammar__all_short_sequences_of_tokens),
             MT_TEST(grammar__all_short_numbers),
             MT_TEST(grammar__every_byte_in_every_position),
             MT_TEST(grammar__all_escapes_and_pairs_of_them),
             MT_TEST(grammar__all_short_sequences_of_utf8),
             MT_TEST(grammar__every_cut_of_a_document))
