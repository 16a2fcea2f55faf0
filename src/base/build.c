/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/build.h"

/* made again by every build, and changed where the commit differs */
#include "base/build_info.h"

const char *mt_build_commit(void)
{
    return MT_BUILD_COMMIT;
}

const char *mt_build_compiler(void)
{
    return MT_BUILD_COMPILER;
}
