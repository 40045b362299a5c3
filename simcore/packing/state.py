"""State of a running packing besides its bodies and candidate pairs; checkpoints write and read it."""

from dataclasses import asdict, dataclass, field

from simcore.dem.energy import TotalEnergy
from simcore.packing.observation import Observation
from simcore.packing.packed import GENERATING


@dataclass
class WatchState:
    """State of the checks that is kept from one check to the next."""

    load: float = 0.0  # contact load of the stiffest grain so far; see simcore.dem.stability
    needed: float = 0.0  # steps per contact time that this grain needs by itself
    stiffest: int = -1  # its id
    contacts: int = 0  # number of its contacts
    deepest: float = 0.0  # largest overlap over the thinner grain's half thickness
    checks: int = 0  # number of checks
    warned_of_steps: bool = False
    warned_of_pinching: bool = False
    energy: TotalEnergy | None = None  # at the last check; None after bodies were added or changed from outside


@dataclass
class PackingState:
    """All that later steps depend on, besides bodies and candidate pairs.

    A stretch is the steps between two checks. Times are in steps.
    """

    phase: str = GENERATING
    step: int = 0
    shaking_end: int = 0
    damping_start: int = 0
    stretch_start: int = 0
    stretch_end: int = 0
    in_stretch: bool = False
    inserted: int = 0  # number of grains
    complete: bool = False  # no grain is left to insert
    next_insertion: int = 0  # step before which no batch is inserted
    space_deadline: int = 0  # step until which the last batch must have left space for the next
    last_insertion: int = 0
    mean_size: float = 0.0  # [m], mean of the sieve sizes of the last batch
    mean_height: float = 0.0  # [m], mean height at the last check while damping
    skin: float = 0.0  # [m], of the neighbour list
    look_ahead: float = 0.0  # [s], a body's margin includes the distance that it moves in this time
    listed_step: int = 0  # step of the last neighbour list
    checks: list = field(default_factory=list)  # (time [s], phase, Observation) at the end of each stretch
    watch: WatchState = field(default_factory=WatchState)

    def to_header(self) -> dict:
        """Return the state as a dict that JSON can store."""
        return {**vars(self), "checks": [(time, phase, *observed) for time, phase, observed in self.checks]} | {
            "watch": asdict(self.watch)
        }

    @classmethod
    def from_header(cls, header: dict):
        """Return the state that `to_header` stored; other keys of the header are ignored."""
        fields = {name: header[name] for name in cls.__dataclass_fields__}
        watch = WatchState(**fields.pop("watch"))
        if watch.energy is not None:
            watch.energy = TotalEnergy(*watch.energy)
        checks = [(time, phase, Observation(*observed)) for time, phase, *observed in fields.pop("checks")]
        return cls(**fields, checks=checks, watch=watch)
