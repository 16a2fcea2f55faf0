/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_DAMPED_H
#define CLI_DAMPED_H

#include "analysis/damping.h"
#include "cli/cli.h"
#include "report/table.h"

/* Columns and rows; configuration NULL: no such column. */
void mt_damped_columns(mt_table *t, bool with_configuration);
void mt_damped_rows(mt_table *t, const mt_damped_modes *d, int count,
                    const char *configuration);
/* Print the table with its notes. count: oscillating modes to show, 0: all. */
void mt_damped_print(const mt_damped_modes *d, int count, mt_text *out);
/* Member "damped_modes". */
void mt_damped_json(const mt_damped_modes *d, int count, mt_json_writer *w);

#endif
