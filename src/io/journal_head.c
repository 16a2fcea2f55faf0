/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/journal_head.h"

#include <string.h>

/* Members of the identity that say how the processor computes. */
static bool is_of_processor(const char *line, size_t n)
{
    static const char *const names[] = {"\"blas\":", "\"arithmetic\":"};
    const size_t blanks = strspn(line, " ");
    for (int i = 0; i < MT_COUNT(names); i++) {
        const size_t m = strlen(names[i]);
        if (n > blanks + m && memcmp(line + blanks, names[i], m) == 0) {
            return true;
        }
    }
    return false;
}

mt_status mt_journal_refuse(const char *identity, const char *path, const char *theirs,
                            bool *foreign, mt_err *err)
{
    const char *ours = identity;
    const char *first[2] = {NULL, NULL};
    *foreign = true;
    while (theirs[0] == '|' && theirs[1] == ' ' && *foreign) {
        const size_t n = strcspn(theirs + 2, "\n");
        const size_t m = strcspn(ours, "\n");
        if (n != m || memcmp(theirs + 2, ours, n) != 0) {
            *foreign = is_of_processor(theirs + 2, n) && is_of_processor(ours, m);
            if (first[0] == NULL || !*foreign) {
                first[0] = theirs + 2;
                first[1] = ours;
            }
        }
        theirs += 2 + n + (theirs[2 + n] == '\n' ? 1 : 0);
        ours += m + (ours[m] == '\n' ? 1 : 0);
    }
    *foreign = *foreign && first[0] != NULL && *ours == '\0';
    if (first[0] == NULL) {
        return mt_fail(err, MT_E_INPUT, "%s: the head of the journal is damaged", path);
    }
    const size_t n = strcspn(first[0], "\n");
    const size_t m = strcspn(first[1], "\n");
    return mt_fail(err, MT_E_INPUT, "%s: %s: it has `%.*s` where this run has `%.*s`", path,
                   *foreign ? "the journal of a processor that computes otherwise"
                            : "the journal of another question or program",
                   (int)(n < 200 ? n : 200), first[0], (int)(m < 200 ? m : 200), first[1]);
}

mt_text mt_journal_head(const char *identity, const char *sha256)
{
    mt_text head = {.s = NULL};
    mt_text_add(&head, MT_JOURNAL_FORMAT);
    mt_text_add(&head, sha256);
    mt_text_add(&head, "\n");
    for (const char *s = identity; *s != '\0';) {
        const size_t n = strcspn(s, "\n");
        mt_text_add(&head, "| ");
        mt_text_add_n(&head, s, n);
        mt_text_add(&head, "\n");
        s += n + (s[n] == '\n' ? 1 : 0);
    }
    return head;
}
