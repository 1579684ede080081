"""What accuracy costs in time: error against seconds for each knob of a room, with the default marked."""

from anisogran.cost.averages import averaging_cost
from anisogran.cost.tables import table_text

__all__ = ["averaging_cost", "table_text"]
