/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libFuzzer's hooks: mutate by node most of the time, by bytes now and then; read the shipped
 * files as seeds. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/fuzz.h"

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max, unsigned seed);
size_t LLVMFuzzerCustomCrossOver(const uint8_t *data1, size_t size1, const uint8_t *data2,
                                 size_t size2, uint8_t *out, size_t max, unsigned seed);
int LLVMFuzzerInitialize(int *argc, char ***argv);

enum { BY_BYTES = 16 }; /* one in so many */

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max, unsigned seed)
{
    fuzz_random r = fuzz_random_seed(seed);
    return fuzz_below(&r, BY_BYTES) == 0 ? LLVMFuzzerMutate(data, size, max)
                                         : fuzz_mutate(&r, data, size, max, NULL, 0);
}

size_t LLVMFuzzerCustomCrossOver(const uint8_t *data1, size_t size1, const uint8_t *data2,
                                 size_t size2, uint8_t *out, size_t max, unsigned seed)
{
    fuzz_random r = fuzz_random_seed(seed);
    const size_t size = size1 < max ? size1 : max;
    memcpy(out, data1, size);
    return fuzz_mutate(&r, out, size, max, data2, size2);
}

static bool has_seeds(void)
{
    FILE *const f = fopen(MT_FUZZ_SEEDS, "r");
    const bool any = f != NULL && fgetc(f) != EOF;
    if (f != NULL) {
        (void)fclose(f);
    }
    return any;
}

/* The shipped files as seeds, before the options that the user gives. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    static char seeds[] = "-seed_inputs=@" MT_FUZZ_SEEDS;
    static char length[] = "-max_len=32768";
    const size_t n = (size_t)*argc;
    char **const more = malloc((n + 3) * sizeof *more);
    DEMAND(more != NULL);
    more[0] = (*argv)[0];
    more[1] = has_seeds() ? seeds : length;
    more[2] = length;
    memcpy(more + 3, *argv + 1, n * sizeof *more); /* the NULL behind the last as well */
    *argc += 2;
    *argv = more; /* lives as long as the program */
    return 0;
}
