"""The contact effects: one file each, and the two lists that the kernels and the general tests run over.

A new normal law is one new file and one line in NORMAL_LAWS and in each table of functions.
"""

from anisogran.compiled import specialised
from anisogran.dem.laws import friction, linear, luding
from anisogran.dem.laws.friction import Friction
from anisogran.dem.laws.linear import Linear
from anisogran.dem.laws.luding import Luding

NORMAL_LAWS = {Linear: linear, Luding: luding}

normal_force = specialised({
    linear.LinearParameters: linear.force,
    luding.LudingParameters: luding.force,
    luding.GrowingLudingParameters: luding.growing_force,
})  # fmt: skip
reloading_line = specialised({
    linear.LinearParameters: linear.reloading_line,
    luding.LudingParameters: luding.reloading_line,
    luding.GrowingLudingParameters: luding.growing_reloading_line,
})  # fmt: skip
stored_energy = specialised({
    linear.LinearParameters: linear.stored_energy,
    luding.LudingParameters: luding.stored_energy,
    luding.GrowingLudingParameters: luding.growing_stored_energy,
})  # fmt: skip
tangential_force = specialised({friction.FrictionParameters: friction.force})
tangential_energy = specialised({friction.FrictionParameters: friction.stored_energy})

__all__ = [
    "NORMAL_LAWS", "Friction", "Linear", "Luding", "normal_force", "reloading_line", "stored_energy", "tangential_energy",
    "tangential_force",
]  # fmt: skip
