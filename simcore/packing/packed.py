"""A finished packing, the phases of a packing, and the errors that end it early."""

from typing import NamedTuple

from simcore.dem.spread_contacts import Estimate
from simcore.dem.state.bodies import Bodies
from simcore.dem.state.contacts import CandidatePairs
from simcore.packing.observation import Observation

GENERATING, SHAKING, DAMPING = "generating", "shaking", "damping"


class PackingError(RuntimeError):
    """A packing failed: it did not come to rest, became unstable or does not fit. The message names grain and cause."""


class Interrupted(Exception):
    """A packing stopped because its keeper returned KEEP_AND_STOP; its checkpoint is written."""


class Stability(NamedTuple):
    """The time step of a packing, and the one that it needed."""

    steps: float  # per contact time
    expected: Estimate | None  # estimate before the run
    needed: float  # steps that the stiffest grain needs by itself; the whole bed needs more
    grain: int  # id of the stiffest; -1 if nothing ever touched
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
    mean_overlap: float = 0.0  # of the contacts between grains, in diameters, see simcore.packing.softness
    warnings: tuple = ()  # sentences on what may be wrong with the packing

    @property
    def contacts(self):
        """Contacts between grains, of the candidate pairs."""
        return self.candidates.contacts

    @property
    def walls(self):
        """Contacts with walls, of the candidate pairs."""
        return self.candidates.walls
