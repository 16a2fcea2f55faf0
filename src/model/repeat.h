/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_REPEAT_H
#define MODEL_REPEAT_H

#include "model/copy.h"

/* Write out the repeat of this index; the last one takes the list away. Fails as
 * mt_maker_end. */
mt_status mt_expand_repeat(mt_json *doc, const char *path, mt_expansion *all, int index,
                           bool last, mt_err *err);

#endif
