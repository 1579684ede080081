"""What is written down of a probed state: moduli from the probes and from the fabric side by side, and the probes themselves."""

import numpy as np
import xarray as xr

from anisogran.glossary import attributes
from anisogran.tensors import plane_parts

WAYS = ("forth", "back")
SOURCES = (*WAYS, "fabric")
MODULI = ("E", "A", "B", "G")
CLOCK = ("time", "cell_width", "cell_height")  # of a row of the series, not of a state
TEST_AXES = np.array([1.0, -1.0, 1.0])  # of the half/half parts in the axes x, z: deviators are zz - xx


def moduli_row(ways, fabric, size, phi_C):
    """{"E forth": ...} of the moduli from the ways of the probes of this size, and from the fabric {"E": ..., ...}, with the misfits."""
    from anisogran.fitting import probed_moduli  # slow to import, and only needed here

    row = {f"{name} fabric": float(fabric[name]) for name in MODULI}
    for source in WAYS:
        some = [way for way in ways if way.way == source]
        d_eps, d_sigma = (np.stack([getattr(way, name) for way in some], axis=2) for name in ("d_eps", "d_sigma"))
        fit = probed_moduli(d_eps, d_sigma, phi_C=phi_C)
        row |= {f"{name} {source}": fit.values[name] for name in MODULI}
        row[f"misfit {source}"] = fit.residuals["rms"] / (fit.values["E"] * size)
    return row


def probe_row(way, state):
    """The row of one way of a probe, of the state with this number."""
    eps, sigma = plane_parts(way.d_eps) * TEST_AXES, plane_parts(way.d_sigma) * TEST_AXES
    return {
        "probed_state": state,
        "way": 1 if way.way == "forth" else -1,
        **{f"d_eps_{part}": float(value) for part, value in zip(("V", "D", "xz"), eps, strict=True)},
        **{f"d_sigma_{part}": float(value) for part, value in zip(("V", "D", "xz"), sigma, strict=True)},
        "contacts_opened": way.opened,
        "contacts_closed": way.closed,
        "imbalance": way.imbalance,
    }


def tables_of(records):
    """{"moduli": Dataset over (state, source) with what else is known of the states, "probes": Dataset over the ways of all probes}."""
    if "moduli" not in records.tables:
        return {}
    rows, ways = records.tables["moduli"], records.tables["probes"]
    single = {name: ("state", [row[name] for row in rows], attributes(name)) for name in rows[0] if " " not in name and name not in CLOCK}
    for names, dim, sources in ((MODULI, "source", SOURCES), (("misfit",), "way", WAYS)):
        single |= {
            name: (("state", dim), [[row[f"{name} {source}"] for source in sources] for row in rows], attributes(name)) for name in names
        }
    probes = {name: ("probe", [way[name] for way in ways], attributes(name)) for name in ways[0]}
    return {"moduli": xr.Dataset(single, {"source": list(SOURCES), "way": list(WAYS)}), "probes": xr.Dataset(probes)}
