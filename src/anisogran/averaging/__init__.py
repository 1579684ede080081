"""The averages: from grains to fields, with the lecture's formalism. This room knows snapshots, never where they came from."""

from anisogran.averaging.averages import average
from anisogran.averaging.blocks import TimeBlocks, chance_drift, drift, field_profiles, mean_and_error, standard_error, with_errors
from anisogran.averaging.choosing import place_of
from anisogran.averaging.circles import circle_sums
from anisogran.averaging.densities import densities
from anisogran.averaging.directions import contact_directions, contact_network, fourier_coefficients
from anisogran.averaging.fields import KNOWN, extensive_needs, field_values, known_at
from anisogran.averaging.force_chains import force_network, grain_chains
from anisogran.averaging.fragments import fragments
from anisogran.averaging.layers import layer_fields, layer_sums
from anisogran.averaging.places import Grid, Points, Rings, WholeBox

__all__ = [
    "KNOWN", "Grid", "Points", "Rings", "TimeBlocks", "WholeBox", "average", "chance_drift", "circle_sums", "contact_directions",
    "contact_network", "densities", "drift", "extensive_needs", "field_profiles", "field_values", "force_network", "fourier_coefficients",
    "fragments", "grain_chains", "known_at", "layer_fields", "layer_sums", "mean_and_error", "place_of", "standard_error", "with_errors",
]  # fmt: skip
