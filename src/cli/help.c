/* SPDX-License-Identifier: GPL-3.0-or-later */
/* --help, from the tables. */
#include <string.h>

#include "base/format.h"
#include "cli/args.h"

enum { OPTION_COLUMN = 31, LINE_WIDTH = 92, FORM_TEXT = 64 };

static void spaces(int n, mt_text *out)
{
    for (int i = 0; i < n; i++) {
        mt_text_add(out, " ");
    }
}

/* Words filled into lines that begin at `column`. */
static void fill(const char *s, int column, mt_text *out)
{
    int at = column;
    while (*s != '\0') {
        const int word = (int)strcspn(s, " ");
        if (at > column && at + 1 + word > LINE_WIDTH) {
            mt_text_add(out, "\n");
            spaces(column, out);
            at = column;
        } else if (at > column) {
            mt_text_add(out, " ");
            at++;
        }
        mt_text_add_n(out, s, (size_t)word);
        at += word;
        s += word;
        s += strspn(s, " ");
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
    fill(o->help, OPTION_COLUMN, out);
}

void mt_help_usage(int command, mt_text *out)
{
    const mt_command *const c = &mt_commands[command];
    mt_text_addf(out, "modetune %s %s [options]", c->name, c->operands);
}

static void help_command(int command, mt_text *out)
{
    mt_text_add(out, "Usage: ");
    mt_help_usage(command, out);
    mt_text_add(out, "\n\n");
    mt_text_add(out, mt_commands[command].details); /* lines */
    mt_text_add(out, "\n\nOptions:\n");
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if ((mt_options[i].commands & (1U << (unsigned)command)) != 0U) {
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
        const unsigned all = (1U << (unsigned)MT_CMD_IDS) - 1U;
        if (mt_options[i].commands == all || mt_options[i].commands == 0U) {
            help_option(&mt_options[i], out);
        }
    }
    mt_text_add(
        out, "\n\"modetune COMMAND --help\" explains a command.\n"
             "Exit status: 0 done and all goals met, 1 goals not met, 2 bad input or usage,\n"
             "3 numerical failure, 4 system failure, 130 interrupted.\n");
}
