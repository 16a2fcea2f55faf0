/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <float.h>
#include <math.h>

#include "expr/interval.h"
#include "expr/op.h"

static mt_interval point(double x)
{
    return mt_interval_of(x, x);
}

static mt_interval inverse(mt_interval a)
{
    return mt_interval_div(point(1.0), a);
}

static mt_interval unary_op(mt_op op, mt_interval a)
{
    return mt_interval_op(op, a, a);
}

/* 1 / sqrt((1 - a) (1 + a)) */
static mt_interval asin_slope(mt_interval a)
{
    const mt_interval one = point(1.0);
    const mt_interval product =
        mt_interval_mul(mt_interval_sub(one, a), mt_interval_add(one, a));
    return inverse(unary_op(MT_OP_SQRT, product));
}

static mt_interval tanh_slope(mt_interval a)
{
    const mt_interval c = unary_op(MT_OP_COSH, a);
    return mt_interval_div(inverse(c), c);
}

/* abs'(0) = 1 by convention, so only an interval wholly below 0 has slope -1. */
static mt_interval abs_slope(mt_interval a)
{
    return mt_interval_of(a.lo >= 0.0 ? 1.0 : -1.0, a.hi < 0.0 ? -1.0 : 1.0);
}

static mt_interval_partials pow_partials(mt_interval a, mt_interval b, mt_interval v)
{
    mt_interval_partials d = {point(0.0), mt_interval_all()};
    if (b.lo != 0.0 || b.hi != 0.0) {
        const mt_interval less = mt_interval_sub(b, point(1.0));
        d.a = mt_interval_mul(b, mt_interval_op(MT_OP_POW, a, less));
    }
    if (a.lo > 0.0) {
        d.b = mt_interval_mul(v, unary_op(MT_OP_LN, a));
    }
    return d;
}

static mt_interval_partials atan2_partials(mt_interval a, mt_interval b)
{
    const mt_interval h = mt_interval_op(MT_OP_HYPOT, a, b);
    return (mt_interval_partials){
        mt_interval_div(mt_interval_div(b, h), h),
        mt_interval_neg(mt_interval_div(mt_interval_div(a, h), h)),
    };
}

/* a / v with v = hypot(a, b), which is never beyond 1 but for the rounding of hypot. */
static mt_interval cosine(mt_interval a, mt_interval v)
{
    static const double ONE = 1.0 + MT_INTERVAL_ULPS * DBL_EPSILON;
    const mt_interval q = mt_interval_div(a, v);
    return mt_interval_of(fmax(q.lo, -ONE), fmin(q.hi, ONE));
}

static mt_interval_partials slope(mt_interval a)
{
    return (mt_interval_partials){a, point(0.0)};
}

mt_interval_partials mt_interval_op_partials(mt_op op, mt_interval a, mt_interval b,
                                             mt_interval v)
{
    const mt_interval one = point(1.0);
    switch (op) {
    case MT_OP_NEG:
        return slope(point(-1.0));
    case MT_OP_SQRT:
        return slope(mt_interval_div(point(0.5), v));
    case MT_OP_CBRT:
        return slope(inverse(mt_interval_mul(point(3.0), mt_interval_square(v))));
    case MT_OP_EXP:
        return slope(v);
    case MT_OP_LN:
        return slope(a.lo <= 0.0 ? mt_interval_all() : inverse(a));
    case MT_OP_LOG10:
        return slope(a.lo <= 0.0 ? mt_interval_all()
                                 : inverse(mt_interval_mul(a, point(MT_LN_10))));
    case MT_OP_SIN:
        return slope(unary_op(MT_OP_COS, a));
    case MT_OP_COS:
        return slope(mt_interval_neg(unary_op(MT_OP_SIN, a)));
    case MT_OP_TAN:
        return slope(mt_interval_add(one, mt_interval_square(v)));
    case MT_OP_ASIN:
        return slope(asin_slope(a));
    case MT_OP_ACOS:
        return slope(mt_interval_neg(asin_slope(a)));
    case MT_OP_ATAN:
        return slope(inverse(mt_interval_add(one, mt_interval_square(a))));
    case MT_OP_SINH:
        return slope(unary_op(MT_OP_COSH, a));
    case MT_OP_COSH:
        return slope(unary_op(MT_OP_SINH, a));
    case MT_OP_TANH:
        return slope(tanh_slope(a));
    case MT_OP_ABS:
        return slope(abs_slope(a));
    case MT_OP_ADD:
        return (mt_interval_partials){one, one};
    case MT_OP_SUB:
        return (mt_interval_partials){one, point(-1.0)};
    case MT_OP_MUL:
        return (mt_interval_partials){b, a};
    case MT_OP_DIV:
        return (mt_interval_partials){inverse(b), mt_interval_neg(mt_interval_div(v, b))};
    case MT_OP_POW:
        return pow_partials(a, b, v);
    case MT_OP_ATAN2:
        return atan2_partials(a, b);
    case MT_OP_HYPOT:
        return (mt_interval_partials){cosine(a, v), cosine(b, v)};
    case MT_OP_MIN:
    case MT_OP_MAX:
    case MT_OP_CONST:
    case MT_OP_PARAM:
    case MT_OP_COUNT:
        break;
    }
    return (mt_interval_partials){mt_interval_all(), mt_interval_all()};
}
