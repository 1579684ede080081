"""What accuracy costs in the time step of the grains: collisions and a relaxing chain beside their closed forms, and the biaxial peak."""

import math

import numpy as np

from anisogran.cost.tables import row
from anisogran.cost.timing import clocked
from anisogran.dem import Friction, Grains, Linear, Luding, Periodic, Simulation, collision_time
from anisogran.experiments import Biaxial

STEPS = (5, 10, 20, 50, 100, 200)  # in a contact time
DEFAULT = 20  # of ring and simple shear
DASHPOT, HYSTERETIC = Linear(stiffness=1e4, damping=10.0), Luding(k1=6.4e3, k2=1e4)  # both with restitution 0.80
LAWS = {"dashpot": DASHPOT, "hysteresis": HYSTERETIC}
PAIRS = 1000
CHAIN, MODE, SQUEEZED, SWING = 1000, 250, 0.01, 1e-3  # grains, waves along the chain, overlap and amplitude in diameters
BOX = {"n": 400, "strain": 0.06, "duration": 0.02, "wall_mass": 2e-5, "wall_damping": 0.02, "samples": 60}
QUICK = {"n": 60, "strain": 0.03, "samples": 20}
SMOOTHED = 3  # rows over which the peak is averaged
EARLY = 0.02  # vertical strain up to which the elastic energy is averaged


def time_step_rows(quick):
    """Rows of error against steps in a contact time; processor seconds of the time loop, for the box those of a whole test."""
    rows = []
    for name, law in LAWS.items():
        entries = [(n, *restitution(law, n)) for n in STEPS]
        rows += [row(f"steps in a contact time: restitution, {name}, worst phase", n, error, s, n == DEFAULT) for n, error, s in entries]
    entries = [(n, *relaxation(n)) for n in STEPS]
    rows += [row("steps in a contact time: relaxation of a damped chain", n, error, s, n == DEFAULT) for n, error, s in entries]
    return rows + peak_rows(quick)


def restitution(law, steps):
    """(error, seconds) of the restitution in head-on impacts of 1,000 pairs of mass 1, the worst of all phases of a step."""
    duration = collision_time(law, np.ones(2))
    if isinstance(law, Luding):  # loads on k1, unloads on k2; shorter than on k1 alone
        duration = 0.5 * math.pi * math.sqrt(0.5) * (1 / math.sqrt(law.k1) + 1 / math.sqrt(law.k2))
    dt = collision_time(law, np.ones(2)) / steps
    line = 3.0 * np.arange(PAIRS)
    gap = dt * np.arange(PAIRS) / PAIRS
    left, right = np.stack([10.0 + 0 * line, line], axis=1), np.stack([11.0 + gap, line], axis=1)
    velocity = np.repeat([[0.5, 0.0], [-0.5, 0.0]], PAIRS, axis=0)
    grains = Grains(np.concatenate([left, right]), np.full(2 * PAIRS, 0.5), mass=np.ones(2 * PAIRS), velocity=velocity)
    simulation = Simulation(grains, law, boundary=Periodic(21.0, 3.0 * PAIRS), dt=dt, allow_coarse_dt=True)
    simulation.compile()
    _, seconds = clocked(lambda: simulation.run(math.ceil(2 * duration / dt) + 2))
    speed = simulation.velocity[PAIRS:, 0] - simulation.velocity[:PAIRS, 0]
    return float(np.abs(speed / exact_restitution(law) - 1.0).max()), seconds


def exact_restitution(law):
    """Of two grains of mass 1 at relative speed 1: exp(-damping t_c/(2 m12)) of a dashpot, sqrt(k1/k2) of hysteresis without one."""
    if isinstance(law, Luding):
        return math.sqrt(law.k1 / law.k2)
    return math.exp(-law.damping * collision_time(law, np.ones(2)) / (2 * 0.5))


def relaxation(steps):
    """(error, seconds) of a standing wave in a squeezed periodic chain with dashpots, until it is down to a tenth.

    All contacts stay closed, so that the amplitude of a wave of so many crests is that of one damped oscillator with
    omega^2 = 4 k/m sin^2(q/2) and the decay rate 2 damping/m sin^2(q/2); the error is relative to the amplitude at the start.
    """
    wave = 2.0 * math.pi * MODE / CHAIN
    inertia = 4.0 * math.sin(0.5 * wave) ** 2  # over the mass, which is 1
    decay, omega = 0.5 * DASHPOT.damping * inertia, math.sqrt(DASHPOT.stiffness * inertia)
    swing = math.sqrt(omega**2 - decay**2)
    dt = collision_time(DASHPOT, np.ones(2)) / steps
    rest = (1.0 - SQUEEZED) * (0.5 + np.arange(CHAIN))
    shape = SWING * np.cos(wave * np.arange(CHAIN) + 0.3)
    grains = Grains(np.stack([rest + shape, np.full(CHAIN, 2.5)], axis=1), np.full(CHAIN, 0.5), mass=np.ones(CHAIN))
    simulation = Simulation(grains, DASHPOT, boundary=Periodic((1.0 - SQUEEZED) * CHAIN, 5.0), dt=dt, allow_coarse_dt=True)
    simulation.compile()
    count = math.ceil(math.log(10.0) / decay / dt)
    _, seconds = clocked(lambda: simulation.run(count))
    t = count * dt
    left = math.exp(-decay * t) * (math.cos(swing * t) + decay / swing * math.sin(swing * t))
    moved = simulation.position[:, 0] - rest
    return float(np.abs(moved - left * shape).max() / SWING), seconds


def peak_rows(quick):
    """Errors of the peak of s_D and of the elastic energy before it in a small box, means over seeds, against a quarter of the default
    step; grains in contact are chaotic, so that the scatter between seeds bounds what can be told: quick, it is all that is seen."""
    seeds, box = (range(2), BOX | QUICK) if quick else (range(6), BOX)
    usual = Biaxial.model_fields["contact_steps"].default
    series, seconds = {}, {}
    for count in (0.5 * usual, usual, 2 * usual, 4 * usual):
        scenes = [Biaxial(**box, friction=Friction(2e4, 0.5), contact_steps=count, seed=seed) for seed in seeds]
        if not series:
            scenes[0].run()  # compiles
        runs, time = clocked(lambda scenes=scenes: [scene.run() for scene in scenes])
        series[count], seconds[count] = [run.series for run in runs], time / len(seeds)
    rows = []
    for name, quantity in {"peak": peak, "elastic energy before the peak": early_energy}.items():
        means = {count: np.array([quantity(one) for one in some]) for count, some in series.items()}
        exact = means.pop(4 * usual)
        own = np.std(exact, ddof=1) / math.sqrt(len(exact)) / np.mean(exact)
        told = f"{len(seeds)} seeds, reference {4 * usual:g} good to {own:.0e}{', all scatter' if quick else ''}"
        knob = f"steps in a contact time: {name}, biaxial box of {box['n']}, {told}"
        rows += [row(knob, n, float(abs(np.mean(one) / np.mean(exact) - 1.0)), seconds[n], n == usual) for n, one in means.items()]
    return rows


def peak(series):
    """The largest s_D of a biaxial series, averaged over a few rows."""
    return float(np.convolve(series.s_D.values, np.full(SMOOTHED, 1.0 / SMOOTHED), "valid").max())


def early_energy(series):
    """The mean elastic energy up to EARLY vertical strain, J."""
    return float(series.elastic_energy.values[series.eps_zz.values <= EARLY].mean())
