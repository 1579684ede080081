"""What errs in s_max and phi of a biaxial test: chance, few grains, time step, rate of loading, and the points of the fit."""

import numpy as np

from anisogran.cost.answers import box_answers
from anisogran.cost.budget import Source
from anisogran.cost.cases import Curve, by_value, left_out, turned, work_of
from anisogran.cost.sources import CHANCE, FIRST, chance

ANSWERS = ("s_max", "phi")
REPEATED = ("biaxial.n", "boxes")  # the knobs of chance
TURNED = {  # sweep: (cause, knob, key, order); a curve that is fitted through noise is biased by the square of the noise
    "box_n": ("few grains", "biaxial.n", "n", FIRST),
    "box_steps": ("time step", "biaxial.contact_steps", "contact_steps", FIRST),
    "box_duration": ("rate of loading", "biaxial.duration", "duration", FIRST),
}


def box_errors(sweeps):
    """(sources, curves, {answer: (the best value, its own relative error)}) of the Cases {sweep: [Case]} of a box."""
    told = {id(case): box_answers(case.group("series")) for name in ("box", *TURNED) for case in sweeps[name]}
    boxes, sources, curves, best = sweeps["box"], [], [], {}
    thinned = [box_answers(case.group("series").isel(time=slice(None, None, 2))) for case in boxes]
    good = at_least([case for name in ("box", *TURNED) for case in sweeps[name]], boxes[0].scene)
    for answer in ANSWERS:
        values = [told[id(case)][answer] for case in boxes]
        error, uncertainty, measured = chance(values, [count for count in (1, 2, 4) if 2 * count <= len(values)])
        sources.append(Source(answer, "chance", error, uncertainty, REPEATED, CHANCE))
        grains = [case.scene.n for case in good]
        own = error * (boxes[0].scene.n / sum(grains)) ** CHANCE
        best[answer] = float(np.average([told[id(case)][answer] for case in good], weights=grains)), own
        points = [(count, error, count * work_of(boxes)) for count, error in measured]
        curves.append(Curve(answer, "chance", "boxes", boxes[0].scene.kind, points))
        for name, (cause, knob, key, order) in TURNED.items():
            groups = by_value([*sweeps[name], *boxes], key)
            over = [[told[id(case)][answer] for case in cases] for cases in groups.values()]
            source, curve = turned(answer, cause, knob, order, groups, over, getattr(boxes[0].scene, key))
            sources.append(source)
            curves.append(curve)
        sources.append(left_out(answer, "points of the fit", values, [one[answer] for one in thinned], REPEATED))
    return sources, curves, best


def at_least(cases, usual):
    """The cases whose knobs are all as high as usual, or higher."""
    return [case for case in cases if all(getattr(case.scene, key) >= getattr(usual, key) for _, _, key, _ in TURNED.values())]
