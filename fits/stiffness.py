"""E, A, B, G along the biaxial path from probes beside those from the fabric: `python fits/stiffness.py [stiffness.h5 [FIGURE.png]]`.

The file is made by data_generation/stiffness.py; that of the full run is fits/data/stiffness.h5. Moduli in kN/m, half/half measures, those
of the probes on their elastic way back; the fabric's are those of the same contacts moving affinely (Voigt's bound). Errors are standard
errors over the seeds.
"""

import sys
from pathlib import Path

import numpy as np
import xarray as xr
from scipy import stats

import anisogran as ag
from anisogran import plots

DATA = Path(__file__).parent / "data" / "stiffness.h5"
MODULI = ("E", "A", "B", "G")
PATHS = {"mu = 0": "smooth_path", "mu = 0.5": "rough_path"}
MORE_PRESSURES = {"mu = 0": "smooth", "mu = 0.5": "rough"}
K2 = 1e5  # N/m


def main(path=DATA, figure=None):
    """Print the tables, save the figure if a file is named; return {name: exponent and its error} of the pressure."""
    tree = ag.open(path, holds="smooth_path")
    data = {name: tree[name].to_dataset().load() for name in tree.children}
    for title, name in PATHS.items():
        for p in data[name].pressure.values:
            print_path(f"Along the path, {title}, p = {p:g} N/m", data[name].sel(pressure=p))
    exponents = {}
    print("\nIsotropic states, modulus ~ p^m: m +- error from probes | from the fabric")
    for title, one in isotropic(data).items():
        for modulus in ("E", "B", "G"):
            fits = [exponent(one[modulus].sel(source=source)) for source in ("back", "fabric")]
            exponents[f"{modulus}, {title}"] = fits[0]
            print(f"  {title:9s} {modulus}  {fits[0][0]:7.3f} +- {fits[0][1]:.3f}  | {fits[1][0]:7.3f} +- {fits[1][1]:.3f}")
    print_adhesion(data["adhesion"])
    for title, name in PATHS.items():
        print_fabric(title, data[name])
    print_probe(data["probe"])
    if figure is not None:
        picture(data).savefig(figure, dpi=130)
    return exponents


def isotropic(data):
    """{title: the first states at all pressures}."""
    parts = {title: (data[name].isel(state=0), data[PATHS[title]].isel(state=0)) for title, name in MORE_PRESSURES.items()}
    return {title: xr.concat(both, "pressure").sortby("pressure") for title, both in parts.items()}


def exponent(modulus):
    """Exponent of the pressure, of the mean over the seeds, and its standard error by leaving out one seed after the other.

    The mean, since a small sample without friction may be unstable in shear, with G < 0; nan if a mean is not above 0, which no power is.
    """
    x, seeds = np.log(modulus.pressure.values), modulus.seed.values

    def slope(kept):
        mean = modulus.sel(seed=kept).mean("seed").values
        return np.polyfit(x, np.log(mean), 1)[0] if mean.min() > 0 else np.nan

    parts = [slope(seeds[seeds != one]) for one in seeds]
    return float(slope(seeds)), float(np.sqrt((len(seeds) - 1) * np.var(parts)))


def told(values, scale=1e-3):
    """Mean +- standard error over the seeds."""
    mean, error = ag.fit.mean_and_error(scale * values.transpose("seed").values)
    return f"{mean:7.2f}+-{error:4.2f}"


def print_path(title, data):
    """The moduli of each state, and the relations that the laws assume."""
    print(f"\n{title}: probes | fabric, kN/m")
    print("eps_zz    s_D     a2  " + "".join(f"{name:>13s} |fabric" for name in MODULI) + "  A/E:a2/2   EB/A2   (E-B)/2G")
    for k in range(data.sizes["state"]):
        one = data.isel(state=k)
        back, fabric = one.sel(source="back"), one.sel(source="fabric")
        both = "".join(f"{told(back[name]):>13s} |{1e-3 * float(fabric[name].mean()):6.2f}" for name in MODULI)
        E, A, B, G = (float(back[name].mean()) for name in MODULI)
        a2 = float(one.a2.mean())
        print(f"{float(one.eps_zz.mean()):6.4f} {float(one.s_D.mean()):6.3f} {a2:6.3f} {both}"
              f"   {A / E:5.3f}:{a2 / 2:5.3f} {E * B / A**2:7.2f} {(E - B) / (2 * G):8.2f}")  # fmt: skip
    unstable = (data.E * data.B < data.A**2).sel(source="back").isel(state=slice(1, None))
    print(f"  E B < A^2 in {int(unstable.sum())} of {unstable.size} states after the first")


def print_adhesion(data):
    """The moduli against adhesion, of the first and the last state."""
    for k in (0, data.sizes["state"] - 1):
        one = data.isel(state=k)
        print(f"\nAdhesion, p = 100 N/m, eps_zz = {float(one.eps_zz.mean()):.4f}: probes (elastic, k2) | fabric, kN/m")
        print("kc/k2    s_D   tr F " + "".join(f"{name:>13s} |fabric" for name in MODULI) + "   first loading/elastic E, G")
        for kc in one.contact_kc.values:
            case = one.sel(contact_kc=kc)
            forth, back, fabric = (case.sel(source=source) for source in ("forth", "back", "fabric"))
            both = "".join(f"{told(back[name]):>13s} |{1e-3 * float(fabric[name].mean()):6.2f}" for name in MODULI)
            ratio = [float(forth[name].mean() / back[name].mean()) for name in ("E", "G")]
            state = f"{kc / K2:5.1f} {float(case.s_D.mean()):6.3f} {float(case.fabric_trace.mean()):6.3f}"
            print(f"{state} {both}   {ratio[0]:.3f}, {ratio[1]:.3f}")


def print_fabric(title, data):
    """How the shear modulus goes with the fabric, over all states after the first."""
    states = data.isel(state=slice(1, None))
    G = states.G.sel(source="back")
    print(f"\nShear modulus against fabric, {title}, {G.size} states (Spearman's rank correlation; p = probability by chance)")
    ratio = states.G.sel(source="back") / states.G.sel(source="fabric")
    for words, other in (("trace of the fabric", states.fabric_trace), ("deviator of the fabric", states.fabric_deviator),
                         ("A from probes", states.A.sel(source="back")), ("sigma_V", states.sigma_V)):  # fmt: skip
        rank = stats.spearmanr(other.transpose(*G.dims).values.ravel(), G.values.ravel())
        print(f"  with {words:22s} {rank.statistic:6.2f} (p = {rank.pvalue:.1g})")
    print(f"  G from probes/G of the affine network: {float(ratio.min()):.2f} .. {float(ratio.max()):.2f}")


def print_probe(data):
    """The moduli against the size of the probe."""
    one = data.isel(state=-1)
    print(
        f"\nSize of the probe, kc = 0, mu = 0.5, p = 100 N/m, eps_zz = {float(one.eps_zz.mean()):.3f}: over that at 1e-5, elastic way back"
    )
    print("  probe  " + "".join(f"{name:>9s}" for name in MODULI) + "   misfit   forth/back E, G")
    reference = one.sel(source="back").sel(probe_asked=1e-5, method="nearest")
    for size in one.probe_asked.values:
        case = one.sel(probe_asked=size)
        back, forth = case.sel(source="back"), case.sel(source="forth")
        parts = "".join(f"{float(back[name].mean() / reference[name].mean()):9.4f}" for name in MODULI)
        ratio = [float(forth[name].mean() / back[name].mean()) for name in ("E", "G")]
        print(f"{size:8.0e} {parts} {float(case.misfit.sel(way='back').mean()):8.4f}   {ratio[0]:.4f}, {ratio[1]:.4f}")


def picture(data):
    """The Figure of all of it."""
    paths = {f"{title}, p = {p:g} N/m": data[name].sel(pressure=p) for title, name in PATHS.items() for p in data[name].pressure.values}
    adhesion = data["adhesion"].isel(state=-1)
    adhesion = adhesion.assign_coords(contact_kc=adhesion.contact_kc / K2)
    varied = {
        ("adhesion, last state", "contact_kc", "$k_c/k_2$"): adhesion,
        ("size of the probe, $\\mu$ = 0.5", "probe_asked", "strain of the probe"): data["probe"].isel(state=-1),
    }
    fabric = {title: data[name] for title, name in PATHS.items()}
    return plots.moduli_figure(paths, isotropic(data), varied, fabric)


if __name__ == "__main__":
    main(*sys.argv[1:3])
