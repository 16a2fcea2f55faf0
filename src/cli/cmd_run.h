/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_CMD_RUN_H
#define CLI_CMD_RUN_H

#include "result/record.h"

/* The members of index.json. */
extern const mt_record mt_index_record;

#endif
