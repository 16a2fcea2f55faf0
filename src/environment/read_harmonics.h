/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_READ_HARMONICS_H
#define ENVIRONMENT_READ_HARMONICS_H

#include "environment/bands.h"
#include "io/reader.h"

/* Read the harmonics ("4P", "nT") of a rotor of a study or a profile; invalid ones are
 * noted. */
void mt_read_harmonics(mt_reader *r, mt_addr list, mt_rotor *rotor);
/* Warn at addr of suspicious factors of a nominal speed (mt_rotor_warning_range). */
void mt_read_warning_range(mt_reader *r, double lower, double upper, double least,
                           const char *whose, mt_addr addr);
/* The correct form, with this letter, of a multiple per turn written otherwise ("4p", "4/rev",
 * "2"); NULL: not a multiple. */
const char *mt_read_multiple_meant(const mt_reader *r, const char *text, char letter);

#endif
