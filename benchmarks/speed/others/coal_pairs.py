"""CPU time of the same pairs in coal (GJK and EPA).

    python coal_pairs.py PAIRS.npz

It runs in an environment with `coal` and `cmeel-eigen`. The loop is C++ and is compiled here against the wheel (g++),
so that the time contains no Python. Cold queries start from coal's default guess; warm ones start from the guess and
the support vertices of the last query of the pair.
"""

import argparse
import json
import subprocess
import sysconfig
import tempfile
from pathlib import Path

import coal
import numpy as np

COLD_ROUNDS, WARM_ROUNDS = 20, 50
NOT_COMPARABLE = [
    "coal keeps a guess, not the facet, and runs EPA from its start at each query",
    "coal's default tolerance is 1e-6; where it ends says largest_difference_of_overlap",
    "coal's wheel is compiled for any x86-64, numba for this processor",
]


def compile_loop(folder):
    prefix = Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix"
    program = Path(folder) / "coal_pairs"
    subprocess.run(
        [
            *("g++", "-std=c++17", "-O3", "-DNDEBUG", "-w", str(Path(__file__).with_suffix(".cpp"))),
            *(f"-I{prefix / 'include'}", f"-I{prefix / 'include' / 'eigen3'}"),
            *(f"-L{prefix / 'lib'}", "-lcoal", f"-Wl,-rpath,{prefix / 'lib'}", "-Wl,--allow-shlib-undefined"),
            *("-o", str(program)),
        ],
        check=True,
    )
    return program


def write_text(path, pairs):
    """Write the pairs as text: their number, then the hulls, then the poses in order of pair, pose, side."""
    n = len(pairs["position"])
    with open(path, "w", encoding="utf-8") as file:
        print(n, file=file)
        for k in range(2 * n):
            vertices = pairs["vertices"][pairs["vertex_start"][k] : pairs["vertex_start"][k + 1]]
            faces = pairs["faces"][pairs["face_start"][k] : pairs["face_start"][k + 1]]
            print(len(vertices), len(faces), file=file)
            np.savetxt(file, vertices, fmt="%.17g")
            np.savetxt(file, faces, fmt="%d")
        poses = np.concatenate([pairs["rotation"], pairs["position"]], axis=-1)
        np.savetxt(file, poses.reshape(-1, 7), fmt="%.17g")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pairs")
    with np.load(parser.parse_args().pairs) as file:
        pairs = dict(file)
    with tempfile.TemporaryDirectory() as folder:
        program = compile_loop(folder)
        write_text(Path(folder) / "pairs.txt", pairs)
        command = [program, Path(folder) / "pairs.txt", str(COLD_ROUNDS), str(WARM_ROUNDS)]
        text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    (cold, *cold_depth), (warm, *warm_depth) = [[float(word) for word in line.split()] for line in text.splitlines()]
    error = {name: np.array(depth) - pairs["overlap"] for name, depth in (("cold", cold_depth), ("warm", warm_depth))}
    print(
        json.dumps(
            {
                "code": "coal",
                "version": coal.__version__,
                "cold_us": cold,
                "warm_us": warm,
                "pairs": len(pairs["position"]),
                "largest_difference_of_overlap": {k: float(np.abs(e).max()) for k, e in error.items()},
                "mean_overlap": float(pairs["overlap"].mean()),
                "not_comparable": NOT_COMPARABLE,
            }
        )
    )


if __name__ == "__main__":
    main()
