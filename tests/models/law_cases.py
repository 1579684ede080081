"""Every law of `LAWS` with parameters, a start and paths, for the hard cases: a new law needs one line in each table, and gets them all."""

import numpy as np

from anisogran.models import LAWS, PointState, biaxial, law_parameters, pure_shear
from hard_case_page import NOT_ASKED

ANISOTROPIC = {"E": 1e5, "B": 5e4, "s_max": 0.3, "A_max": 2e4, "beta_F": 80.0}
PARAMETERS = {
    "scalar": ANISOTROPIC,
    "tensorial": ANISOTROPIC | {"G": 2e4},
    "mohr_coulomb": {"E": 1e5, "G": 2.5e4, "phi": 0.4, "c": 2.0, "phi_residual": 0.3, "psi": 0.1, "beta": 30.0},
    "mu_of_I": {"mu_s": 0.28, "mu_d": 0.5, "I0": 0.3, "phi_max": 0.84, "slope": 0.3, "grain_mass": 1e-5},
}
OF_STRESS = {  # parameters that grow with the unit of stress
    "scalar": ("E", "B", "A_max"),
    "tensorial": ("E", "B", "A_max", "G"),
    "mohr_coulomb": ("E", "G", "c"),
    "mu_of_I": ("grain_mass",),
}
INTERNAL_OF_STRESS = {"A", "A_1", "A_2"}
START = dict.fromkeys(LAWS, 100.0) | {"mu_of_I": {"area_fraction": 0.8}}
NO_MEANING = {one: reason for one, reason in NOT_ASKED.items() if one[1] in LAWS} | {  # (case, law): why it says nothing about the law
    ("O11", "mohr_coulomb"): "it has no anisotropy, and no gradual approach",
    ("O11", "mu_of_I"): "it has no anisotropy",
    ("M2", "scalar"): "it knows no rate",
    ("M2", "tensorial"): "it knows no rate",
    ("M2", "mohr_coulomb"): "it knows no rate",
}


def laws(case):
    """The laws for which a case has a meaning."""
    return [law for law in LAWS if (case, law) not in NO_MEANING]


def state(law, sigma_V=100.0, sigma_1=0.0, sigma_2=0.0, **internal):
    """A PointState with the law's internal variables, those of the start unless given."""
    usual = START[law] if isinstance(START[law], dict) else {}
    inner = {name: internal.get(name, usual.get(name, 0.0)) for name in LAWS[law].INTERNAL if name}
    return PointState(strain(sigma_V, sigma_1, sigma_2), inner)


def strain(eps_V, eps_1, eps_2=0.0):
    """The symmetric tensor (2, 2, ...) of a mean and a deviator."""
    eps_V, eps_1, eps_2 = np.broadcast_arrays(eps_V, eps_1, eps_2)
    return np.array([[eps_V + eps_1, eps_2], [eps_2, eps_V - eps_1]])


def record(law, **change):
    return law_parameters(law, **(PARAMETERS[law] | change))


def scaled(law, scale, values=None):
    """Parameters in a unit of stress that is `scale` times smaller."""
    values = PARAMETERS[law] if values is None else values
    return values | {key: scale * values[key] for key in OF_STRESS[law]}


def shearing(law, amount=0.01):
    """A control that shears along the box: at constant sigma_xx, or at constant volume for a law that has no stress at rest."""
    return biaxial([0.0, amount], 100.0) if LAWS[law].STRESS_IS_STATE else pure_shear([0.0, amount])


def failures(law):
    """{name: (control, start, changed parameters, words of the reason)} of paths that the law cannot follow."""
    if law == "mu_of_I":
        return {
            "jammed": ({"eps_V": [0.0, 0.05], "eps_D": 0.0}, None, {}, "jams"),
            "no stress at rest": ({"sigma_xx": 100.0, "eps_zz": [0.0, 0.01]}, None, {}, "gives way"),
        }
    found = {
        "extension": ({"eps_V": [0.0, -0.01], "eps_D": 0.0}, None, {}, "tension"),
        "unreachable stress": ({"sigma_V": 100.0, "sigma_D": [0.0, 90.0]}, None, {}, "not reachable"),
        "prescribed tension": ({"sigma_V": [100.0, -20.0], "sigma_D": 0.0}, None, {}, "tension"),
    }
    if law == "mohr_coulomb":
        return found | {"brittle": (pure_shear([0.0, 0.01]), None, {"beta": 1e4}, "snap-back")}
    too_far = 1.1 * np.sqrt(PARAMETERS[law]["E"] * PARAMETERS[law]["B"])
    change = {"A_max": too_far} | ({"B": 5e4, "G": 2.5e4} if law == "tensorial" else {})
    huge = ({"eps_D": [0.0, 1e3], "eps_V": 0.0}, None, {}, "more sub-steps")
    return found | {"not positive definite": (pure_shear([0.0, 0.1]), None, change, "not positive definite"), "huge": huge}
