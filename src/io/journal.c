/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/journal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h> /* renameat */
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/format.h"
#include "base/text.h"
#include "io/file.h"
#include "io/folder.h"

/* The head of a journal (io/journal.h): format, digest of the identity, and the identity behind
 * bars. */
#define JOURNAL_FORMAT "modetune-journal/1 "

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

/* MT_E_INPUT, naming the first line of the identity, other than those of the processor, in
 * which another head differs; where only the processor differs (*foreign), its first line.
 * theirs: the lines behind bars. */
static mt_status journal_refuse(const char *identity, const char *path, const char *theirs,
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

static mt_text journal_head(const char *identity, const char *sha256)
{
    mt_text head = {.s = NULL};
    mt_text_add(&head, JOURNAL_FORMAT);
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

/* Digits of a SHA-256 that a line has: nobody works against the engineer here, a disk does. */
enum { CHECK = 16, NIBBLE = 4, WORD_DIGITS = 16 };
/* A journal is read as a whole, within the memory that the program may use. */
static const size_t MOST_BYTES = (size_t)1 << 36;

typedef struct record {
    const char *key;       /* in the file's bytes */
    const uint64_t *words; /* the first of n; NULL: another record has the same key */
    size_t n;
} record;

typedef struct source {
    mt_file file;
    uint64_t *words; /* of all its records; owned */
    size_t n_words;
} source;

struct mt_journal {
    char *identity;
    char sha256[MT_SHA256_TEXT]; /* of it */
    mt_checkpoint_store store;
    int n_sources;
    source *sources;
    int n;
    int room;
    record *records; /* [n], by key once they are asked for */
    mt_journal_counts counts;
    char *path; /* of new records; NULL: they go nowhere */
    int fd;     /* has the lock of the file at `path`, which is ours; -1: not made yet */
    bool sorted;
    bool torn;    /* a file that was read ends within its head: it is written anew */
    bool begun;   /* the file has its head, and ends with a line */
    mt_text line; /* under way */
    mt_err err;   /* the first failure of writing: nothing is written after it */
};

static void check_of(const mt_journal *j, const char *rest, size_t length, mt_text *scratch,
                     char out[MT_SHA256_TEXT])
{
    scratch->length = 0;
    mt_text_add_n(scratch, j->sha256, MT_SHA256_TEXT - 1);
    mt_text_add_n(scratch, rest, length);
    mt_sha256(scratch->s, scratch->failed ? 0 : scratch->length, out);
}

static int digit(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* " WORD WORD ..." up to the end; false where it is anything else. */
static bool read_words(const char *s, const char *end, source *from, record *out)
{
    out->words = from->words + from->n_words;
    while (s < end) {
        uint64_t word = 0;
        const char *const first = ++s;
        if (first[-1] != ' ') {
            return false;
        }
        for (; s < end && digit(*s) >= 0; s++) {
            word = (word << NIBBLE) | (uint64_t)digit(*s);
        }
        if (s == first || s - first > WORD_DIGITS) {
            return false;
        }
        from->words[from->n_words++] = word;
        out->n++;
    }
    return true;
}

/* One line as a record: its key ends with a NUL then. */
static bool read_line(const mt_journal *j, char *line, char *end, source *from,
                      mt_text *scratch, record *out)
{
    char check[MT_SHA256_TEXT];
    const size_t before = from->n_words;
    if (end - line <= CHECK + 1 || line[CHECK] != ' ') {
        return false;
    }
    char *const key = line + CHECK + 1;
    check_of(j, key, (size_t)(end - key), scratch, check);
    char *const rest = memchr(key, ' ', (size_t)(end - key));
    char *const words = rest == NULL ? end : rest;
    if (scratch->failed || memcmp(check, line, CHECK) != 0 || words == key ||
        words - key >= MT_KEY_SIZE) {
        return false;
    }
    *out = (record){.key = key};
    if (!read_words(words, end, from, out)) {
        from->n_words = before;
        return false;
    }
    *words = '\0';
    return true;
}

static mt_status add_record(mt_journal *j, const record *r, mt_err *err)
{
    if (j->n == j->room) {
        const int room = j->room > 0 ? 2 * j->room : 64;
        record *const records = realloc(j->records, (size_t)room * sizeof *records);
        if (records == NULL) {
            return mt_fail_memory(err);
        }
        j->records = records;
        j->room = room;
    }
    j->records[j->n++] = *r;
    return MT_OK;
}

/* Past the head, which may have been torn (*torn: there is no more). Fails: MT_E_INPUT (as
 * mt_journal_read), MT_E_MEMORY. */
static mt_status skip_head(const mt_journal *j, const char *path, const mt_file *file,
                           char **records, bool *torn, bool *foreign, mt_err *err)
{
    mt_text head = journal_head(j->identity, j->sha256);
    if (head.failed || head.s == NULL || file->bytes == NULL) {
        mt_text_free(&head);
        return mt_fail_memory(err);
    }
    const size_t n = file->length < head.length ? file->length : head.length;
    const bool same = memcmp(file->bytes, head.s, n) == 0;
    *torn = n < head.length;
    *records = file->bytes + n;
    mt_text_free(&head);
    if (same) {
        return MT_OK;
    }
    if (strncmp(file->bytes, JOURNAL_FORMAT, strlen(JOURNAL_FORMAT)) != 0) {
        return mt_fail(err, MT_E_INPUT, "%s: not a journal of modetune", path);
    }
    const char *const line = strchr(file->bytes, '\n');
    return journal_refuse(j->identity, path, line == NULL ? "" : line + 1, foreign, err);
}

static mt_status read_records(mt_journal *j, source *from, char *at, mt_err *err)
{
    mt_text scratch = {.s = NULL};
    mt_status rc = MT_OK;
    char *const end = from->file.bytes + from->file.length;
    /* a word takes two bytes at least */
    from->words = malloc(((size_t)(end - at) / 2 + 1) * sizeof *from->words);
    if (from->words == NULL) {
        return mt_fail_memory(err);
    }
    while (at < end && rc == MT_OK) {
        char *const found = memchr(at, '\n', (size_t)(end - at));
        char *const stop = found == NULL ? end : found;
        record r;
        if (found != NULL && read_line(j, at, stop, from, &scratch, &r)) {
            rc = add_record(j, &r, err);
            j->counts.known += rc == MT_OK ? 1 : 0;
        } else if (stop > at) {
            j->counts.ignored++;
        }
        at = stop + 1;
    }
    rc = rc == MT_OK && scratch.failed ? mt_fail_memory(err) : rc;
    mt_text_free(&scratch);
    return rc;
}

mt_status mt_journal_new(const char *identity, mt_journal **out, mt_err *err)
{
    mt_journal *const j = calloc(1, sizeof *j);
    *out = NULL;
    if (j == NULL) {
        return mt_fail_memory(err);
    }
    mt_text copy = {.s = NULL};
    mt_text_add(&copy, identity);
    mt_status rc = copy.failed || copy.s == NULL ? mt_fail_memory(err)
                                                 : mt_checkpoint_store_init(&j->store, err);
    if (rc != MT_OK) {
        mt_text_free(&copy);
        free(j);
        return rc;
    }
    j->identity = copy.s;
    j->fd = -1;
    mt_sha256(identity, copy.length, j->sha256);
    *out = j;
    return MT_OK;
}

void mt_journal_delete(mt_journal *j)
{
    if (j == NULL) {
        return;
    }
    for (int i = 0; i < j->n_sources; i++) {
        mt_file_free(&j->sources[i].file);
        free(j->sources[i].words);
    }
    if (j->fd >= 0) {
        (void)close(j->fd);
    }
    mt_checkpoint_store_free(&j->store);
    mt_text_free(&j->line);
    free(j->sources);
    free(j->records);
    free(j->path);
    free(j->identity);
    free(j);
}

mt_status mt_journal_read(mt_journal *j, const char *path, bool *foreign, mt_err *err)
{
    bool other = false;
    bool *const is_foreign = foreign == NULL ? &other : foreign;
    *is_foreign = false;
    source *const sources =
        realloc(j->sources, ((size_t)j->n_sources + 1) * sizeof *j->sources);
    if (sources == NULL) {
        return mt_fail_memory(err);
    }
    j->sources = sources;
    source *const s = &sources[j->n_sources];
    *s = (source){.words = NULL};
    MT_TRY(mt_file_read(path, NULL, MOST_BYTES, &s->file, err));
    j->n_sources++;
    j->sorted = false;
    char *records = s->file.bytes;
    bool torn = false;
    MT_TRY(skip_head(j, path, &s->file, &records, &torn, is_foreign, err));
    j->torn = j->torn || torn;
    return torn ? MT_OK : read_records(j, s, records, err);
}

/* True where the file is held by another run. Where the file system knows no locks it is
 * not. */
static bool is_held(int fd)
{
    while (flock(fd, LOCK_EX | LOCK_NB) != 0) {
        if (errno != EINTR) {
            return errno == EWOULDBLOCK;
        }
    }
    return false;
}

/* errno as a failure of the journal's path. */
static void fail(mt_journal *j)
{
    const int code = errno;
    if (code == ELOOP || code == ENXIO || code == EMLINK) {
        (void)mt_fail(&j->err, MT_E_SYSTEM, "%s: is not a regular file with one name: %s",
                      j->path, "nothing is written there");
    } else {
        (void)mt_file_failed(j->path, code, &j->err);
    }
}

/* The folder's lock, under which journals are made and put aside; -1: j->err, or there is no
 * folder. */
static int lock_folder(mt_journal *j, bool makes)
{
    char *const folder = mt_file_folder(j->path);
    int lock = -1;
    if (folder == NULL) {
        (void)mt_fail_memory(&j->err);
    } else if ((makes && mt_folder_make(folder, &j->err) == MT_OK) || !mt_file_absent(folder)) {
        (void)mt_folder_lock(folder, false, MT_FOLDER_PATIENCE_MS, &lock, &j->err);
    }
    free(folder);
    return lock;
}

/* Open the file at the path, under the folder's lock, to continue it. */
static mt_journal_place continue_journal(mt_journal *j)
{
    const int fd = mt_file_create(MT_FILE_HERE, j->path, true);
    if (fd < 0 && errno == ENOENT) {
        return MT_JOURNAL_NEW;
    }
    if (fd < 0) {
        fail(j);
        return MT_JOURNAL_FAILED;
    }
    if (is_held(fd)) {
        (void)close(fd);
        return MT_JOURNAL_HELD;
    }
    j->fd = fd;
    return MT_JOURNAL_CONTINUED;
}

static bool remove_file(const mt_journal *j)
{
    return unlinkat(AT_FDCWD, j->path, 0) == 0 || errno == ENOENT || errno == ENOTDIR;
}

/* For looking at it; -1 with errno also where it is no regular file. */
static int open_regular(const char *path)
{
    struct stat st;
    const int fd = mt_file_open(MT_FILE_HERE, path);
    const int code = fd < 0 || fstat(fd, &st) != 0 ? errno : S_ISREG(st.st_mode) ? 0 : ENXIO;
    if (code == 0) {
        return fd;
    }
    if (fd >= 0) {
        (void)close(fd);
    }
    errno = code;
    return -1;
}

/* Two names of one file do not replace each other: then one of them goes. */
static bool rename_to(const mt_journal *j, const char *old)
{
    return renameat(AT_FDCWD, j->path, AT_FDCWD, old) == 0 && remove_file(j);
}

/* Put the file at the path aside, under the folder's lock. */
static mt_journal_place put_aside(mt_journal *j)
{
    mt_text old = {.s = NULL};
    mt_journal_place place = MT_JOURNAL_FAILED;
    const int fd = open_regular(j->path);
    if (fd < 0 && errno == ENOENT) {
        return MT_JOURNAL_NEW;
    }
    if (fd < 0) {
        fail(j);
        return MT_JOURNAL_FAILED;
    }
    mt_text_add(&old, j->path);
    mt_text_add(&old, MT_JOURNAL_OLD);
    if (is_held(fd)) {
        place = MT_JOURNAL_HELD;
    } else if (old.failed) {
        (void)mt_fail_memory(&j->err);
    } else if (rename_to(j, old.s)) {
        place = MT_JOURNAL_KEPT;
    } else {
        fail(j);
    }
    (void)close(fd);
    mt_text_free(&old);
    return place;
}

mt_status mt_journal_write_to(mt_journal *j, const char *path, bool adds,
                              mt_journal_place *place, mt_err *err)
{
    mt_text copy = {.s = NULL};
    mt_text_add(&copy, path);
    *place = MT_JOURNAL_NEW;
    if (copy.failed || copy.s == NULL) {
        mt_text_free(&copy);
        return mt_fail_memory(err);
    }
    free(j->path);
    j->path = copy.s;
    const int lock = lock_folder(j, false);
    if (lock >= 0) {
        *place = adds ? continue_journal(j) : put_aside(j);
    } else if (j->err.code != MT_OK) {
        *place = MT_JOURNAL_FAILED;
    }
    mt_folder_unlock(lock);
    if (*place == MT_JOURNAL_HELD) { /* the other run's: nothing is written or removed */
        free(j->path);
        j->path = NULL;
    }
    return j->err.code == MT_E_MEMORY ? mt_fail_memory(err) : MT_OK;
}

static int by_key(const void *a, const void *b)
{
    return strcmp(((const record *)a)->key, ((const record *)b)->key);
}

/* Sort records by key, each once; a key with two different records has none. */
static void sort_records(mt_journal *j)
{
    int kept = 0;
    if (j->n > 0) {
        qsort(j->records, (size_t)j->n, sizeof *j->records, by_key);
    }
    for (int i = 0; i < j->n; i++) {
        const record *const r = &j->records[i];
        record *const last = kept > 0 ? &j->records[kept - 1] : NULL;
        if (last == NULL || strcmp(last->key, r->key) != 0) {
            j->records[kept++] = *r;
            continue;
        }
        const bool same = last->words != NULL && last->n == r->n &&
                          memcmp(last->words, r->words, r->n * sizeof *r->words) == 0;
        j->counts.ignored += same ? 0 : 1;
        last->words = same ? last->words : NULL;
    }
    j->n = kept;
    j->counts.known = 0;
    for (int i = 0; i < j->n; i++) {
        j->counts.known += j->records[i].words != NULL ? 1 : 0;
    }
    j->sorted = true;
}

static const uint64_t *find_record_words(void *context, const char *key, size_t *n)
{
    mt_journal *const j = context;
    const record wanted = {.key = key};
    const record *const r =
        j->n == 0 ? NULL : bsearch(&wanted, j->records, (size_t)j->n, sizeof wanted, by_key);
    if (r == NULL || r->words == NULL) {
        return NULL;
    }
    j->counts.used++;
    *n = r->n;
    return r->words;
}

static void write_all(mt_journal *j, const char *s, size_t n)
{
    if (j->err.code == MT_OK && !mt_file_write(j->fd, s, n)) {
        (void)mt_file_failed(j->path, errno, &j->err);
    }
}

static void write_head(mt_journal *j)
{
    mt_text head = journal_head(j->identity, j->sha256);
    if (head.failed) {
        (void)mt_fail_memory(&j->err);
    } else {
        write_all(j, head.s, head.length);
    }
    mt_text_free(&head);
}

/* A new file, and its lock before anybody else can have it. */
static void make_file(mt_journal *j)
{
    const int lock = lock_folder(j, true);
    if (lock < 0) {
        return;
    }
    j->fd = mt_file_create(MT_FILE_HERE, j->path, false);
    if (j->fd < 0 && errno == EEXIST) { /* another run has begun meanwhile: that is its own */
        free(j->path);
        j->path = NULL;
    } else if (j->fd < 0) {
        fail(j);
    } else {
        (void)is_held(j->fd);
    }
    mt_folder_unlock(lock);
}

static void open_file(mt_journal *j)
{
    const bool adds = j->fd >= 0 && !j->torn;
    if (j->fd >= 0 && j->torn) {
        const bool gone = remove_file(j);
        if (!gone) {
            fail(j);
        }
        (void)close(j->fd);
        j->fd = -1;
        if (!gone) {
            return;
        }
    }
    if (j->fd < 0) {
        make_file(j);
    }
    if (j->fd >= 0 && adds) {
        write_all(j, "\n", 1); /* behind a line that was torn */
    } else if (j->fd >= 0) {
        write_head(j);
    }
    j->begun = j->fd >= 0;
}

static void write_record(void *context, const char *key, const uint64_t *words, size_t n)
{
    static const char digits[] = "0123456789abcdef";
    mt_journal *const j = context;
    mt_text *const line = &j->line;
    mt_text scratch = {.s = NULL};
    j->counts.made++;
    if (j->path == NULL || j->err.code != MT_OK) {
        return;
    }
    mt_journal_begin(j);
    if (j->path == NULL || j->fd < 0) {
        return;
    }
    line->length = 0;
    mt_text_add_n(line, "0123456789abcdef ", CHECK + 1); /* the check's place */
    mt_text_add(line, key);
    for (size_t i = 0; i < n; i++) {
        char word[WORD_DIGITS + 1];
        int at = WORD_DIGITS + 1;
        uint64_t rest = words[i];
        do {
            word[--at] = digits[rest & 15U];
            rest >>= NIBBLE;
        } while (rest != 0);
        word[--at] = ' ';
        mt_text_add_n(line, word + at, (size_t)(WORD_DIGITS + 1 - at));
    }
    mt_text_add(line, "\n");
    if (line->s != NULL && !line->failed) {
        char check[MT_SHA256_TEXT];
        check_of(j, line->s + CHECK + 1, line->length - CHECK - 2, &scratch, check);
        memcpy(line->s, check, CHECK);
    }
    if (line->failed || scratch.failed) {
        (void)mt_fail_memory(&j->err);
    }
    write_all(j, line->s, line->length);
    j->counts.written += j->err.code == MT_OK ? 1 : 0;
    mt_text_free(&scratch);
}

mt_checkpoint_store *mt_journal_checkpoint_store(mt_journal *j, int part, int parts)
{
    if (!j->sorted) {
        sort_records(j);
    }
    j->store.find = find_record_words;
    j->store.put = write_record;
    j->store.context = j;
    j->store.part = part;
    j->store.parts = parts;
    return &j->store;
}

mt_journal_counts mt_journal_count(const mt_journal *j)
{
    return j->counts;
}

void mt_journal_begin(mt_journal *j)
{
    if (j->path != NULL && !j->begun && j->err.code == MT_OK) {
        open_file(j);
    }
}

mt_status mt_journal_end(mt_journal *j, bool remove, mt_err *err)
{
    if (j->fd >= 0 && remove && !remove_file(j) && j->err.code == MT_OK) {
        fail(j);
    }
    if (j->fd >= 0 && close(j->fd) != 0 && j->err.code == MT_OK) {
        fail(j);
    }
    j->fd = -1;
    if (j->err.code != MT_OK && err != NULL) {
        *err = j->err;
    }
    return j->err.code;
}
