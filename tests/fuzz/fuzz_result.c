/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any bytes as a result: what is read of it is written, shown and applied to the model that it
 * names. */
#include <math.h>
#include <string.h>

#include "cli/cli.h"
#include "common/fuzz.h"
#include "io/json.h"
#include "report/page.h"
#include "report/summary.h"
#include "result/read.h"
#include "result/write.h"

static void show(const mt_result *r)
{
    mt_text said = {0};
    mt_table designs = mt_report_designs(r);
    mt_err err = {.code = MT_OK};
    mt_json *doc = NULL;
    mt_table_csv(&designs, &said);
    mt_table_free(&designs);
    mt_report_summary(r, true, 0, &said);
    mt_report_html_told(r, &said);
    DEMAND(!said.failed);
    mt_text_free(&said);
    DEMAND(mt_result_write(r, &said, &err) == MT_OK);
    DEMAND(mt_json_parse(said.s, said.length, &doc, &err) == MT_OK);
    mt_json_delete(doc);
    mt_text_free(&said);
}

/* modetune apply RESULT --model MODEL: done, or refused; the new model is a JSON text. */
static void apply(const char *path)
{
    char program[] = "modetune";
    char command[] = "apply";
    char model[] = "--model=" MT_TEST_SOURCE_DIR "/problems/six_masses.json";
    char quiet[] = "--quiet";
    char result[512];
    char *const argv[] = {program, command, result, model, quiet, NULL};
    mt_args args;
    mt_err err = {.code = MT_OK};
    mt_text out = {0};
    mt_json *doc = NULL;
    const size_t length = strlen(path);
    DEMAND(length < sizeof result);
    memcpy(result, path, length + 1);
    DEMAND(mt_args_parse(MT_COUNT(argv) - 1, argv, mt_commands, &args, &err) == MT_OK);
    const int code = mt_command_apply.run(&args, &out);
    DEMAND(code == MT_EXIT_DONE || code == MT_EXIT_GOALS || code == MT_EXIT_INPUT);
    if (code == MT_EXIT_DONE) {
        DEMAND(mt_json_parse(out.s, out.length, &doc, &err) == MT_OK);
    }
    mt_json_delete(doc);
    mt_text_free(&out);
    mt_args_free(&args);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    mt_result *result = NULL;
    mt_diagnostics said = {.count = 0};
    mt_err err = {.code = MT_OK};
    const char *const path = fuzz_write("result.json", data, size);
    const mt_status rc = mt_result_load(path, NULL, &result, &said, &err);
    if (rc != MT_OK) {
        DEMAND(rc == MT_E_INPUT && result == NULL && err.text[0] != '\0');
        DEMAND(mt_hostile_diagnosed(said.lines.s, said.lines.length));
    } else {
        show(result);
        apply(path);
    }
    mt_diagnostics_free(&said);
    mt_result_delete(result);
    return 0;
}
