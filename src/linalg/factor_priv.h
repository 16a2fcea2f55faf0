/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_FACTOR_PRIV_H
#define LINALG_FACTOR_PRIV_H

#include "linalg/factor.h"

struct mt_factor_pattern {
    int n;
    int n_super;
    int *to;          /* [n] index of a row in the order of P */
    int *first;       /* [n_super + 1] first column of a supernode */
    int *row_at;      /* [n_super + 1] start of its rows in `row`, its own columns first */
    int *row;         /* ascending, in the order of P */
    ptrdiff_t *at;    /* [n_super + 1] start of its block in l: rows x columns */
    int *super_of;    /* [n] supernode that has the column */
    size_t most_rows; /* largest number of rows of a supernode */
    size_t most_columns;
};

#endif
