/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Measurements of a study: of the responses of a file those that are meant stay, in SI. A table
 * says by names of ports what it has, which is held against the goals where the mechanism is
 * known; a universal file by numbers of datasets, nodes and directions.
 */
#include "study/study_priv.h"

#include <string.h>

int mt_study_find_measurement(const mt_study *study, const char *name)
{
    for (int i = 0; i < study->n_measurements; i++) {
        if (strcmp(study->measurements[i].name.s, name) == 0) {
            return i;
        }
    }
    return MT_ABSENT;
}

/* True where the freedom of the file is the requested one. A node alone means any direction;
 * the opposite direction is the same freedom, as the sign is in the values. */
static bool is_freedom(mt_name asked, const mt_measured_freedom *has)
{
    mt_measured_freedom f;
    if (asked.s == NULL || !mt_measured_freedom_parse(asked.s, &f)) {
        return true;
    }
    return f.node == has->node && (f.direction == 0 || f.direction == has->direction ||
                                   f.direction == -has->direction);
}

static bool is_meant(const mt_measurement *m, const mt_measured_response *r)
{
    return mt_measured_is_response(r) && (m->dataset == 0 || m->dataset == r->dataset) &&
           is_freedom(m->response_name, &r->response) &&
           is_freedom(m->reference_name, &r->reference);
}

/* The address of the member that selects one of several responses. */
static mt_addr choice_of(const mt_study_check *c, const mt_measurement *m)
{
    return m->dataset > 0                ? mt_diag_member(c->diags, m->addr, "dataset")
           : m->response_name.s != NULL  ? m->response_name.addr
           : m->reference_name.s != NULL ? m->reference_name.addr
                                         : m->addr;
}

/* Keep only the selected response of a measurement. */
static void keep_selected_response(mt_study_check *c, mt_measurement *m)
{
    const bool table = m->n_responses > 0 && m->responses[0].dataset == 0;
    const bool asked =
        m->dataset > 0 || m->response_name.s != NULL || m->reference_name.s != NULL;
    if (table && asked) {
        mt_diag_error(c->diags, choice_of(c, m),
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
    mt_diag_error(c->diags, choice_of(c, m),
                  n > 1 ? "%d frequency responses of \"%s\" can be meant: say which by "
                          "\"dataset\", or by \"response_node\" and \"reference_node\" (%s)"
                        : "%d frequency responses of \"%s\" are meant by this; it has: %s",
                  n, m->path.s, *list == '\0' ? "none" : list);
}

static bool scale(mt_study_check *c, const mt_measurement *m, mt_measured_response *r)
{
    const double by = MT_HAS(m->factor) ? m->factor : r->si;
    if (!MT_HAS(by)) {
        if (r->foreign != NULL && r->against != NULL) {
            mt_diag_error(c->diags, m->path.addr,
                          "\"%s\" says that it has %s, and \"%s\" for its unit: give "
                          "\"factor\", by which its values are multiplied to be in SI",
                          m->path.s, r->against, r->foreign);
            return false;
        }
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
        if (!m->read) {
            continue;
        }
        const int before = c->diags->errors;
        keep_selected_response(c, m);
        bool known = c->diags->errors == before;
        for (int k = 0; k < m->n_responses && known; k++) {
            known = scale(c, m, &m->responses[k]);
        }
    }
}

void mt_study_check_measured(mt_study_check *c, mt_response_limit *s, mt_addr goal)
{
    s->measurement = mt_check_measurement(c, s->measurement_name);
    mt_check_range(c, s, goal);
}
