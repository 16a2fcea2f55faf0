/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/linear_priv.h"

/* Only geometry that an input moves is worth sharing; loaded or driven systems depend on more
 * than their shape. */
static mt_status can_share(const mt_system *a, const mt_system *b, bool *can, mt_err *err)
{
    *can = false;
    const bool plain = !a->loaded && !a->driven && !b->loaded && !b->driven;
    return plain && !a->geometry_fixed ? mt_system_same_shape(a, b, can, err) : MT_OK;
}

mt_status mt_linear_share(mt_linear *lin, mt_linear *with, bool *shared, mt_err *err)
{
    *shared = false;
    if (lin->pool->n > 1 || lin->first_input != with->first_input) {
        return MT_OK;
    }
    MT_TRY(can_share(lin->sys, with->sys, shared, err));
    const mt_status rc = *shared ? mt_geometry_join(lin, with, err) : MT_OK;
    *shared = *shared && rc == MT_OK;
    return rc;
}
