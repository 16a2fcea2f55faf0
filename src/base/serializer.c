/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/serializer.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_ROOM = 64, WORD = sizeof(uint64_t) };

_Static_assert(sizeof(double) == WORD, "a number is one word");

mt_serializer mt_serializer_of(const uint64_t *words, size_t n)
{
    mt_serializer t = {.n = n, .reads = true};
    memcpy(&t.words, &words, sizeof words); /* only read: the qualifier goes, the words stay */
    return t;
}

void mt_serializer_free(mt_serializer *t)
{
    if (!t->reads) {
        free(t->words);
    }
    *t = (mt_serializer){.words = NULL};
}

bool mt_serializer_is_read(const mt_serializer *t)
{
    return t->reads && !t->failed && t->at == t->n;
}

/* The next word; 0 where there is none. */
static uint64_t get(mt_serializer *t)
{
    if (t->failed || t->at >= t->n) {
        t->failed = true;
        return 0;
    }
    return t->words[t->at++];
}

static void append_word(mt_serializer *t, uint64_t word)
{
    if (t->n == t->room && !t->failed) {
        const size_t room = t->room > 0 ? 2 * t->room : FIRST_ROOM;
        uint64_t *const words =
            room > SIZE_MAX / WORD ? NULL : realloc(t->words, room * sizeof *words);
        t->failed = words == NULL;
        t->no_memory = words == NULL;
        t->words = words != NULL ? words : t->words;
        t->room = words != NULL ? room : t->room;
    }
    if (!t->failed) {
        t->words[t->n++] = word;
    }
}

void mt_serializer_numbers(mt_serializer *t, size_t n, double *x)
{
    for (size_t i = 0; i < n && !t->failed; i++) {
        uint64_t word = 0;
        if (t->reads) {
            word = get(t);
            memcpy(&x[i], &word, sizeof word);
        } else {
            memcpy(&word, &x[i], sizeof word);
            append_word(t, word);
        }
    }
}

void mt_serializer_long(mt_serializer *t, long *x, long least, long most)
{
    if (!t->reads) {
        append_word(t, (uint64_t)*x);
        return;
    }
    const uint64_t word = get(t);
    long value = 0;
    memcpy(&value, &word, sizeof value);
    t->failed = t->failed || value < least || value > most;
    *x = t->failed ? least : value;
}

void mt_serializer_int(mt_serializer *t, int *x, int least, int most)
{
    long value = *x;
    mt_serializer_long(t, &value, least, most);
    *x = (int)value;
}

void mt_serializer_flag(mt_serializer *t, bool *x)
{
    int value = !t->reads && *x ? 1 : 0;
    mt_serializer_int(t, &value, 0, 1);
    *x = value != 0;
}

void *mt_serializer_items(mt_serializer *t, int *n, size_t size, void *items, mt_arena *mem)
{
    mt_serializer_int(t, n, 0, INT_MAX);
    if (!t->reads) {
        return items;
    }
    t->failed = t->failed || (size_t)*n > t->n - t->at;
    void *const own = t->failed ? NULL : mt_arena_alloc(mem, (size_t)*n, size);
    t->failed = own == NULL;
    return own;
}

void mt_serializer_text(mt_serializer *t, const char **text, mt_arena *mem)
{
    int n = !t->reads && *text != NULL ? (int)strlen(*text) + 1 : 0; /* with its NUL; 0: NULL */
    mt_serializer_int(t, &n, 0, INT_MAX);
    const size_t words = ((size_t)n + WORD - 1) / WORD;
    char *own = NULL;
    if (t->reads) {
        t->failed = t->failed || words > t->n - t->at;
        own = t->failed || n == 0 ? NULL : mt_arena_alloc(mem, words, WORD);
        t->failed = t->failed || (n > 0 && own == NULL);
    }
    for (size_t i = 0; i < words && !t->failed; i++) {
        const size_t left = (size_t)n - (i * WORD);
        const size_t size = left < WORD ? left : WORD;
        uint64_t word = 0;
        if (own != NULL) {
            uint64_t kept = 0;
            word = get(t);
            memcpy(own + (i * WORD), &word, size);
            memcpy(&kept, own + (i * WORD), size);
            t->failed = t->failed || kept != word; /* behind the text there is nothing */
        } else if (*text != NULL) {
            memcpy(&word, *text + (i * WORD), size);
            append_word(t, word);
        }
    }
    if (t->reads) {
        t->failed = t->failed || (own != NULL && memchr(own, '\0', (size_t)n) != own + n - 1);
        *text = t->failed ? NULL : own;
    }
}
