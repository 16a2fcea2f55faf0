/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef INSPECT_ENERGIES_H
#define INSPECT_ENERGIES_H

#include "analysis/energy_share.h"
#include "inspect/loaded_model.h"

/* Who has the energy of each mode: what `modes --energy` tells, as records. Shares of modes of
 * one frequency are sums over them (analysis/energy_share.h). */

typedef struct mt_energies_question {
    const char *about; /* a point of the model; NULL: each body's centre */
    const char *axes;  /* one of mt_energy_axes_names; NULL: global */
} mt_energies_question;

/* Energies of the modes of one configuration, solved with shapes. */
typedef struct mt_energies {
    mt_energy_owners owners;
    mt_energy_about about;
    int n;                    /* modes */
    mt_energy_shares *shares; /* [n] */
} mt_energies;

/* Of the first n positions, in mem. Fails: MT_E_USAGE (no such point or axes), as
 * mt_analysis_energy_shares. */
mt_status mt_energies_take(const mt_model *model, mt_analysis *a,
                           const mt_energies_question *question, int n, mt_arena *mem,
                           mt_energies *out, mt_err *err);

/* A body or link, in percent; NaN where it has no such direction. */
typedef struct mt_energy_body_row {
    const char *body;
    const char *axes;
    double percent[MT_ENERGY_DIRECTIONS];
    double total;
} mt_energy_body_row;

/* A spring or link, in percent; components are those of a bushing, else NaN. */
typedef struct mt_energy_spring_row {
    const char *spring;
    double percent[MT_ENERGY_DIRECTIONS];
    double total;
    bool components;
} mt_energy_spring_row;

/* A mode. */
typedef struct mt_energy_row {
    int modes;
    mt_energy_body_row *kinetic;
    int n_kinetic;
    mt_energy_spring_row *strain; /* NULL: it strains nothing */
    int n_strain;
    double loads;
    double kinetic_sum;
    double strain_sum;
} mt_energy_row;

extern const mt_record mt_energy_record;
extern const mt_record mt_energy_body_record;
extern const mt_record mt_energy_spring_record;
/* Of the mode at position i; in mem, which remembers a shortage. */
mt_energy_row mt_energy_row_of(const mt_system *sys, const mt_energies *e, int i,
                               mt_arena *mem);

#endif
