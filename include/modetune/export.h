/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Visibility of symbols: everything is built hidden, public functions carry MT_API. */
#ifndef MODETUNE_EXPORT_H
#define MODETUNE_EXPORT_H

#if defined(__GNUC__)
#    define MT_API __attribute__((visibility("default")))
#else
#    define MT_API
#endif

#endif
