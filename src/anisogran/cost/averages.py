"""What accuracy costs in the averages: the width, the kernel, the grains in a cell, the snapshots, and the price of each field.

The sample is a homogeneous packing, so that the pressure is the same everywhere but for the chance of the packing: the scatter of local
pressures about that of the whole sample is their error, and that of the whole sample itself is as much smaller as it holds more grains. A
wave of velocity laid over the same grains tells what a width takes away: there the exact field is known.
"""

import math
from dataclasses import replace

import numpy as np

from anisogran.averaging import average, known_at, place_of
from anisogran.averaging.places import grid_points
from anisogran.averaging.smoothing_kernels import KERNELS, smoothing, standard_deviation
from anisogran.benchmark import sheared_snapshot
from anisogran.cost.tables import row
from anisogran.cost.timing import timed
from anisogran.experiments import SimpleShear

WAVELENGTH = 20.0  # of the velocity wave in mean diameters: that of a shear zone
WIDTHS = (0.25, 0.5, 1.0, 2.0, 4.0)  # of the Gaussian in mean diameters
DEFAULT_WIDTH = 1.0


def averaging_cost(quick=False):
    """Rows {knob, value, error, seconds, default} for the averages, a list; processor seconds, medians."""
    snapshot, repeats = sheared_snapshot(2_000 if quick else 10_000), 1 if quick else 3
    points = nodes(snapshot, 15 if quick else 30)
    rows = width_rows(snapshot, points, repeats) + kernel_rows(snapshot, points, repeats) + grains_rows(snapshot, repeats)
    return rows + snapshots_rows(quick, repeats) + price_rows(snapshot, points, repeats)


def nodes(snapshot, count):
    """Points (count^2, 2) of a regular grid over the periodic cell."""
    share = (np.arange(count) + 0.5) / count
    return grid_points(share, share) @ snapshot.cell


def scatter(local, whole):
    """Root mean square of the local values about that of the whole sample, relative."""
    return float(np.sqrt(np.mean((np.asarray(local) / float(whole) - 1) ** 2)))


def width_rows(snapshot, points, repeats):
    """Error of the local pressure, and of a velocity wave, against the width of the Gaussian."""
    whole = average(snapshot, fields="pressure").pressure
    d, height = snapshot.mean_diameter, snapshot.cell[1, 1]
    waves = round(height / (WAVELENGTH * d))
    waving = replace(snapshot, velocity=shear_wave(snapshot.position[:, 1], waves / height), cell_velocity=None)
    exact = shear_wave(points[:, 1], waves / height)[:, 0]
    noise, bias = [], []
    for width in WIDTHS:
        where = {"on": "points", "points": points, "width": width * d}
        default = width == DEFAULT_WIDTH
        local, seconds = timed(lambda where=where: average(snapshot, fields="pressure", **where).pressure, repeats)
        noise.append(row("width in d: scatter of the pressure at a point", width, scatter(local, whole), seconds, default))
        wave, seconds = timed(lambda where=where: average(waving, fields="velocity", **where).velocity[0], repeats)
        error = float(np.sqrt(np.nanmean((wave - exact) ** 2) / np.mean(exact**2)))
        bias.append(row(f"width in d: error of a velocity wave of {WAVELENGTH:g} d", width, error, seconds, default))
    return noise + bias


def shear_wave(y, wave_number):
    """Velocity (n, 2) along x that goes as a sine of y."""
    return np.stack([np.sin(2 * np.pi * wave_number * y), np.zeros(len(y))], axis=1)


def kernel_rows(snapshot, points, repeats):
    """Scatter of the pressure for kernels of one standard deviation, and for squares of the same with exact shares."""
    whole, d = average(snapshot, fields="pressure").pressure, snapshot.mean_diameter
    places = {}
    for kernel in KERNELS:
        width = d**2 / standard_deviation(smoothing(kernel, d, 2))  # so that the standard deviation is one diameter
        places[kernel] = {"on": "points", "points": points, "kernel": kernel, "width": width}
    places["squares, exact shares"] = {"on": "grid", "width": math.sqrt(12.0) * d}
    rows = []
    for name, where in places.items():
        local, seconds = timed(lambda where=where: average(snapshot, fields="pressure", **where).pressure, repeats)
        knob = "kernel of standard deviation 1 d: scatter of the pressure"
        rows.append(row(knob, name, scatter(local, whole), seconds, name == "gaussian"))
    return rows


def grains_rows(snapshot, repeats):
    """Scatter of the pressure between squares that hold so many grains: it falls with the root of their number."""
    whole, rows = average(snapshot, fields="pressure").pressure, []
    for parts in (32, 16, 8, 4, 2):
        edges = [np.linspace(0.0, side, parts + 1) for side in np.diag(snapshot.cell)]
        grains = len(snapshot.radius) / parts**2
        if grains < 2:
            continue
        local, seconds = timed(lambda edges=edges: average(snapshot, on="grid", edges=edges, fields="pressure").pressure, repeats)
        rows.append(row("grains in a cell: scatter of the pressure", round(grains), scatter(local, whole), seconds))
    return rows


def snapshots_rows(quick, repeats):
    """Error of s_D of a sheared cell of 100 grains against the number of snapshots, spread over the run.

    The snapshots of one run are dealt into sets; the error is the scatter of the sets about the mean over all, whose own error is as
    much smaller as it holds more of them.
    """
    frames = 64 if quick else 256
    run = SimpleShear(n=100, strain=4.0 if quick else 13.0, discard=1.0, inertial_number=0.03, frames=frames, seed=1).run()
    whole, rows = average(run, fields="s_D").s_D, []
    for count in (1, 4, 16):
        sets = [run.frames[begin :: frames // count] for begin in range(frames // count)]
        _, seconds = timed(lambda sets=sets: average(sets[0], fields="s_D"), repeats)
        error = scatter([float(average(part, fields="s_D").s_D) for part in sets], whole)
        rows.append(row("snapshots of a run: scatter of s_D", count, error, seconds))
    return rows


def price_rows(snapshot, points, repeats):
    """What each field costs by itself on rings and at points; asked for together, they share most of it."""
    ring = replace(snapshot, cell=None, cell_velocity=None)  # seen as a disc-shaped sample: only the time matters
    rows = []
    for title, sample, where in (
        ("price of a field on rings of 1 d", ring, {"on": "rings"}),
        (f"price of a field at {len(points)} points, width 1 d", snapshot, {"on": "points", "points": points}),
    ):
        names = known_at(place_of(sample, **where))
        for fields in [*([name] for name in names), names]:
            value = fields[0] if len(fields) == 1 else "all together"
            _, seconds = timed(lambda fields=fields, sample=sample, where=where: average(sample, fields=fields, **where), repeats)
            rows.append(row(f"{title}, {len(sample.radius)} grains", value, None, seconds))
    return rows
