/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Variables, and the catalogues that their values may come from.
 *
 * IEC 60063: the values of E48, E96 and E192 are 10^(i/N) rounded to three digits, but for 9.20
 * in E192, where the rule says 9.19. E24 and below are older and have two digits that no rule
 * gives; E12, E6 and E3 are every second, fourth and eighth of E24.
 */
#include "study/variables.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

#include "study/catalogues.h"
#include "study/check.h"
#include "study/reader.h"

/* Preferred numbers and steps */

static const int E24[] = {100, 110, 120, 130, 150, 160, 180, 200, 220, 240, 270, 300,
                          330, 360, 390, 430, 470, 510, 560, 620, 680, 750, 820, 910};
enum {
    E24_SIZE = MT_COUNT(E24),
    E192_SIZE = 192,
    E192_EXCEPTION = 185,
    E192_EXCEPTIONAL = 920
};

/* Bounds are often expressions: 3 * 1.1 is a rounding above 3.3. */
static const double BOUND_SLACK = 1e-12;
/* The same, in steps: differences of two rounded numbers, divided. */
static const double STEP_SLACK = 1e-9;

#define SERIES_NAME(n) "E" #n,
const char *const mt_series_names[] = {MT_SERIES_LIST(SERIES_NAME)};
#define SERIES_SIZE(n) n,
static const int SIZES[] = {MT_SERIES_LIST(SERIES_SIZE)};

/* The i-th value of a decade, in hundredths: 100 to 999. */
static int digits(int per_decade, int i)
{
    if (per_decade <= E24_SIZE) {
        const int position = i * (E24_SIZE / per_decade);
        return E24[position];
    }
    if (i * (E192_SIZE / per_decade) == E192_EXCEPTION) {
        return E192_EXCEPTIONAL;
    }
    return (int)lround(100.0 * pow(10.0, (double)i / (double)per_decade));
}

/* digits * 10^(decade - 2): one rounding, as powers of ten up to 22 are exact. */
static double decimal_value(int hundredths, int decade)
{
    const int exponent = decade - 2;
    return exponent >= 0 ? (double)hundredths * pow(10.0, (double)exponent)
                         : (double)hundredths / pow(10.0, (double)-exponent);
}

int mt_catalogue_series(int which, double lower, double upper, int most, double *values)
{
    const int per_decade = SIZES[which];
    int n = 0;
    if (!(lower > 0.0) || !isfinite(lower) || !isfinite(upper)) {
        return 0;
    }
    const double least = lower * (1.0 - BOUND_SLACK);
    const double greatest = upper * (1.0 + BOUND_SLACK);
    for (int decade = (int)floor(log10(lower)) - 1; n <= MT_MAX_CATALOGUE; decade++) {
        if (decimal_value(digits(per_decade, 0), decade) > greatest) {
            break;
        }
        for (int i = 0; i < per_decade && n <= MT_MAX_CATALOGUE; i++) {
            const double value = decimal_value(digits(per_decade, i), decade);
            if (value < least || value > greatest) {
                continue;
            }
            if (values != NULL && n < most) {
                values[n] = value;
            }
            n++;
        }
    }
    return n;
}

int mt_catalogue_steps(double step, double lower, double upper, int most, double *values)
{
    if (!(step > 0.0) || !(lower <= upper) || !isfinite(lower) || !isfinite(upper)) {
        return 0;
    }
    const double steps = floor((upper - lower) / step + STEP_SLACK);
    if (!(steps < (double)MT_MAX_CATALOGUE)) {
        return MT_MAX_CATALOGUE + 1;
    }
    const int n = (int)steps + 1;
    for (int i = 0; values != NULL && i < n && i < most; i++) {
        const double value = lower + (double)i * step;
        values[i] = value < upper ? value : upper;
    }
    return n;
}

/* Reading */

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

/* The unit of bare numbers for the parameter; NULL: SI, or not known. */
static const mt_unit *bare_unit(const mt_study_reader *s, const char *parameter)
{
    const mt_model *const m = s->study->model;
    const int p =
        m == NULL || parameter == NULL ? MT_ABSENT : mt_model_find_parameter(m, parameter);
    return p == MT_ABSENT ? NULL : mt_study_unit(s->study, p);
}

/* The values of a rule whose numbers are given, or what is wrong with them. */
static void expand_rule(mt_study_reader *s, const mt_object *o, const rule *r, mt_variable *v)
{
    const mt_unit *const unit = bare_unit(s, v->parameter_name.s);
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
    return mt_unit_written(bare_unit(s, parameter), mt_read_study_value(s, value, parameter));
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

/* The parameters of a column: one name, or several. */
static void add_parameters(mt_reader *r, mt_variable *v, mt_name column, mt_addr value,
                           int room)
{
    mt_items items = mt_reader_one_or_items(r, value);
    while (mt_items_next(&items)) {
        const mt_name parameter = mt_reader_ref(r, items.at);
        if (parameter.s != NULL && v->columns.count < room) {
            v->columns.items[v->columns.count++] = column;
            v->parameters.items[v->parameters.count++] = parameter;
        }
    }
}

/* Names in the order of the columns, or an object of columns and their parameters. */
static void read_parameters(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_variable *const v = item;
    int room = 0;
    (void)key;
    v->by_order = mt_json_type_of(r->doc, value) == MT_JSON_ARRAY;
    for (mt_items items = mt_reader_items(r, value); mt_items_next(&items);) {
        mt_items inner = mt_reader_one_or_items(r, items.at);
        room += inner.count;
    }
    v->columns.items = mt_arena_alloc(r->mem, (size_t)room, sizeof *v->columns.items);
    v->parameters.items = mt_arena_alloc(r->mem, (size_t)room, sizeof *v->parameters.items);
    if (mt_arena_failed(r->mem)) {
        return;
    }
    if (room == 0) {
        mt_diag_structure(r->diags, value, "no parameter is named");
    }
    for (mt_items items = mt_reader_items(r, value); mt_items_next(&items);) {
        const mt_name column = {.s = v->by_order ? NULL : mt_json_name(r->doc, items.at),
                                .addr = items.at};
        add_parameters(r, v, column, items.at, room);
    }
}

/* A list of values, a rule, or the name of a catalogue of parts. */
static void read_catalogue(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_study_reader *const s = mt_study_reader_of(r);
    mt_variable *const v = item;
    (void)key;
    if (mt_json_type_of(r->doc, value) == MT_JSON_STRING) {
        v->catalogue_name = mt_reader_ref(r, value);
        return;
    }
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
    *(mt_variable *)item = (mt_variable){
        .parameter = MT_ABSENT,
        .lower = nan(""),
        .upper = nan(""),
        .weight = 1.0,
        .scale = nan(""),
        .range = nan(""),
        .tolerance_percent = nan(""),
        .original = nan(""),
        .addr = addr,
    };
}

/* What goes with a catalogue of parts, and what does not. */
static void variable_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    static const char *const others[] = {"lower", "upper", "scale"};
    mt_variable *const v = item;
    const bool rows = v->catalogue_name.s != NULL;
    if (which == 1 && !rows && !mt_object_wrong(r, o)) {
        mt_diag_error(r->diags, mt_object_place(r, o, "catalogue"),
                      "\"parameters\" go with the name of one of the study's \"catalogues\"");
    }
    if (which == 0 && rows) {
        mt_diag_error(r->diags, v->catalogue_name.addr,
                      "the rows of a catalogue set \"parameters\"; the values of one "
                      "\"parameter\" are a list, or a rule");
        v->catalogue_name.s = NULL;
    }
    for (int i = 0; i < MT_COUNT(others) && which == 1; i++) {
        if (mt_object_has(r, o, others[i])) {
            mt_diag_error(r->diags, mt_object_place(r, o, others[i]),
                          "\"%s\" goes with a single \"parameter\"", others[i]);
        }
    }
}

#define THIS mt_variable
static const mt_key VARIABLE[] = {
    MT_M_REF("parameter", false, parameter_name, "Name of a parameter of the model."),
    {.name = "parameters",
     .type = MT_KEY_LIST_OR_OBJECT,
     .read = read_parameters,
     .says = "Parameters that a row of a catalogue sets together: an object of columns and the "
             "parameter that each sets, or a list of several; or a list of parameters in the "
             "order of the columns.",
     .examples = "[{\"D\": \"d_1\", \"t\": \"wall_1\"}, [\"d_1\", \"wall_1\"], {\"D\": "
                 "[\"d_1\", \"d_2\"], \"t\": [\"wall_1\", \"wall_2\"]}]",
     .schema = "\"anyOf\": [{\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": "
               "\"string\"}}, {\"type\": \"object\", \"minProperties\": 1, "
               "\"additionalProperties\": {\"anyOf\": [{\"type\": \"string\"}, {\"type\": "
               "\"array\", \"minItems\": 1, \"items\": {\"type\": \"string\"}}]}}]"},
    MT_S_VALUE("lower", false, lower, parameter_name, BOUND,
               "Lower bound, in the unit of the parameter. Goes with \"upper\"."),
    MT_S_VALUE("upper", false, upper, parameter_name, BOUND,
               "Upper bound, in the unit of the parameter. Goes with \"lower\"."),
    {.name = "catalogue",
     .type = MT_KEY_TEXT_LIST_OR_OBJECT,
     .possible = MT_POSSIBLE_VALUES,
     .read = read_catalogue,
     .says = "The values that can be had, in the unit of the parameter, instead of bounds: a "
             "list, or a rule. With \"parameters\": the name of one of the study's "
             "\"catalogues\", of which a row is taken.",
     .examples =
         "[[5000, 8000, 10000], {\"series\": \"E24\", \"lower\": 1000, \"upper\": 100000}]",
     .schema = "\"anyOf\": [{\"type\": \"array\", \"minItems\": 1, \"items\": {\"$ref\": "
               "\"#/definitions/number\"}}, {\"$ref\": \"#/definitions/catalogue\"}, "
               "{\"type\": \"string\"}]"},
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
    .one_of = 2,
    .size = sizeof(mt_variable),
    .defaults = variable_defaults,
    .finish = variable_finish,
    .says = "A parameter that the study may change: within two bounds, or to an entry of a "
            "catalogue; or several that a row of a catalogue of parts sets together.",
    .examples = "[{\"parameter\": \"K_T1\", \"lower\": 1000, \"upper\": 100000}, "
                "{\"catalogue\": \"tube\", \"parameters\": {\"D\": \"d_1\", \"t\": "
                "\"wall_1\"}}]"};

/* Checks */

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
    if (v->rows == NULL && catalogue && (lower || upper)) {
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
    mt_study_check_rows(c);
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
