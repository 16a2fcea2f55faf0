/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_LOCALE_H
#define IO_LOCALE_H

#include "base/base.h"

/* Call f(context, err) with this thread in the locale "C", so that numbers of the C library
 * have its decimal point; then restore the thread's locale. Fails: as f, MT_E_MEMORY. */
mt_status mt_locale_plain(mt_status (*f)(void *context, mt_err *err), void *context,
                          mt_err *err);

#endif
