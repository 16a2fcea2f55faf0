/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_LINT_H
#define MODEL_LINT_H

#include "base/diagnostics.h"
#include "model/model.h"
#include "model/values.h"

/**
 * Check the numbers of a configuration: faults (masses and stiffnesses below 0, sections
 * without area) and warnings (a modulus that no material has, a drive beyond a turn). Each
 * names item and member, has its JSON pointer and, where the model was read from a file, its
 * location.
 * @param[in]  value  [n_nums] as mt_model_numbers gives them
 * @param[in]  whole  a parameter without a finite value is a fault, too, with the reason
 *   ("sqrt(-3) has no finite value"); false: not of this design, one between bounds
 */
void mt_model_lint(const mt_model *model, int configuration, const double *value, bool whole,
                   mt_warning_list *out);

/* A sentence in mem on what the model of this kind of link neglects, part of every result;
 * NULL: nothing. */
const char *mt_model_link_limit(const mt_model *model, int configuration, int link,
                                mt_arena *mem);

/* Succeeds where the numbers of a configuration are free of faults at these inputs. Scratch
 * from mem. Fails: MT_E_USAGE (the first fault that mt_model_lint finds), as
 * mt_model_numbers. */
mt_status mt_model_admit(const mt_model *model, int configuration, int n_inputs,
                         const int *inputs, const double *at, mt_arena *mem, mt_err *err);
/* As mt_model_admit, with all numbers of the model compiled for that configuration. */
mt_status mt_model_admit_numbers(const mt_model *model, int configuration,
                                 const mt_numbers *numbers, const double *at, mt_arena *mem,
                                 mt_err *err);

#endif
