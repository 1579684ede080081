"""Pictures of runs, profiles and fits. The only room that imports matplotlib; every function returns a Figure and opens no window."""

import numpy as np
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from anisogran.averaging.grain_sums import nearest_image
from anisogran.glossary import label

COLOURS = {"dem": "#1b4965", "fit": "#d1495b", "local": "#8d99ae", "nonlocal": "#d1495b", "exponential": "#edae49"}
GRAIN = "#e9e4d8"
WALL = "#9a9184"
CHAIN = "#7a1f2b"
BRANCHES = {  # of a contact: colour and label
    "loading": ("#1b4965", "loading"),
    "elastic": ("#2a9d8f", "elastic un- and reloading"),
    "limit": ("#d1495b", "adhesive limit"),
    "open": ("#8d99ae", "open"),
}
SERIES = ("#1b4965", "#2a9d8f", "#edae49", "#e76f51", "#d1495b")
OVERLAP, FORCE = r"overlap $\delta/\delta_\mathrm{max}$", r"force $f/(k\,\delta_\mathrm{max})$"


def figure(columns, rows=1, width=4.4, height=3.5):
    """A Figure with an array of axes, shape (rows, columns)."""
    fig = Figure(figsize=(width * columns, height * rows), layout="constrained")
    return fig, fig.subplots(rows, columns, squeeze=False)


def draw_discs(axes, snapshot, mask, colour):
    """The grains of the mask (N,) as discs; `colour` is one, or one for each of them."""
    diameter = 2 * snapshot.radius[mask]
    axes.add_collection(
        EllipseCollection(
            diameter, diameter, np.zeros(len(diameter)), units="xy", offsets=snapshot.position[mask], transOffset=axes.transData,
            facecolors=colour, edgecolors="white", linewidths=0.2,
        )
    )  # fmt: skip


def branches(snapshot, first, second):
    """Lines (n, 2, 2) from the centres of the first grains to the nearest images of the second ones."""
    begin = snapshot.position[first]
    return np.stack([begin, begin + nearest_image(snapshot, snapshot.position[second] - begin)], axis=1)


def draw_packing(axes, snapshot, title="", colour=CHAIN):
    """Grains as discs and contact forces as lines between centres (or to the wall), as wide as the force is strong."""
    for mask, body in ((snapshot.free, GRAIN), (snapshot.fixed, WALL)):
        if mask.any():
            draw_discs(axes, snapshot, mask, body)
    first, second = snapshot.pairs.T
    inner = second >= 0
    lines = np.stack([snapshot.position[first], snapshot.point], axis=1)
    lines[inner] = branches(snapshot, first[inner], second[inner])
    strength = np.hypot(*snapshot.force.T)
    if strength.any():
        strong = strength > 0.05 * strength.mean()
        widths = 0.75 * strength[strong] / strength.mean()
        axes.add_collection(LineCollection(lines[strong], linewidths=widths, colors=colour, capstyle="round"))
    border = 2 * snapshot.radius.max()
    low, high = snapshot.position.min(axis=0) - border, snapshot.position.max(axis=0) + border
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", title=title)
    axes.set_axis_off()


def chain_figure(snapshot, chains, title=""):
    """The packing with its contact forces in grey, and on it the grains and links of the force chains, of `grain_chains`.

    Each chain has one colour; there are few colours, so chains apart may share one.
    """
    fig, axes = figure(1, width=6.0, height=6.0)
    draw_packing(axes[0, 0], snapshot, title, colour="0.6")
    chain, links = chains.chain_of.values, chains.links.values
    colour = np.array(SERIES)[chain % len(SERIES)]
    member = chain >= 0
    if member.any():
        draw_discs(axes[0, 0], snapshot, member, [(name, 0.45) for name in colour[member]])
        lines = branches(snapshot, *links.T)
        axes[0, 0].add_collection(LineCollection(lines, linewidths=2.5, colors=colour[links[:, 0]], capstyle="round"))
    return fig


def direction_figure(directions, title=""):
    """Of `contact_directions`: the contact normals as a polar histogram with its error bars and harmonics, and beside it the forces."""
    fig = Figure(figsize=(8.4, 3.8), layout="constrained")
    polar, forces = fig.add_subplot(1, 2, 1, projection="polar"), fig.add_subplot(1, 2, 2)
    if directions.contacts == 0:
        polar.set(title=title or "no contacts", yticks=[])
        return fig
    angle, density = directions.angle.values, directions.contact_density
    circle = np.linspace(0, 2 * np.pi, 361)

    def second(axis, turn=np.cos):
        return turn(2 * (circle - float(directions[axis])))

    polar.bar(angle, density, 2 * np.pi / len(angle), color=GRAIN, edgecolor="white", lw=0.4, label="contacts")
    polar.errorbar(angle, density, directions.contact_density_error, fmt="none", ecolor=WALL, elinewidth=0.8)
    wave = float(directions.a2) * second("axis") + float(directions.a4) * np.cos(4 * (circle - float(directions["axis"])))
    text = ", ".join(f"{label(name)} = {float(directions[name]):.2f}" for name in ("a2", "a4"))
    polar.plot(circle, (1 + wave) / (2 * np.pi), color=COLOURS["fit"], lw=1.6, label=text)
    polar.set(title=title, yticks=[], ylim=(0, None))
    polar.legend(fontsize=8, frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2)
    # the harmonics are those of f0 = <f_n>/(1 + a2 a_n cos 2(axes)/2), the mean over directions instead of contacts
    a_n, a_t = float(directions.a_n), float(directions.a_t)
    tilt = 2 * (float(directions["axis"]) - float(directions.normal_axis))
    level = 1 / (1 + 0.5 * float(directions.a2) * a_n * np.cos(tilt))
    for name, wave, text, colour in (
        ("normal_force", 1 + a_n * second("normal_axis"), "a_n", COLOURS["dem"]),
        ("tangential_force", -a_t * second("tangential_axis", np.sin), "a_t", SERIES[1]),
    ):
        text = f"{label(name)}, {label(text)} = {float(directions[text]):.2f}"
        forces.plot(np.degrees(angle), directions[name], "o", ms=3, color=colour)
        forces.plot(np.degrees(circle), level * wave, lw=1.6, color=colour, label=text)
    forces.axhline(0, color="0.7", lw=0.8)
    forces.set(xlabel=r"angle $\theta$ of the contact normal [degrees]", xlim=(0, 360), xticks=range(0, 361, 90))
    forces.legend(fontsize=8, frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    return fig


def biaxial_curves(series, fits, element=None):
    """Four pictures of a biaxial run: stresses, stress ratio with its fit, dilatancy, anisotropy with its fit.

    `fits` maps "s_D" and "anisotropy" to FitResults over eps_D; `element` is an element test of the scalar law, drawn if given.
    """
    fig, ((stress, ratio), (volume, structure)) = figure(2, 2)
    eps = series.eps_D.values
    for name in ("sigma_zz", "sigma_xx"):
        stress.plot(series.eps_zz, series[name], label=f"{label(name)} grains", lw=1.6)
    stress.plot(series.eps_zz, series.sigma_zz_wall, "k:", lw=1.2, label="same from wall forces")
    stress.plot(series.eps_zz, series.sigma_xx_wall, "k:", lw=1.2)
    stress.set(xlabel=label("eps_zz"), ylabel="stress [N/m]", ylim=(0, None))
    for axes, name in ((ratio, "s_D"), (structure, "anisotropy")):
        axes.plot(eps, series[name], color=COLOURS["dem"], lw=1.2, label="DEM")
        fit = fits[name]
        x = np.linspace(*fit.x_range, 200)
        axes.plot(x, fit.predict(x), color=COLOURS["fit"], lw=2, label="exponential fit" + ("" if fit.verdict else " (not trustworthy)"))
        axes.axvline(fit.x_range[1], color="0.7", lw=0.8, ls="--")
        axes.set(xlabel=label("eps_D") + " (half/half)", ylabel=label(name))
    ratio.annotate("fit ends", (fits["s_D"].x_range[1], 0.02), xytext=(4, 0), textcoords="offset points", color="0.5", fontsize=8)
    volume.plot(eps, series.eps_V, color=COLOURS["dem"], lw=1.6, label="DEM")
    volume.axhline(0, color="0.7", lw=0.8)
    volume.set(xlabel=label("eps_D") + " (half/half)", ylabel=label("eps_V") + " (half of the trace)")
    if element is not None:
        style = {"color": COLOURS["exponential"], "lw": 1.6, "label": "scalar law E, A, B"}
        ratio.plot(element.eps_D, element.s_D, **style)
        volume.plot(element.eps_D, element.eps_V, **style)
    for axes in (stress, ratio, volume, structure):
        axes.legend(fontsize=8, frameon=False)
    return fig


def packings(snapshots, titles, size=4.4):
    """Force chains of several snapshots side by side."""
    fig, axes = figure(len(snapshots), width=size, height=size)
    for place, snapshot, title in zip(axes[0], snapshots, titles, strict=True):
        draw_packing(place, snapshot, title)
    return fig


def friction_law(points, fit):
    """mu(I) and area fraction against I of homogeneous shear, with the fitted law."""
    fig, ((law, density),) = figure(2)
    law.errorbar(
        points.inertial_number,
        points.stress_ratio,
        points.stress_ratio_error,
        fmt="o",
        ms=4,
        color=COLOURS["dem"],
        label="DEM, periodic shear",
    )
    x = np.geomspace(float(points.inertial_number.min()) / 2, float(points.inertial_number.max()) * 1.5, 100)
    law.plot(x, fit.predict(x), color=COLOURS["fit"], label=r"$\mu_s + b\,I$")
    density.errorbar(points.inertial_number, points.area_fraction, points.area_fraction_error, fmt="o", ms=4, color=COLOURS["dem"])
    for axes, name in ((law, "stress_ratio"), (density, "area_fraction")):
        axes.set(xscale="log", xlabel=label("inertial_number"), ylabel=label(name))
    law.legend(fontsize=8, frameon=False)
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
        place.set(xlabel=f"depth {label('depth')}", ylabel=r"$v_\phi/V$, mean of 1 d rings")
    lowest = float((profiles.v_phi / wall_speed).where(profiles.v_phi > 0).min())
    axes[0, 1].set(yscale="log", ylim=(0.3 * lowest, 1.5))
    axes[0, 0].legend(fontsize=8, frameon=False)
    return fig


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


def draw_contact_path(axes, path, title=""):
    """The branches of one contact with their directions and marks, in units of its largest overlap and the force k delta_max there.

    k is the stiffness of un- and reloading; the ticks are the marks, with their values.
    """
    unit = np.array([path.delta_max, path.stiffness * path.delta_max])
    points = np.stack([path.overlap, path.force], axis=1) / unit
    axes.axhline(0, color="0.75", lw=0.8, zorder=0)
    # a point was reached on its branch, and so was the step that leads to it; a new run begins where branch or direction change
    ways = np.sign(np.diff(path.overlap, prepend=path.overlap[0]))
    begins = np.flatnonzero(np.append(True, (path.branch[1:] != path.branch[:-1]) | (ways[1:] != ways[:-1])))
    for begin, end in zip(begins, np.append(begins[1:], len(points)), strict=True):
        colour, _ = BRANCHES[path.branch[begin]]
        run = points[max(begin - 1, 0) : end]
        axes.plot(*run.T, color=colour, lw=2, solid_capstyle="round")
        half = 2 * len(run) // 5  # not in the middle, where the way back has its own
        if half > 0 and abs(run[-1, 0] - run[0, 0]) > 0.05:
            arrow = {"arrowstyle": "-|>", "color": colour, "mutation_scale": 14}
            axes.annotate("", run[half], xytext=run[half - 1], arrowprops=arrow)
    strongest = points[path.overlap.argmax()]
    zero, weakest = np.array([path.delta_0, 0.0]) / unit, np.array([path.delta_min, path.f_min]) / unit
    low, high = min(points[:, 1].min(), weakest[1]), strongest[1]
    left, bottom = points[:, 0].min() - 0.04, low - 0.12 * (high - low)
    for x, y in (strongest, zero, weakest):
        axes.plot([x, x, left], [bottom, y, y], color="0.6", lw=0.8, ls=":", zorder=0)
        axes.plot(x, y, "o", color="black", ms=4, zorder=5)
    axes.set_xticks(*marks({"0": 0.0, r"$\delta_0$": zero[0], r"$\delta_\mathrm{min}$": weakest[0], r"$\delta_\mathrm{max}$": 1.0}))
    axes.set_yticks(*marks({"0": 0.0, r"$f_\mathrm{min}$": weakest[1], r"$f_\mathrm{max}$": high}))
    axes.set(xlim=(left, 1.08), ylim=(bottom, high + 0.1 * (high - low)), xlabel=OVERLAP, ylabel=FORCE, title=title)
    handles = [Line2D([], [], color=colour, lw=2, label=text) for name, (colour, text) in BRANCHES.items() if name in path.branch]
    axes.legend(handles=handles, fontsize=8, frameon=False, loc="upper left")


def marks(places):
    """Places and labels of ticks, of {name: place}: the value below each name, one tick where several are at one place."""
    names = {}
    for name, place in places.items():
        names.setdefault(round(float(place), 9), []).append(name)
    return list(names), [" = ".join(found) + (f"\n{place:.3g}" if place else "") for place, found in names.items()]


def contact_law_figure(path, families):
    """One ContactPath with its branches and marks, and beside it `families` {title: {label: ContactPath}}, a panel each.

    The paths of a panel share their units, those of the last one; a dot is where un- and reloading meets the adhesive limit.
    """
    fig, axes = figure(1 + len(families), width=4.6, height=4.0)
    draw_contact_path(axes[0, 0], path, "branches of one contact")
    for place, (title, paths) in zip(axes[0, 1:], families.items(), strict=True):
        last = list(paths.values())[-1]
        length, scale = last.delta_max, last.stiffness * last.delta_max
        place.axhline(0, color="0.75", lw=0.8, zorder=0)
        for k, (name, member) in enumerate(paths.items()):
            colour = SERIES[k % len(SERIES)]
            place.plot(member.overlap / length, member.force / scale, color=colour, lw=1.6, label=name, zorder=2 - 0.01 * k)
            place.plot(member.delta_min / length, member.f_min / scale, "o", color=colour, ms=4)
        place.set(xlabel=OVERLAP, ylabel=FORCE, title=title)
        place.legend(fontsize=8, frameon=False, loc="upper left")
    return fig
