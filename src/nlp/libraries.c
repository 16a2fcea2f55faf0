/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "nlp/libraries.h"

#include <gsl/gsl_version.h>

const char *mt_gsl_version(void)
{
    return gsl_version;
}
