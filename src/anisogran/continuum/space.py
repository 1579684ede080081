"""The space in which a ring flow is sought: mesh, finite elements, and the operators B from unknowns to what a law sees.

Polar components (r, phi) with the area measure r dr dphi, so the ring is exact and no mesh line approximates a circle. For an
axisymmetric flow the mesh is a line; the residual is B^T q(z) in any dimension, with z = B x the `Point` seen by the law.
"""

from math import ceil, expm1, log

import numpy as np
from skfem import Basis, ElementLineP1, ElementLineP2, MeshLine

ELEMENTS = {"u_r": ElementLineP2, "u_phi": ElementLineP2, "p": ElementLineP1, "g": ElementLineP2}
QUADRATURE_ORDER = 9  # five points an element: 1/r and 1/g are not polynomials


def graded(inner, outer, elements, layer):
    """Radii of the elements + 1 mesh points from `inner` to `outer`, half of them within the thickness `layer` of the inner ring.

    Element lengths grow geometrically outward; they are equal if `layer` is half the gap or more.
    """
    gap, growth = outer - inner, growth_exponent((outer - inner) / layer)
    place = np.linspace(0.0, 1.0, elements + 1)
    if growth > 0.0:
        place = np.expm1(growth * place) / np.expm1(growth)
    radii = inner + gap * place
    radii[-1] = outer
    return radii


def growth_exponent(layers):
    """Logarithm of outermost over innermost element length of a graded mesh, for a gap of so many layers; 0 if equal."""
    return 2.0 * log(layers - 1.0) if layers > 2.0 else 0.0


def elements_for(tail, layers):
    """The number of elements of a graded mesh whose outermost one is `tail` long, in units of the gap."""
    growth = growth_exponent(layers)
    return ceil((growth / -expm1(-growth) if growth > 0.0 else 1.0) / tail)


class Space:
    """Unknown fields on a line mesh in r; unknowns of all fields are stacked in one vector of length `size`.

    Attributes: `r`, the quadrature points [element, point]; `weight`, the area r dr (for one radian) of each of them;
    `dofs[element, local]`, the places of an element's unknowns in the vector; `b[element, point, row, local]`, the operators.
    """

    def __init__(self, vertices, fields):
        self.vertices, self.fields = np.asarray(vertices, dtype=float), tuple(fields)
        mesh = MeshLine(self.vertices)
        self.mapping = mesh.mapping()
        bases = [Basis(mesh, ELEMENTS[name](), intorder=QUADRATURE_ORDER) for name in self.fields]
        starts = np.concatenate([[0], np.cumsum([basis.N for basis in bases])])
        self.size = int(starts[-1])
        self.part = {name: slice(starts[k], starts[k + 1]) for k, name in enumerate(self.fields)}
        self.place = np.concatenate([basis.doflocs[0] for basis in bases])
        self.dofs = np.concatenate([basis.element_dofs + start for basis, start in zip(bases, starts, strict=False)]).T
        cells = np.arange(len(self.vertices) - 1)
        self.r, self.b = self._operators(np.broadcast_to(bases[0].X, (1, cells.size, bases[0].X.shape[1])), cells)
        self.weight = bases[0].dx * self.r
        self.local, self.share = bases[0].X[0], bases[0].W  # of one element: places and weights, which add up to 1
        self._columns = self.b.reshape(cells.size, -1, self.dofs.shape[1])

    def _operators(self, local, cells):
        """Radii [cell, point] and B [cell, point, row, local unknown] at `local` (1, cells, points) in the reference element."""
        r = self.mapping.F(local, cells)[0]
        rows, columns = (8 if "g" in self.fields else 6), []
        for name in self.fields:
            for i in range(3 if ELEMENTS[name] is ElementLineP2 else 2):
                (shape,) = ELEMENTS[name]().gbasis(self.mapping, local, i, cells)
                value, slope = np.asarray(shape), shape.grad[0]
                column = np.zeros((*r.shape, rows))
                if name == "u_r":
                    column[..., 0], column[..., 2], column[..., 3] = value, slope, value / r
                elif name == "u_phi":
                    column[..., 1], column[..., 4] = value, slope - value / r
                elif name == "p":
                    column[..., 5] = value
                else:
                    column[..., 6], column[..., 7] = value, slope
                columns.append(column)
        return r, np.stack(columns, axis=-1)

    def at_end(self, field, outer):
        """Place in the vector of the unknown of `field` on the inner or the outer ring."""
        part = self.part[field]
        return part.start + int(np.argmax(self.place[part]) if outer else np.argmin(self.place[part]))

    def points(self, x):
        """z[row, element, point] = B x at the quadrature points."""
        z = self._columns @ x[self.dofs][:, :, None]
        return z.reshape(*self.r.shape, -1).transpose(2, 0, 1)

    def residual(self, q):
        """The vector sum over points of weight B^T q, for q[row, element, point]."""
        weighted = (q * self.weight).transpose(1, 2, 0).reshape(len(self.dofs), 1, -1)
        return np.bincount(self.dofs.ravel(), weights=(weighted @ self._columns).ravel(), minlength=self.size)

    def tangents(self, slope):
        """Element matrices [element, local, local] of B^T C B, for C = dq/dz as slope[row, column, element, point]."""
        weighted = (slope * self.weight).transpose(2, 3, 0, 1)
        return self._columns.transpose(0, 2, 1) @ (weighted @ self.b).reshape(self._columns.shape)

    def evaluated(self, x, radii):
        """z[row, ...] at any radii inside the mesh; on a mesh point, where slopes jump, the mean of the two sides."""
        radii, mean = np.asarray(radii, dtype=float), 0.0
        for cells, local in self._both_sides(radii.ravel()):
            _, b = self._operators(local[None, :, None], cells)
            mean = mean + 0.5 * np.einsum("cqkn,cn->kc", b, x[self.dofs[cells]])
        return mean.reshape(-1, *radii.shape)

    def recovered(self, values, radii):
        """Values[row, element, point] at any radii, from the line in each element that fits them best; on a mesh point the mean.

        For a stress this is far better than its value at the place: the weak balance makes just this line right.
        """
        radii, mean = np.asarray(radii, dtype=float), 0.0
        level = values @ self.share
        slope = 3.0 * values @ (self.share * (2.0 * self.local - 1.0))
        for cells, local in self._both_sides(radii.ravel()):
            mean = mean + 0.5 * (level[:, cells] + slope[:, cells] * (2.0 * local - 1.0))
        return mean.reshape(-1, *radii.shape)

    def _both_sides(self, radii):
        """Twice the element that holds each radius and the place in it (0 to 1); they differ on a mesh point between two."""
        for side in ("left", "right"):
            cells = np.clip(np.searchsorted(self.vertices, radii, side) - 1, 0, len(self.vertices) - 2)
            yield cells, (radii - self.vertices[cells]) / (self.vertices[cells + 1] - self.vertices[cells])

    def nodes(self):
        """Radii of the quadratic nodes (mesh points and element middles), ascending."""
        return np.sort(np.concatenate([self.vertices, 0.5 * (self.vertices[1:] + self.vertices[:-1])]))
