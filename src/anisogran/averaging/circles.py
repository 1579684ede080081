"""The stress on a circle about the origin, from the forces of all contacts whose branch crosses it.

Averages over rings are sums over whole grains; this is the same stress where it is defined, on a line, and so the reference for them:
what the grains outside exert on those inside. In a steady flow the torque is the same on every circle.
"""

import numpy as np


def circle_sums(snapshot, radii):
    """{"cut_pressure", "cut_shear_stress"}: sigma_rr and sigma_rphi on circles of these radii (K,) in m, each (K,) in N/m.

    Compression positive; the shear stress is positive if what is inside drags what is outside along counter-clockwise. Each branch goes
    from centre to centre, or from the centre to the contact point with a smooth wall. The torque is that of the force at its contact
    point, so that r^2 sigma_rphi is the torque of the inside over 2 pi, spins included; the radial force is taken where the branch
    crosses, twice if it crosses there and back. Wall discs count as grains: on the circle of a wall the stress is that on the wall.
    Known in the plane. Source: the method of planes (Todd, Evans & Daivis, Phys. Rev. E 52, 1627, 1995; cited from memory) on a circle.
    """
    first, second = snapshot.pairs.T
    start = snapshot.position[first]
    end = np.where((second >= 0)[:, None], snapshot.position[second], snapshot.point)
    branch, (fx, fy) = end - start, snapshot.force.T
    torque = snapshot.point[:, 0] * fy - snapshot.point[:, 1] * fx
    square, along = (branch**2).sum(axis=1), (start * branch).sum(axis=1)
    # |start + t branch| = r at t = (-along -+ root)/square: inwards at the first, outwards at the second
    discriminant = along**2 - square * ((start**2).sum(axis=1) - np.square(radii)[:, None])
    root = np.sqrt(np.where(discriminant > 0, discriminant, np.nan))  # a branch that crosses nowhere compares false below
    radial, moment = np.zeros(len(radii)), np.zeros(len(radii))
    for sense in (-1, 1):
        t = (sense * root - along) / square
        circle, c = np.nonzero((t >= 0) & (t < 1))
        r = radii[circle]
        x, y = (start[c] + t[circle, c, None] * branch[c]).T
        radial += np.bincount(circle, sense * (fx[c] * x + fy[c] * y) / r, len(radii))
        moment += np.bincount(circle, sense * torque[c], len(radii))
    length = 2 * np.pi * radii
    return {"cut_pressure": -radial / length, "cut_shear_stress": -moment / (length * radii)}
