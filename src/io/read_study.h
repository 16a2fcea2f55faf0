/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_READ_STUDY_H
#define IO_READ_STUDY_H

#include "io/io.h"
#include "io/reader.h"
#include "study/study.h"

/* The tables of keys of a study file, for the test that holds them to the JSON Schema; *n their
 * number. `what` is the name of the schema's definition, "" the root. */
const mt_key_table *const *mt_study_key_tables(int *n);

#endif
