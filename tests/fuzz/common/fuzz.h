/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the fuzz targets share. A broken promise stops the fuzzer, in every build type. */
#ifndef TESTS_FUZZ_FUZZ_H
#define TESTS_FUZZ_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/text.h"
#include "support/mt_hostile.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define DEMAND(holds)                                \
    do {                                             \
        if (!(holds)) {                              \
            fuzz_broken(#holds, __FILE__, __LINE__); \
        }                                            \
    } while (0)
_Noreturn void fuzz_broken(const char *text, const char *file, int line);
/* No number that is not finite shows in a text ("nan", "-inf" as words), unless such a word
 * stands in the input itself. */
void fuzz_requirement_finite_words(const mt_text *said, const uint8_t *data, size_t size);
/* Is this a status that a file may cause? (Not an internal error, not wrong use.) */
bool fuzz_is_refusal(mt_status rc);

/* A folder of our own, made when first asked for and removed at exit, with links to the tree's
 * problems and tests. Files in it are written by fuzz_write. */
const char *fuzz_folder(void);
/* Write bytes to folder/name; the path, valid until the next call with the same name. */
const char *fuzz_write(const char *name, const uint8_t *data, size_t size);

/*
 * Mutants of JSON by node (mutate.c): a value is replaced (by an extreme one, by another of the
 * same or of another text), deleted, doubled, exchanged, wrapped, renamed, a number scaled.
 * Works on any bytes; texts that are no JSON are mutated as far as brackets and quotes are
 * found.
 * @param[in]     random  called with n >= 1: a number below n
 *   @param[in,out] data    size bytes, room for max
 * @param[in]     other   another text of other_size bytes to take from; NULL: none
 *   Returns the new size, at most max.
 */
typedef struct fuzz_random {
    uint64_t state;
} fuzz_random;
fuzz_random fuzz_random_seed(uint64_t seed);
size_t fuzz_below(fuzz_random *r, size_t n);
size_t fuzz_mutate(fuzz_random *r, uint8_t *data, size_t size, size_t max, const uint8_t *other,
                   size_t other_size);

#endif
