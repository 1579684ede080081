"""How often the intervals of a fit hold the truth, and what they cost: coverage beside seconds, for three ways to an error.

    python data_generation/fit_coverage.py fit_coverage.h5 [--quick]

Synthetic data of the exponential law with white noise, and with noise that remembers (correlation 0.8 between neighbours); one data
set, and three that share beta. A 95 % interval should hold the truth in 90 to 99 % of 200 trials. Then the size of a bootstrap: how
much its error scatters from seed to seed, and what it costs.
"""

import argparse
import time

import numpy as np
import xarray as xr

import anisogran as ag
from anisogran.files import check_writable, save_results

WAYS = "covariance", "profile", "bootstrap"
NOISES = {"white": 0.0, "remembering": 0.8}
KINDS = {"one data set": (0.4,), "three share beta": (0.3, 0.4, 0.5)}
POINTS = {"white": 100, "remembering": 300}
SIZES = 50, 100, 200, 400, 800
S_0, BETA, SCATTER = 0.05, 60.0, 0.02


def noise(rng, rho, shape):
    """Noise of variance 1 with the correlation rho^lag along its first axis."""
    values = rng.normal(size=shape)
    for i in range(1, shape[0]):
        values[i] = rho * values[i - 1] + np.sqrt(1.0 - rho**2) * values[i]
    return values


def fit(rng, rho, points, levels):
    """(result, {name: truth}) of one trial."""
    x = np.linspace(0.0, 0.1, points)
    scatter = SCATTER * noise(rng, rho, (points, len(levels)))
    curves = [s_max - (s_max - S_0) * np.exp(-BETA * x) for s_max in levels]
    sets = [ag.fit.DataSet(x, curve + scatter[:, k], label=str(k)) for k, curve in enumerate(curves)]
    result = ag.fit.relaxations(sets, {"beta": "all"} if len(levels) > 1 else None)
    truths = [{"s_0": S_0, "s_max": s_max, "beta": BETA} for s_max in levels]
    return result, {variable: truths[int(label)][name] for (label, name), variable in result.table.variables.items()}


def intervals(result, way, samples):
    """{name: (low, high)} by this way."""
    if way == "bootstrap":
        again = result.bootstrap(samples)
        return {name: again.interval(name) for name in result.values}
    if way == "profile":
        return {name: result.profile(name)[:2] for name in result.values}
    return {name: result.interval(name) for name in result.values}


def coverage(rng, kind, name, trials, samples):
    """{way: (lowest, highest share over the parameters, share of trustworthy fits, seconds for one trial)}; of the trustworthy ones."""
    inside, seconds, trusted = {way: [] for way in WAYS}, dict.fromkeys(WAYS, 0.0), 0
    for _ in range(trials):
        clock = time.perf_counter()
        result, truth = fit(rng, NOISES[name], POINTS[name], KINDS[kind])
        seconds["covariance"] += time.perf_counter() - clock
        trusted += bool(result.verdict)
        for way in WAYS if result.verdict else ():
            clock = time.perf_counter()
            found = intervals(result, way, samples)
            seconds[way] += time.perf_counter() - clock
            inside[way].append([found[key][0] <= value <= found[key][1] for key, value in truth.items()])
    shares = {way: np.mean(inside[way], axis=0) for way in WAYS}
    return {way: (shares[way].min(), shares[way].max(), trusted / trials, seconds[way] / trials) for way in WAYS}


def sizes(rng, seeds, numbers):
    """{samples: (relative scatter of the error of beta over seeds, seconds)}."""
    result, _ = fit(rng, 0.0, 100, (0.4,))
    table = {}
    for samples in numbers:
        clock = time.perf_counter()
        errors = [result.bootstrap(samples, seed).errors["beta"] for seed in range(seeds)]
        table[samples] = np.std(errors) / np.mean(errors), (time.perf_counter() - clock) / seeds
    return table


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--quick", action="store_true", help="a few trials and small bootstraps, to see that it runs")
    options = parser.parse_args(arguments)
    check_writable(options.file)
    trials, seeds, samples = (4, 3, 20) if options.quick else (200, 20, 200)
    rng = np.random.default_rng(20050603)
    rows = {}
    print(f"{trials} trials; share of 95 % intervals that hold the truth, over the parameters from the worst to the best")
    print(f"{'noise':>12} {'fit':>17} {'way':>11} {'lowest':>7} {'highest':>8} {'trusted':>8} {'seconds':>8}")
    for name in NOISES:
        for kind in KINDS:
            for way, row in coverage(rng, kind, name, trials, samples).items():
                rows[name, kind, way] = row
                print(f"{name:>12} {kind:>17} {way:>11} {row[0]:7.3f} {row[1]:8.3f} {row[2]:8.3f} {row[3]:8.3f}", flush=True)
    table = sizes(rng, seeds, SIZES[:2] if options.quick else SIZES)
    print("samples of the bootstrap   scatter of its error    seconds")
    for samples, (scatter, seconds) in table.items():
        print(f"{samples:24d} {scatter:22.3f} {seconds:10.2f}")
    save_results(options.file, _datasets(rows, table), {})
    return rows, table


def _datasets(rows, table):
    shape = len(NOISES), len(KINDS), len(WAYS)
    columns = np.array(list(rows.values())).T.reshape(4, *shape)
    names = "lowest", "highest", "trusted", "seconds"
    axes = ("noise", "kind", "way")
    scatter, seconds = np.array(list(table.values())).T
    return {
        "coverage": xr.Dataset(
            {name: (axes, column) for name, column in zip(names, columns, strict=True)},
            coords={"noise": list(NOISES), "kind": list(KINDS), "way": list(WAYS)},
        ),
        "bootstrap": xr.Dataset({"error": ("samples", scatter), "seconds": ("samples", seconds, {"units": "s"})}, {"samples": list(table)}),
    }


if __name__ == "__main__":
    main()
