/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "nlp/prepare.h"

#include <gsl/gsl_errno.h>

void mt_tune_prepare_process(void)
{
    (void)gsl_set_error_handler_off();
}
