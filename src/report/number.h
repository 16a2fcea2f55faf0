/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_NUMBER_H
#define REPORT_NUMBER_H

#include <stddef.h>

enum { MT_NUMBER_TEXT = 40 };

/* A number for people: `digits` significant ones (1..17) with trailing zeros, which show the
 * precision ("18.0000"), 0 as "0", NaN ("not applicable") as "-", infinities as a word
 * (base/format.h). Exponents only where |x| >= 10^digits or < 1e-4 ("2.1e+11"). Returns
 * buffer. */
const char *mt_report_number(double x, int digits, char buffer[MT_NUMBER_TEXT]);
/* The same, always with a sign ("+3.20"): for changes. */
const char *mt_report_change(double x, int digits, char buffer[MT_NUMBER_TEXT]);
/* A number for machines: 17 significant digits, empty where not finite (null in JSON). Returns
 * buffer. */
const char *mt_report_exact(double x, char buffer[MT_NUMBER_TEXT]);

#endif
