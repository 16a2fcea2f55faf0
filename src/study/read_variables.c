/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/read_priv.h"

#include "study/catalogue.h"

static const mt_key CATALOGUE[] = {
    {.name = "series",
     .type = MT_KEY_TEXT,
     .choices = mt_series_names,
     .n_choices = MT_SERIES_COUNT,
     .says = "Preferred numbers, so many per decade."},
    MT_M_JUST("step", NUMBER, false, POSITIVE,
              "Step between the values, in the unit of the parameter, above 0."),
    MT_M_JUST("lower", NUMBER, true, RULE, "Least value, in the unit of the parameter."),
    MT_M_JUST("upper", NUMBER, true, RULE, "Greatest value, in the unit of the parameter."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
const mt_key_table mt_study_catalogue_keys = {
    .what = "catalogue",
    .keys = CATALOGUE,
    .n = MT_COUNT(CATALOGUE),
    .one_of = 2,
    .says = "The values of an E series of IEC 60063, or steps from the lower bound, between "
            "two bounds (included); at most 10000.",
    .examples = "[{\"series\": \"E24\", \"lower\": 1000, \"upper\": 100000}, {\"step\": 0.5, "
                "\"lower\": 1, \"upper\": 10}]"};

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
static void expand_rule(mt_study_reader *s, const mt_object *o, const rule *r, mt_variable *v)
{
    const mt_unit *const unit = mt_read_study_unit(s, v->parameter_name.s);
    mt_diags *const diags = s->r.diags;
    if (r->series == MT_ABSENT && !(r->step > 0.0)) {
        return; /* noted, with its row */
    }
    if (r->series != MT_ABSENT && !(r->lower > 0.0)) {
        mt_diag_error(diags, mt_object_value(o, "lower"), "lower (%g) must be above 0",
                      r->lower);
    } else if (r->lower > r->upper) {
        mt_diag_error(diags, mt_object_value(o, "upper"), "upper (%g) is below lower (%g)",
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
    mt_object o;
    if (!mt_object_match(&s->r, value, &mt_study_catalogue_keys, &o)) {
        return;
    }
    const int which = mt_object_one_of(&s->r, &o, "series", 2);
    const char *const name = v->parameter_name.s;
    const rule r = {
        .series = mt_reader_choice(&s->r, mt_object_value(&o, "series"), "series",
                                   mt_series_names, MT_SERIES_COUNT),
        .step = in_unit(s, mt_object_value(&o, "step"), name),
        .lower = in_unit(s, mt_object_value(&o, "lower"), name),
        .upper = in_unit(s, mt_object_value(&o, "upper"), name),
    };
    const bool known = which == 0 ? r.series != MT_ABSENT : MT_HAS(r.step);
    if (which != MT_ABSENT && known && MT_HAS(r.lower) && MT_HAS(r.upper)) {
        expand_rule(s, &o, &r, v);
    }
}

/* A list of values, or a rule. */
static void read_catalogue(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_study_reader *const s = mt_study_reader_of(r);
    mt_variable *const v = item;
    (void)key;
    if (mt_json_type_of(r->doc, value) == MT_JSON_OBJECT) {
        read_rule(s, value, v);
        return;
    }
    mt_items items = mt_reader_some_items(r, value, "the catalogue");
    v->catalogue = mt_reader_room(r, &items, sizeof *v->catalogue);
    while (mt_items_next(&items)) {
        const double number = mt_read_study_value(s, items.at, v->parameter_name.s);
        if (MT_HAS(number)) {
            v->catalogue[v->n_catalogue++] = number;
        }
    }
}

static void variable_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    *(mt_variable *)item = mt_variable_default(addr);
}

#define THIS mt_variable
static const mt_key VARIABLE[] = {
    MT_M_REF("parameter", true, parameter_name, "Name of a parameter of the model."),
    MT_S_VALUE("lower", false, lower, parameter_name, BOUND,
               "Lower bound, in the unit of the parameter. Goes with \"upper\"."),
    MT_S_VALUE("upper", false, upper, parameter_name, BOUND,
               "Upper bound, in the unit of the parameter. Goes with \"lower\"."),
    {.name = "catalogue",
     .type = MT_KEY_LIST_OR_OBJECT,
     .possible = MT_POSSIBLE_VALUES,
     .read = read_catalogue,
     .says = "The values that can be had, in the unit of the parameter, instead of bounds: a "
             "list, or a rule.",
     .examples =
         "[[5000, 8000, 10000], {\"series\": \"E24\", \"lower\": 1000, \"upper\": 100000}]",
     .schema = "\"if\": {\"type\": \"array\"}, \"then\": {\"minItems\": 1, \"items\": "
               "{\"$ref\": \"#/definitions/number\"}}, \"else\": {\"$ref\": "
               "\"#/definitions/catalogue\"}, \"type\": [\"array\", \"object\"]"},
    MT_S_NUMBER("weight", false, weight, POSITIVE,
                "Weight of this variable in the size of a change (no unit), above 0.",
                .otherwise = "1"),
    MT_S_VALUE("scale", false, scale, parameter_name, POSITIVE,
               "Change that counts as 1, in the parameter's unit: measures its change "
               "linearly. Absent: ln(new/original) where original and bounds are positive or "
               "0, else the range."),
    MT_S_NUMBER("tolerance_percent", false, tolerance_percent, TOLERANCE,
                "Manufacturing tolerance, in percent of the value either way: constraints must "
                "hold everywhere within the tolerances of all variables. A target, or "
                "\"equals\", is met by the design itself; with a tolerance_percent of its own "
                "it is a range that is kept everywhere over the tolerances. Misfit and "
                "objectives are those of the design itself."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_study_variable_keys = {
    .what = "variable",
    .keys = VARIABLE,
    .n = MT_COUNT(VARIABLE),
    .size = sizeof(mt_variable),
    .defaults = variable_defaults,
    .says = "A parameter that the study may change: within two bounds, or to an entry of a "
            "catalogue.",
    .examples = "[{\"parameter\": \"K_T1\", \"lower\": 1000, \"upper\": 100000}]"};
