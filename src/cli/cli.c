/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program but for main: limits of memory, and the call of a command. */
/* Which processors are the process's own is not in POSIX. */
#define _GNU_SOURCE /* NOLINT(cert-dcl37-c,cert-dcl51-cpp): for the system, not ours */

#include "cli/cli.h"

#include <inttypes.h>
#include <malloc.h>
#include <sched.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/base.h"
#include "base/workers.h"
#include "cli/args.h"
#include "io/file.h"
#include "io/folder.h"
#include "linalg/dense.h"
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

/* The program. */

#define ENTRY(id, name) [MT_CMD_##id] = &mt_command_##name,
const mt_command *const mt_commands[MT_CMD_IDS] = {MT_COMMAND_LIST(ENTRY)};

static int wrong_use(const mt_args *args, mt_status rc, const mt_err *err)
{
    mt_terminal_error("%s", err->text);
    if (args->renewed.s != NULL && !args->renewed.failed) {
        mt_terminal_talk(false, "Type: %s", args->renewed.s);
    } else if (rc == MT_E_USAGE) {
        mt_terminal_talk(false, "Try \"modetune%s%s --help\".",
                         args->command == MT_CMD_NONE ? "" : " ",
                         args->command == MT_CMD_NONE ? "" : mt_commands[args->command]->name);
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

/* Write the file of --output, completely or not at all. */
static mt_status save_output_file(const mt_args *args, const mt_text *text, mt_err *err)
{
    const char *const path = args->value[MT_OPT_FILE];
    const char *const name = mt_text_base_name(path);
    if (name[0] == '\0' || strcmp(name, ".") == 0 || strcmp(name, "..") == 0) {
        return mt_fail(err, MT_E_USAGE, "--output: \"%s\" is not the name of a file", path);
    }
    if (strlen(name) >= MT_FOLDER_NAME) {
        return mt_fail(err, MT_E_USAGE, "--output: the name \"%s\" is too long", name);
    }
    char *const folder = mt_file_folder(path);
    if (folder == NULL || text->failed) {
        free(folder);
        return mt_fail_memory(err);
    }
    const mt_folder_file file = {name, text->s, text->length};
    const mt_status rc = mt_folder_replace(folder, &file, 1, err);
    free(folder);
    MT_TRY(rc);
    mt_terminal_talk(
        args->given[MT_OPT_QUIET], "%s: written to %s",
        args->n_operands > 0 ? args->operands[0] : mt_commands[args->command]->name, path);
    return MT_OK;
}

/* Call the command; where --output names one file, that takes the place of standard output. */
static int run_command(const mt_args *args, mt_text *out)
{
    mt_err err = {.code = MT_OK};
    int code = mt_commands[args->command]->run(args, out);
    if (!args->given[MT_OPT_FILE]) {
        return code;
    }
    if (code == MT_EXIT_DONE) {
        const mt_status rc = save_output_file(args, out, &err);
        code = rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
    }
    mt_text_free(out);
    return code;
}

int mt_cli_main(int argc, char *const argv[])
{
    mt_args args;
    mt_err err = {.code = MT_OK};
    mt_text out = {.s = NULL};
    int code = MT_EXIT_DONE;
    const mt_status rc = mt_args_parse(argc, argv, mt_commands, &args, &err);
    if (rc != MT_OK) {
        code = wrong_use(&args, rc, &err);
    } else if (args.given[MT_OPT_VERSION] || args.given[MT_OPT_MANUAL] ||
               args.given[MT_OPT_COMPLETION] || args.given[MT_OPT_HELP]) {
        code = mt_command_help.run(&args, &out);
    } else {
        mt_status ready = limits_set(&args, &err);
        ready = ready == MT_OK ? find_result(&args, &err) : ready;
        code = ready == MT_OK ? run_command(&args, &out) : mt_cli_failed(ready, &err);
    }
    code = mt_exit_worse(code, mt_terminal_put(&out));
    if (mt_exit_without_memory()) {
        limits_explain();
    }
    mt_args_free(&args);
    return code;
}
