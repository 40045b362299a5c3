"""Where the batches of a packing are born: on a lattice above the bed, at the study's heights, or strewn at random.

Every rank draws the whole of a batch and takes its own grains. Nothing here changes, so that nothing of it is kept: a
batch follows from the number of grains born before it and from the top of those.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from simcore.packing.insertion.initial_states import occupy_sites
from simcore.packing.insertion.random_placement import fall_time, layer_grains, release_places, zone_height
from simcore.packing.packed import PackingError
from simcore.scene.domain import lattice_sites
from simcore.scene.scene import R22_FIRST_FILL, REFILL_HEIGHT, Scene
from simcore.scene.shapes import Base, Draw, grain_volumes

MEAN_REACH = 200  # grains whose size says how many make up a layer


class Batch(NamedTuple):
    """Grains drawn, places (n, 3) [m] of the first n of them, and the time [s] before which no other is born."""

    drawn: Draw
    places: np.ndarray
    interval: float


class Pouring:
    """The batches of a scene's grains; they come by ids, so that each is asked for the grains born before it."""

    def __init__(self, scene: Scene, bases: list[Base], draw: Callable):
        """bases: shapes of the grains; draw(ids (n,)) -> Draw."""
        self.scene, self.bases, self.draw = scene, bases, draw

    def has_space(self, born: int, top: float, highest: Callable, last: bool = False) -> bool:
        """Whether a batch finds room above `top` [m]; last: be it as little as a layer of its lattice.

        highest() -> height of the highest centre and largest bounding radius [m], asked for fill "r22" alone.
        """
        generation, height = self.scene.generation, self.scene.domain.height
        if generation.placement == "random":
            _, drawn, reach = self._next_strewn(born)
            return top + generation.drop_height + self._zone(drawn, reach) <= height
        if generation.fill == "r22":
            high, radius = highest()
            return bool(high < REFILL_HEIGHT * height - max(generation.spacing, 2.0 * radius))
        return top + generation.drop_height < (1.0 if last else REFILL_HEIGHT) * height

    def batch(self, born: int, top: float, touching: Callable) -> Batch:
        """The batch that follows `born` grains which reach up to `top` [m]; PackingError where none finds room.

        touching(drawn, places (n, 3)) -> (m, 2) indices of the grains that touch each other there.
        """
        if self.scene.generation.placement == "random":
            return self._strewn(born, top, touching)
        return self._on_lattice(born, top)

    def volumes(self, drawn: Draw) -> np.ndarray:
        """Of grains, (n,) [m³]."""
        return grain_volumes(self.bases, drawn)

    # -- strewn at random -----------------------------------------------------------------------------------

    def _next_strewn(self, born):
        """Ids, draw and bounding radii [m] of the next batch."""
        scene, batch = self.scene, self.scene.generation.batch_grains
        if batch is None:
            first, _ = extents(self.bases, self.draw(np.arange(MEAN_REACH)), True)
            batch = layer_grains(first, scene.domain.area)
        if scene.amount_grains is not None:
            batch = min(batch, scene.amount_grains - born)
        ids = np.arange(born, born + batch)
        drawn = self.draw(ids)
        return ids, drawn, extents(self.bases, drawn, True)[0]

    def _zone(self, drawn, reach):
        return zone_height(reach, self.volumes(drawn), self.scene.domain.area)

    def _strewn(self, born, top, touching):
        """The next is due when it has fallen, or as given."""
        scene, generation = self.scene, self.scene.generation
        ids, drawn, reach = self._next_strewn(born)
        low = top + generation.drop_height
        height = self._zone(drawn, reach)
        if low + height > scene.domain.height:
            raise PackingError(
                f"{scene.name}: a batch of {len(ids)} grains is strewn from {low:.3g} m to {low + height:.3g} m, above "
                f"domain.height {scene.domain.height:g} m; lower generation.batch_grains or make the domain higher"
            )
        try:
            places = release_places(
                ids, reach, height, scene.domain, low, scene.seed, lambda places: touching(drawn, places)
            )
        except ValueError as error:
            raise PackingError(f"{scene.name}: {error}") from None
        interval = generation.batch_interval
        if interval is None:
            gravity = scene.material.effective_gravity
            interval = fall_time(generation.drop_height + height, -generation.velocity_z, gravity)
        return Batch(drawn, places, interval)

    # -- on a lattice ---------------------------------------------------------------------------------------

    def _on_lattice(self, born, top):
        """Places may be fewer than the grains drawn; the next is due when there is room for it."""
        scene, generation = self.scene, self.scene.generation
        if generation.fill == "r22":
            low = (R22_FIRST_FILL if born == 0 else REFILL_HEIGHT) * scene.domain.height
        else:
            low = top + generation.drop_height
        sites = lattice_sites(scene.domain, generation.spacing, low, scene.domain.height)
        wanted = len(sites) if scene.amount_grains is None else min(len(sites), scene.amount_grains - born)
        ids = np.arange(born, born + max(wanted, 1))  # one also where there is no site, so that the error has its size
        drawn = self.draw(ids)
        reach, half_height = extents(self.bases, drawn, generation.orientation == "random")
        sites[:, 2] += half_height[: len(sites)].max(initial=0.0)
        tallest, ceiling = half_height.max(initial=0.0), scene.domain.height
        if born > 0 and generation.fill == "bed":
            # There is no lid: the last layers may stand out of a domain that the bed nearly fills.
            ceiling = max(ceiling, sites[0, 2] + tallest)
        sites = sites[sites[:, 2] + tallest <= ceiling]
        taken = occupy_sites(sites, reach, half_height, scene.domain)
        if len(taken) == 0:
            raise PackingError(
                f"{scene.name}: no grain finds room at birth between {low:.3g} m and domain.height "
                f"{scene.domain.height:g} m in a {scene.domain.type} domain of width {scene.domain.width:g} m; grains "
                f"reach {2 * reach.max(initial=0.0):.3g} m across; make the domain larger"
            )
        return Batch(drawn, sites[taken], 0.0)


def extents(bases: list[Base], drawn: Draw, any_orientation: bool):
    """How far grains reach horizontally and vertically from their centre at birth, (n,) and (n,) [m]."""
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
