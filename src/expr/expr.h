/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_EXPR_H
#define EXPR_EXPR_H

#include <stdbool.h>

#include "base/arena.h"
#include "base/diagnostics.h"

/*
 * Parameter expressions, parsed once into postfix code. Grammar:
 *     sum     = product { ("+" | "-") product }
 *     product = unary { ("*" | "/") unary }
 *     unary   = ("+" | "-") unary | power
 *     power   = atom [ "^" unary ]      right associative, binds tighter than a sign
 *     atom    = number | name | function "(" sum { "," sum } ")" | "(" sum ")"
 *     number  = decimal digits with an optional point and exponent
 * So -2^2 = -4. Numbers are correctly rounded, the same in every locale; hexadecimal, inf and
 * nan are not accepted. Functions of one argument: sqrt cbrt exp ln log10 sin cos tan asin acos
 * atan sinh cosh tanh abs; of two: atan2 min max hypot pow. interp(curve, sum) is the value of
 * a curve, called by its name, with or without quotes ' or ".
 * if(condition, sum, sum) is the first sum where the condition holds, else the second:
 *     condition = term { "or" term }
 *     term      = factor { "and" factor }
 *     factor    = "not" factor | "(" condition ")"
 *               | sum ( "<" | "<=" | ">" | ">=" | "==" ) sum
 * The condition holds nothing that varies where the expression is evaluated, and of the sums
 * only the chosen one is. "and", "or" and "not" are words there only. Angles in radians. x^0 =
 * 1 for every x; a negative base takes integer exponents only. Constants: pi, deg (pi/180), rpm
 * (1/60: "258*rpm" is a speed in Hz), mm, cm, inch and ft (in metres); e is not a constant. A
 * parameter name is [A-Za-z_][A-Za-z0-9_]*; names of functions and constants are reserved. The
 * limits below, on bytes of text, on levels of parentheses, arguments, signs and exponents, and
 * on elements of the code, bound the cost of any text.
 */
enum { MT_EXPR_MAX_LENGTH = 4096, MT_EXPR_MAX_DEPTH = 64, MT_EXPR_MAX_CODE = 1024 };

typedef enum mt_op {
    MT_OP_CONST,
    MT_OP_PARAM, /* in mt_expr: a parameter of the model; in mt_program: an input */
    MT_OP_NEG,
    MT_OP_SQRT,
    MT_OP_CBRT,
    MT_OP_EXP,
    MT_OP_LN,
    MT_OP_LOG10,
    MT_OP_SIN,
    MT_OP_COS,
    MT_OP_TAN,
    MT_OP_ASIN,
    MT_OP_ACOS,
    MT_OP_ATAN,
    MT_OP_SINH,
    MT_OP_COSH,
    MT_OP_TANH,
    MT_OP_ABS,
    MT_OP_INTERP, /* of a curve; mt_op_value does not know it */
    MT_OP_NOT,
    MT_OP_IF,
    MT_OP_ADD,
    MT_OP_SUB,
    MT_OP_MUL,
    MT_OP_DIV,
    MT_OP_POW,
    MT_OP_ATAN2,
    MT_OP_MIN,
    MT_OP_MAX,
    MT_OP_HYPOT,
    /* Conditions, whose value is 1 or 0. */
    MT_OP_LESS,
    MT_OP_AT_MOST,
    MT_OP_GREATER,
    MT_OP_AT_LEAST,
    MT_OP_EQUAL,
    MT_OP_AND,
    MT_OP_OR,
    /* if(c, a, b) is "c IF a THEN b ELSE": where c is false, the code of a and THEN is skipped,
     * else that of b and ELSE. Who does not skip sees operations of two operands: THEN has c
     * and a, ELSE what THEN left and b. */
    MT_OP_THEN,
    MT_OP_ELSE,
    MT_OP_COUNT
} mt_op;

typedef struct mt_interpolant mt_interpolant; /* expr/interpolant.h */

typedef struct mt_code {
    mt_op op;
    /* MT_OP_PARAM: index of the parameter; MT_OP_CONST: its mt_kind (expr/kind.h); MT_OP_IF and
     * MT_OP_THEN: number of elements that may be skipped */
    int param;
    union {
        double value;                /* MT_OP_CONST */
        const mt_interpolant *curve; /* MT_OP_INTERP */
    };
} mt_code;

/* One parsed expression: postfix code in an arena; immutable. */
typedef struct mt_expr {
    const mt_code *code;
    int length;
} mt_expr;

/* Finds a parameter by name (not NUL-terminated: length given); -1 where there is none. */
typedef int (*mt_expr_lookup)(const void *context, const char *name, size_t length);

/* What the names of an expression may be: parameters, which lookup (with context) finds (NULL:
 * there are none), and curves. names[n_names] are suggested besides functions and constants;
 * may be NULL. */
typedef struct mt_expr_scope {
    mt_expr_lookup lookup;
    const void *context;
    const char *const *names;
    int n_names;
    const mt_interpolant *curves;
    int n_curves;
} mt_expr_scope;

/*
 * Parse NUL-terminated text into code in mem, which refers to the scope's curves. scope NULL:
 * there are no names. Fails: MT_E_INPUT with location (characters from 1) and problem, "at
 * character 7: unknown name \"K_T9\"; did you mean \"K_T8\"?"; MT_E_MEMORY. *out is set on
 * success only. O(length of text).
 */
mt_status mt_expr_parse(const char *text, const mt_expr_scope *scope, mt_arena *mem,
                        mt_expr *out, mt_err *err);
/* An expression of one number. */
mt_status mt_expr_number(double value, mt_arena *mem, mt_expr *out, mt_err *err);
/* True where the expression has no parameter; *value is then its value, which may be infinite
 * or NaN ("1/0"). */
bool mt_expr_is_constant(const mt_expr *e, double *value);
/* True where the name is that of a function or a constant, and no parameter can have it: "if"
 * can, where no "(" follows. */
bool mt_expr_reserved(const char *name);
/* Names of all functions and constants, for suggestions; *n their number. */
const char *const *mt_expr_names(int *n);

#endif
