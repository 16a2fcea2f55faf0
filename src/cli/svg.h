/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_SVG_H
#define CLI_SVG_H

#include "base/text.h"
#include "scene/scene.h"

/* A drawing of one configuration as SVG: in space an isometric view with up opposite to
 * gravity; mode (NULL: none): its shape in a second colour over the position at rest. */
void mt_svg(const mt_scene *scene, const mt_scene_view *view, const mt_scene_mode *mode,
            mt_text *out);

#endif
