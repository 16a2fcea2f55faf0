/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bytes are those of files (CMakeLists.txt). */
#include "cli/documents.h"

#include <string.h>

#include "base/base.h"
#include "cli/documents_data.h"

static const mt_shipped files[] = {
#define DOCUMENT(bytes, path) {path, bytes, sizeof(bytes) - 1},
    DOCUMENTS_LIST(DOCUMENT)
#undef DOCUMENT
};

const mt_shipped *mt_documents_all(int *n)
{
    *n = MT_COUNT(files);
    return files;
}

const mt_shipped *mt_documents_find(const char *path)
{
    return mt_shipped_among(files, MT_COUNT(files), path);
}

bool mt_document_is_reference(const mt_shipped *document)
{
    return strcmp(document->path, "schemas/README.md") == 0;
}

static const char *behind_line(const char *at)
{
    at += strcspn(at, "\n");
    return *at == '\n' ? at + 1 : at;
}

static bool is_fence(const char *line)
{
    return strncmp(line, "```", 3) == 0;
}

/* "## Title": 2; 0: the line is no heading. */
static int level_of(const char *line)
{
    const size_t n = strspn(line, "#");
    return n > 0 && line[n] == ' ' ? (int)n : 0;
}

static bool is_item(const char *line)
{
    return strncmp(line, "- `", 3) == 0;
}

/* Where the next heading of this level or above begins. */
static const char *section_end(const char *at, int level)
{
    bool fenced = false;
    for (; *at != '\0'; at = behind_line(at)) {
        fenced = fenced != is_fence(at);
        const int here = fenced ? 0 : level_of(at);
        if (here > 0 && here <= level) {
            break;
        }
    }
    return at;
}

static bool is_row(const char *line)
{
    return strncmp(line, "| `", 3) == 0;
}

bool mt_passage_is_row(const mt_passage *p)
{
    return is_row(p->begin);
}

static const char *item_end(const char *at)
{
    if (is_row(at)) {
        return behind_line(at);
    }
    do {
        at = behind_line(at);
    } while (strncmp(at, "  ", 2) == 0);
    return at;
}

bool mt_passage_next(const char *text, mt_passage *p)
{
    const char *at = p->begin == NULL ? text : behind_line(p->begin);
    bool fenced = false;
    for (; *at != '\0'; at = behind_line(at)) {
        fenced = fenced != is_fence(at);
        if (fenced) {
            continue;
        }
        const int level = level_of(at);
        if (level > 0) {
            const char *const body = behind_line(at);
            *p = (mt_passage){
                .level = level, .begin = at, .body = body, .end = section_end(body, level)};
            return true;
        }
        if (is_item(at) || is_row(at)) {
            *p = (mt_passage){.begin = at, .end = item_end(at)};
            return true;
        }
    }
    return false;
}

bool mt_passage_name(const mt_passage *p, const char **at, const char **name, size_t *length)
{
    if (p->level == 0 && *at != NULL && !is_row(p->begin)) {
        return false;
    }
    const char *const from = *at == NULL ? p->begin + 1 : *at;
    const char *const open = from + strcspn(from, is_row(p->begin) ? "`|\n" : "`\n");
    const char *const close = *open == '`' ? open + 1 + strcspn(open + 1, "`\n") : open;
    if (*close != '`') {
        return false;
    }
    *name = open + 1;
    *length = (size_t)(close - open - 1);
    *at = close + 1;
    return true;
}

bool mt_passage_is(const mt_passage *p, const char *name)
{
    const char *at = NULL;
    const char *own = NULL;
    size_t length = 0;
    while (mt_passage_name(p, &at, &own, &length)) {
        if (strlen(name) == length && strncmp(own, name, length) == 0) {
            return true;
        }
    }
    return false;
}
