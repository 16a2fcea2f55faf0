/* SPDX-License-Identifier: GPL-3.0-or-later */
/* --help, from the tables. */
#include "cli/help.h"

#include <stdbool.h>
#include <string.h>

#include "base/format.h"
#include "cli/args.h"

enum { OPTION_COLUMN = 31, EXIT_COLUMN = 7, LINE_WIDTH = 92, FORM_TEXT = 64 };

static void spaces(int n, mt_text *out)
{
    for (int i = 0; i < n; i++) {
        mt_text_add(out, " ");
    }
}

void mt_help_fill(const char *s, int column, mt_text *out)
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

static void help_option(const mt_option *o, mt_text *out)
{
    char form[FORM_TEXT];
    const int n =
        mt_snprintf(form, sizeof form, "  %c%c%s--%s%s%s", o->letter == '\0' ? ' ' : '-',
                    o->letter == '\0' ? ' ' : o->letter, o->letter == '\0' ? "  " : ", ",
                    o->name, o->value == NULL ? "" : " ", o->value == NULL ? "" : o->value);
    mt_text_add(out, form);
    if (n + 2 > OPTION_COLUMN) {
        mt_text_add(out, "\n");
        spaces(OPTION_COLUMN, out);
    } else {
        spaces(OPTION_COLUMN - n, out);
    }
    mt_help_fill(o->help, OPTION_COLUMN, out);
}

static void help_command(int command, mt_text *out)
{
    const mt_command *const c = &mt_commands[command];
    mt_text_addf(out, "Usage: modetune %s %s [options]\n\n", c->name, c->operands);
    mt_help_fill(c->details, 0, out);
    mt_text_add(out, "\nOptions:\n");
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_option_is_of(i, command)) {
            help_option(&mt_options[i], out);
        }
    }
}

void mt_help(int command, mt_text *out)
{
    if (command != MT_CMD_NONE) {
        help_command(command, out);
        return;
    }
    mt_text_add(
        out, "Usage: modetune COMMAND ...\n\n"
             "Tells what to change so that the natural frequencies of a mechanism land where "
             "they must.\n\nCommands:\n");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "  %-12s %s\n", mt_commands[i].name, mt_commands[i].summary);
    }
    mt_text_add(out, "\nOptions of every command:\n");
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (mt_options[i].commands == MT_ALL_COMMANDS || mt_options[i].commands == 0U) {
            help_option(&mt_options[i], out);
        }
    }
    mt_text_add(out, "\n\"modetune COMMAND --help\" explains a command, \"modetune help "
                     "TOPIC\" a command or a "
                     "word of a\nmodel, a study or a result.\n\nExit status:\n");
    for (int i = 0; i < MT_EXITS; i++) {
        mt_text_addf(out, "  %-4d ", mt_exits[i].code);
        mt_help_fill(mt_exits[i].meaning, EXIT_COLUMN, out);
    }
}
