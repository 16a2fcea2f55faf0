/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/read_harmonics.h"

void mt_read_harmonics(mt_reader *r, mt_addr list, mt_rotor *rotor)
{
    mt_items items = mt_reader_some_items(r, list, "the list of harmonics");
    rotor->harmonics = mt_reader_room(r, &items, sizeof *rotor->harmonics);
    while (mt_items_next(&items)) {
        mt_harmonic *const h = &rotor->harmonics[rotor->n_harmonics];
        const char *const text = mt_reader_text(r, items.at);
        if (text != NULL && mt_harmonic_parse(text, h)) {
            h->addr = items.at;
            rotor->n_harmonics++;
        } else if (text != NULL) {
            mt_diag_structure(r->diags, items.at,
                              "\"%s\" is no harmonic: a number from 1 to 999, n (the number of "
                              "blades) or both, then P (main rotor) or T (tail rotor)",
                              text);
        }
    }
}
