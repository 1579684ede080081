"""What accuracy costs in time: error against seconds for each knob of a room, with the default marked."""

from anisogran.cost.averages import averaging_cost
from anisogran.cost.curve_fits import fitting_cost
from anisogran.cost.grains import dem_cost
from anisogran.cost.point_laws import models_cost
from anisogran.cost.ring_flows import continuum_cost
from anisogran.cost.rooms import ROOMS, all_rows, rows_of
from anisogran.cost.tables import table_text

__all__ = [
    "ROOMS", "all_rows", "averaging_cost", "continuum_cost", "dem_cost", "fitting_cost", "models_cost", "rows_of", "table_text",
]  # fmt: skip
