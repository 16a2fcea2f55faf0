/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bytes are those of files (CMakeLists.txt). */
#include "io/shipped.h"

#include <string.h>

#include "base/base.h"
#include "io/shipped_data.h"

static const mt_shipped files[] = {
#define SHIPPED(bytes, path) {path, bytes, sizeof(bytes) - 1},
    SHIPPED_LIST(SHIPPED)
#undef SHIPPED
};

const mt_shipped *mt_shipped_all(int *n)
{
    *n = MT_COUNT(files);
    return files;
}

const mt_shipped *mt_shipped_among(const mt_shipped *of, int n, const char *path)
{
    for (int i = 0; i < n; i++) {
        if (strcmp(of[i].path, path) == 0) {
            return &of[i];
        }
    }
    return NULL;
}

const mt_shipped *mt_shipped_find(const char *path)
{
    return mt_shipped_among(files, MT_COUNT(files), path);
}
