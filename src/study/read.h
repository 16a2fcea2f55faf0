/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_READ_H
#define STUDY_READ_H

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
 *   be NULL
 * Every problem in any of the files is reported. Fails: MT_E_INPUT (err: the first; a missing
 * model is a problem of the study), MT_E_SYSTEM (a file cannot be read, or the study itself is
 * missing), MT_E_MEMORY.
 */
mt_status mt_study_load(const char *path, const mt_io_options *opt, mt_study **out,
                        mt_diagnostics *messages, mt_err *err);

/* The key tables of a study file, for the test that compares them with the JSON Schema; *n is
 * their number. `what` is the name of the schema's definition, "" the root. */
const mt_key_table *const *mt_study_key_tables(int *n);
/* The types that members of a study share; *n is their number. */
const mt_schema_type *mt_study_types(int *n);

#endif
