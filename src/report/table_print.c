/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table as aligned text: columns that hold nothing are left out, and what a terminal has no
 * room for is told below, under the same first columns. */
#include <string.h>

#include "base/format.h"
#include "report/table.h"

enum { GAP = 2, MOST_KEYS = 2 };

/* Columns up to the decimal point, or where it would stand. */
static int before_point(const char *s)
{
    return mt_text_width(s) - mt_text_width(s + strcspn(s, ".e"));
}

typedef struct layout {
    int width;  /* of the column */
    int before; /* MT_ALIGN_POINT: widest part before the point */
} layout;

static int larger(int a, int b)
{
    return a > b ? a : b;
}

static layout measure_column(const mt_table *t, int column)
{
    layout l = {0, 0};
    int after = 0;
    const bool point = t->columns[column].align == MT_ALIGN_POINT;
    for (int i = column; i < t->n_cells; i += t->n_columns) {
        const char *const s = t->cells[i].text;
        if (point) {
            l.before = larger(l.before, before_point(s));
            after = larger(after, mt_text_width(s) - before_point(s));
        } else {
            l.width = larger(l.width, mt_text_width(s));
        }
    }
    l.width = larger(l.width, l.before + after);
    const int heading = mt_text_width(t->columns[column].heading);
    if (point && heading > l.width) {
        l.before += heading - l.width; /* numbers stand at the right end of a wider heading */
    }
    l.width = larger(l.width, heading);
    return l;
}

static void pad(mt_text *out, int n)
{
    for (int i = 0; i < n; i++) {
        mt_text_add(out, " ");
    }
}

static void print_cell(mt_align align, const layout *l, const char *s, bool last, mt_text *out)
{
    const int width = mt_text_width(s);
    int before = align == MT_ALIGN_LEFT ? 0 : l->width - width;
    if (align == MT_ALIGN_POINT) {
        before = l->before - before_point(s);
    }
    pad(out, before);
    mt_text_add(out, s);
    pad(out, last ? 0 : l->width - width - before);
}

/* Trailing blanks of the line just written. */
static void end_line(mt_text *out)
{
    while (!out->failed && out->length > 0 && out->s[out->length - 1] == ' ') {
        out->s[--out->length] = '\0';
    }
    mt_text_add(out, "\n");
}

/* The columns that one block of lines shows. */
typedef struct block {
    int n;
    const int *columns;
} block;

static void print_block(const mt_table *t, const layout *l, const block *b, int indent,
                        mt_text *out)
{
    pad(out, indent);
    for (int k = 0; k < b->n; k++) {
        const int c = b->columns[k];
        const mt_align align =
            t->columns[c].align == MT_ALIGN_LEFT ? MT_ALIGN_LEFT : MT_ALIGN_RIGHT;
        print_cell(align, &l[c], t->columns[c].heading, k == b->n - 1, out);
        pad(out, k == b->n - 1 ? 0 : GAP);
    }
    end_line(out);
    pad(out, indent);
    for (int k = 0; k < b->n; k++) {
        for (int i = 0; i < l[b->columns[k]].width; i++) {
            mt_text_add(out, "-");
        }
        pad(out, k == b->n - 1 ? 0 : GAP);
    }
    end_line(out);
    for (int row = 0; row < t->n_cells; row += t->n_columns) {
        pad(out, indent);
        for (int k = 0; k < b->n; k++) {
            const int c = b->columns[k];
            print_cell(t->columns[c].align, &l[c], t->cells[row + c].text, k == b->n - 1, out);
            pad(out, k == b->n - 1 ? 0 : GAP);
        }
        end_line(out);
    }
}

static bool is_empty(const mt_table *t, int column)
{
    for (int i = column; i < t->n_cells; i += t->n_columns) {
        const char *const s = t->cells[i].text;
        if (s[0] != '\0' && strcmp(s, "-") != 0) {
            return false;
        }
    }
    return t->n_cells > 0;
}

/* The first columns that tell rows apart, which every block repeats: texts and counts, as long
 * as they leave half of the width. */
static int key_columns(const mt_table *t, const layout *l, int n, const int *kept, int room)
{
    int keys = 1;
    int used = l[kept[0]].width;
    while (keys < n && keys < MOST_KEYS && t->columns[kept[keys]].align != MT_ALIGN_POINT &&
           2 * (used + GAP + l[kept[keys]].width) <= room) {
        used += GAP + l[kept[keys++]].width;
    }
    return keys;
}

/* Blocks of as many columns as fit into the width, at least one besides those repeated. */
static void print_folded(const mt_table *t, const layout *l, int n, const int *kept, int *shown,
                         int indent, int width, mt_text *out)
{
    const int keys = key_columns(t, l, n, kept, width - indent);
    int used = indent;
    for (int k = 0; k < keys; k++) {
        shown[k] = kept[k];
        used += l[kept[k]].width + (k > 0 ? GAP : 0);
    }
    for (int next = keys; next < n || next == keys;) {
        int m = keys;
        int line = used;
        while (next < n && (m == keys || line + GAP + l[kept[next]].width <= width)) {
            line += GAP + l[kept[next]].width;
            shown[m++] = kept[next++];
        }
        print_block(t, l, &(block){m, shown}, indent, out);
        if (next >= n) {
            return;
        }
        mt_text_add(out, "\n");
    }
}

static int whole_width(const layout *l, int n, const int *kept, int indent)
{
    int width = indent;
    for (int k = 0; k < n; k++) {
        width += l[kept[k]].width + (k > 0 ? GAP : 0);
    }
    return width;
}

void mt_table_print(const mt_table *t, int indent, int width, mt_text *out)
{
    mt_arena scratch = {.first = NULL};
    const size_t n = (size_t)t->n_columns;
    layout *l = NULL;
    int *kept = NULL;
    if (!t->failed && mt_arena_init(&scratch, 0, NULL) == MT_OK) {
        l = mt_arena_alloc(&scratch, n, sizeof *l);
        kept = mt_arena_int(&scratch, 2 * n);
    }
    if (l == NULL || kept == NULL) {
        out->failed = true;
    } else if (n > 0) {
        int m = 0;
        for (int c = 0; c < t->n_columns; c++) {
            l[c] = measure_column(t, c);
            if (c == 0 || !is_empty(t, c)) {
                kept[m++] = c;
            }
        }
        if (width <= 0 || whole_width(l, m, kept, indent) <= width) {
            print_block(t, l, &(block){m, kept}, indent, out);
        } else {
            print_folded(t, l, m, kept, kept + n, indent, width, out);
        }
    }
    mt_arena_free(&scratch);
}
