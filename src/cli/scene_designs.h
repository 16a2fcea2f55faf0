/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SCENE_DESIGNS_H
#define CLI_SCENE_DESIGNS_H

#include "result/result.h"
#include "scene/scene.h"

/* The designs of a result as what a scene is asked (mt_scene_new): the original one, with what
 * was set when the study was asked, then the recommended ones. asks[n] in mem, with texts of
 * the result. Fails: MT_E_INPUT (a parameter that the model has not, or has no value),
 * MT_E_USAGE (the model is no mechanism there), MT_E_MEMORY. */
mt_status mt_scene_designs(const mt_model *model, const mt_result *result, mt_arena *mem,
                           mt_scene_ask **asks, int *n, mt_err *err);
/* Names that the model gives to modes, of the design in its file. */
mt_status mt_scene_name_modes(const mt_model *m, mt_arena *mem, mt_scene_ask *ask, mt_err *err);

#endif
