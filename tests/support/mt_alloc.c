/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces the allocator's entry points in front of glibc's own (__libc_*), which do the work.
 * Only glibc offers those; the project's tests run on Debian. */
#define _GNU_SOURCE /* dl_iterate_phdr; NOLINT(cert-dcl37-c,cert-dcl51-cpp) */
#include "mt_alloc.h"

#include <errno.h>
#include <limits.h>
#include <link.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#    define SANITIZED 1
#elif defined(__has_feature)
#    if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#        define SANITIZED 1
#    endif
#endif
/* clang links its sanitizer into the program, where two of a name are one too many. */
#if defined(SANITIZED) && defined(__clang__)
#    define REPLACE 0
#else
#    define REPLACE 1
#endif

/* Atomic: libraries may allocate from threads of their own. */
static _Atomic long asked;           /* allocations asked for */
static _Atomic long from = LONG_MAX; /* those numbered from .. to are refused */
static _Atomic long to = LONG_MAX;
static _Atomic long count;
static _Atomic long live;
static void (*_Atomic watch)(const void *caller, size_t size);
#ifdef SANITIZED
static _Atomic bool used; /* told to look beside a sanitizer */
#else
static const bool used = true;
#endif

void mt_alloc_fail_after(long nth)
{
    from = LONG_MAX;
    to = LONG_MAX;
    from = nth < 0 ? LONG_MAX : asked + nth;
}

void mt_alloc_fail_only(long nth)
{
    from = LONG_MAX;
    to = asked + nth;
    from = asked + nth;
}

void mt_alloc_watch(void (*seen)(const void *caller, size_t size))
{
    watch = seen;
}

void mt_alloc_use_beside_sanitizer(void)
{
#ifdef SANITIZED
    used = true;
#endif
}

long mt_alloc_count(void)
{
    return count;
}

long mt_alloc_live(void)
{
    return live;
}

bool mt_alloc_works(void)
{
    const long before = count;
    /* volatile: a direct call could be inlined here and yet be redirected everywhere else */
    void *(*volatile const allocate)(size_t) = malloc;
    free(allocate(1));
    return count == before + 1;
}

#if REPLACE

/* NOLINTBEGIN(cert-dcl37-c,cert-dcl51-cpp,readability-inconsistent-declaration-parameter-name):
 * these names are the C library's, and meant to be */

#    ifdef SANITIZED
/* what the sanitizer puts in place of the C library's; it may be called before a sanitizer is
 * ready, so that what calls it is not instrumented */
#        define REAL(name) __interceptor_##name
#        define PLAIN      __attribute__((no_sanitize("address", "undefined")))
#    else
#        define REAL(name) __libc_##name
#        define PLAIN
#    endif
void *REAL(malloc)(size_t size);
void *REAL(calloc)(size_t n, size_t size);
void *REAL(realloc)(void *old, size_t size);
void *REAL(memalign)(size_t alignment, size_t size);
void REAL(free)(void *block);

/* Code of OpenBLAS. For some orders its product of small matrices asks malloc for a buffer and
 * writes to it unseen (0.3.21, dgemm_small_kernel): nobody's test can let that fail, and it is
 * no allocation of ours. */
static _Atomic uintptr_t blas_from;
static _Atomic uintptr_t blas_to; /* 0: not looked for yet */

PLAIN static int find_blas(struct dl_phdr_info *info, size_t size, void *unused)
{
    (void)size;
    (void)unused;
    for (int i = 0; i < info->dlpi_phnum && strstr(info->dlpi_name, "libopenblas") != NULL;
         i++) {
        if (info->dlpi_phdr[i].p_type == PT_LOAD && (info->dlpi_phdr[i].p_flags & PF_X) != 0) {
            blas_from = info->dlpi_addr + info->dlpi_phdr[i].p_vaddr;
            blas_to = blas_from + info->dlpi_phdr[i].p_memsz;
        }
    }
    return 0;
}

PLAIN static bool from_blas(const void *caller)
{
    static _Atomic bool looking;
    if (blas_to == 0) {
        if (looking) {
            return false;
        }
        looking = true;
        blas_to = 1;
        (void)dl_iterate_phdr(find_blas, NULL);
        looking = false;
    }
    return (uintptr_t)caller >= blas_from && (uintptr_t)caller < blas_to;
}

/* NLopt (2.7.1) ends the process where it has no memory for a sentence. That there is some is
 * seen to before (local.c), which a shortage of one moment cannot know. */
extern char *nlopt_vsprintf(char *text, const char *format, va_list args) __attribute__((weak));

PLAIN static bool from_nlopt_message(const void *caller)
{
    enum { CODE_BYTES = 256 };
    const uintptr_t begin = (uintptr_t)nlopt_vsprintf;
    return begin != 0 && (uintptr_t)caller - begin < CODE_BYTES;
}

/* Is this allocation to fail? */
PLAIN bool mt_alloc_refuses(const void *caller, size_t size)
{
    if (!used) {
        return false;
    }
    void (*const seen)(const void *, size_t) = watch;
    if (seen != NULL) {
        seen(caller, size);
    }
    const long number = asked++;
    if (number < from || number > to) {
        return false;
    }
    errno = ENOMEM;
    return true;
}

PLAIN static void *counted(void *block)
{
    if (block != NULL && used) {
        count++;
        live++;
    }
    return block;
}

#    define CALLER() __builtin_return_address(0)

PLAIN void *malloc(size_t size)
{
    if (used && from_blas(CALLER())) {
        void *const block = REAL(malloc)(size);
        live += block != NULL ? 1 : 0; /* free cannot tell whose it is */
        return block;
    }
    return mt_alloc_refuses(CALLER(), size) ? NULL : counted(REAL(malloc)(size));
}

PLAIN void *calloc(size_t n, size_t size)
{
    return mt_alloc_refuses(CALLER(), n * size) ? NULL : counted(REAL(calloc)(n, size));
}

PLAIN void *aligned_alloc(size_t alignment, size_t size)
{
    return mt_alloc_refuses(CALLER(), size) ? NULL : counted(REAL(memalign)(alignment, size));
}

PLAIN int posix_memalign(void **block, size_t alignment, size_t size)
{
    void *const got =
        mt_alloc_refuses(CALLER(), size) ? NULL : counted(REAL(memalign)(alignment, size));
    if (got == NULL) {
        return ENOMEM;
    }
    *block = got;
    return 0;
}

PLAIN void *realloc(void *old, size_t size)
{
    if (!from_nlopt_message(CALLER()) && mt_alloc_refuses(CALLER(), size)) {
        return NULL;
    }
    if (old == NULL) {
        return counted(REAL(malloc)(size));
    }
    void *const block = REAL(realloc)(old, size);
    if (block != NULL) {
        count++;
    } else if (size == 0) { /* glibc has freed it */
        live--;
    }
    return block;
}

PLAIN void free(void *block)
{
    if (block != NULL) {
        live--;
        REAL(free)(block);
    }
}

/* NOLINTEND(cert-dcl37-c,cert-dcl51-cpp,readability-inconsistent-declaration-parameter-name) */

#else

bool mt_alloc_refuses(const void *caller, size_t size)
{
    (void)caller;
    (void)size;
    return false;
}

#endif
