/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_BUILD_H
#define BASE_BUILD_H

/* Commit and compiler that the library was built from; static texts. */
/* "v1.0.0-3-g0123456789ab", without tags "0123456789ab"; "-dirty" where files differed;
 * "unknown" where the sources were not a repository of their own. */
const char *mt_build_commit(void);
/* "GNU 12.2.0" */
const char *mt_build_compiler(void);

#endif
