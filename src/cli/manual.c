/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The manual page, from the tables behind --help: what they do not say, this file does. */
#include "cli/manual.h"

#include "modetune/version.h"

#include <ctype.h>
#include <string.h>

#include "cli/args.h"

static const char description[] =
    "A model describes a mechanism: bodies, joints, springs, flexible links, with numbers that "
    "may be expressions of parameters. A study names the parameters that may change, within "
    "bounds, and what is asked of the natural frequencies and mode shapes. Both are JSON "
    "files; their schemas are part of the source distribution.";

static const char text_from_files[] =
    "Names, titles, paths and other texts from outside are shown, never obeyed: control "
    "characters, marks of direction, zero-width characters and bytes that are no UTF-8 are "
    "written as \\u001b or \\x9b. In CSV, text that a spreadsheet would take for a formula has "
    "an apostrophe in front. What has no number is null in JSON, an empty cell in CSV, - or a "
    "word in text.";

static const char interrupts[] =
    "The first SIGINT or SIGTERM ends a search, and run.incomplete of result.json says which "
    "parts of the answer are missing; a second one ends the program at once, as the first one "
    "does in every command that does not search. Where several studies or files are given, the "
    "worst status counts.";

/* Text of man(7): what it would obey is made visible, words --like-this are bold. */
static void roff(const char *s, mt_text *out)
{
    bool bold = false;
    for (const char *at = s; *at != '\0'; at++) {
        const bool begins = at == s || strchr(" (\"\n", at[-1]) != NULL;
        if (begins && strncmp(at, "--", 2) == 0 && isalpha((unsigned char)at[2]) != 0) {
            mt_text_add(out, "\\fB");
            bold = true;
        } else if (bold && *at != '-' && isalpha((unsigned char)*at) == 0) {
            mt_text_add(out, "\\fR");
            bold = false;
        }
        if ((at == s || at[-1] == '\n') && (*at == '.' || *at == '\'')) {
            mt_text_add(out, "\\&");
        }
        switch (*at) {
        case '\\':
            mt_text_add(out, "\\e");
            break;
        case '-':
            mt_text_add(out, "\\-");
            break;
        case '\n':
            mt_text_add(out, "\n.IP\n"); /* a paragraph, as deep as the one before */
            break;
        default:
            mt_text_add_n(out, at, 1);
        }
    }
    mt_text_add(out, bold ? "\\fR\n" : "\n");
}

/* A paragraph with a hanging tag: bold, then italic (NULL: nothing). */
static void tag(const char *bold, const char *italic, mt_text *out)
{
    mt_text_add(out, ".TP\n\\fB");
    for (const char *at = bold; *at != '\0'; at++) {
        mt_text_add(out, *at == '-' ? "\\-" : (char[]){*at, '\0'});
    }
    mt_text_add(out, "\\fR");
    if (italic != NULL) {
        mt_text_add(out, " \\fI");
        mt_text_add(out, italic);
        mt_text_add(out, "\\fR");
    }
    mt_text_add(out, "\n");
}

static void section(const char *title, mt_text *out)
{
    mt_text_add(out, ".SH ");
    mt_text_add(out, title);
    mt_text_add(out, "\n");
}

/* "modes, sweep: " before the help of an option that not all commands take. */
static void owners(int option, mt_text *out)
{
    const char *before = "\\fB";
    if (mt_options[option].commands == 0U || mt_options[option].commands == MT_ALL_COMMANDS) {
        return;
    }
    for (int i = 0; i < MT_CMD_IDS; i++) {
        if (mt_option_is_of(option, i)) {
            mt_text_add(out, before);
            mt_text_add(out, mt_commands[i].name);
            before = "\\fR, \\fB";
        }
    }
    mt_text_add(out, "\\fR: ");
}

static void options(mt_text *out)
{
    for (int i = 0; i < MT_OPT_IDS; i++) {
        const mt_option *const o = &mt_options[i];
        mt_text form = {.s = NULL};
        if (o->letter != '\0') {
            mt_text_addf(&form, "-%c, ", o->letter);
        }
        mt_text_addf(&form, "--%s", o->name);
        out->failed = out->failed || form.failed;
        tag(form.failed ? "" : form.s, o->value, out);
        mt_text_free(&form);
        owners(i, out);
        roff(o->help, out);
    }
}

void mt_manual(mt_text *out)
{
    mt_text_add(out,
                ".\\\" SPDX-License-Identifier: GPL-3.0-or-later\n"
                ".\\\" made by \"modetune --manual\"\n"
                ".TH MODETUNE 1 \"\" \"modetune " MT_VERSION_STRING "\" \"User Commands\"\n"
                ".SH NAME\n"
                "modetune \\- what to change so that natural frequencies land where they must\n"
                ".SH SYNOPSIS\n");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_add(out, i == 0 ? "" : ".br\n");
        mt_text_add(out, "\\fBmodetune ");
        mt_text_add(out, mt_commands[i].name);
        mt_text_add(out, "\\fR \\fI");
        mt_text_add(out, mt_commands[i].operands);
        mt_text_add(out, "\\fR [\\fIoptions\\fR]\n");
    }
    section("DESCRIPTION", out);
    roff(description, out);
    section("COMMANDS", out);
    for (int i = 0; i < MT_CMD_IDS; i++) {
        tag(mt_commands[i].name, mt_commands[i].operands, out);
        roff(mt_commands[i].details, out);
    }
    section("OPTIONS", out);
    options(out);
    section("EXIT STATUS", out);
    for (int i = 0; i < MT_EXITS; i++) {
        mt_text_addf(out, ".TP\n\\fB%d\\fR\n", mt_exits[i].code);
        roff(mt_exits[i].meaning, out);
    }
    mt_text_add(out, ".PP\n");
    roff(interrupts, out);
    section("TEXT FROM FILES", out);
    roff(text_from_files, out);
    section("ENVIRONMENT", out);
    tag("NO_COLOR", NULL, out);
    roff("No colour on a terminal.", out);
}
