"""A finished packing, the phases it went through, and the errors with which one ends unfinished."""

from typing import NamedTuple

from simcore.dem.stability import Estimate
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import CandidatePairs
from simcore.packing.observation import Observation

GENERATING, SHAKING, DAMPING = "generating", "shaking", "damping"


class PackingError(RuntimeError):
    """A packing that failed: it did not come to rest, blew up or does not fit. The message names grain and cause."""


class Interrupted(Exception):
    """A packing that stopped because its keeper asked it to; its checkpoint is written."""


class Stability(NamedTuple):
    """The time step that a packing had, and the one that it needed."""

    steps: float  # per contact time
    expected: Estimate | None  # before the run
    needed: float  # by the stiffest grain, each by itself; the whole bed needs more
    grain: int  # the stiffest; -1 where nothing ever touched
    contacts: int  # of that grain
    deepest: float  # largest overlap over the thinner grain's half thickness


class Packed(NamedTuple):
    """A packing that came to rest."""

    bodies: Bodies
    candidates: CandidatePairs
    observation: Observation
    steps: int
    time: float  # [s], simulated
    last_insertion: float  # [s], simulated
    checks: list  # (time [s], phase, Observation) at every convergence interval
    stability: Stability | None = None
    warnings: tuple = ()  # sentences on what may be wrong with it

    @property
    def contacts(self):
        return self.candidates.contacts

    @property
    def walls(self):
        return self.candidates.walls
