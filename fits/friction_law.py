"""The laws mu = mu_s + b I and nu = nu_max - a I from homogeneous shear: `python fits/friction_law.py friction_law.h5`.

The file is made by data_generation/friction_law.py.
"""

import sys

import anisogran as ag

LARGEST = 0.2  # the linear law is not meant for faster flow


def main(path):
    """Print the fits and the points; return the FitResult of mu(I)."""
    data = ag.open(path, holds="steady")["steady"].to_dataset()
    data = data.isel(test=data.inertial_number.values < LARGEST)
    fit = ag.fit.mu_of_I(data.inertial_number.values, data.stress_ratio.values, data.stress_ratio_error.values)
    print(fit)
    print(ag.fit.area_fraction(data.inertial_number.values, data.area_fraction.values, data.area_fraction_error.values))
    print("       I        mu     error    fit     area fraction")
    for I, mu, error, nu in zip(data.inertial_number, data.stress_ratio, data.stress_ratio_error, data.area_fraction, strict=True):
        print(f"{float(I):9.5f} {float(mu):8.4f} {float(error):8.4f} {float(fit.predict(I)):8.4f} {float(nu):9.4f}")
    return fit


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) == 2 else sys.exit(__doc__))
