/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_JUDGE_H
#define MODAL_JUDGE_H

#include "modal/modes.h"

/*
 * What the terms that K and M are sums of say of the shapes y, each term evaluated by itself:
 * spring by spring c (f . y)^2, and so on. Where stiff springs hardly take part in a mode,
 * their terms are tiny, and the sum is accurate where an entry of the assembled K is not.
 */
typedef struct mt_mode_energies {
    double *stiffness;       /* [count] y^T K y */
    double *mass;            /* [count] y^T M y */
    double *stiffness_noise; /* [count] what rounding may have made of it, counted by terms */
    double *mass_noise;      /* [count] */
    double *given_noise; /* [count] the part of stiffness_noise, and of mass_noise times lambda,
                            that is in K and M as they are given, and that no solution of them
                            can be without */
    bool *strained;      /* [count] a spring moves by more than the rounding of its terms */
    int count;           /* the lowest modes; the others have no doubts to be judged */
    /* NULL, or mt_modal_groups: then stiffness, mass and their noises go on, behind count, with
     * those of mt_modal_pair_shapes, and what they say of y_i^T (K - lambda M) y_k is known */
    const int *group;
} mt_mode_energies;
/*
 * Replace each lambda_i by the quotient of its energies where that is the surer one, and decide
 * the kinds anew, mode by mode: n_rigid as in the options of the solve that gave `modes` (with
 * vectors). Now a rigid-body mode is one within its error in which no spring is strained, and
 * one that is strained is undecided. A shape whose error is at most r in the norm of the
 * residual changes the quotient by r min(1, r/gap) at most, gap: distance to the next lambda
 * (Parlett, The Symmetric Eigenvalue Problem, sec. 10-5 and 11-7). Modes of one group are
 * judged together: their quotients are eigenvalues to the greatest sum of |y_i^T (K - lambda M)
 * y_k| over the others (Weyl), and the gap is that to the modes beside the group. Overwrites e,
 * whose arrays have room for all modes.
 */
void mt_modal_judge(mt_mode_energies *e, int n_rigid, mt_modes *modes);

/* Of how many, the lowest, that is worth its while where no errors are asked for: up to the
 * last mode of which the kind could be wrong or the error is above 1e-9 of its lambda. */
int mt_modal_doubtful(const mt_modes *modes);

/* Whether the error of a vibration that has a shape is above 1e-9 of its lambda. */
bool mt_modal_rough(const mt_modes *modes);

/* Neighbours that stand too close for a gap between them, up to eight: group[count], the first
 * mode of the group that each belongs to. Returns how many pairs i < k of one group there are.
 */
int mt_modal_groups(const mt_modes *modes, int count, int *group);
/* (y_i + y_k)/sqrt 2 of these pairs, y n x pairs. */
void mt_modal_pair_shapes(const mt_modes *modes, int count, const int *group, double *y);

#endif
