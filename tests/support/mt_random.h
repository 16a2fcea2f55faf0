/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Small deterministic generator for tests (xorshift64*): the same numbers everywhere. */
#ifndef MT_RANDOM_H
#define MT_RANDOM_H

#include <stdint.h>

typedef struct mt_random {
    uint64_t state;
} mt_random;

static inline mt_random mt_random_seed(uint64_t seed)
{
    return (mt_random){seed * 2654435761U + 88172645463325252U};
}

static inline uint64_t mt_random_bits(mt_random *r)
{
    r->state ^= r->state >> 12;
    r->state ^= r->state << 25;
    r->state ^= r->state >> 27;
    return r->state * 2685821657736338717U;
}

/* Uniform in [low, high). */
static inline double mt_random_in(mt_random *r, double low, double high)
{
    const double unit = (double)(mt_random_bits(r) >> 11) / 9007199254740992.0;
    return low + (high - low) * unit;
}

/* Integer in [0, n). */
static inline int mt_random_int(mt_random *r, int n)
{
    return (int)(mt_random_bits(r) % (uint64_t)n);
}

/* Uniform in a box, or, once in `corners` times, at a corner of it. */
static inline void mt_random_in_box(mt_random *r, int corners, int n, const double *lower,
                                    const double *upper, double *x)
{
    const int corner = mt_random_int(r, corners) == 0;
    for (int i = 0; i < n; i++) {
        x[i] = !corner                    ? mt_random_in(r, lower[i], upper[i])
               : mt_random_int(r, 2) == 0 ? lower[i]
                                          : upper[i];
    }
}

static inline void mt_random_fill(mt_random *r, int n, double *x)
{
    for (int i = 0; i < n; i++) {
        x[i] = mt_random_in(r, -1.0, 1.0);
    }
}

#endif
