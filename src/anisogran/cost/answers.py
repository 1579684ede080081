"""The answers of the main job whose errors are told: s_max and phi of a box, the velocity of a ring, of grains and of the continuum.

All are plain numbers or lists of them: s_max of the exponential law, phi the mobilised friction angle at the peak in rad, velocities over
the speed of the inner ring. The continuum's is the end of the way: friction law from homogeneous shear, amplitude from the ring. Beside
them mu_s and b of that law.
"""

import numpy as np

from anisogran import fitting
from anisogran.comparison.measures import near
from anisogran.models import mobilised_angle

DEPTHS = np.linspace(0.0, 8.0, 33)  # mean diameters from the inner ring, where the velocity of the continuum is told


def box_answers(series):
    """s_max and phi of the series of a biaxial test."""
    fit = fitting.relaxation(series.eps_D.values, series.s_D.values)
    peak = fitting.peak(series.eps_zz.values, series.s_D.values).value
    return {"s_max": fit.values["s_max"], "phi": float(mobilised_angle(peak))}


def grain_velocity(run):
    """v_phi of the rings of a RingShear run nearer than 8 d, over the wall speed, (rings,)."""
    return run.profiles.v_phi.values[near(run.profiles)] / run.scene.wall_speed


def continuum_velocity(run, flow, depths=DEPTHS):
    """v_phi of a Flow at depths from the inner ring of the run, over the wall speed."""
    scene = run.scene
    return np.asarray(flow.at(scene.inner_radius + scene.mean_diameter * depths).v_phi) / scene.wall_speed
