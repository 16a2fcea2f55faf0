/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune run and modes: how often each stage of the evaluations was done. */
#include "cli/profile.h"

#include "cli/cli.h"
#include "report/table.h"

static const double NANOSECOND = 1e-9;

/* Digits of a time. */
enum { DIGITS = 3 };

mt_profile *mt_cli_profile(const mt_args *args, mt_profile *own)
{
    if (!args->given[MT_OPT_PROFILE]) {
        return NULL;
    }
    mt_profile_init(own, mt_terminal_seconds);
    return own;
}

int mt_cli_profile_print(mt_profile *p)
{
    if (p == NULL) {
        return MT_EXIT_DONE;
    }
    mt_text text = {.s = NULL};
    mt_table t = mt_table_default();
    int code = MT_EXIT_DONE;
    mt_table_column(&t, "stage", "stage", MT_ALIGN_LEFT);
    mt_table_column(&t, "done", "done", MT_ALIGN_RIGHT);
    mt_table_column(&t, "shared", "shared", MT_ALIGN_RIGHT);
    mt_table_column(&t, "skipped", "skipped", MT_ALIGN_RIGHT);
    mt_table_column(&t, "time [s]", "time_s", MT_ALIGN_POINT);
    mt_table_column(&t, "what it is", "what", MT_ALIGN_LEFT);
    for (int i = 0; i < MT_STAGES; i++) {
        mt_table_text(&t, mt_stage_name((mt_stage_id)i));
        mt_table_integer(&t, atomic_load(&p->done[i]));
        mt_table_integer(&t, atomic_load(&p->shared[i]));
        mt_table_integer(&t, atomic_load(&p->skipped[i]));
        mt_table_number(&t, NANOSECOND * (double)atomic_load(&p->nanoseconds[i]), DIGITS);
        mt_table_text(&t, mt_stage_text((mt_stage_id)i));
    }
    mt_table_print(&t, 2, mt_terminal_width(), &text);
    if (text.failed) {
        mt_err err;
        code = mt_cli_failed(mt_fail_memory(&err), &err);
    } else {
        mt_terminal_diagnostics(text.s);
    }
    mt_table_free(&t);
    mt_text_free(&text);
    return code;
}
