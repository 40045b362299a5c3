"""Longest stable time step of contact laws for a stone on a pebble on the floor, at the same static overlap.

    python -m benchmarks.studies.contact_law [--write]

It prints the table, or writes it to results/reference/contact_law.csv, in half a minute of CPU time. The pebble has the
mass m, the stone `mass_ratio` times as much; both move vertically. All this and all constants were committed before the
first run, but for the overlap `impact`: it was added because stiffening laws overlap less in impacts at the others.

Laws. The force of a contact at the overlap d is m_eff s d, with s = S (d / ε)^(p - 1) and the exponent p: p = 1 is
Scree's linear law, larger ones stiffen with depth (1.5: Hertz), 0.5 softens. S follows from the static overlap ε under
the stone; both contacts of the pebble then overlap by ε, because stiffness is proportional to the effective mass. The
damping is m_eff γ with γ = 2 ζ √((p + 1) / 2) √s, where ζ is the damping ratio of the linear law. The motion in
y = d^((p + 1) / 2) is then that of the linear law, so that every impact has the same restitution at any speed.

Overlaps. `linear`: ε is the overlap that Scree's linear law has in campaigns (a contact time of 0.5 ms, 14 implicit
steps). `equals`: ε is that overlap for a stone as heavy as the pebble, so that no stone sinks deeper than equals do.
`impact`: ε is chosen so that the largest overlap in the scene `impact`, with short steps, is that of the linear law at
the overlap `linear`. S is chosen for the step that is tried, so that all laws have the overlap ε also with
implicit dashpots, which soften springs.

Steps. Motion, dashpots and effective contacts are those of the compiled step, for explicit and for implicit dashpots.
A step is stable if three scenes of 10 000 steps are:

    loaded  The pebble gets a small velocity, 0.001 √(g ε), at its loaded equilibrium. In the last tenth of the steps
            the kinetic energy must not exceed that of this velocity.
    impact  At the same equilibrium the stone moves down at the largest speed of shaking, v. The pebble must not exceed
            2 v (a much heavier stone can give it 1.1 v), and the stone must not rise faster than v.
    alone   The pebble lies on the floor without a stone, with the law of the loaded one. It is judged as in `loaded`.

The longest stable step is that below which all tried steps are stable: steps are tried in ratios of 2^(1/8), and again
between the last stable and the first unstable one. It is compared with two bounds, with the force F of the stone, which
hold for explicit steps of any law that is linear or stiffens: 2 √(m ε / F) for one contact, and 2 √(m ε / (F + F_f))
for two, with the force F_f on the floor. The restitution is that of a pebble and a stone that meet at v without
gravity, at a fifth of the longest stable step (about that of campaigns), mean over phases of the first touch.
"""

import argparse
from typing import NamedTuple

import numpy as np
import pandas as pd

from simcore.dem.forces.spring_dashpot import (
    ContactLaw,
    contact_law,
    explicit_dashpot,
    implicit_dashpot,
    implicit_law,
    normal_force,
)
from simcore.paths import REFERENCE

TABLE = "contact_law.csv"
GRAVITY = 9.81  # [m/s²]
DIAMETER = 4e-3  # [m], of the pebble; only for its relative overlap
CONTACT_TIME, CAMPAIGN_STEPS = 5e-4, 14  # of the preset `wide`
RESTITUTION = 0.1
IMPACT_SPEED = 2.0 * np.pi * 3e-4 / 0.025  # [m/s], of shaking by 0.3 mm with a period of 25 ms
MASS_RATIOS = (1.0, 10.0, 100.0, 1000.0)
EXPONENTS = (0.5, 1.0, 1.5, 2.0, 3.0)
KICK = 1e-3  # initial velocity of the pebble in `loaded` and `alone`, over √(g overlap)
STEPS = 10_000
OCTAVES_BELOW, OCTAVES_ABOVE, TRIES = 7, 1, 64  # tried steps over the bound for one contact
SHARE = 5.0  # longest stable step over that of the restitution
PHASES = 16
SHORT = 100.0  # bound for two contacts over the step with which overlaps in the scene `impact` are computed
ROUNDS = 18  # of the search for ε
LINEAR = contact_law(RESTITUTION, CONTACT_TIME, 0.22, 0.0)  # Poisson's ratio has no effect in one dimension


class Pile(NamedTuple):
    """A stone on a pebble; all fields may be arrays that broadcast."""

    mass_ratio: np.ndarray  # of the stone to the pebble
    exponent: np.ndarray  # p
    overlap: np.ndarray  # [m], static one under the stone, ε

    @property
    def weights(self):
        """Weights of the contact in the effective contacts of the pebble and the stone, which are spheres here.

        As in simcore.dem.step.motion.count_effective_contacts.
        """
        ratio, size = self.mass_ratio, np.cbrt(self.mass_ratio)
        return ratio * (1.0 + size) / ((1.0 + ratio) * size), (1.0 + size) / (1.0 + ratio)

    @property
    def one_contact_bound(self):
        return 2.0 * np.sqrt(self.overlap / (self.mass_ratio * GRAVITY))

    @property
    def two_contact_bound(self):
        return 2.0 * np.sqrt(self.overlap / ((2.0 * self.mass_ratio + 1.0) * GRAVITY))


class Contacts(NamedTuple):
    """The contact law of a pile at a time step."""

    pile: Pile
    step: np.ndarray  # [s]
    implicit: bool
    stiffness: np.ndarray  # [1/s²], S
    damping: np.ndarray  # damping over the root of the stiffness

    def push(self, overlap, speed, effective_contacts):
        """Return the force per effective mass [m/s²]; speed [m/s]: of separation."""
        depth = np.maximum(overlap / self.pile.overlap, 1e-300)
        stiffness = self.stiffness * depth ** (self.pile.exponent - 1.0)
        law = ContactLaw(stiffness, self.damping * np.sqrt(stiffness), 1.0, 1.0, 0.0)
        if self.implicit:
            law = implicit_law(law, self.step)
            damping, _ = implicit_dashpot.py_func(law, np.maximum(effective_contacts, 1.0))
        else:
            damping, _ = explicit_dashpot.py_func(law)
        return np.where(overlap > 0.0, normal_force.py_func(law, damping, 1.0, overlap, speed, True), 0.0)


def contacts_at(pile: Pile, step, implicit: bool) -> Contacts:
    """Return the contact law of `pile` whose static overlap under the stone is pile.overlap at a time step [s]."""
    damping = LINEAR.damping / np.sqrt(LINEAR.stiffness) * np.sqrt(0.5 * (pile.exponent + 1.0))
    root = np.sqrt((1.0 + pile.mass_ratio) * GRAVITY / pile.overlap)
    # With implicit dashpots F / (m ε) = S / (1 + γ h / 2), a quadratic equation for √S.
    softening = 0.25 * root * damping * step if implicit else 0.0 * step
    stiffness = (root * (softening + np.sqrt(softening**2 + 1.0))) ** 2
    return Contacts(pile, step, implicit, stiffness, damping)


def static_overlap(mass_ratio, implicit: bool):
    """Return the overlap [m] of the pebble under the stone, in Scree's linear law with the settings of campaigns."""
    law = implicit_law(LINEAR, CONTACT_TIME / CAMPAIGN_STEPS) if implicit else LINEAR
    return (1.0 + mass_ratio) * GRAVITY / law.stiffness


def move(contacts: Contacts, position, velocity, steps: int, stone: bool = True):
    """Yield (positions, velocities) after each of the steps, both as in the arguments.

    position: (height of the pebble's lower end, that of the stone's without the pebble's diameter) [m]. velocity: (of
    the pebble, of the stone) [m/s]. stone: whether there is one.
    """
    pile, dt = contacts.pile, contacts.step
    (low, high), (slow, fast) = position, velocity
    of_pebble, of_stone = pile.weights
    share = pile.mass_ratio / (1.0 + pile.mass_ratio)
    on_pebble, on_stone, pair = 0.0, 0.0, 0.0  # effective contacts, counted in the step before as in the compiled step
    for _ in range(steps):
        floor = contacts.push(-low, slow, on_pebble)
        touching = 1.0 * (low < 0.0)
        if stone:
            pair = contacts.push(low - high, fast - slow, np.maximum(on_pebble, on_stone))
            meeting = 1.0 * (low > high)
            on_stone = of_stone * meeting
            touching = touching + of_pebble * meeting
            fast = fast + dt * ((1.0 - share) * pair - GRAVITY)
            high = high + dt * fast
        on_pebble = touching
        slow = slow + dt * (floor - share * pair - GRAVITY)
        low = low + dt * slow
        yield (low, high), (slow, fast)


def stays_at_rest(contacts: Contacts, stone: bool, steps: int = STEPS):
    """Return whether the scene `loaded`, or `alone` without a stone, is stable."""
    pile = contacts.pile
    depth = pile.overlap + 0.0 * contacts.step
    if not stone:
        depth = depth * (1.0 + pile.mass_ratio) ** (-1.0 / pile.exponent)
    kick = KICK * np.sqrt(GRAVITY * depth)
    largest = 0.0
    moved = move(contacts, (-depth, -2.0 * depth), (kick, 0.0 * kick), steps, stone)
    for k, (_, (slow, fast)) in enumerate(moved):
        if k >= steps - steps // 10:
            largest = np.maximum(largest, slow**2 + stone * pile.mass_ratio * fast**2)
    return largest <= kick**2


def bears_impact(contacts: Contacts, steps: int = STEPS):
    """Return whether the scene `impact` is stable."""
    stable = np.ones(np.broadcast_shapes(contacts.pile.overlap.shape, contacts.step.shape), bool)
    for _, (slow, fast) in _impact(contacts, steps):
        stable &= (np.abs(slow) <= 2.0 * IMPACT_SPEED) & (fast <= IMPACT_SPEED)
    return stable


def _impact(contacts, steps):
    depth = contacts.pile.overlap + 0.0 * contacts.step
    return move(contacts, (-depth, -2.0 * depth), (0.0 * depth, 0.0 * depth - IMPACT_SPEED), steps)


def impact_overlap(pile: Pile, implicit: bool):
    """Return the largest overlap (n,) [m] of the scene `impact`, until the stones of all piles (n,) have risen."""
    largest, risen = pile.overlap, False
    for (low, high), (_, fast) in _impact(contacts_at(pile, pile.two_contact_bound / SHORT, implicit), 10 * STEPS):
        largest = np.maximum(largest, np.maximum(-low, low - high))
        risen = risen | (fast > 0.0)
        if risen.all():
            return largest
    raise RuntimeError("A stone still falls after its impact. Allow more steps.")


def overlap_of_impact(pile: Pile, implicit: bool):
    """Return the static overlap (n,) [m] with which a law has the impact_overlap of the linear law at pile.overlap."""
    wanted = impact_overlap(pile._replace(exponent=np.ones_like(pile.exponent)), implicit)
    low, high = np.log(pile.overlap / 1e3), np.log(wanted)
    for _ in range(ROUNDS):
        middle = 0.5 * (low + high)
        deep = impact_overlap(pile._replace(overlap=np.exp(middle)), implicit) > wanted
        low, high = np.where(deep, low, middle), np.where(deep, middle, high)
    return np.exp(0.5 * (low + high))


SCENES = {
    "loaded": lambda contacts, steps: stays_at_rest(contacts, True, steps),
    "impact": bears_impact,
    "alone": lambda contacts, steps: stays_at_rest(contacts, False, steps),
}


def longest_stable_step(pile: Pile, implicit: bool, scene: str, steps: int = STEPS):
    """Return the longest stable step (n,) [s] in a scene; NaN if all tried steps are stable. Fields of pile: (n,)."""
    columns = Pile(*(values[:, None] for values in pile))
    low, high = pile.one_contact_bound / 2.0**OCTAVES_BELOW, pile.one_contact_bound * 2.0**OCTAVES_ABOVE
    beyond = np.zeros(len(low), bool)
    for refining in (False, True):
        tried = np.geomspace(low, high, TRIES + 1, axis=1)
        with np.errstate(over="ignore", invalid="ignore"):  # unstable motion grows without limit
            stable = SCENES[scene](contacts_at(columns, tried, implicit), steps)
        if not refining:
            if not stable[:, 0].all():
                raise RuntimeError(f"The shortest tried step is unstable in the scene {scene!r}. Try shorter ones.")
            beyond = stable.all(axis=1)
        first = np.where(stable.all(axis=1), TRIES, np.argmin(stable, axis=1))
        rows = np.arange(len(first))
        low, high = tried[rows, np.maximum(first - 1, 0)], tried[rows, first]
    return np.where(beyond, np.nan, low)


def restitution(pile: Pile, step, implicit: bool):
    """Return the mean restitution (n,) of the pebble and the stone, at time steps (n,) [s]."""
    columns, step = Pile(*(values[:, None] for values in pile)), step[:, None]
    contacts = contacts_at(columns, step, implicit)
    effective = np.maximum(*columns.weights)
    overlap = -(np.arange(PHASES) + 0.5) / PHASES * IMPACT_SPEED * step
    speed = np.full(overlap.shape, -IMPACT_SPEED)
    touched = 0.0
    while np.any((overlap > 0.0) | (speed < 0.0)):
        push = contacts.push(overlap, speed, effective * touched)
        touched = 1.0 * (overlap > 0.0)
        speed = speed + step * push
        overlap = overlap - step * speed
    return (speed / IMPACT_SPEED).mean(axis=1)


def listed_cases(implicit: bool) -> pd.DataFrame:
    """Return overlap_of, mass_ratio, exponent and overlap [m] of all rows of the table with this dashpot."""
    rows = [
        (of, ratio, exponent, static_overlap(1.0 if of == "equals" else ratio, implicit))
        for of in ("linear", "equals", "impact")
        for ratio in MASS_RATIOS
        for exponent in EXPONENTS
        # Other rows are equal to those of `linear`.
        if not (of == "equals" and ratio == 1.0 or of == "impact" and exponent == 1.0)
    ]
    cases = pd.DataFrame(rows, columns=["overlap_of", "mass_ratio", "exponent", "overlap"])
    of_impact = cases["overlap_of"] == "impact"
    cases.loc[of_impact, "overlap"] = overlap_of_impact(_pile(cases[of_impact]), implicit)
    return cases


def _pile(cases):
    return Pile(*(cases[name].to_numpy(float) for name in Pile._fields))


def contact_law_table(implicit: bool, cases: pd.DataFrame | None = None, steps: int = STEPS) -> pd.DataFrame:
    """Return the rows of the table with this dashpot. cases: instead of all of listed_cases."""
    cases = listed_cases(implicit) if cases is None else cases
    pile = _pile(cases)
    of_scene = {name: longest_stable_step(pile, implicit, name, steps) for name in SCENES}
    longest = np.nanmin(list(of_scene.values()), axis=0)
    table = cases[["overlap_of", "mass_ratio", "exponent"]].assign(relative_overlap=pile.overlap / DIAMETER)
    table.insert(0, "dashpot", "implicit" if implicit else "explicit")
    table["relative_impact_overlap"] = impact_overlap(pile, implicit) / DIAMETER
    table["restitution"] = restitution(pile, longest / SHARE, implicit)
    for name, values in of_scene.items():
        table[f"{name}_step_s"] = values
    return table.assign(
        step_s=longest, one_contact_bound_s=pile.one_contact_bound, two_contact_bound_s=pile.two_contact_bound
    )


def main(arguments=None) -> None:
    """Print the table, or write it with --write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help=f"write results/reference/{TABLE}")
    writing = parser.parse_args(arguments).write
    table = pd.concat([contact_law_table(implicit) for implicit in (True, False)], ignore_index=True)
    if writing:
        table.to_csv(REFERENCE / TABLE, index=False, lineterminator="\n", float_format="%.4g")
    else:
        print(table.to_string(index=False, float_format="%.3g", na_rep=""))


if __name__ == "__main__":
    main()
