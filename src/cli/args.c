/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/args.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "base/possible.h"
#include "base/workers.h"
#include "cli/limits.h"
#include "response/curve.h"
#include "study/study.h"

enum { SUGGESTION_TEXT = 64, MAX_THREADS = 1024 };

/* "; did you mean "x"?" or nothing */
static const char *did_you_mean(const char *name, const char *const *names, int n,
                                const char *dashes, char text[SUGGESTION_TEXT])
{
    const char *const nearest = mt_text_nearest(name, names, n);
    text[0] = '\0';
    if (nearest != NULL) {
        (void)mt_snprintf(text, SUGGESTION_TEXT, "; did you mean \"%s%s\"?", dashes, nearest);
    }
    return text;
}

bool mt_option_is_of(int option, int command)
{
    const unsigned commands = mt_options[option].commands;
    return command == MT_CMD_NONE ? commands == 0U || option == MT_OPT_HELP
                                  : (commands & (1U << (unsigned)command)) != 0U;
}

static bool takes(int command, int option)
{
    return mt_option_is_of(option, command) || option == MT_OPT_VERSION ||
           option == MT_OPT_MANUAL;
}

static mt_status unknown_option(int command, const char *name, size_t length, mt_err *err)
{
    const char *names[MT_OPT_IDS];
    char given[SUGGESTION_TEXT];
    char suggestion[SUGGESTION_TEXT];
    int n = 0;
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (takes(command, i)) {
            names[n++] = mt_options[i].name;
        }
    }
    length = length < sizeof given ? length : sizeof given - 1;
    memcpy(given, name, length);
    given[length] = '\0';
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (strcmp(given, mt_options[i].name) == 0 && command != MT_CMD_NONE) {
            return mt_fail(err, MT_E_USAGE, "\"%s\" has no option \"--%s\"",
                           mt_commands[command].name, given);
        }
    }
    return mt_fail(err, MT_E_USAGE, "unknown option \"--%s\"%s", given,
                   did_you_mean(given, names, n, "--", suggestion));
}

/* Read a whole number of at least 1. */
static mt_status read_count(const char *s, const char *option, int most, int *out, mt_err *err)
{
    char *end = NULL;
    errno = 0;
    const long value = strtol(s, &end, 10);
    if (s[0] < '0' || s[0] > '9' || *end != '\0' || errno != 0 || value < 1 || value > most) {
        return mt_fail(err, MT_E_USAGE, "--%s: \"%s\" is not a whole number from 1 to %d",
                       option, s, most);
    }
    *out = (int)value;
    return MT_OK;
}

/* A number from 0 up to 1. */
/* A number from 0 up to, and without, `most`. */
static bool read_below(const char *s, double most, double *out)
{
    char *end = NULL;
    *out = strtod(s, &end);
    return s[0] != '\0' && strspn(s, "0123456789.eE+-") == strlen(s) && *end == '\0' &&
           *out >= 0.0 && *out < most;
}

static mt_status read_absolute(const char *s, double *out, mt_err *err)
{
    return read_below(s, HUGE_VAL, out)
               ? MT_OK
               : mt_fail(err, MT_E_USAGE, "--abs-tol: \"%s\" is not a number from 0", s);
}

static mt_status read_tolerance(const char *s, const char *option, double *out, mt_err *err)
{
    double value = 0.0;
    if (!read_below(s, 1.0, &value)) {
        return mt_fail(err, MT_E_USAGE, "--%s: \"%s\" is not a number from 0 up to 1", option,
                       s);
    }
    *out = value;
    return MT_OK;
}

/* Read seconds: above 0, or 0 where allowed. */
static mt_status read_seconds(const char *s, const char *option, bool zero, double most,
                              double *out, mt_err *err)
{
    char *end = NULL;
    const double value = strtod(s, &end);
    const bool is_number = strspn(s, "0123456789.eE+-") == strlen(s) && *end == '\0';
    const bool is_enough = zero ? value >= 0.0 : value > 0.0;
    if (!is_number || !is_enough || !(value <= most)) {
        return mt_fail(err, MT_E_USAGE,
                       "--%s: \"%s\" is not a number of seconds %s, at most %g", option, s,
                       zero ? "from 0" : "above 0", most);
    }
    *out = value;
    return MT_OK;
}

/* Read a seed, with the range of a study's seed. */
static mt_status read_seed(const char *s, const char *option, unsigned long *out, mt_err *err)
{
    char *end = NULL;
    errno = 0;
    const unsigned long value = strtoul(s, &end, 10);
    if (s[0] < '0' || s[0] > '9' || *end != '\0' || errno != 0 || value > INT_MAX) {
        return mt_fail(err, MT_E_USAGE, "--%s: \"%s\" is not a whole number from 0 to %d",
                       option, s, INT_MAX);
    }
    *out = value;
    return MT_OK;
}

/* "2/8": part 2 of 8. */
static mt_status read_part(const char *s, const char *option, mt_args *out, mt_err *err)
{
    char *end = NULL;
    errno = 0;
    const long part = strtol(s, &end, 10);
    const char *const second = *end == '/' ? end + 1 : s;
    const long parts = strtol(second, &end, 10);
    if (s[0] < '0' || s[0] > '9' || second == s || second[0] < '0' || second[0] > '9' ||
        *end != '\0' || errno != 0 || part < 1 || part > parts || parts > INT_MAX) {
        return mt_fail(
            err, MT_E_USAGE,
            "--%s: \"%s\" is not PART/PARTS, two whole numbers from 1/1 on with PART "
            "not above PARTS",
            option, s);
    }
    out->part = (int)part;
    out->parts = (int)parts;
    return MT_OK;
}

const char *mt_format_of(int format, int command)
{
    enum {
        SHOW = 1 << MT_CMD_SHOW,
        PAGES = SHOW | 1 << MT_CMD_REPORT,
        MODEL = 1 << MT_CMD_APPLY,
        PROSE = 1 << MT_CMD_HELP
    };
    static const struct {
        const char *name;
        unsigned commands;
    } formats[MT_FORMATS] = {
        [MT_FORMAT_TEXT] = {"text", MT_ALL_COMMANDS & ~(unsigned)SHOW},
        [MT_FORMAT_JSON] = {"json", MT_ALL_COMMANDS & ~(unsigned)PROSE},
        [MT_FORMAT_CSV] = {"csv", MT_ALL_COMMANDS & ~(unsigned)(SHOW | MODEL | PROSE)},
        [MT_FORMAT_HTML] = {"html", PAGES},
        [MT_FORMAT_SARIF] = {"sarif", 1U << (unsigned)MT_CMD_CHECK}};
    const bool of = command == MT_CMD_NONE ? format <= MT_FORMAT_CSV
                                           : (formats[format].commands >> command & 1U) != 0U;
    return of ? formats[format].name : NULL;
}

/* One of a few words: *out its place among them. */
static mt_status read_word(const char *s, const char *option, const char *const *names, int n,
                           int *out, mt_err *err)
{
    char suggestion[SUGGESTION_TEXT];
    mt_text list = {.s = NULL};
    for (int i = 0; i < n; i++) {
        if (strcmp(s, names[i]) == 0) {
            *out = i;
            mt_text_free(&list);
            return MT_OK;
        }
        mt_text_addf(&list, "%s%s", i == 0 ? "" : ", ", names[i]);
    }
    const mt_status rc =
        list.failed ? mt_fail_memory(err)
                    : mt_fail(err, MT_E_USAGE, "--%s: \"%s\" is not one of %s%s", option, s,
                              list.s, did_you_mean(s, names, n, "", suggestion));
    mt_text_free(&list);
    return rc;
}

static mt_status read_format(const char *s, int command, mt_format *out, mt_err *err)
{
    const char *names[MT_FORMATS];
    mt_format of[MT_FORMATS];
    int at = 0;
    int n = 0;
    for (int i = 0; i < MT_FORMATS; i++) {
        const char *const known = mt_format_of(i, command);
        if (known != NULL) {
            of[n] = (mt_format)i;
            names[n++] = known;
        }
    }
    MT_TRY(read_word(s, "format", names, n, &at, err));
    *out = of[at];
    return MT_OK;
}

static mt_status read_report(const char *s, const char *option, bool *none, mt_err *err)
{
    static const char *const names[] = {"html", "none"};
    int at = 0;
    MT_TRY(read_word(s, option, names, MT_COUNT(names), &at, err));
    *none = at == 1;
    return MT_OK;
}

static mt_status read_progress(const char *s, const char *option, mt_progress_form *out,
                               mt_err *err)
{
    static const char *const names[] = {"auto", "line", "json", "none"};
    int at = 0;
    MT_TRY(read_word(s, option, names, MT_COUNT(names), &at, err));
    *out = (mt_progress_form)at;
    return MT_OK;
}

static mt_status read_shell(const char *s, const char *option, mt_shell *out, mt_err *err)
{
    static const char *const names[MT_SHELL_COUNT] = {"bash", "zsh"};
    int at = 0;
    MT_TRY(read_word(s, option, names, MT_COUNT(names), &at, err));
    *out = (mt_shell)at;
    return MT_OK;
}

static mt_status store_option_value(mt_args *args, int option, const char *value, mt_err *err)
{
    const mt_option *const o = &mt_options[option];
    if (args->given[option] && o->value != NULL && !o->repeats) {
        return mt_fail(err, MT_E_USAGE, "--%s is given twice", o->name);
    }
    args->given[option] = true;
    args->value[option] = value;
    if (value == NULL) {
        return MT_OK;
    }
    if (value[0] == '\0') {
        return mt_fail(err, MT_E_USAGE, "--%s: the value is empty", o->name);
    }
    if (o->repeats) {
        args->repeats[args->n_repeats++] =
            (mt_repeat){.option = (mt_option_id)option, .value = value};
        return MT_OK;
    }
    switch (option) {
    case MT_OPT_POINTS:
        return read_count(value, o->name, MT_CURVE_MOST, &args->points, err);
    case MT_OPT_KEEP:
        return read_count(value, o->name, INT_MAX, &args->keep, err);
    case MT_OPT_COUNT:
        args->count = INT_MAX;
        return strcmp(value, "all") == 0 ||
                       read_count(value, o->name, INT_MAX, &args->count, NULL) == MT_OK
                   ? MT_OK
                   : mt_fail(err, MT_E_USAGE,
                             "--%s: \"%s\" is neither \"all\" nor a whole number from 1 to %d",
                             o->name, value, INT_MAX);
    case MT_OPT_RANK:
        return read_count(value, o->name, INT_MAX, &args->rank, err);
    case MT_OPT_MODE:
        return read_count(value, o->name, INT_MAX, &args->mode, err);
    case MT_OPT_STARTS:
        return read_count(value, o->name, MT_STARTS_MOST, &args->starts, err);
    case MT_OPT_MAX_EVALUATIONS:
        return read_count(value, o->name, INT_MAX, &args->max_evaluations, err);
    case MT_OPT_MAX_MODAL_SOLUTIONS:
        return read_count(value, o->name, INT_MAX, &args->max_modal_solutions, err);
    case MT_OPT_THREADS:
        MT_TRY(read_count(value, o->name, MAX_THREADS, &args->threads, err));
        args->threads = args->threads < MT_WORKERS_MOST ? args->threads : MT_WORKERS_MOST;
        return MT_OK;
    case MT_OPT_TIME:
        return read_seconds(value, o->name, false, MT_SECONDS_MOST, &args->time_s, err);
    case MT_OPT_DURATION:
        return read_seconds(value, o->name, false, MT_SECONDS_MOST, &args->duration_s, err);
    case MT_OPT_DT_OUT:
        return read_seconds(value, o->name, false, MT_SECONDS_MOST, &args->dt_out_s, err);
    case MT_OPT_TOLERANCE:
        return read_tolerance(value, o->name, &args->tolerance, err);
    case MT_OPT_PROOF:
        return read_seconds(value, o->name, true, mt_possible_of[MT_POSSIBLE_PROOF].most,
                            &args->proof_s, err);
    case MT_OPT_SEED:
        return read_seed(value, o->name, &args->seed, err);
    case MT_OPT_REL_TOL:
        return read_tolerance(value, o->name, &args->rel_tol, err);
    case MT_OPT_ABS_TOL:
        return read_absolute(value, &args->abs_tol, err);
    case MT_OPT_SHARD:
        return read_part(value, o->name, args, err);
    case MT_OPT_MAX_MEMORY:
        return mt_limits_read_size(value, &args->max_memory, err);
    case MT_OPT_REPORT:
        return read_report(value, o->name, &args->no_report, err);
    case MT_OPT_PROGRESS:
        return read_progress(value, o->name, &args->progress, err);
    case MT_OPT_COMPLETION:
        return read_shell(value, o->name, &args->shell, err);
    case MT_OPT_FORMAT:
        return read_format(value, args->command, &args->format, err);
    default:
        return MT_OK;
    }
}

/* The argument at *at is an option: read it, with its value from the same or the next
 * argument. */
static mt_status read_long(mt_args *args, int argc, char *const argv[], int *at, mt_err *err)
{
    const char *const name = argv[*at] + 2;
    const size_t length = strcspn(name, "=");
    int option = MT_OPT_NONE;
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (strlen(mt_options[i].name) == length &&
            strncmp(name, mt_options[i].name, length) == 0 && takes(args->command, i)) {
            option = i;
        }
    }
    if (option == MT_OPT_NONE) {
        return unknown_option(args->command, name, length, err);
    }
    const bool attached = name[length] == '=';
    if (mt_options[option].value == NULL) {
        return attached
                   ? mt_fail(err, MT_E_USAGE, "--%s takes no value", mt_options[option].name)
                   : store_option_value(args, option, NULL, err);
    }
    if (!attached && *at + 1 >= argc) {
        return mt_fail(err, MT_E_USAGE, "--%s needs a value: %s", mt_options[option].name,
                       mt_options[option].value);
    }
    return store_option_value(args, option, attached ? name + length + 1 : argv[++*at], err);
}

static mt_status read_short(mt_args *args, int argc, char *const argv[], int *at, mt_err *err)
{
    const char *const text = argv[*at] + 1;
    for (int i = 0; i < MT_OPT_IDS; i++) {
        const mt_option *const o = &mt_options[i];
        if (o->letter != text[0] || !takes(args->command, i)) {
            continue;
        }
        if (o->value == NULL) {
            return text[1] == '\0' ? store_option_value(args, i, NULL, err)
                                   : mt_fail(err, MT_E_USAGE, "-%c takes no value", o->letter);
        }
        if (text[1] == '\0' && *at + 1 >= argc) {
            return mt_fail(err, MT_E_USAGE, "-%c needs a value: %s", o->letter, o->value);
        }
        return store_option_value(args, i, text[1] != '\0' ? text + 1 : argv[++*at], err);
    }
    return mt_fail(err, MT_E_USAGE, "unknown option \"-%s\"", text);
}

int mt_command_named(const char *name)
{
    for (int i = 0; i < MT_CMD_IDS; i++) {
        if (strcmp(mt_commands[i].name, name) == 0) {
            return i;
        }
    }
    return MT_CMD_NONE;
}

static mt_status read_command(mt_args *args, const char *name, mt_err *err)
{
    const char *names[MT_CMD_IDS];
    char suggestion[SUGGESTION_TEXT];
    args->command = mt_command_named(name);
    if (args->command != MT_CMD_NONE) {
        return MT_OK;
    }
    for (int i = 0; i < MT_CMD_IDS; i++) {
        names[i] = mt_commands[i].name;
    }
    return mt_fail(err, MT_E_USAGE, "unknown command \"%s\"%s", name,
                   did_you_mean(name, names, MT_CMD_IDS, "", suggestion));
}

static mt_status check_operands(const mt_args *args, mt_err *err)
{
    if (args->given[MT_OPT_HELP] || args->given[MT_OPT_MANUAL] ||
        args->given[MT_OPT_COMPLETION] || args->given[MT_OPT_VERSION]) {
        return MT_OK;
    }
    if (args->command == MT_CMD_NONE) {
        return mt_fail(err, MT_E_USAGE, "a command is missing");
    }
    const mt_command *const c = &mt_commands[args->command];
    if (args->n_operands < c->least) {
        return mt_fail(err, MT_E_USAGE, "\"%s\" needs %s", c->name, c->operands);
    }
    if (c->most >= 0 && args->n_operands > c->most) {
        return mt_fail(err, MT_E_USAGE, "\"%s\" takes %s, and \"%s\" is too many", c->name,
                       c->operands, args->operands[c->most]);
    }
    return MT_OK;
}

/* The values of each option that may be repeated, one behind the other. */
static void group_repeated_values(mt_args *args)
{
    const char **at = args->pool;
    for (int option = 0; option < MT_OPT_IDS; option++) {
        mt_values *const to = &args->all[option];
        *to = (mt_values){.value = at};
        for (int i = 0; i < args->n_repeats; i++) {
            if (args->repeats[i].option == (mt_option_id)option) {
                to->value[to->n++] = args->repeats[i].value;
            }
        }
        at += to->n;
    }
}

mt_status mt_args_parse(int argc, char *const argv[], mt_args *out, mt_err *err)
{
    const size_t room = argc > 0 ? (size_t)argc : 1;
    bool operands_only = false;
    *out = (mt_args){.command = MT_CMD_NONE, .rank = 1, .threads = 1};
    out->operands = calloc(room, sizeof *out->operands);
    out->pool = calloc(room, sizeof *out->pool);
    out->repeats = calloc(room, sizeof *out->repeats);
    if (out->operands == NULL || out->pool == NULL || out->repeats == NULL) {
        return mt_fail(err, MT_E_MEMORY, "out of memory");
    }
    for (int i = 1; i < argc; i++) {
        const char *const s = argv[i];
        mt_status rc = MT_OK;
        if (!operands_only && strcmp(s, "--") == 0) {
            operands_only = true;
        } else if (!operands_only && strncmp(s, "--", 2) == 0) {
            rc = read_long(out, argc, argv, &i, err);
        } else if (!operands_only && s[0] == '-' && s[1] != '\0') {
            rc = read_short(out, argc, argv, &i, err);
        } else if (out->command == MT_CMD_NONE) {
            rc = read_command(out, s, err);
        } else {
            out->operands[out->n_operands++] = s;
        }
        MT_TRY(rc);
    }
    group_repeated_values(out);
    return check_operands(out, err);
}

void mt_args_free(mt_args *args)
{
    free((void *)args->operands);
    free((void *)args->pool);
    free(args->result_path);
    free(args->repeats);
    *args = (mt_args){.command = MT_CMD_NONE};
}
