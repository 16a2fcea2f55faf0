/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One walk over a universal file's lines, from dataset to dataset, that counts what is in them.
 * Of functions (58) the kind stands in the first five columns of the sixth line, of data at
 * nodes (55) the kind of analysis in the second field of the sixth; nodes have a line each (15)
 * or two (781, 2411). The bytes behind 58b are told in its first line and passed over.
 */
#include "io/universal.h"

#include <string.h>

#include "base/base.h"

enum { NUMBER_MOST = 9, KIND_LINE = 6, BINARY_LINES = 11, BYTES_COLUMN = 31, BYTES_WIDTH = 12 };

typedef struct content {
    int dataset;
    int kind; /* of functions and of data at nodes; else 0 */
    const char *one;
    const char *many;
} content;

/* Frequency responses first; what has no line of its own is of the last. */
static const content contents[] = {
    {58, 4, "frequency response", "frequency responses"},
    {58, 5, "transmissibility", "transmissibilities"},
    {58, 1, "time history", "time histories"},
    {58, 2, "power spectrum", "power spectra"},
    {58, 3, "cross spectrum", "cross spectra"},
    {58, 6, "coherence", "coherences"},
    {58, 7, "auto-correlation", "auto-correlations"},
    {58, 8, "cross-correlation", "cross-correlations"},
    {58, 9, "power spectral density", "power spectral densities"},
    {58, 10, "energy spectral density", "energy spectral densities"},
    {58, 12, "spectrum", "spectra"},
    {58, 17, "mode indicator function", "mode indicator functions"},
    {58, 25, "multiple coherence", "multiple coherences"},
    {58, 26, "order function", "order functions"},
    {58, 0, "function of another kind", "functions of other kinds"},
    {55, 2, "mode shape", "mode shapes"},
    {55, 3, "complex mode shape", "complex mode shapes"},
    {55, 0, "set of data at nodes", "sets of data at nodes"},
    {2414, 0, "set of data at nodes", "sets of data at nodes"},
    {15, 0, "node", "nodes"},
    {781, 0, "node", "nodes"},
    {2411, 0, "node", "nodes"},
    {82, 0, "set of trace lines", "sets of trace lines"},
    {2412, 0, "set of elements", "sets of elements"},
    {2420, 0, "set of coordinate systems", "sets of coordinate systems"},
    {151, 0, "header", "headers"},
    {164, 0, "set of units", "sets of units"},
    {0, 0, "other dataset", "other datasets"},
};

typedef struct walk {
    const char *at;
    const char *end;
    long count[MT_COUNT(contents)];
} walk;

typedef struct line {
    const char *s;
    size_t length;
} line;

static bool next_line(walk *w, line *out)
{
    if (w->at >= w->end) {
        return false;
    }
    out->s = w->at;
    while (w->at < w->end && *w->at != '\n' && *w->at != '\r' && *w->at != '\0') {
        w->at++;
    }
    out->length = (size_t)(w->at - out->s);
    if (w->at < w->end) {
        const bool two = *w->at != '\n' && w->at + 1 < w->end && w->at[1] == '\n';
        w->at += two ? 2 : 1;
    }
    return true;
}

/* The whole number in so many columns; -1: there is none. */
static long number_at(const line *l, size_t from, size_t width)
{
    size_t i = from;
    const size_t end = from + width < l->length ? from + width : l->length;
    long value = -1;
    int digits = 0;
    while (i < end && (l->s[i] == ' ' || l->s[i] == '\t')) {
        i++;
    }
    for (; i < end && l->s[i] >= '0' && l->s[i] <= '9' && digits < NUMBER_MOST; i++, digits++) {
        value = 10 * (value < 0 ? 0 : value) + (l->s[i] - '0');
    }
    return value;
}

static bool is_blank(const line *l)
{
    size_t i = 0;
    while (i < l->length && (l->s[i] == ' ' || l->s[i] == '\t')) {
        i++;
    }
    return i == l->length;
}

static bool is_delimiter(const line *l)
{
    size_t i = 0;
    size_t end = l->length;
    while (i < end && (l->s[i] == ' ' || l->s[i] == '\t')) {
        i++;
    }
    while (end > i && (l->s[end - 1] == ' ' || l->s[end - 1] == '\t')) {
        end--;
    }
    return end == i + 2 && l->s[i] == '-' && l->s[i + 1] == '1';
}

static void count_dataset(walk *w, long dataset, long kind, long number)
{
    int found = MT_COUNT(contents) - 1;
    for (int i = MT_COUNT(contents) - 1; i >= 0; i--) {
        const content *const c = &contents[i];
        if (c->dataset == dataset && (c->kind == 0 || c->kind == kind)) {
            found = i;
        }
    }
    w->count[found] += number;
}

/* The dataset whose number was read, to the line that ends it. */
static void read_dataset(walk *w, const line *number)
{
    enum { KIND_FIELD = 10, KIND_WIDTH = 10, FUNCTION_WIDTH = 5 };
    const long dataset = number_at(number, 0, number->length);
    const long bytes = number_at(number, BYTES_COLUMN, BYTES_WIDTH);
    const bool binary = memchr(number->s, 'b', number->length) != NULL;
    long kind = 0;
    long lines = 0;
    line l;
    while (next_line(w, &l) && !is_delimiter(&l)) {
        lines++;
        if (lines == KIND_LINE && dataset == 58) {
            kind = number_at(&l, 0, FUNCTION_WIDTH);
        } else if (lines == KIND_LINE && dataset == 55) {
            kind = number_at(&l, KIND_FIELD, KIND_WIDTH);
        }
        if (lines == BINARY_LINES && binary && bytes > 0) {
            w->at = bytes < w->end - w->at ? w->at + bytes : w->end;
        }
    }
    const bool node = dataset == 15 || dataset == 781 || dataset == 2411;
    count_dataset(w, dataset, kind, !node ? 1 : dataset == 15 ? lines : lines / 2);
}

static walk walk_of(const char *text, size_t length)
{
    walk w = {.at = text, .end = text + length};
    line l;
    while (next_line(&w, &l)) {
        if (is_delimiter(&l) && next_line(&w, &l) && !is_delimiter(&l)) {
            read_dataset(&w, &l);
        }
    }
    return w;
}

bool mt_universal_begins(const char *text, size_t length)
{
    walk w = {.at = text, .end = text + length};
    line l;
    while (next_line(&w, &l)) {
        if (!is_blank(&l)) {
            return is_delimiter(&l) && next_line(&w, &l) && number_at(&l, 0, l.length) >= 0;
        }
    }
    return false;
}

void mt_universal_contents(const char *text, size_t length, mt_text *out)
{
    const walk w = walk_of(text, length);
    bool any = false;
    for (int i = 0; i < MT_COUNT(contents); i++) {
        const content *const c = &contents[i];
        if (w.count[i] > 0) {
            mt_text_addf(out, "%s%ld %s", any ? ", " : "", w.count[i],
                         w.count[i] == 1 ? c->one : c->many);
            if (c->dataset > 0) {
                mt_text_addf(out, " (dataset %d)", c->dataset);
            }
            any = true;
        }
    }
    mt_text_add(out, any ? "" : "nothing");
    mt_text_add(out, w.count[0] + w.count[1] > 0 ? "" : "; no frequency response");
}
