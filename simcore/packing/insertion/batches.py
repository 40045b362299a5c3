"""Places of the batches of a packing: on a lattice above the bed, at the heights of Rettinger et al., or at random.

Every rank draws the whole batch and takes its own grains. The objects here have no state that changes, so checkpoints
do not contain them: a batch follows from the number of grains inserted before it and from their top.
"""

import functools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from simcore.packing.insertion.initial_states import occupy_sites
from simcore.packing.insertion.random_placement import (
    check_reach,
    fall_time,
    fitting_grains,
    layer_grains,
    release_places,
    zone_height,
)
from simcore.packing.packed import PackingError
from simcore.scene.domain import lattice_sites
from simcore.scene.scene import R22_FIRST_FILL, REFILL_HEIGHT, Scene
from simcore.scene.shapes import Base, Draw, grain_volumes

FIRST_DRAWN = 1000  # grains that are drawn at least to find how many a mass has
CHECKED = 100_000  # grains of which none may be wider than the domain
MEAN_REACH = 200  # grains whose mean size gives the number of grains in a layer


class Batch(NamedTuple):
    """The drawn grains, places (n, 3) [m] of the first n of them, and the time [s] until the next batch may come."""

    drawn: Draw
    places: np.ndarray
    interval: float


class Pouring:
    """The batches of a scene's grains. Grains are inserted in the order of their ids."""

    def __init__(self, scene: Scene, bases: list[Base], draw: Callable):
        """bases: shapes of the grains; draw(ids (n,)) -> Draw."""
        self.scene, self.bases, self.draw = scene, bases, draw
        self._next_filled = functools.lru_cache(maxsize=1)(self._remaining_grains)

    def check_widths(self):
        """Raise PackingError if one of the grains is wider than the domain, as far as their number is known.

        At random places a grain may have any orientation. In a lattice it is upright, and sites that it does not fit
        into stay empty.
        """
        scene = self.scene
        if scene.generation.placement == "lattice" or scene.amount_grains is None:
            return
        reach, _ = extents(self.bases, self.draw(np.arange(min(scene.amount_grains, CHECKED))), any_orientation=True)
        try:
            check_reach(reach, scene.domain.width)
        except ValueError as error:
            raise PackingError(f"{scene.name}: {error}") from None

    def has_space(self, inserted: int, top: float, highest: Callable, last: bool = False) -> bool:
        """Return whether there is space for a batch above `top` [m] after `inserted` grains.

        last: also accept a batch of one layer (placement "lattice" with fill "bed") or of one grain (placement
        "filled"); otherwise it has no effect. highest() -> height of the highest centre and
        largest bounding radius [m]; called only for fill "r22".
        """
        generation, height = self.scene.generation, self.scene.domain.height
        if generation.placement == "random":
            _, drawn, reach = self._next_random(inserted)
            return top + generation.drop_height + self._zone(drawn, reach) <= height
        if generation.placement == "filled":
            _, _, reach, volumes = self._next_filled(inserted)
            area, fraction, available = self.scene.domain.area, generation.solid_fraction, height - top
            available -= generation.drop_height
            if last:
                return fitting_grains(reach, volumes, area, fraction, available) > 0
            return min(zone_height(reach, volumes, area, fraction), (1.0 - REFILL_HEIGHT) * height) <= available
        if generation.fill == "r22":
            high, radius = highest()
            return bool(high < REFILL_HEIGHT * height - max(generation.spacing, 2.0 * radius))
        return top + generation.drop_height < (1.0 if last else REFILL_HEIGHT) * height

    def needed_height(self, inserted: int, largest: float) -> float:
        """Return the height [m] above the bed without which no batch can follow `inserted` grains.

        largest [m]: diameter of the largest grain.
        """
        generation = self.scene.generation
        if generation.placement == "random":
            _, drawn, reach = self._next_random(inserted)
            return generation.drop_height + self._zone(drawn, reach)
        if generation.placement == "filled":
            _, _, reach, volumes = self._next_filled(inserted)
            grain = zone_height(reach[:1], volumes[:1], self.scene.domain.area, generation.solid_fraction)
            return generation.drop_height + grain
        if generation.fill == "r22":
            return (1.0 - REFILL_HEIGHT) * self.scene.domain.height + max(generation.spacing, largest) - 0.5 * largest
        return generation.drop_height

    def batch(self, inserted: int, top: float, touching: Callable) -> Batch:
        """Return the batch that follows `inserted` grains whose top is `top` [m]; PackingError if no grain fits.

        touching(drawn, places (n, 3)) -> (m, 2) indices of the grains that touch each other at these places.
        """
        if self.scene.generation.placement == "random":
            return self._random_batch(inserted, top, touching)
        if self.scene.generation.placement == "filled":
            return self._filled_batch(inserted, top, touching)
        return self._on_lattice(inserted, top)

    def volumes(self, drawn: Draw) -> np.ndarray:
        """Return the volumes (n,) [m³] of the drawn grains."""
        return grain_volumes(self.bases, drawn)

    # -- at random places -----------------------------------------------------------------------------------

    def _next_random(self, inserted):
        """Return ids, Draw and bounding radii [m] of the next batch."""
        scene, batch = self.scene, self.scene.generation.batch_grains
        if batch is None:
            number = MEAN_REACH if scene.amount_grains is None else min(MEAN_REACH, scene.amount_grains)
            radius, _ = extents(self.bases, self.draw(np.arange(number)), True)
            batch = layer_grains(radius, scene.domain.area)
        if scene.amount_grains is not None:
            batch = min(batch, scene.amount_grains - inserted)
        ids = np.arange(inserted, inserted + batch)
        drawn = self.draw(ids)
        return ids, drawn, extents(self.bases, drawn, True)[0]

    def _zone(self, drawn, reach):
        return zone_height(reach, self.volumes(drawn), self.scene.domain.area)

    def _random_batch(self, inserted, top, touching):
        """Return a batch at random places; its interval is the time to fall, or generation.batch_interval if given."""
        scene, generation = self.scene, self.scene.generation
        ids, drawn, reach = self._next_random(inserted)
        low = top + generation.drop_height
        height = self._zone(drawn, reach)
        if low + height > scene.domain.height:
            raise PackingError(
                f"{scene.name}: a batch of {len(ids)} grains needs the height from {low:.3g} m to {low + height:.3g} "
                f"m, but domain.height is {scene.domain.height:g} m. Lower generation.batch_grains, or raise "
                "domain.height"
            )
        places = self._free_places(ids, drawn, reach, (low, height), touching)
        interval = generation.batch_interval
        return Batch(drawn, places, self._time_to_fall(height) if interval is None else interval)

    def _free_places(self, ids, drawn, reach, zone, touching, turns=None):
        """Return places (n, 3) [m] at which no grains touch; zone: its lower end and height [m]."""
        scene, (low, height) = self.scene, zone
        try:
            return release_places(
                ids, reach, height, scene.domain, low, scene.seed, lambda places: touching(drawn, places), turns
            )
        except ValueError as error:
            raise PackingError(f"{scene.name}: {error}") from None

    def _time_to_fall(self, height):
        """Return the time [s] in which the grains of a zone of this height [m] fall onto the bed."""
        generation, gravity = self.scene.generation, self.scene.material.effective_gravity
        return fall_time(generation.drop_height + height, -generation.velocity_z, gravity)

    # -- filling a zone -------------------------------------------------------------------------------------

    def _remaining_grains(self, inserted):
        """Return ids, Draw, bounding radii [m] and volumes [m³] of all grains that are still to be inserted."""
        scene = self.scene
        if scene.amount_grains is not None:
            ids = np.arange(inserted, scene.amount_grains)
        else:
            whole = scene.amount_mass / scene.material.density
            ids = np.arange(FIRST_DRAWN)
            while (volumes := np.cumsum(self.volumes(self.draw(ids))))[-1] < whole:
                ids = np.arange(2 * len(ids))
            # At least one grain: the masses of inserted bodies are summed in another order.
            ids = ids[inserted : max(int(np.searchsorted(volumes, whole)), inserted) + 1]
        drawn = self.draw(ids)
        return ids, drawn, extents(self.bases, drawn, True)[0], self.volumes(drawn)

    def _filled_batch(self, inserted, top, touching):
        """Return a batch that fills its zone to generation.solid_fraction, large grains first.

        It has all remaining grains, or as many as fit below domain.height. Its interval is the time to fall.
        """
        scene, generation = self.scene, self.scene.generation
        ids, drawn, reach, volumes = self._next_filled(inserted)
        low, area, fraction = top + generation.drop_height, scene.domain.area, generation.solid_fraction
        count = fitting_grains(reach, volumes, area, fraction, scene.domain.height - low)
        if count == 0:
            raise PackingError(
                f"{scene.name}: no grain can be inserted between {low:.3g} m and domain.height = "
                f"{scene.domain.height:g} m; make the domain higher"
            )
        ids, reach, volumes = ids[:count], reach[:count], volumes[:count]
        drawn = Draw(*(values[:count] for values in drawn))
        height = zone_height(reach, volumes, area, fraction)
        turns = np.empty(count, np.int64)
        turns[np.argsort(-reach, kind="stable")] = np.arange(count)
        places = self._free_places(ids, drawn, reach, (low, height), touching, turns)
        return Batch(drawn, places, self._time_to_fall(height))

    # -- on a lattice ---------------------------------------------------------------------------------------

    def _on_lattice(self, inserted, top):
        """Return a batch on the lattice. It may have fewer places than drawn grains; its interval is 0."""
        scene, generation = self.scene, self.scene.generation
        if generation.fill == "r22":
            low = (R22_FIRST_FILL if inserted == 0 else REFILL_HEIGHT) * scene.domain.height
        else:
            low = top + generation.drop_height
        stretch = generation.stretch_x, generation.stretch_z
        sites = lattice_sites(scene.domain, generation.spacing, low, scene.domain.height, *stretch)
        wanted = len(sites) if scene.amount_grains is None else min(len(sites), scene.amount_grains - inserted)
        # At least one grain is drawn, so that the error below can give its size.
        ids = np.arange(inserted, inserted + max(wanted, 1))
        drawn = self.draw(ids)
        reach, half_height = extents(self.bases, drawn, generation.orientation == "random")
        sites[:, 2] += half_height[: len(sites)].max(initial=0.0)
        tallest, ceiling = half_height.max(initial=0.0), scene.domain.height
        if len(sites) and inserted > 0 and generation.fill == "bed":
            # The domain has no lid: the last layers may exceed the height of a domain that the bed nearly fills.
            ceiling = max(ceiling, sites[0, 2] + tallest)
        sites = sites[sites[:, 2] + tallest <= ceiling]
        taken = occupy_sites(sites, reach, half_height, scene.domain)
        if len(taken) == 0:
            raise PackingError(
                f"{scene.name}: no grain can be inserted between {low:.3g} m and domain.height = "
                f"{scene.domain.height:g} m in a {scene.domain.type} domain of width {scene.domain.width:g} m. Grains "
                f"are up to {2 * reach.max(initial=0.0):.3g} m wide; make the domain larger"
            )
        return Batch(drawn, sites[taken], 0.0)


def extents(bases: list[Base], drawn: Draw, any_orientation: bool):
    """Return the horizontal and vertical distance (n,), (n,) [m] that inserted grains reach from their centre.

    any_orientation: both are the radius of the bounding sphere.
    """
    if any_orientation:
        radius = np.zeros(len(drawn.shape))
    reach = np.zeros(len(drawn.shape))
    half_height = np.zeros(len(drawn.shape))
    for k, (shape, scale) in enumerate(zip(drawn.shape, drawn.scale, strict=True)):
        if len(bases[shape].vertices):
            corners = np.abs(bases[shape].vertices * scale)
            reach[k], half_height[k] = np.hypot(corners[:, 0], corners[:, 1]).max(), corners[:, 2].max()
            if any_orientation:
                radius[k] = np.sqrt((corners**2).sum(axis=1).max())
        else:
            reach[k], half_height[k] = max(scale[0], scale[1]), scale[2]
            if any_orientation:
                radius[k] = scale.max()
    return (radius, radius) if any_orientation else (reach, half_height)
