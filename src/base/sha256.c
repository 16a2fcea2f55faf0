/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * SHA-256, FIPS 180-4 (2015), sections 4.1.2, 5.1.1, 6.2. The round constants are the first 32
 * bits of the fractional parts of the cube roots of the first 64 primes, the initial hash those
 * of the square roots of the first 8 (4.2.2, 5.3.3).
 */
#include "base/sha256.h"

#include <string.h>

enum { BLOCK = 64, ROUNDS = 64, WORDS = MT_SHA256_WORDS };

static const uint32_t round_constant[ROUNDS] = {
    0x428a2f98U, 0x71374491U, 0xb5c0fbcfU, 0xe9b5dba5U, 0x3956c25bU, 0x59f111f1U, 0x923f82a4U,
    0xab1c5ed5U, 0xd807aa98U, 0x12835b01U, 0x243185beU, 0x550c7dc3U, 0x72be5d74U, 0x80deb1feU,
    0x9bdc06a7U, 0xc19bf174U, 0xe49b69c1U, 0xefbe4786U, 0x0fc19dc6U, 0x240ca1ccU, 0x2de92c6fU,
    0x4a7484aaU, 0x5cb0a9dcU, 0x76f988daU, 0x983e5152U, 0xa831c66dU, 0xb00327c8U, 0xbf597fc7U,
    0xc6e00bf3U, 0xd5a79147U, 0x06ca6351U, 0x14292967U, 0x27b70a85U, 0x2e1b2138U, 0x4d2c6dfcU,
    0x53380d13U, 0x650a7354U, 0x766a0abbU, 0x81c2c92eU, 0x92722c85U, 0xa2bfe8a1U, 0xa81a664bU,
    0xc24b8b70U, 0xc76c51a3U, 0xd192e819U, 0xd6990624U, 0xf40e3585U, 0x106aa070U, 0x19a4c116U,
    0x1e376c08U, 0x2748774cU, 0x34b0bcb5U, 0x391c0cb3U, 0x4ed8aa4aU, 0x5b9cca4fU, 0x682e6ff3U,
    0x748f82eeU, 0x78a5636fU, 0x84c87814U, 0x8cc70208U, 0x90befffaU, 0xa4506cebU, 0xbef9a3f7U,
    0xc67178f2U,
};

static const uint32_t initial_hash[WORDS] = {
    0x6a09e667U, 0xbb67ae85U, 0x3c6ef372U, 0xa54ff53aU,
    0x510e527fU, 0x9b05688cU, 0x1f83d9abU, 0x5be0cd19U,
};

static uint32_t rotate_right(uint32_t x, int n)
{
    return (x >> n) | (x << (32 - n));
}

/* The sum of x rotated by a, by a + b, and by a + b + c. */
static uint32_t rotate3(uint32_t x, int a, int b, int c)
{
    return rotate_right(rotate_right(rotate_right(x, c) ^ x, b) ^ x, a);
}

/* A round. Instead of moving all eight words to the next letter, letters move: at round t
 * letter i is word (i - t) mod 8. added: the round's constant and word of the message. */
static inline void turn(uint32_t s[WORDS], int t, uint32_t added)
{
    const uint32_t a = s[(8 - t) & 7];
    const uint32_t b = s[(9 - t) & 7];
    const uint32_t c = s[(10 - t) & 7];
    const uint32_t e = s[(12 - t) & 7];
    const uint32_t f = s[(13 - t) & 7];
    const uint32_t g = s[(14 - t) & 7];
    uint32_t *const h = &s[(15 - t) & 7];
    const uint32_t t1 = *h + rotate3(e, 6, 5, 14) + (g ^ (e & (f ^ g))) + added;
    s[(11 - t) & 7] += t1;
    *h = t1 + rotate3(a, 2, 11, 9) + ((a & b) | (c & (a | b)));
}

static void compress(uint32_t hash[WORDS], const unsigned char *block)
{
    uint32_t w[ROUNDS];
    uint32_t s[WORDS];
    for (size_t t = 0; t < 16; t++) {
        const unsigned char *const p = block + 4 * t;
        w[t] =
            (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | (uint32_t)p[3];
    }
    for (int t = 16; t < ROUNDS; t++) {
        const uint32_t x = w[t - 15];
        const uint32_t y = w[t - 2];
        w[t] = w[t - 16] + (rotate_right(x, 7) ^ rotate_right(x, 18) ^ (x >> 3)) + w[t - 7] +
               (rotate_right(y, 17) ^ rotate_right(y, 19) ^ (y >> 10));
    }
    memcpy(s, hash, sizeof s);
    for (int t = 0; t < ROUNDS; t += 8) {
        const uint32_t *const k = round_constant + t;
        turn(s, 0, k[0] + w[t]);
        turn(s, 1, k[1] + w[t + 1]);
        turn(s, 2, k[2] + w[t + 2]);
        turn(s, 3, k[3] + w[t + 3]);
        turn(s, 4, k[4] + w[t + 4]);
        turn(s, 5, k[5] + w[t + 5]);
        turn(s, 6, k[6] + w[t + 6]);
        turn(s, 7, k[7] + w[t + 7]);
    }
    for (int i = 0; i < WORDS; i++) {
        hash[i] += s[i];
    }
}

static size_t whole_blocks(size_t length)
{
    return length / BLOCK * BLOCK;
}

mt_sha256_start mt_sha256_begin(const void *bytes, size_t length)
{
    const unsigned char *const p = bytes;
    mt_sha256_start s = {.length = whole_blocks(length)};
    memcpy(s.words, initial_hash, sizeof s.words);
    for (size_t i = 0; i < s.length; i += BLOCK) {
        compress(s.words, p + i);
    }
    return s;
}

void mt_sha256(const void *bytes, size_t length, char out[MT_SHA256_TEXT])
{
    const mt_sha256_start none = mt_sha256_begin(bytes, 0);
    mt_sha256_end(&none, bytes, length, out);
}

void mt_sha256_end(const mt_sha256_start *start, const void *bytes, size_t length,
                   char out[MT_SHA256_TEXT])
{
    static const char hex[] = "0123456789abcdef";
    const unsigned char *const p = bytes;
    const size_t whole = whole_blocks(length);
    uint32_t hash[WORDS];
    memcpy(hash, start->words, sizeof hash);
    for (size_t i = start->length; i < whole; i += BLOCK) {
        compress(hash, p + i);
    }
    /* padding: a bit 1, zeros, the length in bits as 64 bits big-endian */
    unsigned char last[2 * BLOCK] = {0};
    const size_t rest = length - whole;
    if (rest > 0) {
        memcpy(last, p + whole, rest);
    }
    last[rest] = 0x80;
    const size_t padded = rest + 9 <= BLOCK ? BLOCK : 2 * BLOCK;
    const uint64_t bits = (uint64_t)length * 8;
    for (size_t i = 0; i < 8; i++) {
        last[padded - 1 - i] = (unsigned char)(bits >> (8 * i));
    }
    for (size_t i = 0; i < padded; i += BLOCK) {
        compress(hash, last + i);
    }
    for (size_t i = 0; i < 64; i++) {
        out[i] = hex[(hash[i / 8] >> (28 - 4 * (i % 8))) & 0xFU];
    }
    out[64] = '\0';
}
