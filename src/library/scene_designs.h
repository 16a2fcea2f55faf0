/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LIBRARY_SCENE_DESIGNS_H
#define LIBRARY_SCENE_DESIGNS_H

#include "base/text.h"
#include "result/result.h"
#include "scene/scene.h"

/* The designs of a result as what a scene is asked (mt_scene_new): the original one, with what
 * was set when the study was asked, then the recommended ones. asks[n] in mem, with texts of
 * the result. configurations[n_configurations]: that are to be shown. Fails: MT_E_INPUT (a
 * parameter that the model has not, or has no value), MT_E_USAGE (the model is no mechanism in
 * one of these), MT_E_MEMORY. */
mt_status mt_scene_designs(const mt_model *model, const mt_result *result, int n_configurations,
                           const int *configurations, mt_arena *mem, mt_scene_query **asks,
                           int *n, mt_err *err);
/* All configurations of the model, configurations[n_configurations]: first those of which
 * the result has frequencies, in its order; returns how many these are. */
int mt_scene_order(const mt_model *model, const mt_result *result, int *configurations);
/**
 * What a result's report shows of its mechanism, as JSON: all designs, in the configurations of
 * which the result has frequencies; in all of them where it has none. Nothing is written where
 * the model does not fit the result, or there is nothing to show.
 * @param[in] model  the one that was solved; NULL: nobody has it
 * Fails: MT_E_MEMORY.
 */
mt_status mt_scene_of_result(const mt_model *model, const mt_result *result, int threads,
                             mt_text *json, mt_err *err);
/* Names that the model gives to modes, of the design in its file. */
mt_status mt_scene_name_modes(const mt_model *m, mt_arena *mem, mt_scene_query *ask,
                              mt_err *err);

#endif
