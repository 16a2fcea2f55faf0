/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Any bytes as a model file: they are refused with messages that have a place, or become a
 * model. Whatever happens, the messages are lines of visible text.
 */
#include "common/fuzz.h"
#include "io/json.h"
#include "model/read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    mt_json *doc = NULL;
    mt_model *model = NULL;
    mt_diagnostics said = {.count = 0};
    mt_status rc = mt_json_parse((const char *)data, size, &doc, NULL);
    DEMAND(rc == MT_OK || rc == MT_E_INPUT);
    if (rc == MT_OK) {
        rc = mt_model_from_json(doc, "f", &model, NULL);
        DEMAND(rc == MT_OK || rc == MT_E_INPUT);
    }
    mt_json_report(doc, "f", &said);
    DEMAND((rc == MT_OK) == (mt_json_diags(doc)->errors == 0));
    DEMAND(rc == MT_OK || said.lines.length > 0);
    DEMAND(mt_hostile_visible(said.lines.s, said.lines.length));
    mt_diagnostics_free(&said);
    mt_model_delete(model);
    mt_json_delete(doc);
    return 0;
}
