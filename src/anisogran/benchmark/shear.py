"""How fast the grains are: one fixed piece of work, pure shear of a dense periodic packing, that other codes have been timed on as well.

Box side x shrinks and side y grows at `rate`, k_n = 1e5 N/m, k_t = 2e4 N/m, mu = 0.5, dt = 1.44e-7 s, rho = 2000 kg/m3, discs with the mass
of spheres. The dashpots are those of a mean pair, 3.5e4/s times half the mean mass, and half of that along the tangent; codes that take
the reduced mass of each pair instead do one quotient more. `luding` has k1 = 5e4, k2 = 1e5 and kc = 5e4 N/m, a plastic depth of 0.05, and
the same friction. Without a file the packing is made here: radii uniform in 0.5 .. 1.5 mm, area fraction 0.86.
"""

import math
import time
import zipfile

import numpy as np

from anisogran.dem import Friction, Grains, Linear, Luding, Periodic, Simulation, dense_packing
from anisogran.outcome import InputError, checked

EFFECTS = ("frictionless", "friction", "luding")
LARGEST_TILE = 10_000  # grains
STEP = 1.44e-7  # s, a fiftieth of the contact time of the smallest pair
SMALLEST, LARGEST, AREA_FRACTION = 0.5e-3, 1.5e-3, 0.86


def check_effects(effects):
    """Raises InputError if these are not effects that can be asked for."""
    if effects not in EFFECTS:
        raise InputError(f"--effects {effects}: must be one of {', '.join(EFFECTS)}")


def read_packing(path):
    """Position (N, 2) in m, radius (N,) in m and side in m of the square periodic packing in an .npz file with `x` (N, 3), `r` (N,), `L`.

    Raises InputError naming the file if it cannot be read, or is not flat: all z equal means two dimensions.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            x, radius, side = (np.asarray(file[name], float) for name in ("x", "r", "L"))
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(f"--packing {path}: not a readable packing with x, r and L ({error})") from None
    if x.ndim != 2 or x.shape[1] not in (2, 3) or radius.shape != x.shape[:1] or side.ndim:
        raise InputError(f"--packing {path}: x {x.shape}, r {radius.shape} and L {side.shape} are not (N, 3), (N,) and one number")
    if x.shape[1] == 3 and np.ptp(x[:, 2]) > 0:
        raise InputError(f"--packing {path}: z differs from grain to grain; spheres in three dimensions are not there yet")
    return x[:, :2], radius, float(side)


def made_packing(grains):
    """Position, radius and side of a packing of about that many grains; above 10,000 it is laid with tiles of one periodic packing."""
    tiles = math.ceil(math.sqrt(grains / LARGEST_TILE))
    radius = np.random.default_rng(1).uniform(SMALLEST, LARGEST, round(grains / tiles**2))
    made = dense_packing(radius, area_fraction=AREA_FRACTION, seed=1)
    place = made.width * np.indices((tiles, tiles)).reshape(2, -1).T
    return (place[:, None] + made.position).reshape(-1, 2), np.tile(radius, tiles**2), tiles * made.width


def sheared_packing(position, radius, side, effects, rate, ledger=False):
    """The Simulation that is timed."""
    check_effects(effects)
    grains = Grains(position, radius, density=2000.0, velocity=position * [-rate, rate])
    damping = 3.5e4 * 0.5 * float(grains.mass.mean())
    normal = Luding(5e4, 1e5, 5e4, damping, plastic_depth=0.05) if effects == "luding" else Linear(1e5, damping)
    friction = None if effects == "frictionless" else Friction(2e4, 0.5, damping=0.5 * damping)
    return Simulation(grains, normal, friction, boundary=Periodic(side, side, stretch_rate=(-rate, rate)), dt=STEP, ledger=ledger)


def dem_benchmark(position, radius, side, effects, steps, warmup=300, rate=5.0, ledger=False):
    """The work of `steps` steps after `warmup` untimed ones, a dict: particle_steps_per_s, seconds, pairs and contacts a grain, ...

    first_step_s is the processor time from the start of the process to the end of the first step, compilation included; rebuilds and
    late_builds count neighbour lists in the timed part; bytes_per_grain is the memory of the state.
    """
    checked("bench", "--steps", steps, at_least=1)
    checked("bench", "--warmup", warmup, at_least=0)
    simulation = sheared_packing(position, radius, side, effects, checked("bench", "--rate", rate, unit="1/s"), ledger)
    simulation.run(1)
    first_step = time.process_time()
    simulation.run(warmup)
    before = simulation.counters
    clock = time.perf_counter()
    simulation.run(steps)
    seconds = time.perf_counter() - clock
    after = simulation.counters
    n = len(radius)
    return {
        "effects": effects,
        "ledger": ledger,
        "grains": n,
        "dimension": 2,
        "steps": steps,
        "seconds": seconds,
        "particle_steps_per_s": n * steps / seconds,
        "pairs_per_grain": after["pairs"] / n,
        "contacts_per_grain": len(simulation.snapshot().overlap) / n,
        "rebuilds": after["builds"] - before["builds"],
        "late_builds": after["late_builds"] - before["late_builds"],
        "bytes_per_grain": simulation.bytes_per_grain(),
        "first_step_s": first_step,
    }
