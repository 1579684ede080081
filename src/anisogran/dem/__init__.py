"""The grains: a compact discrete element method (DEM) for discs, compiled for exactly the effects of a scene."""

from anisogran.dem.boundaries import Box, Cosine, Fixed, Open, Path, Periodic, Pressure, Ring
from anisogran.dem.grains import Grains
from anisogran.dem.laws import NORMAL_LAWS, Friction, Linear, Luding
from anisogran.dem.limits import collision_time, longest_step
from anisogran.dem.packing import Packing, dense_packing
from anisogran.dem.relaxation import relaxed
from anisogran.dem.simulation import Simulation
from anisogran.dem.single_contact import contact_path

__all__ = [
    "NORMAL_LAWS", "Box", "Cosine", "Fixed", "Friction", "Grains", "Linear", "Luding", "Open", "Packing", "Path", "Periodic", "Pressure",
    "Ring", "Simulation", "collision_time", "contact_path", "dense_packing", "longest_step", "relaxed",
]  # fmt: skip
