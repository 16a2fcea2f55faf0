/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modetune/version.h"

const char *mt_version(void)
{
    return MT_VERSION_STRING;
}
