/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Numbers in groups of four, of which the first three are a vector: (u, ln L) of a distance,
 * (axis, 0) three times of a body, (0, angle) of an angle. Two positions differ by the largest
 * of |vector_a - vector_b| and |number_a - number_b|.
 */
#include "mechanics/directions.h"

#include "mechanics/linear_priv.h"

#include <math.h>

enum { GROUP = 4, AXES = 3 };

/* Of the model's length: shorter distances have this one and no direction. */
static const double LEAST_LENGTH = 1e-12;

static bool is_counted(const mt_measure_def *def)
{
    return def->kind == MT_MEASURE_DISTANCE || def->kind == MT_MEASURE_ANGLE;
}

int mt_directions_count(const mt_system *sys)
{
    int groups = AXES * sys->n_bodies;
    for (int i = 0; i < sys->n_measures; i++) {
        groups += is_counted(&sys->measures[i]) ? 1 : 0;
    }
    return GROUP * groups;
}

/* x + R s of a body's point. */
static void place_point(const mt_pose *pose, const mt_cx *s, double *out)
{
    for (int i = 0; i < AXES; i++) {
        out[i] = creal(pose->x[i]);
        for (int k = 0; k < AXES && s != NULL; k++) {
            out[i] += creal(pose->r[i + (AXES * k)]) * creal(s[k]);
        }
    }
}

static void read_distance(const mt_linear *lin, const mt_measure_def *def, double *out)
{
    const mt_pose *const poses = lin->position.at.pose;
    const mt_measure_data m = mt_data_measure(&lin->data, def);
    double ends[2][AXES];
    double square = 0.0;
    for (int k = 0; k < 2; k++) {
        place_point(mt_pose_of(poses, def->body[k]), m.point[k], ends[k]);
    }
    for (int i = 0; i < AXES; i++) {
        out[i] = ends[1][i] - ends[0][i];
        square += out[i] * out[i];
    }
    const double least = LEAST_LENGTH * lin->sys->length_m;
    const double length = fmax(sqrt(square), least);
    for (int i = 0; i < AXES; i++) {
        out[i] /= length;
    }
    out[AXES] = log(length);
}

void mt_directions_read(const mt_linear *lin, double *out)
{
    const mt_system *const sys = lin->sys;
    const mt_placement *const at = &lin->position.at;
    double *to = out;
    for (int i = 0; i < sys->n_bodies; i++) {
        for (int k = 0; k < AXES; k++, to += GROUP) {
            for (int j = 0; j < AXES; j++) {
                to[j] = creal(at->pose[i].r[j + (AXES * k)]);
            }
            to[AXES] = 0.0;
        }
    }
    for (int i = 0; i < sys->n_measures; i++) {
        if (!is_counted(&sys->measures[i])) {
            continue;
        }
        to[0] = to[1] = to[2] = 0.0;
        to[AXES] = at->turn[i];
        if (sys->measures[i].kind == MT_MEASURE_DISTANCE) {
            read_distance(lin, &sys->measures[i], to);
        }
        to += GROUP;
    }
}

double mt_directions_turn(const mt_system *sys, const double *a, const double *b)
{
    const int n = mt_directions_count(sys);
    double most = 0.0;
    for (int i = 0; i < n; i += GROUP) {
        double square = 0.0;
        for (int k = 0; k < AXES; k++) {
            square += (a[i + k] - b[i + k]) * (a[i + k] - b[i + k]);
        }
        most = fmax(most, fmax(sqrt(square), fabs(a[i + AXES] - b[i + AXES])));
    }
    return most;
}
