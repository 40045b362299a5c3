"""CPU time per grain and step in a shaken bed, for each kind of grain.

    python benchmarks/throughput.py [--grains 1000] [--threads 1] [--contact-time "1 ms"]

Pours U1 grains into a periodic box at 40 steps a contact time, lets them fall, and then
times stretches of shaking. Prints one CSV row a kind: kind, faces, grains, threads, contacts per grain, near pairs per
grain, microseconds of CPU per grain and step (median of the stretches, least, most), source digest.
"""

import argparse
import os
import sys
import time

KINDS = {"sphere": None, "ellipsoid": None, "mesh": (50, 100, 300)}
SETTLING, STRETCH, STRETCHES = 0.5, 400, 10  # [s], steps, number


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--grains", type=int, default=1000)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--contact-time", default="1 ms", help="the campaign's; the study's is 0.2 ms")
    options = parser.parse_args()
    os.environ["NUMBA_NUM_THREADS"] = str(options.threads)
    print("kind,faces,grains,threads,contacts_per_grain,near_pairs_per_grain,us_median,us_least,us_most,digest")
    for kind, faces in KINDS.items():
        for target in faces or (0,):
            print(measure(kind, target, options), flush=True)


def measure(kind, faces, options):
    from simcore.compilation import source_digest
    from simcore.dem.packing import SHAKING, Process
    from simcore.scenes import set_up
    from simcore.sources import load_grains
    from simcore.specification import resolve

    n_grains, threads = options.grains, options.threads
    width = 6.5e-3 * (n_grains / 10) ** (1 / 3)  # a bed about as high as the box is wide
    specification = resolve(
        {
            "name": f"{kind}{faces or ''}",
            "domain": {"width": f"{width} m", "height": f"{40 * width} m"},
            "faces": faces or 100,
            "shapes": {"kind": kind, "choice": "random"},
            "sizes": {"case": "U1"},
            "amount": {"grains": n_grains},
            "numerics": {"contact_time": options.contact_time, "progress_interval": "1000 s"},
        }
    )
    setup = set_up(specification, load_grains)
    process = Process(setup.scene, setup.bases, setup.draw, lambda line: print(line, file=sys.stderr))
    process.generate()
    process.advance(round(SETTLING / process.dt), SHAKING)
    times = []
    for _ in range(STRETCHES):
        started = time.process_time()
        process.advance(STRETCH, SHAKING)
        times.append((time.process_time() - started) / STRETCH / n_grains * 1e6)
    times.sort()
    contacts = process.contacts.touching.sum() / n_grains
    pairs = len(process.contacts.body_a) / n_grains
    middle = times[len(times) // 2]
    return (
        f"{kind},{faces},{n_grains},{threads},{contacts:.2f},{pairs:.2f},{middle:.3f},{times[0]:.3f},{times[-1]:.3f},"
        f"{source_digest()}"
    )


if __name__ == "__main__":
    main()
