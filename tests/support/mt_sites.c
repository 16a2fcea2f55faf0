/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mt_sites.h"

#include <stdarg.h>

#include "base/arena.h"

static struct {
    const void *place[MT_SITES_MOST];
    int n;
    bool recording;
    int failing; /* -1: none */
    bool failed;
} sites = {.failing = -1};

void mt_sites_record(void)
{
    sites.n = 0;
    sites.recording = true;
    sites.failing = -1;
}

void mt_sites_fail(int i)
{
    sites.failing = i;
    sites.failed = false;
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

static bool refuses(const void *place)
{
    if (sites.failing >= 0) {
        const bool now = !sites.failed && sites.place[sites.failing] == place;
        sites.failed = sites.failed || now;
        return now;
    }
    for (int i = 0; i < sites.n && sites.recording; i++) {
        if (sites.place[i] == place) {
            return false;
        }
    }
    if (sites.recording && sites.n < MT_SITES_MOST) {
        sites.place[sites.n++] = place;
    }
    return false;
}

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
    *a = (mt_arena){0};
    return refuses(__builtin_return_address(0)) ? mt_fail_memory(err)
                                                : __real_mt_arena_init(a, block_size, err);
}

void *__wrap_mt_arena_alloc(mt_arena *a, size_t count, size_t size)
{
    return refuses(__builtin_return_address(0)) ? NULL : __real_mt_arena_alloc(a, count, size);
}

double *__wrap_mt_arena_f64(mt_arena *a, size_t m, size_t n)
{
    return refuses(__builtin_return_address(0)) ? NULL : __real_mt_arena_f64(a, m, n);
}

int *__wrap_mt_arena_int(mt_arena *a, size_t n)
{
    return refuses(__builtin_return_address(0)) ? NULL : __real_mt_arena_int(a, n);
}

char *__wrap_mt_arena_strdup(mt_arena *a, const char *s)
{
    return refuses(__builtin_return_address(0)) ? NULL : __real_mt_arena_strdup(a, s);
}

char *__wrap_mt_arena_strndup(mt_arena *a, const char *s, size_t length)
{
    return refuses(__builtin_return_address(0)) ? NULL : __real_mt_arena_strndup(a, s, length);
}

char *__wrap_mt_arena_printf(mt_arena *a, const char *fmt, ...)
{
    va_list args;
    if (refuses(__builtin_return_address(0))) {
        return NULL;
    }
    va_start(args, fmt);
    char *const text = __real_mt_arena_vprintf(a, fmt, args);
    va_end(args);
    return text;
}

char *__wrap_mt_arena_vprintf(mt_arena *a, const char *fmt, va_list args)
{
    return refuses(__builtin_return_address(0)) ? NULL : __real_mt_arena_vprintf(a, fmt, args);
}

void *__wrap_mt_arena_grow(mt_arena *a, void *items, int count, int *capacity, size_t size)
{
    return refuses(__builtin_return_address(0))
               ? NULL
               : __real_mt_arena_grow(a, items, count, capacity, size);
}
/* NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp) */
