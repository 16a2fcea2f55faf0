/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_BLAS_H
#define LINALG_BLAS_H

/*
 * The BLAS under us. Its thread count belongs to the whole process: only a program, never the
 * library, may set it. Two threads make matrices of order twelve five times slower and change
 * the last bits of results.
 */
void mt_blas_set_threads(int threads);
/* Name, version and processor kernel of the BLAS, for `run` of a result; never NULL, owned by
 * the BLAS. */
const char *mt_blas_description(void);

#endif
