/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_JUDGE_H
#define MODAL_JUDGE_H

#include "modal/modes.h"

/*
 * Energies of the shapes y, summed over the terms of K and M: spring by spring c (f . y)^2, and
 * so on. Where stiff springs hardly take part in a mode, their terms are tiny, and the sum is
 * accurate where an entry of the assembled K is not.
 */
typedef struct mt_mode_energies {
    double *stiffness;       /* [count] y^T K y */
    double *mass;            /* [count] y^T M y */
    double *stiffness_noise; /* [count] bound of its rounding error, by terms */
    double *mass_noise;      /* [count] */
    /* [count] the part of stiffness_noise, and of mass_noise times lambda, that is already in
     * the entries of K and M and that every solution with them has */
    double *given_noise;
    bool *strained; /* [count] a spring moves by more than the rounding of its terms */
    int count;      /* the lowest modes; the others need no check */
    /* NULL, or from mt_modal_groups: then stiffness, mass and their noises continue behind
     * count with the pairs of mt_modal_pair_shapes, which give y_i^T (K - lambda M) y_k */
    const int *group;
} mt_mode_energies;
/*
 * Replace each lambda_i by the quotient of its energies where that is more accurate, and
 * classify the modes again: n_rigid as in the options of the solve that gave `modes` (with
 * vectors). A rigid-body mode is now one that is 0 within its error and strains no spring; one
 * that strains a spring is undecided. A shape with an error of at most r in the norm of the
 * residual changes the quotient by at most r min(1, r/gap), gap: distance to the next lambda
 * (Parlett, The Symmetric Eigenvalue Problem, sec. 10-5 and 11-7). Modes of one group are
 * treated together: their quotients are eigenvalues to the greatest sum of |y_i^T (K - lambda
 * M) y_k| over the others (Weyl), and the gap is that to the modes next to the group.
 * Overwrites e, whose arrays have room for all modes.
 */
void mt_modal_judge(mt_mode_energies *e, int n_rigid, mt_modes *modes);

/* Number of lowest modes worth this check where no errors are wanted: up to the last mode whose
 * kind may be wrong or whose error is above 1e-9 of its lambda. */
int mt_modal_doubtful(const mt_modes *modes);

/* True where a vibration mode with a shape has an error above 1e-9 of its lambda. */
bool mt_modal_rough(const mt_modes *modes);

/* Groups of up to eight neighbours too close for a gap between them: group[count], the first
 * mode of each mode's group. Returns the number of pairs i < k within groups. */
int mt_modal_groups(const mt_modes *modes, int count, int *group);
/* (y_i + y_k)/sqrt 2 of these pairs, y n x pairs. */
void mt_modal_pair_shapes(const mt_modes *modes, int count, const int *group, double *y);

#endif
