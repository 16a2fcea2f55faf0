/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program but for main: limits of memory, what commands share, --help, and the call of a
 * command. */
/* Which processors are the process's own is not in POSIX. */
#define _GNU_SOURCE /* NOLINT(cert-dcl37-c,cert-dcl51-cpp): for the system, not ours */

#include "cli/cli.h"

#include "modetune/version.h"

#include <inttypes.h>
#include <malloc.h>
#include <sched.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/base.h"
#include "base/format.h"
#include "base/workers.h"
#include "cli/args.h"
#include "cli/help.h"
#include "io/file.h"
#include "linalg/dense.h"
#include "mechanics/linear.h"
#include "report/table.h"
#include "result/folder.h"

/*
 * How much memory the program may have. The system counts (RLIMIT_DATA: private writable
 * memory, whoever asks for it), so that nothing is missed; a request beyond is refused and ends
 * as MT_E_MEMORY. What is there already does not count: the buffers of OpenBLAS are address
 * space above all.
 */

/* The runtimes of sanitizers claim more than any limit. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#    define WITH_SANITIZER 1
#elif defined(__has_feature)
#    if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#        define WITH_SANITIZER 1
#    endif
#endif

static const uint64_t KIB = 1024;
enum { LARGE_BLOCK = 1 << 20 };

mt_status mt_limits_read_size(const char *text, uint64_t *bytes, mt_err *err)
{
    static const char units[] = "kMGT";
    const uint64_t least = KIB * KIB;
    const uint64_t most = (uint64_t)1 << 50U;
    uint64_t size = 0;
    const char *s = text;
    for (; *s >= '0' && *s <= '9' && size <= most; s++) {
        size = 10 * size + (uint64_t)(*s - '0');
    }
    const char *const unit = s == text || *s == '\0' ? NULL : strchr(units, *s);
    for (const char *u = units; unit != NULL && u <= unit && size <= most; u++) {
        size *= KIB;
    }
    s += unit == NULL ? 0 : 1;
    if (*s != '\0' || size < least || size > most) {
        return mt_fail(err, MT_E_USAGE,
                       "--max-memory: \"%s\" is not a size from 1M to 1024T (\"500M\", \"8G\")",
                       text);
    }
    *bytes = size;
    return MT_OK;
}

/* what the limit that was set leaves to the program; 0: none was */
static uint64_t granted = 0;

#ifndef WITH_SANITIZER

/* The number in a file of one number; 0 where there is none. */
static uint64_t number_in(const char *path, int place)
{
    char text[256];
    const int fd = mt_file_open(MT_FILE_HERE, path);
    const ssize_t length = fd < 0 ? -1 : read(fd, text, sizeof text - 1);
    if (fd >= 0) {
        (void)close(fd);
    }
    text[length > 0 ? length : 0] = '\0';
    const char *at = length > 0 ? text : NULL;
    char *end = NULL;
    uint64_t number = 0;
    for (int i = 0; i <= place && at != NULL; i++) {
        number = strtoumax(at, &end, 10);
        at = end == at ? NULL : end;
    }
    return at == NULL ? 0 : number;
}

/* Half of the memory of the machine or of its container. */
static uint64_t share_of_machine(void)
{
    static const char *const containers[] = {"/sys/fs/cgroup/memory.max",
                                             "/sys/fs/cgroup/memory/memory.limit_in_bytes"};
    const long pages = sysconf(_SC_PHYS_PAGES);
    const long page = sysconf(_SC_PAGESIZE);
    uint64_t all = pages > 0 && page > 0 ? (uint64_t)pages * (uint64_t)page : UINT64_MAX;
    for (int i = 0; i < MT_COUNT(containers); i++) {
        const uint64_t most = number_in(containers[i], 0);
        all = most > 0 && most < all ? most : all;
    }
    return all / 2;
}

/* Bytes that the process has now, as RLIMIT_DATA counts; and the stacks of workers that are to
 * come. */
static uint64_t have_already(int workers)
{
    enum { DATA_PAGES = 5 }; /* the sixth number of statm */
    const uint64_t stack = 8 * KIB * KIB;
    const long page = sysconf(_SC_PAGESIZE);
    const uint64_t data = number_in("/proc/self/statm", DATA_PAGES) * (uint64_t)page;
    const uint64_t known = data > 0 ? data : (uint64_t)workers * MT_BLAS_BUFFER;
    return known + (uint64_t)(workers - 1) * stack;
}

/* Lower the soft limit; false where the system's own is as low. */
static bool lower_limit(uint64_t bytes)
{
    struct rlimit now;
    if (getrlimit(RLIMIT_DATA, &now) != 0 || (rlim_t)bytes >= now.rlim_cur) {
        return false;
    }
    now.rlim_cur = (rlim_t)bytes;
    return setrlimit(RLIMIT_DATA, &now) == 0;
}
#endif

/* Processors that the process may use, which a batch system may have made fewer. */
static int processors(void)
{
    cpu_set_t set;
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    const long n = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : online;
    return n < 1 ? 1 : n < MT_WORKERS_MOST ? (int)n : MT_WORKERS_MOST;
}

/* Allocate blocks from a megabyte on from the system directly: their pages are zero without
 * being written, and are returned when freed. By default the C library raises that size to 32
 * megabytes. */
static void map_large_blocks(void)
{
#ifdef M_MMAP_THRESHOLD
    (void)mallopt(M_MMAP_THRESHOLD, LARGE_BLOCK);
#endif
}

/* Reserve OpenBLAS's memory for the workers (without --threads: as many as the process has
 * processors, or one where they cannot all have it), then limit the memory of the process to
 * what it has plus --max-memory (default: half of the machine's memory or of its container's).
 * Never raises a limit of the system; no limit where a sanitizer needs address space. Fails:
 * MT_E_MEMORY. */
static mt_status limits_set(mt_args *args, mt_err *err)
{
    map_large_blocks();
    const bool free =
        !args->given[MT_OPT_THREADS] && mt_option_is_of(MT_OPT_THREADS, args->command);
    args->threads = free ? processors() : args->threads;
    if (free && mt_blas_claim(args->threads, NULL) != MT_OK) {
        args->threads = 1;
    }
    MT_TRY(mt_blas_claim(args->threads, err));
#ifndef WITH_SANITIZER
    const uint64_t share = args->max_memory > 0 ? args->max_memory : share_of_machine();
    granted = lower_limit(have_already(args->threads) + share) ? share : 0;
#endif
    return MT_OK;
}

/* Write a line that names the limit to standard error. */
static void limits_explain(void)
{
    static const char *const units[] = {"MB", "GB", "TB"};
    double size = (double)granted / (double)(KIB * KIB);
    int unit = 0;
    while (size >= (double)KIB && unit + 1 < MT_COUNT(units)) {
        size /= (double)KIB;
        unit++;
    }
    if (granted > 0) {
        mt_terminal_talk(false, "The program may use %.3g %s (--max-memory).", size,
                         units[unit]);
    }
}

/* What commands share, and the call of one. */

/* What the commands share: how they say what went wrong, and facts that several tell. */

int mt_cli_failed(mt_status rc, const mt_err *err)
{
    mt_terminal_error("%s", err->text);
    if (rc == MT_E_MEMORY) {
        mt_terminal_drop();
    }
    return mt_exit_of(rc);
}

int mt_cli_loaded(mt_status rc, mt_diagnostics *messages, const mt_err *err)
{
    const bool told = mt_diagnostics_first_error(messages) >= 0;
    mt_err shortage = {.code = MT_OK};
    if (messages->lines.failed && rc != MT_E_MEMORY) { /* some of them are missing */
        rc = mt_fail_memory(&shortage);
        err = &shortage;
    }
    mt_terminal_diagnostics(mt_diagnostics_text(messages));
    mt_diagnostics_free(messages);
    if (rc != MT_OK && !(told && rc == MT_E_INPUT)) {
        return mt_cli_failed(rc, err);
    }
    return mt_exit_of(rc);
}

void mt_cli_place(const mt_study *study, const char *path, mt_status rc, mt_err *err,
                  mt_diagnostics *messages)
{
    mt_diagnostic_place place = {.file = path};
    if (rc != MT_E_INPUT || !mt_study_locate(study, err->text, &place.line, &place.column)) {
        (void)mt_err_in(err, rc, "%s", path);
        return;
    }
    mt_diagnostics_add(messages, MT_SEVERITY_ERROR, &place, err->text);
}

mt_io_options mt_cli_io(const mt_args *args)
{
    const mt_io_options opt = {.root = args->value[MT_OPT_ROOT]};
    return opt;
}

int mt_cli_json_done(mt_json_writer *w)
{
    if (mt_json_done(w)) {
        return MT_EXIT_DONE;
    }
    if (!w->misused) {
        return MT_EXIT_SYSTEM; /* mt_terminal_put tells */
    }
    mt_terminal_error("the output cannot be written as JSON");
    return MT_EXIT_NUMERICAL;
}

void mt_cli_json_failed(mt_json_writer *w, const char *configuration, const mt_err *err)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "configuration", configuration);
    mt_json_put_string(w, "error", err->text);
    mt_json_close(w);
}

void mt_cli_print_warnings(const mt_warning_list *list, mt_text *out)
{
    for (int i = 0; i < list->n; i++) {
        const mt_warning *const d = &list->items[i];
        mt_text_addf(out, "  %s: %s\n", d->level == MT_LEVEL_WARNING ? "doubtful" : "note",
                     d->text);
    }
}

void mt_cli_json_dead_centre(mt_json_writer *w, const mt_nearness *nearness)
{
    if (!nearness->near) {
        mt_json_put_null(w, "dead_centre");
        return;
    }
    mt_json_open(w, "dead_centre", '{');
    mt_json_put_number(w, "distance", nearness->distance);
    mt_json_put_number(w, "independence", nearness->independence);
    mt_cli_json_joints(w, "joints", &nearness->joints);
    mt_json_close(w);
}

void mt_cli_json_joints(mt_json_writer *w, const char *member, const mt_joint_names *joints)
{
    mt_json_open_flat(w, member, '[');
    for (int i = 0; i < joints->n; i++) {
        mt_json_put_string(w, NULL, joints->name[i]);
    }
    mt_json_close(w);
}

mt_status mt_cli_json_redundant(mt_json_writer *w, mt_linear *lin, mt_arena *mem, mt_err *err)
{
    mt_json_open(w, "redundant_constraints", '[');
    for (int k = 0; k < mt_linear_redundant(lin); k++) {
        mt_joint_names joints;
        MT_TRY(mt_linear_redundant_set(lin, k, mem, &joints, err));
        mt_cli_json_joints(w, NULL, &joints);
    }
    mt_json_close(w);
    return MT_OK;
}

mt_status mt_cli_recommendation(const mt_args *args, const mt_result *result,
                                const mt_recommendation **out, mt_err *err)
{
    const int n = result->n_recommendations;
    for (int i = 0; i < n; i++) {
        if (result->recommendations[i].rank == args->rank) {
            *out = &result->recommendations[i];
            return MT_OK;
        }
    }
    return mt_fail(err, MT_E_USAGE, "%s has %d recommendation%s: there is no rank %d",
                   args->operands[0], n, n == 1 ? "" : "s", args->rank);
}

/* --model takes a file as it is, with a warning where it is not what was solved; without it the
 * model is looked for (io/result_model.h). */

mt_status mt_find_model(const mt_args *args, const mt_result *result, mt_file *file,
                        char **path, mt_err *err)
{
    const char *const given = args->value[MT_OPT_MODEL];
    const char *const root = args->value[MT_OPT_ROOT];
    if (given == NULL) {
        return mt_result_find_model(args->operands[0], result, root, file, path, err);
    }
    MT_TRY(mt_file_read(given, root, MT_JSON_MAX_BYTES, file, err));
    const char *const hash = mt_result_model_sha256(result);
    if (hash == NULL || strcmp(hash, file->sha256) != 0) {
        mt_terminal_warning("%s is not what was solved: it has changed since", given);
    }
    *path = mt_file_join("x", given);
    return *path == NULL ? mt_fail_memory(err) : MT_OK;
}

/* modetune run and modes: how often each stage of the evaluations was done. */

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

/* --help, from the tables. */

enum { OPTION_COLUMN = 31, EXIT_COLUMN = 7, LINE_WIDTH = 92, FORM_TEXT = 64 };

static void spaces(int n, mt_text *out)
{
    for (int i = 0; i < n; i++) {
        mt_text_add(out, " ");
    }
}

void mt_help_fill(const char *s, int column, mt_text *out)
{
    int at = column;
    for (const char *word = s; *word != '\0'; word += strspn(word, " \n")) {
        const int length = (int)strcspn(word, " \n");
        const bool paragraph = word > s && word[-1] == '\n';
        if (paragraph || (at > column && at + 1 + length > LINE_WIDTH)) {
            mt_text_add(out, "\n");
            spaces(column, out);
            at = column;
        } else if (at > column) {
            mt_text_add(out, " ");
            at++;
        }
        mt_text_add_n(out, word, (size_t)length);
        at += length;
        word += length;
    }
    mt_text_add(out, "\n");
}

static void help_option(const mt_option *o, mt_text *out)
{
    char form[FORM_TEXT];
    const int n =
        mt_snprintf(form, sizeof form, "  %c%c%s--%s%s%s", o->letter == '\0' ? ' ' : '-',
                    o->letter == '\0' ? ' ' : o->letter, o->letter == '\0' ? "  " : ", ",
                    o->name, o->value == NULL ? "" : " ", o->value == NULL ? "" : o->value);
    mt_text_add(out, form);
    if (n + 2 > OPTION_COLUMN) {
        mt_text_add(out, "\n");
        spaces(OPTION_COLUMN, out);
    } else {
        spaces(OPTION_COLUMN - n, out);
    }
    mt_help_fill(o->help, OPTION_COLUMN, out);
}

static void help_command(int command, mt_text *out)
{
    const mt_command *const c = &mt_commands[command];
    mt_text_addf(out, "Usage: modetune %s %s [options]\n\n", c->name, c->operands);
    mt_help_fill(c->details, 0, out);
    mt_text_add(out, "\nOptions:\n");
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_option_is_of(i, command)) {
            help_option(&mt_options[i], out);
        }
    }
}

void mt_help(int command, mt_text *out)
{
    if (command != MT_CMD_NONE) {
        help_command(command, out);
        return;
    }
    mt_text_add(
        out, "Usage: modetune COMMAND ...\n\n"
             "Tells what to change so that the natural frequencies of a mechanism land where "
             "they must.\n\nCommands:\n");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "  %-12s %s\n", mt_commands[i].name, mt_commands[i].summary);
    }
    mt_text_add(out, "\nOptions of every command:\n");
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_options[i].commands == MT_ALL_COMMANDS || mt_options[i].commands == 0U) {
            help_option(&mt_options[i], out);
        }
    }
    mt_text_add(out, "\n\"modetune COMMAND --help\" explains a command, \"modetune help "
                     "TOPIC\" a command or a "
                     "word of a\nmodel, a study or a result.\n\nExit status:\n");
    for (int i = 0; i < MT_EXITS; i++) {
        mt_text_addf(out, "  %-4d ", mt_exits[i].code);
        mt_help_fill(mt_exits[i].meaning, EXIT_COLUMN, out);
    }
}

/* The program. */

typedef int (*command_function)(const mt_args *args, mt_text *out);

static const command_function functions[MT_CMD_IDS] = {
    [MT_CMD_RUN] = mt_cmd_run,           [MT_CMD_MERGE] = mt_cmd_merge,
    [MT_CMD_COMPARE] = mt_cmd_compare,   [MT_CMD_MODES] = mt_cmd_modes,
    [MT_CMD_MAC] = mt_cmd_mac,           [MT_CMD_SWEEP] = mt_cmd_sweep,
    [MT_CMD_SIMULATE] = mt_cmd_simulate, [MT_CMD_SENSITIVITY] = mt_cmd_sensitivity,
    [MT_CMD_RESPONSE] = mt_cmd_response, [MT_CMD_INFO] = mt_cmd_info,
    [MT_CMD_SHOW] = mt_cmd_show,         [MT_CMD_REPORT] = mt_cmd_report,
    [MT_CMD_EXPLAIN] = mt_cmd_explain,   [MT_CMD_APPLY] = mt_cmd_apply,
    [MT_CMD_DIFF] = mt_cmd_diff,         [MT_CMD_CHECK] = mt_cmd_check,
    [MT_CMD_INIT] = mt_cmd_init,         [MT_CMD_EXAMPLES] = mt_cmd_examples,
    [MT_CMD_SCHEMA] = mt_cmd_schema,     [MT_CMD_PROFILE] = mt_cmd_profile,
    [MT_CMD_HELP] = mt_cmd_help,
};

static int wrong_use(const mt_args *args, mt_status rc, const mt_err *err)
{
    mt_terminal_error("%s", err->text);
    if (rc == MT_E_USAGE) {
        mt_terminal_talk(false, "Try \"modetune%s%s --help\".",
                         args->command == MT_CMD_NONE ? "" : " ",
                         args->command == MT_CMD_NONE ? "" : mt_commands[args->command].name);
    }
    return mt_exit_of(rc);
}

/* Commands that read one result accept its folder, too. */
static mt_status find_result(mt_args *args, mt_err *err)
{
    static const unsigned READERS =
        1U << MT_CMD_REPORT | 1U << MT_CMD_EXPLAIN | 1U << MT_CMD_APPLY | 1U << MT_CMD_SHOW;
    if ((READERS >> (unsigned)args->command & 1U) == 0) {
        return MT_OK;
    }
    MT_TRY(mt_result_path(args->operands[0], &args->result_path, err));
    args->operands[0] = args->result_path;
    return MT_OK;
}

int mt_cli_main(int argc, char *const argv[])
{
    mt_args args;
    mt_err err = {.code = MT_OK};
    mt_text out = {.s = NULL};
    int code = MT_EXIT_DONE;
    const mt_status rc = mt_args_parse(argc, argv, &args, &err);
    if (rc != MT_OK) {
        code = wrong_use(&args, rc, &err);
    } else if (args.given[MT_OPT_VERSION]) {
        mt_text_addf(&out, "modetune %s (commit %s, compiled by %s)\n", mt_version(),
                     mt_build_commit(), mt_build_compiler());
    } else if (args.given[MT_OPT_MANUAL]) {
        mt_manual(args.command, &out);
    } else if (args.given[MT_OPT_COMPLETION]) {
        mt_completion(args.shell, &out);
    } else if (args.given[MT_OPT_HELP]) {
        mt_help(args.command, &out);
    } else {
        mt_status ready = limits_set(&args, &err);
        ready = ready == MT_OK ? find_result(&args, &err) : ready;
        code =
            ready == MT_OK ? functions[args.command](&args, &out) : mt_cli_failed(ready, &err);
    }
    code = mt_exit_worse(code, mt_terminal_put(&out));
    if (mt_exit_without_memory()) {
        limits_explain();
    }
    mt_args_free(&args);
    return code;
}
