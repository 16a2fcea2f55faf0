/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_LARGE_H
#define RESPONSE_LARGE_H

#include "response/response.h"

/*
 * The forced problem of a large mechanism in few coordinates: its rigid-body modes, its lowest
 * modes, and of every force that comes in, is seen or damps locally the shapes g, A g, A^2 g
 * ... of what those modes leave of it (lowest_forced.h), which is what a series in w^2 has.
 * (Modal synthesis with static correction of all orders: Krylov's space; Galerkin's error in
 * it is no more than the series'.)
 */
typedef struct mt_large {
    mt_forced f;       /* of unit mass, K diagonal */
    mt_modes modes;    /* all of that: themselves */
    int shapes;        /* coordinates beside the modes */
    mt_left_out *left; /* row: by the problem's coordinates */
} mt_large;

/* Up to frequency `to`; as mt_response_open_large. Results in mem. */
mt_status mt_large_make(mt_lowest *l, const mt_port_set *ports, double to, mt_arena *mem,
                        mt_large *out, bool *is, char why[MT_LARGE_WHY], mt_err *err);
/* Has the transfer of a basis of it (with all modes) count what is left out. */
mt_status mt_large_left(const mt_large *large, mt_basis *basis, mt_arena *mem, mt_err *err);

#endif
