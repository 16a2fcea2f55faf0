/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_MANUAL_H
#define CLI_MANUAL_H

#include "base/text.h"

/* The manual page, section 1, in the language of man(7). */
void mt_manual(mt_text *out);

#endif
