/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mt_hostile.h"

#include <string.h>

enum { MAX_DEPTH = 256 };

typedef struct scan {
    const char *s;
    size_t n;
    size_t name_begin; /* n: no name waits for its value */
    size_t name_end;
    int most;
    int count;
    mt_hostile_node *nodes;
} scan;

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static size_t end_of_token(const char *s, size_t n, size_t i)
{
    if (s[i] == '"') {
        for (i++; i < n && s[i] != '"'; i++) {
            i += s[i] == '\\' ? 1 : 0;
        }
        return i < n ? i + 1 : n;
    }
    const size_t start = i;
    while (i < n && strchr("{}[],:\" \t\r\n", s[i]) == NULL) {
        i++;
    }
    return i > start ? i : start + 1;
}

/* A value stands at begin; its place in the list, -1 where that is full. */
static int add(scan *sc, size_t begin, size_t end)
{
    const bool named = sc->name_begin < sc->n;
    if (sc->count == sc->most) {
        return -1;
    }
    sc->nodes[sc->count] = (mt_hostile_node){
        .name_begin = named ? sc->name_begin : begin,
        .name_end = named ? sc->name_end : begin,
        .begin = begin,
        .end = end,
    };
    sc->name_begin = sc->n;
    return sc->count++;
}

/* A string, number or word at i: a name where a colon follows, else a value. Its end. */
static size_t token(scan *sc, size_t i)
{
    const size_t end = end_of_token(sc->s, sc->n, i);
    size_t after = end;
    while (after < sc->n && is_space(sc->s[after])) {
        after++;
    }
    if (after < sc->n && sc->s[after] == ':') {
        sc->name_begin = i;
        sc->name_end = end;
    } else {
        (void)add(sc, i, end);
    }
    return end;
}

int mt_hostile_nodes(const char *s, size_t n, int most, mt_hostile_node *nodes)
{
    int open[MAX_DEPTH];
    int depth = 0;
    scan sc = {.s = s, .n = n, .name_begin = n, .most = most, .nodes = nodes};
    for (size_t i = 0; i < n;) {
        const char c = s[i];
        if (is_space(c) || c == ',' || c == ':' || c == '\0') {
            i++;
        } else if (c == '{' || c == '[') {
            const int at = add(&sc, i++, n);
            if (depth < MAX_DEPTH) {
                open[depth++] = at;
            }
        } else if (c == '}' || c == ']') {
            i++;
            if (depth > 0 && open[--depth] >= 0) {
                nodes[open[depth]].end = i;
            }
            sc.name_begin = n;
        } else {
            i = token(&sc, i);
        }
    }
    return sc.count;
}

bool mt_hostile_visible(const char *said, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        const unsigned char c = (unsigned char)said[i];
        if (c == 0x7F || (c < ' ' && c != '\n')) {
            return false;
        }
    }
    return true;
}

/* Does ":12:3" stand before mark? */
static bool has_place(const char *line, const char *mark)
{
    const char *p = mark;
    for (int numbers = 0; numbers < 2; numbers++) {
        const char *const end = p;
        while (p > line && p[-1] >= '0' && p[-1] <= '9') {
            p--;
        }
        if (p == end || p == line || *--p != ':') {
            return false;
        }
    }
    return true;
}

bool mt_hostile_diagnosed(const char *said, size_t length)
{
    int errors = 0;
    if (said == NULL || !mt_hostile_visible(said, length)) {
        return false;
    }
    for (const char *line = said; *line != '\0';) {
        const char *const end = strchr(line, '\n');
        const char *const error = strstr(line, ": error: ");
        const char *const warning = strstr(line, ": warning: ");
        if (end == NULL) {
            return false;
        }
        if (error != NULL && error < end) {
            errors++;
            if (!has_place(line, error)) {
                return false;
            }
        } else if ((warning == NULL || warning > end) &&
                   strstr(line, " more not shown\n") == NULL) {
            return false;
        }
        line = end + 1;
    }
    return errors > 0;
}
