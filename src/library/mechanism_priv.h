/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LIBRARY_MECHANISM_PRIV_H
#define LIBRARY_MECHANISM_PRIV_H

#include "modetune/mechanism.h"

#include "analysis/analysis.h"

struct mt_mechanism {
    mt_analysis *a; /* owned */
    mt_arena mem;   /* lives as long as this */
    mt_arena scratch;
    int n_inputs;
    int *inputs;   /* [n_inputs] parameters */
    double *at;    /* [n_inputs] their values at the last evaluation */
    bool slopes;   /* derivatives were requested once: prepare them again */
    bool has_none; /* the last evaluation failed */
};

#endif
