/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCENE_DISTANCE_H
#define SCENE_DISTANCE_H

/* Distances of points in space. */

double mt_distance_points(const double a[3], const double b[3]);
/* To the segment from a to b; nearest (may be NULL): the point of it. */
double mt_distance_segment(const double a[3], const double b[3], const double x[3],
                           double nearest[3]);
/* Of x, in its axes from its centre, to the solid ellipsoid with these radii, of which some may
 * be 0: a disc, a rod, a point. 0 inside. */
double mt_distance_ellipsoid(const double radii[3], const double x[3]);

#endif
