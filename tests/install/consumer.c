/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A stranger's program: includes what is installed, links it, and sees one version. */
#include <modetune/version.h>
#include <stdio.h>
#include <string.h>

int main(void)
{
    if (strcmp(mt_version(), MT_VERSION_STRING) != 0) {
        fprintf(stderr, "library %s, header %s\n", mt_version(), MT_VERSION_STRING);
        return 1;
    }
    return puts(mt_version()) < 0;
}
