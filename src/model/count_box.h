/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_COUNT_BOX_H
#define MODEL_COUNT_BOX_H

/* A family of designs over which modes are counted alike: these parameters anywhere between
 * lower and upper, the others as the model says. Empty: n = 0. */
typedef struct mt_count_box {
    int n;
    int *parameter; /* [n] */
    double *lower;  /* [n] */
    double *upper;
    double *at; /* [n] a design of it: the original */
} mt_count_box;

#endif
