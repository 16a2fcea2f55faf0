/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MEASUREMENT_READ_H
#define MEASUREMENT_READ_H

#include "base/diagnostics.h"
#include "io/options.h"
#include "measurement/measurement.h"

/* Largest size of a file of measurements. */
enum { MT_MEASUREMENT_MAX_BYTES = 1 << 28 };

/**
 * Read measured frequency responses: a table (CSV), or the datasets 58 of a universal file,
 * which begins with a line "-1".
 *
 * A table has a line of names, then a line for each frequency: frequency_hz; real and imag, or
 * magnitude and phase_deg; and optionally coherence, input, output, configuration and unit,
 * which identify the response. Other columns and lines that begin with # are skipped. Fields
 * are separated by commas, semicolons or tabs, and quoted as in RFC 4180; where commas do not
 * separate, numbers may have decimal commas. `response` writes such tables.
 *     A universal file: complex data, in text or binary (58b, IEEE), at even or uneven
 * frequencies; units by dataset 164, signs of directions taken into the values. Frequencies
 * ascend within a response; a line at 0 Hz is left out.
 * @param[in,out] out  gets responses, in mem, and `read`
 * @param[out] sha256  [MT_SHA256_TEXT] of the file
 * Fails: MT_E_INPUT with line and column in messages and err, as mt_files_read, MT_E_MEMORY.
 */
mt_status mt_measurement_load(const char *path, const mt_io_options *opt, mt_arena *mem,
                              mt_measurement *out, char *sha256, mt_diagnostics *messages,
                              mt_err *err);

#endif
