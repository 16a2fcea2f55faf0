/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef ENVIRONMENT_READ_PROFILE_H
#define ENVIRONMENT_READ_PROFILE_H

#include "base/diagnostics.h"
#include "environment/vibration.h"
#include "io/options.h"
#include "io/reader.h"

/**
 * Read and check a profile of vibration (format "modetune-profile/1") and the catalogue of
 * aircraft of its rotors: the one that it names, else aircraft.json in its folder, else the one
 * built into the program.
 * @param[out] out  mt_vibration_delete; NULL on failure
 * Fails and messages as for mt_study_load.
 */
mt_status mt_vibration_load(const char *path, const mt_io_options *opt, mt_vibration **out,
                            mt_diagnostics *messages, mt_err *err);
/* As mt_vibration_load, of a profile that another file names: it must lie within opt->root. */
mt_status mt_vibration_load_within(const char *path, const mt_io_options *opt,
                                   mt_vibration **out, mt_diagnostics *messages, mt_err *err);

/* The key tables of a profile, for the test that compares them with the JSON Schema; *n is
 * their number. */
const mt_key_table *const *mt_profile_key_tables(int *n);
/* The types that members of a profile share; *n is their number. */
const mt_schema_type *mt_profile_types(int *n);

#endif
