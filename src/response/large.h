/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_LARGE_H
#define RESPONSE_LARGE_H

#include "response/response.h"

/*
 * The forced problem of a large mechanism in few coordinates: its rigid-body modes, its lowest
 * modes, and for each input, output and local damper with force shape g the shapes g, A g, A^2
 * g ... of the part of g that these modes leave (analysis/lowest.h), the terms of a series in
 * w^2. (Modal synthesis with static correction of all orders: a Krylov space; Galerkin's error
 * in it is at most that of the series.)
 */
typedef struct mt_large {
    mt_forced f;       /* of unit mass, K diagonal */
    mt_modes modes;    /* all modes of f: unit vectors */
    int shapes;        /* coordinates besides the modes */
    mt_left_out *left; /* its rows are in the coordinates of f */
} mt_large;

/* Builds *out for frequencies up to `to` [rad/s]; arguments and failures as
 * mt_response_open_large. Results in mem. */
mt_status mt_large_make(mt_lowest *l, const mt_port_set *ports, double to, mt_arena *mem,
                        mt_large *out, bool *is, char why[MT_LARGE_WHY], mt_err *err);

#endif
