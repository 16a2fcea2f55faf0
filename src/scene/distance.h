/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCENE_DISTANCE_H
#define SCENE_DISTANCE_H

/* Distances of points in space. */

double mt_distance_points(const double a[3], const double b[3]);
/* Distance of x from the segment from a to b; nearest (may be NULL): its nearest point. */
double mt_distance_segment(const double a[3], const double b[3], const double x[3],
                           double nearest[3]);
/* Distance of x, in the ellipsoid's axes from its centre, from the solid ellipsoid with these
 * radii, some of which may be 0: a disc, a rod, a point. 0 inside. */
double mt_distance_ellipsoid(const double radii[3], const double x[3]);

#endif
