/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are given by their texts, beside those of the disk. */
#include "io/files.h"

#include <stdlib.h>
#include <string.h>

#include "base/arena.h"

char *mt_files_normal(const char *path)
{
    char *const out = malloc(strlen(path) + 2);
    if (out == NULL) {
        return NULL;
    }
    const size_t root = path[0] == '/' ? 1 : 0;
    size_t length = root;
    memcpy(out, "/", root);
    for (const char *at = path + strspn(path, "/"); *at != '\0'; at += strspn(at, "/")) {
        const size_t n = strcspn(at, "/");
        size_t last = length; /* where the last part begins */
        while (last > root && out[last - 1] != '/') {
            last--;
        }
        const bool up = n == 2 && strncmp(at, "..", 2) == 0;
        const bool stays = length > root && strncmp(out + last, "..", length - last) == 0;
        if (up && length > root && !stays) {
            length = last > root ? last - 1 : root;
        } else if (!(n == 1 && *at == '.') && !(up && root == 1)) {
            if (length > root) {
                out[length++] = '/';
            }
            memcpy(out + length, at, n);
            length += n;
        }
        at += n;
    }
    out[length] = '\0';
    return out;
}

/* The text that is given for the path; NULL: none, or *rc. */
static const char *find_given_text(const mt_files *files, const char *path, mt_status *rc)
{
    const char *found = NULL;
    *rc = MT_OK;
    if (files == NULL || files->n == 0) {
        return NULL;
    }
    char *const wanted = mt_files_normal(path);
    for (int i = 0; i < files->n && found == NULL && wanted != NULL; i++) {
        char *const name = mt_files_normal(files->given[i].path);
        if (name == NULL) {
            *rc = MT_E_MEMORY;
            break;
        }
        found = strcmp(name, wanted) == 0 ? files->given[i].text : NULL;
        free(name);
    }
    *rc = wanted == NULL ? MT_E_MEMORY : *rc;
    free(wanted);
    return found;
}

mt_status mt_files_read(const mt_files *files, const char *path, const char *root, size_t limit,
                        mt_file *out, mt_err *err)
{
    mt_status rc = MT_OK;
    const char *const text = find_given_text(files, path, &rc);
    *out = (mt_file){0};
    if (rc != MT_OK) {
        return mt_fail_memory(err);
    }
    if (text == NULL && files != NULL && files->only) {
        return mt_fail(err, MT_E_SYSTEM, "%s: is not among the files that are given", path);
    }
    if (text == NULL) {
        return mt_file_read(path, root, limit, out, err);
    }
    const size_t length = strlen(text);
    if (length > limit) {
        return mt_fail(err, MT_E_INPUT, "%s: is longer than %zu bytes", path, limit);
    }
    out->bytes = malloc(length + 1);
    if (out->bytes == NULL) {
        return mt_fail_memory(err);
    }
    memcpy(out->bytes, text, length + 1);
    out->length = length;
    mt_sha256(out->bytes, length, out->sha256);
    return MT_OK;
}

mt_status mt_files_give(const mt_files *files, const char *path, bool *out, mt_err *err)
{
    mt_status rc = MT_OK;
    *out = find_given_text(files, path, &rc) != NULL;
    return rc == MT_OK ? rc : mt_fail_memory(err);
}

bool mt_files_lack(const mt_files *files, const char *path)
{
    mt_status rc = MT_OK;
    if (find_given_text(files, path, &rc) != NULL || rc != MT_OK) {
        return false;
    }
    return (files != NULL && files->only) || mt_file_absent(path);
}
