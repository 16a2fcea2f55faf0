/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_MAN_H
#define CLI_MAN_H

#include "base/text.h"

/* Text in the language of man(7). Characters with a meaning there are escaped. */

/* ".SH TITLE"; the title is written in capitals. */
void mt_man_section(const char *title, size_t length, mt_text *out);
/* A paragraph with a hanging tag: bold, then italic (NULL: none). Its text follows. */
void mt_man_tag(const char *bold, const char *italic, mt_text *out);
/* Text of --help: paragraphs, one per line, below a hanging tag or not; words --like-this are
 * bold. */
void mt_man_help(const char *s, bool hanging, mt_text *out);
/**
 * Markdown, from begin to end: paragraphs, lists, code blocks, headings as sections; links as
 * their text, without pictures and comments. A block of console output that begins with
 * "modetune ... --help" is left out: pages have OPTIONS. "See also: ..." becomes the section of
 * that name, in which `modetune run` is modetune-run(1). headed: a section has just begun, so
 * that a paragraph needs no macro.
 */
void mt_man_markdown(const char *begin, const char *end, bool headed, mt_text *out);

#endif
