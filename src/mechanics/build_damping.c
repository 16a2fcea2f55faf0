/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of a configuration's damping. */
#include "mechanics/build.h"

void mt_build_damping(mt_builder *b)
{
    mt_system *const sys = b->sys;
    const mt_damping *const d = &b->model->configurations[sys->configuration].damping;
    mt_damping_def *const def = &sys->damping;
    *def = (mt_damping_def){.mass = MT_NO_NODE, .stiffness = MT_NO_NODE, .ratio = MT_NO_NODE};
    if (!d->given) {
        return;
    }
    def->mass = mt_build_num(b, d->mass);
    def->stiffness = mt_build_num(b, d->stiffness);
    def->ratio = mt_build_num(b, d->ratio);
    def->ratios = mt_arena_alloc(&sys->mem, (size_t)d->n_ratios, sizeof *def->ratios);
    def->named = mt_arena_int(&sys->mem, (size_t)d->n_named);
    def->named_ratios =
        mt_arena_alloc(&sys->mem, (size_t)d->n_named, sizeof *def->named_ratios);
    if (mt_arena_failed(&sys->mem)) {
        return;
    }
    def->n_ratios = d->n_ratios;
    for (int i = 0; i < d->n_ratios; i++) {
        def->ratios[i] = mt_build_num(b, d->ratios[i]);
    }
    for (int i = 0; i < d->n_named; i++) {
        const mt_mode_ratio *const m = &d->named[i];
        if (b->model->modes[m->mode].configuration == sys->configuration) {
            def->named[def->n_named] = m->mode;
            def->named_ratios[def->n_named++] = mt_build_num(b, m->ratio);
        }
    }
    def->modal = def->ratio != MT_NO_NODE || def->n_ratios > 0 || def->n_named > 0;
}
