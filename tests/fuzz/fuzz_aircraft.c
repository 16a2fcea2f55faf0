/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any bytes as a catalogue of aircraft, read by itself and by a study whose rotor is to be
 * found in it. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/fuzz.h"
#include "environment/aircraft.h"
#include "io/options.h"
#include "io/write_json.h"
#include "study/read.h"

/* The study names what the catalogue lists first. */
static void use(const char *name)
{
    mt_text text = {0};
    mt_diagnostics said = {.count = 0};
    mt_study *study = NULL;
    mt_err err = {.code = MT_OK};
    const mt_io_options opt = {.root = "/"};
    mt_json_writer w = mt_json_writer_default(&text);
    mt_json_open(&w, NULL, '{');
    mt_json_put_string(&w, "format", "modetune-study/1");
    mt_json_put_string(&w, "model", "../problems/six_masses.json");
    mt_json_put_string(&w, "aircraft", "aircraft.json");
    mt_json_open(&w, "goals", '[');
    mt_json_open(&w, NULL, '{');
    mt_json_put_string(&w, "type", "avoid");
    mt_json_open(&w, "rotor", '{');
    mt_json_put_string(&w, "aircraft", name);
    mt_json_open(&w, "harmonics", '[');
    mt_json_put_string(&w, NULL, "1P");
    mt_json_put_string(&w, NULL, "nP");
    mt_json_put_string(&w, NULL, "nT");
    mt_json_close(&w);
    mt_json_close(&w);
    mt_json_put_number(&w, "margin_percent", 10.0);
    mt_json_close(&w);
    mt_json_close(&w);
    mt_json_close(&w);
    DEMAND(mt_json_done(&w));
    const char *const path = fuzz_write("study.json", (const uint8_t *)text.s, text.length);
    const mt_status rc = mt_study_load(path, &opt, &study, &said, &err);
    if (rc != MT_OK) {
        DEMAND(rc == MT_E_INPUT && study == NULL);
        DEMAND(mt_hostile_diagnosed(said.lines.s, said.lines.length));
    }
    mt_study_delete(study);
    mt_diagnostics_free(&said);
    mt_text_free(&text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    mt_arena mem = {0};
    mt_aircraft_list list = {0};
    mt_diagnostics said = {.count = 0};
    mt_err err = {.code = MT_OK};
    const char *const path = fuzz_write("aircraft.json", data, size);
    const mt_status rc = mt_aircraft_load(path, NULL, &mem, &list, &said, &err);
    if (rc != MT_OK) {
        DEMAND(rc == MT_E_INPUT && err.text[0] != '\0');
        DEMAND(mt_hostile_diagnosed(said.lines.s, said.lines.length));
    }
    for (int i = 0; rc == MT_OK && i < list.n; i++) {
        DEMAND(list.items[i].name.s != NULL && list.items[i].name.s[0] != '\0');
        DEMAND(isfinite(list.items[i].main_rotor.speed.value));
    }
    if (rc == MT_OK && list.n > 0) {
        use(list.items[0].name.s);
    }
    mt_diagnostics_free(&said);
    mt_arena_free(&mem);
    return 0;
}
