/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_SVG_H
#define REPORT_SVG_H

/* Distance of the marks of an axis of this length: 1, 2 or 5 times a power of ten, about six
 * marks. */
double mt_svg_step(double length);

#endif
