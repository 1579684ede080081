"""What errs in the friction law and in the velocity of a ring, of grains and of the continuum that is calibrated on it: the end of the way.

The continuum gets its friction law from homogeneous shear and its amplitude from the ring. Chance in the ring, its time step, and the
samples of its averages reach it through the amplitude; chance and the time step of the shear tests through mu_s and b. One of the two is
held while the other varies. An amplitude that is fitted anew takes up nearly all of what mu_s and b err.
"""

import math
from dataclasses import replace
from functools import cached_property

import numpy as np
import xarray as xr

from anisogran.comparison import fitted_amplitude, homogeneous_friction, measured, ring_flow
from anisogran.comparison.measures import near, near_l2, ring_edges
from anisogran.continuum import LocalMuI
from anisogran.cost.answers import DEPTHS, continuum_velocity, grain_velocity
from anisogran.cost.budget import Source
from anisogran.cost.cases import Curve, by_value, left_out, turned, work_of
from anisogran.cost.sources import CHANCE, FIRST, chance, size

GRAINS, CONTINUUM = "v_phi of the grains", "v_phi of the continuum"
MESH = 3.0  # order of the velocity in quadratic elements


class Rings:
    """The ring runs, and the two answers of each, on as many rings as all have; `weights` of their points are the radii."""

    def __init__(self, sweeps):
        self.cases = {name: sweeps[name] for name in ("ring", "ring_steps", "ring_samples")}
        self.runs = {id(case): measured(case.results) for cases in self.cases.values() for case in cases}
        self.law = np.mean(friction_laws(sweeps["shear"]), axis=0)
        self.scene = sweeps["ring"][0].scene
        self.rings = min(int(near(run.profiles).sum()) for run in self.runs.values())
        self.depths = DEPTHS[self.rings >= DEPTHS]
        inner = self.scene.inner_radius / self.scene.mean_diameter
        self.weights = {GRAINS: inner + 0.5 + np.arange(self.rings), CONTINUUM: inner + self.depths}

    def usual(self):
        """The runs with the usual knobs."""
        return [self.runs[id(case)] for case in self.cases["ring"]]

    def flow(self, run, law=None):
        """The Flow of the continuum whose amplitude suits the run, with mu_s and b of a law or the usual ones."""
        return ring_flow(run, fitted_amplitude(run, *(self.law if law is None else law)).law).solve()

    @cached_property
    def usual_flows(self):
        """The flow of each of the usual runs."""
        return [self.flow(run) for run in self.usual()]

    def answer(self, name, run):
        """An answer of a run, (points,)."""
        return grain_velocity(run)[: self.rings] if name == GRAINS else self.velocity(run, self.flow(run))

    def velocity(self, run, flow):
        """v_phi of the continuum, (points,)."""
        return continuum_velocity(run, flow, self.depths)


def friction_laws(tests):
    """[(mu_s, b)] of each seed, from Cases of homogeneous shear at several inertial numbers."""
    found = []
    for seed in sorted({case.scene.seed for case in tests}):
        steady = xr.concat([case.group("steady") for case in tests if case.scene.seed == seed], "test")
        fit = homogeneous_friction(steady)
        found.append((fit.values["mu_s"], fit.values["b"]))
    return found


def averaged_over(run, begin, end):
    """The run as it would be known from some of its blocks alone."""
    v_phi = run.blocks.v_phi.isel(block=slice(begin, end)).mean("block").assign_attrs(run.profiles.v_phi.attrs)
    return replace(run, profiles=run.profiles.assign(v_phi=v_phi), blocks=None)


def ring_errors(sweeps, usual_travel):
    """(sources, curves, {answer: (the best profile, its own relative error)}, {law: misfit}) of Cases {sweep: [Case]} of rings and of
    homogeneous shear.

    `usual_travel` is that of the main job. The misfits between grains and continuum, relative L2, are left whatever the knobs.
    """
    rings = Rings(sweeps)
    found = [
        *(part(rings, answer, usual_travel) for part in (chance_in_ring, time_step, samples) for answer in (GRAINS, CONTINUUM)),
        *shear_errors(rings, sweeps),
        *mesh_errors(rings),
    ]
    sources = [source for source, _ in found]
    repeated = {  # of chance, how often the usual amount stands behind the best profile
        "ring.travel": len(rings.usual()) * (rings.scene.travel - rings.scene.discard) / (usual_travel - rings.scene.discard),
        "shear.strain": len(friction_laws(sweeps["shear"])),
    }
    best = {"mu_s": float(rings.law[0]), "b": float(rings.law[1])}
    best[GRAINS] = np.mean([rings.answer(GRAINS, run) for run in rings.usual()], axis=0).tolist()
    flows = zip(rings.usual(), rings.usual_flows, strict=True)
    best[CONTINUUM] = np.mean([rings.velocity(run, flow) for run, flow in flows], axis=0).tolist()
    for answer, value in best.items():
        own = [source.error**2 / repeated[source.knobs[0]] for source in sources if source.answer == answer and source.order == CHANCE]
        best[answer] = value, math.sqrt(sum(own))
    return sources, [curve for _, curve in found if curve is not None], best, misfits(rings)


def chance_in_ring(rings, answer, usual_travel):
    """(Source, Curve) of averages over little travel; the continuum is calibrated on pairs of blocks."""
    scene, group = rings.scene, 1 if answer == GRAINS else 2
    starts = [(run, k) for run in rings.usual() for k in range(0, run.blocks.sizes["block"] - group + 1, group)]
    parts = [averaged_over(run, k, k + group) for run, k in starts]
    usual = (usual_travel - scene.discard) / scene.block / group
    error, uncertainty, measured = chance([rings.answer(answer, part) for part in parts], (1, 2, 4), usual, rings.weights[answer])
    work = work_of(rings.cases["ring"]) / scene.travel
    travels = [scene.discard + count * group * scene.block for count, _ in measured]
    points = [(travel, error, travel * work) for travel, (_, error) in zip(travels, measured, strict=True)]
    knob = "ring.travel"
    return Source(answer, "chance", error, uncertainty, (knob,), CHANCE), Curve(answer, "chance", knob, scene.kind, points)


def time_step(rings, answer, usual_travel):
    """(Source, Curve) of the time step of the grains; of the longer runs as many blocks are taken."""
    groups = by_value([*rings.cases["ring_steps"], *rings.cases["ring"]], "contact_steps")
    blocks = min(rings.runs[id(case)].blocks.sizes["block"] for cases in groups.values() for case in cases)
    values = [[rings.answer(answer, averaged_over(rings.runs[id(case)], 0, blocks)) for case in cases] for cases in groups.values()]
    usual = {
        value: [case._replace(grain_steps=case.grain_steps * usual_travel / case.scene.travel) for case in cases]
        for value, cases in groups.items()
    }
    knob = "time step", "ring.contact_steps", FIRST
    return turned(answer, *knob, usual, values, rings.scene.contact_steps, rings.weights[answer])


def samples(rings, answer, usual_travel):
    """(Source, None) of the samples in the averages: the same trajectory, looked at as often as usual, and twice as often.

    What differs is what the more often leaves; as often as usual leaves the root of two times that, and less over more travel.
    """
    dense = max(rings.cases["ring_samples"], key=lambda case: case.scene.samples_per_diameter)
    [usual] = [case for case in rings.cases["ring"] if case.scene.seed == dense.scene.seed]
    blocks = rings.runs[id(dense)].blocks.sizes["block"]
    every, fewer = ([rings.answer(answer, averaged_over(rings.runs[id(case)], 0, blocks))] for case in (dense, usual))
    found = left_out(answer, "samples of the averages", every, fewer, ("ring.travel",), rings.weights[answer])
    more = math.sqrt(2.0 * blocks * usual.scene.block / (usual_travel - usual.scene.discard))
    return replace(found, error=more * found.error, uncertainty=more * found.uncertainty), None


def shear_errors(rings, sweeps):
    """[(Source, Curve)] of what homogeneous shear leaves in mu_s and b, and in the continuum that is calibrated on one ring: chance and the
    time step of the tests."""
    run, scene, found = rings.usual()[0], sweeps["shear"][0].scene, []
    steps = by_value([*sweeps["shear_steps"], *sweeps["shear"]], "contact_steps")
    laws = {id(tests): friction_laws(tests) for tests in (sweeps["shear"], sweeps["shear_half"], *steps.values())}
    told = {
        "mu_s": lambda law: law[0],
        "b": lambda law: law[1],
        CONTINUUM: lambda law: rings.velocity(run, rings.flow(run, law)),
    }
    for answer, value in told.items():
        weights = rings.weights.get(answer, 1.0)
        values = {key: [value(law) for law in some] for key, some in laws.items()}
        scatter = {key: chance(some, weights=weights)[0] for key, some in values.items()}
        points = [(tests[0].scene.strain, scatter[id(tests)], work_of(tests)) for tests in (sweeps["shear_half"], sweeps["shear"])]
        # all repetitions are pooled: what a shorter average makes of the usual one, and other time steps, which hardly change chance
        others = [tests for steps_of_contact, tests in steps.items() if steps_of_contact != scene.contact_steps]
        all_tests = [sweeps["shear_half"], sweeps["shear"], *others]
        free = [len(values[id(tests)]) - 1 for tests in all_tests]
        averaged = [(tests[0].scene.strain - scene.discard) / (scene.strain - scene.discard) for tests in all_tests]
        squares = [scatter[id(tests)] ** 2 * share for tests, share in zip(all_tests, averaged, strict=True)]
        error = math.sqrt(np.average(squares, weights=free))
        uncertainty = error / math.sqrt(2.0 * sum(free))
        source = Source(answer, "chance in the tests", error, uncertainty, ("shear.strain",), CHANCE)
        found.append((source, Curve(answer, source.cause, "shear.strain", scene.kind, points)))
        over = [values[id(tests)] for tests in steps.values()]
        of_steps = "time step of the tests", "shear.contact_steps", FIRST
        found.append(turned(answer, *of_steps, steps, over, scene.contact_steps, weights))
    return found


def mesh_errors(rings):
    """[(Source, None)] of the continuum's own numerics: its mesh, and its rate floor."""
    run, weights = rings.usual()[0], rings.weights[CONTINUUM]
    flow = rings.usual_flows[0]
    problem = flow.problem
    found = []
    for cause, changes, knobs, order in (
        ("mesh", {"elements": 2 * problem.elements_along()}, ("elements",), MESH),
        ("rate floor", {"rate_floor": 0.1 * problem.floor}, (), 0.0),
    ):
        better = rings.velocity(run, replace(problem, **changes).solve())
        error = size(rings.velocity(run, flow) - better, better, weights)
        found.append((Source(CONTINUUM, cause, error, 0.0, knobs, order), None))
    return found


def misfits(rings):
    """{law: mean relative L2 difference between the continuum and the rings it is calibrated on}."""
    flows = {"nonlocal": rings.usual_flows, "local": [ring_flow(run, LocalMuI(*rings.law)).solve() for run in rings.usual()]}
    found = {}
    for name, solved in flows.items():
        pairs = zip(rings.usual(), solved, strict=True)
        each = [near_l2(run.profiles, np.asarray(flow.ring_average(ring_edges(run.profiles)).v_phi)) for run, flow in pairs]
        found[name] = float(np.mean(each))
    return found
