/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_TABLE_H
#define REPORT_TABLE_H

#include <stddef.h>

#include "base/arena.h"
#include "base/base.h"
#include "base/text.h"
#include "result/record.h"

/*
 * A table that can be printed as aligned text, CSV (RFC 4180) or HTML. Columns come first, then
 * cells row by row. A shortage of memory is remembered and passed on to the mt_text of the
 * printed table, which the caller checks at the end.
 */
typedef enum mt_align {
    MT_ALIGN_LEFT,
    MT_ALIGN_RIGHT,
    MT_ALIGN_POINT /* numbers with their decimal points below each other */
} mt_align;

typedef struct mt_column {
    const char *heading; /* for people, with its unit: "frequency [Hz]" */
    const char *member;  /* for machines: "frequency_hz" */
    mt_align align;
} mt_column;

typedef struct mt_cell {
    const char *text;  /* for people */
    const char *exact; /* for machines */
    const char *mark;  /* class of the cell on a page; NULL: none */
} mt_cell;

typedef struct mt_table {
    mt_arena mem;
    mt_column *columns;
    int n_columns;
    int cap_columns;
    mt_cell *cells; /* row by row */
    int n_cells;
    int cap_cells;
    bool failed; /* out of memory */
} mt_table;

/* An empty table; mt_table_free accepts one that was never used (zeroed). */
mt_table mt_table_default(void);
void mt_table_free(mt_table *t);
/* Add a column; all columns before the first cell. Texts are copied. */
void mt_table_column(mt_table *t, const char *heading, const char *member, mt_align align);
/* Add a cell: its text for people, and for machines. */
void mt_table_cell(mt_table *t, const char *text, const char *exact);
/* Cells of texts and numbers; NULL and NaN are "-" for people and empty for machines. */
void mt_table_text(mt_table *t, const char *text);
void mt_table_integer(mt_table *t, long long value);
void mt_table_number(mt_table *t, double value, int digits);
void mt_table_change(mt_table *t, double value, int digits); /* with its sign */
/* A number, and the name of its unit, displayed to people in another unit, as value / factor
 * (result/result.h), and given to machines in SI. Factor NULL or not above 0: in the unit
 * itself. */
void mt_table_shown(mt_table *t, double value, double factor, int digits);
void mt_table_unit(mt_table *t, const char *unit, const char *display_unit);
/* mt_table_percent: a percentage with its sign; mt_table_ratio: a ratio without. For people,
 * noise (base/number.h) is written as 0. */
void mt_table_percent(mt_table *t, double value, int digits);
void mt_table_ratio(mt_table *t, double value, int digits);
int mt_table_rows(const mt_table *t);

/*
 * Tables of records (result/record.h): a member's name and type stand in the record, which also
 * JSON is written by; a column says where it stands, what people read above it, and how many
 * digits it has. A value is shown as its text where it has one.
 */
enum { MT_IN_TEXT = 1, MT_IN_CSV = 2, MT_IN_TABLES = MT_IN_TEXT | MT_IN_CSV, MT_IN_OWN = 4 };

typedef struct mt_record_column {
    size_t offset;       /* of the member in its struct */
    const char *heading; /* for people, with its unit */
    const char *member;  /* for machines, not as in JSON; NULL: as there, or the heading */
    int digits;          /* of numbers */
    bool with_sign;
    bool right;  /* at the right, numbers not by their points */
    unsigned in; /* MT_IN_TEXT, MT_IN_CSV; from MT_IN_OWN on: where the caller says so */
} mt_record_column;

typedef struct mt_record_table {
    const mt_record *record;
    int n;
    const mt_record_column *columns; /* [n] in their order */
} mt_record_table;

/* Columns of the struct THIS, and a table of them. */
#define MT_R_COLUMN(m, heading_, digits_, in_)                                               \
    {                                                                                        \
        .offset = offsetof(THIS, m), .heading = (heading_), .digits = (digits_), .in = (in_) \
    }
#define MT_R_CHANGE(m, heading_, member_, digits_, in_)                          \
    {                                                                            \
        .offset = offsetof(THIS, m), .heading = (heading_), .member = (member_), \
        .digits = (digits_), .with_sign = true, .in = (in_)                      \
    }
#define MT_R_RIGHT(m, heading_, digits_, in_)                                    \
    {                                                                            \
        .offset = offsetof(THIS, m), .heading = (heading_), .digits = (digits_), \
        .right = true, .in = (in_)                                               \
    }
#define MT_R_TABLE_OF(record_, columns_)           \
    {                                              \
        &(record_), MT_COUNT(columns_), (columns_) \
    }

/* Add the columns that are in any of these places, and the cells of one struct: texts, numbers,
 * values, counts and flags. */
void mt_table_record_columns(mt_table *t, const mt_record_table *of, unsigned in);
void mt_table_record_row(mt_table *t, const mt_record_table *of, unsigned in, const void *item);
/* The same; of lists of numbers the cell of item i. */
void mt_table_record_nth(mt_table *t, const mt_record_table *of, unsigned in, const void *item,
                         int i);

/* Heading, rule, rows; two blanks between columns, `indent` before the first, none after the
 * last. Empty columns other than the first are left out; columns beyond `width` (0: unlimited)
 * follow below, after the same first columns. */
void mt_table_print(const mt_table *t, int indent, int width, mt_text *out);
/* Header line and rows, each ended by CR LF. */
void mt_table_csv(const mt_table *t, mt_text *out);
/* <table>...</table>, every text escaped. */
void mt_table_html(const mt_table *t, mt_text *out);

/* One CSV field in one line, quoted where RFC 4180 requires it; control characters are made
 * visible (base/text.h). Text that a spreadsheet would take for a formula (it begins with =
 * + - @) gets an apostrophe in front; a number does not. */
void mt_csv_field(const char *s, mt_text *out);
/* Escape text for HTML or a quoted attribute: & < > " ' become references, control characters
 * except tab and line feed are made visible. */
void mt_html_escape(const char *s, mt_text *out);

enum { MT_NUMBER_TEXT = 40 };

/* A number for people: `digits` significant ones (1..17) with trailing zeros, which show the
 * precision ("18.0000"), 0 as "0", NaN ("not applicable") as "-", infinities as a word
 * (base/format.h). Exponents only where |x| >= 10^digits or < 1e-4 ("2.1e+11"). Returns
 * buffer. */
const char *mt_report_number(double x, int digits, char buffer[MT_NUMBER_TEXT]);
/* The same, always with a sign ("+3.20"): for changes. */
const char *mt_report_change(double x, int digits, char buffer[MT_NUMBER_TEXT]);
/* A number for machines: 17 significant digits, empty where not finite (null in JSON). Returns
 * buffer. */
const char *mt_report_exact(double x, char buffer[MT_NUMBER_TEXT]);

#endif
