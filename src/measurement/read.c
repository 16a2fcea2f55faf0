/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measured frequency responses: what tables and universal files have in common. */
#include "measurement/read.h"

#include "measurement/read_priv.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "io/locale.h"

enum { NUMBER_TEXT = 64, REFUSAL_TEXT = 512 };

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

/* True where the text begins as a universal file, with a line "-1". */
static bool is_universal(const char *s)
{
    s += strspn(s, " \t\r\n");
    return s[0] == '-' && s[1] == '1' && strchr(" \t\r\n", s[2]) != NULL;
}

/* Any file; err is m's. */
static mt_status read_measurement_text(void *context, mt_err *err)
{
    mt_measuring *const m = context;
    m->err = err;
    m->begin = m->at;
    if (is_universal(m->at)) {
        return mt_read_measurement_uff(m);
    }
    const char *const nul = memchr(m->at, '\0', (size_t)(m->end - m->at));
    if (nul != NULL) {
        return mt_measuring_refuse(m, 1, 1,
                                   "this is not text: neither a table (CSV) nor a universal "
                                   "file, which begins with a line \"-1\"");
    }
    return mt_read_measurement_csv(m);
}

mt_status mt_measurement_load(const char *path, const mt_io_options *opt, mt_arena *mem,
                              mt_measurement *out, char *sha256, mt_diagnostics *messages,
                              mt_err *err)
{
    mt_file file = {0};
    const size_t limit =
        opt->max_bytes == 0 ? (size_t)MT_MEASUREMENT_MAX_BYTES : opt->max_bytes;
    mt_status rc = mt_files_read(&opt->files, path, opt->root, limit, &file, err);
    if (rc == MT_OK) {
        mt_measuring m = {.path = path,
                          .at = file.bytes,
                          .end = file.bytes + file.length,
                          .start_of_line = file.bytes,
                          .line = 1,
                          .mem = mem,
                          .out = out,
                          .messages = messages};
        memcpy(sha256, file.sha256, sizeof file.sha256);
        rc = mt_locale_plain(read_measurement_text, &m, err);
        rc = rc == MT_OK ? mt_arena_check(mem, err) : rc;
        out->read = rc == MT_OK;
        if (messages != NULL && messages->lines.failed) {
            rc = mt_fail_memory(err);
        }
    }
    mt_file_free(&file);
    return rc;
}
