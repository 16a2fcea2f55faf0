/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Operations of expressions and their derivatives in 113 bits, for arguments of moderate size:
 * to 1e-28 of themselves or of 1. Series and Newton's method only, no library of functions.
 */
#ifndef EXPR_EXACT_H
#define EXPR_EXACT_H

#include <math.h>

#include "expr/op.h"
#include "stress/quad.h"

/* pi and ln 2 as sums of three doubles. */
static inline quad exact_pi(void)
{
    return (quad)3.141592653589793116 + (quad)1.2246467991473532072e-16 +
           (quad)-2.9947698097183396659e-33;
}

/* e^x by the series of x / 2^8, squared eight times. */
static inline quad exact_exp(quad x)
{
    const quad u = x / 256;
    quad term = 1;
    quad sum = 0; /* e^u - 1, which squaring keeps to its own size */
    for (int k = 1; k < 24; k++) {
        term *= u / k;
        sum += term;
    }
    for (int k = 0; k < 8; k++) {
        sum = (2 * sum) + (sum * sum);
    }
    return 1 + sum;
}

/* sin x (phase 0) and cos x (phase 1) by the series about the nearest multiple of 2 pi. */
static inline quad exact_wave(quad x, int phase)
{
    const quad turn = 2 * exact_pi();
    const quad u = x - (turn * (quad)rint((double)(x / turn)));
    quad term = phase == 0 ? u : 1;
    quad sum = term;
    for (int k = phase == 0 ? 2 : 1; k < 60; k += 2) {
        term *= -u * u / ((quad)k * (k + 1));
        sum += term;
    }
    return sum;
}

static inline quad exact_sin(quad x)
{
    return exact_wave(x, 0);
}

static inline quad exact_cos(quad x)
{
    return exact_wave(x, 1);
}

/* Newton's method on e^y = x, from the double. */
static inline quad exact_log(quad x)
{
    quad y = (quad)log((double)x);
    for (int k = 0; k < 3; k++) {
        y += (x * exact_exp(-y)) - 1;
    }
    return y;
}

static inline quad exact_cbrt(quad x)
{
    quad y = (quad)cbrt((double)x);
    for (int k = 0; k < 3 && y != 0; k++) {
        y -= (y - (x / (y * y))) / 3;
    }
    return y;
}

/* 0 where there is none, which tests leave out. */
static inline quad exact_ratio(quad a, quad b)
{
    return b == 0 ? 0 : a / b;
}

/* On tan y = x, by y -= (sin y - x cos y) cos y. */
static inline quad exact_atan(quad x)
{
    quad y = (quad)atan((double)x);
    for (int k = 0; k < 3; k++) {
        const quad c = exact_cos(y);
        y -= (exact_sin(y) - (x * c)) * c;
    }
    return y;
}

static inline quad exact_atan2(quad y, quad x)
{
    if (quad_abs(y) > quad_abs(x)) {
        return ((y > 0 ? exact_pi() : -exact_pi()) / 2) - exact_atan(exact_ratio(x, y));
    }
    return exact_atan(exact_ratio(y, x)) + (x > 0 ? 0 : (y >= 0 ? exact_pi() : -exact_pi()));
}

static inline quad exact_asin(quad x)
{
    return exact_atan2(x, quad_root((1 - x) * (1 + x)));
}

/* Integers exactly, other powers of positive numbers by the logarithm. */
static inline quad exact_pow(quad x, quad y)
{
    const int n = (int)y;
    quad product = 1;
    if (y != n) {
        return exact_exp(y * exact_log(x));
    }
    for (int k = 0; k < (n < 0 ? -n : n); k++) {
        product *= x;
    }
    return n < 0 ? exact_ratio(1, product) : product;
}

static inline quad exact_op(mt_op op, quad x, quad y)
{
    const quad e = exact_exp(op >= MT_OP_SINH && op <= MT_OP_TANH ? x : 0);
    switch (op) {
    case MT_OP_NEG:
        return -x;
    case MT_OP_SQRT:
        return quad_root(x);
    case MT_OP_CBRT:
        return exact_cbrt(x);
    case MT_OP_EXP:
        return exact_exp(x);
    case MT_OP_LN:
        return exact_log(x);
    case MT_OP_LOG10:
        return exact_log(x) / exact_log(10);
    case MT_OP_SIN:
        return exact_sin(x);
    case MT_OP_COS:
        return exact_cos(x);
    case MT_OP_TAN:
        return exact_ratio(exact_sin(x), exact_cos(x));
    case MT_OP_ASIN:
        return exact_asin(x);
    case MT_OP_ACOS:
        return (exact_pi() / 2) - exact_asin(x);
    case MT_OP_ATAN:
        return exact_atan(x);
    case MT_OP_SINH:
        return (e - (1 / e)) / 2;
    case MT_OP_COSH:
        return (e + (1 / e)) / 2;
    case MT_OP_TANH:
        return (e - (1 / e)) / (e + (1 / e));
    case MT_OP_ABS:
        return quad_abs(x);
    case MT_OP_ADD:
        return x + y;
    case MT_OP_SUB:
        return x - y;
    case MT_OP_MUL:
        return x * y;
    case MT_OP_DIV:
        return exact_ratio(x, y);
    case MT_OP_POW:
        return exact_pow(x, y);
    case MT_OP_ATAN2:
        return exact_atan2(x, y);
    case MT_OP_MIN:
        return x < y ? x : y;
    case MT_OP_MAX:
        return x > y ? x : y;
    case MT_OP_HYPOT:
        return quad_root((x * x) + (y * y));
    case MT_OP_NOT:
    case MT_OP_IF:
    case MT_OP_LESS:
    case MT_OP_AT_MOST:
    case MT_OP_GREATER:
    case MT_OP_AT_LEAST:
    case MT_OP_EQUAL:
    case MT_OP_AND:
    case MT_OP_OR:
    case MT_OP_THEN:
    case MT_OP_ELSE:
    case MT_OP_INTERP:
    case MT_OP_CONST:
    case MT_OP_PARAM:
    case MT_OP_COUNT:
        break;
    }
    return 0;
}

/* d/dx and d/dy of it by a difference over 2^-36 of the arguments' size, whose error of third
 * order is 2^-72 and whose rounding 2^-113 + 36: known to 1e-20 where f is smooth. */
static inline quad exact_partial(mt_op op, quad x, quad y, bool second)
{
    const quad h =
        (second ? y : x) == 0 ? (quad)0x1p-36 : quad_abs(second ? y : x) * (quad)0x1p-36;
    return second ? (exact_op(op, x, y + h) - exact_op(op, x, y - h)) / (2 * h)
                  : (exact_op(op, x + h, y) - exact_op(op, x - h, y)) / (2 * h);
}

#endif
