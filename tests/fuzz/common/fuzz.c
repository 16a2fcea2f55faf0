/* SPDX-License-Identifier: GPL-3.0-or-later */
/* realpath and mkdtemp are in POSIX.1-2008, but the C library shows them only with X/Open:
 * asked for before any header. */
#define _XOPEN_SOURCE 700 /* NOLINT(cert-dcl37-c,cert-dcl51-cpp): for the system, not ours */

#include "common/fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH_SIZE = 256, MAX_NAMES = 8 };

void fuzz_broken(const char *text, const char *file, int line)
{
    (void)fprintf(stderr, "%s:%d: broken: %s\n", file, line, text);
    abort();
}

static bool is_letter(unsigned char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           c == '_' || c >= 0x80U;
}

static bool has_word(const char *s, size_t length, const char *word)
{
    const size_t n = strlen(word);
    for (size_t i = 0; i + n <= length; i++) {
        if (strncasecmp(s + i, word, n) == 0 &&
            (i == 0 || !is_letter((unsigned char)s[i - 1])) &&
            (i + n == length || !is_letter((unsigned char)s[i + n]))) {
            return true;
        }
    }
    return false;
}

void fuzz_requirement_finite_words(const mt_text *said, const uint8_t *data, size_t size)
{
    static const char *const words[] = {"nan", "inf", "infinity"};
    for (int i = 0; i < MT_COUNT(words) && said->s != NULL; i++) {
        DEMAND(!has_word(said->s, said->length, words[i]) ||
               has_word((const char *)data, size, words[i]));
    }
}

bool fuzz_is_refusal(mt_status rc)
{
    return rc != MT_OK && rc != MT_E_INTERNAL && rc != MT_E_USAGE && rc != MT_E_MEMORY;
}

static char folder[PATH_SIZE];
static char written[MAX_NAMES][PATH_SIZE];

static void remove_folder(void)
{
    char path[PATH_SIZE + 16];
    static const char *const links[] = {"problems", "tests"};
    for (int i = 0; i < MAX_NAMES && written[i][0] != '\0'; i++) {
        (void)unlink(written[i]);
    }
    for (int i = 0; i < MT_COUNT(links); i++) {
        (void)snprintf(path, sizeof path, "%s/%s", folder, links[i]);
        (void)unlink(path);
    }
    (void)snprintf(path, sizeof path, "%s/s", folder);
    (void)rmdir(path);
    (void)rmdir(folder);
}

const char *fuzz_folder(void)
{
    char path[PATH_SIZE + 16];
    if (folder[0] != '\0') {
        return folder;
    }
    const char *const temporary = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    (void)snprintf(folder, sizeof folder, "%s/mt_fuzz_XXXXXX", temporary);
    DEMAND(mkdtemp(folder) != NULL);
    (void)snprintf(path, sizeof path, "%s/problems", folder);
    DEMAND(symlink(MT_TEST_SOURCE_DIR "/problems", path) == 0);
    (void)snprintf(path, sizeof path, "%s/tests", folder);
    DEMAND(symlink(MT_TEST_SOURCE_DIR "/tests", path) == 0);
    (void)snprintf(path, sizeof path, "%s/s", folder);
    DEMAND(mkdir(path, 0700) == 0);
    DEMAND(atexit(remove_folder) == 0);
    return folder;
}

const char *fuzz_write(const char *name, const uint8_t *data, size_t size)
{
    char path[PATH_SIZE];
    int i = 0;
    const int length = snprintf(path, sizeof path, "%.200s/s/%.40s", fuzz_folder(), name);
    DEMAND(length > 0 && length < PATH_SIZE);
    while (i < MAX_NAMES && written[i][0] != '\0' && strcmp(written[i], path) != 0) {
        i++;
    }
    DEMAND(i < MAX_NAMES);
    memcpy(written[i], path, sizeof path);
    FILE *const f = fopen(path, "wb");
    DEMAND(f != NULL && fwrite(data, 1, size, f) == size);
    DEMAND(fclose(f) == 0);
    return written[i];
}
