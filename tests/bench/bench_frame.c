/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A peer of `modetune modes` of a space frame: what a short program makes of it with CHOLMOD's
 * supernodal factor and Lanczos' method, one vector at a time, without a count of what it may
 * have missed. It makes the frame itself (tests/support/large.py: tower): 10 x 10 nodes a
 * floor, tubes between neighbours, the lowest nodes clamped. An element has six strains, and K
 * = sum c b b^T over them,
 *     u2 - u1: EA/l,   t2 - t1: GJ/l,   of each bending  r2 - r1: EI/l  and
 *     (r1 + r2)/2 - (v2 - v1)/l: 12 EI/l,
 * and the mass of its cubic and linear shapes (Przemieniecki, Theory of Matrix Structural
 * Analysis, 1968, section 11.3).
 *     bench_frame FLOORS COUNT
 * CSV: elements,freedoms,products,hz_1,...
 */
#include <cblas.h>
#include <lapacke.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>

enum { ACROSS = 10, NODE = 6, ELEMENT = 12, ENTRIES = ELEMENT * (ELEMENT + 1) / 2 };
enum { MOST_STEPS = 120, FIRST_LOOK = 20, LOOK_EVERY = 3, MOST_WANTED = 40 };
enum { DECIMAL = 10 };

static const double YOUNG = 2.1e11;
static const double SHEAR = 8e10;
static const double DENSITY = 7850.0;
static const double OUTER = 0.2;
static const double INNER = 0.18;
static const double PI = 3.14159265358979323846;
static const double SPACING[3] = {3.0, 4.0, 3.5};
/* A residual below this part of the last eigenvalue wanted is none. */
static const double CLOSE = 1e-12;

typedef struct frame {
    cholmod_common c;
    cholmod_triplet *k;
    cholmod_triplet *m;
    int elements;
    int freedoms;
} frame;

/* A peer has nothing to say after a failure. */
static void need(bool is, const char *what)
{
    if (!is) {
        (void)fprintf(stderr, "bench_frame: %s\n", what);
        exit(EXIT_FAILURE);
    }
}

/* The lower triangle of an element's matrix into that of the frame; at[2]: the first freedom of
 * each node, negative where it is clamped. */
static void add(const double *e, const int at[2], cholmod_triplet *to)
{
    int *const row = to->i;
    int *const column = to->j;
    double *const value = to->x;
    for (int q = 0; q < ELEMENT; q++) {
        for (int p = q; p < ELEMENT; p++) {
            const double x = e[p + (ELEMENT * q)];
            if (x != 0.0 && at[p / NODE] >= 0 && at[q / NODE] >= 0) {
                row[to->nnz] = at[p / NODE] + (p % NODE);
                column[to->nnz] = at[q / NODE] + (q % NODE);
                value[to->nnz++] = x;
            }
        }
    }
}

/* e += c b b^T, b with `count` entries. */
static void add_strain(double c, int count, const int *index, const double *b, double *e)
{
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            e[index[i] + (ELEMENT * index[j])] += c * b[i] * b[j];
        }
    }
}

/* e += c S, S symmetric of order `count`. */
static void add_square(double c, int count, const int *index, const double *s, double *e)
{
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            e[index[i] + (ELEMENT * index[j])] += c * s[i + (count * j)];
        }
    }
}

/* A tube of length l along an axis. */
static void element(int axis, double l, double *k, double *m)
{
    static const double apart[] = {-1.0, 1.0};
    static const double linear[] = {2.0, 1.0, 1.0, 2.0};
    const double area = PI / 4.0 * ((OUTER * OUTER) - (INNER * INNER));
    const double second = PI / 64.0 * (pow(OUTER, 4.0) - pow(INNER, 4.0));
    const double mass = DENSITY * area * l;
    const int along[] = {axis, NODE + axis};
    const int twist[] = {3 + axis, NODE + 3 + axis};
    memset(k, 0, sizeof(double) * ELEMENT * ELEMENT);
    memset(m, 0, sizeof(double) * ELEMENT * ELEMENT);
    add_strain(YOUNG * area / l, 2, along, apart, k);
    add_strain(SHEAR * 2.0 * second / l, 2, twist, apart, k);
    add_square(mass / 6.0, 2, along, linear, m);
    add_square(mass * 2.0 * second / area / 6.0, 2, twist, linear, m);
    for (int plane = 0; plane < 2; plane++) {
        /* v along e2 turns by +e3, along e3 by -e2 */
        const int v = (axis + 1 + plane) % 3;
        const int r = 3 + ((axis + 2 - plane) % 3);
        const double sign = plane == 0 ? 1.0 : -1.0;
        const int turns[] = {r, NODE + r};
        const int all[] = {v, r, NODE + v, NODE + r};
        const double bent[] = {1.0 / l, sign / 2.0, -1.0 / l, sign / 2.0};
        const double a = 22.0 * l * sign;
        const double b = 13.0 * l * sign;
        const double cubic[] = {156.0, a, 54.0,  -b, a,  4.0 * l * l,  b,  -3.0 * l * l,
                                54.0,  b, 156.0, -a, -b, -3.0 * l * l, -a, 4.0 * l * l};
        add_strain(YOUNG * second / l, 2, turns, apart, k);
        add_strain(12.0 * YOUNG * second / l, 4, all, bent, k);
        add_square(mass / 420.0, 4, all, cubic, m);
    }
}

static void make(frame *f, int floors)
{
    const int step[3] = {1, ACROSS, ACROSS * ACROSS};
    const int most[3] = {ACROSS, ACROSS, floors};
    const int nodes = ACROSS * ACROSS * floors;
    const size_t room = (size_t)nodes * 3 * ENTRIES;
    double k[3][ELEMENT * ELEMENT];
    double m[3][ELEMENT * ELEMENT];
    f->freedoms = NODE * (nodes - step[2]);
    f->k = cholmod_allocate_triplet((size_t)f->freedoms, (size_t)f->freedoms, room, -1,
                                    CHOLMOD_REAL, &f->c);
    f->m = cholmod_allocate_triplet((size_t)f->freedoms, (size_t)f->freedoms, room, -1,
                                    CHOLMOD_REAL, &f->c);
    need(f->k != NULL && f->m != NULL, "out of memory");
    for (int axis = 0; axis < 3; axis++) {
        element(axis, SPACING[axis], k[axis], m[axis]);
    }
    for (int node = 0; node < nodes; node++) {
        const int place[3] = {node % ACROSS, node / ACROSS % ACROSS, node / step[2]};
        for (int axis = 0; axis < 3; axis++) {
            if (place[axis] + 1 < most[axis]) {
                const int at[2] = {NODE * (node - step[2]),
                                   NODE * (node + step[axis] - step[2])};
                add(k[axis], at, f->k);
                add(m[axis], at, f->m);
                f->elements++;
            }
        }
    }
}

static cholmod_sparse *compress(frame *f, cholmod_triplet **from)
{
    cholmod_sparse *const a = cholmod_triplet_to_sparse(*from, (*from)->nnz, &f->c);
    need(a != NULL, "out of memory");
    cholmod_free_triplet(from, &f->c);
    return a;
}

/* What the iteration works with: K^-1 M in the metric M, V M-orthonormal. */
typedef struct iteration {
    int n;
    cholmod_sparse *m;
    cholmod_factor *factor;
    double *v; /* n x (MOST_STEPS + 1) */
    double alpha[MOST_STEPS];
    double beta[MOST_STEPS];
    cholmod_dense *x; /* n */
    cholmod_dense *y; /* n: M x */
    cholmod_dense *solved;
    cholmod_dense *work[2];
} iteration;

static void weigh(iteration *it, const double *from, cholmod_common *c)
{
    double one[2] = {1.0, 0.0};
    double zero[2] = {0.0, 0.0};
    memcpy(it->x->x, from, (size_t)it->n * sizeof *from);
    need(cholmod_sdmult(it->m, 0, one, zero, it->x, it->y, c), "M x");
}

/* w := w - V V^T M w; h: the coefficients. */
static void orthogonalise(iteration *it, int count, double *w, double *h, cholmod_common *c)
{
    weigh(it, w, c);
    cblas_dgemv(CblasColMajor, CblasTrans, it->n, count, 1.0, it->v, it->n, it->y->x, 1, 0.0, h,
                1);
    cblas_dgemv(CblasColMajor, CblasNoTrans, it->n, count, -1.0, it->v, it->n, h, 1, 1.0, w, 1);
}

static double normalise(iteration *it, double *w, cholmod_common *c)
{
    weigh(it, w, c);
    const double size = sqrt(cblas_ddot(it->n, w, 1, it->y->x, 1));
    cblas_dscal(it->n, 1.0 / size, w, 1);
    return size;
}

static void extend(iteration *it, int j, cholmod_common *c)
{
    double h[MOST_STEPS + 1];
    double *const w = it->v + ((ptrdiff_t)(j + 1) * it->n);
    weigh(it, it->v + ((ptrdiff_t)j * it->n), c);
    need(cholmod_solve2(CHOLMOD_A, it->factor, it->y, NULL, &it->solved, NULL, &it->work[0],
                        &it->work[1], c),
         "a solution");
    memcpy(w, it->solved->x, (size_t)it->n * sizeof *w);
    orthogonalise(it, j + 1, w, h, c);
    it->alpha[j] = h[j];
    orthogonalise(it, j + 1, w, h, c);
    it->beta[j] = normalise(it, w, c);
}

/* Whether the largest `wanted` of j eigenvalues are there; their frequencies. */
static bool look(const iteration *it, int j, int wanted, double *hz)
{
    double d[MOST_STEPS];
    double e[MOST_STEPS];
    static double z[MOST_STEPS * MOST_STEPS];
    bool are = true;
    memcpy(d, it->alpha, sizeof d);
    memcpy(e, it->beta, sizeof e);
    need(LAPACKE_dstev(LAPACK_COL_MAJOR, 'V', j, d, e, z, j) == 0, "dstev");
    for (int i = 0; i < wanted; i++) {
        const int at = j - 1 - i;
        const double rest = fabs(it->beta[j - 1] * z[j - 1 + ((ptrdiff_t)at * j)]);
        are = are && rest <= CLOSE * d[j - wanted];
        hz[i] = 1.0 / sqrt(d[at]) / (2.0 * PI);
    }
    return are;
}

static int iterate(iteration *it, int wanted, double *hz, cholmod_common *c)
{
    int j = 0;
    bool are = false;
    for (int i = 0; i < it->n; i++) {
        it->v[i] = fmod(0.6180339887498949 * (i + 1), 1.0) - 0.5;
    }
    (void)normalise(it, it->v, c);
    while (!are && j < MOST_STEPS) {
        extend(it, j++, c);
        are = j >= FIRST_LOOK && j >= wanted && j % LOOK_EVERY == 0 && look(it, j, wanted, hz);
    }
    need(are, "no convergence");
    return j;
}

int main(int argc, char **argv)
{
    frame f = {.elements = 0};
    double hz[MOST_WANTED];
    const long floors = argc == 3 ? strtol(argv[1], NULL, DECIMAL) : 0;
    const long wanted = argc == 3 ? strtol(argv[2], NULL, DECIMAL) : 0;
    need(floors > 1 && floors <= 1000 && wanted > 0 && wanted <= MOST_WANTED,
         "bench_frame FLOORS COUNT");
    need(cholmod_start(&f.c), "CHOLMOD does not start");
    make(&f, (int)floors);
    cholmod_sparse *k = compress(&f, &f.k);
    iteration it = {.n = f.freedoms, .m = compress(&f, &f.m)};
    f.c.supernodal = CHOLMOD_SUPERNODAL;
    f.c.final_ll = 1;
    it.factor = cholmod_analyze(k, &f.c);
    need(it.factor != NULL && cholmod_factorize(k, it.factor, &f.c), "no factor");
    it.v = malloc((size_t)it.n * (MOST_STEPS + 1) * sizeof *it.v);
    it.x = cholmod_allocate_dense((size_t)it.n, 1, (size_t)it.n, CHOLMOD_REAL, &f.c);
    it.y = cholmod_allocate_dense((size_t)it.n, 1, (size_t)it.n, CHOLMOD_REAL, &f.c);
    need(it.v != NULL && it.x != NULL && it.y != NULL, "out of memory");
    const int products = iterate(&it, (int)wanted, hz, &f.c);
    (void)printf("elements,freedoms,products");
    for (int i = 0; i < wanted; i++) {
        (void)printf(",hz_%d", i + 1);
    }
    (void)printf("\n%d,%d,%d", f.elements, f.freedoms, products);
    for (int i = 0; i < wanted; i++) {
        (void)printf(",%.15g", hz[i]);
    }
    (void)printf("\n");
    free(it.v);
    cholmod_free_dense(&it.x, &f.c);
    cholmod_free_dense(&it.y, &f.c);
    cholmod_free_dense(&it.solved, &f.c);
    cholmod_free_dense(&it.work[0], &f.c);
    cholmod_free_dense(&it.work[1], &f.c);
    cholmod_free_factor(&it.factor, &f.c);
    cholmod_free_sparse(&it.m, &f.c);
    cholmod_free_sparse(&k, &f.c);
    (void)cholmod_finish(&f.c);
    return EXIT_SUCCESS;
}
