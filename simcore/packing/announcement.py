"""The progress line that a packing reports while its step is compiled."""

from simcore.dem.shapes.polyhedra import ELLIPSOID, MIXED, POLYHEDRON, SPHERE
from simcore.dem.state.features import Features

# CPU time [s] with an empty cache on the reference machine, rounded up: docs/reference/cost.md.
SECONDS = {SPHERE: 10, ELLIPSOID: 15, POLYHEDRON: 50, MIXED: 60}
KIND_WORDS = {
    SPHERE: "spheres",
    ELLIPSOID: "ellipsoids",
    POLYHEDRON: "convex polyhedra",
    MIXED: "ellipsoids and convex polyhedra",
}


def announcement(features: Features) -> str:
    """Return a sentence that says what is compiled and how long it takes, for the step with these features."""
    friction = "with" if features.friction or features.sliding else "without"
    return (
        f"Compiling the step for {KIND_WORDS[features.kind]} {friction} friction, once; this takes about "
        f"{SECONDS[features.kind]} s of CPU time."
    )
