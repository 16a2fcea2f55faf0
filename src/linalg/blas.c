/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linalg/blas.h"

#include <cblas.h>

void mt_blas_set_threads(int threads)
{
    openblas_set_num_threads(threads > 1 ? threads : 1);
}

const char *mt_blas_description(void)
{
    const char *const text = openblas_get_config();
    return text == NULL ? "OpenBLAS" : text;
}
