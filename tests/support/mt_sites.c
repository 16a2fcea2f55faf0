/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mt_sites.h"

#include <stdarg.h>
#include <string.h>

#include "base/arena.h"

/* Calls by which a place is known: its own and that many above it. */
#ifndef MT_SITES_CALLERS
#    define MT_SITES_CALLERS 0
#endif
enum { MOST_KNOWN = 16384 };

typedef struct place {
    const void *call[MT_SITES_CALLERS + 1];
} place;

static struct {
    place place[MT_SITES_MOST];
    int n;
    bool recording;
    int failing; /* -1: none */
    bool failed;
    place known[MOST_KNOWN]; /* refused in an earlier run */
    int n_known;
    const char *top; /* of the stack, as far as frames are walked */
} sites = {.failing = -1};

static bool is_same(const place *a, const place *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

static bool is_among(const place *p, int n, const place *list)
{
    for (int i = 0; i < n; i++) {
        if (is_same(p, &list[i])) {
            return true;
        }
    }
    return false;
}

void mt_sites_record(void)
{
    sites.n = 0;
    sites.recording = true;
    sites.failing = -1;
    sites.top = __builtin_frame_address(0);
}

bool mt_sites_known(int i)
{
    return is_among(&sites.place[i], sites.n_known, sites.known);
}

void mt_sites_fail(int i)
{
    sites.failing = i;
    sites.failed = false;
    sites.top = __builtin_frame_address(0);
}

int mt_sites_stop(void)
{
    sites.recording = false;
    sites.failing = -1;
    return sites.n;
}

bool mt_sites_failed(void)
{
    return sites.failed;
}

/* A frame begins with the address of its caller's frame and its return address. What is no
 * frame (a foreign library keeps none) ends the walk. */
static place place_of(const char *frame)
{
    enum { WORD = sizeof(void *) };
    place p;
    memset(&p, 0, sizeof p);
    for (int i = 0; i <= MT_SITES_CALLERS; i++) {
        const char *above;
        memcpy(&p.call[i], frame + WORD, WORD);
        memcpy(&above, frame, WORD);
        if (above <= frame || above >= sites.top) {
            break;
        }
        frame = above;
    }
    return p;
}

static bool (*ask)(const void *caller, size_t size);

void mt_sites_ask(bool (*refuses)(const void *caller, size_t size))
{
    ask = refuses;
}

static bool refuses(const void *call, const char *frame)
{
    if (ask != NULL) {
        return ask(call, 0);
    }
    if (sites.failing < 0 && !sites.recording) {
        return false;
    }
    const place p = MT_SITES_CALLERS > 0 ? place_of(frame) : (place){{call}};
    if (sites.failing >= 0) {
        const bool now = !sites.failed && is_same(&sites.place[sites.failing], &p);
        if (now && sites.n_known < MOST_KNOWN) {
            sites.known[sites.n_known++] = p;
        }
        sites.failed = sites.failed || now;
        return now;
    }
    if (sites.n < MT_SITES_MOST && !is_among(&p, sites.n, sites.place)) {
        sites.place[sites.n++] = p;
    }
    return false;
}

/* As an arena does that has no memory. */
static void *refuse(mt_arena *a)
{
    mt_arena_fail(a);
    return NULL;
}

#define REFUSED() refuses(__builtin_return_address(0), __builtin_frame_address(0))

/* The linker's names for what it replaces, and for what was there. */
/* NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp) */
mt_status __real_mt_arena_init(mt_arena *a, size_t block_size, mt_err *err);
void *__real_mt_arena_alloc(mt_arena *a, size_t count, size_t size);
double *__real_mt_arena_f64(mt_arena *a, size_t m, size_t n);
int *__real_mt_arena_int(mt_arena *a, size_t n);
char *__real_mt_arena_strdup(mt_arena *a, const char *s);
char *__real_mt_arena_strndup(mt_arena *a, const char *s, size_t length);
char *__real_mt_arena_vprintf(mt_arena *a, const char *fmt, va_list args) MT_PRINTF(2, 0);
void *__real_mt_arena_grow(mt_arena *a, void *items, int count, int *capacity, size_t size);
mt_status __wrap_mt_arena_init(mt_arena *a, size_t block_size, mt_err *err);
void *__wrap_mt_arena_alloc(mt_arena *a, size_t count, size_t size);
double *__wrap_mt_arena_f64(mt_arena *a, size_t m, size_t n);
int *__wrap_mt_arena_int(mt_arena *a, size_t n);
char *__wrap_mt_arena_strdup(mt_arena *a, const char *s);
char *__wrap_mt_arena_strndup(mt_arena *a, const char *s, size_t length);
char *__wrap_mt_arena_printf(mt_arena *a, const char *fmt, ...) MT_PRINTF(2, 3);
char *__wrap_mt_arena_vprintf(mt_arena *a, const char *fmt, va_list args) MT_PRINTF(2, 0);
void *__wrap_mt_arena_grow(mt_arena *a, void *items, int count, int *capacity, size_t size);

mt_status __wrap_mt_arena_init(mt_arena *a, size_t block_size, mt_err *err)
{
    return __real_mt_arena_init(a, REFUSED() ? SIZE_MAX : block_size, err);
}

void *__wrap_mt_arena_alloc(mt_arena *a, size_t count, size_t size)
{
    return REFUSED() ? refuse(a) : __real_mt_arena_alloc(a, count, size);
}

double *__wrap_mt_arena_f64(mt_arena *a, size_t m, size_t n)
{
    return REFUSED() ? refuse(a) : __real_mt_arena_f64(a, m, n);
}

int *__wrap_mt_arena_int(mt_arena *a, size_t n)
{
    return REFUSED() ? refuse(a) : __real_mt_arena_int(a, n);
}

char *__wrap_mt_arena_strdup(mt_arena *a, const char *s)
{
    return REFUSED() ? refuse(a) : __real_mt_arena_strdup(a, s);
}

char *__wrap_mt_arena_strndup(mt_arena *a, const char *s, size_t length)
{
    return REFUSED() ? refuse(a) : __real_mt_arena_strndup(a, s, length);
}

char *__wrap_mt_arena_printf(mt_arena *a, const char *fmt, ...)
{
    va_list args;
    if (REFUSED()) {
        return refuse(a);
    }
    va_start(args, fmt);
    char *const text = __real_mt_arena_vprintf(a, fmt, args);
    va_end(args);
    return text;
}

char *__wrap_mt_arena_vprintf(mt_arena *a, const char *fmt, va_list args)
{
    return REFUSED() ? refuse(a) : __real_mt_arena_vprintf(a, fmt, args);
}

void *__wrap_mt_arena_grow(mt_arena *a, void *items, int count, int *capacity, size_t size)
{
    return REFUSED() ? refuse(a) : __real_mt_arena_grow(a, items, count, capacity, size);
}
/* NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp) */
