/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What joints, springs and sensors hold on to: "ground", a body, "link.start", "link.end",
 * "link.node3", "link.3". */
#include "model/resolve_priv.h"

#include <limits.h>
#include <string.h>

/* The number written in s, 0 or more without leading zeros; -1: not a number. */
static int whole_number(const char *s)
{
    int n = 0;
    if (*s == '\0' || (s[0] == '0' && s[1] != '\0')) {
        return -1;
    }
    for (; *s != '\0'; s++) {
        if (*s < '0' || *s > '9' || n > (INT_MAX - 9) / 10) {
            return -1;
        }
        n = 10 * n + (*s - '0');
    }
    return n;
}

/* "start", "end", "3", "node3"; false for any other part. Elements count from 1, nodes from
 * 0. */
static bool read_part(mt_attach *a, const mt_link *l, const char *part)
{
    static const char node[] = "node";
    const bool beam = l->kind == MT_LINK_BEAM;
    const int last = beam ? l->elements : l->elements - 1;
    if (strcmp(part, "start") == 0) {
        a->kind = MT_ATTACH_LINK_START;
        a->part = 0;
        return true;
    }
    if (strcmp(part, "end") == 0) {
        a->kind = MT_ATTACH_LINK_END;
        a->part = last;
        return true;
    }
    if (strncmp(part, node, sizeof node - 1) == 0) {
        a->kind = MT_ATTACH_LINK_NODE;
        a->element = whole_number(part + sizeof node - 1);
        /* the element that ends there */
        a->part = beam || a->element == 0 ? a->element : a->element - 1;
        return a->element >= 0 && a->element <= l->elements;
    }
    a->kind = MT_ATTACH_LINK_ELEMENT;
    a->element = whole_number(part) - 1;
    a->part = a->element;
    return !beam && a->element >= 0 && a->element <= last;
}

/* Part of a link behind the dot. */
static void attach_link(mt_resolve *f, mt_attach *a, int link, const char *part)
{
    const mt_link *const l = &f->m->links[link];
    a->index = link;
    if (read_part(a, l, part) || l->elements == 0) {
        return; /* or the link could not be read */
    }
    if (l->kind == MT_LINK_BEAM) {
        mt_diag_error(f->d, a->name.addr,
                      "\"%s\": beam link \"%s\" has \"start\", \"end\" and the nodes node0 to "
                      "node%d",
                      a->name.s, l->name.s, l->elements);
    } else {
        mt_diag_error(
            f->d, a->name.addr,
            "\"%s\": link \"%s\" has \"start\", \"end\", the elements 1 to %d and the "
            "nodes node0 to node%d",
            a->name.s, l->name.s, l->elements, l->elements);
    }
}

/* True for other common names of the ground. */
static bool is_ground(const char *word)
{
    static const char *const words[] = {"world", "World",    "base",  "Base",
                                        "frame", "Frame",    "earth", "chassis",
                                        "fixed", "inertial", "wall",  "0"};
    for (int i = 0; i < MT_COUNT(words); i++) {
        if (strcmp(word, words[i]) == 0) {
            return true;
        }
    }
    return false;
}

void mt_resolve_attach(mt_resolve *f, mt_attach *a)
{
    const mt_names *const table = &f->m->tables->bodies;
    const char *const s = a->name.s;
    a->kind = MT_ATTACH_GROUND;
    a->index = MT_GROUND;
    a->element = MT_ABSENT;
    a->part = 0;
    if (s == NULL || strcmp(s, "ground") == 0) {
        return;
    }
    bool found = false;
    const char *const dot = strchr(s, '.');
    const size_t length = dot == NULL ? strlen(s) : (size_t)(dot - s);
    const int i = mt_names_find(table, s, length, &found);
    if (!found) {
        static const char *const more[] = {"ground"};
        const char *const stem = mt_arena_strndup(&f->m->mem, s, length);
        const mt_name name = {.s = stem, .addr = a->name.addr};
        if (stem != NULL && dot == NULL && is_ground(stem)) {
            mt_diag_error(f->d, name.addr, "unknown body \"%s\"; did you mean \"ground\"?",
                          stem);
        } else if (stem != NULL) {
            mt_resolve_unknown(f, name, table, dot == NULL ? "body" : "link", more,
                               dot == NULL ? 1 : 0);
        }
    } else if (i >= 0 && dot == NULL) {
        a->kind = MT_ATTACH_BODY;
        a->index = i;
    } else if (i >= 0) {
        mt_diag_error(f->d, a->name.addr,
                      "\"%s\": \"%.*s\" is a body, not a link: it has no parts", s, (int)length,
                      s);
    } else if (dot == NULL) {
        mt_diag_error(f->d, a->name.addr,
                      "\"%s\" is a link: write \"%s.start\", \"%s.end\" or one of its %s", s, s,
                      s, f->m->links[-1 - i].kind == MT_LINK_BEAM ? "nodes" : "elements");
    } else {
        attach_link(f, a, -1 - i, dot + 1);
    }
}

bool mt_resolve_same_attach(const mt_attach *a, const mt_attach *b)
{
    if (a->name.s == NULL || b->name.s == NULL) {
        return false;
    }
    if (a->kind == MT_ATTACH_GROUND || b->kind == MT_ATTACH_GROUND) {
        return strcmp(a->name.s, b->name.s) == 0; /* an unknown name counts as ground as well */
    }
    /* "l.start" and "l.1" are one rigid element */
    return (a->kind == MT_ATTACH_BODY) == (b->kind == MT_ATTACH_BODY) && a->index == b->index &&
           a->part == b->part;
}

bool mt_resolve_is_point_mass(const mt_resolve *f, const mt_attach *a)
{
    return a->kind == MT_ATTACH_BODY && f->m->bodies[a->index].point_mass;
}

void mt_resolve_needs_attach(mt_resolve *f, mt_name item, const char *what,
                             const mt_presence *in, const mt_attach *part)
{
    switch (part->kind) {
    case MT_ATTACH_GROUND:
        return;
    case MT_ATTACH_BODY:
        mt_resolve_needs(f, item, what, in, &f->m->bodies[part->index].in, "body",
                         f->m->bodies[part->index].name.s);
        return;
    case MT_ATTACH_LINK_START:
    case MT_ATTACH_LINK_END:
    case MT_ATTACH_LINK_ELEMENT:
    case MT_ATTACH_LINK_NODE:
        mt_resolve_needs(f, item, what, in, &f->m->links[part->index].in, "link",
                         f->m->links[part->index].name.s);
        return;
    }
}
