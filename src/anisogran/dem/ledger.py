"""The energy ledger, on request: what dashpots, friction, plasticity and drag have taken, and what the boundary has given.

It looks at each contact before its forces are computed, with the memory of the step before, and touches nothing but its own arrays: a run
gives the same bits with and without it. The work of a force over a step is the mean of its values before and after, times the way, just
as the time stepping has it; for that a contact remembers its overlap and the forces of its dashpot and of its friction.
"""

import math

from anisogran.compiled import kernel, subkernel
from anisogran.dem.boundaries import lattice, touch
from anisogran.dem.laws import normal_force, stored_energy, tangential_energy, tangential_force
from anisogran.dem.pairs import BLOCK, direction, pair_size, separation, slip_velocity
from anisogran.dem.rows import DIFFERENCE_RADIUS, DIFFERENCE_SPIN, DU, DV, DX, DY, FX, FY, SPIN, SUM_SPIN, TORQUE, VX, VY, pair_columns
from anisogran.dem.specialisation import block, unaliased
from anisogran.dem.walls import wall_slip

DASHPOT, FRICTION, PLASTICITY, DRAG, BOUNDARY = range(5)
POWER, POWER_BEFORE = 5, 6  # W: of the boundary, through lattice and driven grains, in this step and in the one before
SUMS = ("dissipated_dashpot", "dissipated_friction", "dissipated_plasticity", "dissipated_drag", "boundary_work")


@subkernel
def normal_losses(normal, before, viscous_before, overlap, rate, largest, size, dt):
    """One contact over one step, from the overlap (0 where open) and the dashpot's force before it, without a branch.

    Energy lost to the dashpot and to plasticity, mean forces of spring and dashpot, present force of the dashpot, and bound of friction.
    """
    was = 1.0 if before > 0.0 else 0.0
    touches = 1.0 if overlap > 0.0 else 0.0
    spring_before, _, _ = normal_force(normal, before, 0.0, largest, size)
    spring, _, memory = normal_force(normal, overlap, 0.0, largest, size)
    whole, bound, _ = normal_force(normal, overlap, rate, largest, size)
    elastic = 0.5 * (was * spring_before + touches * spring)
    damping = touches * (whole - spring)
    viscous = 0.5 * (viscous_before + damping)
    gain = touches * stored_energy(normal, overlap, memory, size) - was * stored_energy(normal, before, largest, size)
    return -viscous * rate * dt, elastic * (overlap - before) - gain, elastic, viscous, damping, touches * bound


@subkernel
def tangential_losses(friction, closed, force_before, slip, spring, bound, dt):
    """One contact over one step: energy lost to the tangential dashpot and to sliding, the mean force and the present one.

    An opening contact loses what its spring still holds.
    """
    touches = 1.0 if closed else 0.0
    force, stretched = tangential_force(friction, spring, slip, bound, dt)
    sticks = closed and abs(stretched - (spring + slip * dt)) <= 1e-12 * abs(stretched)  # all of the slip has gone into the spring
    force *= touches
    mean = 0.5 * (force_before + force)
    lost = -mean * slip * dt - (tangential_energy(friction, touches * stretched) - tangential_energy(friction, spring))
    return lost if sticks else 0.0, 0.0 if sticks else lost, mean, force


@subkernel
def account_pairs(pairs, reach, normal, friction, cell, largest, spring, overlaps, viscous, tangential, losses, dt):
    """A block of pairs, before their forces: what this step takes from each, into the columns of `losses`; one pass of vectors."""
    seen = unaliased(overlaps)
    damped = unaliased(viscous)
    rubbed = unaliased(tangential)
    dashpot = unaliased(losses[DASHPOT])
    plasticity = unaliased(losses[PLASTICITY])
    sliding = unaliased(losses[FRICTION])
    boundary = unaliased(losses[BOUNDARY])
    x = pairs[DX]
    y = pairs[DY]
    u = pairs[DU]
    v = pairs[DV]
    difference_radius = pairs[DIFFERENCE_RADIUS]
    difference_spin = pairs[DIFFERENCE_SPIN]
    sum_spin = pairs[SUM_SPIN]
    for k in range(reach.size):
        dx, dy, du, dv = separation(cell, x[k], y[k], u[k], v[k])
        distance = math.sqrt(dx * dx + dy * dy)
        nx, ny = direction(dx, dy, distance)
        overlap = reach[k] - distance
        overlap = overlap if overlap > 0.0 else 0.0
        memo = 0.0
        if largest is not None:
            memo = largest[k]
        size = pair_size(reach[k], difference_radius[k])
        lost, plastic, mean, _, damping, bound = normal_losses(normal, seen[k], damped[k], overlap, du * nx + dv * ny, memo, size, dt)
        seen[k] = overlap
        damped[k] = damping
        if friction is not None:
            slip = slip_velocity(nx, ny, du, dv, distance, difference_radius[k], difference_spin[k], sum_spin[k])
            stuck, slid, _, force = tangential_losses(friction, overlap > 0.0, rubbed[k], slip, spring[k], bound, dt)
            rubbed[k] = force
            lost += stuck
            sliding[k] = slid
        dashpot[k] = lost
        plasticity[k] = plastic
        if cell is not None:  # under pressure it carries the grains along, which no velocity tells
            boundary[k] = -mean * (nx * cell.growth_x * dx + ny * cell.growth_y * dy)


@subkernel
def add_losses(losses, size, sums, dt):
    """Adds the columns of a block to the sums, pair by pair; in a step of no time the book is only opened."""
    if dt > 0.0:
        for k in range(size):
            sums[DASHPOT] += losses[DASHPOT, k]
            sums[FRICTION] += losses[FRICTION, k]
            sums[PLASTICITY] += losses[PLASTICITY, k]
            sums[BOUNDARY] += losses[BOUNDARY, k]


@subkernel
def account_images(pairs, size, cell, force, losses, sums):
    """A block of pairs, after their forces: the power of the moving lattice, since an image is faster than its original."""
    if cell is not None:
        power = unaliased(losses[BOUNDARY])
        x = pairs[DX]
        y = pairs[DY]
        u = pairs[DU]
        v = pairs[DV]
        fx = force[FX]
        fy = force[FY]
        for k in range(size):
            _, _, du, dv = separation(cell, x[k], y[k], u[k], v[k])
            power[k] = fx[k] * (du - u[k]) + fy[k] * (dv - v[k])
        for k in range(size):
            sums[POWER] -= power[k]


@subkernel
def account_walls(boundary, body, spin, wall_list, normal, friction, largest, spring, overlaps, viscous, tangential, sums, dt):
    """The contacts with walls, before their forces: losses, and the work of moving walls."""
    if wall_list is not None:
        for k in range(wall_list.size[0]):
            i = wall_list.grain[k]
            wall = wall_list.wall[k]
            radius = body.radius[i]
            overlap, nx, ny, wall_vx, wall_vy = touch(boundary, wall, body.x[i], body.y[i], radius)
            overlap = max(overlap, 0.0)
            before = overlaps[wall, i]
            if overlap == 0.0 and before == 0.0:
                continue
            du = wall_vx - body.vx[i]
            dv = wall_vy - body.vy[i]
            memo = 0.0
            if largest is not None:
                memo = largest[wall, i]
            lost, plastic, elastic, drag, damping, bound = normal_losses(
                normal, before, viscous[wall, i], overlap, du * nx + dv * ny, memo, 2.0 * radius, dt
            )
            overlaps[wall, i] = overlap
            viscous[wall, i] = damping
            if dt > 0.0:  # else the book is only opened
                sums[DASHPOT] += lost
                sums[PLASTICITY] += plastic
                sums[BOUNDARY] -= (elastic + drag) * (wall_vx * nx + wall_vy * ny) * dt
            if friction is not None:
                slip = wall_slip(nx, ny, du, dv, radius, overlap, spin[i])
                stuck, slid, mean, force = tangential_losses(friction, overlap > 0.0, tangential[wall, i], slip, spring[wall, i], bound, dt)
                tangential[wall, i] = force
                if dt > 0.0:
                    sums[DASHPOT] += stuck
                    sums[FRICTION] += slid
                    sums[BOUNDARY] -= mean * (wall_vy * nx - wall_vx * ny) * dt


@subkernel
def account_grains(rows, forces, movable, drag, sums, dt):
    """After all forces: what drag takes, and the work that driven grains and the lattice do on the free grains."""
    if drag is not None:
        for i in range(movable):
            sums[DRAG] += drag * (rows[i, VX] ** 2 + rows[i, VY] ** 2) * dt
    for i in range(movable, rows.shape[0]):
        sums[POWER] -= forces[i, FX] * rows[i, VX] + forces[i, FY] * rows[i, VY] + forces[i, TORQUE] * rows[i, SPIN]
    sums[BOUNDARY] += 0.5 * (sums[POWER_BEFORE] + sums[POWER]) * dt
    sums[POWER_BEFORE] = sums[POWER]
    sums[POWER] = 0.0


@subkernel
def stored_in_pairs(pairs, reach, normal, friction, cell, largest, spring):
    """Energy in J that the contacts of a block of pairs can give back."""
    total = 0.0
    for k in range(reach.size):
        dx, dy, _, _ = separation(cell, pairs[DX, k], pairs[DY, k], 0.0, 0.0)
        overlap = reach[k] - math.sqrt(dx * dx + dy * dy)
        if overlap > 0.0:
            memo = 0.0
            if largest is not None:
                memo = largest[k]
            total += stored_energy(normal, overlap, memo, pair_size(reach[k], pairs[DIFFERENCE_RADIUS, k]))
            if friction is not None:
                total += tangential_energy(friction, spring[k])
    return total


@subkernel
def stored_at_walls(boundary, body, wall_list, normal, friction, largest, spring):
    """Energy in J that the contacts with walls can give back."""
    total = 0.0
    if wall_list is not None:
        for k in range(wall_list.size[0]):
            i = wall_list.grain[k]
            wall = wall_list.wall[k]
            overlap = touch(boundary, wall, body.x[i], body.y[i], body.radius[i])[0]
            if overlap > 0.0:
                memo = 0.0
                if largest is not None:
                    memo = largest[wall, i]
                total += stored_energy(normal, overlap, memo, 2.0 * body.radius[i])
                if friction is not None:
                    total += tangential_energy(friction, spring[wall, i])
    return total


@kernel
def stored_in_contacts(body, pairs, wall_list, memory, wall_memory, normal, friction, wall_friction, boundary, out):
    """Energy in J that all contacts can give back at this instant: the springs of pairs and walls."""
    cell = lattice(boundary)
    total = stored_at_walls(boundary, body, wall_list, normal, wall_friction, wall_memory.largest, wall_memory.spring)
    used = pairs.start[-1]
    for begin in range(0, used, BLOCK):
        end = min(begin + BLOCK, used)
        pair_columns(body.rows, pairs.first, pairs.second, begin, end - begin, out.pairs, out.whole)
        largest = block(memory.largest, begin, end)
        total += stored_in_pairs(out.pairs, pairs.reach[begin:end], normal, friction, cell, largest, block(memory.spring, begin, end))
    return total
