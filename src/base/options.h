/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_OPTIONS_H
#define BASE_OPTIONS_H

#include "base/base.h"

/*
 * Copy a public options struct, which begins with its size (modetune/read.h), into the struct
 * that this library knows: out[size] bytes including the size; 0 where `given` is shorter or
 * NULL. Fails: MT_E_USAGE with the name of the function, where the size is missing or
 * implausible, or a member unknown to this library is not 0.
 */
mt_status mt_options_take(const char *function, const void *given, size_t size, void *out,
                          mt_err *err);
#define MT_OPTIONS_TAKE(given, out, err) \
    mt_options_take(__func__, (given), sizeof *(out), (out), (err))

#endif
