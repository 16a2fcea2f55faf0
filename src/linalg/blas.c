/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * OpenBLAS claims a work buffer (128 MB of address space, of which small matrices touch little)
 * for every thread that is in it at the same time, keeps it, and where it cannot have one asks
 * for ever. Its own threads, started when it is loaded, do the same before main begins. So a
 * program loads it with one thread, and claims the buffers of its workers while a failure can
 * still be told. (The serial OpenBLAS starts no threads, but without locks: Debian's is not for
 * callers with threads.)
 */
#include "linalg/blas.h"

#include <cblas.h>

#include <stdlib.h>

/* Exported by every OpenBLAS, though no header declares them: its constructor, which does
 * nothing the second time, and its pool. */
extern void gotoblas_init(void) __attribute__((weak));
extern void *blas_memory_alloc(int position) __attribute__((weak));
extern void blas_memory_free(void *buffer) __attribute__((weak));

void mt_blas_load(void)
{
    if (gotoblas_init != NULL) {
        gotoblas_init();
    }
}

void mt_blas_set_threads(int threads)
{
    openblas_set_num_threads(threads > 1 ? threads : 1);
}

mt_status mt_blas_claim(int callers, mt_err *err)
{
    enum { MOST = 64 };
    void *buffers[MOST];
    const int n = callers < 1 ? 1 : callers > MOST ? MOST : callers;
    int have = 0;
    while (have < n && blas_memory_alloc != NULL && blas_memory_free != NULL) {
        void *volatile const room = malloc(MT_BLAS_BUFFER); /* not to be optimised away */
        if (room == NULL) {
            break;
        }
        free(room);
        buffers[have++] = blas_memory_alloc(0);
    }
    for (int i = have - 1; i >= 0; i--) {
        blas_memory_free(buffers[i]);
    }
    if (have < n && blas_memory_alloc != NULL && blas_memory_free != NULL) {
        return mt_fail(err, MT_E_MEMORY,
                       "out of memory: OpenBLAS reserves 128 MB of address space for each "
                       "worker, which not all of %d can have",
                       n);
    }
    return MT_OK;
}

const char *mt_blas_description(void)
{
    const char *const text = openblas_get_config();
    return text == NULL ? "OpenBLAS" : text;
}
