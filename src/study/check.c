/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/check.h"

#include <stddef.h>
#include <string.h>

#include "base/text.h"

enum { KNOWN_MOST = 20 }; /* names that a message lists */

/* "a, b, c" in the study's arena; NULL: out of memory, which the arena remembers. */
static const char *joined(mt_study_check *c, const char *const *names, int n)
{
    const char *text = "";
    for (int i = 0; i < n && text != NULL; i++) {
        text = mt_arena_printf(&c->study->mem, "%s%s%s", text, i == 0 ? "" : ", ", names[i]);
    }
    return text;
}

void mt_check_unknown_name(mt_study_check *c, mt_name name, const char *what,
                           const void *records, int n, size_t size)
{
    const bool may = mt_diag_may_suggest(c->diags);
    const mt_arena_mark mark = mt_arena_get_mark(&c->study->mem);
    const char **const names =
        may ? mt_arena_alloc(&c->study->mem, (size_t)n, sizeof *names) : NULL;
    for (int i = 0; names != NULL && i < n; i++) {
        const void *const record = (const char *)records + (size_t)i * size;
        names[i] = ((const mt_name *)record)->s;
    }
    const char *const near = names == NULL ? NULL : mt_text_nearest(name.s, names, n);
    const bool few = names != NULL && near == NULL && n > 0 && n <= KNOWN_MOST;
    const char *const known = few ? joined(c, names, n) : NULL;
    if (near != NULL) {
        mt_diag_error(c->diags, name.addr, "unknown %s \"%s\"; did you mean \"%s\"?", what,
                      name.s, near);
    } else if (known != NULL) {
        mt_diag_error(c->diags, name.addr, "unknown %s \"%s\" (known: %s)", what, name.s,
                      known);
    } else {
        mt_diag_error(c->diags, name.addr, "unknown %s \"%s\"", what, name.s);
    }
    mt_arena_rewind(&c->study->mem, mark);
}

int mt_check_parameter(mt_study_check *c, mt_name name)
{
    const mt_model *const m = c->model;
    if (name.s == NULL) {
        return MT_ABSENT;
    }
    const int found = mt_model_find_parameter(m, name.s);
    if (found == MT_ABSENT) {
        mt_check_unknown_name(c, name, "parameter", m->parameters, m->n_parameters,
                              sizeof *m->parameters);
    }
    return found;
}

void mt_check_unset(mt_study_check *c, mt_name name, int parameter)
{
    for (int i = 0; i < c->model->n_settings; i++) {
        if (c->model->settings[i].parameter == parameter) {
            mt_diag_error(c->diags, name.addr,
                          "the study varies \"%s\" itself: it cannot be set to %.17g", name.s,
                          c->model->settings[i].value);
        }
    }
}

int mt_check_configuration(mt_study_check *c, const mt_model *model, mt_name name)
{
    if (name.s == NULL) {
        return MT_ABSENT;
    }
    const int found = mt_model_find_configuration(model, name.s);
    if (found == MT_ABSENT) {
        mt_check_unknown_name(c, name, "configuration", model->configurations,
                              model->n_configurations, sizeof *model->configurations);
    }
    return found;
}

int mt_check_reference(mt_study_check *c, mt_name name)
{
    const mt_study *const s = c->study;
    if (name.s == NULL) {
        return MT_ABSENT;
    }
    const int found = mt_study_find_reference(s, name.s);
    if (found == MT_ABSENT) {
        mt_check_unknown_name(c, name, "reference", s->references, s->n_references,
                              sizeof *s->references);
    }
    return found;
}

void mt_check_warn_result(mt_study_check *c, const char *text)
{
    mt_study *const s = c->study;
    const char **const list = mt_arena_grow(&s->mem, (void *)s->warnings, s->n_warnings,
                                            &s->cap_warnings, sizeof *list);
    if (list != NULL) {
        list[s->n_warnings++] = text;
        s->warnings = list;
    }
}

int mt_check_only_configuration(mt_study_check *c, const mt_model *model, mt_addr addr)
{
    if (model->n_configurations == 1) {
        return 0;
    }
    mt_diag_error(
        c->diags, addr,
        "no configuration is named and the model has %d of them (the first is \"%s\")",
        model->n_configurations, model->configurations[0].name.s);
    return MT_ABSENT;
}

int mt_check_mode(mt_study_check *c, mt_mode_ref *mode)
{
    const mt_model *const m = c->model;
    mode->named = MT_ABSENT;
    if (mode->mode_name.s == NULL) {
        return mode->index > 0 ? mode->index : 0;
    }
    mode->named = mt_model_find_mode(m, mode->mode_name.s);
    if (mode->named == MT_ABSENT) {
        mt_check_unknown_name(c, mode->mode_name, "mode", m->modes, m->n_modes,
                              sizeof *m->modes);
        return 0;
    }
    return m->modes[mode->named].index;
}

void mt_check_reference_mode(mt_study_check *c, int reference, int reference_mode,
                             int mode_index, bool shape, mt_addr addr)
{
    if (reference == MT_ABSENT) {
        return;
    }
    const mt_reference *const r = &c->study->references[reference];
    const int index = reference_mode > 0 ? reference_mode : mode_index;
    if (r->model_path.s != NULL || index < 1) {
        return; /* how many modes a model has is known later */
    }
    if (index > r->n_modes) {
        mt_diag_error(c->diags, addr, "reference \"%s\" has %d mode%s, not %d", r->name.s,
                      r->n_modes, r->n_modes == 1 ? "" : "s", index);
        return;
    }
    const mt_measured_mode *const m = &r->modes[index - 1];
    if (shape && m->n_values == 0) {
        mt_diag_error(c->diags, addr, "mode %d of reference \"%s\" has no shape", index,
                      r->name.s);
    } else if (!shape && !mt_check_given(c, m->frequency_hz, m->addr, "frequency_hz")) {
        mt_diag_error(c->diags, addr, "mode %d of reference \"%s\" has no frequency", index,
                      r->name.s);
    }
}

bool mt_check_given(const mt_study_check *c, double value, mt_addr object, const char *member)
{
    return MT_HAS(value) || mt_diag_member(c->diags, object, member) != object;
}
