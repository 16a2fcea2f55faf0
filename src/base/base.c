/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Status and error, arguments and options of public functions, and what the library was built
 * from. */
#include "base/base.h"

#include "modetune/version.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "base/build_info.h"
#include "base/format.h"

/* Arguments. */

mt_status mt_check_argument(const void *argument, const char *function, const char *name,
                            mt_err *err)
{
    return argument != NULL ? MT_OK
                            : mt_fail(err, MT_E_USAGE, "%s: %s is NULL", function, name);
}

/* Status and error. */

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

/* Options. */

enum { MOST_BYTES = 4096 }; /* of a struct of options: more is a size that was not set */

mt_status mt_options_take(const char *function, const void *given, size_t size, void *out,
                          mt_err *err)
{
    size_t theirs = 0;
    memset(out, 0, size);
    if (given != NULL) {
        memcpy(&theirs, given, sizeof theirs);
        if (theirs < sizeof theirs || theirs > MOST_BYTES) {
            return mt_fail(err, MT_E_USAGE, "%s: the size of the options is not set", function);
        }
        memcpy(out, given, theirs < size ? theirs : size);
        for (size_t i = size; i < theirs; i++) {
            if (((const unsigned char *)given)[i] != 0) {
                return mt_fail(err, MT_E_USAGE,
                               "%s: an option is set that this version of the library does not "
                               "know",
                               function);
            }
        }
    }
    memcpy(out, &size, sizeof size);
    return MT_OK;
}

/* Version and build. */

const char *mt_version(void)
{
    return MT_VERSION_STRING;
}

/* made again by every build, and changed where the commit differs */

const char *mt_build_commit(void)
{
    return MT_BUILD_COMMIT;
}

const char *mt_build_compiler(void)
{
    return MT_BUILD_COMPILER;
}
