/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks that there are the ports of the responses that results show. */
#include "problem/forced_response.h"
#include "problem/problem.h"

/* A profile says how the ground accelerates. */
static mt_status check_forced_response(const mt_study_response *r, const mt_port *in, int index,
                                       mt_err *err)
{
    const bool accelerates = in->kind == MT_PORT_BASE && in->motion == 2;
    return accelerates || r->response_limit.profile_name.s == NULL
               ? MT_OK
               : mt_fail(err, MT_E_INPUT,
                         "/responses/%d/input: \"%s\" is not an acceleration of the ground, as "
                         "a profile is: write \"base.x\", \"base.y\" or \"base.z\"",
                         index, r->response_limit.input.s);
}

static mt_status check_response_ports(const mt_problem *p, int index, mt_arena *mem,
                                      mt_err *err)
{
    const mt_study_response *const r = &p->study->responses[index];
    mt_port in = {.name = NULL};
    mt_port out;
    mt_system *sys = NULL;
    const char *const at = mt_arena_printf(mem, "/responses/%d", index);
    MT_TRY(mt_arena_check(mem, err));
    const mt_system_def def = mt_problem_system(p, r->configuration, p->original);
    mt_status rc = mt_system_new_of(&def, &sys, err);
    rc = rc == MT_OK
             ? mt_forced_response_ports_at(sys, &r->response_limit, at, mem, &in, &out, err)
             : rc;
    rc = rc == MT_OK ? check_forced_response(r, &in, index, err) : rc;
    mt_system_delete(sys);
    return rc;
}

mt_status mt_problem_check_responses(const mt_problem *p, mt_err *err)
{
    mt_arena mem;
    mt_status rc = mt_arena_init(&mem, 0, err);
    const int n = p->study->examined ? 0 : p->study->n_responses;
    for (int i = 0; i < n && rc == MT_OK; i++) {
        rc = check_response_ports(p, i, &mem, err);
    }
    mt_arena_free(&mem);
    return rc;
}
