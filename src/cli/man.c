/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/man.h"

#include <ctype.h>
#include <string.h>

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

void mt_man_section(const char *title, size_t length, mt_text *out)
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

void mt_man_tag(const char *bold, const char *italic, mt_text *out)
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

void mt_man_help(const char *s, bool hanging, mt_text *out)
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

void mt_man_markdown(const char *begin, const char *end, bool headed, mt_text *out)
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
            mt_man_section(title, (size_t)(line_end(&b, title) - title), out);
            next_line(&b);
            b.headed = true;
        } else if (begins(&b, b.at, "![")) {
            skip_paragraph(&b, "\n");
        } else if (begins(&b, b.at, see)) {
            mt_man_section(see, strlen(see) - 2, out);
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
