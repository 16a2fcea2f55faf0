/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_JSON_H
#define IO_JSON_H

#include <stdbool.h>
#include <stddef.h>

#include "base/diagnostics.h"
#include "base/text.h"

/*
 * A JSON text, strictly RFC 8259: scanned first (mt_json_scan validates everything and records
 * the place of each value), then parsed by cJSON, which builds the values. Also refused, beyond
 * the RFC, are a byte order mark, a name given twice in an object, U+0000 in a string, numbers
 * outside the range of a double, nesting deeper than MT_JSON_MAX_DEPTH, more than
 * MT_JSON_MAX_BYTES bytes or MT_JSON_MAX_VALUES values.
 *
 * A value's address (mt_addr) is its index in document order; MT_JSON_ROOT is the whole text.
 * Addresses of mt_json_name_addr denote the member name in front of a value. Diagnostics take
 * both kinds and give their places. Lines count from 1 and end at LF, CR or CR LF; columns
 * count UTF-8 code points from 1.
 */
enum {
    MT_JSON_ROOT = 0,
    MT_JSON_MAX_DEPTH = 64,
    MT_JSON_MAX_BYTES = 512 * 1024 * 1024,
    MT_JSON_MAX_VALUES = 30000000
};

/* Bits, so that several types can be allowed at once. */
typedef enum mt_json_type {
    MT_JSON_NULL = 1,
    MT_JSON_BOOL = 2,
    MT_JSON_NUMBER = 4,
    MT_JSON_STRING = 8,
    MT_JSON_ARRAY = 16,
    MT_JSON_OBJECT = 32
} mt_json_type;

typedef struct mt_json mt_json;

/**
 * Read a text.
 * @param[in]  text   length bytes, need not be NUL-terminated; not kept
 * @param[out] out    the document, owned by the caller; given for MT_OK and MT_E_INPUT, else
 *                    NULL
 *   Fails: MT_E_INPUT when the text is not JSON (every problem is in mt_json_diags; the
 *   document then has no values and serves mt_json_report only), MT_E_MEMORY. A name given
 *   twice is a problem in mt_json_diags, but MT_OK: reading can go on, and later members of
 *   that name are ignored.
 */
mt_status mt_json_parse(const char *text, size_t length, mt_json **out, mt_err *err);
void mt_json_delete(mt_json *doc);

/* The problems found in this document by the parser and its readers. Lives as long as the
 * document. */
mt_diags *mt_json_diags(mt_json *doc);

mt_json_type mt_json_type_of(const mt_json *doc, mt_addr value);
/* "null", "true or false", "a number", "a string", "a list", "an object" */
const char *mt_json_type_text(mt_json_type type);
/* The value of a string (never NULL), number or true/false; the value must have that type.
 * Numbers are the nearest doubles in any locale. Strings live as long as the document. */
const char *mt_json_string(const mt_json *doc, mt_addr value);
double mt_json_number(const mt_json *doc, mt_addr value);
bool mt_json_bool(const mt_json *doc, mt_addr value);
/* Number of items of a list or members of an object; the first of them; the next after one.
 * MT_NO_ADDR at the end. */
int mt_json_count(const mt_json *doc, mt_addr value);
mt_addr mt_json_first(const mt_json *doc, mt_addr value);
mt_addr mt_json_next(const mt_json *doc, mt_addr value);
/* The member of that name (case-sensitive; the first of several); MT_NO_ADDR where there is
 * none or value is not an object. O(members). */
mt_addr mt_json_member(const mt_json *doc, mt_addr value, const char *name);
/* The name in front of a member's value; NULL for other values. */
const char *mt_json_name(const mt_json *doc, mt_addr value);
/* The address of that name, for messages about the member itself: its JSON pointer is the
 * object's. */
mt_addr mt_json_name_addr(const mt_json *doc, mt_addr value);

/* Offsets in bytes of the beginning and the end (one past) of the source text of a number or
 * string (quotes included). False for values of other types. */
bool mt_json_span(const mt_json *doc, mt_addr value, size_t *begin, size_t *end);

/*
 * The strict scanner of JSON texts. It refuses all of that except names given twice and numbers
 * out of range, whose detection needs values. It records only what cJSON does not: the place of
 * each value.
 */

/* A value, in document order (its index is its address), or a syntax error. */
typedef struct mt_json_spot {
    unsigned start; /* offset of its first byte */
    unsigned name;  /* offset of the quote that opens its name; 0: not a member */
    int parent;     /* its list or object; MT_NO_ADDR: none */
    bool mistake;
} mt_json_spot;

typedef struct mt_json_spots {
    mt_json_spot *items; /* in the arena of the diagnostics, which remembers a shortage */
    int n;
    int capacity;
    int most; /* [in] largest number of values; a text with more is refused */
} mt_json_spots;

/* Scan all values of a text of length bytes followed by a NUL; syntax errors go to diags with
 * their addresses. A text longer than MT_JSON_MAX_BYTES is not read. O(length). */
void mt_json_scan(const char *text, size_t length, mt_json_spots *out, mt_diags *diags);

/*
 * The items of a list or the members of an object, in order:
 *     for (mt_items i = mt_reader_items(r, value); mt_items_next(&i);) { ... i.at ... }
 * An array is allocated (mt_reader_room) from the walk that fills it: the count is that of the
 * walk, so no item exceeds the array. A test checks that no other code walks or counts values.
 */
typedef struct mt_items {
    const mt_json *doc;
    mt_addr at;   /* the present item; MT_NO_ADDR before the first and after the last */
    mt_addr next; /* the one after it */
    int count;    /* items of the whole walk */
    int left;     /* items not yet visited */
} mt_items;

/* The items of a value; of MT_NO_ADDR none. */
mt_items mt_json_items(const mt_json *doc, mt_addr value);
/* Go on to the next item; false where there is none. */
bool mt_items_next(mt_items *items);

/*
 * A document that was made of others: its text was written by a program, and every value
 * remembers which value of which document it stands for. Places, pointers and diagnostics are
 * those of the originals.
 */
/* Where a value comes from. */
typedef struct mt_json_origin {
    int doc;      /* index of a document */
    mt_addr addr; /* of a value or a name there */
    int note;     /* index of what messages add about it, in parentheses; -1: nothing */
} mt_json_origin;

typedef struct mt_json_parts {
    int n_docs; /* docs[0] is the document itself */
    mt_json **docs;
    const char *const *files;      /* [n_docs]: what they are called; that of docs[0] is NULL */
    const int *by;                 /* [n_docs]: the note about all of a document; -1: none */
    int n_origins;                 /* the number of values of the text */
    const mt_json_origin *origins; /* in document order */
    int n_notes;
    const char *const *notes; /* "copy 3 of \"mount\", line 12" */
} mt_json_parts;

/* Turn a document into one of this text, made of `parts`: problems noted in these documents are
 * the problems of this one; doc stays the caller's. The other documents become its own (also on
 * failure). Fails: MT_E_MEMORY; MT_E_INTERNAL where the origins do not fit the text. */
mt_status mt_json_become(mt_json *doc, const char *text, size_t length,
                         const mt_json_parts *parts, mt_err *err);
/* The file of an address of a document made of several; NULL: the document's own. */
const char *mt_json_file(const mt_json *doc, mt_addr addr);
/* The text of a document: length bytes and a NUL, alive as long as it is. */
const char *mt_json_text(const mt_json *doc, size_t *length);

/* Conversion of addresses to places and JSON pointers, and diagnostics with these. */

/* The line and column of an address. */
void mt_json_locate(const mt_json *doc, mt_addr addr, int *line, int *column);
/* The same for n addresses of values in ascending order, in one walk through the text. */
void mt_json_locates(const mt_json *doc, int n, const mt_addr *addrs, int *lines, int *columns);
/* The value that a JSON pointer of so many bytes leads to; MT_NO_ADDR where there is none. */
mt_addr mt_json_find(const mt_json *doc, const char *pointer, size_t length);
/* Append the JSON pointer of an address (RFC 6901: ~ is ~0, / is ~1; the root's is empty). */
void mt_json_pointer(const mt_json *doc, mt_addr addr, mt_text *out);
/* Add all diagnostics with their places, sorted by place (those of one place in the order
 * found), and the number of those beyond MT_DIAG_LIMIT. */
void mt_json_report(const mt_json *doc, const char *file, mt_diagnostics *out);
/* MT_E_MEMORY, MT_E_INPUT where there are errors, or MT_OK. err: the first error as printed,
 * and the number of others. */
mt_status mt_json_status(const mt_json *doc, const char *file, mt_err *err);

#endif
