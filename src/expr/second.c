/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Along a line, v = f(a, b) has v'' = f_a a'' + f_b b'' + f_aa a'^2 + 2 f_ab a' b' + f_bb
 * b'^2. */
#include "expr/second.h"

#include <math.h>

#include "expr/op.h"

/* Second derivatives of one operation at (a, b), where its value is v: not finite where there
 * is none, 0 at kinks. */
typedef struct curvatures {
    double aa;
    double ab;
    double bb;
} curvatures;

/* Of two operands. */
MT_DIVIDES_BY_ZERO
static curvatures of_two(mt_op op, double a, double b, double v)
{
    const double r4 = ((a * a) + (b * b)) * ((a * a) + (b * b));
    switch ((int)op) {
    case MT_OP_MUL:
        return (curvatures){0.0, 1.0, 0.0};
    case MT_OP_DIV:
        return (curvatures){0.0, -1.0 / (b * b), 2.0 * v / (b * b)};
    case MT_OP_POW:
        return (curvatures){b == 0.0 || b == 1.0 ? 0.0 : b * (b - 1.0) * pow(a, b - 2.0),
                            pow(a, b - 1.0) * (1.0 + (b * log(a))), v * log(a) * log(a)};
    case MT_OP_ATAN2:
        return (curvatures){-2.0 * a * b / r4, ((a * a) - (b * b)) / r4, 2.0 * a * b / r4};
    case MT_OP_HYPOT:
        return (curvatures){b * b / (v * v * v), -a * b / (v * v * v), a * a / (v * v * v)};
    default:
        return (curvatures){0.0, 0.0, 0.0};
    }
}

/* Of one operand. */
MT_DIVIDES_BY_ZERO
static double of_one(mt_op op, double a, double v)
{
    switch ((int)op) {
    case MT_OP_SQRT:
        return -0.25 / (a * v);
    case MT_OP_CBRT:
        return -2.0 / 9.0 * v / (a * a);
    case MT_OP_EXP:
    case MT_OP_SINH:
    case MT_OP_COSH:
        return v;
    case MT_OP_LN:
        return -1.0 / (a * a);
    case MT_OP_LOG10:
        return -1.0 / (a * a * MT_LN_10);
    case MT_OP_SIN:
    case MT_OP_COS:
        return -v;
    case MT_OP_TAN:
        return 2.0 * v * (1.0 + (v * v));
    case MT_OP_ASIN:
        return a / pow((1.0 - a) * (1.0 + a), 1.5);
    case MT_OP_ACOS:
        return -a / pow((1.0 - a) * (1.0 + a), 1.5);
    case MT_OP_ATAN:
        return -2.0 * a / ((1.0 + (a * a)) * (1.0 + (a * a)));
    case MT_OP_TANH:
        return -2.0 * v * (1.0 - v) * (1.0 + v);
    default:
        return 0.0;
    }
}

static curvatures curvatures_of(mt_op op, double a, double b, double v)
{
    return mt_op_operands(op) == 2 ? of_two(op, a, b, v)
                                   : (curvatures){of_one(op, a, v), 0.0, 0.0};
}

/* Product in which 0 times a value that is not finite is 0: a constant operand needs no
 * derivative. */
static double times(double slope, double by)
{
    return by == 0.0 ? 0.0 : slope * by;
}

static void node_second(const mt_program_node *n, const double *a, const double *b,
                        double out[3])
{
    const double v = mt_op_value(n->op, a[0], b[0]);
    const mt_partials d = mt_op_partials(n->op, a[0], b[0], v);
    const curvatures c = curvatures_of(n->op, a[0], b[0], v);
    out[0] = v;
    out[1] = times(d.a, a[1]) + times(d.b, b[1]);
    out[2] = times(d.a, a[2]) + times(d.b, b[2]) + times(c.aa, a[1] * a[1]) +
             times(2.0 * c.ab, a[1] * b[1]) + times(c.bb, b[1] * b[1]);
}

mt_status mt_program_second(const mt_program *p, double t, double (*node)[3], mt_err *err)
{
    static const double none[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < p->count; i++) {
        const mt_program_node *const n = &p->nodes[i];
        double *const out = node[i];
        if (n->op == MT_OP_CONST || n->op == MT_OP_PARAM) {
            out[0] = n->op == MT_OP_CONST ? n->value : t;
            out[1] = n->op == MT_OP_CONST ? 0.0 : 1.0;
            out[2] = 0.0;
            continue;
        }
        node_second(n, node[n->a], n->b == MT_NO_NODE ? none : node[n->b], out);
        if (!isfinite(out[0]) || !isfinite(out[1]) || !isfinite(out[2])) {
            return mt_fail(err, MT_E_DOMAIN,
                           "at %.6g \"%s\" has no finite value or no finite derivatives", t,
                           mt_op_name(n->op));
        }
    }
    return MT_OK;
}
