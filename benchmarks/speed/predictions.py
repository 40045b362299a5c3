"""CPU time of many predictions of porosity with their intervals, from sieve curves and form statistics.

    python -m benchmarks.speed.predictions
    python -m benchmarks.speed.predictions --number 1000

There are two uses: many samples with one sieve curve (B50), and as many sieve curves with one sample each. Curves are
random, of two to eight classes; samples have random means and deviations of flatness and elongation about those of the
Rhine. The model is the one that `predict --sieve` uses. It and the models of one class are read before the clock
starts. A row has the number of predictions, how many of them are refused, the CPU time of all threads, and that of one
prediction.
"""

import argparse
import time

import numpy as np

from simcore.grains.measured_forms import Sample
from simcore.grains.sieve import SieveCurve
from simcore.grains.statistics import equancy_statistics
from simcore.models.fitting import fit_reference_models
from simcore.models.size_and_form.bed_prediction import predict_curve
from simcore.scene.sizes import all_cases

NUMBER = 10_000
CURVE = "B50"


def random_samples(number, rng):
    """Return a list of Samples whose means and deviations of FL and EL are drawn about those of the Rhine."""
    forms = rng.uniform([0.5, 0.1, 0.55, 0.1], [0.75, 0.2, 0.8, 0.2], (number, 4))
    return [Sample(f"s{i}", 40, *form, *map(float, equancy_statistics(*form))) for i, form in enumerate(forms.tolist())]


def random_curves(number, rng):
    """Return a list of SieveCurves of two to eight classes that are 1.1 to 1.9 wide, with random mass fractions."""
    curves = []
    for _ in range(number):
        k = int(rng.integers(2, 9))
        bounds = 1e-3 * np.cumprod(rng.uniform(1.1, 1.9, k + 1))
        curves.append(SieveCurve(bounds, rng.dirichlet(np.full(k, 0.7)), "random"))
    return curves


def uses(number, seed=0):
    """Return the two uses, dict from their name to a function that returns the number of refused predictions."""
    rng = np.random.default_rng(seed)
    fitted, samples, curves = fit_reference_models(), random_samples(number, rng), random_curves(number, rng)
    of_one_curve = all_cases()[CURVE].curve

    def one_curve():
        return int((predict_curve(of_one_curve, samples, fitted)["refused"] != "").sum())

    def many_curves():
        pairs = zip(curves, samples, strict=True)
        return sum(predict_curve(curve, [sample], fitted)["refused"].iloc[0] != "" for curve, sample in pairs)

    predict_curve(of_one_curve, samples[:1], fitted)  # reads the tables of the model
    return {f"samples with {CURVE}": one_curve, "sieve curves with one sample each": many_curves}


def measure(number):
    """Yield (use, refused predictions, CPU time [s]) of each use."""
    for name, run in uses(number).items():
        began = time.process_time()
        refused = run()
        yield name, refused, time.process_time() - began


def main(arguments=None) -> None:
    """Print one line per use."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--number", type=int, default=NUMBER, help=f"predictions of each use; default {NUMBER}")
    options = parser.parse_args(arguments)
    print("use,predictions,refused,cpu_s,cpu_ms_per_prediction")
    for name, refused, cpu in measure(options.number):
        print(f"{name},{options.number},{refused},{cpu:.1f},{1e3 * cpu / options.number:.2f}", flush=True)


if __name__ == "__main__":
    main()
