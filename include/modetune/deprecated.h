/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODETUNE_DEPRECATED_H
#define MODETUNE_DEPRECATED_H

/* Deprecated names, for programs that still use them, removed in version 1.0. No header of
 * modetune includes this one. */
#include "modetune/status.h"
#include "modetune/study.h"

#define mt_wish             mt_stop_request
#define MT_WISH_NONE        MT_STOP_REQUEST_NONE
#define MT_WISH_FINISH      MT_STOP_REQUEST_FINISH
#define MT_WISH_END         MT_STOP_REQUEST_END
#define mt_wish_at          mt_stop_request_at
#define mt_cause            mt_stop_reason
#define MT_CAUSE_INTERRUPT  MT_STOP_REASON_INTERRUPT
#define MT_CAUSE_TIME_LIMIT MT_STOP_REASON_TIME_LIMIT

#endif
