/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_ARITHMETIC_H
#define LINALG_ARITHMETIC_H

enum { MT_ARITHMETIC_TEXT = 17 };

/* The bits of the C library's functions on this processor, as digits of a hash: where they
 * differ (fused multiply-add or not, another version), results may in their last digits. */
void mt_arithmetic_digest(char out[MT_ARITHMETIC_TEXT]);

#endif
