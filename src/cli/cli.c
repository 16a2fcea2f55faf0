/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the commands share: how they say what went wrong, and facts that several tell. */
#include "cli/cli.h"

#include "mechanics/redundant.h"

int mt_cli_failed(mt_status rc, const mt_err *err)
{
    mt_terminal_error("%s", err->text);
    if (rc == MT_E_MEMORY) {
        mt_terminal_drop();
    }
    return mt_exit_of(rc);
}

int mt_cli_loaded(mt_status rc, mt_diagnostics *messages, const mt_err *err)
{
    const bool told = mt_diagnostics_first_error(messages) >= 0;
    mt_err shortage = {.code = MT_OK};
    if (messages->lines.failed && rc != MT_E_MEMORY) { /* some of them are missing */
        rc = mt_fail_memory(&shortage);
        err = &shortage;
    }
    mt_terminal_diagnostics(mt_diagnostics_text(messages));
    mt_diagnostics_free(messages);
    if (rc != MT_OK && !(told && rc == MT_E_INPUT)) {
        return mt_cli_failed(rc, err);
    }
    return mt_exit_of(rc);
}

void mt_cli_place(const mt_study *study, const char *path, mt_status rc, mt_err *err,
                  mt_diagnostics *messages)
{
    const mt_study_place *const found =
        rc == MT_E_INPUT ? mt_study_locate(study, err->text) : NULL;
    if (found == NULL) {
        (void)mt_err_in(err, rc, "%s", path);
        return;
    }
    const mt_diagnostic_place place = {
        .file = path, .line = found->line, .column = found->column};
    mt_diagnostics_add(messages, MT_SEVERITY_ERROR, &place, err->text);
}

mt_io_options mt_cli_io(const mt_args *args)
{
    const mt_io_options opt = {.root = args->value[MT_OPT_ROOT]};
    return opt;
}

int mt_cli_json_done(mt_json_writer *w)
{
    if (mt_json_done(w)) {
        return MT_EXIT_DONE;
    }
    if (!w->misused) {
        return MT_EXIT_SYSTEM; /* mt_terminal_put tells */
    }
    mt_terminal_error("the output cannot be written as JSON");
    return MT_EXIT_NUMERICAL;
}

void mt_cli_json_failed(mt_json_writer *w, const char *configuration, const mt_err *err)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "configuration", configuration);
    mt_json_put_string(w, "error", err->text);
    mt_json_close(w);
}

void mt_cli_print_warnings(const mt_warning_list *list, mt_text *out)
{
    for (int i = 0; i < list->n; i++) {
        const mt_warning *const d = &list->items[i];
        mt_text_addf(out, "  %s: %s\n", d->level == MT_LEVEL_WARNING ? "doubtful" : "note",
                     d->text);
    }
}

void mt_cli_json_dead_centre(mt_json_writer *w, const mt_nearness *nearness)
{
    if (!nearness->near) {
        mt_json_put_null(w, "dead_centre");
        return;
    }
    mt_json_open(w, "dead_centre", '{');
    mt_json_put_number(w, "distance", nearness->distance);
    mt_json_put_number(w, "independence", nearness->independence);
    mt_cli_json_joints(w, "joints", &nearness->joints);
    mt_json_close(w);
}

void mt_cli_json_joints(mt_json_writer *w, const char *member, const mt_joint_names *joints)
{
    mt_json_open_flat(w, member, '[');
    for (int i = 0; i < joints->n; i++) {
        mt_json_put_string(w, NULL, joints->name[i]);
    }
    mt_json_close(w);
}

mt_status mt_cli_json_redundant(mt_json_writer *w, mt_linear *lin, mt_arena *mem, mt_err *err)
{
    mt_json_open(w, "redundant_constraints", '[');
    for (int k = 0; k < mt_linear_redundant(lin); k++) {
        mt_joint_names joints;
        MT_TRY(mt_linear_redundant_set(lin, k, mem, &joints, err));
        mt_cli_json_joints(w, NULL, &joints);
    }
    mt_json_close(w);
    return MT_OK;
}

mt_status mt_cli_recommendation(const mt_args *args, const mt_result *result,
                                const mt_recommendation **out, mt_err *err)
{
    const int n = result->n_recommendations;
    for (int i = 0; i < n; i++) {
        if (result->recommendations[i].rank == args->rank) {
            *out = &result->recommendations[i];
            return MT_OK;
        }
    }
    return mt_fail(err, MT_E_USAGE, "%s has %d recommendation%s: there is no rank %d",
                   args->operands[0], n, n == 1 ? "" : "s", args->rank);
}
