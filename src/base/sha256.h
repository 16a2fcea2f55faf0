/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_SHA256_H
#define BASE_SHA256_H

#include <stddef.h>
#include <stdint.h>

enum {
    MT_SHA256_TEXT = 65, /* 64 hexadecimal digits and the terminator */
    MT_SHA256_WORDS = 8
};

/* SHA-256 (FIPS 180-4) of the bytes, in lower-case hexadecimal digits. */
void mt_sha256(const void *bytes, size_t length, char out[MT_SHA256_TEXT]);

/* SHA-256 in two steps, for texts with a common beginning: the state after the whole blocks of
 * the beginning, and the digest of `length` bytes that begin with it. */
typedef struct mt_sha256_start {
    size_t length; /* bytes of the whole blocks */
    uint32_t words[MT_SHA256_WORDS];
} mt_sha256_start;
mt_sha256_start mt_sha256_begin(const void *bytes, size_t length);
void mt_sha256_end(const mt_sha256_start *start, const void *bytes, size_t length,
                   char out[MT_SHA256_TEXT]);

#endif
