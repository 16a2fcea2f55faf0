/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "mechanics/build.h"

/* Add all inputs of what is drawn: vectors, joints, drive. */
static void include_places(const mt_system *sys, uint64_t *set)
{
    const mt_program *const p = &sys->program;
    mt_program_include_inputs(p, sys->drive, set);
    for (int i = 0; i < sys->n_vecs; i++) {
        for (int k = 0; k < 3; k++) {
            mt_program_include_inputs(p, sys->vecs[i].node[k], set);
        }
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        mt_program_include_inputs(p, sys->constraints[i].target, set);
        mt_program_include_inputs(p, sys->constraints[i].coefficient[0], set);
        mt_program_include_inputs(p, sys->constraints[i].coefficient[1], set);
    }
}

/* Add all other inputs of the geometry of stiffness and mass: sections of beams. */
static void include_sections(const mt_system *sys, uint64_t *set)
{
    const mt_program *const p = &sys->program;
    for (int i = 0; i < sys->n_measures && mt_system_beams_shape(sys); i++) {
        for (int k = 0; k < MT_BEAM_NUMBERS; k++) {
            mt_program_include_inputs(p, sys->measures[i].beam[k], set);
        }
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        mt_program_include_inputs(p, sys->inertias[i].shape[0], set);
        mt_program_include_inputs(p, sys->inertias[i].shape[1], set);
    }
}

static void include_sensors(const mt_system *sys, uint64_t *set)
{
    const mt_program *const p = &sys->program;
    for (int i = 0; i < sys->n_channels; i++) {
        mt_program_include_inputs(p, sys->channels[i].shape[0], set);
        mt_program_include_inputs(p, sys->channels[i].shape[1], set);
        mt_program_include_inputs(p, sys->channels[i].fraction, set);
    }
}

/* All numbers of the energy that an equilibrium is a stationary point of. */
static void include_forces(const mt_system *sys, uint64_t *set)
{
    const mt_program *const p = &sys->program;
    for (int i = 0; i < sys->n_springs; i++) {
        mt_program_include_inputs(p, sys->springs[i].stiffness, set);
        mt_program_include_inputs(p, sys->springs[i].free, set);
        mt_program_include_inputs(p, sys->springs[i].preload, set);
    }
    for (int i = 0; i < sys->n_measures; i++) {
        for (int k = 0; k < MT_BEAM_NUMBERS; k++) {
            mt_program_include_inputs(p, sys->measures[i].beam[k], set);
        }
    }
    for (int i = 0; i < sys->n_loads; i++) {
        for (int k = 0; k < 3; k++) {
            mt_program_include_inputs(p, sys->loads[i].force[k], set);
        }
        mt_program_include_inputs(p, sys->loads[i].size, set);
    }
}

void mt_build_inputs(mt_system *sys)
{
    const size_t words = (size_t)sys->program.words;
    sys->places = mt_arena_alloc(&sys->mem, words, sizeof *sys->places);
    sys->frame = mt_arena_alloc(&sys->mem, words, sizeof *sys->frame);
    sys->shape = mt_arena_alloc(&sys->mem, words, sizeof *sys->shape);
    sys->forces = mt_arena_alloc(&sys->mem, words, sizeof *sys->forces);
    if (mt_arena_failed(&sys->mem)) {
        return;
    }
    include_places(sys, sys->places);
    memcpy(sys->frame, sys->places, words * sizeof *sys->frame);
    include_sections(sys, sys->frame);
    memcpy(sys->shape, sys->frame, words * sizeof *sys->shape);
    include_sensors(sys, sys->shape);
    include_forces(sys, sys->forces);
    sys->geometry_fixed = true;
    for (size_t w = 0; w < words; w++) {
        sys->geometry_fixed = sys->geometry_fixed && sys->shape[w] == 0;
    }
}
