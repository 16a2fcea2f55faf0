/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "expr/op.h"

#include <math.h>

const char *mt_op_name(mt_op op)
{
    static const char *const names[MT_OP_COUNT] = {
        [MT_OP_CONST] = "number",  [MT_OP_PARAM] = "parameter", [MT_OP_NEG] = "-",
        [MT_OP_SQRT] = "sqrt",     [MT_OP_CBRT] = "cbrt",       [MT_OP_EXP] = "exp",
        [MT_OP_LN] = "ln",         [MT_OP_LOG10] = "log10",     [MT_OP_SIN] = "sin",
        [MT_OP_COS] = "cos",       [MT_OP_TAN] = "tan",         [MT_OP_ASIN] = "asin",
        [MT_OP_ACOS] = "acos",     [MT_OP_ATAN] = "atan",       [MT_OP_SINH] = "sinh",
        [MT_OP_COSH] = "cosh",     [MT_OP_TANH] = "tanh",       [MT_OP_ABS] = "abs",
        [MT_OP_INTERP] = "interp", [MT_OP_ADD] = "+",           [MT_OP_SUB] = "-",
        [MT_OP_MUL] = "*",         [MT_OP_DIV] = "/",           [MT_OP_POW] = "^",
        [MT_OP_ATAN2] = "atan2",   [MT_OP_MIN] = "min",         [MT_OP_MAX] = "max",
        [MT_OP_HYPOT] = "hypot",   [MT_OP_NOT] = "not",         [MT_OP_IF] = "if",
        [MT_OP_LESS] = "<",        [MT_OP_AT_MOST] = "<=",      [MT_OP_GREATER] = ">",
        [MT_OP_AT_LEAST] = ">=",   [MT_OP_EQUAL] = "==",        [MT_OP_AND] = "and",
        [MT_OP_OR] = "or",         [MT_OP_THEN] = "then",       [MT_OP_ELSE] = "else",
    };
    return op < MT_OP_COUNT ? names[op] : "unknown";
}

int mt_op_operands(mt_op op)
{
    if (op < MT_OP_NEG) {
        return 0;
    }
    return op < MT_OP_ADD ? 1 : 2;
}

/* a / b; NaN instead of a division by zero, which sanitizers and trapping builds object to. */
static double quotient(double a, double b)
{
    return b == 0.0 ? nan("") : a / b;
}

static double pow_value(double a, double b)
{
    return a == 0.0 && b < 0.0 ? nan("") : pow(a, b);
}

/* 1 or 0; NaN where an operand is. */
static double truth(bool holds, double a, double b)
{
    return isnan(a) || isnan(b) ? nan("") : holds ? 1.0 : 0.0;
}

static double condition_value(mt_op op, double a, double b)
{
    switch ((int)op) {
    case MT_OP_LESS:
        return truth(a < b, a, b);
    case MT_OP_AT_MOST:
        return truth(a <= b, a, b);
    case MT_OP_GREATER:
        return truth(a > b, a, b);
    case MT_OP_AT_LEAST:
        return truth(a >= b, a, b);
    case MT_OP_EQUAL:
        return truth(a == b, a, b);
    case MT_OP_AND:
        return truth(a != 0.0 && b != 0.0, a, b);
    case MT_OP_OR:
        return truth(a != 0.0 || b != 0.0, a, b);
    case MT_OP_NOT:
        return truth(a == 0.0, a, 0.0);
    default:
        return nan("");
    }
}

double mt_op_value(mt_op op, double a, double b)
{
    switch (op) {
    case MT_OP_NEG:
        return -a;
    case MT_OP_SQRT:
        return sqrt(a);
    case MT_OP_CBRT:
        return cbrt(a);
    case MT_OP_EXP:
        return exp(a);
    case MT_OP_LN:
        return a > 0.0 ? log(a) : nan(""); /* at its pole, too */
    case MT_OP_LOG10:
        return a > 0.0 ? log10(a) : nan("");
    case MT_OP_SIN:
        return sin(a);
    case MT_OP_COS:
        return cos(a);
    case MT_OP_TAN:
        return tan(a);
    case MT_OP_ASIN:
        return asin(a);
    case MT_OP_ACOS:
        return acos(a);
    case MT_OP_ATAN:
        return atan(a);
    case MT_OP_SINH:
        return sinh(a);
    case MT_OP_COSH:
        return cosh(a);
    case MT_OP_TANH:
        return tanh(a);
    case MT_OP_ABS:
        return fabs(a);
    case MT_OP_ADD:
        return a + b;
    case MT_OP_SUB:
        return a - b;
    case MT_OP_MUL:
        return a * b;
    case MT_OP_DIV:
        return quotient(a, b);
    case MT_OP_POW:
        return pow_value(a, b);
    case MT_OP_ATAN2:
        return atan2(a, b);
    case MT_OP_MIN:
        return b < a ? b : a;
    case MT_OP_MAX:
        return b > a ? b : a;
    case MT_OP_HYPOT:
        return hypot(a, b);
    case MT_OP_LESS:
    case MT_OP_AT_MOST:
    case MT_OP_GREATER:
    case MT_OP_AT_LEAST:
    case MT_OP_EQUAL:
    case MT_OP_AND:
    case MT_OP_OR:
    case MT_OP_NOT:
        return condition_value(op, a, b);
    case MT_OP_IF:
    case MT_OP_THEN:
    case MT_OP_ELSE:
    case MT_OP_INTERP:
    case MT_OP_CONST:
    case MT_OP_PARAM:
    case MT_OP_COUNT:
        break;
    }
    return nan("");
}

/*
 * v = a^b. dv/da = b a^(b-1) holds without a logarithm, also for a <= 0 where b is an integer;
 * x^0 = 1 everywhere, so its derivative is 0 even at x = 0. dv/db = v ln a needs a > 0; at a =
 * 0 with b > 0 the value stays 0 for every exponent nearby.
 */
static mt_partials pow_partials(double a, double b, double v)
{
    mt_partials d = {0.0, 0.0};
    if (b != 0.0) {
        d.a = b * pow_value(a, b - 1.0);
    }
    if (a > 0.0) {
        d.b = v * log(a);
    } else if (a < 0.0 || b <= 0.0) {
        d.b = nan("");
    }
    return d;
}

/* v = atan2(a, b): dv = (b da - a db) / (a^2 + b^2), written with h = hypot(a, b) so that
 * squares can neither overflow nor underflow. */
static mt_partials atan2_partials(double a, double b)
{
    const double h = hypot(a, b);
    return (mt_partials){quotient(quotient(b, h), h), -quotient(quotient(a, h), h)};
}

static double tanh_slope(double a)
{
    const double c = cosh(a); /* 1 - tanh^2 would lose all digits where tanh is near 1 */
    return 1.0 / c / c;
}

static double asin_slope(double a)
{
    return quotient(1.0, sqrt((1.0 - a) * (1.0 + a)));
}

static mt_partials choice(bool second)
{
    return second ? (mt_partials){0.0, 1.0} : (mt_partials){1.0, 0.0};
}

static mt_partials slope(double a)
{
    return (mt_partials){a, 0.0};
}

mt_partials mt_op_partials(mt_op op, double a, double b, double v)
{
    switch (op) {
    case MT_OP_NEG:
        return slope(-1.0);
    case MT_OP_SQRT:
        return slope(quotient(0.5, v));
    case MT_OP_CBRT:
        return slope(quotient(1.0, 3.0 * (v * v)));
    case MT_OP_EXP:
        return slope(v);
    case MT_OP_LN:
        return slope(quotient(1.0, a));
    case MT_OP_LOG10:
        return slope(quotient(1.0, a * MT_LN_10));
    case MT_OP_SIN:
        return slope(cos(a));
    case MT_OP_COS:
        return slope(-sin(a));
    case MT_OP_TAN:
        return slope(1.0 + v * v);
    case MT_OP_ASIN:
        return slope(asin_slope(a));
    case MT_OP_ACOS:
        return slope(-asin_slope(a));
    case MT_OP_ATAN:
        return slope(1.0 / (1.0 + a * a));
    case MT_OP_SINH:
        return slope(cosh(a));
    case MT_OP_COSH:
        return slope(sinh(a));
    case MT_OP_TANH:
        return slope(tanh_slope(a));
    case MT_OP_ABS:
        return slope(a < 0.0 ? -1.0 : 1.0);
    case MT_OP_ADD:
        return (mt_partials){1.0, 1.0};
    case MT_OP_SUB:
        return (mt_partials){1.0, -1.0};
    case MT_OP_MUL:
        return (mt_partials){b, a};
    case MT_OP_DIV:
        return (mt_partials){quotient(1.0, b), -quotient(v, b)};
    case MT_OP_POW:
        return pow_partials(a, b, v);
    case MT_OP_ATAN2:
        return atan2_partials(a, b);
    case MT_OP_MIN:
        return choice(b < a);
    case MT_OP_MAX:
        return choice(b > a);
    case MT_OP_HYPOT:
        return (mt_partials){quotient(a, v), quotient(b, v)};
    case MT_OP_LESS:
    case MT_OP_AT_MOST:
    case MT_OP_GREATER:
    case MT_OP_AT_LEAST:
    case MT_OP_EQUAL:
    case MT_OP_AND:
    case MT_OP_OR:
    case MT_OP_NOT:
    case MT_OP_IF:
    case MT_OP_THEN:
    case MT_OP_ELSE:
    case MT_OP_INTERP:
    case MT_OP_CONST:
    case MT_OP_PARAM:
    case MT_OP_COUNT:
        break;
    }
    return (mt_partials){nan(""), nan("")};
}
