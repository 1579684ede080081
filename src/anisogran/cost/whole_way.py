"""What accuracy costs on the whole way: runs of the main job in which one knob at a time is turned, and what each leaves in the answers.

Causes are of two kinds. Chance (few grains, little travel or strain) is the scatter of repetitions. What a knob does to the mean (time
step, loading rate, few grains) is found from runs of the same seeds at several values, as the slope of the answers against the power of the
knob that theory gives; coarse values are there to make it stand out of the chance, which is all that is left of it where the uncertainty
is as large as the error. Grains in contact are chaotic: no two runs can be compared step by step.
"""

from dataclasses import replace

from anisogran.benchmark.ring_flows import LAWS, RING
from anisogran.continuum import RingFlow
from anisogran.cost.box_errors import box_errors
from anisogran.cost.budget import KNOBS, Budget
from anisogran.cost.cases import done_cases
from anisogran.cost.machine import measured_on
from anisogran.cost.main_job import MainJob, Price
from anisogran.cost.ring_errors import ring_errors
from anisogran.cost.tables import row
from anisogran.cost.timing import clocked, timed
from anisogran.scenes.changes import changed


def whole_way_cost(quick=False):
    """Rows {knob, value, error, seconds, default} for the whole way, a list; processor seconds.

    The whole of it takes about an hour on one core; `quick` runs a small job, whose budget is rough. What was measured once comes with the
    package, see `measured_budget`.
    """
    job = small_job() if quick else MainJob()
    fine = measured_job(job)
    budget, curves = budget_of({name: done_cases(*one) for name, one in sweeps_of(fine, quick).items()}, fine)
    return whole_way_rows(budget, curves, job)


def small_job():
    """The small MainJob, smaller still: its budget is made of some sixty runs."""
    job = MainJob.small()
    return replace(
        job,
        biaxial=changed(job.biaxial, {"n": 100, "duration": 0.01}),
        ring=changed(job.ring, {"travel": 8.0, "block": 1.0}),
        shear=changed(job.shear, {"n": 50, "strain": 2.0, "discard": 0.8}),
        inertial_numbers=job.inertial_numbers[::4],
    )


def measured_job(job):
    """The job around which a budget is measured: with finer time steps than it has itself, so that the best answers are better."""
    return job.turned({"ring.contact_steps": 20.0, "shear.contact_steps": 20.0})


def whole_way_rows(budget, curves, job):
    """The rows of a Budget and the Curves it was made of: the curves; the budget of each answer of a job, and what the next second buys."""
    paces, misfits = budget.made["seconds_per_grain_step"], budget.made["misfits"]
    price, rows, usual = price_of(budget, job), [], job.knobs(KNOBS)
    for curve in curves:
        knob = f"{curve.answer}: {curve.cause}, {curve.knob}"
        rows += [row(knob, value, error, work * paces[curve.kind], value == usual[curve.knob]) for value, error, work in curve.points]
    for answer in budget.names:
        whole = row(f"{answer}: budget at the defaults", "all together", budget.error(answer, usual), price(usual))
        rows += [*(whole | {"value": source.cause, "error": error} for source, error in budget.parts(answer, usual)), whole]
        for name, _ in budget.next_second(answer, usual, price):
            choice = usual | {name: KNOBS[name].turned(usual[name])}
            rows.append(row(f"{answer}: one knob a fifth up, best first", name, budget.error(answer, choice), price(choice)))
    told = "v_phi of the continuum: what the law itself leaves to the grains"
    return [*rows, *(row(told, law, error, price(usual), law == "nonlocal") for law, error in misfits.items())]


def price_of(budget, job):
    """The Price of a job on the machine where a Budget was measured."""
    return Price(job, budget.made["seconds_per_grain_step"], budget.made["seconds_per_element"])


def sweeps_of(job, quick=False):
    """{name: (experiment, what is varied)} for a MainJob: the usual knobs, and each turned by itself; `quick` by one value only."""
    many, seeds, few, keep = (3, 2, 2, slice(-1, None)) if quick else (8, 6, 3, slice(None))
    box, ring, shear = job.biaxial, changed(job.ring, {"frames": 0}), changed(job.shear, {"frames": 0})
    short = changed(ring, {"travel": ring.discard + 5 * ring.block})
    tests = {"inertial_number": list(job.inertial_numbers)}

    def some(count):
        return {"seed": list(range(1, count + 1))}

    return {
        "box": (box, some(many)),
        "box_n": (box, {"n": [box.n // 4, box.n // 2, 2 * box.n][keep]} | some(seeds)),
        "box_steps": (box, {"contact_steps": [5.0, 20.0][keep]} | some(seeds)),
        "box_duration": (box, {"duration": [box.duration / 4, box.duration / 2][keep]} | some(seeds)),
        "shear": (shear, tests | some(seeds)),
        "shear_half": (changed(shear, {"strain": 0.5 * (shear.strain + shear.discard)}), tests | some(seeds)),
        "shear_steps": (shear, {"contact_steps": [5.0, 10.0][keep]} | tests | some(few)),
        "ring": (changed(ring, {"travel": ring.discard + 10 * ring.block}), some(few if quick else few + 1)),
        "ring_steps": (short, {"contact_steps": [5.0, 10.0][keep]} | some(few)),
        "ring_samples": (changed(short, {"seed": 1}), {"samples_per_diameter": [2 * ring.samples_per_diameter]}),
    }


def budget_of(sweeps, job):
    """(Budget, Curves) of the Cases {sweep: [Case]} of `sweeps_of` a job."""
    of_box, box_curves, best = box_errors(sweeps)
    of_ring, ring_curves, profiles, misfits = ring_errors(sweeps, job.ring.travel)
    best |= profiles
    made = {**measured_on(), **paces(job), "misfits": misfits}
    answers, own = ({name: pair[k] for name, pair in best.items()} for k in (0, 1))
    lost = {"ring.travel": job.ring.discard, "shear.strain": job.shear.discard}
    return Budget((*of_box, *of_ring), job.knobs(KNOBS), lost, answers, own, made), [*box_curves, *ring_curves]


def paces(job):
    """What this machine takes, in processor seconds without compilation: for a grain and a step of each kind of experiment, averages
    included; for an element of the continuum; and beside them its `machine_speed`."""
    short = changed(job.ring, {"travel": job.ring.discard + job.ring.block})
    found = {}
    for scene, small in ((short, MainJob.small().ring), (job.biaxial, MainJob.small().biaxial), (job.shear, MainJob.small().shear)):
        small.run()  # compiles
        run, seconds = clocked(scene.run)
        found[scene.kind] = seconds / run.provenance["grain_steps"]
    problem = RingFlow(law=LAWS["nonlocal"], **RING)
    per_element = timed(problem.solve, 3)[1] / problem.elements_along()
    return {"seconds_per_grain_step": found, "seconds_per_element": per_element, "grain_steps_per_second": machine_speed()}


def machine_speed():
    """Grain-steps a second of a small shear test in its time loop: prices are scaled with it from machine to machine."""
    return MainJob.small().shear.run().provenance["particle_steps_per_s"]
