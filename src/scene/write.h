/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCENE_WRITE_H
#define SCENE_WRITE_H

#include "base/text.h"
#include "scene/scene.h"

/* Append a scene as JSON (format "modetune-scene/1"), for pages and other drawings: positions
 * with six digits, frequencies with nine. The same scene gives the same bytes. Fails:
 * MT_E_MEMORY. */
mt_status mt_scene_write(const mt_scene *scene, mt_text *out, mt_err *err);
/* The same without white space, as a page embeds it. */
mt_status mt_scene_write_page(const mt_scene *scene, mt_text *out, mt_err *err);

#endif
