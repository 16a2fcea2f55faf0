/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_PAGE_HEADS_H
#define REPORT_PAGE_HEADS_H

#include "base/sha256.h"
#include "report/page.h"

/* The beginning of a page up to its title, made by the build from files (page/heads.cmake). */
typedef struct mt_page_head {
    const char *text;
    size_t length;
    mt_sha256_start start; /* state of its digest */
} mt_page_head;

extern const mt_page_head mt_page_heads[MT_PAGE_KINDS];

#endif
