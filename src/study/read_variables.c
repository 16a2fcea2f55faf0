/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/read_priv.h"

#include "study/catalogue.h"

#define VARIABLE_KEYS(X)                                                        \
    X(VARIABLE_PARAMETER, "parameter", MT_KEY_TEXT, true)                       \
    X(VARIABLE_LOWER, "lower", MT_KEY_NUMBER, false, BOUND)                     \
    X(VARIABLE_UPPER, "upper", MT_KEY_NUMBER, false, BOUND)                     \
    X(VARIABLE_CATALOGUE, "catalogue", MT_KEY_LIST_OR_OBJECT, false, VALUES)    \
    X(VARIABLE_WEIGHT, "weight", MT_KEY_NUMBER, false, POSITIVE)                \
    X(VARIABLE_SCALE, "scale", MT_KEY_NUMBER, false, POSITIVE)                  \
    X(VARIABLE_TOLERANCE, "tolerance_percent", MT_KEY_NUMBER, false, TOLERANCE) \
    X(VARIABLE_DESCRIPTION, "description", MT_KEY_TEXT, false)                  \
    X(VARIABLE_SOURCE, "source", MT_KEY_TEXT, false)
enum { VARIABLE_KEYS(MT_STUDY_KEY_ENUM) VARIABLE_KEY_COUNT };
static const mt_key KEYS[] = {VARIABLE_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_variable_keys = {"variable", KEYS, VARIABLE_KEY_COUNT};

#define CATALOGUE_KEYS(X)                                       \
    X(CATALOGUE_SERIES, "series", MT_KEY_TEXT, false)           \
    X(CATALOGUE_STEP, "step", MT_KEY_NUMBER, false, POSITIVE)   \
    X(CATALOGUE_LOWER, "lower", MT_KEY_NUMBER, true, RULE)      \
    X(CATALOGUE_UPPER, "upper", MT_KEY_NUMBER, true, RULE)      \
    X(CATALOGUE_DESCRIPTION, "description", MT_KEY_TEXT, false) \
    X(CATALOGUE_SOURCE, "source", MT_KEY_TEXT, false)
enum { CATALOGUE_KEYS(MT_STUDY_KEY_ENUM) CATALOGUE_KEY_COUNT };
static const mt_key CATALOGUE[] = {CATALOGUE_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_catalogue_keys = {"catalogue", CATALOGUE, CATALOGUE_KEY_COUNT};

/* A series or steps between two bounds, in the unit of the catalogue's numbers: a series is one
 * of that unit's, and steps of 0.5 in are. */
typedef struct rule {
    int series; /* MT_ABSENT: steps */
    double step;
    double lower;
    double upper;
} rule;

static int list_catalogue_values(const rule *r, int most, double *values)
{
    return r->series != MT_ABSENT
               ? mt_catalogue_series(r->series, r->lower, r->upper, most, values)
               : mt_catalogue_steps(r->step, r->lower, r->upper, most, values);
}

/* The values of a rule whose numbers are given, or what is wrong with them. */
static void expand_rule(mt_study_reader *s, const mt_study_object *o, const rule *r,
                        mt_variable *v)
{
    const mt_unit *const unit = mt_read_study_unit(s, v->parameter_name.s);
    mt_diags *const diags = s->r.diags;
    if (r->series == MT_ABSENT && !(r->step > 0.0)) {
        return; /* noted, with its row */
    }
    if (r->series != MT_ABSENT && !(r->lower > 0.0)) {
        mt_diag_error(diags, o->found[CATALOGUE_LOWER], "lower (%g) must be above 0", r->lower);
    } else if (r->lower > r->upper) {
        mt_diag_error(diags, o->found[CATALOGUE_UPPER], "upper (%g) is below lower (%g)",
                      r->upper, r->lower);
    } else {
        const int n = list_catalogue_values(r, 0, NULL);
        if (n == 0 || n > MT_MAX_CATALOGUE) {
            mt_diag_error(diags, o->addr,
                          n == 0 ? "no value lies from %g to %g"
                                 : "more than 10000 values lie from %g to %g",
                          r->lower, r->upper);
            return;
        }
        v->catalogue = mt_arena_f64(&s->study->mem, (size_t)n, 1);
        if (v->catalogue == NULL) {
            return;
        }
        v->n_catalogue = list_catalogue_values(r, n, v->catalogue);
        for (int i = 0; i < n; i++) {
            v->catalogue[i] = mt_unit_to_si(unit, v->catalogue[i]);
        }
    }
}

/* A value in its parameter's unit: as written, or as near as numbers come. */
static double in_unit(mt_study_reader *s, mt_addr value, const char *parameter)
{
    return mt_unit_written(mt_read_study_unit(s, parameter),
                           mt_read_study_value(s, value, parameter));
}

static void read_rule(mt_study_reader *s, mt_addr value, mt_variable *v)
{
    mt_study_object o;
    int n = 0;
    const char *const *const names = mt_series_names(&n);
    if (!mt_read_study_object(s, value, &mt_study_catalogue_keys, &o)) {
        return;
    }
    const int which = mt_read_study_one_of(s, &o, CATALOGUE_SERIES, 2);
    const char *const name = v->parameter_name.s;
    const rule r = {
        .series = mt_reader_choice(&s->r, o.found[CATALOGUE_SERIES], "series", names, n),
        .step = in_unit(s, o.found[CATALOGUE_STEP], name),
        .lower = in_unit(s, o.found[CATALOGUE_LOWER], name),
        .upper = in_unit(s, o.found[CATALOGUE_UPPER], name),
    };
    const bool known = which == CATALOGUE_SERIES ? r.series != MT_ABSENT : MT_HAS(r.step);
    if (which != MT_ABSENT && known && MT_HAS(r.lower) && MT_HAS(r.upper)) {
        expand_rule(s, &o, &r, v);
    }
}

static void read_catalogue(mt_study_reader *s, mt_addr list, mt_variable *v)
{
    if (list == MT_NO_ADDR) {
        return;
    }
    if (mt_json_type_of(s->r.doc, list) == MT_JSON_OBJECT) {
        read_rule(s, list, v);
        return;
    }
    mt_items items = mt_reader_some_items(&s->r, list, "the catalogue");
    v->catalogue = mt_reader_room(&s->r, &items, sizeof *v->catalogue);
    while (mt_items_next(&items)) {
        const double value = mt_read_study_value(s, items.at, v->parameter_name.s);
        if (MT_HAS(value)) {
            v->catalogue[v->n_catalogue++] = value;
        }
    }
}

static void read_variable(mt_study_reader *s, mt_addr value, mt_variable *v)
{
    mt_study_object o;
    *v = mt_variable_default(value);
    if (!mt_read_study_object(s, value, &mt_study_variable_keys, &o)) {
        return;
    }
    v->parameter_name = mt_reader_ref(&s->r, o.found[VARIABLE_PARAMETER]);
    const char *const name = v->parameter_name.s;
    v->lower = mt_read_study_value(s, o.found[VARIABLE_LOWER], name);
    v->upper = mt_read_study_value(s, o.found[VARIABLE_UPPER], name);
    read_catalogue(s, o.found[VARIABLE_CATALOGUE], v);
    const double weight = mt_read_study_number(s, o.found[VARIABLE_WEIGHT]);
    v->weight = MT_HAS(weight) ? weight : v->weight;
    v->scale = mt_read_study_value(s, o.found[VARIABLE_SCALE], name);
    v->tolerance_percent = mt_read_study_number(s, o.found[VARIABLE_TOLERANCE]);
}

void mt_read_study_variables(mt_study_reader *s, mt_addr list)
{
    mt_study *const study = s->study;
    mt_items items = mt_reader_items(&s->r, list);
    study->variables = mt_reader_room(&s->r, &items, sizeof *study->variables);
    while (mt_items_next(&items)) {
        if (mt_reader_type(&s->r, items.at, MT_KEY_OBJECT)) {
            read_variable(s, items.at, &study->variables[study->n_variables++]);
        }
    }
}
