/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdbool.h>
#include <string.h>

#include "base/base.h"
#include "base/format.h"

#define TEXT_CASE(name, text) \
    case name:                \
        return text;
#define NAME_CASE(name, text) \
    case name:                \
        return #name;

const char *mt_status_text(mt_status code)
{
    switch (code) {
        MT_STATUS_LIST(TEXT_CASE)
    case MT_STATUS_COUNT:
        break;
    }
    return "unknown status";
}

const char *mt_status_name(mt_status code)
{
    switch (code) {
        MT_STATUS_LIST(NAME_CASE)
    case MT_STATUS_COUNT:
        break;
    }
    return "MT_STATUS_UNKNOWN";
}

static bool is_continuation(char c)
{
    return ((unsigned char)c & 0xC0U) == 0x80U;
}

/* Copy src into dst[MT_ERR_TEXT_SIZE]; text that does not fit ends before a UTF-8 character,
 * not in it. */
static void copy_cut(char *dst, const char *src)
{
    size_t n = strlen(src);
    if (n >= MT_ERR_TEXT_SIZE) {
        n = MT_ERR_TEXT_SIZE - 1;
        while (n > 0 && is_continuation(src[n])) {
            n--;
        }
    }
    memcpy(dst, src, n);
    dst[n] = '\0';
}

/* The buffers are longer than err->text by a whole UTF-8 character, so that copy_cut sees where
 * it begins. Formatting goes through them because the arguments may point into err->text. */
enum { BUFFER_SIZE = MT_ERR_TEXT_SIZE + 4 };

mt_status mt_fail(mt_err *err, mt_status code, const char *fmt, ...)
{
    if (err == NULL) {
        return code;
    }
    char text[BUFFER_SIZE];
    va_list args;
    va_start(args, fmt);
    if (fmt == NULL || mt_vsnprintf(text, sizeof text, fmt, args) < 0) {
        text[0] = '\0';
    }
    va_end(args);
    err->code = code;
    copy_cut(err->text, fmt == NULL ? mt_status_text(code) : text);
    return code;
}

mt_status mt_err_in(mt_err *err, mt_status rc, const char *fmt, ...)
{
    if (err == NULL || rc == MT_OK || fmt == NULL) {
        return rc;
    }
    char text[BUFFER_SIZE];
    va_list args;
    va_start(args, fmt);
    int n = mt_vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    if (n < 0) {
        return rc;
    }
    if (n < BUFFER_SIZE - 1) {
        (void)mt_snprintf(text + n, sizeof text - (size_t)n, ": %s", err->text);
    }
    copy_cut(err->text, text);
    return rc;
}
