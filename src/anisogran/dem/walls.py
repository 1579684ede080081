"""Forces between grains and walls: a short list of candidates, the same contact laws, forces summed onto grains and walls.

Contact memory is kept for each wall and grain, arrays (walls, N), so that it needs no bookkeeping when the list of candidates changes.
A wall is a partner of infinite mass that meets the grain along the boundary's normal. A scene without walls has no list (None), and
none of this is compiled for it.
"""

from typing import NamedTuple

import numpy as np

from anisogran.compiled import kernel, subkernel
from anisogran.dem.boundaries import touch
from anisogran.dem.laws import normal_force, tangential_force
from anisogran.dem.rows import TORQUE


class WallList(NamedTuple):
    """Candidates (grain[k], wall[k]) closer than the skin; size[0] of them are in use."""

    grain: np.ndarray  # (capacity,) int64
    wall: np.ndarray  # (capacity,) int64
    size: np.ndarray  # (1,) int64


def empty_wall_list(grains, walls):
    """A list that can hold every grain at every wall; None if there is no wall."""
    if walls == 0:
        return None
    return WallList(np.zeros(grains * walls, np.int64), np.zeros(grains * walls, np.int64), np.zeros(1, np.int64))


@subkernel
def find_wall_contacts(boundary, body, movable, skin, wall_list):
    """Fills the list; returns the index of a grain whose centre lies beyond a wall, or -1."""
    outside = -1
    if wall_list is not None:
        found = 0
        for wall in range(boundary.position.size):
            for i in range(movable):
                overlap = touch(boundary, wall, body.x[i], body.y[i], body.radius[i])[0]
                if overlap > -skin:
                    wall_list.grain[found] = i
                    wall_list.wall[found] = wall
                    found += 1
                if overlap > body.radius[i]:
                    outside = i
        wall_list.size[0] = found
    return outside


@kernel
def wall_arm(radius, overlap):
    """Lever arm of the contact with a wall, the same in the slip velocity and in the torque."""
    return radius - 0.5 * overlap


@kernel
def wall_slip(nx, ny, du, dv, radius, overlap, spin):
    """Velocity of the wall against the grain's surface along the tangent; du, dv: of the wall against the grain's centre."""
    return dv * nx - du * ny - wall_arm(radius, overlap) * spin


@subkernel
def wall_contact(boundary, body, spin, k, wall_list, normal, friction, largest, spring, dt):
    """Candidate k: grain, wall, overlap, normal towards the wall, normal force, tangential force on the wall; contact memory updated."""
    i = wall_list.grain[k]
    wall = wall_list.wall[k]
    radius = body.radius[i]
    overlap, nx, ny, wall_vx, wall_vy = touch(boundary, wall, body.x[i], body.y[i], radius)
    du = wall_vx - body.vx[i]
    dv = wall_vy - body.vy[i]
    memo = 0.0
    if largest is not None:
        memo = largest[wall, i]
    fn, bound, memo = normal_force(normal, overlap, du * nx + dv * ny, memo, 2.0 * radius)
    closed = overlap > 0.0
    if largest is not None:
        largest[wall, i] = memo if closed else 0.0
    ft = 0.0
    if friction is not None:
        slip = wall_slip(nx, ny, du, dv, radius, overlap, spin[i])
        ft, stretched = tangential_force(friction, spring[wall, i], slip, bound, dt)
        spring[wall, i] = stretched if closed else 0.0
    return i, wall, overlap, nx, ny, fn, ft


@subkernel
def add_wall_forces(boundary, body, spin, wall_list, normal, friction, largest, spring, dt):
    """Adds the forces of all wall contacts to the grains, and to boundary.force and boundary.traction those on the walls."""
    if wall_list is not None:
        boundary.force[:] = 0.0
        boundary.traction[:] = 0.0
        for k in range(wall_list.size[0]):
            i, wall, overlap, nx, ny, fn, ft = wall_contact(boundary, body, spin, k, wall_list, normal, friction, largest, spring, dt)
            if overlap > 0.0:
                body.fx[i] -= fn * nx - ft * ny
                body.fy[i] -= fn * ny + ft * nx
                boundary.force[wall] += fn
                boundary.traction[wall] += ft
                if friction is not None:
                    body.forces[i, TORQUE] -= wall_arm(body.radius[i], overlap) * ft
