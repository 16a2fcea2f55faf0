/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune help: what the documents say of a command, or of a member of a file. */
#include "cli/cmd_help.h"

#include <stdbool.h>
#include <string.h>

#include "base/base.h"
#include "base/format.h"
#include "cli/cli.h"
#include "cli/documents_data.h"

/* The documents, whose bytes are those of files (CMakeLists.txt). */

static const mt_shipped files[] = {
#define DOCUMENT(bytes, path) {path, bytes, sizeof(bytes) - 1},
    DOCUMENTS_LIST(DOCUMENT)
#undef DOCUMENT
};

/* The Markdown documents built into the program, ordered by path; *n is their number. */
static const mt_shipped *documents_all(int *n)
{
    *n = MT_COUNT(files);
    return files;
}

const mt_shipped *mt_documents_find(const char *path)
{
    return mt_shipped_among(files, MT_COUNT(files), path);
}

/* True where the document is a reference generated from schemas; other documents are listed
 * first. */
static bool document_is_reference(const mt_shipped *document)
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

static bool passage_is_row(const mt_passage *p)
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

/* The command. */

/* Documents in the order in which they are shown. */
typedef enum rank { OF_COMMANDS, WRITTEN, REFERENCE, RANKS } rank;

static rank rank_of(const mt_shipped *document)
{
    return strcmp(document->path, MT_DOCUMENT_COMMANDS) == 0 ? OF_COMMANDS
           : document_is_reference(document)                 ? REFERENCE
                                                             : WRITTEN;
}

/* True where the text already has the same item, byte by byte. */
static bool is_listed_already(const mt_text *out, const mt_passage *p)
{
    const size_t length = (size_t)(p->end - p->begin) - 1; /* the last one has no line feed */
    for (const char *at = out->s; at != NULL && (at = strstr(at, "\n- `")) != NULL; at++) {
        if (strncmp(at + 1, p->begin, length) == 0) {
            return true;
        }
    }
    return false;
}

/* Its text without comments (<!-- ... -->), which are for programs. */
static void add_passage(const mt_passage *p, mt_text *out)
{
    const char *at = p->begin;
    while (at < p->end) {
        const char *const comment = strstr(at, "<!--");
        const char *const behind = comment == NULL ? NULL : strstr(comment, "-->");
        if (behind == NULL || comment >= p->end) {
            break;
        }
        mt_text_add_n(out, at, (size_t)(comment - at));
        at = behind + strlen("-->");
        at += strspn(at, "\n");
    }
    mt_text_add_n(out, at, at < p->end ? (size_t)(p->end - at) : 0);
}

static void trim(mt_text *out)
{
    while (out->length > 0 && out->s[out->length - 1] == '\n') {
        out->s[--out->length] = '\0';
    }
}

/* Show a passage, after the name of its document where that differs from the one before. */
static void show(const mt_shipped *document, const mt_passage *p, const mt_shipped **last,
                 mt_text *out)
{
    if (*last != document) {
        mt_text_add(out, *last == NULL ? "" : "\n\n");
        mt_text_addf(out, "From %s:", document->path);
    }
    mt_text_add(out, p->level > 0 || *last != document ? "\n\n" : "\n");
    *last = document;
    add_passage(p, out);
    trim(out);
}

static void add_title(const mt_passage *heading, mt_text *out)
{
    const char *const title = heading->begin + heading->level + 1;
    mt_text_add_n(out, title, strcspn(title, "\n"));
}

/* The topic is one of the values that an item of the reference lists, `"revolute"`. */
static bool has_value(const mt_passage *p, const char *topic)
{
    mt_text value = {.s = NULL};
    mt_text_add(&value, "`\"");
    mt_text_add(&value, topic);
    mt_text_add(&value, "\"`");
    const char *const at = value.failed ? NULL : strstr(p->begin, value.s);
    mt_text_free(&value);
    return at != NULL && at < p->end;
}

/* Whatever stands for a topic. */
typedef enum way { BY_HEADINGS, BY_ITEMS, BY_VALUES, BY_MENTIONS, WAYS } way;

/* Where an item stands. */
typedef struct place {
    mt_passage section; /* its heading */
    mt_passage chapter; /* the heading of level 2 that has this */
    const char *shown;  /* the heading that was shown last */
} place;

/* "From PAGE, SECTION (CHAPTER):" where that is another one than before. */
static void show_place(const mt_shipped *document, place *at, const mt_shipped **last,
                       mt_text *out)
{
    mt_text heading = {.s = NULL};
    if (at->section.level == 0 || at->shown == at->section.begin) {
        return;
    }
    add_title(&at->section, &heading);
    if (at->chapter.level > 0 && at->chapter.begin != at->section.begin) {
        mt_text_add(&heading, " (");
        add_title(&at->chapter, &heading);
        mt_text_add(&heading, ")");
    }
    mt_text_add(out, *last == NULL ? "" : "\n\n");
    mt_text_addf(out, "From %s, %s:\n", document->path, heading.s == NULL ? "" : heading.s);
    out->failed = out->failed || heading.failed;
    mt_text_free(&heading);
    *last = document;
    at->shown = at->section.begin;
}

/* An item with its place; of a row the section that has its table. */
static void show_item(const mt_shipped *document, const mt_passage *p, place *at,
                      const mt_shipped **last, mt_text *out)
{
    if (!passage_is_row(p)) {
        show_place(document, at, last, out);
        show(document, p, last, out);
    } else if (at->section.level > 0 && at->shown != at->section.begin) {
        show(document, &at->section, last, out);
        at->shown = at->section.begin;
    }
}

/* Items that are called so, or that list such a value. */
static void show_items(const mt_shipped *document, const char *topic, way by,
                       const mt_shipped **last, mt_text *out)
{
    enum { CHAPTER = 2 };
    mt_passage p = {.begin = NULL};
    place at = {.shown = NULL};
    while (mt_passage_next(document->bytes, &p)) {
        if (p.level > 0) {
            at.chapter = p.level <= CHAPTER ? p : at.chapter;
            at.section = p;
        } else if ((by == BY_ITEMS ? mt_passage_is(&p, topic) : has_value(&p, topic)) &&
                   !is_listed_already(out, &p)) {
            show_item(document, &p, &at, last, out);
        }
    }
}

/* `topic`, or `topic(...)`, stands within [begin, end). */
static bool mentions(const char *begin, const char *end, const char *topic)
{
    const size_t length = strlen(topic);
    for (const char *at = begin; (at = strchr(at, '`')) != NULL && at < end; at++) {
        if (strncmp(at + 1, topic, length) == 0 && strchr("`(", at[1 + length]) != NULL) {
            return true;
        }
    }
    return false;
}

/* The first sections, each up to the next heading, that mention the topic. */
static void show_mentions(const mt_shipped *document, const char *topic,
                          const mt_shipped **last, mt_text *out)
{
    enum { MOST = 3 };
    mt_passage p = {.begin = NULL};
    mt_passage section = {.begin = NULL};
    bool more = true;
    for (int n = 0; more && n < MOST;) {
        more = mt_passage_next(document->bytes, &p);
        if (more && p.level == 0) {
            continue;
        }
        section.end = more ? p.begin : section.end;
        if (section.level > 1 && mentions(section.body, section.end, topic)) {
            show(document, &section, last, out);
            n++;
        }
        section = p;
    }
}

/* Show all passages of the documents about the topic, by one kind of match. */
static void show_all(const char *topic, way by, const mt_shipped **last, mt_text *out)
{
    int n = 0;
    const mt_shipped *const documents = documents_all(&n);
    for (int k = 0; k < RANKS * n; k++) {
        const mt_shipped *const document = &documents[k % n];
        mt_passage p = {.begin = NULL};
        const rank r = rank_of(document);
        if ((int)r != k / n || (by == BY_VALUES && r != REFERENCE) ||
            (by == BY_MENTIONS && r != WRITTEN)) {
            continue;
        }
        if (by == BY_MENTIONS) {
            show_mentions(document, topic, last, out);
        } else if (by != BY_HEADINGS) {
            show_items(document, topic, by, last, out);
        }
        while (by == BY_HEADINGS && mt_passage_next(document->bytes, &p)) {
            if (p.level > 0 && mt_passage_is(&p, topic)) {
                show(document, &p, last, out);
            }
        }
    }
}

/* ",a,b,": each name once. */
static void add_names(rank of, bool items, mt_text *names)
{
    int n = 0;
    const mt_shipped *const documents = documents_all(&n);
    for (int i = 0; i < n; i++) {
        mt_passage p = {.begin = NULL};
        while (rank_of(&documents[i]) == of && mt_passage_next(documents[i].bytes, &p)) {
            const char *at = NULL;
            const char *name = NULL;
            size_t length = 0;
            while ((p.level == 0) == items && mt_passage_name(&p, &at, &name, &length)) {
                mt_text one = {.s = NULL};
                mt_text_add(&one, ",");
                mt_text_add_n(&one, name, length);
                mt_text_add(&one, ",");
                if (!one.failed && !names->failed && strcspn(name, ", /") >= length &&
                    (names->s == NULL || strstr(names->s, one.s) == NULL)) {
                    mt_text_add(names, names->s == NULL ? one.s : one.s + 1);
                }
                names->failed = names->failed || one.failed;
                mt_text_free(&one);
            }
        }
    }
}

/* The same of the commands, where no name is there yet. */
static void add_commands(mt_text *names)
{
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(names, "%s%s,", i == 0 ? "," : "", mt_commands[i].name);
    }
}

static void list_names(const char *what, const mt_text *names, mt_text *out)
{
    mt_text line = {.s = NULL};
    for (const char *at = names->s; at != NULL && at[1] != '\0';) {
        const size_t length = strcspn(at + 1, ",");
        mt_text_add(&line, line.s == NULL ? "" : ", ");
        mt_text_add_n(&line, at + 1, length);
        at += 1 + length;
    }
    if (line.s != NULL && !line.failed) {
        mt_text_addf(out, "\n%s:\n  ", what);
        mt_help_fill(line.s, 2, out);
    }
    out->failed = out->failed || line.failed || names->failed;
    mt_text_free(&line);
}

static void list_topics(mt_text *out)
{
    static const char *const what[RANKS] = {"Commands", "Topics",
                                            "Objects of files (and each of their members)"};
    for (rank r = OF_COMMANDS; r < RANKS; r++) {
        mt_text names = {.s = NULL};
        if (r == OF_COMMANDS) {
            add_commands(&names);
        } else {
            add_names(r, false, &names);
        }
        list_names(what[r], &names, out);
        mt_text_free(&names);
    }
}

/* Add names that the topic may mean: near ones, then those that contain it. */
static void add_near(const char *topic, mt_text *out)
{
    enum { MOST = 5, LONG_ENOUGH = 3 };
    mt_text names = {.s = NULL};
    int n = 0;
    const int length = (int)strlen(topic);
    add_commands(&names);
    for (rank r = OF_COMMANDS; r < RANKS; r++) {
        add_names(r, false, &names);
        add_names(r, true, &names);
    }
    for (int round = 0; round < 2; round++) {
        for (const char *at = names.s; at != NULL && at[1] != '\0' && n < MOST;) {
            char name[MT_TEXT_DISTANCE_MAX];
            const size_t size = strcspn(at + 1, ",");
            (void)mt_snprintf(name, sizeof name, "%.*s", (int)size, at + 1);
            at += 1 + size;
            const int most = 1 + length / 4;
            const bool is_near = mt_text_distance(topic, name, most) <= most && most < length;
            const bool contains = length >= LONG_ENOUGH && strstr(name, topic) != NULL;
            if (round == 0 ? is_near : contains && !is_near) {
                mt_text_addf(out, "%s\"%s\"", n == 0 ? "; did you mean " : " or ", name);
                n++;
            }
        }
    }
    out->failed = out->failed || names.failed;
    mt_text_free(&names);
}

static int report_unknown_topic(const char *topic)
{
    mt_text near = {.s = NULL};
    mt_text topics = {.s = NULL};
    add_near(topic, &near);
    list_topics(&topics);
    if (near.failed || topics.failed) {
        mt_err err = {.code = MT_OK};
        mt_text_free(&near);
        mt_text_free(&topics);
        return mt_cli_failed(mt_fail_memory(&err), &err);
    }
    mt_terminal_error("no topic is called \"%s\"%s%s", topic, near.s == NULL ? "" : near.s,
                      near.s == NULL ? "" : "?");
    mt_terminal_write(topics.s, topics.length);
    mt_text_free(&near);
    mt_text_free(&topics);
    return MT_EXIT_INPUT;
}

int mt_cmd_help(const mt_args *args, mt_text *out)
{
    const mt_shipped *last = NULL;
    if (args->n_operands == 0) {
        mt_help(MT_CMD_NONE, out);
        list_topics(out);
        return MT_EXIT_DONE;
    }
    const char *const topic = args->operands[0];
    show_all(topic, BY_HEADINGS, &last, out);
    const int command = mt_command_named(topic);
    if (last == NULL && command != MT_CMD_NONE) {
        mt_help(command, out);
        return MT_EXIT_DONE;
    }
    for (way by = BY_ITEMS; by < WAYS && last == NULL; by++) {
        show_all(topic, by, &last, out);
    }
    mt_text_add(out, last == NULL ? "" : "\n");
    return last == NULL && !out->failed ? report_unknown_topic(topic) : MT_EXIT_DONE;
}
