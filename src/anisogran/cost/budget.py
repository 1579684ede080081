"""The error budget of the main job: what each of its knobs leaves in each of its answers, and how to turn them for an accuracy.

What one knob leaves goes as a power of its value, and the causes are independent, so that their squares add. The sizes are measured
(cost/whole_way.py) and come with the package; the powers are those of theory: a half for chance, one for the time step of a damped
contact, the rate and the number of grains, three for quadratic elements.
"""

import json
import math
from dataclasses import dataclass, field, fields
from importlib.resources import files

import numpy as np

from anisogran.cost.sources import size
from anisogran.outcome import InputError, checked

MEASURED = "whole_way.json"  # beside this file, made by data_generation/whole_way.py
STEP = 1.2  # by which a knob is turned at a time


@dataclass(frozen=True)
class Knob:
    """A number of the main job that can be turned between bounds."""

    name: str
    lowest: float
    highest: float
    whole: bool = False

    def turned(self, value):
        """The next value, or None at the end."""
        more = float(f"{STEP * value:.3g}")
        more = max(round(more), value + 1) if self.whole else more
        return more if more <= self.highest else None


KNOBS = {  # no lower than what was measured
    knob.name: knob
    for knob in (
        Knob("ring.travel", 120.0, 10_000.0),
        Knob("ring.contact_steps", 10.0, 200.0),
        Knob("biaxial.n", 250, 2000, whole=True),
        Knob("biaxial.contact_steps", 5.0, 200.0),
        Knob("biaxial.duration", 0.125, 4.0),
        Knob("boxes", 1, 1000, whole=True),
        Knob("shear.strain", 2.75, 1000.0),
        Knob("shear.contact_steps", 12.0, 200.0),
        Knob("elements", 64, 1024, whole=True),
    )
}
LEAST = {knob.name: knob.lowest for knob in KNOBS.values()}


@dataclass(frozen=True)
class Source:
    """One cause of error in one answer: `error`, relative, where it was measured, and known to +- `uncertainty`.

    It goes as the product of its `knobs`, over their values there, to the power -order; without knobs nothing buys it off.
    """

    answer: str
    cause: str
    error: float
    uncertainty: float
    knobs: tuple = ()
    order: float = 0.0


@dataclass(frozen=True)
class Budget:
    """All sources, and the knobs {name: value} at which they were measured.

    `lost` {name: value} goes by before a knob helps, such as the travel of a transient. Beside them the best `answers` {name: number or
    list} and what these err by themselves, by chance: what a knob does to their mean is the same in a choice with the same knobs, and
    not seen by comparing them. `made` says where, when and how fast.
    """

    sources: tuple
    knobs: dict
    lost: dict = field(default_factory=dict)
    answers: dict = field(default_factory=dict)
    own_errors: dict = field(default_factory=dict)
    made: dict = field(default_factory=dict)

    @property
    def names(self):
        """The answers that have sources."""
        return tuple(dict.fromkeys(source.answer for source in self.sources))

    def ratio(self, name, choice):
        """How much more a choice has of a knob than where it was measured."""
        lost = self.lost.get(name, 0.0)
        return (choice[name] - lost) / (self.knobs[name] - lost)

    def error_of(self, source, choice):
        """What a cause leaves at a choice {name of knob: value}."""
        return source.error * math.prod(self.ratio(name, choice) for name in source.knobs) ** -source.order

    def parts(self, answer, choice):
        """[(source, its error)] of an answer, the largest first."""
        own = [(source, self.error_of(source, choice)) for source in self.sources if source.answer == answer]
        return sorted(own, key=lambda part: -part[1])

    def error(self, answer, choice):
        """The expected relative error of an answer."""
        return math.hypot(*(error for _, error in self.parts(answer, choice)))

    def deviation(self, answer, value):
        """The relative difference of a number, or in L2 of a profile, from the best answer; a profile may have more points than that."""
        best = np.asarray(self.answers[answer], float)
        value = np.asarray(value, float)[: len(best)] if best.ndim else value
        return size(value - best, best)

    def excess(self, choice, accuracy):
        """How far the squares of all answers are above that of the accuracy, summed."""
        return sum(max(0.0, self.error(name, choice) ** 2 - accuracy**2) for name in self.names)

    def gain(self, before, after, accuracy, price):
        """Excess taken away by a second."""
        return (self.excess(before, accuracy) - self.excess(after, accuracy)) / (price(after) - price(before))

    def choose(self, accuracy, price):
        """{name of knob: value} at which no answer is expected to err by more than `accuracy`, for little.

        `price(choice)` gives seconds. From the lowest values up, that knob is turned a step which takes away most for a second of what
        is still too much: where all answers are powers this ends at the cheapest choice but for the size of the steps. Raises
        InputError, with the best that can be had, for an accuracy that no choice reaches.
        """
        checked("choose", "accuracy", accuracy, above=0, below=1)
        choice = dict(LEAST)
        while self.excess(choice, accuracy) > 0:
            options = [choice | {name: more} for name, knob in KNOBS.items() if (more := knob.turned(choice[name])) is not None]
            best = max(options, key=lambda option: self.gain(choice, option, accuracy, price), default=None)
            if best is None or not self.gain(choice, best, accuracy, price) > 0:
                worst = max(self.names, key=lambda name: self.error(name, choice))
                cause, least = self.parts(worst, choice)[0][0].cause, rounded_up(self.error(worst, choice))
                raise InputError(f"accuracy = {accuracy:g}: {worst} cannot be had better than {least} ({cause})")
            choice = best
        return choice

    def next_second(self, answer, choice, price):
        """[(name of knob, how much the error of the answer falls, relative, for a second more)], the best first."""
        found = []
        for name, knob in KNOBS.items():
            if (more := knob.turned(choice[name])) is not None:
                turned = choice | {name: more}
                fall = 1.0 - self.error(answer, turned) / self.error(answer, choice)
                if fall > 0:
                    found.append((name, fall / (price(turned) - price(choice))))
        return sorted(found, key=lambda entry: -entry[1])

    def as_dict(self):
        """Numbers, words and lists only, for a file."""
        return vars(self) | {"sources": [vars(source) for source in self.sources]}


def rounded_up(number):
    """Two digits that are not below the number, as text."""
    scale = 10.0 ** (1 - math.floor(math.log10(number)))
    return f"{math.ceil(number * scale - 1e-9) / scale:.2g}"


def budget_from(content):
    """The Budget of what `as_dict` made; what else there is in it is left aside."""
    sources = tuple(Source(**source | {"knobs": tuple(source["knobs"])}) for source in content["sources"])
    return Budget(**{one.name: content[one.name] for one in fields(Budget)} | {"sources": sources})


def measured_budget():
    """The Budget that comes with the package. Raises InputError if its file is missing or damaged."""
    path = files("anisogran.cost").joinpath(MEASURED)
    try:
        return budget_from(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: is missing or damaged ({type(error).__name__}: {error}); install anisogran anew") from None
