/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the program says of itself: --help, the command help, which reads the documents, manual
 * pages and completion in shells. */
#include "modetune/version.h"

#include <ctype.h>
#include <stdbool.h>
#include <string.h>

#include "base/base.h"
#include "base/format.h"
#include "cli/args.h"
#include "cli/cli.h"
#include "cli/documents_data.h"
#include "cli/shipped.h"
#include "io/file.h"

/* The document of the commands. */
#define DOCUMENT_COMMANDS "src/cli/README.md"

/* A part of a document: a heading with everything below it, or an item of a list or a row of a
 * table that begins with a name in backquotes. Code blocks have none of these. */
typedef struct passage {
    int level;         /* of a heading, from 1; 0: an item or a row */
    const char *begin; /* its first line */
    const char *body;  /* after the heading's line; NULL for an item or a row */
    const char *end;   /* after its last line */
} passage;

/* --help, from the tables. */

enum { OPTION_COLUMN = 31, EXIT_COLUMN = 7, LINE_WIDTH = 92, FORM_TEXT = 64 };

static void spaces(int n, mt_text *out)
{
    for (int i = 0; i < n; i++) {
        mt_text_add(out, " ");
    }
}

/* Append paragraphs of words (one per line of s) in lines of up to 92 columns that begin at
 * `column`; the caller has already written up to there for the first line. */
static void fill_lines(const char *s, int column, mt_text *out)
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

/* An option as it is of one command, whose own formats --format has; MT_CMD_NONE: as of all. */
typedef struct shown_option {
    const char *value; /* NULL: a switch */
    const char *help;
    char values[FORM_TEXT];
} shown_option;

/* The words of --format of a command. */
static void join_formats(int command, char *text, size_t size)
{
    int n = 0;
    for (int i = 0; i < MT_FORMATS; i++) {
        const char *const name = mt_format_of(i, command);
        if (name != NULL) {
            n += mt_snprintf(text + n, size - (size_t)n, "%s%s", n == 0 ? "" : "|", name);
        }
    }
}

static void show_option(int option, int command, shown_option *out)
{
    const mt_option *const o = &mt_options[option];
    *out = (shown_option){.value = o->value, .help = o->help};
    if (option == MT_OPT_FORMAT && command != MT_CMD_NONE) {
        join_formats(command, out->values, sizeof out->values);
        out->value = out->values;
        out->help = command == MT_CMD_SHOW ? "form of standard output (default: html)"
                                           : "form of standard output (default: text)";
    }
}

static void help_option(int option, int command, mt_text *out)
{
    const mt_option *const o = &mt_options[option];
    char form[FORM_TEXT];
    shown_option shown;
    show_option(option, command, &shown);
    const int n = mt_snprintf(
        form, sizeof form, "  %c%c%s--%s%s%s", o->letter == '\0' ? ' ' : '-',
        o->letter == '\0' ? ' ' : o->letter, o->letter == '\0' ? "  " : ", ", o->name,
        shown.value == NULL ? "" : " ", shown.value == NULL ? "" : shown.value);
    mt_text_add(out, form);
    if (n + 2 > OPTION_COLUMN) {
        mt_text_add(out, "\n");
        spaces(OPTION_COLUMN, out);
    } else {
        spaces(OPTION_COLUMN - n, out);
    }
    fill_lines(shown.help, OPTION_COLUMN, out);
}

static void help_command(const mt_command *const *commands, int command, mt_text *out)
{
    const mt_command *const c = commands[command];
    mt_text_addf(out, "Usage: modetune %s %s [options]\n\n", c->name, c->operands);
    fill_lines(c->details, 0, out);
    mt_text_add(out, "\nOptions:\n");
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_option_is_of(i, command)) {
            help_option(i, command, out);
        }
    }
}

/* Append the text of --help: of the program (MT_CMD_NONE) or of one command. */
static void print_help(const mt_command *const *commands, int command, mt_text *out)
{
    if (command != MT_CMD_NONE) {
        help_command(commands, command, out);
        return;
    }
    mt_text_add(
        out, "Usage: modetune COMMAND ...\n\n"
             "Tells what to change so that the natural frequencies of a mechanism land where "
             "they must.\n\nCommands:\n");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "  %-12s %s\n", commands[i]->name, commands[i]->summary);
    }
    mt_text_add(out, "\nOptions of every command:\n");
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_options[i].commands == MT_ALL_COMMANDS || mt_options[i].commands == 0U) {
            help_option(i, MT_CMD_NONE, out);
        }
    }
    mt_text_add(out, "\n\"modetune COMMAND --help\" explains a command, \"modetune help "
                     "TOPIC\" a command or a "
                     "word of a\nmodel, a study or a result.\n\nExit status:\n");
    for (int i = 0; i < MT_EXITS; i++) {
        mt_text_addf(out, "  %-4d ", mt_exits[i].code);
        fill_lines(mt_exits[i].meaning, EXIT_COLUMN, out);
    }
}

/* What the documents say of a command, or of a member of a file. */

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

/* The document of that path; NULL: none. */
static const mt_shipped *documents_find(const char *path)
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

static bool passage_is_row(const passage *p)
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

/* Move *p to the next heading, item or row of the text, or, with begin NULL, to the first one.
 * False: none. O(text passed over and the section). */
static bool passage_next(const char *text, passage *p)
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
            *p = (passage){
                .level = level, .begin = at, .body = body, .end = section_end(body, level)};
            return true;
        }
        if (is_item(at) || is_row(at)) {
            *p = (passage){.begin = at, .end = item_end(at)};
            return true;
        }
    }
    return false;
}

/* The next name of a passage. Names are all words in backquotes of a heading or of the first
 * cell of a row, and the first one of an item. *at is NULL before the first; *name has *length
 * bytes, not terminated. False: no more names. */
static bool passage_name(const passage *p, const char **at, const char **name, size_t *length)
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

/* True where name is one of the passage's names. */
static bool passage_is(const passage *p, const char *name)
{
    const char *at = NULL;
    const char *own = NULL;
    size_t length = 0;
    while (passage_name(p, &at, &own, &length)) {
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
    return strcmp(document->path, DOCUMENT_COMMANDS) == 0 ? OF_COMMANDS
           : document_is_reference(document)              ? REFERENCE
                                                          : WRITTEN;
}

/* True where the text already has the same item, byte by byte. */
static bool is_listed_already(const mt_text *out, const passage *p)
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
static void add_passage(const passage *p, mt_text *out)
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
static void show(const mt_shipped *document, const passage *p, const mt_shipped **last,
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

static void add_title(const passage *heading, mt_text *out)
{
    const char *const title = heading->begin + heading->level + 1;
    mt_text_add_n(out, title, strcspn(title, "\n"));
}

/* The topic is one of the values that an item of the reference lists, `"revolute"`. */
static bool has_value(const passage *p, const char *topic)
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
    passage section;   /* its heading */
    passage chapter;   /* the heading of level 2 that has this */
    const char *shown; /* the heading that was shown last */
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
static void show_item(const mt_shipped *document, const passage *p, place *at,
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
    passage p = {.begin = NULL};
    place at = {.shown = NULL};
    while (passage_next(document->bytes, &p)) {
        if (p.level > 0) {
            at.chapter = p.level <= CHAPTER ? p : at.chapter;
            at.section = p;
        } else if ((by == BY_ITEMS ? passage_is(&p, topic) : has_value(&p, topic)) &&
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
    passage p = {.begin = NULL};
    passage section = {.begin = NULL};
    bool more = true;
    for (int n = 0; more && n < MOST;) {
        more = passage_next(document->bytes, &p);
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
        passage p = {.begin = NULL};
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
        while (by == BY_HEADINGS && passage_next(document->bytes, &p)) {
            if (p.level > 0 && passage_is(&p, topic)) {
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
        passage p = {.begin = NULL};
        while (rank_of(&documents[i]) == of && passage_next(documents[i].bytes, &p)) {
            const char *at = NULL;
            const char *name = NULL;
            size_t length = 0;
            while ((p.level == 0) == items && passage_name(&p, &at, &name, &length)) {
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
static void add_commands(const mt_command *const *commands, mt_text *names)
{
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(names, "%s%s,", i == 0 ? "," : "", commands[i]->name);
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
        fill_lines(line.s, 2, out);
    }
    out->failed = out->failed || line.failed || names->failed;
    mt_text_free(&line);
}

static void list_topics(const mt_command *const *commands, mt_text *out)
{
    static const char *const what[RANKS] = {"Commands", "Topics",
                                            "Objects of files (and each of their members)"};
    for (rank r = OF_COMMANDS; r < RANKS; r++) {
        mt_text names = {.s = NULL};
        if (r == OF_COMMANDS) {
            add_commands(commands, &names);
        } else {
            add_names(r, false, &names);
        }
        list_names(what[r], &names, out);
        mt_text_free(&names);
    }
}

/* Add names that the topic may mean: near ones, then those that contain it. */
static void add_near(const mt_command *const *commands, const char *topic, mt_text *out)
{
    enum { MOST = 5, LONG_ENOUGH = 3 };
    mt_text names = {.s = NULL};
    int n = 0;
    const int length = (int)strlen(topic);
    add_commands(commands, &names);
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

static int report_unknown_topic(const mt_command *const *commands, const char *topic)
{
    mt_text near = {.s = NULL};
    mt_text topics = {.s = NULL};
    add_near(commands, topic, &near);
    list_topics(commands, &topics);
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

static int show_topic(const mt_args *args, mt_text *out)
{
    const mt_shipped *last = NULL;
    if (args->n_operands == 0) {
        print_help(args->commands, MT_CMD_NONE, out);
        list_topics(args->commands, out);
        return MT_EXIT_DONE;
    }
    const char *const topic = args->operands[0];
    show_all(topic, BY_HEADINGS, &last, out);
    int command = MT_CMD_IDS - 1;
    while (command != MT_CMD_NONE && strcmp(args->commands[command]->name, topic) != 0) {
        command--;
    }
    if (last == NULL && command != MT_CMD_NONE) {
        print_help(args->commands, command, out);
        return MT_EXIT_DONE;
    }
    for (way by = BY_ITEMS; by < WAYS && last == NULL; by++) {
        show_all(topic, by, &last, out);
    }
    mt_text_add(out, last == NULL ? "" : "\n");
    return last == NULL && !out->failed ? report_unknown_topic(args->commands, topic)
                                        : MT_EXIT_DONE;
}

/* The manual pages. */

/* Text in the language of man(7). Characters with a meaning there are escaped. */

static void escape(const char *s, size_t n, mt_text *out)
{
    for (const char *at = s; at < s + n; at++) {
        if (*at == '\\' || *at == '-') {
            mt_text_add(out, *at == '\\' ? "\\e" : "\\-");
        } else {
            mt_text_add_n(out, at, 1);
        }
    }
}

/* A line that begins with a character that roff obeys there. */
static void guard(const char *s, mt_text *out)
{
    mt_text_add(out, *s == '.' || *s == '\'' ? "\\&" : "");
}

/* ".SH TITLE"; the title is written in capitals. */
static void man_section(const char *title, size_t length, mt_text *out)
{
    mt_text_add(out, ".SH ");
    for (const char *at = title; at < title + length; at++) {
        const char upper = (char)toupper((unsigned char)*at);
        if (*at != '`') {
            escape(&upper, 1, out);
        }
    }
    mt_text_add(out, "\n");
}

/* A paragraph with a hanging tag: bold, then italic (NULL: none). Its text follows. */
static void man_tag(const char *bold, const char *italic, mt_text *out)
{
    mt_text_add(out, ".TP\n\\fB");
    escape(bold, strlen(bold), out);
    mt_text_add(out, "\\fR");
    if (italic != NULL) {
        mt_text_add(out, " \\fI");
        mt_text_add(out, italic);
        mt_text_add(out, "\\fR");
    }
    mt_text_add(out, "\n");
}

/* Text of --help: paragraphs, one per line, below a hanging tag or not; words --like-this are
 * bold. */
static void man_help(const char *s, bool hanging, mt_text *out)
{
    bool bold = false;
    for (const char *at = s; *at != '\0'; at++) {
        const bool starts = at == s || strchr(" (\"\n", at[-1]) != NULL;
        if (starts && strncmp(at, "--", 2) == 0 && isalpha((unsigned char)at[2]) != 0) {
            mt_text_add(out, "\\fB");
            bold = true;
        } else if (bold && *at != '-' && isalpha((unsigned char)*at) == 0) {
            mt_text_add(out, "\\fR");
            bold = false;
        }
        if (at == s || at[-1] == '\n') {
            guard(at, out);
        }
        if (*at == '\n') {
            mt_text_add(out, hanging ? "\n.IP\n" : "\n.PP\n");
        } else {
            escape(at, 1, out);
        }
    }
    mt_text_add(out, bold ? "\\fR\n" : "\n");
}

/* The character c in s[0 .. n); NULL: there is none. */
static const char *find_char(const char *s, size_t n, char c)
{
    return memchr(s, c, n);
}

/* Code: bold; among references `modetune run` is a page. */
static void add_code(const char *s, size_t n, bool references, mt_text *out)
{
    static const char program[] = "modetune";
    const size_t length = strlen(program);
    mt_text_add(out, "\\fB");
    if (references && n >= length && strncmp(s, program, length) == 0) {
        mt_text_add(out, program);
        if (n > length) {
            mt_text_add(out, "\\-");
            escape(s + length + 1, n - length - 1, out);
        }
        mt_text_add(out, "\\fR(1)");
    } else {
        escape(s, n, out);
        mt_text_add(out, "\\fR");
    }
}

/* Words with `code`, *emphasis* and [links](of which the text is shown). */
static void add_words(const char *s, size_t n, bool references, mt_text *out)
{
    const char *const end = s + n;
    const char *link = NULL; /* where the text of the link that we are in ends */
    for (const char *at = s; at < end; at++) {
        const size_t left = (size_t)(end - at) - 1;
        const char *const close =
            *at == '`' || *at == '*' ? find_char(at + 1, left, *at) : NULL;
        if (*at == '`' && close != NULL) {
            add_code(at + 1, (size_t)(close - at) - 1, references, out);
            at = close;
        } else if (*at == '*' && close != NULL && left > 0 && at[1] != ' ' &&
                   close[-1] != ' ') {
            mt_text_add(out, "\\fI");
            escape(at + 1, (size_t)(close - at) - 1, out);
            mt_text_add(out, "\\fR");
            at = close;
        } else if (*at == '[' && link == NULL) {
            const char *const middle = find_char(at, left, ']');
            link = middle != NULL && middle + 1 < end && middle[1] == '(' ? middle : NULL;
            mt_text_add(out, link == NULL ? "[" : "");
        } else if (at == link) {
            const char *const behind = find_char(at, left, ')');
            at = behind == NULL ? at : behind;
            link = NULL;
        } else {
            escape(at, 1, out);
        }
    }
}

typedef struct block {
    const char *at; /* the next line */
    const char *end;
    bool headed;
    mt_text *out;
} block;

static const char *line_end(const block *b, const char *line)
{
    const char *const end = find_char(line, (size_t)(b->end - line), '\n');
    return end == NULL ? b->end : end;
}

static bool begins(const block *b, const char *line, const char *with)
{
    const size_t n = strlen(with);
    return (size_t)(b->end - line) >= n && strncmp(line, with, n) == 0;
}

static void next_line(block *b)
{
    const char *const end = line_end(b, b->at);
    b->at = end < b->end ? end + 1 : end;
}

/* Lines as they are, up to the fence that closes the block. */
static void add_code_block(block *b)
{
    next_line(b);
    const char *const first_end = line_end(b, b->at);
    const bool shown = first_end - b->at < 7 || strncmp(first_end - 7, " --help", 7) != 0;
    if (shown) {
        mt_text_add(b->out, b->headed ? ".RS 4\n.nf\n" : ".PP\n.RS 4\n.nf\n");
        b->headed = false;
    }
    for (; b->at < b->end && !begins(b, b->at, "```"); next_line(b)) {
        if (shown) {
            guard(b->at, b->out);
            escape(b->at, (size_t)(line_end(b, b->at) - b->at), b->out);
            mt_text_add(b->out, "\n");
        }
    }
    mt_text_add(b->out, shown ? ".fi\n.RE\n" : "");
    next_line(b);
}

/* The lines of a paragraph, or of an item of a list, as one. */
static void add_paragraph(block *b, size_t indent, bool references)
{
    mt_text words = {.s = NULL};
    do {
        const char *const line = b->at + indent;
        mt_text_add(&words, words.s == NULL ? "" : " ");
        mt_text_add_n(&words, line, (size_t)(line_end(b, line) - line));
        next_line(b);
    } while (b->at < b->end && *b->at != '\n' && !begins(b, b->at, "- ") &&
             !begins(b, b->at, "```") && (indent == 0 || begins(b, b->at, "  ")));
    if (words.s != NULL) {
        guard(words.s, b->out);
        add_words(words.s, words.length, references, b->out);
        mt_text_add(b->out, "\n");
    }
    b->out->failed = b->out->failed || words.failed;
    mt_text_free(&words);
    b->headed = false;
}

static void skip_paragraph(block *b, const char *until)
{
    while (b->at < b->end && strncmp(b->at, until, strlen(until)) != 0) {
        next_line(b);
    }
}

/**
 * Markdown, from begin to end: paragraphs, lists, code blocks, headings as sections; links as
 * their text, without pictures and comments. A block of console output that begins with
 * "modetune ... --help" is left out: pages have OPTIONS. "See also: ..." becomes the section of
 * that name, in which `modetune run` is modetune-run(1). headed: a section has just begun, so
 * that a paragraph needs no macro.
 */
static void man_markdown(const char *begin, const char *end, bool headed, mt_text *out)
{
    static const char see[] = "See also: ";
    block b = {.at = begin, .end = end, .headed = headed, .out = out};
    while (b.at < b.end) {
        if (*b.at == '\n' || begins(&b, b.at, "<!--")) {
            next_line(&b);
        } else if (begins(&b, b.at, "```")) {
            add_code_block(&b);
        } else if (begins(&b, b.at, "#")) {
            const char *const title = b.at + strspn(b.at, "# ");
            man_section(title, (size_t)(line_end(&b, title) - title), out);
            next_line(&b);
            b.headed = true;
        } else if (begins(&b, b.at, "![")) {
            skip_paragraph(&b, "\n");
        } else if (begins(&b, b.at, see)) {
            man_section(see, strlen(see) - 2, out);
            b.at += strlen(see);
            add_paragraph(&b, 0, true);
        } else if (begins(&b, b.at, "- ")) {
            mt_text_add(out, ".IP \\(bu 2\n");
            add_paragraph(&b, 2, false);
        } else {
            mt_text_add(out, b.headed ? "" : ".PP\n");
            add_paragraph(&b, 0, false);
        }
    }
}

/* The manual pages: from the tables behind --help, and from the document of the commands. */

static const char description[] =
    "A model describes a mechanism: bodies, joints, springs, flexible links, with numbers that "
    "may be expressions of parameters. A study names the parameters that may change, within "
    "bounds, and what is asked of the natural frequencies and mode shapes. Both are JSON "
    "files. \\fBmodetune help\\fR \\fITOPIC\\fR explains their members.";

static void section(const char *title, mt_text *out)
{
    man_section(title, strlen(title), out);
}

static void head(const char *command, const char *summary, mt_text *out)
{
    mt_text_add(out, ".\\\" SPDX-License-Identifier: GPL-3.0-or-later\n"
                     ".\\\" made by \"modetune");
    mt_text_addf(out, "%s%s --manual\"\n.TH MODETUNE", *command == '\0' ? "" : " ", command);
    for (const char *at = command; *at != '\0'; at++) {
        mt_text_addf(out, "%s%c", at == command ? "\\-" : "", *at - 'a' + 'A');
    }
    mt_text_add(out, " 1 \"\" \"modetune " MT_VERSION_STRING "\" \"User Commands\"\n");
    section("NAME", out);
    mt_text_addf(out, "modetune%s%s \\- %s\n", *command == '\0' ? "" : "\\-", command, summary);
    section("SYNOPSIS", out);
}

static void add_option(int option, int command, mt_text *out)
{
    const mt_option *const o = &mt_options[option];
    mt_text form = {.s = NULL};
    shown_option shown;
    show_option(option, command, &shown);
    if (o->letter != '\0') {
        mt_text_addf(&form, "-%c, ", o->letter);
    }
    mt_text_addf(&form, "--%s", o->name);
    out->failed = out->failed || form.failed;
    man_tag(form.failed ? "" : form.s, shown.value, out);
    mt_text_free(&form);
    man_help(shown.help, true, out);
}

static void add_exits(mt_text *out)
{
    for (int i = 0; i < MT_EXITS; i++) {
        mt_text_addf(out, ".TP\n\\fB%d\\fR\n", mt_exits[i].code);
        man_help(mt_exits[i].meaning, true, out);
    }
}

/* The next section of the page whose heading is of level 2. */
static bool next_section(const mt_shipped *page, passage *p)
{
    while (page != NULL && passage_next(page->bytes, p)) {
        if (p->level == 2) {
            return true;
        }
    }
    return false;
}

/* Where the text is found within [begin, end), at the beginning of a line; end: nowhere. */
static const char *line_with(const char *begin, const char *end, const char *text)
{
    for (const char *at = begin; at < end; at += strcspn(at, "\n") + 1) {
        if (strncmp(at, text, strlen(text)) == 0) {
            return at;
        }
    }
    return end;
}

static const char *earlier(const char *a, const char *b)
{
    return a < b ? a : b;
}

static void manual_of(const mt_command *const *commands, int command, mt_text *out)
{
    const mt_command *const c = commands[command];
    const mt_shipped *const page = documents_find(DOCUMENT_COMMANDS);
    passage p = {.begin = NULL};
    bool found = next_section(page, &p);
    while (found && !passage_is(&p, c->name)) {
        found = next_section(page, &p);
    }
    const char *const end = found ? p.end : c->name;
    const char *const body = found ? p.body : end;
    /* before the first heading, behind it, and what pages end with */
    const char *const last =
        earlier(line_with(body, end, "### Examples\n"), line_with(body, end, "See also: "));
    const char *const rest = earlier(line_with(body, last, "### "), last);
    head(c->name, c->summary, out);
    mt_text_addf(out, "\\fBmodetune %s\\fR \\fI%s\\fR [\\fIoptions\\fR]\n", c->name,
                 c->operands);
    section("DESCRIPTION", out);
    man_help(c->details, false, out);
    man_markdown(body, rest, false, out);
    section("OPTIONS", out);
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_option_is_of(i, command)) {
            add_option(i, command, out);
        }
    }
    man_markdown(rest, last, false, out);
    section("EXIT STATUS", out);
    add_exits(out);
    man_markdown(last, end, false, out);
}

/* The sections of the page that are of no command. */
static void add_common(mt_text *out)
{
    static const char exits[] = "Exit status\n";
    const mt_shipped *const page = documents_find(DOCUMENT_COMMANDS);
    passage p = {.begin = NULL};
    while (next_section(page, &p)) {
        const char *at = NULL;
        const char *name = NULL;
        const char *const title = p.begin + strlen("## ");
        size_t length = 0;
        if (passage_name(&p, &at, &name, &length)) {
            continue;
        }
        man_section(title, strcspn(title, "\n"), out);
        const bool of_exits = strncmp(title, exits, strlen(exits)) == 0;
        if (of_exits) {
            add_exits(out);
        }
        man_markdown(p.body, p.end, !of_exits, out);
    }
}

/* A manual page, section 1, in the language of man(7): modetune(1) with MT_CMD_NONE, or
 * modetune-COMMAND(1). */
static void print_manual(const mt_command *const *commands, int command, mt_text *out)
{
    if (command != MT_CMD_NONE) {
        manual_of(commands, command, out);
        return;
    }
    head("", "what to change so that natural frequencies land where they must", out);
    mt_text_add(out, "\\fBmodetune\\fR \\fICOMMAND\\fR ... [\\fIoptions\\fR]\n");
    section("DESCRIPTION", out);
    mt_text_add(out, description);
    mt_text_add(out, "\n");
    section("COMMANDS", out);
    for (int i = 0; i < MT_CMD_IDS; i++) {
        man_tag(commands[i]->name, commands[i]->operands, out);
        man_help(commands[i]->summary, true, out);
    }
    section("OPTIONS", out);
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_options[i].commands == MT_ALL_COMMANDS || mt_options[i].commands == 0U) {
            add_option(i, MT_CMD_NONE, out);
        }
    }
    add_common(out);
    section("ENVIRONMENT", out);
    man_tag("NO_COLOR", NULL, out);
    man_help("No colour on a terminal.", true, out);
    section("SEE ALSO", out);
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "\\fBmodetune\\-%s\\fR(1)%s\n", commands[i]->name,
                     i + 1 < MT_CMD_IDS ? "," : "");
    }
}

/*
 * Scripts for the shells, from the tables behind --help. What the value of an option may be is
 * read from how the tables call it: "a|b|c" are words, DIR a folder, MODEL and PROFILE a
 * JSON file, FILE any; of another value nothing is known.
 */

static const char separators[] = "|";

static bool is_choice(const mt_option *o)
{
    return o->value != NULL && strchr(o->value, '|') != NULL;
}

static bool is_called(const mt_option *o, const char *value)
{
    return o->value != NULL && strcmp(o->value, value) == 0;
}

static bool is_file(const mt_option *o)
{
    return is_called(o, "MODEL") || is_called(o, "PROFILE");
}

/* The words of "a|b|c", a blank between them. */
static void add_choice(const char *value, mt_text *out)
{
    for (const char *at = value; *at != '\0'; at++) {
        mt_text_add_n(out, strchr(separators, *at) != NULL ? " " : at, 1);
    }
}

static bool is_shared(const mt_option *o)
{
    int n = 0;
    for (int i = 0; i < MT_OPT_IDS; i++) {
        n += strcmp(mt_options[i].name, o->name) == 0 ? 1 : 0;
    }
    return n > 1;
}

/* "-o"|"--output" behind a command, for a pattern of `case`: behind any, or, where another
 * option is called so, behind each of its own. */
static void add_pattern(const mt_command *const *commands, const mt_option *o, mt_text *out)
{
    const bool shared = is_shared(o);
    const char *between = "";
    for (int i = 0; i < (shared ? (int)MT_CMD_IDS : 1); i++) {
        const char *const before = shared ? commands[i]->name : "";
        const char *const star = shared ? "" : "*";
        if (shared && !mt_option_is_of((int)(o - mt_options), i)) {
            continue;
        }
        if (o->letter != '\0') {
            mt_text_addf(out, "%s%s\"%s -%c\"", between, star, before, o->letter);
            between = "|";
        }
        mt_text_addf(out, "%s%s\"%s --%s\"", between, star, before, o->name);
        between = "|";
    }
}

static void bash_options(int command, mt_text *out)
{
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_option_is_of(i, command)) {
            mt_text_addf(out, " --%s", mt_options[i].name);
        }
    }
}

/* What the program has of the command's operands by name; NULL: they are files. */
static const mt_shipped_kind *shipped_of(int command)
{
    return command == MT_CMD_EXAMPLES ? &mt_shipped_examples
           : command == MT_CMD_SCHEMA ? &mt_shipped_schemas
                                      : NULL;
}

/* The words of --format, a blank between them. */
static void add_formats(int command, mt_text *out)
{
    const char *between = "";
    for (int i = 0; i < MT_FORMATS; i++) {
        const char *const name = mt_format_of(i, command);
        if (name != NULL) {
            mt_text_addf(out, "%s%s", between, name);
            between = " ";
        }
    }
}

/* What stands behind an option that takes a value. */
static void bash_values(const mt_command *const *commands, mt_text *out)
{
    mt_text_add(out, "    case \"$command $previous\" in\n");
    for (int i = 0; i < MT_OPT_IDS; i++) {
        const mt_option *const o = &mt_options[i];
        if (o->value == NULL) {
            continue;
        }
        mt_text_add(out, "    ");
        add_pattern(commands, o, out);
        if (i == MT_OPT_FORMAT) {
            mt_text_add(out, ") COMPREPLY=($(compgen -W \"$formats\" -- \"$current\")); "
                             "return ;;\n");
        } else if (is_choice(o)) {
            mt_text_add(out, ") COMPREPLY=($(compgen -W '");
            add_choice(o->value, out);
            mt_text_add(out, "' -- \"$current\")); return ;;\n");
        } else if (is_called(o, "DIR")) {
            mt_text_add(out, ") COMPREPLY=($(compgen -d -- \"$current\")); return ;;\n");
        } else if (is_called(o, "FILE")) {
            mt_text_add(out, ") COMPREPLY=($(compgen -f -- \"$current\")); return ;;\n");
        } else if (is_file(o)) {
            mt_text_add(out, ") ;;\n");
        } else {
            mt_text_add(out, ") return ;;\n");
        }
    }
    mt_text_add(out, "    esac\n");
}

static void bash(const mt_command *const *commands, mt_text *out)
{
    mt_text_add(out,
                "# modetune(1) in bash: commands, options, values, JSON files\n"
                "_modetune() {\n"
                "    local current=${COMP_WORDS[COMP_CWORD]} "
                "previous=${COMP_WORDS[COMP_CWORD-1]} command= words= formats= names= word\n"
                "    for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
                "        case $word in\n        ");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "%s%s", i == 0 ? "" : "|", commands[i]->name);
    }
    mt_text_add(out, ") command=$word; break ;;\n        esac\n    done\n    COMPREPLY=()\n");
    mt_text_add(out, "    case $command in\n    '') words='");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "%s%s", i == 0 ? "" : " ", commands[i]->name);
    }
    bash_options(MT_CMD_NONE, out);
    mt_text_add(out, "' ;;\n");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "    %s) words='", commands[i]->name);
        bash_options(i, out);
        mt_text_add(out, "' formats='");
        add_formats(i, out);
        if (shipped_of(i) != NULL) {
            mt_text_add(out, "' names='");
            mt_shipped_names(shipped_of(i), out);
        }
        mt_text_add(out, "' ;;\n");
    }
    mt_text_add(out, "    esac\n");
    bash_values(commands, out);
    mt_text_add(out, "    if [[ -z $command || $current == -* ]]; then\n"
                     "        COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
                     "    elif [[ -n $names ]]; then\n"
                     "        COMPREPLY=($(compgen -W \"$names\" -- \"$current\"))\n"
                     "    else\n"
                     "        COMPREPLY=($(compgen -f -X '!*.json' -- \"$current\") "
                     "$(compgen -d -- \"$current\"))\n"
                     "    fi\n"
                     "}\n"
                     "complete -o filenames -F _modetune modetune\n");
}

/* The first clause of a text between apostrophes, without what zsh would obey there. */
static void zsh_text(const char *text, mt_text *out)
{
    const char *const sentence = strstr(text, ". ");
    const char *const clause = text + strcspn(text, ";:(");
    const char *const end = sentence == NULL || clause < sentence ? clause : sentence;
    for (const char *at = text; at < end; at++) {
        if (*at == '\'') {
            mt_text_add(out, "'\\''");
        } else if (strchr("[]\\", *at) == NULL && !(at + 1 == end && *at == ' ')) {
            mt_text_add_n(out, at, 1);
        }
    }
}

static void zsh_option(const mt_option *o, int command, mt_text *out)
{
    mt_text_addf(out, " \\\n            '%s--%s%s[", o->repeats ? "*" : "", o->name,
                 o->value == NULL ? "" : "=");
    zsh_text(o->help, out);
    mt_text_add(out, "]");
    if (is_choice(o)) {
        mt_text_addf(out, ":%s:(", o->name);
        if (o == &mt_options[MT_OPT_FORMAT]) {
            add_formats(command, out);
        } else {
            add_choice(o->value, out);
        }
        mt_text_add(out, ")");
    } else if (o->value != NULL) {
        const char *const how = is_called(o, "DIR")    ? "_files -/"
                                : is_called(o, "FILE") ? "_files"
                                : is_file(o)           ? "_files -g \"*.json\""
                                                       : "";
        mt_text_addf(out, ":%s:%s", o->name, how);
    }
    mt_text_add(out, "'");
}

static void zsh_options(int command, mt_text *out)
{
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_option_is_of(i, command)) {
            zsh_option(&mt_options[i], command, out);
        }
    }
}

static void zsh(const mt_command *const *commands, mt_text *out)
{
    mt_text_add(out, "#compdef modetune\n"
                     "# modetune(1) in zsh: commands, options, values, JSON files\n"
                     "_modetune() {\n"
                     "    local curcontext=$curcontext state line\n"
                     "    local -a commands=(\n");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "        '%s:", commands[i]->name);
        zsh_text(commands[i]->summary, out);
        mt_text_add(out, "'\n");
    }
    mt_text_add(out, "    )\n    _arguments -C");
    zsh_options(MT_CMD_NONE, out);
    mt_text_add(out, " \\\n            '1:command:->command' '*::argument:->argument'\n"
                     "    case $state in\n"
                     "    command) _describe command commands ;;\n"
                     "    argument)\n        case $line[1] in\n");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "        %s) _arguments", commands[i]->name);
        zsh_options(i, out);
        if (shipped_of(i) != NULL) {
            mt_text_addf(out, " \\\n            '*:%s:(", shipped_of(i)->what);
            mt_shipped_names(shipped_of(i), out);
            mt_text_add(out, ")' ;;\n");
        } else {
            mt_text_add(out, " \\\n            '*:file:_files -g \"*.json\"' ;;\n");
        }
    }
    mt_text_add(out, "        esac ;;\n    esac\n}\n_modetune \"$@\"\n");
}

/* A script for this shell that completes commands, options, their values and files, from the
 * tables of --help. */
static void print_completion(const mt_command *const *commands, mt_shell shell, mt_text *out)
{
    if (shell == MT_SHELL_BASH) {
        bash(commands, out);
    } else {
        zsh(commands, out);
    }
}

/* The command help, and the options of every command that ask what the program is. */

static int run_help(const mt_args *args, mt_text *out)
{
    if (args->given[MT_OPT_VERSION]) {
        mt_text_addf(out, "modetune %s (commit %s, compiled by %s)\n", mt_version(),
                     mt_build_commit(), mt_build_compiler());
    } else if (args->given[MT_OPT_MANUAL]) {
        print_manual(args->commands, args->command, out);
    } else if (args->given[MT_OPT_COMPLETION]) {
        print_completion(args->commands, args->shell, out);
    } else if (args->given[MT_OPT_HELP]) {
        print_help(args->commands, args->command, out);
    } else {
        return show_topic(args, out);
    }
    return MT_EXIT_DONE;
}

const mt_command mt_command_help = {
    .name = "help",
    .operands = "[TOPIC]",
    .least = 0,
    .most = 1,
    .summary = "what the documents say of a command or a word",
    .details =
        "Prints the sections of the documents about a topic: a command, or a member of a "
        "model, a study or a result (avoid, bushing, margin_percent). Explanations come "
        "first, then the reference of the file formats. Without a topic: lists all "
        "commands and topics.",
    .run = run_help,
};
