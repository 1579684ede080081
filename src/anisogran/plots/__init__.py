"""Pictures of runs, profiles and fits. The only room that imports matplotlib; every picture is a Figure, and no window is opened."""

from anisogran.plots.contact_law import contact_law_figure, draw_contact_path
from anisogran.plots.costs import cost_figure, rooms_figure
from anisogran.plots.directions import direction_figure
from anisogran.plots.element import element_figure
from anisogran.plots.fits import FittedCurve, fit_figure
from anisogran.plots.flow import flow_figure
from anisogran.plots.grain_values import biaxial_pictures
from anisogran.plots.homogeneous import biaxial_curves, friction_law
from anisogran.plots.maps import field_map
from anisogran.plots.moduli import moduli_figure
from anisogran.plots.mohr_circles import mohr_circles_figure
from anisogran.plots.panels import Panel, panels_figure
from anisogran.plots.ring import predictions_figure, ring_fields, velocity_comparison
from anisogran.plots.ring_pictures import ring_pictures, stress_crosses
from anisogran.plots.snapshots import chain_figure, draw_packing, packings
from anisogran.plots.stiffness import stiffness_figure
from anisogran.plots.style import figure

__all__ = [
    "FittedCurve",
    "Panel",
    "biaxial_curves",
    "biaxial_pictures",
    "chain_figure",
    "contact_law_figure",
    "cost_figure",
    "direction_figure",
    "draw_contact_path",
    "draw_packing",
    "element_figure",
    "field_map",
    "figure",
    "fit_figure",
    "flow_figure",
    "friction_law",
    "moduli_figure",
    "mohr_circles_figure",
    "packings",
    "panels_figure",
    "predictions_figure",
    "ring_fields",
    "ring_pictures",
    "rooms_figure",
    "stiffness_figure",
    "stress_crosses",
    "velocity_comparison",
]
