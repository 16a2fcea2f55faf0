/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Makes the k-th call to the system fail, or the last thing that the process does. Every
 * function that our own code calls to open, read, write, name or remove files is replaced by
 * the linker (--wrap), for the programs test_*_faults and for modetune_faults, which is the
 * program itself. Calls are counted over all of these functions, so that no clock decides when.
 *
 * modetune_faults takes its orders from the environment: MT_FAULT="K:ACTION[:ERRNO]", and
 * MT_FAULT_LOG names a file that the calls are listed in, one per line.
 *     fail   the k-th call fails with ERRNO
 *     ever   so do all later calls of the same function
 *     kill   the process is killed in place of the k-th call
 *     tear   the process is killed after it; of a write only half is done
 */
#ifndef MT_FAULTS_H
#define MT_FAULTS_H

#include <stdbool.h>

typedef enum mt_fault {
    MT_FAULT_NONE,
    MT_FAULT_FAIL,
    MT_FAULT_EVER,
    MT_FAULT_KILL,
    MT_FAULT_TEAR
} mt_fault;

/* Count from 0 again, and let the k-th call meet this fault. MT_FAULT_NONE: only count. */
void mt_faults_at(long k, mt_fault fault, int error);
/* How many calls there have been, and whether the fault was met. */
long mt_faults_count(void);
bool mt_faults_met(void);
/* The function of call k since then; "" beyond the last one, or beyond the first 1000. */
const char *mt_faults_name(long k);

#endif
