/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LINALG_ARITHMETIC_H
#define LINALG_ARITHMETIC_H

enum { MT_ARITHMETIC_TEXT = 17 };

/* Hash of the bits that the C library's functions give on this processor. Where two hashes
 * differ (fused multiply-add or not, another version), results may differ in their last
 * digits. */
void mt_arithmetic_digest(char out[MT_ARITHMETIC_TEXT]);

#endif
