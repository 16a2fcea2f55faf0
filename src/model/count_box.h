/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_COUNT_BOX_H
#define MODEL_COUNT_BOX_H

/* Box of designs over which modes are counted with one number: these parameters between lower
 * and upper, the others as in the model. Empty: n = 0. */
typedef struct mt_count_box {
    int n;
    int *parameter; /* [n] */
    double *lower;  /* [n] */
    double *upper;
    double *at; /* [n] the original design */
} mt_count_box;

#endif
