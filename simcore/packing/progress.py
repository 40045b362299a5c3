"""Progress lines at intervals of wall-clock time, which excludes compiling; no result depends on them."""

from simcore.packing.packed import GENERATING, SHAKING
from simcore.provenance.cpu_time import working_clock


class Progress:
    """Reports each change of phase, and a line every scene.numerics.progress_interval [s] of wall-clock time."""

    def __init__(self, scene, report):
        self.scene, self.report = scene, report
        self.last_time = working_clock()
        self.last_step = 0

    def phase(self, text):
        """Report a sentence about the packing, such as a warning or the begin of a phase."""
        self.report(f"{self.scene.name}: {text}")

    def resume(self, step):
        """Begin to measure the rate at this step, which was read from a checkpoint and not reached by this process."""
        self.last_time, self.last_step = working_clock(), step

    def line(self, phase, step, dt, n_bodies, observed, end):
        """Report the rate since the last line and the time left. end: step at which the phase ends, or None."""
        now = working_clock()
        elapsed = now - self.last_time
        if elapsed < self.scene.numerics.progress_interval or step == self.last_step:
            return
        rate = (step - self.last_step) / elapsed
        self.last_time, self.last_step = now, step
        # When grains will all be inserted is not known, but at least the shaking after that is left.
        left = (end - step if end is not None else self.scene.shaking.duration / dt) / rate
        # The end of damping is a limit that is seldom reached.
        estimate = {
            GENERATING: f"> {left:.0f} s left, including the shaking",
            SHAKING: f"about {left:.0f} s left in this phase",
        }.get(phase, f"< {left:.0f} s left in this phase")
        self.report(
            f"{self.scene.name}: {phase}, t = {step * dt:.3f} s, {n_bodies} grains, kinetic energy "
            f"{observed.kinetic_energy:.2e} J, mean overlap {observed.mean_overlap:.1e} m, {rate:.0f} steps/s, "
            f"{estimate}"
        )
