"""The space in which a ring flow is sought: mesh, finite elements, and the operators B from unknowns to what a law sees.

Polar components (r, phi) with the area measure r dr dphi, so the rings are exact and no mesh line approximates a circle. The mesh
is a line in r if the flow is axisymmetric, else the logical rectangle (s, phi), closed in phi, whose lines of constant s lead from
ring to ring (s = r if the rings are concentric). The residual is B^T q(z) on both, with z = B x the `Point` seen by the law.
"""

from itertools import product
from math import pi

import numpy as np
from skfem import ElementLineP1, ElementLineP2, ElementQuad1, ElementQuad2

from anisogran.continuum.balance import Point

DEGREE = {"u_r": 2, "u_phi": 2, "p": 1, "g": 2}  # of the polynomials, in each direction
LINE, RECTANGLE = {1: ElementLineP1(), 2: ElementLineP2()}, {1: ElementQuad1(), 2: ElementQuad2()}
GAUSS_R, GAUSS_PHI = 5, 3  # points of an element: 1/r and 1/g are not polynomials, so more than the degrees ask for


class Space:
    """Unknown fields between two rings; unknowns of all fields are stacked in one vector of length `size`.

    `vertices`, ascending radii of mesh points; `angles`, ascending from 0 to 2 pi, or None for an axisymmetric flow; `offset`, how
    far the centre of the inner ring lies from that of the outer one, the origin, towards phi = 0. With `inertia` the Point has
    velocity and spin too, which only the advection needs.

    Attributes: `place` and `angle` of each unknown; `part[name]`, the slice of a field in the vector, which reads as an array
    [radius, angle]; `radians`, the angle that integrals run over (1 on a line); `r`, the quadrature points [element, point];
    `weight`, their areas; `dofs[element, local]`, the places of an element's unknowns in the vector.
    """

    def __init__(self, vertices, fields, angles=None, offset=0.0, inertia=False):
        self.vertices, self.fields, self.offset = np.asarray(vertices, dtype=float), tuple(fields), offset
        self.angles = None if angles is None else np.asarray(angles, dtype=float)
        line = angles is None
        self.around = 1 if line else len(self.angles) - 1
        self.radians = 1.0 if line else 2.0 * pi
        self.elements = LINE if line else RECTANGLE
        self.lines = [self.vertices] if line else [self.vertices, self.angles]
        self.cells = np.arange((len(self.vertices) - 1) * self.around)
        self.rows = self._rows(inertia)
        self._number()
        self.local, self.share = gauss_points(len(self.lines))
        everywhere = self.local[:, None]
        self.b = self.operators(everywhere, self.cells, self.rows)
        s, phi, sizes = self._mapped(everywhere, self.cells)
        self.r, stretch, _ = self.polar(s, phi)
        self.weight = self.share * np.prod(sizes, axis=0) * stretch * self.r
        self._columns = self.b.reshape(self.cells.size, -1, self.dofs.shape[1])

    def _rows(self, inertia):
        rows = ["u_r", "u_phi", "spin"] if inertia else []
        rows += ["d_rr", "d_ff", "gamma", "p"]
        if "g" in self.fields:
            rows += ["g", "g_r"] if self.angles is None else ["g", "g_r", "g_f"]
        return tuple(rows)

    def _number(self):
        """Numbers the unknowns of each field [radius, angle]; the last angle is the first one again."""
        self.part, self.size, dofs, place, angle = {}, 0, [], [], []
        radial, angular = np.divmod(self.cells, self.around)
        for name in self.fields:
            degree = DEGREE[name]
            corner = np.rint(degree * self.elements[degree].doflocs).astype(int)
            i, j = degree * radial[:, None] + corner[:, 0], degree * angular[:, None] + corner[:, -1]
            radii, turns = nodes(self.vertices, degree), np.zeros(1) if self.angles is None else nodes(self.angles, degree)[:-1]
            dofs.append(self.size + i * turns.size + (j % turns.size))
            self.part[name] = slice(self.size, self.size + radii.size * turns.size)
            self.size = self.part[name].stop
            place.append(np.repeat(radii, turns.size))
            angle.append(np.tile(turns, radii.size))
        self.dofs, self.place, self.angle = np.concatenate(dofs, axis=1), np.concatenate(place), np.concatenate(angle)

    def _mapped(self, local, cells):
        """s and phi of places `local` (s and phi, or s only; 0 to 1) in the elements `cells`, and the sizes of these [cell, 1]."""
        corners = np.divmod(cells, self.around)
        sizes = [np.diff(line)[k][:, None] for line, k in zip(self.lines, corners, strict=False)]
        at = [line[k][:, None] + size * x for line, k, size, x in zip(self.lines, corners, sizes, local, strict=False)]
        return at[0], at[1] if self.angles is not None else np.zeros_like(at[0]), sizes

    def polar(self, s, phi):
        """r, dr/ds and dr/dphi at s: radii stretch linearly from the inner ring, a circle beside the origin, to the outer one."""
        inner, outer = self.vertices[0], self.vertices[-1]
        across, along = self.offset * np.sin(phi), self.offset * np.cos(phi)
        reach = np.sqrt(inner**2 - across**2)
        share = (outer - s) / (outer - inner)
        excess = along + reach - inner
        return s + share * excess, 1.0 - excess / (outer - inner), -share * across * (1.0 + along / reach)

    def operators(self, local, cells, rows):
        """B [cell, point, row, local unknown] of the named rows at `local` [direction, cell or 1, point] in the elements `cells`."""
        s, phi, sizes = self._mapped(local, cells)
        r, stretch, turn = self.polar(s, phi)
        out, column = np.zeros((*r.shape, len(rows), self.dofs.shape[1])), 0
        for name in self.fields:
            element = self.elements[DEGREE[name]]
            for i in range(len(element.doflocs)):
                value, slopes = element.lbasis(local, i)
                slope = slopes[0] / sizes[0] / stretch
                around = (slopes[1] / sizes[1] - turn * slope) / r if self.angles is not None else 0.0
                for row, added in contributions(name, value, slope, around, r).items():
                    if row in rows:
                        out[..., rows.index(row), column] = added
                column += 1
        return out

    def ring(self, field, outer):
        """Places in the vector of the unknowns of `field` on the inner or the outer ring, by angle."""
        part = self.part[field]
        number = DEGREE[field] * self.around if self.angles is not None else 1
        return np.arange(part.stop - number, part.stop) if outer else np.arange(part.start, part.start + number)

    def points(self, x):
        """z[row, element, point] = B x at the quadrature points."""
        z = self._columns @ x[self.dofs][:, :, None]
        return z.reshape(*self.r.shape, -1).transpose(2, 0, 1)

    def point(self, x):
        """The Point at the quadrature points, as far as the balances need it."""
        return Point(**dict(zip(self.rows, self.points(x), strict=True)))

    def residual(self, q):
        """The vector sum over points of weight B^T q, for q[row, element, point]."""
        weighted = (q * self.weight).transpose(1, 2, 0).reshape(len(self.dofs), 1, -1)
        return np.bincount(self.dofs.ravel(), weights=(weighted @ self._columns).ravel(), minlength=self.size)

    def tangents(self, slope):
        """Element matrices [element, local, local] of B^T C B, for C = dq/dz as slope[row, column, element, point]."""
        weighted = np.ascontiguousarray((slope * self.weight).transpose(2, 3, 0, 1))
        return self._columns.transpose(0, 2, 1) @ (weighted @ self.b).reshape(self._columns.shape)

    def evaluated(self, x, s, phi=0.0):
        """The whole Point at any s (and phi) inside the mesh; on a mesh line, where slopes jump, the mean of its sides."""
        s, phi = np.broadcast_arrays(np.asarray(s, dtype=float), phi)
        rows = ["u_r", "u_phi", "spin", "d_rr", "d_ff", "gamma", "p"] + (["g", "g_r", "g_f"] if "g" in self.fields else [])
        sides = [
            np.einsum("cqkn,cn->kc", self.operators(local[:, :, None], cells, rows), x[self.dofs[cells]])
            for cells, local in self._sides(s.ravel(), phi.ravel())
        ]
        return Point(**dict(zip(rows, np.mean(sides, axis=0).reshape(-1, *s.shape), strict=True)))

    def recovered(self, values, s, phi=0.0):
        """Values[row, element, point] at any s (and phi), from the (bi)linear field in each element that fits them best.

        For a stress this is far better than its value at the place: the weak balance makes just this field right. On a mesh line
        the mean of its sides.
        """
        s, phi = np.broadcast_arrays(np.asarray(s, dtype=float), phi)
        moments = values @ (self.share[:, None] * legendre(self.local).T)
        sides = [np.sum(moments[:, cells] * legendre(local).T, axis=-1) for cells, local in self._sides(s.ravel(), phi.ravel())]
        return np.mean(sides, axis=0).reshape(-1, *s.shape)

    def _sides(self, s, phi):
        """The elements that hold each point and the places in them [direction, point], from both sides of each mesh line."""
        for sides in product(("left", "right"), repeat=len(self.lines)):
            cells, local = 0, []
            for line, value, side in zip(self.lines, (s, np.mod(phi, 2.0 * pi)), sides, strict=False):
                k = np.searchsorted(line, value, side) - 1
                if line is self.angles:  # the line phi = 0 is the line 2 pi
                    value, k = np.where(k < 0, value + 2.0 * pi, value), k % self.around
                k = np.clip(k, 0, line.size - 2)
                local.append((value - line[k]) / (line[k + 1] - line[k]))
                cells = k if line is self.vertices else cells * self.around + k
            yield cells, np.array(local)

    def arc(self, outer):
        """The length of the ring that belongs to each of its quadratic nodes (Simpson's rule), by angle; on a line its radius."""
        s = self.vertices[-1 if outer else 0]
        if self.angles is None:
            return np.array([s])
        r, _, turn = self.polar(s, nodes(self.angles, 2)[:-1])
        widths = np.diff(self.angles)
        share = np.empty(2 * self.around)
        share[::2], share[1::2] = (widths + np.roll(widths, 1)) / 6.0, widths / 1.5
        return np.hypot(r, turn) * share

    def nodes(self):
        """Values of s at the quadratic nodes (mesh points and element middles), ascending."""
        return nodes(self.vertices, 2)


def contributions(name, value, slope, around, r):
    """{row of the Point: what an unknown of a field adds to it}; `slope` is along r, `around` = (1/r) d/dphi."""
    if name == "u_r":
        return {"u_r": value, "d_rr": slope, "d_ff": value / r, "gamma": around, "spin": -0.5 * around}
    if name == "u_phi":
        return {"u_phi": value, "d_ff": around, "gamma": slope - value / r, "spin": 0.5 * (slope + value / r)}
    if name == "p":
        return {"p": value}
    return {"g": value, "g_r": slope, "g_f": around}


def nodes(points, degree):
    """The points and, for degree 2, the middles between them, ascending."""
    if degree == 1:
        return points
    out = np.empty(2 * len(points) - 1)
    out[::2], out[1::2] = points, 0.5 * (points[1:] + points[:-1])
    return out


def gauss_points(directions):
    """Places [direction, point] and weights, which add up to 1, of a reference element; directions: s (and phi)."""
    rules = [np.polynomial.legendre.leggauss(n) for n in (GAUSS_R, GAUSS_PHI)[:directions]]
    places = np.meshgrid(*(0.5 * (1.0 + x) for x, _ in rules), indexing="ij")
    weights = np.meshgrid(*(0.5 * w for _, w in rules), indexing="ij")
    return np.array([place.ravel() for place in places]), np.prod([weight.ravel() for weight in weights], axis=0)


def legendre(local):
    """The orthonormal (bi)linear functions [function, ...] at places local[direction, ...] of a reference element."""
    return np.array([np.prod(pair, axis=0) for pair in product(*((np.ones_like(x), np.sqrt(3.0) * (2.0 * x - 1.0)) for x in local))])
