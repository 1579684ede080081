"""What each effect of the grains costs, beside the same scene without it, in turn; and what the reserve of the neighbour list does."""

import statistics
import tempfile
from functools import partial
from pathlib import Path

from anisogran.averaging import average
from anisogran.benchmark import made_packing
from anisogran.benchmark.shear import STEP
from anisogran.cost.tables import row
from anisogran.cost.timing import clocked
from anisogran.dem import Friction, Grains, Linear, Luding, Periodic, Simulation

RATE = 200.0  # 1/s, fast enough that neighbour lists are built
STEPS = 1000
SKINS = (0.05, 0.1, 0.2, 0.4, 0.8)  # in mean radii
DEFAULT_SKIN = 0.2


def sheared(packing, skin=DEFAULT_SKIN, **changes):
    """The Simulation of pure shear of a dense packing (position, radius, side) without friction, with some arguments changed."""
    position, radius, side = packing
    grains = Grains(position, radius, density=2000.0, velocity=position * [-RATE, RATE])
    damping = 3.5e4 * 0.5 * float(grains.mass.mean())
    usual = {"normal": Linear(1e5, damping), "boundary": Periodic(side, side, stretch_rate=(-RATE, RATE)), "dt": STEP}
    return Simulation(grains, **usual | {"skin": skin * float(radius.mean())} | changes)


def price_rows(quick):
    """Rows without an error: processor seconds of 1,000 steps with and without each effect, medians of runs in turn; and skins."""
    packing, repeats = made_packing(1000 if quick else 4000), 3 if quick else 7
    mass = float(Grains(packing[0], packing[1], density=2000.0).mass.mean())
    damping = 3.5e4 * 0.5 * mass
    hysteretic = Luding(5e4, 1e5, 0.0, damping)
    rows = []
    rubbing = {"friction": Friction(2e4, 0.5, damping=0.5 * damping)}
    for name, without, changes in (
        ("friction and rotation", {}, rubbing),
        ("hysteresis", {}, {"normal": hysteretic}),
        ("adhesion", {"normal": hysteretic}, {"normal": Luding(5e4, 1e5, 5e4, damping)}),
        ("background drag", {}, {"drag": 1e3 * mass}),
        ("the energy ledger", {}, {"ledger": True}),
    ):
        pair = [sheared(packing, **some) for some in (without, changes)]
        rows += beside(name, [partial(simulation.run, STEPS) for simulation in pair], packing, repeats)
    with tempfile.TemporaryDirectory() as folder:
        plain, other = sheared(packing), sheared(packing)

        def averaged():
            other.run(STEPS)
            average(other.snapshot(), fields=["stress", "fabric", "area_fraction"])

        def saved():
            other.run(STEPS)
            other.save(Path(folder) / "checkpoint.npz")

        for name, work in (("a snapshot and its averages", averaged), ("a checkpoint", saved)):
            rows += beside(name, [partial(plain.run, STEPS), work], packing, repeats)
    return rows + skin_rows(packing, repeats)


def beside(name, works, packing, repeats):
    """Two rows, without and with: the works are done in turn, once before the clock runs."""
    for work in works:
        work()
    seconds = [[clocked(work)[1] for work in works] for _ in range(repeats)]
    knob = f"price of {name}, {STEPS} steps of {len(packing[1])} grains"
    return [
        row(knob, value, None, statistics.median(one)) for value, one in zip(("without", "with"), zip(*seconds, strict=True), strict=True)
    ]


def skin_rows(packing, repeats):
    """Seconds against the reserve of the neighbour list, which changes only the order in memory and with it the rounding of sums."""
    simulations = {skin: sheared(packing, skin) for skin in SKINS}
    seconds = {skin: [] for skin in SKINS}
    for simulation in simulations.values():
        simulation.compile()
    for _ in range(repeats):
        for skin, simulation in simulations.items():
            seconds[skin].append(clocked(partial(simulation.run, STEPS))[1])
    knob = f"neighbour skin in mean radii, {STEPS} steps of {len(packing[1])} grains"
    return [row(knob, skin, None, statistics.median(some), skin == DEFAULT_SKIN) for skin, some in seconds.items()]
