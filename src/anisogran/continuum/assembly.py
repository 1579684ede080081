"""From element matrices to the sparse tangent of the equations."""

import numpy as np
from scipy.sparse import csc_array


class Assembly:
    """test @ (sum of element matrices) @ trial + linear @ trial, its places found once and used for every tangent.

    `dofs[element, local]` are the places of an element's unknowns; the sparse `trial`, `test` and `linear` are those of a System.
    """

    def __init__(self, dofs, trial, test, linear):
        (column, _), *tied = targets(trial.T)
        if tied:
            raise ValueError("an unknown may depend on one value only")
        fixed = (linear @ trial).tocoo()
        places, rows, columns, factors = [], [fixed.row], [fixed.col], []
        for equation, factor in targets(test):
            row, of = np.broadcast_arrays(equation[dofs][:, :, None], column[dofs][:, None, :])
            kept = np.flatnonzero((row >= 0) & (of >= 0))
            places.append(kept)
            rows.append(row.ravel()[kept])
            columns.append(of.ravel()[kept])
            factors.append(np.broadcast_to(factor[dofs][:, :, None], row.shape).ravel()[kept])
        self.places, self.factors, self.fixed = np.concatenate(places), np.concatenate(factors), fixed.data
        number = test.shape[0]
        filled, self.entry = np.unique(np.concatenate(columns) * number + np.concatenate(rows), return_inverse=True)
        self.indices, self.shape = filled % number, (number, trial.shape[1])
        self.starts = np.concatenate([[0], np.cumsum(np.bincount(filled // number, minlength=trial.shape[1]))])

    def matrix(self, values):
        """The csc matrix of element matrices [element, local, local]."""
        entries = np.concatenate([self.fixed, values.ravel()[self.places] * self.factors])
        return csc_array((np.bincount(self.entry, weights=entries), self.indices, self.starts), shape=self.shape)


def targets(matrix):
    """[(row, factor), ...]: for each column of a sparse matrix its first entry, its second one, ...; row -1 where there is none."""
    matrix = csc_array(matrix)
    counts, out = np.diff(matrix.indptr), []
    for k in range(int(counts.max())):
        row, factor = np.full(matrix.shape[1], -1), np.zeros(matrix.shape[1])
        has = counts > k
        row[has], factor[has] = matrix.indices[matrix.indptr[:-1][has] + k], matrix.data[matrix.indptr[:-1][has] + k]
        out.append((row, factor))
    return out
