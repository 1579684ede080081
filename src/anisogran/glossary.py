"""Every quantity that leaves a room: its symbol, unit and meaning; axis labels, file attributes and tables are made from this.

Units are those of the two-dimensional model, where a stress is a force per length. Compression is positive for stress and strain.
A scene in reduced units (grain diameter, pressure and density set to 1) reads the same units with these three as "1 m" and so on.
"""

from typing import NamedTuple

CONVENTIONS = (
    "compression positive for stress and strain; eps_V = (e1 + e2)/2, eps_D = (e1 - e2)/2, sigma_V and sigma_D likewise (half/half); "
    "true strain; spin positive counter-clockwise; tensors t[i, j, ...]; fabric F = (1/V) sum w V^p sum_c n n"
)


class Quantity(NamedTuple):
    """Symbol (matplotlib mathtext without dollars), unit ("1" if it has none) and meaning of a quantity."""

    symbol: str
    unit: str
    meaning: str


GLOSSARY = {
    # clock and place
    "time": Quantity("t", "s", "time since the stage began"),
    "r": Quantity("r", "m", "distance from the axis of the cell"),
    "depth": Quantity("(r - R_i)/d", "1", "distance from the inner ring in mean grain diameters"),
    # strain, half/half
    "eps_zz": Quantity(r"\epsilon_{zz}", "1", "vertical strain ln(z0/z), compression positive"),
    "eps_xx": Quantity(r"\epsilon_{xx}", "1", "horizontal strain ln(x0/x), compression positive"),
    "eps_V": Quantity(r"\epsilon_V", "1", "volumetric strain (eps_zz + eps_xx)/2, half of the trace; negative is dilation"),
    "eps_D": Quantity(r"\epsilon_D", "1", "deviatoric strain (eps_zz - eps_xx)/2"),
    "strain": Quantity(r"\gamma", "1", "shear strain of the cell, rate times time"),
    # stress
    "stress": Quantity(r"\sigma", "N/m", "stress, compression positive, contact and fluctuation part, momentum flux [force, branch]"),
    "stress_static": Quantity(r"\sigma^s", "N/m", "stress carried by contacts, compression positive"),
    "stress_dynamic": Quantity(r"\sigma^d", "N/m", "stress of the velocity fluctuations relative to the local linear mean field"),
    "sigma_xx": Quantity(r"\sigma_{xx}", "N/m", "horizontal stress, compression positive"),
    "sigma_zz": Quantity(r"\sigma_{zz}", "N/m", "vertical stress, compression positive"),
    "sigma_yy": Quantity(r"\sigma_{yy}", "N/m", "stress along the velocity gradient, compression positive"),
    "sigma_xx_wall": Quantity(r"\sigma_{xx}^w", "N/m", "horizontal stress from the force on the side wall over its height"),
    "sigma_zz_wall": Quantity(r"\sigma_{zz}^w", "N/m", "vertical stress from the force on the top wall over its width"),
    "pressure": Quantity("p", "N/m", "half the trace of the stress"),
    "s_D": Quantity("s_D", "1", "deviatoric stress ratio sigma_D/sigma_V = sin(mobilised friction angle)"),
    "stress_ratio": Quantity(r"\mu", "1", "shear stress over pressure"),
    "wall_shear_stress": Quantity(r"\tau_i", "N/m", "shear stress that the inner ring exerts, from its torque"),
    "wall_pressure": Quantity("p_i", "N/m", "normal pressure on the inner ring, from the forces on its discs"),
    "outer_radius": Quantity("R_o", "m", "radius of the outer ring"),
    "outer_pressure": Quantity("p_o", "N/m", "normal pressure on the outer ring"),
    "outer_shear_stress": Quantity(r"\tau_o", "N/m", "shear stress on the outer ring, positive along the turning"),
    # structure
    "area_fraction": Quantity(r"\nu", "1", "area of the grains over area"),
    "fabric": Quantity("F", "1", "fabric tensor (1/V) sum w V^p sum_c n n"),
    "fabric_trace": Quantity(r"\mathrm{tr}\,F", "1", "trace of the fabric: area fraction times contacts a grain"),
    "fabric_deviator": Quantity("F_D", "1", "half the difference of the eigenvalues of the fabric"),
    "anisotropy": Quantity("a_2", "1", "deviatoric fabric ratio a_2 = 2 (F_1 - F_2)/tr F, the second Fourier coefficient of the contacts"),
    "coordination_number": Quantity("Z", "1", "contacts a grain, rattlers left out"),
    "kinetic_energy": Quantity("E_k", "J", "kinetic energy of the free grains, spin included"),
    # motion
    "velocity": Quantity("v", "m/s", "velocity"),
    "v_phi": Quantity(r"v_\phi", "m/s", "azimuthal velocity"),
    "shear_rate": Quantity(r"\dot\gamma", "1/s", "shear rate 2 |D_dev|, the engineering rate in simple shear"),
    "spin": Quantity(r"\omega", "1/s", "mean spin of the grains, counter-clockwise positive"),
    "continuum_spin": Quantity("W", "1/s", "spin of the mean flow (dv/dr + v/r)/2"),
    "eigen_rotation": Quantity(r"\omega^*", "1/s", "spin of the grains less the spin of the mean flow"),
    "inertial_number": Quantity("I", "1", "shear_rate sqrt(mean grain mass / pressure)"),
    "fluidity": Quantity("g", "1/s", "granular fluidity: shear rate over stress ratio"),
}


def attributes(name, **more):
    """The file attributes of a quantity (units, long_name, symbol), with further ones; KeyError if the glossary lacks it."""
    quantity = GLOSSARY[name]
    return {"units": quantity.unit, "long_name": quantity.meaning, "symbol": quantity.symbol, **more}


def label(name):
    """An axis label such as "$s_D$" or "$\\sigma_{zz}$ [N/m]"."""
    quantity = GLOSSARY[name]
    return f"${quantity.symbol}$" + (f" [{quantity.unit}]" if quantity.unit != "1" else "")
