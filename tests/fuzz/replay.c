/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a fuzz target over a corpus where libFuzzer is not linked: every file of the folder given,
 * in the order of their names, and always the empty input. No file is an error, not a pass. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MAX_PATH_LENGTH = 4096 };

/* The whole file in memory of its exact size, so that a read past the end is seen; NULL on error. */
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

/* 0: fed to the target, or a hidden name; 1: cannot be read. */
static int run_file(const char *folder, const char *name, int *files)
{
    char path[MAX_PATH_LENGTH];
    if (name[0] == '.') {
        return 0;
    }
    const int length = snprintf(path, sizeof path, "%s/%s", folder, name);
    if (length < 0 || length >= MAX_PATH_LENGTH) {
        return 1;
    }
    size_t size = 0;
    uint8_t *const data = read_all(path, &size);
    if (data == NULL) {
        (void)fprintf(stderr, "%s: cannot be read\n", path);
        return 1;
    }
    (void)LLVMFuzzerTestOneInput(data, size);
    free(data);
    ++*files;
    return 0;
}

int main(int argc, char **argv)
{
    struct dirent **entries = NULL;
    int files = 0;
    int failed = 0;
    if (argc != 2) {
        (void)fprintf(stderr, "usage: %s CORPUS\n", argv[0]);
        return 2;
    }
    const int n = scandir(argv[1], &entries, NULL, alphasort);
    for (int i = 0; i < n; i++) {
        failed |= run_file(argv[1], entries[i]->d_name, &files);
        free(entries[i]);
    }
    free(entries);
    const uint8_t nothing = 0;
    (void)LLVMFuzzerTestOneInput(&nothing, 0);
    printf("%d inputs from %s\n", files, argv[1]);
    return failed != 0 || files == 0;
}
