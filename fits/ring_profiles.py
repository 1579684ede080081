"""The lecture's averages in the ring shear cell: density, velocity, stress, fabric, moduli, angles, rotations.

    python fits/ring_profiles.py [FOLDER [FIGURE.png]]

FOLDER (fits/data/ if none is named) holds ring_reference.h5, and ring_paper.h5 and ring_lecture.h5 where they are there; data_generation/
makes them. Shown are means over the seeds, with the errors of their blocks; stresses over the outer pressure, angles in degrees. The
printed angles have the standard error over the seeds, which differ by more than their blocks.
"""

import sys
from pathlib import Path

import numpy as np

import anisogran as ag
from anisogran import plots
from anisogran.comparison import near_angle, study_runs
from anisogran.glossary import label

DATA = Path(__file__).parent / "data"
NEAR = 8.0  # mean diameters from the inner ring: the shear zone
CELLS = {"gap of 8 d": ("ring_reference", "reference"), "gap of 20 d": ("ring_paper", "paper"), "smooth": ("ring_lecture", "smooth")}
ANGLES = "rate_to_stress_angle", "rate_to_fabric_angle", "fabric_to_stress_angle", "strain_to_stress_angle"


def seed_mean(study, path):
    """The Dataset of a group of a study, mean over the seeds on the rings that all of them have."""
    data = study[path].to_dataset()
    if "r_index" in data.dims:
        data = data.isel(r_index=np.isfinite(data.r.values).all(axis=0)).rename(r_index="place")
    else:
        data = data.rename_dims(r="place").reset_coords()
    seeds = data.sizes["seed"]
    values = {name: data[name].mean("seed", skipna=False) if "seed" in data[name].dims else data[name] for name in data.data_vars}
    for name in data.data_vars:
        if name.endswith("_error"):
            values[name] = np.sqrt((data[name] ** 2).sum("seed", skipna=False)) / seeds
    return data.assign(values)


def cells(folder):
    """{name: {"profiles", "circles", "layers", "pressure", "angles"}} of those cells whose file is there."""
    found = {}
    for name, (file, group) in CELLS.items():
        path = Path(folder) / f"{file}.h5"
        if path.exists():
            study = ag.open(path, holds=f"{group}/profiles")
            found[name] = {part: seed_mean(study, f"{group}/{part}") for part in ("profiles", "circles", "layers")}
            found[name]["pressure"] = float(found[name]["circles"].cut_pressure[-1])
            runs = study_runs(study, group).values()
            found[name]["angles"] = {key: seed_angle([near_angle(run.profiles, key) for run in runs]) for key in ANGLES}
    return found


def seed_angle(angles):
    """(mean, standard error) over the seeds from that of each; a single one is as it is."""
    return tuple(map(float, ag.fit.mean_and_error([angle for angle, _ in angles]))) if len(angles) > 1 else angles[0]


def balances(cell):
    """(spread of r^2 sigma_rphi over the circles, rms of d(r sigma_rr)/dr - sigma_phiphi), relative, without the circles of the walls."""
    circles, stress = cell["circles"].isel(place=slice(1, None)), cell["profiles"].stress.isel(place=slice(1, None)).values
    torque = (circles.r**2 * circles.cut_shear_stress).values
    force = (circles.r * circles.cut_pressure).values
    hoop = np.diff(force) / np.diff(circles.r.values)
    return float(np.std(torque) / np.mean(torque)), float(np.sqrt(np.mean((hoop - stress[1, 1]) ** 2)) / cell["pressure"])


def symbol(name):
    return f"${ag.glossary.GLOSSARY[name].symbol}$"


def main(folder=DATA, figure=None):
    """Print the figures, save the picture if a file is named; return {cell: {name: value}}."""
    found = cells(folder)
    result = {}
    for name, cell in found.items():
        profiles = cell["profiles"]
        zone = profiles.depth.values < NEAR
        nu, trace, bulk = (profiles[key].values for key in ("area_fraction", "fabric_trace", "bulk_modulus"))
        decay = ag.fit.exponential_decay(profiles.depth.values[zone], profiles.v_phi.values[zone], profiles.v_phi_error.values[zone])
        torque, force = balances(cell)
        slope = np.polyfit(np.log(cell["circles"].r.values[1:]), np.log(cell["circles"].cut_pressure.values[1:]), 1)[0]
        ratio = profiles.stress.values[1, 1] / profiles.stress.values[0, 0]
        one = result[name] = {
            "area_fraction_wall": nu[0], "area_fraction_far": nu[len(nu) // 2 : -1].mean(), "decay_length": decay.values["length"],
            "torque_spread": torque, "force_misfit": force, "exponent_rr": slope, "hoop_over_radial": ratio.mean(),
            "bulk_over_trace": (bulk / trace).mean(), "bulk_over_trace_spread": (bulk / trace).std(),
            **cell["angles"],
        }  # fmt: skip
        print(f"\n{name}: {profiles.sizes['place']} rings")
        print(f"  area fraction {one['area_fraction_wall']:.3f} at the inner ring, {one['area_fraction_far']:.3f} in the outer half")
        print(f"  v_phi decays over {one['decay_length']:.2f} d near the ring (x < {NEAR:g} d)")
        print(f"  r^2 sigma_rphi on circles: constant within {torque:.2%}")
        print(f"  d(r sigma_rr)/dr against sigma_phiphi: {force:.1%} of the pressure")
        print(f"  sigma_rr ~ r^{slope:.3f}; equilibrium asks for the mean of sigma_phiphi/sigma_rr - 1 = {one['hoop_over_radial'] - 1:.3f}")
        print(f"  bulk modulus over tr F: {one['bulk_over_trace']:.1f} +- {one['bulk_over_trace_spread']:.1f}")
        for key in ANGLES:
            print(f"  {ag.glossary.GLOSSARY[key].meaning}: {one[key][0]:.1f} +- {one[key][1]:.1f} degrees")
    if figure is not None:
        draw(found).savefig(figure, dpi=150)
    return result


def draw(found):
    """Nine panels over the depth, or over the fabric."""
    depth = f"depth {label('depth')}"

    def panel(ylabel, pick, **more):
        return plots.Panel(depth, ylabel, {}, {name: drawn for name, cell in found.items() if (drawn := pick(cell))}, **more)

    def profile(name, scale=lambda cell: 1.0):
        def pick(cell):
            data = cell["profiles"]
            return data.depth.values, scale(cell) * data[name].values, scale(cell) * data[f"{name}_error"].values

        return pick

    def torque(cell):
        circles = cell["circles"]
        inner = float(circles.r[0])
        factor = (circles.r / inner).values ** 2 / cell["pressure"]
        return circles.depth.values, factor * circles.cut_shear_stress.values, factor * circles.cut_shear_stress_error.values

    def layers(cell):
        data = cell["layers"]
        shown = (data.depth.values < 4.0) & (data.number_density.values > 0.02 * float(data.number_density.max()))
        return data.depth.values[shown], data.eigen_rotation.values[shown], data.eigen_rotation_error.values[shown]

    one = next(iter(found.values()))
    rings, circles, pressure = one["profiles"], one["circles"], one["pressure"]
    middle = 0.5 * (circles.depth.values[1:] + circles.depth.values[:-1])
    slope = np.diff((circles.r * circles.cut_pressure).values) / np.diff(circles.r.values)
    stress, error = rings.stress.values / pressure, rings.stress_error.values / pressure
    force = {
        r"$\sigma_{rr}$": (rings.depth.values, stress[0, 0], error[0, 0]),
        r"$\sigma_{\phi\phi}$": (rings.depth.values, stress[1, 1], error[1, 1]),
        r"$d(r\sigma_{rr})/dr$, circles": (middle, slope / pressure, None),
    }
    fabric = {
        label("fabric_trace"): (rings.depth.values, rings.fabric_trace.values, rings.fabric_trace_error.values),
        f"4 {label('fabric_deviator')}": (rings.depth.values, 4 * rings.fabric_deviator.values, 4 * rings.fabric_deviator_error.values),
    }
    trace, names = rings.fabric_trace.values, ("bulk_modulus", "shear_modulus")
    moduli = {symbol(name): (trace, rings[name].values, rings[f"{name}_error"].values) for name in names}
    angles = {symbol(name): (rings.depth.values, *(np.degrees(rings[key].values) for key in (name, f"{name}_error"))) for name in ANGLES}
    panels = [
        panel(label("area_fraction"), profile("area_fraction"), from_zero=False),
        panel(label("v_phi"), profile("v_phi"), log="y"),
        panel(r"$(r/R_i)^2 \sigma_{r\phi}/p$ on circles", torque),
        plots.Panel(depth, "stress / outer pressure", {}, force, title=next(iter(found))),
        plots.Panel(depth, "fabric", {}, fabric, title=next(iter(found))),
        plots.Panel(label("fabric_trace"), "modulus [N/m]", {}, moduli, title=next(iter(found))),
        plots.Panel(depth, "angle [degrees]", {}, angles, title=next(iter(found))),
        panel(f"{label('eigen_rotation')}, layers of 0.1 d", layers, from_zero=False),
        panel(label("torque_stiffness"), profile("torque_stiffness"), log="y"),
    ]
    return plots.panels_figure(panels, columns=3)


if __name__ == "__main__":
    main(*sys.argv[1:3])
