"""What accuracy costs in the grains: time step, steady flow, and the price of each effect."""

from anisogran.cost.contact_steps import time_step_rows
from anisogran.cost.effects import price_rows
from anisogran.cost.steady_flows import steady_rows


def dem_cost(quick=False):
    """Rows {knob, value, error, seconds, default} for the grains, a list: time step, steady flow, price of each effect."""
    return time_step_rows(quick) + steady_rows(quick) + price_rows(quick)
