/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Measurements of a study: of the responses of a file those that are meant stay, in SI. A table
 * says by names of ports what it has, which is held against the goals where the mechanism is
 * known; a universal file by numbers of datasets, nodes and directions.
 */
#include "study/study_priv.h"

#include <string.h>

enum { FREQUENCY_RESPONSE = 4, TRANSMISSIBILITY = 5, LISTED_MOST = 10 };

int mt_study_find_measurement(const mt_study *study, const char *name)
{
    for (int i = 0; i < study->n_measurements; i++) {
        if (strcmp(study->measurements[i].name.s, name) == 0) {
            return i;
        }
    }
    return MT_ABSENT;
}

/* Is one of the file the one that was asked for? A node alone means any direction. Against a direction is the same freedom: the
 * sign is in the values. */
static bool is_freedom(mt_name asked, const mt_measured_freedom *has)
{
    mt_measured_freedom f;
    if (asked.s == NULL || !mt_measured_freedom_parse(asked.s, &f)) {
        return true;
    }
    return f.node == has->node && (f.direction == 0 || f.direction == has->direction ||
                                   f.direction == -has->direction);
}

static bool is_response(const mt_measured_response *r)
{
    return r->dataset == 0 || r->function == FREQUENCY_RESPONSE ||
           r->function == TRANSMISSIBILITY;
}

static bool is_meant(const mt_measurement *m, const mt_measured_response *r)
{
    return is_response(r) && (m->dataset == 0 || m->dataset == r->dataset) &&
           is_freedom(m->response_name, &r->response) &&
           is_freedom(m->reference_name, &r->reference);
}

const char *mt_measured_response_text(const mt_measured_response *r, mt_arena *mem)
{
    char a[MT_FREEDOM_TEXT];
    char b[MT_FREEDOM_TEXT];
    if (r->dataset == 0) {
        return mt_arena_printf(
            mem, "%s%s%s by %s", r->configuration == NULL ? "" : r->configuration,
            r->configuration == NULL ? "" : ": ", r->output == NULL ? "an output" : r->output,
            r->input == NULL ? "an input" : r->input);
    }
    mt_measured_freedom_text(&r->response, a);
    mt_measured_freedom_text(&r->reference, b);
    return mt_arena_printf(mem, "dataset %d: %s by %s", r->dataset, a, b);
}

const char *mt_measured_list_text(const mt_measurement *m, mt_arena *mem)
{
    const char *text = "";
    int listed = 0;
    for (int i = 0; i < m->n_responses && text != NULL && listed < LISTED_MOST; i++) {
        if (is_response(&m->responses[i])) {
            const char *const one = mt_measured_response_text(&m->responses[i], mem);
            text = mt_arena_printf(mem, "%s%s%s", text, listed++ > 0 ? "; " : "",
                                   one == NULL ? "" : one);
        }
    }
    return text == NULL ? "" : text;
}

/* Where the study asks for one of several. */
static mt_addr choice_of(const mt_measurement *m)
{
    return m->dataset > 0                ? m->dataset_addr
           : m->response_name.s != NULL  ? m->response_name.addr
           : m->reference_name.s != NULL ? m->reference_name.addr
                                         : m->addr;
}

/* Those that are meant alone stay. */
static void choose(mt_study_check *c, mt_measurement *m)
{
    const bool table = m->n_responses > 0 && m->responses[0].dataset == 0;
    const bool asked =
        m->dataset > 0 || m->response_name.s != NULL || m->reference_name.s != NULL;
    if (table && asked) {
        mt_diag_error(c->diags, choice_of(m),
                      "datasets and nodes go with a universal file, and \"%s\" is a table",
                      m->path.s);
        return;
    }
    mt_measured_response kept = {.dataset = 0};
    int n = 0;
    for (int i = 0; i < m->n_responses && !table; i++) {
        if (is_meant(m, &m->responses[i])) {
            kept = n++ == 0 ? m->responses[i] : kept;
        }
    }
    if (table) {
        return;
    }
    if (n == 1) {
        m->responses[0] = kept;
        m->n_responses = 1;
        return;
    }
    const char *const list = mt_measured_list_text(m, &c->study->mem);
    mt_diag_error(c->diags, choice_of(m),
                  n > 1 ? "%d frequency responses of \"%s\" can be meant: say which by "
                          "\"dataset\", or by \"response_node\" and \"reference_node\" (%s)"
                        : "%d frequency responses of \"%s\" are meant by this; it has: %s",
                  n, m->path.s, *list == '\0' ? "none" : list);
}

static bool scale(mt_study_check *c, const mt_measurement *m, mt_measured_response *r)
{
    const double by = MT_HAS(m->factor) ? m->factor : r->si;
    if (!MT_HAS(by)) {
        mt_diag_error(c->diags, m->path.addr,
                      r->foreign != NULL
                          ? "the unit \"%s\" of \"%s\" is not known: give \"factor\", by which "
                            "its values are multiplied to be in SI"
                          : "\"%s%s\" does not say what it measures, so that its units say "
                            "nothing: give \"factor\", by which its values are multiplied to "
                            "be in SI",
                      r->foreign != NULL ? r->foreign : "", m->path.s);
        return false;
    }
    r->scale = by;
    r->unit = MT_HAS(m->factor) ? NULL : r->unit;
    return true;
}

void mt_study_check_measurements(mt_study_check *c)
{
    mt_study *const s = c->study;
    for (int i = 0; i < s->n_measurements; i++) {
        mt_measurement *const m = &s->measurements[i];
        if (mt_study_find_measurement(s, m->name.s) < i) {
            mt_diag_error(c->diags, m->name.addr, "measurement \"%s\" is given twice",
                          m->name.s);
        }
        mt_check_positive(c, m->factor, m->factor_addr, "factor");
        if (!m->read) {
            continue;
        }
        const int before = c->diags->errors;
        choose(c, m);
        bool known = c->diags->errors == before;
        for (int k = 0; k < m->n_responses && known; k++) {
            known = scale(c, m, &m->responses[k]);
        }
    }
}
