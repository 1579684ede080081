"""Every quantity that leaves a room: its symbol, unit and meaning; axis labels, file attributes and tables are made from this.

Units are those of the two-dimensional model, where a stress is a force per length. Compression is positive for stress and strain.
A scene in reduced units (grain diameter, pressure and density set to 1) reads the same units with these three as "1 m" and so on.
"""

import math
from typing import NamedTuple

CONVENTIONS = (
    "compression positive for stress and strain; eps_V = (e1 + e2)/2, eps_D = (e1 - e2)/2, sigma_V and sigma_D likewise (half/half); "
    "true strain; spin positive counter-clockwise; tensors t[i, j, ...]; fabric F = (1/V) sum w V^p sum_c n n"
)


class Quantity(NamedTuple):
    """Symbol (matplotlib mathtext without dollars), unit ("1" if it has none) and meaning of a quantity.

    `period`: an angle that is the same after that, in rad.
    """

    symbol: str
    unit: str
    meaning: str
    period: float | None = None


# in space a stress is a force per area, a density a mass per volume, and so on
IN_SPACE = {
    "N/m": "N/m2", "N": "N/m", "N/m2": "N/m3", "kg/m2": "kg/m3", "kg/m3": "kg/m4", "kg/(m s)": "kg/(m2 s)", "kg/(m2 s)": "kg/(m3 s)",
    "1/m2": "1/m3", "m2": "m3", "N s/m": "N s/m2",
}  # fmt: skip


GLOSSARY = {
    # clock and place
    "time": Quantity("t", "s", "time since the stage began"),
    "r": Quantity("r", "m", "distance from the axis of the cell"),
    "x": Quantity("x", "m", "horizontal position"),
    "y": Quantity("y", "m", "position along the second axis"),
    "z": Quantity("z", "m", "height"),
    "width": Quantity("w", "m", "width of a sample with free sides: sqrt(12) times the spread of its area along x"),
    "floor_height": Quantity("z_f", "m", "height of a floor that moves"),
    "volume": Quantity("V", "m2", "area (in space: volume) that was averaged over"),
    "depth": Quantity("(r - R_i)/d", "1", "distance from the inner ring in mean grain diameters"),
    # strain, half/half
    "eps_zz": Quantity(r"\epsilon_{zz}", "1", "vertical strain ln(z0/z), compression positive"),
    "eps_xx": Quantity(r"\epsilon_{xx}", "1", "horizontal strain ln(x0/x), compression positive"),
    "eps_V": Quantity(r"\epsilon_V", "1", "volumetric strain (eps_zz + eps_xx)/2, half of the trace; negative is dilation"),
    "eps_D": Quantity(r"\epsilon_D", "1", "deviatoric strain (eps_zz - eps_xx)/2"),
    "eps_xz": Quantity(r"\epsilon_{xz}", "1", "shear strain, half of the engineering one, compression positive"),
    "strain": Quantity(r"\gamma", "1", "shear strain of the cell, rate times time"),
    # stress
    "stress": Quantity(r"\sigma", "N/m", "stress, compression positive, contact and fluctuation part, momentum flux [force, branch]"),
    "stress_static": Quantity(r"\sigma^s", "N/m", "stress carried by contacts, walls included, compression positive, [force, branch]"),
    "stress_dynamic": Quantity(r"\sigma^d", "N/m", "stress of the velocity fluctuations relative to the local linear mean field"),
    "sigma_xx": Quantity(r"\sigma_{xx}", "N/m", "horizontal stress, compression positive"),
    "sigma_zz": Quantity(r"\sigma_{zz}", "N/m", "vertical stress, compression positive"),
    "sigma_xz": Quantity(r"\sigma_{xz}", "N/m", "shear stress in the axes x and z, compression positive"),
    "sigma_yy": Quantity(r"\sigma_{yy}", "N/m", "stress along the velocity gradient, compression positive"),
    "sigma_xy": Quantity(r"\sigma_{xy}", "N/m", "shear stress in the axes x and y, compression positive"),
    "sigma_V": Quantity(r"\sigma_V", "N/m", "mean stress (sigma_1 + sigma_2)/2, compression positive"),
    "sigma_D": Quantity(r"\sigma_D", "N/m", "deviatoric stress (sigma_1 - sigma_2)/2"),
    "sigma_xx_grains": Quantity(r"\sigma_{xx}^g", "N/m", "horizontal stress averaged over the grains, compression positive"),
    "sigma_zz_grains": Quantity(r"\sigma_{zz}^g", "N/m", "vertical stress averaged over the grains, compression positive"),
    "pressure": Quantity("p", "N/m", "trace of the stress over the dimension"),
    "couple_stress": Quantity("M", "N", "couple stress (1/V) sum w sum_c (l x f) l with the force f on the grain, lecture's sign"),
    "torque_stiffness": Quantity(r"\mu l^2", "N m s", "couple stress over curvature (of the spin, a rate), M.kappa / kappa.kappa"),
    "stress_divergence": Quantity(r"\nabla\cdot\sigma", "N/m2", "sum_j d sigma_ij / d x_j of the contact stress, compression positive"),
    "wall_force_density": Quantity("t", "N/m2", "force of walls on grains per area, spread about the contact points by the kernel"),
    "s_D": Quantity("s_D", "1", "deviatoric stress ratio sigma_D/sigma_V = sin(mobilised friction angle)"),
    "normal_stress": Quantity(r"\sigma", "N/m", "normal stress on a plane, compression positive"),
    "shear_stress": Quantity(r"\tau", "N/m", "shear stress on a plane"),
    "friction_angle": Quantity(r"\phi", "rad", "internal friction angle, the slope of the common tangent of stress circles"),
    "mobilised_angle": Quantity(r"\phi_m", "rad", "total (mobilised, secant) friction angle arcsin(s_D), of a line through the origin"),
    "cohesion": Quantity("c", "N/m", "macroscopic cohesion, the shear stress of the yield line at no normal stress"),
    "stress_ratio": Quantity(r"\mu", "1", "shear stress over pressure"),
    "wall_shear_stress": Quantity(r"\tau_i", "N/m", "shear stress that the inner ring exerts, from its torque"),
    "wall_pressure": Quantity("p_i", "N/m", "radial stress on the circle of the inner ring, from the contacts that cross it"),
    "outer_radius": Quantity("R_o", "m", "radius of the outer ring"),
    "outer_pressure": Quantity("p_o", "N/m", "normal pressure on the outer ring"),
    "cut_pressure": Quantity(r"\sigma_{rr}", "N/m", "radial stress on a circle, from the contacts that cross it, compression positive"),
    "cut_shear_stress": Quantity(r"\sigma_{r\phi}", "N/m", "shear stress on a circle, from the torque of the contacts that cross it"),
    "relative_stress": Quantity(r"\sigma/p_i", "1", "stress over the pressure on the inner ring in the same block"),
    "turns": Quantity("n", "1", "turns of the inner ring"),
    "outer_shear_stress": Quantity(r"\tau_o", "N/m", "shear stress on the outer ring, positive along the turning"),
    # structure
    "area_fraction": Quantity(r"\nu", "1", "area of the grains over area"),
    "volume_fraction": Quantity(r"\nu", "1", "volume of the grains over volume"),
    "density": Quantity(r"\rho", "kg/m2", "mass of the grains per area"),
    "density_gradient": Quantity(r"\nabla\rho", "kg/m3", "gradient of the density, from the gradient of the kernel"),
    "number_density": Quantity("n", "1/m2", "grains per area"),
    "mean_diameter": Quantity("d", "m", "mean diameter of the grains"),
    "fabric": Quantity("F", "1", "fabric tensor (1/V) sum w V^p sum_c n n"),
    "fabric_xx": Quantity("F_{xx}", "1", "component of the fabric along x"),
    "fabric_yy": Quantity("F_{yy}", "1", "component of the fabric along y"),
    "fabric_xy": Quantity("F_{xy}", "1", "shear component of the fabric in the axes x and y"),
    "fabric_trace": Quantity(r"\mathrm{tr}\,F", "1", "trace of the fabric: area fraction times contacts a grain"),
    "fabric_deviator": Quantity("F_D", "1", "half the difference of the eigenvalues of the fabric"),
    "anisotropy": Quantity("a_2", "1", "deviatoric fabric ratio a_2 = 2 (F_1 - F_2)/tr F, the second Fourier coefficient of the contacts"),
    "coordination_number": Quantity("Z", "1", "contacts a grain, rattlers left out"),
    "rattler_fraction": Quantity("N_r/N", "1", "share of the grains that carry nothing: too few contacts, removed until none is left"),
    "elastic_strain": Quantity(
        r"\epsilon", "1", "elastic strain pi (1/V) sum w sum_c (Delta l) . F^-1 of the contacts, symmetric, with the full overlap as Delta"
    ),
    "elastic_strain_raw": Quantity(
        r"\epsilon", "1", "elastic strain (sum w sum_c Delta l) . (sum w sum_c l l)^-1, symmetric, with the full overlap as Delta"
    ),
    "bulk_modulus": Quantity("E", "N/m", "trace of the contact stress over trace of the elastic strain"),
    "shear_modulus": Quantity("G", "N/m", "deviator of the contact stress over deviator of the elastic strain"),
    "stress_angle": Quantity(r"\phi_\sigma", "rad", "angle of the axis of the largest compressive stress", math.pi),
    "fabric_angle": Quantity(r"\phi_F", "rad", "angle of the axis of the largest fabric", math.pi),
    "elastic_strain_angle": Quantity(r"\phi_\epsilon", "rad", "angle of the axis of the largest compressive elastic strain", math.pi),
    "strain_rate_angle": Quantity(r"\phi_D", "rad", "angle of the axis of the fastest compression", math.pi),
    "fabric_to_stress_angle": Quantity(r"\phi_\sigma - \phi_F", "rad", "axis of the stress from that of the fabric", math.pi),
    "strain_to_stress_angle": Quantity(
        r"\phi_\sigma - \phi_\epsilon", "rad", "axis of the stress from that of the elastic strain", math.pi
    ),
    "rate_to_stress_angle": Quantity(r"\phi_\sigma - \phi_D", "rad", "axis of the stress from that of the strain rate", math.pi),
    "rate_to_fabric_angle": Quantity(r"\phi_F - \phi_D", "rad", "axis of the fabric from that of the strain rate", math.pi),
    "elastic_energy": Quantity("E_e", "J", "energy that all contacts can give back"),
    "spin_rms": Quantity(r"\omega_\mathrm{rms}", "1/s", "root mean square spin of the grains"),
    "kinetic_energy": Quantity("E_k", "J", "kinetic energy of the free grains, spin included"),
    "granular_temperature": Quantity("T", "J", "granular temperature, kinetic energy of translation a grain, half of it in each direction"),
    # contact network: directions, forces, chains
    "angle": Quantity(r"\theta", "rad", "angle of the contact normal, from the centre of the grain", 2 * math.pi),
    "contact_density": Quantity(r"f(\theta)", "1/rad", "probability density of the contact normals"),
    "contact_density_error": Quantity(r"\Delta f", "1/rad", "Poisson error of the probability density of the contact normals"),
    "normal_force": Quantity(r"f_n/\langle f_n\rangle", "1", "mean normal force over that of all contacts, compression positive"),
    "tangential_force": Quantity(r"f_t/\langle f_n\rangle", "1", "mean tangential force over the mean normal force"),
    "a2": Quantity("a_2", "1", "second Fourier coefficient of the contact normals, along their axis"),
    "a2_error": Quantity(r"\Delta a_2", "1", "standard error of a2, for independent contacts"),
    "a4": Quantity("a_4", "1", "fourth Fourier coefficient of the contact normals, along the axis of the second"),
    "axis": Quantity(r"\theta_2", "rad", "major axis of the contact normals", math.pi),
    "a_n": Quantity("a_n", "1", "anisotropy of the normal forces"),
    "normal_axis": Quantity(r"\theta_n", "rad", "axis of the largest normal forces", math.pi),
    "a_t": Quantity("a_t", "1", "anisotropy of the tangential forces"),
    "tangential_axis": Quantity(r"\theta_t", "rad", "axis of the compression that the tangential forces make", math.pi),
    "mean_normal_force": Quantity(r"\langle f_n\rangle", "N", "mean normal force, compression positive"),
    "contacts": Quantity("N_c", "1", "number of contacts"),
    "contact_ends": Quantity("N_e", "1", "number of contact ends: two a contact, one at a wall"),
    "relative_force": Quantity(r"f_n/\langle f_n\rangle", "1", "normal force over its mean"),
    "force_density": Quantity(r"P(f_n/\langle f_n\rangle)", "1", "probability density of the normal forces over their mean"),
    "force_density_error": Quantity(r"\Delta P", "1", "Poisson error of the probability density of the normal forces"),
    "largest_force": Quantity(r"f_\mathrm{max}/\langle f_n\rangle", "1", "largest normal force over the mean"),
    "strong_share": Quantity("s_c", "1", "share of the contacts above the mean normal force, the strong network"),
    "strong_pressure_share": Quantity("s_p", "1", "share of the strong network in the trace of the contact stress"),
    "strong_deviator_share": Quantity("s_q", "1", "share of the strong network in the deviator of the contact stress"),
    "participation": Quantity(r"\Gamma", "1", "participation number (sum f)^2/(N_c sum f^2) of the normal forces"),
    "chain_of": Quantity("c", "1", "number of the force chain of the grain, -1 for none"),
    "major_stress": Quantity(r"\sigma_1^p", "N/m", "major principal stress of the grain, compression positive"),
    "links": Quantity("l", "1", "grains that each link of the force chains joins"),
    "chain_grains": Quantity("n_c", "1", "grains of the force chain"),
    "chain_length": Quantity("L/d", "1", "summed branch lengths of the force chain in mean diameters"),
    "chain_axis": Quantity(r"\theta_c", "rad", "mean direction of the links of the force chain", math.pi),
    "chain_share": Quantity("s_g", "1", "share of the grains that are in force chains"),
    "mean_axis": Quantity(r"\langle\theta_c\rangle", "rad", "mean direction of all links of force chains", math.pi),
    "alignment": Quantity(r"|\langle e^{2i\theta}\rangle|", "1", "alignment of the links of force chains, 1 if all are parallel"),
    # fragments: clusters of grains that contacts connect
    "fragment_of": Quantity("k", "1", "number of the fragment of the grain, 0 for that of the largest mass, -1 for a grain of a wall"),
    "fragment_grains": Quantity("n_k", "1", "grains of the fragment"),
    "fragment_mass": Quantity("m_k", "kg", "mass of the fragment"),
    "fragments": Quantity("N_k", "1", "number of fragments, the clusters of free grains that contacts connect"),
    "largest_fragment": Quantity(r"m_0/\sum m_k", "1", "mass of the largest fragment over that of all free grains"),
    "mean_fragment_mass": Quantity(r"\langle m_k\rangle", "kg", "mean mass of the fragments"),
    # internal variables of the laws at a point
    "A": Quantity("A", "N/m", "anisotropy modulus, positive if stiffer along z"),
    "A_1": Quantity("A_1", "N/m", "anisotropy modulus A cos(2 phi_C), phi_C the stiff axis from x"),
    "A_2": Quantity("A_2", "N/m", "anisotropy modulus A sin(2 phi_C), phi_C the stiff axis from x"),
    "kappa": Quantity(r"\kappa_p", "1", "plastic deviatoric strain"),
    "rotation": Quantity(r"\theta", "rad", "rotation of the material, counter-clockwise"),
    "work": Quantity("w", "N/m", "work done on the sample per area"),
    # stiffness from probes
    "E": Quantity("E", "N/m", "bulk modulus d sigma_V/d eps_V, half/half measures"),
    "B": Quantity("B", "N/m", "shear modulus along the axes of the structure, d sigma_D/d eps_D, half/half measures"),
    "G": Quantity("G", "N/m", "shear modulus across the axes of the structure: 2G = d sigma_xz/d eps_xz"),
    "misfit": Quantity(
        r"\Delta\sigma/(E\Delta\epsilon)", "1", "rms misfit of the anisotropic law to the probes, over E times their strain"
    ),
    "probed_state": Quantity("k", "1", "number of the state that is probed"),
    "way": Quantity("w", "1", "1: of the probe forth, -1: back"),
    "d_eps_V": Quantity(r"\Delta\epsilon_V", "1", "volumetric strain of the probe, half of the trace"),
    "d_eps_D": Quantity(r"\Delta\epsilon_D", "1", "deviatoric strain (zz - xx)/2 of the probe"),
    "d_eps_xz": Quantity(r"\Delta\epsilon_{xz}", "1", "shear strain of the probe, half of the engineering one"),
    "d_sigma_V": Quantity(r"\Delta\sigma_V", "N/m", "change of the mean stress by the probe"),
    "d_sigma_D": Quantity(r"\Delta\sigma_D", "N/m", "change of (sigma_zz - sigma_xx)/2 by the probe"),
    "d_sigma_xz": Quantity(r"\Delta\sigma_{xz}", "N/m", "change of the shear stress by the probe, seen from the material"),
    "contacts_opened": Quantity("N_-", "1", "contacts that the probe has opened"),
    "contacts_closed": Quantity("N_+", "1", "contacts that the probe has closed"),
    "imbalance": Quantity("f/f_c", "1", "mean net force on a grain over the mean contact force"),
    "cell_width": Quantity("L_x", "m", "width of the cell"),
    "cell_height": Quantity("L_z", "m", "height of the cell"),
    # motion
    "velocity": Quantity("v", "m/s", "velocity; of averages, that of the local linear mean field"),
    "velocity_density": Quantity(r"\nu v", "m/s", "area fraction times velocity, (1/V) sum w V^p v"),
    "momentum_density": Quantity(r"\rho v", "kg/(m s)", "momentum of the grains per area"),
    "momentum_gradient": Quantity(
        r"\partial_j \rho v_i", "kg/(m2 s)", "d (rho v_i) / d x_j, from the gradient of the kernel; its trace is the loss of density"
    ),
    "velocity_gradient": Quantity(r"\partial_j v_i", "1/s", "d v_i / d x_j of the local linear mean field"),
    "strain_rate": Quantity("D", "1/s", "symmetric part of the velocity gradient, compression positive"),
    "v_phi": Quantity(r"v_\phi", "m/s", "azimuthal velocity"),
    "shear_rate": Quantity(r"\dot\gamma", "1/s", "shear rate 2 |D_dev|, the engineering rate in simple shear"),
    "spin": Quantity(r"\omega", "1/s", "mean spin of the grains, counter-clockwise positive"),
    "spin_density": Quantity(r"\nu\omega", "1/s", "area fraction times spin, (1/V) sum w V^p spin"),
    "continuum_spin": Quantity("W", "1/s", "spin of the mean flow, half the curl of the velocity"),
    "curvature": Quantity(r"\kappa", "1/(m s)", "gradient of the spin, d spin / d x_j"),
    "eigen_rotation": Quantity(r"\omega^*", "1/s", "spin of the grains less the spin of the mean flow"),
    "inertial_number": Quantity("I", "1", "shear_rate sqrt(mean grain mass / pressure)"),
    "viscosity": Quantity(r"\eta", "N s/m", "stress deviator |tau| over shear rate"),
    "well_posedness": Quantity("C", "1", "C(I) of a friction law mu(I): flow is ill posed where it is positive"),
    "cooperativity_length": Quantity(r"\xi", "m", "length over which grains act on the fluidity of others"),
    "fluidity": Quantity("g", "1/s", "granular fluidity: shear rate over stress ratio"),
}


def attributes(name, dimension=2, **more):
    """The file attributes of a quantity (units, long_name, symbol), with further ones; KeyError if the glossary lacks it."""
    quantity = GLOSSARY[name]
    unit = quantity.unit if dimension == 2 else IN_SPACE.get(quantity.unit, quantity.unit)
    period = {} if quantity.period is None else {"period": quantity.period}
    return {"units": unit, "long_name": quantity.meaning, "symbol": quantity.symbol, **period, **more}


def label(name):
    """An axis label such as "$s_D$" or "$\\sigma_{zz}$ [N/m]"."""
    quantity = GLOSSARY[name]
    return f"${quantity.symbol}$" + (f" [{quantity.unit}]" if quantity.unit != "1" else "")
