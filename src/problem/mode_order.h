/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef PROBLEM_MODE_ORDER_H
#define PROBLEM_MODE_ORDER_H

/* Largest number of modes beyond a limited one that a search includes. */
enum { MT_MODE_ORDER_MOST = 5 };

#endif
