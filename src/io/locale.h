/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_LOCALE_H
#define IO_LOCALE_H

#include "base/base.h"

/* f(context, err) with this thread in the locale "C", whose decimal point the C library's
 * numbers then have; it keeps its own. Fails: as f, MT_E_MEMORY. */
mt_status mt_locale_plain(mt_status (*f)(void *context, mt_err *err), void *context,
                          mt_err *err);

#endif
