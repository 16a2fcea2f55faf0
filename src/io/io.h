/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_IO_H
#define IO_IO_H

/* The interface of this folder for the others. */
#include "io/json.h"
#include "io/options.h"
#include "io/read_aircraft.h"
#include "io/read_model.h"
#include "io/read_profile.h"
#include "io/read_result.h"
#include "io/read_study.h"
#include "io/result_folder.h"
#include "io/write_json.h"
#include "io/write_result.h"

#endif
