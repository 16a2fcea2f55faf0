/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The manual pages: from the tables behind --help, and from the document of the commands. */
#include "cli/manual.h"

#include "modetune/version.h"

#include <string.h>

#include "cli/args.h"
#include "cli/documents.h"
#include "cli/man.h"

static const char description[] =
    "A model describes a mechanism: bodies, joints, springs, flexible links, with numbers that "
    "may be expressions of parameters. A study names the parameters that may change, within "
    "bounds, and what is asked of the natural frequencies and mode shapes. Both are JSON "
    "files. \\fBmodetune help\\fR \\fITOPIC\\fR explains their members.";

static void section(const char *title, mt_text *out)
{
    mt_man_section(title, strlen(title), out);
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
    mt_man_tag(form.failed ? "" : form.s, o->value, out);
    mt_text_free(&form);
    mt_man_help(o->help, true, out);
}

static void add_exits(mt_text *out)
{
    for (int i = 0; i < MT_EXITS; i++) {
        mt_text_addf(out, ".TP\n\\fB%d\\fR\n", mt_exits[i].code);
        mt_man_help(mt_exits[i].meaning, true, out);
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
    mt_man_help(c->details, false, out);
    mt_man_markdown(body, rest, false, out);
    section("OPTIONS", out);
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_option_is_of(i, command)) {
            add_option(&mt_options[i], out);
        }
    }
    mt_man_markdown(rest, last, false, out);
    section("EXIT STATUS", out);
    add_exits(out);
    mt_man_markdown(last, end, false, out);
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
        mt_man_section(title, strcspn(title, "\n"), out);
        const bool of_exits = strncmp(title, exits, strlen(exits)) == 0;
        if (of_exits) {
            add_exits(out);
        }
        mt_man_markdown(p.body, p.end, !of_exits, out);
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
        mt_man_tag(mt_commands[i].name, mt_commands[i].operands, out);
        mt_man_help(mt_commands[i].summary, true, out);
    }
    section("OPTIONS", out);
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_options[i].commands == MT_ALL_COMMANDS || mt_options[i].commands == 0U) {
            add_option(&mt_options[i], out);
        }
    }
    add_common(out);
    section("ENVIRONMENT", out);
    mt_man_tag("NO_COLOR", NULL, out);
    mt_man_help("No colour on a terminal.", true, out);
    section("SEE ALSO", out);
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "\\fBmodetune\\-%s\\fR(1)%s\n", mt_commands[i].name,
                     i + 1 < MT_CMD_IDS ? "," : "");
    }
}
