"""What a user should doubt in a solved flow: the range of its law, the mesh; and, no doubt as such, where it is ill posed in time."""

import numpy as np

COARSE = 0.5  # of the speed within one element; then the stress ratio of a ring is wrong by about 1e-3, at 0.8 by 1e-2


def beyond_the_law(status, law, profile):
    """The status, warned where the inertial number exceeds what the law is meant for."""
    fastest = int(np.argmax(profile.inertial_number))
    highest = profile.inertial_number[fastest]
    if highest <= law.valid_to:
        return status
    where = f"reaches {highest:.2g} at r = {profile.r[fastest]:g}"
    return status.warn(f"the inertial number {where}; the law is meant for I <= {law.valid_to:g}")


def between_mesh_points(status, r, v_phi, speed):
    """The status, warned where most of the speed falls within one element; r and v_phi on the mesh points along the radius."""
    falls = np.abs(np.diff(v_phi)) / speed
    worst = int(np.argmax(falls))
    if falls[worst] <= COARSE:
        return status
    where = f"falls within one element, {r[worst + 1] - r[worst]:.2g} wide at r = {r[worst]:g}"
    return status.warn(f"{100 * falls[worst]:.0f} % of the speed {where}: more elements are needed")


def ill_posed_share(law, point, weight, setting):
    """The share of the area where a flow in time would be ill posed; None for a law without a criterion, as for one that is nonlocal."""
    return float(np.sum(weight * law.ill_posed(point, setting)) / np.sum(weight)) if hasattr(law, "ill_posed") else None
