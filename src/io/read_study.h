/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_READ_STUDY_H
#define IO_READ_STUDY_H

#include "base/diagnostics.h"
#include "io/options.h"
#include "io/reader.h"
#include "study/study.h"

/**
 * Read, resolve and check a study file (format "modetune-study/1") with the models that it
 * names.
 * @param[in]  opt       NULL: defaults; the models must lie beneath root
 * @param[out] out       the study, owned by the caller (mt_study_delete), models included; NULL
 *                       on failure
 * @param[out] messages the diagnostics of the study, then those of the models, are added; may
 *   be NULL Every problem is reported, whichever file it is in. Fails: MT_E_INPUT (err: the
 *   first; a model that is not there counts as one of the study's problems), MT_E_SYSTEM (a
 *   file cannot be read, or the study itself is not there), MT_E_MEMORY.
 */
mt_status mt_study_load(const char *path, const mt_io_options *opt, mt_study **out,
                        mt_diagnostics *messages, mt_err *err);

/* The tables of keys of a study file, for the test that holds them to the JSON Schema; *n their
 * number. `what` is the name of the schema's definition, "" the root. */
const mt_key_table *const *mt_study_key_tables(int *n);

#endif
