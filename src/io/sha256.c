/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * SHA-256, FIPS 180-4 (2015), sections 4.1.2, 5.1.1, 6.2. The round constants are the first 32
 * bits of the fractional parts of the cube roots of the first 64 primes, the initial hash those
 * of the square roots of the first 8 (4.2.2, 5.3.3); they are computed here, exactly, by
 * integer roots, instead of being typed in.
 */
#include "io/sha256.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { BLOCK = 64, ROUNDS = 64, WORDS = 8 };

typedef struct sha {
    uint32_t k[ROUNDS];
    uint32_t h[WORDS];
} sha;

/* Is x^power <= p * 2^(32 power)? x = 2^32 times a root below 8: compared in 32-bit limbs. */
static bool root_at_most(uint64_t x, int power, uint32_t p)
{
    enum { LIMBS = 6, LIMB_BITS = 32 };
    uint32_t product[LIMBS] = {1};
    for (int step = 0; step < power; step++) {
        uint32_t next[LIMBS + 2] = {0};
        const uint32_t factor[2] = {(uint32_t)x, (uint32_t)(x >> LIMB_BITS)};
        for (int f = 0; f < 2; f++) {
            uint64_t carry = 0;
            for (int i = 0; i + f < LIMBS; i++) {
                carry += (uint64_t)product[i] * factor[f] + next[i + f];
                next[i + f] = (uint32_t)carry;
                carry >>= LIMB_BITS;
            }
        }
        memcpy(product, next, sizeof product);
    }
    /* p * 2^(32 power) has p in limb `power` and nothing else */
    for (int i = LIMBS - 1; i > power; i--) {
        if (product[i] != 0) {
            return false;
        }
    }
    return product[power] < p; /* never equal: the root of a prime is irrational */
}

/* First 32 bits of the fractional part of the root of p. */
static uint32_t root_fraction(int power, uint32_t p)
{
    uint64_t x = 0;
    for (uint64_t bit = (uint64_t)1 << 36; bit != 0; bit >>= 1) {
        if (root_at_most(x | bit, power, p)) {
            x |= bit;
        }
    }
    return (uint32_t)x;
}

static bool is_prime(uint32_t p)
{
    for (uint32_t d = 2; d * d <= p; d++) {
        if (p % d == 0) {
            return false;
        }
    }
    return true;
}

static void start(sha *s)
{
    uint32_t p = 2;
    for (int i = 0; i < ROUNDS; p++) {
        if (is_prime(p)) {
            s->k[i] = root_fraction(3, p);
            if (i < WORDS) {
                s->h[i] = root_fraction(2, p);
            }
            i++;
        }
    }
}

static uint32_t rotate(uint32_t x, int n)
{
    return (x >> n) | (x << (32 - n));
}

static void compress(sha *s, const unsigned char *block)
{
    uint32_t w[ROUNDS];
    for (size_t t = 0; t < 16; t++) {
        const unsigned char *const b = block + 4 * t;
        w[t] =
            (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | (uint32_t)b[3];
    }
    for (int t = 16; t < ROUNDS; t++) {
        const uint32_t x = w[t - 15];
        const uint32_t y = w[t - 2];
        w[t] = w[t - 16] + (rotate(x, 7) ^ rotate(x, 18) ^ (x >> 3)) + w[t - 7] +
               (rotate(y, 17) ^ rotate(y, 19) ^ (y >> 10));
    }
    uint32_t v[WORDS]; /* a b c d e f g h */
    memcpy(v, s->h, sizeof v);
    for (int t = 0; t < ROUNDS; t++) {
        const uint32_t e = v[4];
        const uint32_t a = v[0];
        const uint32_t t1 = v[7] + (rotate(e, 6) ^ rotate(e, 11) ^ rotate(e, 25)) +
                            ((e & v[5]) ^ (~e & v[6])) + s->k[t] + w[t];
        const uint32_t t2 = (rotate(a, 2) ^ rotate(a, 13) ^ rotate(a, 22)) +
                            ((a & v[1]) ^ (a & v[2]) ^ (v[1] & v[2]));
        memmove(v + 1, v, 7 * sizeof v[0]);
        v[4] += t1;
        v[0] = t1 + t2;
    }
    for (int i = 0; i < WORDS; i++) {
        s->h[i] += v[i];
    }
}

void mt_sha256(const void *bytes, size_t length, char out[MT_SHA256_TEXT])
{
    static const char hex[] = "0123456789abcdef";
    const unsigned char *const p = bytes;
    const size_t whole = length / BLOCK * BLOCK;
    sha s;
    start(&s);
    for (size_t i = 0; i < whole; i += BLOCK) {
        compress(&s, p + i);
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
        compress(&s, last + i);
    }
    for (size_t i = 0; i < 64; i++) {
        out[i] = hex[(s.h[i / 8] >> (28 - 4 * (i % 8))) & 0xFU];
    }
    out[64] = '\0';
}
