"""Driven grains that belong to no wall: they keep their velocity and spin, whatever pushes them."""

from anisogran.compiled import kernel


@kernel
def coast(body, begin, end, dt):
    """Moves the grains begin .. end on by one step with their velocity."""
    for i in range(begin, end):
        body.x[i] += dt * body.vx[i]
        body.y[i] += dt * body.vy[i]
