/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_SHA256_H
#define BASE_SHA256_H

#include <stddef.h>

enum { MT_SHA256_TEXT = 65 }; /* 64 hexadecimal digits and the terminator */

/* SHA-256 (FIPS 180-4) of the bytes, in lower-case hexadecimal digits. */
void mt_sha256(const void *bytes, size_t length, char out[MT_SHA256_TEXT]);

#endif
