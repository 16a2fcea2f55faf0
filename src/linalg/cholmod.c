/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "linalg/cholmod.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdbool.h>
#include <string.h>

#include "base/arena.h"

#define TEXT_OF(x) #x
#define TEXT(x)    TEXT_OF(x)
/* Of the headers' own interface: its major version is the library's. */
#define LIBRARY "libcholmod.so." TEXT(CHOLMOD_MAIN_VERSION)

/* POSIX gives a function's address as a pointer to an object, which ISO C does not convert. */
static bool find_library_symbol(void *library, const char *name, void *function)
{
    void *const address = dlsym(library, name);
    memcpy(function, (const void *)&address, sizeof address);
    return address != NULL;
}

/* Status from the loader's text, the only report it gives; a lack of memory is recognised in
 * it. */
static mt_status failed(mt_err *err)
{
    const char *const said = dlerror();
    if (said == NULL || strstr(said, "out of memory") != NULL ||
        strstr(said, strerror(ENOMEM)) != NULL) {
        return mt_fail_memory(err);
    }
    return mt_fail(err, MT_E_INTERNAL, "CHOLMOD, which large mechanisms need: %s", said);
}

mt_status mt_cholmod_load(mt_cholmod *cholmod, mt_err *err)
{
    void *const library = dlopen(LIBRARY, RTLD_NOW | RTLD_LOCAL);
    if (library == NULL || !find_library_symbol(library, "cholmod_start", &cholmod->start) ||
        !find_library_symbol(library, "cholmod_analyze", &cholmod->analyze) ||
        !find_library_symbol(library, "cholmod_analyze_p", &cholmod->analyze_p) ||
        !find_library_symbol(library, "cholmod_free_factor", &cholmod->free_factor) ||
        !find_library_symbol(library, "cholmod_finish", &cholmod->finish)) {
        return failed(err);
    }
    return MT_OK;
}
