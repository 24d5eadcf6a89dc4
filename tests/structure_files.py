"""Matrices written as finite-element programs write them."""

import numpy as np


def market(path, matrix, symmetric=True):
    """Matrix Market, coordinates."""
    i, j = np.nonzero(np.tril(matrix) if symmetric else matrix)
    kind = "symmetric" if symmetric else "general"
    n = len(matrix)
    lines = [f"%%MatrixMarket matrix coordinate real {kind}", "% a comment", f"{n} {n} {i.size}"]
    path.write_text(
        "\n".join([*lines, *(f"{a + 1} {b + 1} {matrix[a, b]:.16e}" for a, b in zip(i, j, strict=True))])
        + "\n"
    )


def market_array(path, matrix, symmetric=False):
    """Matrix Market, all entries column by column, or those of the lower triangle."""
    n = len(matrix)
    kept = [value for k, column in enumerate(matrix.T) for value in column[k * symmetric :]]
    kind = "symmetric" if symmetric else "general"
    lines = [f"%%MatrixMarket matrix array real {kind}", f"{n} {n}", *(f"{value:.16e}" for value in kept)]
    path.write_text("\n".join(lines) + "\n")


def abaqus(path, matrix, labels, part=np.tril):
    """Lines of node, dof, node, dof, entry."""
    lines = ["** MATRIX INPUT", "*MATRIX INPUT, NAME=K, TYPE=SYMMETRIC"]
    for a, b in zip(*np.nonzero(part(matrix)), strict=True):
        (n, d), (m, e) = labels[a], labels[b]
        lines.append(f"{n},{d}, {m},{e},  {matrix[a, b]:.16e}")
    path.write_text("\n".join(lines) + "\n")


def abaqus_coordinates(path, matrix, part=np.triu):
    """Lines of row, column, entry."""
    places = zip(*np.nonzero(part(matrix)), strict=True)
    path.write_text("\n".join(f"{a + 1} {b + 1}  {matrix[a, b]:.16E}" for a, b in places) + "\n")


def harwell_boeing(path, matrix, symmetric=True):
    """Fixed columns, three entries of 23 characters a line, negative ones touch."""
    half = np.tril(matrix) if symmetric else matrix
    columns, rows = np.nonzero(half.T)
    pointers = np.concatenate(([1], 1 + np.cumsum([np.count_nonzero(column) for column in half.T])))

    def cards(values, form, most):
        words = [form.format(value) for value in values]
        return ["".join(words[k : k + most]) for k in range(0, len(words), most)]

    parts = [
        cards(pointers, "{:8d}", 10), cards(rows + 1, "{:8d}", 10),
        cards(half[rows, columns], "{:23.16E}", 3),
    ]  # fmt: skip
    counts = [len(part) for part in parts]
    n, kind = len(matrix), "RSA" if symmetric else "RUA"
    header = [
        f"{'a structure':<72}{'KEY':<8}",
        "".join(f"{count:14d}" for count in (sum(counts), *counts, 0)),
        f"{kind:<14}" + "".join(f"{count:14d}" for count in (n, n, rows.size, 0)),
        f"{'(10I8)':<16}{'(10I8)':<16}{'(3E23.16)':<20}",
    ]
    path.write_text("\n".join([*header, *(line for part in parts for line in part)]) + "\n")


def punch(path, matrices, labels):
    """DMIG cards, symmetric, of numbers with few digits: there is room for nine."""
    lines = []
    for name, matrix in matrices.items():
        lines.append(f"DMIG    {name:<8}{0:>8}{6:>8}{2:>8}{0:>8}")
        for column, (node, dof) in enumerate(labels):
            rows = [row for row in range(column, len(labels)) if matrix[row, column]]
            if rows:
                lines.append(f"DMIG*   {name:<16}{node:>16}{dof:>16}")
            for row in rows:
                n, d = labels[row]
                lines.append(f"*       {n:>16}{d:>16}{matrix[row, column]:>16.9E}")
    path.write_text("\n".join(lines) + "\n")
