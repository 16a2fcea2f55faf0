/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_BLAS_H
#define LINALG_BLAS_H

#include "base/base.h"

/*
 * The BLAS under us. Its threads and buffers belong to the whole process: only a program, never
 * the library, may see to them. Two threads make matrices of order twelve five times slower and
 * change the last bits of results.
 */

/* Bytes of address space of the buffer that OpenBLAS keeps per caller at a time, rounded up: 32
 * MB times 4, and a page. */
enum { MT_BLAS_BUFFER = (128 + 1) * 1024 * 1024 };

/* Run OpenBLAS's constructor now, with the environment of now (OPENBLAS_NUM_THREADS), rather
 * than when its turn comes. */
void mt_blas_load(void);
void mt_blas_set_threads(int threads);
/* Have OpenBLAS keep buffers for so many callers at a time (at most 64), so that it never asks
 * for one again: it would ask for ever where there is no room. Before any thread starts. Fails:
 * MT_E_MEMORY. */
mt_status mt_blas_claim(int callers, mt_err *err);
/* Name, version and processor kernel of the BLAS, for `run` of a result; never NULL, owned by
 * the BLAS. */
const char *mt_blas_description(void);

#endif
