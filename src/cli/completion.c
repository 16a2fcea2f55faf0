/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Scripts for the shells, from the tables behind --help. What the value of an option may be is
 * read from how the tables call it: "a|b|c" are words, DIR a folder, MODEL and PROFILE a
 * file; of another value nothing is known.
 */
#include "cli/completion.h"

#include <stdbool.h>
#include <string.h>

#include "cli/args.h"
#include "cli/shipped.h"

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

/* -o --output, for a pattern of `case`. */
static void add_pattern(const mt_option *o, mt_text *out)
{
    if (o->letter != '\0') {
        mt_text_addf(out, "-%c|", o->letter);
    }
    mt_text_addf(out, "--%s", o->name);
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
static void bash_values(mt_text *out)
{
    mt_text_add(out, "    case $previous in\n");
    for (int i = 0; i < MT_OPT_IDS; i++) {
        const mt_option *const o = &mt_options[i];
        if (o->value == NULL) {
            continue;
        }
        mt_text_add(out, "    ");
        add_pattern(o, out);
        if (i == MT_OPT_FORMAT) {
            mt_text_add(out, ") COMPREPLY=($(compgen -W \"$formats\" -- \"$current\")); "
                             "return ;;\n");
        } else if (is_choice(o)) {
            mt_text_add(out, ") COMPREPLY=($(compgen -W '");
            add_choice(o->value, out);
            mt_text_add(out, "' -- \"$current\")); return ;;\n");
        } else if (is_called(o, "DIR")) {
            mt_text_add(out, ") COMPREPLY=($(compgen -d -- \"$current\")); return ;;\n");
        } else if (is_file(o)) {
            mt_text_add(out, ") ;;\n");
        } else {
            mt_text_add(out, ") return ;;\n");
        }
    }
    mt_text_add(out, "    esac\n");
}

static void bash(mt_text *out)
{
    mt_text_add(out,
                "# modetune(1) in bash: commands, options, values, JSON files\n"
                "_modetune() {\n"
                "    local current=${COMP_WORDS[COMP_CWORD]} "
                "previous=${COMP_WORDS[COMP_CWORD-1]} command= words= formats= names= word\n"
                "    for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
                "        case $word in\n        ");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "%s%s", i == 0 ? "" : "|", mt_commands[i].name);
    }
    mt_text_add(out, ") command=$word; break ;;\n        esac\n    done\n    COMPREPLY=()\n");
    mt_text_add(out, "    case $command in\n    '') words='");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "%s%s", i == 0 ? "" : " ", mt_commands[i].name);
    }
    bash_options(MT_CMD_NONE, out);
    mt_text_add(out, "' ;;\n");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "    %s) words='", mt_commands[i].name);
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
    bash_values(out);
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
        const char *const how = is_called(o, "DIR") ? "_files -/"
                                : is_file(o)        ? "_files -g \"*.json\""
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

static void zsh(mt_text *out)
{
    mt_text_add(out, "#compdef modetune\n"
                     "# modetune(1) in zsh: commands, options, values, JSON files\n"
                     "_modetune() {\n"
                     "    local curcontext=$curcontext state line\n"
                     "    local -a commands=(\n");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "        '%s:", mt_commands[i].name);
        zsh_text(mt_commands[i].summary, out);
        mt_text_add(out, "'\n");
    }
    mt_text_add(out, "    )\n    _arguments -C");
    zsh_options(MT_CMD_NONE, out);
    mt_text_add(out, " \\\n            '1:command:->command' '*::argument:->argument'\n"
                     "    case $state in\n"
                     "    command) _describe command commands ;;\n"
                     "    argument)\n        case $line[1] in\n");
    for (int i = 0; i < MT_CMD_IDS; i++) {
        mt_text_addf(out, "        %s) _arguments", mt_commands[i].name);
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

void mt_completion(mt_shell shell, mt_text *out)
{
    if (shell == MT_SHELL_BASH) {
        bash(out);
    } else {
        zsh(out);
    }
}
