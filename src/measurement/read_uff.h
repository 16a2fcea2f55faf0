/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MEASUREMENT_READ_UFF_H
#define MEASUREMENT_READ_UFF_H

#include "measurement/measurement.h"

/* Read a universal file, to its end. Fails: MT_E_INPUT, MT_E_MEMORY. */
mt_status mt_read_measurement_uff(mt_measuring *m);

#endif
