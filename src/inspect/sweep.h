/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef INSPECT_SWEEP_H
#define INSPECT_SWEEP_H

#include "inspect/loaded_model.h"
#include "io/write_json.h"
#include "mechanics/sweep.h"

/* The positions of one configuration along the range of a driven joint, a path of several,
 * or over a grid of them: what `sweep` tells, as records. */

/* Frequencies by position, where no number is given. */
enum { MT_SWEEP_MODES = 6 };

typedef struct mt_sweep_question {
    int n_drives;
    mt_system_drive drives[MT_DRIVES_MOST]; /* [n_drives] */
    int n;                                  /* positions */
    int line;          /* of a grid: positions of a line along the last joint; 0: a path */
    double *positions; /* n_drives x n, rad or m from the reference position */
    int modes;         /* frequencies of so many modes at each position; 0: none */
} mt_sweep_question;

/* What is asked in texts: drives "JOINT=FROM:TO:N" (none: refused) with expressions of the
 * model's values; holds "SPRING" of the only joint, or "JOINT=SPRING", others are locked; grid:
 * each position with each, else all together. */
typedef struct mt_sweep_texts {
    int n_drives;
    const char *const *drives;
    int n_holds;
    const char *const *holds;
    bool grid;
} mt_sweep_texts;
/* In the memory of s. Fails: MT_E_USAGE, MT_E_MEMORY. */
mt_status mt_sweep_question_read(mt_loaded_model *s, const mt_sweep_texts *texts,
                                 mt_sweep_question *out, mt_err *err);

/* The sweep of one configuration. */
typedef struct mt_sweep_view {
    const char *configuration;
    const mt_sweep_question *question;
    const mt_system *sys;
    mt_sweep sweep;
    int modes;      /* frequencies per point; 0: there are none */
    double *hz;     /* modes x n points; NaN: no such mode */
    int *rigid;     /* [n] rigid-body modes; NULL: not requested */
    int *unstable;  /* [n] */
    int *undecided; /* [n] */
    mt_arena mem;
    mt_analysis *a;     /* with frequencies */
    mt_system *own_sys; /* without */
    mt_linear *lin;
} mt_sweep_view;

/* Sweep configuration c. v zeroed before; mt_sweep_view_free in any case; s and the question
 * must outlive v. A position that is not reached is told at its place. Fails: MT_E_USAGE (no
 * such joint, or out of its reach; err without the file), as mt_analysis_new and
 * mt_sweep_run. */
mt_status mt_sweep_view_take(const mt_loaded_model *s, int c, const mt_sweep_question *question,
                             mt_sweep_view *v, mt_err *err);
void mt_sweep_view_free(mt_sweep_view *v);

/* A joint with a coordinate at a position. */
typedef struct mt_swept_joint_row {
    const char *name;
    bool turns;
    bool slides;
    double coordinate;
    double ratio; /* to the first driven joint */
    bool several;
    int n_ratios;
    double *ratios; /* to each of several driven joints */
} mt_swept_joint_row;

/* One of several driven joints, at a position. */
typedef struct mt_swept_drive_row {
    bool turns;
    bool slides;
    double position;
    bool holds_moment;
    bool holds_force;
    double hold;
} mt_swept_drive_row;

/* A position of the driven joint, the first of several. */
typedef struct mt_sweep_point_row {
    bool turns;          /* the driven joint: its position is an angle */
    bool slides;         /* else */
    double position_rad; /* of a joint that turns */
    double position_m;   /* of one that slides */
    const char *error;
    bool failed;
    bool reached;
    int n_joints;
    mt_swept_joint_row *joints;
    bool several;
    int n_drives;
    mt_swept_drive_row *drives;
    bool holds_moment;
    bool holds_force;
    double hold_n_m; /* of a moment */
    double hold_n;   /* of a force */
    double residual;
    double gap_m;
    mt_dead_centre_row *dead_centre;
    bool with_modes;
    int n_hz;
    double *hz;
    int rigid;
    int unstable;
    int undecided;
} mt_sweep_point_row;

extern const mt_record mt_sweep_point_record;
/* Without its lists. */
mt_sweep_point_row mt_sweep_point_row_of(const mt_sweep_view *v, int point);

/* A driven joint and what holds it. */
typedef struct mt_swept_hold_row {
    const char *joint;
    const char *hold;
    const char *spring;
} mt_swept_hold_row;

/* A configuration, swept. */
typedef struct mt_swept_row {
    const char *configuration;
    const char *joint;
    const char *hold;
    const char *spring;
    bool several;
    int n_drives;
    mt_swept_hold_row *drives;
    int n;
    mt_sweep_point_row *points;
} mt_swept_row;

extern const mt_record mt_swept_record;
/* Write all of it as JSON. Fails: MT_E_MEMORY. */
mt_status mt_sweep_put(mt_sweep_view *v, mt_json_writer *w, mt_err *err);

/* A driven joint of the question. */
const mt_system_joint *mt_sweep_driven(const mt_sweep_view *v, int drive);
/* True where what holds it acts along an angle. */
bool mt_sweep_holds_moment(const mt_sweep_view *v, int drive);

#endif
