/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The last stage: what the numbers are, in every configuration. Faults are errors, doubts
 * warnings; what several configurations share is said once. */
#include "model/resolve_priv.h"

#include <stddef.h>
#include <string.h>

#include "model/lint.h"
#include "model/values.h"

static bool is_told(const mt_warning_list *list, int n, const mt_warning *d)
{
    for (int i = 0; i < n; i++) {
        const mt_warning *const other = &list->items[i];
        if (other->addr == d->addr && strcmp(other->text, d->text) == 0) {
            return true;
        }
    }
    return false;
}

/* Report a warning, with the configuration where an override caused it. */
static void report_warning(mt_resolve *f, const mt_warning *d, const mt_configuration *c)
{
    const bool own = c->n_overrides > 0;
    const char *const in = own ? " in configuration \"" : "";
    if (d->level == MT_LEVEL_FAULT) {
        mt_diag_error(f->d, d->addr, "%s%s%s%s", d->text, in, own ? c->name.s : "",
                      own ? "\"" : "");
    } else if (d->level == MT_LEVEL_WARNING) {
        mt_diag_warning(f->d, d->addr, "%s%s%s%s", d->text, in, own ? c->name.s : "",
                        own ? "\"" : "");
    }
}

void mt_resolve_values(mt_resolve *f)
{
    mt_model *const m = f->m;
    mt_arena texts = {.first = NULL};
    mt_warning_list list = mt_warning_list_default(&texts);
    const bool sound = f->d->errors == 0;
    double *const value = mt_arena_f64(&texts, (size_t)m->n_nums, 1);
    bool ok = value != NULL;
    for (int pass = 0; pass < 2 && sound && ok; pass++) {
        for (int c = 0; c < m->n_configurations && ok; c++) {
            const bool own = m->configurations[c].n_overrides > 0;
            const int first = list.n;
            if (own != (pass == 1)) {
                continue; /* the file's own values first */
            }
            ok = mt_model_numbers(m, c, 0, NULL, NULL, &texts, value, NULL) == MT_OK;
            if (ok) {
                mt_model_lint(m, c, value, &list);
            }
            for (int i = first; i < list.n && ok; i++) {
                if (!is_told(&list, i, &list.items[i])) {
                    report_warning(f, &list.items[i], &m->configurations[c]);
                }
            }
        }
    }
    if (!ok || mt_arena_failed(&texts)) {
        mt_arena_fail(&m->mem);
    }
    mt_arena_free(&texts);
}
