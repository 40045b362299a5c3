"""How long a neighbour list stays valid: margins of the bodies, and how far ahead they look.

Where these constants come from: docs/constants_packing.md.
"""

import numpy as np

SKIN = 0.3  # twice the margin of a body at rest, in mean sieve sizes
WIDEST_MARGIN = 1.0  # cap on the extra margin of a fast body, in mean sieve sizes
LIST_INTERVAL = (100, 1000)  # steps: lists that hold for fewer look farther ahead, for more less far
AHEAD_STEP = 1.5


def skin_of(scene, mean_size) -> float:
    """Skin [m] of the neighbour list of grains of this mean sieve size [m]."""
    return (SKIN if scene.numerics.skin is None else scene.numerics.skin) * mean_size


def adapt_look_ahead(state, dt) -> None:
    """Lengthen or shorten the look-ahead time by how many steps the last list held, and note the list of this step."""
    held = state.step - state.listed_step
    if 0 < held < LIST_INTERVAL[0]:
        state.look_ahead = min(max(AHEAD_STEP * state.look_ahead, held * dt), LIST_INTERVAL[0] * dt)
    elif held > LIST_INTERVAL[1]:
        state.look_ahead /= AHEAD_STEP
    state.listed_step = state.step


def margins(bodies, state):
    """Way (n,) [m] that the points of each body may go before neighbours are listed anew."""
    spin = np.sqrt((bodies.angular_velocity**2).sum(axis=1))
    speed = np.sqrt((bodies.velocity**2).sum(axis=1)) + bodies.radius * spin
    # fmin: a speed that is not a number widens nothing; the next check reports it.
    return 0.5 * state.skin + np.fmin(state.look_ahead * speed, WIDEST_MARGIN * state.mean_size)
