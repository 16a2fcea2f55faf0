/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces the allocator's entry points in front of glibc's own (__libc_*), which do the work.
 * Only glibc offers those; the project's tests run on Debian. */
#define _GNU_SOURCE /* dl_iterate_phdr; NOLINT(cert-dcl37-c,cert-dcl51-cpp) */
#include "mt_alloc.h"

#include <errno.h>
#include <link.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined(__SANITIZE_ADDRESS__)
#    define REPLACE 0
#elif defined(__has_feature)
#    if __has_feature(address_sanitizer)
#        define REPLACE 0
#    endif
#endif
#ifndef REPLACE
#    define REPLACE 1
#endif

/* Atomic: libraries may allocate from threads of their own. */
static _Atomic long allowed = -1; /* allocations left before failure; negative: no limit */
static _Atomic long count;
static _Atomic long live;

void mt_alloc_fail_after(long nth)
{
    allowed = nth;
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

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t n, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *block);

/* Code of OpenBLAS. For some orders its product of small matrices asks malloc for a buffer and writes to it unseen (0.3.21, dgemm_small_kernel): nobody's
 * test can let that fail, and it is no allocation of ours. */
static _Atomic uintptr_t blas_from;
static _Atomic uintptr_t blas_to; /* 0: not looked for yet */

static int find_blas(struct dl_phdr_info *info, size_t size, void *unused)
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

static bool from_blas(const void *caller)
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

/* Is the next allocation to fail? */
static bool refused(void)
{
    if (allowed < 0) {
        return false;
    }
    if (allowed == 0) {
        errno = ENOMEM;
        return true;
    }
    allowed--;
    return false;
}

static void *counted(void *block)
{
    if (block != NULL) {
        count++;
        live++;
    }
    return block;
}

void *malloc(size_t size)
{
    if (from_blas(__builtin_return_address(0))) {
        void *const block = __libc_malloc(size);
        live += block != NULL ? 1 : 0; /* free cannot tell whose it is */
        return block;
    }
    return refused() ? NULL : counted(__libc_malloc(size));
}

void *calloc(size_t n, size_t size)
{
    return refused() ? NULL : counted(__libc_calloc(n, size));
}

void *aligned_alloc(size_t alignment, size_t size)
{
    return refused() ? NULL : counted(__libc_memalign(alignment, size));
}

int posix_memalign(void **block, size_t alignment, size_t size)
{
    void *const got = aligned_alloc(alignment, size);
    if (got == NULL) {
        return ENOMEM;
    }
    *block = got;
    return 0;
}

void *realloc(void *old, size_t size)
{
    if (refused()) {
        return NULL;
    }
    if (old == NULL) {
        return counted(__libc_malloc(size));
    }
    void *const block = __libc_realloc(old, size);
    if (block != NULL) {
        count++;
    } else if (size == 0) { /* glibc has freed it */
        live--;
    }
    return block;
}

void free(void *block)
{
    if (block != NULL) {
        live--;
        __libc_free(block);
    }
}

/* NOLINTEND(cert-dcl37-c,cert-dcl51-cpp,readability-inconsistent-declaration-parameter-name) */

#endif
