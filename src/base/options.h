/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_OPTIONS_H
#define BASE_OPTIONS_H

#include "base/base.h"

/*
 * A public struct of options, which begins with its size (modetune/read.h), as the one that
 * this library knows: out[size] bytes, its size included; 0 where `given` is shorter or NULL.
 * Fails: MT_E_USAGE, named by function, where the size is missing or beyond reason, or a member
 * that is not known here is not 0.
 */
mt_status mt_options_take(const char *function, const void *given, size_t size, void *out,
                          mt_err *err);
#define MT_OPTIONS_TAKE(given, out, err) \
    mt_options_take(__func__, (given), sizeof *(out), (out), (err))

#endif
