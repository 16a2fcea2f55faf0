/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune report: a result read back and told again, from itself alone; where its model is
 * found, pages show the mechanism, too. */
#include <stdlib.h>

#include "cli/cli.h"
#include "cli/find_model.h"
#include "cli/save.h"
#include "library/scene_designs.h"

/* The scene of the result's designs, where the model that was solved is found. Fails:
 * MT_E_MEMORY, MT_E_SYSTEM (a candidate cannot be read: the page would differ). */
static mt_status find_scene(const mt_args *args, const mt_result *result, mt_text *scene,
                            mt_err *err)
{
    const mt_io_options opt = mt_cli_io(args);
    mt_file file = {.bytes = NULL};
    char *path = NULL;
    mt_model *model = NULL;
    mt_diagnostics messages = {.count = 0};
    mt_err why = {.code = MT_OK};
    mt_status rc = mt_find_model(args, result, &file, &path, &why);
    rc = rc == MT_OK ? mt_model_load(path, &opt, &model, &messages, &why) : rc;
    rc = rc == MT_OK ? mt_scene_of_result(model, result, 1, scene, &why) : rc;
    mt_diagnostics_free(&messages);
    mt_model_delete(model);
    mt_file_free(&file);
    free(path);
    return mt_is_final(rc) || rc == MT_E_SYSTEM ? mt_fail(err, rc, "%s", why.text) : MT_OK;
}

int mt_cmd_report(const mt_args *args, mt_text *out)
{
    const mt_io_options opt = mt_cli_io(args);
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_result *result = NULL;
    mt_text scene = {.s = NULL};
    mt_status rc = mt_result_load(args->operands[0], &opt, &result, &messages, &err);
    int code = mt_cli_loaded(rc, &messages, &err);
    if (rc == MT_OK && (args->format == MT_FORMAT_HTML || args->given[MT_OPT_OUTPUT])) {
        rc = find_scene(args, result, &scene, &err);
        code = rc == MT_OK ? code : mt_cli_failed(rc, &err);
    }
    if (rc == MT_OK) {
        mt_json_writer w = mt_json_writer_default(out);
        mt_save_print(args, result, scene.s, &w, out);
        code = args->format == MT_FORMAT_JSON ? mt_cli_json_done(&w) : MT_EXIT_DONE;
    }
    if (rc == MT_OK && args->given[MT_OPT_OUTPUT]) {
        code = mt_exit_worse(code, mt_save_again(args, args->operands[0], result, scene.s));
    }
    mt_text_free(&scene);
    mt_result_delete(result);
    return code;
}
