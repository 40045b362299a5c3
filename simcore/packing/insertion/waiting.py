"""When the next batch of grains is due, at one of the regular checks of a packing."""

import math


def check_steps(check: float, dt: float) -> int:
    """Return the number of steps of dt [s] between two checks; check [s]: convergence.interval."""
    return max(round(check / dt), 1)


def steps_of_wait(interval: float, check: float, dt: float) -> int:
    """Return the number of steps of dt [s] between two batches: the interval, rounded up to whole checks.

    interval, check [s]: between batches, and convergence.interval. If the step does not divide the check, so many whole
    checks as fit exactly into the interval may be a few steps shorter than it; they are enough within a hundredth.
    """
    steps = check_steps(check, dt)
    whole = math.ceil(round(interval / dt) / steps)
    fitting = max(math.ceil((interval - 0.5 * dt) / check), 0)
    if fitting < whole and fitting * steps * dt > 0.99 * interval:
        return fitting * steps
    return whole * steps
