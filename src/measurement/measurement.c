/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measurement/measurement.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"

enum { DIGITS_MOST = 9 }; /* of the number of a node */
enum { NUMBER_TEXT = 64, REFUSAL_TEXT = 512 };
enum { LISTED_MOST = 10, FREEDOM_TEXT = 24 };

mt_measurement mt_measurement_default(mt_name name, mt_addr addr)
{
    return (mt_measurement){.name = name, .factor = nan(""), .addr = addr};
}

static bool read_axis(const char **s, int *direction)
{
    static const char axes[] = "XYZ";
    const bool turns = (*s)[0] == 'R' || (*s)[0] == 'r';
    const char letter = (*s)[turns ? 1 : 0];
    const char upper = (char)(letter >= 'a' && letter <= 'z' ? letter - 'a' + 'A' : letter);
    const char *const at = upper == '\0' ? NULL : strchr(axes, upper);
    if (at == NULL) {
        return false;
    }
    *direction = (int)(at - axes) + (turns ? 4 : 1);
    *s += turns ? 2 : 1;
    return true;
}

static int read_sign(const char **s)
{
    const char c = **s;
    *s += c == '+' || c == '-' ? 1 : 0;
    return c == '-' ? -1 : c == '+' ? 1 : 0;
}

bool mt_measured_freedom_parse(const char *text, mt_measured_freedom *out)
{
    const char *s = text;
    *out = (mt_measured_freedom){0};
    if (*s < '0' || *s > '9') {
        return false;
    }
    for (; *s >= '0' && *s <= '9'; s++) {
        if (s - text == DIGITS_MOST) {
            return false;
        }
        out->node = (10 * out->node) + (*s - '0');
    }
    if (*s == '\0') {
        return true;
    }
    const int before = read_sign(&s);
    if (!read_axis(&s, &out->direction)) {
        return false;
    }
    const int behind = read_sign(&s);
    if (*s != '\0' || (before != 0 && behind != 0)) {
        return false;
    }
    out->direction *= before + behind < 0 ? -1 : 1;
    return true;
}

/* "12+Z": a node, and a direction with its sign in front. */
static void freedom_text(const mt_measured_freedom *f, char text[FREEDOM_TEXT])
{
    static const char *const names[] = {"", "X", "Y", "Z", "RX", "RY", "RZ"};
    const int axis = f->direction < 0 ? -f->direction : f->direction;
    (void)mt_snprintf(text, FREEDOM_TEXT, "%d%s%s", f->node,
                      f->direction < 0   ? "-"
                      : f->direction > 0 ? "+"
                                         : "",
                      axis < MT_COUNT(names) ? names[axis] : "?");
}

bool mt_measured_is_response(const mt_measured_response *r)
{
    return r->dataset == 0 || r->function == MT_FUNCTION_RESPONSE ||
           r->function == MT_FUNCTION_TRANSMISSIBILITY;
}

/* "dataset 3: 12+Z by 1+Z", "installed: grip.x:acceleration by grip.x" */
static const char *response_text(const mt_measured_response *r, mt_arena *mem)
{
    char a[FREEDOM_TEXT];
    char b[FREEDOM_TEXT];
    if (r->dataset == 0) {
        return mt_arena_printf(
            mem, "%s%s%s by %s", r->configuration == NULL ? "" : r->configuration,
            r->configuration == NULL ? "" : ": ", r->output == NULL ? "an output" : r->output,
            r->input == NULL ? "an input" : r->input);
    }
    freedom_text(&r->response, a);
    freedom_text(&r->reference, b);
    return mt_arena_printf(mem, "dataset %d: %s by %s", r->dataset, a, b);
}

const char *mt_measured_list_text(const mt_measurement *m, mt_arena *mem)
{
    const char *text = "";
    int listed = 0;
    for (int i = 0; i < m->n_responses && text != NULL && listed < LISTED_MOST; i++) {
        if (mt_measured_is_response(&m->responses[i])) {
            const char *const one = response_text(&m->responses[i], mem);
            text = mt_arena_printf(mem, "%s%s%s", text, listed++ > 0 ? "; " : "",
                                   one == NULL ? "" : one);
        }
    }
    return text == NULL ? "" : text;
}

/* What readers of tables and of universal files have in common. */

mt_status mt_measuring_refuse(mt_measuring *m, int line, int column, const char *fmt, ...)
{
    char text[REFUSAL_TEXT];
    va_list args;
    va_start(args, fmt);
    (void)mt_vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    if (m->messages != NULL) {
        const mt_diagnostic_place place = {.file = m->path, .line = line, .column = column};
        mt_diagnostics_add(m->messages, MT_SEVERITY_ERROR, &place, text);
    }
    return mt_fail(m->err, MT_E_INPUT, "%s:%d:%d: %s", m->path, line, column, text);
}

bool mt_measuring_newline(mt_measuring *m)
{
    if (m->at >= m->end || (*m->at != '\n' && *m->at != '\r')) {
        return false;
    }
    m->at += m->at[0] == '\r' && m->at + 1 < m->end && m->at[1] == '\n' ? 2 : 1;
    m->line++;
    m->start_of_line = m->at;
    return true;
}

int mt_measuring_column(const mt_measuring *m)
{
    return (int)(m->at - m->start_of_line) + 1;
}

static size_t digits(const char *s, size_t length, size_t *at)
{
    const size_t first = *at;
    while (*at < length && s[*at] >= '0' && s[*at] <= '9') {
        (*at)++;
    }
    return *at - first;
}

static void skip_sign(const char *s, size_t length, size_t *at)
{
    *at += *at < length && (s[*at] == '+' || s[*at] == '-') ? 1 : 0;
}

/* [sign] digits [. digits] [exponent]; no "nan", no hexadecimal digits. */
static bool is_decimal(const char *s, size_t length)
{
    size_t at = 0;
    skip_sign(s, length, &at);
    size_t n = digits(s, length, &at);
    if (at < length && s[at] == '.') {
        at++;
        n += digits(s, length, &at);
    }
    if (n > 0 && at < length && (s[at] == 'e' || s[at] == 'E')) {
        at++;
        skip_sign(s, length, &at);
        n = digits(s, length, &at);
    }
    return n > 0 && at == length;
}

bool mt_measuring_number(const char *text, size_t length, double *out)
{
    char own[NUMBER_TEXT];
    *out = nan("");
    if (length == 0 || length >= sizeof own) {
        return false;
    }
    for (size_t i = 0; i < length; i++) {
        const bool power = text[i] == 'D' || text[i] == 'd';
        own[i] = (char)(power ? 'E' : text[i]);
    }
    own[length] = '\0';
    if (!is_decimal(own, length)) {
        return false;
    }
    *out = strtod(own, NULL);
    return isfinite(*out);
}

mt_measured_response *mt_measuring_response(mt_measuring *m)
{
    mt_measurement *const out = m->out;
    mt_measured_response *const list = mt_arena_grow(m->mem, out->responses, out->n_responses,
                                                     &out->cap_responses, sizeof *list);
    if (list == NULL) {
        return NULL;
    }
    out->responses = list;
    list[out->n_responses] = (mt_measured_response){.si = 1.0};
    return &list[out->n_responses++];
}

mt_status mt_measuring_add(mt_measuring *m, mt_measured_response *r,
                           const mt_measured_line *line, int column)
{
    const double f = line->frequency_hz;
    if (!(f >= 0.0)) {
        return mt_measuring_refuse(m, line->line, column,
                                   "a frequency must not be below 0, as %.10g Hz is", f);
    }
    if (r->n_lines > 0 && !(f > r->lines[r->n_lines - 1].frequency_hz)) {
        return mt_measuring_refuse(m, line->line, column,
                                   "frequencies must ascend: %.10g Hz follows %.10g Hz", f,
                                   r->lines[r->n_lines - 1].frequency_hz);
    }
    if (f == 0.0) {
        return MT_OK;
    }
    mt_measured_line *const lines =
        mt_arena_grow(m->mem, r->lines, r->n_lines, &r->cap_lines, sizeof *lines);
    if (lines != NULL) {
        r->lines = lines;
        lines[r->n_lines++] = *line;
    }
    return mt_arena_check(m->mem, m->err);
}
