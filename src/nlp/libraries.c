/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "nlp/libraries.h"

#include <nlopt.h>

#include <gsl/gsl_version.h>

#include "base/format.h"

const char *mt_gsl_version(void)
{
    return gsl_version;
}

void mt_nlopt_version(char text[16])
{
    int v[3];
    nlopt_version(&v[0], &v[1], &v[2]);
    (void)mt_snprintf(text, 16, "%d.%d.%d", v[0], v[1], v[2]);
}
