/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the elimination found, in the user's words: redundant joints, directions named by
 * body. */
#include "mechanics/redundant.h"

#include "mechanics/linear_priv.h"

int mt_linear_redundant(const mt_linear *lin)
{
    return lin->m - lin->e.qr.rank;
}

mt_status mt_linear_redundant_set(mt_linear *lin, int k, mt_arena *mem, mt_joint_names *out,
                                  mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const null = mt_arena_f64(&lin->scratch, (size_t)lin->m, 1);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    MT_TRY(mt_eliminate_left_null(&lin->e, k, null, &lin->scratch, err));
    MT_TRY(mt_name_joints(lin->sys, lin->m, null, mem, out, err));
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_linear_nearness(mt_linear *lin, mt_arena *mem, mt_nearness *out, mt_err *err)
{
    return mt_singular_nearness(&lin->data, &lin->position.at, &lin->e, &lin->scratch, mem, out,
                                err);
}

void mt_linear_name_direction(const mt_linear *lin, const double *y, char *text, size_t size)
{
    mt_name_motion(lin->sys, &lin->e, y, text, size);
}
