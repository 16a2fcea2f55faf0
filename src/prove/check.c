/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conditions under which bounds of the coefficients bound the modes, as far as the system's
 * structure shows them. */
#include "prove/check.h"

#include "base/format.h"

/* First input that a node depends on; -1. */
static int input_of(const mt_system *sys, mt_node node)
{
    const mt_program *const p = &sys->program;
    if (node == MT_NO_NODE || mt_program_is_constant(p, node)) {
        return -1;
    }
    for (int i = 0; i < p->n_inputs; i++) {
        const uint64_t word =
            p->inputs_of[((size_t)node * (size_t)p->words) + (size_t)(i / 64)];
        if (((word >> (i % 64)) & 1U) != 0) {
            return i;
        }
    }
    return -1;
}

static void keep(const mt_system *sys, mt_node node, int *found)
{
    *found = *found >= 0 ? *found : input_of(sys, node);
}

/* An input that shapes the geometry of stiffness and mass; -1 where none does (where a sensor
 * stands moves no mode). */
static int shaping_input(const mt_system *sys)
{
    int found = -1;
    keep(sys, sys->drive, &found);
    for (int i = 0; i < sys->n_vecs; i++) {
        for (int k = 0; k < 3; k++) {
            keep(sys, sys->vecs[i].node[k], &found);
        }
    }
    for (int i = 0; i < sys->n_measures && mt_system_beams_shape(sys); i++) {
        for (int k = 0; k < MT_BEAM_NUMBERS; k++) {
            keep(sys, sys->measures[i].beam[k], &found);
        }
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        keep(sys, sys->constraints[i].target, &found);
        keep(sys, sys->constraints[i].coefficient[0], &found);
        keep(sys, sys->constraints[i].coefficient[1], &found);
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        keep(sys, sys->inertias[i].shape[0], &found);
        keep(sys, sys->inertias[i].shape[1], &found);
    }
    return found;
}

static bool refuse(char *reason, const char *what, const char *name, const char *does)
{
    (void)mt_snprintf(reason, MT_REASON_SIZE, "%s \"%s\" %s", what, name, does);
    return false;
}

static bool loads_refused(const mt_system *sys, char *reason)
{
    if (!sys->loaded) {
        return true;
    }
    for (int i = 0; i < sys->n_springs && sys->n_loads == 0; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        if (!s->damper && (s->free != MT_NO_NODE || s->preload != MT_NO_NODE)) {
            return refuse(reason, "spring", s->name, "is preloaded");
        }
    }
    for (int i = 0; i < sys->n_loads; i++) {
        if (sys->loads[i].name != NULL) {
            return refuse(reason, "load", sys->loads[i].name, "acts on the mechanism");
        }
    }
    (void)mt_snprintf(reason, MT_REASON_SIZE, "gravity loads the mechanism");
    return false;
}

bool mt_enclosure_admits(const mt_analysis *a, char *reason)
{
    const mt_system *const sys = a->sys;
    if (!loads_refused(sys, reason)) {
        return false;
    }
    if (mt_linear_reduced(a->lin).loaded) {
        (void)mt_snprintf(reason, MT_REASON_SIZE,
                          "a driven joint or an equilibrium places the mechanism");
        return false;
    }
    const int shaping = shaping_input(sys);
    if (shaping >= 0) {
        return refuse(reason, "parameter", sys->model->parameters[sys->inputs[shaping]].name.s,
                      "shapes the geometry");
    }
    return true;
}
