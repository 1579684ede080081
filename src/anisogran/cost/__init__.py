"""What accuracy costs in time: error against seconds for each knob of a room, with the default marked."""

from anisogran.cost.averages import averaging_cost
from anisogran.cost.budget import measured_budget
from anisogran.cost.budget_tables import budget_tables, choice_rows
from anisogran.cost.curve_fits import fitting_cost
from anisogran.cost.grains import dem_cost
from anisogran.cost.point_laws import models_cost
from anisogran.cost.ring_flows import continuum_cost
from anisogran.cost.rooms import ROOMS, all_rows, rows_of
from anisogran.cost.tables import table_text
from anisogran.cost.whole_way import whole_way_cost

__all__ = [
    "ROOMS", "all_rows", "averaging_cost", "budget_tables", "choice_rows", "continuum_cost", "dem_cost", "fitting_cost", "measured_budget",
    "models_cost", "rows_of", "table_text", "whole_way_cost",
]  # fmt: skip
