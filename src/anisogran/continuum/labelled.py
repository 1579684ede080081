"""A Flow as labelled arrays, for files and tables."""

import dataclasses

import xarray as xr

from anisogran.glossary import attributes

COLUMNS = ("v_phi", "shear_rate", "inertial_number", "pressure", "fluidity")


def flow_numbers(flow):
    """{name: number} of what a Flow says besides its profiles; torques and slip of both rings by name."""
    return {
        "stress_ratio_wall": flow.stress_ratio_wall,
        "torque_inner": flow.torques.inner,
        "torque_outer": flow.torques.outer,
        "torque_difference": flow.torques.difference,
        "slip_inner": flow.slip.inner,
        "slip_outer": flow.slip.outer,
        "ill_posed_share": flow.ill_posed_share,
        "iterations": flow.iterations,
        "seconds": flow.seconds,
    }


def flow_dataset(flow):
    """The profiles of a Flow as an xarray.Dataset over r, with units; its numbers, its law and its status are attributes.

    `converged` is 1 or 0: what NotConverged hands over is no solution. stress[i, j, r] in polar components (r, phi).
    """
    columns = {name: getattr(flow, name) for name in COLUMNS}
    variables = {name: ("r", values, attributes(name)) for name, values in columns.items() if values is not None}
    variables["stress"] = (("i", "j", "r"), flow.stress, attributes("stress"))
    law = flow.problem.law
    facts = {key: value for key, value in flow_numbers(flow).items() if value is not None}
    facts |= {"law": law.kind, **{f"law_{key}": value for key, value in dataclasses.asdict(law).items() if value is not None}}
    facts |= {"status": str(flow.status), "converged": int(bool(flow.status))}
    return xr.Dataset(variables, coords={"r": ("r", flow.r, attributes("r"))}, attrs=facts)
