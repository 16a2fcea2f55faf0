/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Names of the language, what is meant by what it does not know, and its texts read: recursive
 * descent over the grammar of expr.h, one function per rule, to postfix code. Every way to nest
 * (parenthesis, argument, sign, exponent) goes through `deeper`, so the recursion is at most
 * MT_EXPR_MAX_DEPTH * 5 small frames. The first problem ends the parse; its place is counted in
 * characters (code points), from 1.
 */
#include "expr/expr.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "base/text.h"
#include "expr/interpolant.h"
#include "expr/kind.h"
#include "expr/op.h"
#include "expr/units.h"

/* One list makes the table of functions, that of constants and the names that are reserved. */
#define FUNCTION_LIST(X)      \
    X("sqrt", MT_OP_SQRT)     \
    X("cbrt", MT_OP_CBRT)     \
    X("exp", MT_OP_EXP)       \
    X("ln", MT_OP_LN)         \
    X("log10", MT_OP_LOG10)   \
    X("sin", MT_OP_SIN)       \
    X("cos", MT_OP_COS)       \
    X("tan", MT_OP_TAN)       \
    X("asin", MT_OP_ASIN)     \
    X("acos", MT_OP_ACOS)     \
    X("atan", MT_OP_ATAN)     \
    X("sinh", MT_OP_SINH)     \
    X("cosh", MT_OP_COSH)     \
    X("tanh", MT_OP_TANH)     \
    X("abs", MT_OP_ABS)       \
    X("interp", MT_OP_INTERP) \
    X("if", MT_OP_IF)         \
    X("atan2", MT_OP_ATAN2)   \
    X("min", MT_OP_MIN)       \
    X("max", MT_OP_MAX)       \
    X("hypot", MT_OP_HYPOT)   \
    X("pow", MT_OP_POW)
/* The constants that are units are worth what expr/units.h says; pi is its own. */
#define CONSTANT_LIST(X) \
    X("pi", NULL)        \
    X("deg", "deg")      \
    X("rpm", "rpm")      \
    X("mm", "mm")        \
    X("cm", "cm")        \
    X("inch", "in")      \
    X("ft", "ft")

#define NAME_ENTRY(name, value)  name,
#define VALUE_ENTRY(name, value) value,

static const char *const reserved_names[] = {FUNCTION_LIST(NAME_ENTRY)
                                                 CONSTANT_LIST(NAME_ENTRY)};
static const mt_op function_ops[] = {FUNCTION_LIST(VALUE_ENTRY)};
static const char *const constant_units[] = {CONSTANT_LIST(VALUE_ENTRY)};

enum { N_NAMES = MT_COUNT(reserved_names), N_FUNCTIONS = MT_COUNT(function_ops) };

static bool is_reserved_word(const char *name, size_t length, const char *reserved)
{
    return strlen(reserved) == length && memcmp(name, reserved, length) == 0;
}

/* Functions and constants by name (length bytes); false: unknown. A constant has a kind
 * (expr/kind.h): "mm" is a length. */
static bool find_function(const char *name, size_t length, mt_op *op)
{
    for (int i = 0; i < N_FUNCTIONS; i++) {
        if (is_reserved_word(name, length, reserved_names[i])) {
            *op = function_ops[i];
            return true;
        }
    }
    return false;
}

static bool find_constant(const char *name, size_t length, double *value, mt_kind *kind)
{
    static const double pi = 3.14159265358979323846;
    for (int i = N_FUNCTIONS; i < N_NAMES; i++) {
        if (is_reserved_word(name, length, reserved_names[i])) {
            const char *const of = constant_units[i - N_FUNCTIONS];
            const mt_unit *const unit = of == NULL ? NULL : mt_unit_find(of);
            *value = unit == NULL ? pi : mt_unit_factor(unit);
            *kind = unit == NULL ? MT_KIND_PI : mt_kind_of_dimension(unit->dimension);
            return true;
        }
    }
    return false;
}

bool mt_expr_reserved(const char *name)
{
    for (int i = 0; i < N_NAMES; i++) {
        if (strcmp(name, reserved_names[i]) == 0) {
            return i >= N_FUNCTIONS || function_ops[i] != MT_OP_IF;
        }
    }
    return false;
}

const char *const *mt_expr_names(int *n)
{
    *n = N_NAMES;
    return reserved_names;
}

/* Units that no constant of the language is (expr/units.h has those). */
typedef struct unit_word {
    const char *word;
    const char *factor; /* "": 1 */
    const char *si;
} unit_word;

static const unit_word words[] = {{"um", "1e-6", "m"},
                                  {"km", "1e3", "m"},
                                  {"m", "", "m"},
                                  {"g", "1e-3", "kg"},
                                  {"kg", "", "kg"},
                                  {"t", "1e3", "kg"},
                                  {"lb", "0.45359237", "kg"},
                                  {"N", "", "N"},
                                  {"kN", "1e3", "N"},
                                  {"Nm", "", "N m"},
                                  {"Nmm", "1e-3", "N m"},
                                  {"Pa", "", "Pa"},
                                  {"MPa", "1e6", "Pa"},
                                  {"GPa", "1e9", "Pa"},
                                  {"Hz", "", "Hz"},
                                  {"kHz", "1e3", "Hz"},
                                  {"rad", "", "rad"},
                                  {"mrad", "1e-3", "rad"},
                                  {"s", "", "s"},
                                  {"ms", "1e-3", "s"}};

/* Other words for the constants. */
static const char *const other_words[][2] = {
    {"degree", "deg"}, {"degrees", "deg"},   {"\xC2\xB0", "deg"},
    {"in", "inch"},    {"inches", "inch"},   {"feet", "ft"},
    {"foot", "ft"},    {"millimetre", "mm"}, {"RPM", "rpm"}};

static bool is_unit_word(const char *word, size_t n_word, const char *s)
{
    return strlen(s) == n_word && memcmp(s, word, n_word) == 0;
}

/* The constant with this name or synonym; NULL: none. */
static const char *constant_of(const char *word, size_t n_word)
{
    int n = 0;
    const mt_unit *const known = mt_units(&n);
    for (int i = 0; i < n; i++) {
        if (known[i].constant != NULL && is_unit_word(word, n_word, known[i].constant)) {
            return known[i].constant;
        }
    }
    for (int i = 0; i < MT_COUNT(other_words); i++) {
        if (is_unit_word(word, n_word, other_words[i][0])) {
            return other_words[i][1];
        }
    }
    return NULL;
}

/* Suggestion for a number followed by a unit, "15 deg" or "2 mm": "15*deg", "2*1e3 (m)", in
 * out[size]. n_number, n_word: lengths in bytes. False: the word is not a unit. */
static bool find_meant(const char *number, size_t n_number, const char *word, size_t n_word,
                       char *out, size_t size)
{
    const char *const constant = constant_of(word, n_word);
    if (constant != NULL) {
        (void)mt_snprintf(out, size, "\"%.*s*%s\"", (int)n_number, number, constant);
        return true;
    }
    if (is_unit_word(word, n_word, "%") || is_unit_word(word, n_word, "percent")) {
        (void)mt_snprintf(out, size, "\"%.*s/100\"", (int)n_number, number);
        return true;
    }
    for (int i = 0; i < MT_COUNT(words); i++) {
        const unit_word *const w = &words[i];
        if (is_unit_word(word, n_word, w->word)) {
            (void)mt_snprintf(out, size, "\"%.*s%s%s\" (expressions are in SI units, here %s)",
                              (int)n_number, number, w->factor[0] == '\0' ? "" : "*", w->factor,
                              w->si);
            return true;
        }
    }
    return false;
}

/* What an operation can take: a number or a condition. */
typedef struct operand {
    bool condition;
    size_t from; /* where its text begins */
} operand;

typedef struct parser {
    const char *text;
    size_t at;         /* next byte */
    size_t number;     /* of the last number */
    size_t number_end; /* 0: none yet */
    int depth;
    bool conditional; /* within the condition of an if() */
    size_t atom;      /* where the last number, name or parenthesis begins */
    int length;       /* of code */
    int n_operands;   /* what the code so far leaves on its stack */
    operand operands[MT_EXPR_MAX_CODE];
    const mt_expr_scope *scope;
    mt_err *err;
    mt_code code[MT_EXPR_MAX_CODE];
} parser;

/* A name longer than this is shortened in messages. */
enum { SHOWN = 60 };

static mt_status parse_sum(parser *p);
static mt_status parse_unary(parser *p);

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_name_start(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool is_name_part(char c)
{
    return is_name_start(c) || is_digit(c);
}

/* Number of the character that the byte at `at` begins. */
static int character(const parser *p, size_t at)
{
    int n = 1;
    for (size_t i = 0; i < at; i++) {
        n += ((unsigned char)p->text[i] & 0xC0U) != 0x80U; /* 10xxxxxx continues a character */
    }
    return n;
}

static int shown_length(size_t length)
{
    return length < SHOWN ? (int)length : SHOWN;
}

static char peek(parser *p)
{
    while (p->text[p->at] == ' ' || p->text[p->at] == '\t' || p->text[p->at] == '\n' ||
           p->text[p->at] == '\r') {
        p->at++;
    }
    return p->text[p->at];
}

/* "at character 3: "*" where ... is expected" at the next thing in the text. */
static mt_status expected(parser *p, const char *what)
{
    const unsigned char c = (unsigned char)peek(p);
    const int where = character(p, p->at);
    if (c == '\0') {
        return mt_fail(p->err, MT_E_INPUT,
                       "at character %d: the expression ends where %s is expected", where,
                       what);
    }
    if (c < 0x20U || c == 0x7FU) {
        return mt_fail(p->err, MT_E_INPUT,
                       "at character %d: control character where %s is expected", where, what);
    }
    const char *const from = p->text + p->at;
    size_t n = 1;
    while (c >= 0x80U ? n < 4 && ((unsigned char)from[n] & 0xC0U) == 0x80U
                      : is_name_part((char)c) && is_name_part(from[n])) {
        n++;
    }
    return mt_fail(p->err, MT_E_INPUT, "at character %d: \"%.*s\" where %s is expected", where,
                   shown_length(n), from, what);
}

static bool takes_conditions(mt_op op)
{
    return op == MT_OP_AND || op == MT_OP_OR || op == MT_OP_NOT || op == MT_OP_IF;
}

static bool gives_condition(mt_op op)
{
    return op == MT_OP_NOT || (op >= MT_OP_LESS && op <= MT_OP_OR);
}

/* Puts an operation's result in the place of its operands, which are what it takes. */
static mt_status operate(parser *p, mt_op op)
{
    const int n = mt_op_operands(op);
    const int first = p->n_operands - n;
    for (int i = first; i < p->n_operands; i++) {
        const operand *const a = &p->operands[i];
        const bool wanted = takes_conditions(op) || (op == MT_OP_THEN && i == first);
        if (a->condition && !wanted) {
            return mt_fail(p->err, MT_E_INPUT,
                           "at character %d: a condition where a number is expected",
                           character(p, a->from));
        }
        if (!a->condition && wanted) {
            return mt_fail(p->err, MT_E_INPUT,
                           "at character %d: a number where a condition is expected, such as "
                           "\"a > 0\"",
                           character(p, a->from));
        }
    }
    p->operands[first] = (operand){.condition = gives_condition(op) || op == MT_OP_IF,
                                   .from = n == 0 ? p->atom : p->operands[first].from};
    p->n_operands = first + 1;
    return MT_OK;
}

static mt_status emit(parser *p, mt_op op, int param, double value)
{
    if (p->length == MT_EXPR_MAX_CODE) {
        return mt_fail(p->err, MT_E_INPUT,
                       "at character %d: the expression has more than %d parts",
                       character(p, p->at), (int)MT_EXPR_MAX_CODE);
    }
    p->code[p->length++] = (mt_code){.op = op, .param = param, .value = value};
    return operate(p, op);
}

static mt_status emit_op(parser *p, mt_op op)
{
    return emit(p, op, -1, 0.0);
}

/* Parse with `rule` one level further down. */
static mt_status deeper(parser *p, mt_status (*rule)(parser *p))
{
    if (p->depth == MT_EXPR_MAX_DEPTH) {
        return mt_fail(p->err, MT_E_INPUT, "at character %d: nested more than %d levels deep",
                       character(p, p->at), (int)MT_EXPR_MAX_DEPTH);
    }
    p->depth++;
    MT_TRY(rule(p));
    p->depth--;
    return MT_OK;
}

static mt_status parse_close(parser *p, size_t open)
{
    if (peek(p) != ')') {
        char what[64];
        (void)mt_snprintf(what, sizeof what,
                          "an operator or the \")\" for the \"(\" at character %d",
                          character(p, open));
        return expected(p, what);
    }
    p->at++;
    return MT_OK;
}

/* The candidate nearest to the name, from the parameters or from functions and constants; NULL:
 * none. */
static const char *suggestion(const parser *p, const char *name, bool function)
{
    int n = 0;
    const char *const *const reserved = mt_expr_names(&n);
    const char *const of_ours = mt_text_nearest(name, reserved, n);
    const char *const of_theirs =
        mt_text_nearest(name, p->scope->names, p->scope->names == NULL ? 0 : p->scope->n_names);
    if (function) {
        return of_ours;
    }
    return of_theirs != NULL ? of_theirs : of_ours;
}

static mt_status unknown_name(parser *p, size_t from, size_t length, bool function)
{
    char name[MT_EXPR_MAX_LENGTH + 1];
    memcpy(name, p->text + from, length);
    name[length] = '\0';
    const char *const near = suggestion(p, name, function);
    const char *const kind = function ? "function" : "name";
    const int where = character(p, from);
    if (near == NULL) {
        return mt_fail(p->err, MT_E_INPUT, "at character %d: unknown %s \"%.*s\"", where, kind,
                       (int)SHOWN, name);
    }
    return mt_fail(p->err, MT_E_INPUT,
                   "at character %d: unknown %s \"%.*s\"; did you mean \"%s\"?", where, kind,
                   (int)SHOWN, name, near);
}

/* The curve with a name of `length` bytes from `from`. */
static mt_status find_curve(const parser *p, size_t from, size_t length,
                            const mt_interpolant **out)
{
    const mt_expr_scope *const scope = p->scope;
    const char *near = NULL;
    char name[MT_EXPR_MAX_LENGTH + 1];
    memcpy(name, p->text + from, length);
    name[length] = '\0';
    for (int i = 0; i < scope->n_curves; i++) {
        const char *const known = scope->curves[i].name;
        if (known != NULL && strcmp(known, name) == 0) {
            *out = &scope->curves[i];
            return MT_OK;
        }
        near = near != NULL || known == NULL ? near : mt_text_nearest(name, &known, 1);
    }
    return mt_fail(p->err, MT_E_INPUT, "at character %d: unknown curve \"%.*s\"%s%s%s",
                   character(p, from), (int)SHOWN, name,
                   near != NULL           ? "; did you mean \""
                   : scope->n_curves == 0 ? " (the model has no \"curves\")"
                                          : "",
                   near != NULL ? near : "", near != NULL ? "\"?" : "");
}

/* The name of a curve, perhaps in quotes, and the comma behind it. */
static mt_status parse_curve(parser *p, const mt_interpolant **out)
{
    static const char what[] = "the name of a curve";
    const char quote = peek(p);
    const bool quoted = quote == '\'' || quote == '"';
    p->at += quoted;
    const size_t from = p->at;
    if (!is_name_start(p->text[from])) {
        return expected(p, what);
    }
    while (is_name_part(p->text[p->at])) {
        p->at++;
    }
    MT_TRY(find_curve(p, from, p->at - from, out));
    if (quoted && p->text[p->at] != quote) {
        return expected(p, "the end of the curve's name in quotes");
    }
    p->at += quoted;
    if (peek(p) != ',') {
        return expected(p, "\",\" and where to read the curve");
    }
    p->at++;
    return MT_OK;
}

static mt_status parse_interp(parser *p)
{
    const mt_interpolant *curve = NULL;
    const bool outside = p->conditional;
    const size_t open = p->at++;
    MT_TRY(parse_curve(p, &curve));
    p->conditional = false;
    MT_TRY(deeper(p, parse_sum));
    p->conditional = outside;
    MT_TRY(parse_close(p, open));
    MT_TRY(emit_op(p, MT_OP_INTERP));
    p->code[p->length - 1].curve = curve;
    return MT_OK;
}

/* Conditions */

/* The operator of a comparison at p->at, with its length; MT_OP_CONST: there is none. */
static mt_op comparison_at(parser *p, size_t *length)
{
    const char c = peek(p);
    const bool equals = c != '\0' && p->text[p->at + 1] == '=';
    *length = equals ? 2 : 1;
    if (c == '<') {
        return equals ? MT_OP_AT_MOST : MT_OP_LESS;
    }
    if (c == '>') {
        return equals ? MT_OP_AT_LEAST : MT_OP_GREATER;
    }
    return c == '=' && equals ? MT_OP_EQUAL : MT_OP_CONST;
}

/* True where the next word is this one, which is passed. */
static bool pass_word(parser *p, const char *word)
{
    const size_t length = strlen(word);
    (void)peek(p);
    if (strncmp(p->text + p->at, word, length) != 0 || is_name_part(p->text[p->at + length])) {
        return false;
    }
    p->at += length;
    return true;
}

static mt_status parse_comparison(parser *p)
{
    size_t length = 0;
    MT_TRY(parse_sum(p));
    const mt_op op = comparison_at(p, &length);
    if (op == MT_OP_CONST) {
        return MT_OK;
    }
    p->at += length;
    MT_TRY(parse_sum(p));
    MT_TRY(emit_op(p, op));
    if (comparison_at(p, &length) != MT_OP_CONST) {
        return mt_fail(p->err, MT_E_INPUT,
                       "at character %d: a second comparison; write \"a < b and b < c\"",
                       character(p, p->at));
    }
    return MT_OK;
}

static mt_status parse_factor(parser *p)
{
    if (!pass_word(p, "not")) {
        return parse_comparison(p);
    }
    MT_TRY(deeper(p, parse_factor));
    return emit_op(p, MT_OP_NOT);
}

static mt_status parse_term(parser *p)
{
    MT_TRY(parse_factor(p));
    while (pass_word(p, "and")) {
        MT_TRY(parse_factor(p));
        MT_TRY(emit_op(p, MT_OP_AND));
    }
    return MT_OK;
}

static mt_status parse_condition(parser *p)
{
    MT_TRY(parse_term(p));
    while (pass_word(p, "or")) {
        MT_TRY(parse_term(p));
        MT_TRY(emit_op(p, MT_OP_OR));
    }
    return MT_OK;
}

/* Error for what follows a condition in place of its comma. */
static mt_status no_comma(parser *p)
{
    static const char *const meant[][2] = {{"&", "and"},           {"|", "or"},
                                           {"!=", "not a == b"},   {"=", "=="},
                                           {"\xE2\x89\xA4", "<="}, {"\xE2\x89\xA5", ">="}};
    for (int i = 0; i < MT_COUNT(meant); i++) {
        if (strncmp(p->text + p->at, meant[i][0], strlen(meant[i][0])) == 0) {
            return mt_fail(p->err, MT_E_INPUT,
                           "at character %d: \"%s\" is not part of a condition; did you mean "
                           "\"%s\"?",
                           character(p, p->at), meant[i][0], meant[i][1]);
        }
    }
    return expected(p, "\",\" behind the condition of if(condition, a, b)");
}

/* if(condition, a, b); p is at the "(". */
static mt_status parse_if(parser *p)
{
    const bool outside = p->conditional;
    const size_t open = p->at++;
    p->conditional = true;
    MT_TRY(deeper(p, parse_condition));
    p->conditional = false;
    if (peek(p) != ',') {
        return no_comma(p);
    }
    p->at++;
    MT_TRY(emit_op(p, MT_OP_IF));
    const int condition = p->length - 1;
    MT_TRY(deeper(p, parse_sum));
    if (peek(p) != ',') {
        return expected(p,
                        "\",\" and what if(condition, a, b) is where the condition is false");
    }
    p->at++;
    MT_TRY(emit_op(p, MT_OP_THEN));
    const int then = p->length - 1;
    MT_TRY(deeper(p, parse_sum));
    MT_TRY(parse_close(p, open));
    MT_TRY(emit_op(p, MT_OP_ELSE));
    p->code[condition].param = then - condition;
    p->code[then].param = p->length - 1 - then;
    p->conditional = outside;
    return MT_OK;
}

/* The arguments of a function whose name begins at `from`; p is at the "(". */
static mt_status parse_arguments(parser *p, size_t from, size_t length, mt_op op)
{
    const bool outside = p->conditional;
    const size_t open = p->at++;
    const int operands = mt_op_operands(op);
    int count = 0;
    p->conditional = false;
    for (bool more = true; more; count++) {
        MT_TRY(deeper(p, parse_sum));
        more = peek(p) == ',';
        p->at += more;
    }
    p->conditional = outside;
    if (count != operands) {
        return mt_fail(p->err, MT_E_INPUT,
                       "at character %d: function \"%.*s\" takes %d argument%s, not %d",
                       character(p, from), (int)length, p->text + from, operands,
                       operands == 1 ? "" : "s", count);
    }
    MT_TRY(parse_close(p, open));
    return emit_op(p, op);
}

/* A function whose name begins at `from`; p is at the "(". */
static mt_status parse_call(parser *p, size_t from, size_t length)
{
    mt_op op = MT_OP_CONST;
    if (!find_function(p->text + from, length, &op)) {
        return unknown_name(p, from, length, true);
    }
    if (op == MT_OP_IF) {
        return parse_if(p);
    }
    return op == MT_OP_INTERP ? parse_interp(p) : parse_arguments(p, from, length, op);
}

/* A unit that multiplies nothing. */
static mt_status lone_unit(parser *p, size_t from, size_t length)
{
    const char *const name = p->text + from;
    return mt_fail(p->err, MT_E_INPUT,
                   "at character %d: \"%.*s\" is a unit: write how many of it, as \"5*%.*s\"",
                   character(p, from), (int)length, name, (int)length, name);
}

/* True where the name just read, which begins at `from`, is multiplied, divided or raised to a
 * power. A unit of length that is not is probably a slip for a parameter of nearly that
 * name. */
static bool is_factor(parser *p, size_t from)
{
    const char next = peek(p);
    while (from > 0 && strchr(" \t\n\r", p->text[from - 1]) != NULL) {
        from--;
    }
    if (from > 0 && (p->text[from - 1] == '*' || p->text[from - 1] == '/')) {
        return true;
    }
    return next == '*' || next == '/' || next == '^';
}

/* -1: there is none of this name. */
static int find_parameter(const parser *p, const char *name, size_t length)
{
    const mt_expr_scope *const scope = p->scope;
    return scope->lookup == NULL ? -1 : scope->lookup(scope->context, name, length);
}

static mt_status parse_name(parser *p)
{
    const size_t from = p->at;
    while (is_name_part(p->text[p->at])) {
        p->at++;
    }
    const char *const name = p->text + from;
    const size_t length = p->at - from;
    if (peek(p) == '(') {
        return parse_call(p, from, length);
    }
    double value = 0.0;
    mt_kind kind = MT_KIND_NUMBER;
    if (find_constant(name, length, &value, &kind)) {
        if (kind == MT_KIND_LENGTH && !is_factor(p, from)) {
            return lone_unit(p, from, length);
        }
        return emit(p, MT_OP_CONST, (int)kind, value);
    }
    mt_op op = MT_OP_CONST;
    const int param = find_parameter(p, name, length);
    if (find_function(name, length, &op) && (op != MT_OP_IF || param < 0)) {
        return mt_fail(p->err, MT_E_INPUT, "at character %d: function \"%.*s\" without \"(\"",
                       character(p, from), (int)length, name);
    }
    if (param < 0) {
        return unknown_name(p, from, length, false);
    }
    return emit(p, MT_OP_PARAM, param, 0.0);
}

/* Error message for the number that begins at `from`, with all of its text. */
static mt_status bad_number(parser *p, size_t from, const char *what)
{
    size_t end = from;
    while (is_name_part(p->text[end]) || p->text[end] == '.') {
        end++;
    }
    return mt_fail(p->err, MT_E_INPUT, "at character %d: \"%.*s\" %s", character(p, from),
                   shown_length(end - from), p->text + from, what);
}

/* True where a name of `length` bytes is known. */
static bool is_known_name(const parser *p, const char *name, size_t length)
{
    double value = 0.0;
    mt_kind kind = MT_KIND_NUMBER;
    mt_op op = MT_OP_CONST;
    return length > 0 && (find_constant(name, length, &value, &kind) ||
                          find_parameter(p, name, length) >= 0 ||
                          (name[length] == '(' && find_function(name, length, &op)));
}

/* A number from `from` with a name right behind it, at p->at: a product, perhaps. */
static mt_status product_meant(parser *p, size_t from)
{
    size_t end = p->at;
    while (is_name_part(p->text[end])) {
        end++;
    }
    if (!is_name_start(p->text[p->at]) || !is_known_name(p, p->text + p->at, end - p->at)) {
        return bad_number(p, from, "is not a number; a product needs \"*\"");
    }
    return mt_fail(p->err, MT_E_INPUT,
                   "at character %d: \"%.*s\" is not a number; did you mean \"%.*s*%.*s\"?",
                   character(p, from), shown_length(end - from), p->text + from,
                   shown_length(p->at - from), p->text + from, shown_length(end - p->at),
                   p->text + p->at);
}

/*
 * number = (digits [ "." [digits] ] | "." digits) [ ("e"|"E") ["+"|"-"] digits ], correctly
 * rounded. The C library rounds correctly, but reads the decimal point of the process's locale.
 * So it gets none: "12.50e3" is handed over as "1250e1", which means the same in every locale.
 */
static mt_status parse_number(parser *p)
{
    const char *const s = p->text;
    const size_t from = p->at;
    char digits[MT_EXPR_MAX_LENGTH + 32];
    size_t n = 0;
    int exponent = 0;
    bool point = false;
    for (; is_digit(s[p->at]) || (s[p->at] == '.' && !point); p->at++) {
        if (s[p->at] == '.') {
            point = true;
        } else {
            digits[n++] = s[p->at];
            exponent -= point;
        }
    }
    if (n == 0) {
        return bad_number(p, from, "is not a number");
    }
    if (s[p->at] == 'e' || s[p->at] == 'E') {
        enum { EXPONENT_LIMIT = 100000 }; /* beyond any text's digits and any double's range */
        const bool negative = s[p->at + 1] == '-';
        p->at += negative || s[p->at + 1] == '+' ? 2 : 1;
        if (!is_digit(s[p->at])) {
            return bad_number(p, from, "is not a number");
        }
        int e = 0;
        for (; is_digit(s[p->at]); p->at++) {
            e = e < EXPONENT_LIMIT ? 10 * e + (s[p->at] - '0') : e;
        }
        exponent += negative ? -e : e;
    }
    if (is_name_part(s[p->at]) || s[p->at] == '.') {
        return product_meant(p, from);
    }
    (void)mt_snprintf(digits + n, sizeof digits - n, "e%d", exponent);
    const double value = strtod(digits, NULL);
    if (!isfinite(value)) {
        return bad_number(p, from, "is too large for a number");
    }
    p->number = from;
    p->number_end = p->at;
    return emit(p, MT_OP_CONST, (int)MT_KIND_NUMBER, value);
}

static mt_status parse_atom(parser *p)
{
    const char c = peek(p);
    p->atom = p->at;
    if (is_digit(c) || c == '.') {
        return parse_number(p);
    }
    if (is_name_start(c)) {
        return parse_name(p);
    }
    if (c == '(') {
        const size_t open = p->at++;
        MT_TRY(deeper(p, p->conditional ? parse_condition : parse_sum));
        return parse_close(p, open);
    }
    return expected(p, "a number, a name or \"(\"");
}

static mt_status parse_power(parser *p)
{
    MT_TRY(parse_atom(p));
    if (peek(p) != '^') {
        return MT_OK;
    }
    p->at++;
    MT_TRY(deeper(p, parse_unary));
    return emit_op(p, MT_OP_POW);
}

static mt_status parse_unary(parser *p)
{
    const char c = peek(p);
    if (c != '+' && c != '-') {
        return parse_power(p);
    }
    p->at++;
    MT_TRY(deeper(p, parse_unary));
    return c == '-' ? emit_op(p, MT_OP_NEG) : MT_OK;
}

static mt_status parse_product(parser *p)
{
    MT_TRY(parse_unary(p));
    for (char c = peek(p); c == '*' || c == '/'; c = peek(p)) {
        if (c == '*' && p->text[p->at + 1] == '*') {
            return mt_fail(p->err, MT_E_INPUT,
                           "at character %d: \"**\" is not an operator; did you mean \"^\"?",
                           character(p, p->at));
        }
        p->at++;
        MT_TRY(parse_unary(p));
        MT_TRY(emit_op(p, c == '*' ? MT_OP_MUL : MT_OP_DIV));
    }
    return MT_OK;
}

static mt_status parse_sum(parser *p)
{
    MT_TRY(parse_product(p));
    for (char c = peek(p); c == '+' || c == '-'; c = peek(p)) {
        p->at++;
        MT_TRY(parse_product(p));
        MT_TRY(emit_op(p, c == '+' ? MT_OP_ADD : MT_OP_SUB));
    }
    return MT_OK;
}

/* End of the word at p->at: a name, "%" or a sign beyond ASCII, as of degrees. */
static size_t word_end(const parser *p)
{
    size_t end = p->at;
    while (is_name_part(p->text[end]) || ((unsigned char)p->text[end] & 0x80U) != 0) {
        end++;
    }
    return end == p->at && p->text[end] == '%' ? end + 1 : end;
}

/* Error for text behind the expression: the unit of a number, a missing multiplication, or a
 * decimal comma. */
static mt_status left_over(parser *p)
{
    char meant[2 * SHOWN];
    const char *const left = p->text + p->at;
    const char *const number = p->text + p->number;
    const size_t length = word_end(p) - p->at;
    const size_t digits = p->number_end - p->number;
    bool apart = p->number_end > 0 && digits < SHOWN;
    for (size_t i = p->number_end; i < p->at; i++) {
        apart = apart && p->text[i] == ' ';
    }
    if (apart && find_meant(number, digits, left, length, meant, sizeof meant)) {
        return mt_fail(p->err, MT_E_INPUT,
                       "at character %d: \"%.*s\" is not part of a number; did you mean %s?",
                       character(p, p->at), shown_length(length), left, meant);
    }
    size_t more = 1;
    while (left[0] == ',' && is_digit(left[more])) {
        more++;
    }
    if (apart && p->number_end == p->at && left[0] == ',' && more > 1 &&
        memchr(number, '.', digits) == NULL) {
        return mt_fail(p->err, MT_E_INPUT,
                       "at character %d: \",\" where an operator or the end is expected; did "
                       "you mean \"%.*s.%.*s\"?",
                       character(p, p->at), (int)digits, number, shown_length(more - 1),
                       left + 1);
    }
    if (apart && is_name_start(left[0]) && is_known_name(p, left, length)) {
        return mt_fail(
            p->err, MT_E_INPUT,
            "at character %d: \"%.*s\" where an operator or the end is expected; did "
            "you mean \"%.*s*%.*s\"?",
            character(p, p->at), shown_length(length), left, (int)digits, number,
            shown_length(length), left);
    }
    size_t compared = 0;
    return expected(p, comparison_at(p, &compared) == MT_OP_CONST
                           ? "an operator or the end"
                           : "an operator or the end (comparisons stand in the condition of "
                             "if(condition, a, b))");
}

mt_status mt_expr_parse(const char *text, const mt_expr_scope *scope, mt_arena *mem,
                        mt_expr *out, mt_err *err)
{
    static const mt_expr_scope nothing = {0};
    if (strnlen(text, MT_EXPR_MAX_LENGTH + 1) > MT_EXPR_MAX_LENGTH) {
        return mt_fail(err, MT_E_INPUT, "the expression is longer than %d bytes",
                       (int)MT_EXPR_MAX_LENGTH);
    }
    parser p;
    p.text = text;
    p.at = 0;
    p.number = 0;
    p.number_end = 0;
    p.depth = 0;
    p.conditional = false;
    p.atom = 0;
    p.length = 0;
    p.n_operands = 0;
    p.scope = scope == NULL ? &nothing : scope;
    p.err = err;
    MT_TRY(parse_sum(&p));
    if (peek(&p) != '\0') {
        return left_over(&p);
    }
    mt_code *const code = mt_arena_alloc(mem, (size_t)p.length, sizeof *code);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(code, p.code, (size_t)p.length * sizeof *code);
    *out = (mt_expr){.code = code, .length = p.length};
    return MT_OK;
}

mt_status mt_expr_number(double value, mt_arena *mem, mt_expr *out, mt_err *err)
{
    mt_code *const code = mt_arena_alloc(mem, 1, sizeof *code);
    MT_TRY(mt_arena_check(mem, err));
    *code = (mt_code){.op = MT_OP_CONST, .param = (int)MT_KIND_NUMBER, .value = value};
    *out = (mt_expr){.code = code, .length = 1};
    return MT_OK;
}

bool mt_expr_is_constant(const mt_expr *e, double *value)
{
    double stack[MT_EXPR_MAX_CODE];
    int top = 0;
    bool none = false; /* a condition has no value */
    for (int i = 0; i < e->length; i++) {
        if (e->code[i].op == MT_OP_PARAM) {
            return false;
        }
    }
    memset(stack, 0, (size_t)e->length * sizeof *stack); /* which is as deep as it gets */
    for (int i = 0; i < e->length; i++) {
        const mt_code c = e->code[i];
        const int operands = mt_op_operands(c.op);
        double v = c.value;
        if (c.op == MT_OP_IF || c.op == MT_OP_THEN || c.op == MT_OP_ELSE) {
            v = stack[top - 1];
            none = none || (c.op == MT_OP_IF && isnan(v));
            i += c.op == MT_OP_THEN || (c.op == MT_OP_IF && v == 0.0) ? c.param : 0;
        } else if (c.op == MT_OP_INTERP) {
            double at[3];
            mt_interpolant_at(c.curve, stack[top - 1], at);
            v = at[0];
        } else if (operands == 1) {
            v = mt_op_value(c.op, stack[top - 1], 0.0);
        } else if (operands == 2) {
            v = mt_op_value(c.op, stack[top - 2], stack[top - 1]);
        }
        top -= operands;
        stack[top++] = v;
    }
    if (top != 1) {
        return false;
    }
    *value = none ? nan("") : stack[0];
    return true;
}
