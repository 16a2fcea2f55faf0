/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The version, the only place for C code; the build fails where it differs from its own. */
#ifndef MODETUNE_VERSION_H
#define MODETUNE_VERSION_H

#include "modetune/export.h"

#define MT_VERSION_MAJOR  1
#define MT_VERSION_MINOR  1
#define MT_VERSION_PATCH  0
#define MT_VERSION_STRING "1.1.0"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Version of the library that is linked, for comparison with MT_VERSION_STRING of the header.
 * @return "major.minor.patch", static storage. Cannot fail.
 */
MT_API const char *mt_version(void);

#ifdef __cplusplus
}
#endif

#endif
