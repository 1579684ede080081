"""What accuracy costs in time: error against seconds for each knob of a room, with the default marked."""

from anisogran.cost.averages import averaging_cost
from anisogran.cost.curve_fits import fitting_cost
from anisogran.cost.grains import dem_cost
from anisogran.cost.point_laws import models_cost
from anisogran.cost.ring_flows import continuum_cost
from anisogran.cost.tables import table_text

ROOMS = {"dem": dem_cost, "averaging": averaging_cost, "models": models_cost, "fitting": fitting_cost, "continuum": continuum_cost}

__all__ = ["ROOMS", "averaging_cost", "continuum_cost", "dem_cost", "fitting_cost", "models_cost", "table_text"]
