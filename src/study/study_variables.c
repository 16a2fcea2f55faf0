/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/study_priv.h"

#include <math.h>
#include <stdlib.h>

#include "study/catalogue.h"

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return (x > y) - (x < y);
}

static void check_catalogue(mt_study_check *c, mt_variable *v)
{
    if (v->n_catalogue > MT_MAX_CATALOGUE) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, v->addr, "catalogue"),
                      "the catalogue has more than %d values", MT_MAX_CATALOGUE);
    }
    qsort(v->catalogue, (size_t)v->n_catalogue, sizeof *v->catalogue, ascending);
    for (int i = 1; i < v->n_catalogue; i++) {
        if (v->catalogue[i] <= v->catalogue[i - 1]) {
            mt_diag_error(c->diags, mt_diag_member(c->diags, v->addr, "catalogue"),
                          "the catalogue lists %.17g twice",
                          mt_unit_written(v->shown, v->catalogue[i]));
        }
    }
    v->lower = v->catalogue[0];
    v->upper = v->catalogue[v->n_catalogue - 1];
}

/* Continuous between two bounds, or discrete. */
static void check_range(mt_study_check *c, mt_variable *v)
{
    const bool lower = mt_check_given(c, v->lower, v->addr, "lower");
    const bool upper = mt_check_given(c, v->upper, v->addr, "upper");
    const bool catalogue =
        v->n_catalogue > 0 || mt_diag_member(c->diags, v->addr, "catalogue") != v->addr;
    if (catalogue && (lower || upper)) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, v->addr, "catalogue"),
                      "a variable has either a catalogue or bounds, not both");
        return;
    }
    if (v->n_catalogue > 0) {
        check_catalogue(c, v);
        return;
    }
    if (!catalogue && !lower && !upper) {
        mt_diag_error(c->diags, v->addr,
                      "a variable needs \"lower\" and \"upper\", or \"catalogue\"");
    } else if (!catalogue && !(lower && upper)) {
        mt_diag_error(c->diags, v->addr, "\"%s\" is missing: a variable needs both bounds",
                      lower ? "upper" : "lower");
    } else if (v->lower >= v->upper) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, v->addr, "upper"),
                      "upper (%g) is %s lower (%g)", mt_unit_from_si(v->shown, v->upper),
                      v->lower > v->upper ? "below" : "equal to",
                      mt_unit_from_si(v->shown, v->lower));
    }
}

static void check_original(mt_study_check *c, mt_variable *v)
{
    if (c->study->original == NULL) {
        return;
    }
    v->original = c->study->original[v->parameter];
    const bool range = v->lower < v->upper || v->n_catalogue > 0;
    if (!range) {
        return; /* there is more to say about the bounds */
    }
    if (v->original < v->lower || v->original > v->upper) {
        mt_diag_warning(
            c->diags, v->addr, "the original value of \"%s\" (%g) lies outside %g to %g%s%s",
            v->parameter_name.s, mt_unit_from_si(v->shown, v->original),
            mt_unit_from_si(v->shown, v->lower), mt_unit_from_si(v->shown, v->upper),
            v->shown == NULL ? "" : " ", mt_unit_name(v->shown, ""));
    }
}

void mt_study_check_variables(mt_study_check *c)
{
    mt_study *const s = c->study;
    int *const first = mt_arena_int(&s->mem, (size_t)c->model->n_parameters);
    if (first == NULL) {
        return;
    }
    for (int i = 0; i < s->n_variables; i++) {
        mt_variable *const v = &s->variables[i];
        v->parameter = mt_check_parameter(c, v->parameter_name);
        v->shown = v->parameter == MT_ABSENT ? NULL : mt_study_unit(s, v->parameter);
        check_range(c, v);
        v->range = v->upper > v->lower ? v->upper - v->lower : 1.0; /* one value: any scale */
        if (v->parameter == MT_ABSENT) {
            continue;
        }
        if (first[v->parameter]++ > 0) {
            mt_diag_error(c->diags, v->parameter_name.addr, "\"%s\" is a variable already",
                          v->parameter_name.s);
        }
        mt_check_unset(c, v->parameter_name, v->parameter);
        check_original(c, v);
    }
}

static bool overrides(const mt_configuration *configuration, int parameter)
{
    for (int i = 0; i < configuration->n_overrides; i++) {
        if (configuration->overrides[i].parameter == parameter) {
            return true;
        }
    }
    return false;
}

/* True where some configuration that a goal names, or a goal without one, follows the
 * parameter. *asked: set where there is any goal. */
static bool is_followed(const mt_study *s, int parameter, bool *asked)
{
    for (int i = 0; i < s->n_goals; i++) {
        const mt_goal *const goal = &s->goals[i];
        if (goal->n_configurations == 0) {
            *asked = true;
            return true;
        }
        for (int k = 0; k < goal->n_configurations; k++) {
            const int configuration = goal->configurations[k];
            *asked = true;
            if (configuration == MT_ABSENT ||
                !overrides(&s->model->configurations[configuration], parameter)) {
                return true;
            }
        }
    }
    return false;
}

void mt_study_check_overrides(mt_study_check *c)
{
    const mt_study *const s = c->study;
    for (int i = 0; i < s->n_variables; i++) {
        const mt_variable *const v = &s->variables[i];
        bool asked = false;
        if (v->parameter != MT_ABSENT && !is_followed(s, v->parameter, &asked) && asked) {
            mt_diag_error(c->diags, v->parameter_name.addr,
                          "\"%s\" is overridden in every configuration that the goals name: "
                          "changing it has no effect",
                          v->parameter_name.s);
        }
    }
}
