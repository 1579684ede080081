"""Laws of dense granular flow, one file each. A new one is a file with the members of its neighbours, and one line in LAWS.

A law is a small record, its keys declared with unit, meaning and bounds. It has `fields` (its unknowns), its floors, the largest
inertial number it is meant for (`valid_to`), `layer`, `elements`, `positive`, `stress`, `rate` and `friction`; with a fluidity, also
`fluidity`, `length` and `wall_exchange`. All but the last two work on whole arrays in the reduced units of `Setting`; stress and fluidity
must be analytic (no abs), since the tangent of the solver is their derivative by a complex step, exact to rounding for every law.
`friction` is mu(I) of steady homogeneous flow, one of the functions of `anisogran.models`: the law of a point is that of every quadrature
point.
"""

from anisogran.continuum.laws.jop import Jop
from anisogran.continuum.laws.local_mu_i import LocalMuI
from anisogran.continuum.laws.nonlocal_fluidity import Nonlocal
from anisogran.continuum.laws.regularised import Regularised
from anisogran.outcome import InputError

LAWS = (LocalMuI, Jop, Regularised, Nonlocal)

__all__ = ["LAWS", "Jop", "LocalMuI", "Nonlocal", "Regularised", "check_law"]


def check_law(law):
    """The law itself; InputError if it has not what the solver needs."""
    if isinstance(law, type) or not all(hasattr(law, name) for name in ("fields", "stress", "layer", "floor")):
        known = ", ".join(f"{one.__name__}(...)" for one in LAWS)
        raise InputError(f"RingFlow: law = {law!r} is no law; give one of {known}")
    return law
