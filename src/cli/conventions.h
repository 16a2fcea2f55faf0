/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_CONVENTIONS_H
#define CLI_CONVENTIONS_H

#include "base/text.h"
#include "model/model.h"

/* What signs, axes and orders of bodies in a configuration were understood to mean, a line for
 * each number that has one; nothing where there is none. value [n_nums] as mt_model_numbers
 * gives them. */
void mt_cli_write_conventions(const mt_model *model, int configuration, const double *value,
                              mt_text *out);

#endif
