/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/options.h"

#include <string.h>

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
