/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "prove/shaping.h"

/* Note the inputs that a node depends on. */
static void keep(const mt_system *sys, mt_node node, bool *found)
{
    const mt_program *const p = &sys->program;
    for (int i = 0; node != MT_NO_NODE && i < p->n_inputs; i++) {
        const uint64_t word =
            p->inputs_of[((size_t)node * (size_t)p->words) + (size_t)(i / 64)];
        found[i] = found[i] || ((word >> (i % 64)) & 1U) != 0;
    }
}

/* Where a sensor stands moves no mode. */
void mt_enclosure_shaping(const mt_analysis *a, bool *found)
{
    const mt_system *const sys = a->sys;
    for (int i = 0; i < sys->n_inputs; i++) {
        found[i] = false;
    }
    keep(sys, sys->drive, found);
    for (int i = 0; i < sys->n_vecs; i++) {
        for (int k = 0; k < 3; k++) {
            keep(sys, sys->vecs[i].node[k], found);
        }
    }
    for (int i = 0; i < sys->n_measures && mt_system_beams_shape(sys); i++) {
        for (int k = 0; k < MT_BEAM_NUMBERS; k++) {
            keep(sys, sys->measures[i].beam[k], found);
        }
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        keep(sys, sys->constraints[i].target, found);
        keep(sys, sys->constraints[i].coefficient[0], found);
        keep(sys, sys->constraints[i].coefficient[1], found);
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        keep(sys, sys->inertias[i].shape[0], found);
        keep(sys, sys->inertias[i].shape[1], found);
    }
}
