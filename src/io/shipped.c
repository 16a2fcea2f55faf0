/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bytes are written by the build (CMakeLists.txt). */
#include "io/shipped.h"

#include <string.h>

#include "base/base.h"
#include "io/shipped_data.h"

static const mt_shipped files[] = {
#define SHIPPED(number, path) {path, (const char *)file_##number, sizeof file_##number - 1},
    SHIPPED_LIST(SHIPPED)
#undef SHIPPED
};

const mt_shipped *mt_shipped_all(int *n)
{
    *n = MT_COUNT(files);
    return files;
}

const mt_shipped *mt_shipped_find(const char *path)
{
    for (int i = 0; i < MT_COUNT(files); i++) {
        if (strcmp(files[i].path, path) == 0) {
            return &files[i];
        }
    }
    return NULL;
}
