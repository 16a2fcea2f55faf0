/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LIBRARY_SCENE_DESIGNS_H
#define LIBRARY_SCENE_DESIGNS_H

#include "base/text.h"
#include "result/result.h"
#include "scene/scene.h"

/* The designs of a result as queries of a scene (mt_scene_new): the original one, with the
 * overrides of the study, then the recommended ones. asks[n] in mem, with texts of the result.
 * configurations[n_configurations]: those to show. Fails: MT_E_INPUT (a parameter that the
 * model lacks or without a value), MT_E_USAGE (the model is no mechanism in one of these),
 * MT_E_MEMORY. */
mt_status mt_scene_designs(const mt_model *model, const mt_result *result, int n_configurations,
                           const int *configurations, mt_arena *mem, mt_scene_query **asks,
                           int *n, mt_err *err);
/* All configurations of the model in configurations[n_configurations]: first those of which the
 * result has frequencies, in its order; returns the number of these. */
int mt_scene_order(const mt_model *model, const mt_result *result, int *configurations);
/**
 * Write the scene of a result's report as JSON: all designs, in the configurations of which the
 * result has frequencies; in all configurations where it has none. Nothing is written where the
 * model does not fit the result, or the scene is empty.
 * @param[in] model the one that was solved; NULL: not available
 * Fails: MT_E_MEMORY.
 */
mt_status mt_scene_of_result(const mt_model *model, const mt_result *result, int threads,
                             mt_text *json, mt_err *err);
/* Add the names that the model gives to modes, at the design in its file. */
mt_status mt_scene_name_modes(const mt_model *m, mt_arena *mem, mt_scene_query *ask,
                              mt_err *err);

#endif
