/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Any bytes as a file of measured frequency responses, and some that are like them: mutants of
 * JSON, which other targets get, change little of a table or a universal file.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/fuzz.h"
#include "io/options.h"
#include "measurement/read.h"

enum { LIKE_THEM = 12 };

static void requirement_response(const mt_measured_response *r)
{
    DEMAND(isnan(r->si) || (isfinite(r->si) && r->si >= 0.0));
    for (int i = 0; i < r->n_lines; i++) {
        const mt_measured_line *const l = &r->lines[i];
        DEMAND(isfinite(l->frequency_hz) && l->frequency_hz > 0.0 && l->line > 0);
        DEMAND(i == 0 || l->frequency_hz > r->lines[i - 1].frequency_hz);
        DEMAND(isfinite(l->re) && isfinite(l->im));
        DEMAND(isnan(l->coherence) || (l->coherence >= 0.0 && l->coherence <= 1.0));
    }
}

static void read_one(const uint8_t *data, size_t size)
{
    mt_arena mem = {0};
    mt_measurement m = {.read = false};
    mt_diagnostics said = {.count = 0};
    mt_err err = {.code = MT_OK};
    char sha256[MT_SHA256_TEXT];
    const mt_io_options opt = {.root = "/"};
    const char *const path = fuzz_write("measured", data, size);
    const mt_status rc = mt_measurement_load(path, &opt, &mem, &m, sha256, &said, &err);
    if (rc != MT_OK) {
        DEMAND(rc == MT_E_INPUT && err.text[0] != '\0' && !m.read && said.count == 1);
        DEMAND(mt_hostile_diagnosed(said.lines.s, said.lines.length));
    } else {
        DEMAND(m.read && m.n_responses > 0 && said.count == 0);
        for (int i = 0; i < m.n_responses; i++) {
            requirement_response(&m.responses[i]);
        }
        DEMAND(strlen(mt_measured_list_text(&m, &mem)) > 0 || m.responses[0].dataset > 0);
    }
    mt_diagnostics_free(&said);
    mt_arena_free(&mem);
}

/* A byte changed, lines cut off, or a stretch of it written twice. */
static size_t change(fuzz_random *r, uint8_t *data, size_t size)
{
    static const char bytes[] = "-+.,;\"\n\r\t #0159eEnaN\xff";
    const size_t at = fuzz_below(r, size);
    const size_t length = 1 + fuzz_below(r, size - at);
    switch (fuzz_below(r, 4)) {
    case 0:
        return at;
    case 1:
        memmove(data + at, data + at + length, size - at - length);
        return size - length;
    case 2:
        memmove(data + size, data + at, length);
        return size + length;
    default:
        data[at] = (uint8_t)bytes[fuzz_below(r, sizeof bytes)];
        return size;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_random r = fuzz_random_seed(size);
    read_one(data, size);
    uint8_t *const own = malloc((2 * size) + 1);
    for (int i = 0; i < LIKE_THEM && own != NULL && size > 0; i++) {
        memcpy(own, data, size);
        read_one(own, change(&r, own, size));
    }
    free(own);
    return 0;
}
