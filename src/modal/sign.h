/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODAL_SIGN_H
#define MODAL_SIGN_H

/* Make each column's entry of largest magnitude positive; entries within a relative 1e-6 of the
 * largest count as tied, and the first of them decides. phi n x r. */
void mt_modal_fix_sign(int n, int r, double *phi);

#endif
