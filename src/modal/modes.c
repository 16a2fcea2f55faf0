/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modal/modes.h"

#include <math.h>
#include <stddef.h>

static const double TWO_PI = 6.283185307179586476925;

const double *mt_modal_shape(const mt_modes *modes, int i)
{
    return i < modes->shaped ? modes->y + ((ptrdiff_t)i * modes->n) : NULL;
}

double mt_modal_hz(const mt_modes *modes, int i)
{
    if (modes->kind[i] == MT_MODE_UNSTABLE || modes->kind[i] == MT_MODE_UNDECIDED) {
        return nan("");
    }
    return modes->kind[i] == MT_MODE_RIGID_BODY ? 0.0 : sqrt(modes->lambda[i]) / TWO_PI;
}

double mt_modal_error_hz(const mt_modes *modes, int i)
{
    const double e = modes->error[i];
    const double lambda = modes->lambda[i];
    if (isnan(mt_modal_hz(modes, i))) {
        return nan("");
    }
    /* sqrt(lambda) - sqrt(lambda - e), without cancellation */
    return e < lambda ? e / (sqrt(lambda) + sqrt(lambda - e)) / TWO_PI : sqrt(e) / TWO_PI;
}

double mt_modal_hz_slope(double dlambda, double hz)
{
    return hz > 0.0 ? dlambda / (2.0 * TWO_PI * TWO_PI * hz) : nan("");
}

bool mt_modal_indexed(const mt_modes *modes)
{
    return modes->n_unstable == 0 && modes->n_undecided == 0;
}

int mt_modal_vibrations(const mt_modes *modes)
{
    return modes->all - modes->n_rigid;
}

int mt_modal_flexible(const mt_modes *modes, int index)
{
    if (!mt_modal_indexed(modes) || index < 1) {
        return -1;
    }
    int seen = 0;
    for (int i = 0; i < modes->count; i++) {
        seen += modes->kind[i] == MT_MODE_FLEXIBLE ? 1 : 0;
        if (seen == index) {
            return i;
        }
    }
    return -1;
}

int mt_modal_index(const mt_modes *modes, int pos)
{
    int index = 0;
    for (int i = 0; i <= pos; i++) {
        index += modes->kind[i] == MT_MODE_FLEXIBLE ? 1 : 0;
    }
    return index;
}

int mt_modal_cluster(const mt_modes *modes, int i, int *size)
{
    int first = i;
    int end = i + 1;
    while (first > 0 && modes->cluster[first - 1] == modes->cluster[i]) {
        first--;
    }
    while (end < modes->count && modes->cluster[end] == modes->cluster[i]) {
        end++;
    }
    *size = end - first;
    return first;
}
