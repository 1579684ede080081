"""Radial profiles of the ring shear cell, and the continuum beside them."""

import numpy as np

from anisogran.glossary import label
from anisogran.plots.panels import Panel, panels_figure
from anisogran.plots.style import COLOURS, figure


def ring_fields(profiles, pressure):
    """Six radial profiles of the ring: density, rates, stress, fabric, spin, and what equilibrium asks of the stress."""
    fig, ((density, rate, stress), (fabric, spin, balance)) = figure(3, 2, width=4.2, height=3.3)
    depth, r = profiles.depth.values, profiles.r.values

    def bars(axes, value, error, name, colour=None, scale=1.0):
        axes.errorbar(depth, value / scale, error / scale, marker="o", ms=3, lw=1.2, capsize=2, label=name, color=colour)

    def plain(axes, name, scale=1.0):
        bars(axes, profiles[name].values, profiles[f"{name}_error"].values, label(name), scale=scale)

    plain(density, "area_fraction")
    density.set(ylabel=label("area_fraction"))
    plain(rate, "inertial_number")
    rate.set(yscale="log", ylabel=label("inertial_number"))
    sigma, sigma_error = profiles.stress.values, profiles.stress_error.values
    for (i, j), name in {
        (0, 0): r"$\sigma_{rr}$",
        (1, 1): r"$\sigma_{\phi\phi}$",
        (0, 1): r"$\sigma_{r\phi}$",
        (1, 0): r"$\sigma_{\phi r}$",
    }.items():
        bars(stress, sigma[i, j], sigma_error[i, j], name, scale=pressure)
    stress.set(ylabel="stress / outer pressure", ylim=(0, None))
    plain(fabric, "fabric_trace")
    bars(fabric, 4 * profiles.fabric_deviator.values, 4 * profiles.fabric_deviator_error.values, f"4 {label('fabric_deviator')}")
    fabric.set(ylabel="fabric")
    for name in ("spin", "continuum_spin", "eigen_rotation"):
        plain(spin, name)
    spin.axhline(0, color="0.7", lw=0.8)
    spin.set(ylabel="rotation [1/s]")
    torque = r**2 * 0.5 * (sigma[0, 1] + sigma[1, 0])
    balance.plot(depth, torque / torque.mean(), "o-", ms=3, label=r"$r^2\sigma_{r\phi}$ / mean")
    slope = np.diff(r * sigma[0, 0]) / np.diff(r)
    balance.plot(0.5 * (depth[1:] + depth[:-1]), slope / pressure, "s-", ms=3, label=r"$d(r\sigma_{rr})/dr$ / p")
    balance.plot(depth, sigma[1, 1] / pressure, "^-", ms=3, label=r"$\sigma_{\phi\phi}$ / p")
    balance.set(ylabel="equilibrium", ylim=(0, None))
    for axes in (density, rate, stress, fabric, spin, balance):
        axes.set(xlabel=f"depth {label('depth')}")
    for axes in (stress, fabric, spin, balance):
        axes.legend(fontsize=8, frameon=False)
    return fig


def velocity_comparison(profiles, comparisons, exponential, wall_speed):
    """v_phi of the DEM with error bars beside continuum curves and the two-parameter exponential, linear and logarithmic."""
    fig, axes = figure(2, width=4.8)
    depth = profiles.depth.values
    for place in axes[0]:
        place.errorbar(
            depth,
            profiles.v_phi / wall_speed,
            profiles.v_phi_error / wall_speed,
            fmt="o",
            ms=4,
            color=COLOURS["dem"],
            label="DEM",
            zorder=5,
        )
        for comparison in comparisons:
            place.plot(
                depth, comparison.table.v_phi / wall_speed, color=COLOURS[comparison.name], marker=".", lw=1.5,
                label=f"{comparison.name}, L2 = {comparison.l2:.2g}",
            )  # fmt: skip
        place.plot(depth, exponential / wall_speed, color=COLOURS["exponential"], ls="--", lw=1.2, label="exponential, 2 parameters")
        place.set(xlabel=f"depth {label('depth')}", ylabel=r"$v_\phi/V$, on rings of 1 d")
    lowest = float((profiles.v_phi / wall_speed).where(profiles.v_phi > 0).min())
    axes[0, 1].set(yscale="log", ylim=(0.3 * lowest, 1.5))
    axes[0, 0].legend(fontsize=8, frameon=False)
    return fig


def predictions_figure(tables):
    """A Figure of v_phi of grains and rivals over the depth, a logarithmic panel for each {title: Dataset of `comparison.predictions`}."""
    panels = []
    for title, table in tables.items():
        depth = table.depth.values
        dem = {"grains": (depth, table.v_phi_dem.values, table.v_phi_dem_error.values)}
        lowest = 0.1 * np.min(table.v_phi_dem.values, initial=np.inf, where=table.v_phi_dem.values > 0)
        curves = {
            f"{name}, L2 = {float(table.l2.sel(rival=name)):.2g}": (depth, down_to(lowest, v))
            for name, v in zip(table.rival.values, table.v_phi.values, strict=True)
        }
        panels.append(Panel(f"depth {label('depth')}", label("v_phi"), curves, dem, title=title, log="y"))
    return panels_figure(panels, columns=min(3, len(panels)))


def down_to(lowest, v):
    """Values of a curve that ends where it first falls to the lowest value, so that one that does so at once is still a line."""
    shown = np.append(True, np.cumprod(v[:-1] > lowest).astype(bool))
    return np.where(shown, np.maximum(v, lowest), np.nan)
