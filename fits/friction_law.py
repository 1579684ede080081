"""The laws mu = mu_s + b I and nu = nu_max - a I from homogeneous shear: `python fits/friction_law.py fits/data/ring_friction_law.h5`.

The file is made by data_generation/ring_friction_law.py. Each point is one run, so that runs of different seeds show their scatter.
"""

import sys

import numpy as np

import anisogran as ag
from anisogran.comparison import homogeneous_friction


def main(path):
    """Print the fits and the points; return the FitResult of mu(I)."""
    steady = ag.open(path, holds="shear/steady")["shear/steady"].to_dataset()
    data = steady.stack(test=["inertial_number_asked", "seed"]).dropna("test", subset=["stress_ratio"])
    data = data.isel(test=data.inertial_number.values < ag.models.LINEAR_LIMIT)
    fit = homogeneous_friction(data)
    print(fit)
    print(ag.fit.area_fraction(data.inertial_number.values, data.area_fraction.values, data.area_fraction_error.values))
    print("       I        mu     error    fit     area fraction   angle [degrees] of stress and fabric from the strain rate")
    names = ["inertial_number", "stress_ratio", "stress_ratio_error", "area_fraction", "rate_to_stress_angle", "rate_to_fabric_angle"]
    for I, mu, error, nu, *angles in zip(*(data[name].values for name in names), strict=True):
        stress, fabric = np.degrees(angles)
        print(f"{I:9.5f} {mu:8.4f} {error:8.4f} {float(fit.predict(I)):8.4f} {nu:9.4f} {stress:17.1f} {fabric:8.1f}")
    return fit


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) == 2 else sys.exit(__doc__))
