/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_BLAS_H
#define LINALG_BLAS_H

#include "base/base.h"

/*
 * Control of OpenBLAS. Its threads and buffers belong to the whole process, so only a program
 * sets them, never the library. Two threads make matrices of order twelve five times slower and
 * change the last bits of results.
 */

/* Bytes of address space of the buffer that OpenBLAS keeps per concurrent caller, rounded up:
 * 32 MB times 4, and a page. */
enum { MT_BLAS_BUFFER = (128 + 1) * 1024 * 1024 };

/* Run OpenBLAS's constructor now, so that it reads the current environment
 * (OPENBLAS_NUM_THREADS). */
void mt_blas_load(void);
void mt_blas_set_threads(int threads);
/* Make OpenBLAS keep buffers for so many concurrent callers (at most 64), so that it never
 * allocates one later: without memory it would retry for ever. Call before any thread starts.
 * Fails: MT_E_MEMORY. */
mt_status mt_blas_claim(int callers, mt_err *err);
/* Name, version and processor kernel of the BLAS, for `run` of a result; never NULL, owned by
 * the BLAS. */
const char *mt_blas_description(void);

#endif
