/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "prove/shaping.h"

void mt_enclosure_shaping(const mt_analysis *a, bool *found)
{
    for (int i = 0; i < a->sys->n_inputs; i++) {
        found[i] = mt_program_has_input(a->sys->frame, i);
    }
}
