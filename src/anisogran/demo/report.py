"""The report of the demo: report.html for people, results.h5 for programs. Every number in it was computed by this run."""

from dataclasses import asdict
from pathlib import Path

import numpy as np

import anisogran
from anisogran import plots
from anisogran.cost.main_job import MainJob
from anisogran.demo.page import heading, number, page, paragraph, picture, table
from anisogran.files import json_text, save_results, write_text
from anisogran.glossary import CONVENTIONS


def write_report(findings, folder):
    """Writes report.html and results.h5 into the folder, each replaced only when it is complete."""
    folder = Path(folder)
    parts = [*summary(findings), *accuracy(findings), *grains(findings), *law(findings), *ring(findings), *provenance(findings)]
    write_text(folder / "report.html", page("anisogran demo: from grains to the continuum and back", parts))
    save_results(folder / "results.h5", datasets(findings), {"numbers": json_text(findings.numbers), "seed": findings.scene.seed})


def summary(findings):
    n = findings.numbers
    yield paragraph(
        f"{n['grain_steps']:.3g} grain-steps in {n['grains_s']:.0f} s on two cores (ring: {n['particle_steps_per_s']:.3g} grain-steps/s). "
        f"Seed {n['seed']}. Compression is positive; 2D invariants are half/half: eps_V = (e1+e2)/2, eps_D = (e1-e2)/2."
    )
    for reason in findings.reasons:
        yield paragraph(reason, "warning")
    yield table(
        ["station", "quantity", "value"],
        [
            ["biaxial box", "peak stress ratio s_D, and mobilised friction angle",
             f"{number(n['s_D_peak'])}, {n['friction_angle_peak_deg']:.1f} deg"],
            ["biaxial box", "final stress ratio s_D, and angle", f"{number(n['s_D_final'])}, {n['friction_angle_final_deg']:.1f} deg"],
            ["law", "s_max", (n["s_max"], n["s_max_err"])],
            ["law", "beta_s (per half/half eps_D)", (n["beta_s"], n["beta_s_err"])],
            ["law", "A_max (as a_2)", (n["A_max"], n["A_max_err"])],
            ["law", "beta_F (per half/half eps_D)", (n["beta_F"], n["beta_F_err"])],
            ["simple shear", "mu_s", (n["mu_s"], n["mu_s_err"])],
            ["simple shear", "b", (n["b"], n["b_err"])],
            ["ring", "decay length of v_phi in d: grains", (n["decay_length_dem"], n["decay_length_dem_err"])],
            ["ring", "decay length of v_phi in d: nonlocal continuum", n["decay_length_continuum"]],
            ["comparison", "relative L2 of v_phi: local mu(I)", n["l2_local"]],
            ["comparison", "relative L2 of v_phi: nonlocal fluidity (amplitude fitted on this ring)", n["l2_nonlocal"]],
            ["comparison", "relative L2 of v_phi: exponential with 2 parameters fitted on this ring", n["l2_exponential"]],
            ["comparison", "the same measure of the DEM's error bars", n["l2_noise"]],
        ],
    )  # fmt: skip


def accuracy(findings):
    """What the demo promised and found; nothing if no accuracy was asked for."""
    kept = findings.kept
    if kept is None:
        return
    promise, made = kept.promise, kept.promise.budget.made
    yield heading("Accuracy")
    yield paragraph(
        f"Asked: {promise.accuracy:g} in every answer. The knobs were chosen by the error budget measured on {made['date']} "
        f"({made['machine']}). Expected is the error of this demo and that of the best answer together; a profile counts in relative L2."
    )
    rows = [[name, kept.expected(name), found] for name, found in kept.found.items()]
    yield table(["answer", "expected to differ from the best one by", "found"], [*rows, ["seconds", promise.seconds, kept.seconds]])
    usual = MainJob().knobs(promise.choice)
    yield table(["knob", "chosen", "default"], [[name, float(value), float(usual[name])] for name, value in promise.choice.items()])
    parts = [
        [name, *(f"{source.cause} {error:.2g}" for source, error in promise.budget.parts(name, promise.choice)[:3])] for name in kept.found
    ]
    yield table(["answer", "largest cause of error", "second", "third"], parts)


def grains(findings):
    box, cell = findings.biaxial.snapshots, findings.ring.snapshots
    series = findings.biaxial.series
    at_peak = float(series.eps_zz[int(np.argmax(series.s_D.values))])
    yield heading("Grains")
    yield picture(
        plots.packings(
            [box["peak"], box["end"]],
            [f"box, eps_zz = {at_peak:.1%} (largest s_D)", f"box, eps_zz = {float(series.eps_zz[-1]):.1%}"],
        ),
        "Force chains in the biaxial box: lines join the centres of touching grains, as wide as the force is strong.",
    )
    yield picture(
        plots.packings([cell["end"]], ["ring shear cell at the end"], size=6.5),
        "Force chains in the ring shear cell. The inner ring of dark discs turns counter-clockwise, the outer one presses inwards.",
    )


def law(findings):
    found, scene = findings.law, findings.biaxial.scene
    yield heading("Constitutive law")
    yield picture(
        plots.biaxial_curves(findings.biaxial.series, found.fits, found.element),
        f"Biaxial compression at p = {scene.pressure:g} N/m, N = {scene.n}, friction {scene.friction.mu:g}{the_first_of(findings.boxes)}. "
        "Exponential laws "
        "s = s_max - (s_max - s_0) exp(-beta eps_D), fitted up to the peak; the dashed line marks where the fit ends. "
        f"Scalar law with E and B of the response and A = E a_2/2 of the fabric{found.element_remark}; its critical state is isochoric, "
        "so it cannot follow the dilation at the peak.",
    )
    rows = []
    for name, label in (("s_D", "stress ratio s_D"), ("anisotropy", "anisotropy a_2 of the fabric")):
        fit = found.fits[name]
        values = [(fit.values[key], fit.errors[key]) for key in ("s_0", "s_max", "beta")]
        rows.append([label, *values, f"{fit.points}", str(fit.verdict)])
    yield table(["evolution of", "start", "limit", "beta", "points", "verdict"], rows)
    start, peak, response = found.moduli_fabric_start, found.moduli_fabric_peak, found.response
    yield table(
        ["modulus [N/m]", "fabric, start", "fabric, peak", "response", "beta_s s_max sigma_V"],
        [
            ["E", float(start.E), float(peak.E), response["E"], ""],
            ["A", float(start.A), float(peak.A), "not determined by one isobaric path", ""],
            ["B", float(start.B), float(peak.B), response["B"], response["B_implied"]],
            ["G", float(start.G), float(peak.G), "", ""],
        ],
    )
    yield paragraph(
        "Fabric: a network of the unloading stiffness k2 and of k_t that moves affinely, an upper bound. Response: B from the first "
        f"slope of sigma_D, E from the first contraction ({response['points']} samples); loading follows the softer k1, and grains "
        "rearrange. Last column: B as the fit of s_D implies it."
    )
    yield picture(
        plots.friction_law(findings.shear, findings.friction),
        f"Homogeneous simple shear in a periodic cell, {findings.shear.sizes['test']} runs: the friction law that the continuum gets. "
        f"Fit: {findings.friction.verdict}.",
    )


def the_first_of(boxes):
    """Words on the box that is shown, if there are more; the table at the top has means over all."""
    return "" if len(boxes) == 1 else f", the first of {len(boxes)} boxes"


def parameters(law):
    """The parameters of a law to four digits, such as "mu_s = 0.2814, b = 1.085"."""
    return ", ".join(f"{key} = {number(value)}" for key, value in asdict(law).items() if value is not None)


def ring(findings):
    run, n = findings.ring, findings.numbers
    profiles, scene = run.profiles, run.scene
    yield heading("Ring shear cell: grains and continuum")
    yield picture(
        plots.velocity_comparison(profiles, findings.comparisons, findings.exponential, scene.wall_speed),
        f"Azimuthal velocity, averaged over the same rings of 1 d; DEM error bars from {profiles.attrs['blocks']} blocks "
        f"of {scene.block:g} d of wall travel. mu_s and b come from the homogeneous tests; the nonlocal amplitude "
        f"{n['nonlocal_amplitude']:.3g} was fitted on this very ring.",
    )
    rows = [
        [c.name, parameters(findings.flows[c.name].problem.law), c.l2, c.log_rms, c.decay_length_continuum, c.stress_ratio_wall_continuum,
         f"{findings.flows[c.name].iterations} in {findings.flows[c.name].seconds:.3f} s"]
        for c in findings.comparisons
    ]  # fmt: skip
    reference = findings.comparisons[0]
    rows.append(
        ["grains (DEM)", "", reference.l2_noise, (n["decay_length_dem"], n["decay_length_dem_err"]), reference.stress_ratio_wall_dem, ""]
    )
    rows.append(["exponential", "2 parameters fitted on this ring", n["l2_exponential"], n["log_rms_exponential"], "", "", ""])
    yield table(
        [
            "model",
            "law",
            "relative L2 of v_phi",
            "rms of ln v_phi",
            "decay length [d]",
            "stress ratio at the inner ring",
            "iterations",
        ],
        rows,
    )
    yield paragraph(
        "The row of the grains gives what their own error bars amount to. L2 weighs the fast rings, the logarithm all rings whose velocity "
        "is three times its error. The local law has no creep: beyond the radius where the "
        "stress ratio falls to mu_s it stands still, so it must fail in a slow cell."
    )
    yield picture(
        plots.ring_fields(profiles, scene.pressure),
        f"Profiles of the grains. Equilibrium: the spread of r^2 sigma_rphi over the rings is {n['torque_residual']:.1%}; "
        f"d(r sigma_rr)/dr differs from sigma_phiphi by {n['radial_residual']:.1%} of the pressure (rms, neighbouring rings).",
    )


def provenance(findings):
    yield heading("Where this comes from")
    ring, biaxial = findings.ring.provenance, findings.biaxial.provenance

    def text(value):
        return f"{value:.4g}" if isinstance(value, float) else str(value)

    yield table(["key", "ring shear cell", "biaxial box"], [[key, text(ring[key]), text(biaxial[key])] for key in ring])
    yield paragraph(f"anisogran {anisogran.__version__}. Conventions: {CONVENTIONS}.")


def datasets(findings):
    """What results.h5 holds: groups of labelled datasets."""
    groups = {"simple_shear/steady": findings.shear}
    for name, run in (("biaxial", findings.biaxial), ("ring", findings.ring)):
        groups |= {f"{name}/{group}".rstrip("/"): dataset for group, dataset in run.datasets().items()}
    for comparison in findings.comparisons:
        groups[f"comparison/{comparison.name}"] = comparison.table
    return groups
