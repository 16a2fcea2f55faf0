/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCENE_WRITE_H
#define SCENE_WRITE_H

#include "base/text.h"
#include "io/write_json.h"
#include "scene/scene.h"

/* A member of a scene: how it is written, and what its JSON Schema says of it. */
typedef struct mt_scene_table mt_scene_table;
typedef struct mt_scene_row mt_scene_row;
struct mt_scene_row {
    const char *name;
    /* Write the member of the struct; v: the configuration that it is in, NULL: none */
    void (*put)(mt_json_writer *w, const mt_scene_row *row, const void *item,
                const mt_scene_view *v);
    size_t at;    /* place of its value in the struct */
    size_t other; /* of a list's count, or of the flag without which it is null */
    const mt_scene_table *of;
    const char *const *choices;
    const char *says;
    const char *schema; /* its type, as JSON; NULL: an object, or a list of objects */
    const char *limits; /* more of it; NULL: none */
    int n_choices;
    int digits; /* significant digits of a number; 0: all */
    bool list;
    bool views; /* the list of configurations */
    bool or_null;
};
struct mt_scene_table {
    const mt_scene_row *rows; /* [n], all of them always written */
    int n;
    size_t size;      /* of the struct */
    bool flat;        /* on one line */
    const char *says; /* NULL: said where it is used */
};
extern const mt_scene_table mt_scene_members;

/* Append a scene as JSON (format "modetune-scene/1"), for pages and other drawings: positions
 * with six digits, frequencies with nine. The same scene gives the same bytes. Fails:
 * MT_E_MEMORY. */
mt_status mt_scene_write(const mt_scene *scene, mt_text *out, mt_err *err);
/* The same without white space, as a page embeds it. */
mt_status mt_scene_write_page(const mt_scene *scene, mt_text *out, mt_err *err);

#endif
