/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_READ_H
#define RESULT_READ_H

#include "base/diagnostics.h"
#include "base/text.h"
#include "io/options.h"
#include "result/result.h"

/**
 * Read a whole result file: writing it again gives the same bytes. A result.json in its folder
 * is read only where the other files there match it; a run that is replacing them is waited
 * for. Owned by the caller (mt_result_delete). Fails: MT_E_INPUT, MT_E_SYSTEM, MT_E_MEMORY;
 * messages as for mt_model_load.
 */
mt_status mt_result_load(const char *path, const mt_io_options *opt, mt_result **out,
                         mt_diagnostics *messages, mt_err *err);

/* The text of the timing.json next to the result at `path`, where it names the result with this
 * digest; else empty. Fails: MT_E_SYSTEM, MT_E_MEMORY. */
mt_status mt_result_read_timing(const char *path, const char *sha256, mt_text *out,
                                mt_err *err);

#endif
