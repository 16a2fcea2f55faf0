# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear algebra and functions in decimal arithmetic of eighty digits (or in floats: every function takes either)."""
import decimal
import math
from decimal import Decimal

decimal.setcontext(decimal.Context(prec=80, Emin=-99999, Emax=99999, traps=[decimal.InvalidOperation, decimal.DivisionByZero]))

PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899862803482534211706798")
ZERO = Decimal("1e-35")     # relative: below it what was computed with eighty digits is zero
NOTHING = Decimal("1e-50")  # the same of eigenvalues, which may lie thirty decades apart
SERIES = Decimal("1e-82")


def number(value):
    """A number of a file, to its last written digit."""
    return Decimal(repr(value)) if isinstance(value, float) else Decimal(value)


def binary(value):
    """A number of a file as the double that the program reads."""
    return Decimal(float(value))


def root(x):
    return x.sqrt() if isinstance(x, Decimal) else math.sqrt(x)


def _series(first, ratio):
    """Sum of terms: term k + 1 is term k times ratio(k)."""
    total, term, k = first, first, 0
    while abs(term) > SERIES:
        term *= ratio(k)
        total += term
        k += 1
    return total


def sine_cosine(x):
    if not isinstance(x, Decimal):
        return math.sin(x), math.cos(x)
    turns = (x / (2 * PI)).to_integral_value()
    x = (x - 2 * PI * turns) / 64
    square = x * x
    s = _series(x, lambda k: -square / ((2 * k + 2) * (2 * k + 3)))
    c = _series(Decimal(1), lambda k: -square / ((2 * k + 1) * (2 * k + 2)))
    for _ in range(6):
        s, c = 2 * s * c, c * c - s * s
    return s, c


def angle(y, x):
    """atan2."""
    if not isinstance(y, Decimal):
        return math.atan2(y, x)
    near = Decimal(math.atan2(float(y), float(x)))
    s, c = sine_cosine(near)
    u, v = y * c - x * s, x * c + y * s  # what is left, about 1e-16
    t = u / v
    return near + t - t**3 / 3 + t**5 / 5


def angle_over_sine(c):
    """f(c) = acos(c)/sqrt(1 - c^2) with f' and f''. At c = 1 by its series in x = 1 - c: f = sum a_n x^n, a_n = a_(n-1) n/(2n + 1), since (1 - c^2) f' = c f - 1."""
    one, x = type(c)(1), 1 - c
    if x < type(c)("0.02"):
        f, first, second, a, power = one, -one / 3, one * 0, one, one
        for n in range(1, 60):
            a = a * n / (2 * n + 1)
            f += a * power * x
            if n >= 2:
                first -= n * a * power
                second += n * (n - 1) * a * before
            before, power = power, power * x
        return f, first, second
    sine = root(1 - c * c)
    f = angle(sine, c) / sine
    first = (c * f - 1) / (1 - c * c)
    return f, first, (f + 3 * c * first) / (1 - c * c)


def eliminate(rows, width, zero, terms=None):
    """Reduced row echelon form, each row by its largest entry: (rows of rank, their pivot columns, the free columns, those rows' places in the input).

    A pivot at most `zero` of the row's first size, or of `terms`, is none."""
    rows = [list(r) for r in rows]
    size = [max((abs(x) for x in r[:width]), default=0) if terms is None else terms for r in rows]
    columns, chosen = [], []
    for i, row in enumerate(rows):
        j = max(range(width), key=lambda c: abs(row[c]), default=None)
        if j is None or not abs(row[j]) > zero * size[i]:
            continue
        pivot = row[j]
        rows[i] = row = [x / pivot if x else x for x in row]
        support = [(c, x) for c, x in enumerate(row) if x]
        for k, other in enumerate(rows):
            factor = other[j]
            if k != i and factor:
                for c, x in support:
                    other[c] -= factor * x
                other[j] = factor * 0
        columns.append(j)
        chosen.append(i)
    taken = set(columns)
    return [rows[i] for i in chosen], columns, [c for c in range(width) if c not in taken], chosen


def null_space(rows, width, one, zero):
    """Columns Z as a list of vectors: rows . z = 0."""
    reduced, pivots, free, chosen = eliminate(rows, width, zero)
    basis = []
    for f in free:
        z = [one * 0] * width
        z[f] = one
        for row, p in zip(reduced, pivots):
            z[p] = -row[f]
        basis.append(z)
    return basis, chosen


def solve(matrix, right):
    """Square, Gauss with partial pivoting; right: list of right-hand sides."""
    n = len(matrix)
    m = [list(r) + [b[i] for b in right] for i, r in enumerate(matrix)]
    for k in range(n):
        p = max(range(k, n), key=lambda i: abs(m[i][k]))
        if not m[p][k]:
            raise ZeroDivisionError("singular")
        m[k], m[p] = m[p], m[k]
        for i in range(k + 1, n):
            f = m[i][k] / m[k][k]
            if f:
                m[i] = [a - f * b for a, b in zip(m[i], m[k])]
    out = []
    for c in range(len(right)):
        x = [0] * n
        for i in reversed(range(n)):
            x[i] = (m[i][n + c] - sum((m[i][j] * x[j] for j in range(i + 1, n)), 0)) / m[i][i]
        out.append(x)
    return out


def cholesky(m):
    """Lower L, L L' = m; None where m is not positive definite."""
    n = len(m)
    top = max((m[i][i] for i in range(n)), default=0)
    low = [[0] * n for _ in range(n)]
    for i in range(n):
        for j in range(i + 1):
            v = m[i][j] - sum((low[i][k] * low[j][k] for k in range(j)), 0)
            if i == j:
                if not v > NOTHING * top:
                    return None
                low[i][i] = root(v)
            else:
                low[i][j] = v / low[j][j]
    return low


def forward(low, b):
    y = []
    for i in range(len(b)):
        y.append((b[i] - sum((low[i][k] * y[k] for k in range(i)), 0)) / low[i][i])
    return y


def backward(low, b):
    """L' x = b."""
    n = len(b)
    x = [0] * n
    for i in reversed(range(n)):
        x[i] = (b[i] - sum((low[k][i] * x[k] for k in range(i + 1, n)), 0)) / low[i][i]
    return x


def jacobi(matrix):
    """Eigenvalues (ascending) and vectors (list of them) of a symmetric matrix by Jacobi's rotations."""
    n = len(matrix)
    a = [list(r) for r in matrix]
    v = [[Decimal(int(i == j)) for j in range(n)] for i in range(n)]
    size = max((abs(x) for r in a for x in r), default=Decimal(0))
    for _ in range(60):
        off = max((abs(a[i][j]) for i in range(n) for j in range(i)), default=Decimal(0))
        if off <= size * Decimal("1e-77"):
            break
        for p in range(n):
            for q in range(p + 1, n):
                if abs(a[p][q]) <= size * Decimal("1e-78"):
                    continue
                theta = (a[q][q] - a[p][p]) / (2 * a[p][q])
                t = (1 if theta >= 0 else -1) / (abs(theta) + (theta * theta + 1).sqrt())
                c = 1 / (t * t + 1).sqrt()
                s = t * c
                for k in range(n):
                    x, y = a[k][p], a[k][q]
                    a[k][p], a[k][q] = c * x - s * y, s * x + c * y
                rp, rq = a[p], a[q]
                a[p], a[q] = [c * x - s * y for x, y in zip(rp, rq)], [s * x + c * y for x, y in zip(rp, rq)]
                rp, rq = v[p], v[q]
                v[p], v[q] = [c * x - s * y for x, y in zip(rp, rq)], [s * x + c * y for x, y in zip(rp, rq)]
    order = sorted(range(n), key=lambda i: a[i][i])
    return [a[i][i] for i in order], [v[i] for i in order]
