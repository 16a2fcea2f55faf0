/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model: the description of one mechanism, read from a file, checked and immutable. It may be
 * shared by threads. */
#ifndef MODETUNE_MODEL_H
#define MODETUNE_MODEL_H

#include "modetune/export.h"
#include "modetune/read.h"
#include "modetune/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mt_model mt_model;

/**
 * Read a model file (format "modetune-model/1").
 * @param[in]  path  regular file of at most 16 MiB, or one that opt gives by its text
 * @param[in]  opt   NULL: defaults
 * @param[out] out   the model, owned by the caller; NULL on failure
 * O(size of the file). Fails: MT_E_INPUT (the file is wrong; err gives the first problem with
 * line, column and JSON pointer, and the number of others; opt->diagnostics lists all),
 * MT_E_SYSTEM (the file cannot be read), MT_E_USAGE (opt), MT_E_MEMORY.
 */
MT_API mt_status mt_model_read(const char *path, const mt_read_options *opt, mt_model **out,
                               mt_err *err);
/* Accepts NULL. */
MT_API void mt_model_delete(mt_model *model);

/* Name of the model; NULL where it has none. Lives as long as the model, like all names
 * below. */
MT_API const char *mt_model_title(const mt_model *model);
/* Number of space dimensions: 2 or 3. */
MT_API int mt_model_dimension(const mt_model *model);
/* Number of parameters, and the name of each (NULL beyond the last). */
MT_API int mt_model_parameter_count(const mt_model *model);
MT_API const char *mt_model_parameter_name(const mt_model *model, int parameter);
/* Unit of the parameter's values in this library, which are in SI: "m" also where the file
 * gives the number in "mm", "cm", "in" or "ft", "rad" for "deg", "Hz" for "rpm"; NULL where the
 * file gives none, and beyond the last. */
MT_API const char *mt_model_parameter_unit(const mt_model *model, int parameter);
/* 1: the parameter is an expression of others; 0: it is a number, or beyond the last. */
MT_API int mt_model_parameter_follows(const mt_model *model, int parameter);
/* Number of configurations (at least 1), and the name of each (NULL beyond the last). */
MT_API int mt_model_configuration_count(const mt_model *model);
MT_API const char *mt_model_configuration_name(const mt_model *model, int configuration);

#ifdef __cplusplus
}
#endif

#endif
