/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Runs a fuzz target where libFuzzer is not linked: every file of the corpus folder, every seed
 * of a list, the empty input, and then mutants of all of them:
 *     fuzz_model CORPUS [SEEDS [RUNS [SEED]]]
 * SEEDS: a file with names between commas. No file is an error, not a pass. What a mutant
 * breaks is left in the file TARGET.broken in the current folder (the target's input as it is).
 */
#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/fuzz.h"

#if defined(__SANITIZE_ADDRESS__)
#    define WITH_SANITIZER 1
#elif defined(__has_feature)
#    if __has_feature(address_sanitizer)
#        define WITH_SANITIZER 1
#    endif
#endif
#ifdef WITH_SANITIZER
#    include <sanitizer/common_interface_defs.h>
#endif

enum { MAX_PATH_LENGTH = 4096, MAX_INPUTS = 2000, MAX_SIZE = 32768, LIST_SIZE = 1 << 16 };

typedef struct input {
    uint8_t *data;
    size_t size;
} input;

static input inputs[MAX_INPUTS];
static int n_inputs;

/* The whole file in memory of its exact size, so that a read past the end is seen; NULL on
 * error. */
static uint8_t *read_all(const char *path, size_t *size)
{
    struct stat info;
    FILE *const file = fopen(path, "rb");
    uint8_t *data = NULL;
    if (file == NULL) {
        return NULL;
    }
    if (stat(path, &info) == 0 && info.st_size >= 0) {
        *size = (size_t)info.st_size;
        data = malloc(*size > 0 ? *size : 1);
        if (data != NULL && fread(data, 1, *size, file) != *size) {
            free(data);
            data = NULL;
        }
    }
    (void)fclose(file);
    return data;
}

/* 0: fed to the target and kept; 1: cannot be read. */
static int run_file(const char *path)
{
    size_t size = 0;
    uint8_t *const data = read_all(path, &size);
    if (data == NULL || n_inputs == MAX_INPUTS) {
        (void)fprintf(stderr, "%s: cannot be read\n", path);
        free(data);
        return 1;
    }
    (void)LLVMFuzzerTestOneInput(data, size);
    inputs[n_inputs++] = (input){data, size};
    return 0;
}

static int run_folder(const char *folder)
{
    struct dirent **entries = NULL;
    int failed = 0;
    const int n = scandir(folder, &entries, NULL, alphasort);
    for (int i = 0; i < n; i++) {
        char path[MAX_PATH_LENGTH];
        const int length = snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.') {
            failed |= length < 0 || length >= MAX_PATH_LENGTH ? 1 : run_file(path);
        }
        free(entries[i]);
    }
    free(entries);
    return failed;
}

static int run_list(const char *list)
{
    size_t size = 0;
    int failed = 0;
    char names[LIST_SIZE] = "";
    uint8_t *const data = read_all(list, &size);
    if (data == NULL || size >= sizeof names) {
        free(data);
        return 1;
    }
    memcpy(names, data, size);
    free(data);
    for (char *name = names; name != NULL && *name != '\0';) {
        char *const comma = strchr(name, ',');
        if (comma != NULL) {
            *comma = '\0';
        }
        failed |= run_file(name);
        name = comma == NULL ? NULL : comma + 1;
    }
    return failed;
}

static char broken[MAX_PATH_LENGTH];
static const uint8_t *present; /* the mutant that is being tried */
static size_t present_size;

/* The last act of a process that dies: nothing but system calls. */
static void keep_broken(void)
{
    const int file = present == NULL ? -1 : open(broken, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file >= 0) {
        (void)!write(file, present, present_size);
        (void)close(file);
    }
    present = NULL;
}

static void die(int signal_number)
{
    keep_broken();
    (void)signal(signal_number, SIG_DFL);
    (void)raise(signal_number);
}

static void expect_death(const char *program)
{
    const char *const slash = strrchr(program, '/');
    (void)snprintf(broken, sizeof broken, "%s.broken", slash == NULL ? program : slash + 1);
    (void)signal(SIGABRT, die);
#ifdef WITH_SANITIZER
    __sanitizer_set_death_callback(keep_broken);
#else
    (void)signal(SIGSEGV, die);
    (void)signal(SIGBUS, die);
    (void)signal(SIGFPE, die);
#endif
}

static void run_mutants(const char *program, long runs, uint64_t seed)
{
    uint8_t *const data = malloc(MAX_SIZE);
    fuzz_random r = fuzz_random_seed(seed);
    expect_death(program);
    for (long i = 0; i < runs && data != NULL && n_inputs > 0; i++) {
        const input *const from = &inputs[fuzz_below(&r, (size_t)n_inputs)];
        const input *const other = &inputs[fuzz_below(&r, (size_t)n_inputs)];
        size_t size = from->size < MAX_SIZE ? from->size : MAX_SIZE;
        memcpy(data, from->data, size);
        size = fuzz_mutate(&r, data, size, MAX_SIZE, other->data, other->size);
        uint8_t *const exact = malloc(size > 0 ? size : 1);
        if (exact != NULL) {
            memcpy(exact, data, size);
            present = exact;
            present_size = size;
            (void)LLVMFuzzerTestOneInput(exact, size);
            present = NULL;
        }
        free(exact);
    }
    free(data);
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        (void)fprintf(stderr, "usage: %s CORPUS [SEEDS [RUNS [SEED]]]\n", argv[0]);
        return 2;
    }
    int failed = run_folder(argv[1]);
    failed |= argc > 2 ? run_list(argv[2]) : 0;
    const uint8_t nothing = 0;
    (void)LLVMFuzzerTestOneInput(&nothing, 0);
    const long runs = argc > 3 ? strtol(argv[3], NULL, 10) : 0;
    const uint64_t seed = argc > 4 ? strtoull(argv[4], NULL, 10) : 1;
    printf("%d inputs, %ld mutants, seed %llu\n", n_inputs, runs, (unsigned long long)seed);
    (void)fflush(stdout);
    run_mutants(argv[0], runs, seed);
    for (int i = 0; i < n_inputs; i++) {
        free(inputs[i].data);
    }
    return failed != 0 || n_inputs == 0;
}
