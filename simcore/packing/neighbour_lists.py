"""Margins of the neighbour list: how far a body may move before candidate pairs are listed anew.

The constants are justified in docs/explanation/constants_packing.md.
"""

import numpy as np

SKIN = 0.3  # twice the margin of a body at rest, in mean sieve sizes
WIDEST_MARGIN = 1.0  # cap on the extra margin of a fast body, in mean sieve sizes
LIST_INTERVAL = (100, 1000)  # steps: a list valid for fewer raises the look-ahead time, one valid for more lowers it
AHEAD_STEP = 1.5


def skin_of(scene, mean_size) -> float:
    """Return the skin [m] of the neighbour list of grains with this mean sieve size [m]."""
    return (SKIN if scene.numerics.skin is None else scene.numerics.skin) * mean_size


def adapt_look_ahead(state, dt) -> None:
    """Adapt the look-ahead time to how many steps the last list was valid for; store the step of the new list."""
    age = state.step - state.listed_step
    if 0 < age < LIST_INTERVAL[0]:
        state.look_ahead = min(max(AHEAD_STEP * state.look_ahead, age * dt), LIST_INTERVAL[0] * dt)
    elif age > LIST_INTERVAL[1]:
        state.look_ahead /= AHEAD_STEP
    state.listed_step = state.step


def margins(bodies, state):
    """Return the distance (n,) [m] that any point of a body may move before candidate pairs are listed anew."""
    spin = np.sqrt((bodies.angular_velocity**2).sum(axis=1))
    speed = np.sqrt((bodies.velocity**2).sum(axis=1)) + bodies.radius * spin
    # fmin ignores a speed that is not a number; the next check reports it.
    return 0.5 * state.skin + np.fmin(state.look_ahead * speed, WIDEST_MARGIN * state.mean_size)
