/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The manual pages. */
#include "cli/manual.h"

#include "modetune/version.h"

#include <ctype.h>
#include <string.h>

#include "cli/args.h"
#include "cli/cmd_help.h"

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

static void add_option(const mt_option *o, mt_text *out)
{
    mt_text form = {.s = NULL};
    if (o->letter != '\0') {
        mt_text_addf(&form, "-%c, ", o->letter);
    }
    mt_text_addf(&form, "--%s", o->name);
    out->failed = out->failed || form.failed;
    man_tag(form.failed ? "" : form.s, o->value, out);
    mt_text_free(&form);
    man_help(o->help, true, out);
}

static void add_exits(mt_text *out)
{
    for (int i = 0; i < MT_EXITS; i++) {
        mt_text_addf(out, ".TP\n\\fB%d\\fR\n", mt_exits[i].code);
        man_help(mt_exits[i].meaning, true, out);
    }
}

/* The next section of the page whose heading is of level 2. */
static bool next_section(const mt_shipped *page, mt_passage *p)
{
    while (page != NULL && mt_passage_next(page->bytes, p)) {
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

static void manual_of(int command, mt_text *out)
{
    const mt_command *const c = &mt_commands[command];
    const mt_shipped *const page = mt_documents_find(MT_DOCUMENT_COMMANDS);
    mt_passage p = {.begin = NULL};
    bool found = next_section(page, &p);
    while (found && !mt_passage_is(&p, c->name)) {
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
            add_option(&mt_options[i], out);
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
    const mt_shipped *const page = mt_documents_find(MT_DOCUMENT_COMMANDS);
    mt_passage p = {.begin = NULL};
    while (next_section(page, &p)) {
        const char *at = NULL;
        const char *name = NULL;
        const char *const title = p.begin + strlen("## ");
        size_t length = 0;
        if (mt_passage_name(&p, &at, &name, &length)) {
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

void mt_manual(int command, mt_text *out)
{
    if (command != MT_CMD_NONE) {
        manual_of(command, out);
        return;
    }
    head("", "what to change so that natural frequencies land where they must", out);
    mt_text_add(out, "\\fBmodetune\\fR \\fICOMMAND\\fR ... [\\fIoptions\\fR]\n");
    section("DESCRIPTION", out);
    mt_text_add(out, description);
    mt_text_add(out, "\n");
    section("COMMANDS", out);
    for (int i = 0; i < MT_CMD_IDS; i++) {
        man_tag(mt_commands[i].name, mt_commands[i].operands, out);
        man_help(mt_commands[i].summary, true, out);
    }
    section("OPTIONS", out);
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_options[i].commands == MT_ALL_COMMANDS || mt_options[i].commands == 0U) {
            add_option(&mt_options[i], out);
        }
    }
    add_common(out);
    section("ENVIRONMENT", out);
    man_tag("NO_COLOR", NULL, out);
    man_help("No colour on a terminal.", true, out);
    section("SEE ALSO", out);
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "\\fBmodetune\\-%s\\fR(1)%s\n", mt_commands[i].name,
                     i + 1 < MT_CMD_IDS ? "," : "");
    }
}
