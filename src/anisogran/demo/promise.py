"""What the demo promises for an accuracy, by the error budget that was measured once, and whether it kept that."""

import math
from dataclasses import dataclass, replace

from anisogran.cost.answers import continuum_velocity, grain_velocity
from anisogran.cost.budget import Budget, measured_budget
from anisogran.cost.main_job import MainJob
from anisogran.cost.ring_errors import CONTINUUM, GRAINS
from anisogran.cost.whole_way import machine_speed, price_of
from anisogran.demo.grains import shared_out

REST = 10.0  # s of the machine of the budget: starting processes, laws, continuum, pictures; compilation comes on top in a first run
FACTOR = 2.0  # within which a promise is kept


@dataclass(frozen=True)
class Promise:
    """An accuracy, the choice of knobs for it and the MainJob with them, expected relative errors by answer, and expected seconds."""

    accuracy: float
    budget: Budget
    choice: dict
    job: MainJob
    errors: dict
    seconds: float

    def text(self):
        """What is promised, two lines, and what of it cannot be checked, one more."""
        knobs = ", ".join(f"{name} = {value:g}" for name, value in self.choice.items())
        errors = ", ".join(f"{name} {error:.2g}" for name, error in self.errors.items())
        worse = ", ".join(f"{name} {own:.2g}" for name, own in self.budget.own_errors.items() if own > self.errors[name])
        limit = f"\nthe best answers known err more themselves, so that this cannot be checked: {worse}" if worse else ""
        return f"accuracy {self.accuracy:g}: {knobs}\nexpected: {self.seconds:.0f} s; relative errors of {errors}{limit}"

    def held_against(self, findings, seconds):
        """The Findings of its job, done in `seconds`, with what became of the promise."""
        numbers, ring = findings.numbers, findings.ring
        answers = {
            "s_max": numbers["s_max"],
            "phi": math.radians(numbers["friction_angle_peak_deg"]),
            "mu_s": numbers["mu_s"],
            "b": numbers["b"],
            GRAINS: grain_velocity(ring),
            CONTINUUM: continuum_velocity(ring, findings.flows["nonlocal"]),
        }
        kept = Kept(self, {name: self.budget.deviation(name, answers[name]) for name in self.errors}, seconds)
        reasons = [*findings.reasons, *(f"accuracy: {reason}" for reason in kept.reasons())]
        return replace(findings, kept=kept, numbers=numbers | {"accuracy": kept.as_dict()}, reasons=reasons)


@dataclass(frozen=True)
class Kept:
    """How far each answer of a demo is from the best one that is known, and what time it took, beside its promise."""

    promise: Promise
    found: dict
    seconds: float

    def expected(self, answer):
        """What the difference is expected to be: the error of the demo, and that of the best answer itself."""
        return math.hypot(self.promise.errors[answer], self.promise.budget.own_errors[answer])

    def reasons(self):
        """A sentence for each promise that was not kept within a factor of two; an answer that is nearer than promised is none."""
        for name, found in self.found.items():
            if not found <= FACTOR * self.expected(name):  # also one that is NaN
                yield f"{name} is off by {found:.2g}, expected were {self.expected(name):.2g}"
        if not self.promise.seconds / FACTOR <= self.seconds <= FACTOR * self.promise.seconds:
            yield f"it took {self.seconds:.0f} s, expected were {self.promise.seconds:.0f} s"

    def as_dict(self):
        """For --json: what was asked, chosen, expected and found."""
        return {
            "accuracy": self.promise.accuracy,
            "knobs": self.promise.choice,
            "expected": {name: self.expected(name) for name in self.found},
            "found": self.found,
            "expected_s": self.promise.seconds,
            "took_s": self.seconds,
            "kept": not list(self.reasons()),
        }

    def text(self):
        """What came of it, a line."""
        words = ", ".join(f"{name} {found:.2g} ({self.expected(name):.2g})" for name, found in self.found.items())
        return f"found (expected): {self.seconds:.0f} s ({self.promise.seconds:.0f} s); off by {words}"


def promised(accuracy, seed):
    """The Promise of a demo with that seed on this machine, whose speed is measured first.

    Raises InputError for an accuracy that cannot be had, with the best one.
    """
    budget = measured_budget()
    price = price_of(budget, MainJob(seed))
    choice = budget.choose(accuracy, price)
    job = MainJob(seed).turned(choice)
    slowness = budget.made["grain_steps_per_second"] / machine_speed()
    longest = max(sum(map(price.of_run, experiments)) for experiments in shared_out(job.experiments()))
    errors = {name: budget.error(name, choice) for name in budget.names}
    return Promise(accuracy, budget, choice, job, errors, slowness * (longest + REST))
