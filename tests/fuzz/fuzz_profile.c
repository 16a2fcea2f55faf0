/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any bytes as a profile of vibration, and what it does to a mass. */
#include <math.h>

#include "common/fuzz.h"
#include "environment/vibration.h"
#include "io/options.h"
#include "vibration/profile_response.h"

enum { MOST_PARTS = 20 };

/* More of them take longer and tell nothing else. */
static void respond(const mt_vibration *v)
{
    mt_arena mem = {0};
    mt_vibration_response r;
    double complex s[2];
    double complex residue[2];
    if (v->n_random > MOST_PARTS || v->n_tones > MOST_PARTS) {
        return;
    }
    const mt_pole_sum h = mt_vibration_respond_one_mass(22.0, 0.02, s, residue);
    DEMAND(mt_vibration_respond(v, &h, &mem, &r, NULL) == MT_OK);
    DEMAND(r.end == MT_FORCED_FINITE && isfinite(r.peak) && r.peak >= 0.0);
    DEMAND(isfinite(r.rms_bound) && r.rms_bound >= 0.0);
    for (int i = 0; i < r.n_tones; i++) {
        DEMAND(isfinite(r.tones[i].value) && isfinite(r.tones[i].excess));
    }
    mt_arena_free(&mem);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    mt_vibration *v = NULL;
    mt_diagnostics said = {.count = 0};
    mt_err err = {.code = MT_OK};
    const mt_io_options opt = {.root = "/"};
    const char *const path = fuzz_write("profile.json", data, size);
    const mt_status rc = mt_vibration_load(path, &opt, &v, &said, &err);
    if (rc != MT_OK) {
        DEMAND(rc == MT_E_INPUT && err.text[0] != '\0' && v == NULL);
        DEMAND(mt_hostile_diagnosed(said.lines.s, said.lines.length));
    } else {
        for (int i = 0; i < v->n_random; i++) {
            DEMAND(v->random[i].psd.n >= 2 && v->random[i].rms > 0.0);
        }
        for (int i = 0; i < v->n_tones; i++) {
            DEMAND(v->tones[i].lower_hz > 0.0 && v->tones[i].lower_hz <= v->tones[i].upper_hz);
        }
        respond(v);
    }
    mt_vibration_delete(v);
    mt_diagnostics_free(&said);
    return 0;
}
