# ruff: noqa: E741  L, I, S are the field's names of the axes
"""Grain: the convex hull of a measured body in its principal frame, and its decimation to fewer faces."""

from dataclasses import dataclass, replace

import numpy as np

from simcore.grains.form import mass_equivalent_axes, sieve_size
from simcore.grains.polyhedron import convex_hull, face_areas, facet_areas, third_moments, volume_moments
from simcore.grains.spiral import spiral_directions

# Largest change of flatness and elongation by decimation.
FORM_TOLERANCE = 0.015
# A hull with fewer than this share of the requested faces has lost more of the shape than necessary.
_LEAST_SHARE = 0.5
# If collapsing all triangles fails, the collapse starts from the outermost vertices in this number of directions.
_THINNED = (1500, 600)
# Largest stretch of an axis that may restore the form of a grain in its coarse hull.
_LARGEST_STRETCH = 1.1


@dataclass(frozen=True, eq=False)
class Grain:
    """Convex grain with its centre of mass at the origin, S along x, I along y, L along z.

    vertices: (n, 3) [m], all on the hull; faces: (2n - 4, 3), outward; volume [m³]; second_moments: (3,), the means
    <x²>, <y²>, <z²> over the volume [m²]; L >= I >= S: full axes of the mass-equivalent ellipsoid [m].
    hull_ratio: volume of the hull divided by the volume of the measured body; 1 for a convex body, nan if only points
    were measured. notes: predicates such as "has no faces; ..." for the user about how the grain was read, without the
    grain's name.
    """

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    volume: float
    second_moments: np.ndarray
    L: float
    I: float
    S: float
    hull_ratio: float = np.nan
    notes: tuple[str, ...] = ()

    @property
    def sieve_size(self):
        """Sieve size D [m]."""
        return float(sieve_size(self.I, self.S))

    @property
    def flatness(self):
        """Flatness FL = S/I."""
        return self.S / self.I

    @property
    def elongation(self):
        """Elongation EL = I/L."""
        return self.I / self.L

    @property
    def sphericity(self):
        """Wadell sphericity: surface of the sphere of equal volume divided by that of the grain; 1 for a sphere."""
        surface = face_areas(self.vertices, self.faces)[0].sum()
        return float(np.pi ** (1 / 3) * (6 * self.volume) ** (2 / 3) / surface)

    @property
    def facet_share(self):
        """Share of the surface in the ten largest facets; a facet merges triangles within 5° of its seed.

        It decreases with the number of faces, so only grains with similar numbers of faces can be compared.
        """
        areas = facet_areas(self.vertices, self.faces)
        return float(areas[:10].sum() / areas.sum())

    def scaled(self, scale):
        """Return the grain stretched along its axes x, y, z by scale, (3,) or a number.

        Stretching along the principal axes keeps them and scales S, I, L, so no new hull is needed.
        ValueError if S <= I <= L is violated after it.
        """
        scale = np.broadcast_to(np.asarray(scale, float), 3)
        moments = self.second_moments * scale**2
        if not (np.all(scale > 0) and np.all(np.diff(moments) >= -1e-12 * moments[:2])):
            raise ValueError(
                f"grain {self.name!r}: scaled by {scale}, its axes along x, y, z no longer satisfy S <= I <= L; choose "
                "factors that keep their order"
            )
        L, I, S = (float(a) for a in mass_equivalent_axes(moments))
        return replace(
            self,
            vertices=self.vertices * scale,
            volume=self.volume * float(np.prod(scale)),
            second_moments=moments,
            L=L,
            I=I,
            S=S,
        )


def make_grain(name, points, solid_volume=np.nan, notes=()):
    """Return the Grain that is the convex hull of points (n, 3) [m], centred and aligned with its principal axes.

    The axes y and z point to the side with the larger third moment, and x makes the frame right-handed, so the result
    does not depend on the orientation of the points, unless two moments are equal. solid_volume: volume of the measured
    body [m³], nan if unknown; notes: as in Grain. ValueError as in convex_hull, with the grain's name.
    """
    try:
        vertices, faces = convex_hull(points)
    except ValueError as error:
        raise ValueError(f"grain {name!r}: {error}") from None
    volume, centre, products = volume_moments(vertices, faces)
    moments, axes = np.linalg.eigh(products)  # ascending: S, I, L
    vertices = (vertices - centre) @ axes
    skew = third_moments(vertices, faces) / moments**1.5
    # The skew of a mirror-symmetric shape is round-off; there the axes keep the directions of the input.
    sign = np.sign(axes[np.abs(axes).argmax(0), range(3)])
    sign = np.where(np.abs(skew) > 1e-9, np.sign(skew), sign)
    sign[0] = sign[1] * sign[2] * np.sign(np.linalg.det(axes))
    L, I, S = (float(a) for a in mass_equivalent_axes(moments))
    ratio = float(volume / solid_volume)
    return Grain(name, vertices * sign, faces, float(volume), moments, L, I, S, ratio, tuple(notes))


def coarsen(grain, faces):
    """Return the grain with at most `faces` triangles and the same form; its volume is not restored.

    A grain with at most `faces` triangles is returned unchanged. Otherwise three methods are tried in turn: the
    triangles of the hull are collapsed at the least quadric error; as slivers (in dense scans and latitude-longitude
    grids) can spoil this collapse, it is repeated from fewer, evenly spread vertices; finally the hull of the outermost
    vertices in evenly spread directions is used. The first hull whose flatness and elongation agree with the grain's
    to FORM_TOLERANCE is returned. If there is none, the hull that needs the least stretch along its axes is stretched
    to the grain's form. ValueError if faces < 4, or if the stretch would exceed 10 %.
    """
    if faces < 4:
        raise ValueError(f"grain {grain.name!r}: {faces} faces are too few; a closed body has at least 4")
    if len(grain.faces) <= faces:
        return grain
    tried = []
    for coarse in _coarse_hulls(grain, faces):
        if coarse is None or len(coarse.faces) < _LEAST_SHARE * faces:
            continue
        coarse = replace(coarse, hull_ratio=grain.hull_ratio, notes=grain.notes)
        if keeps_form(grain, coarse):
            return coarse
        stretch = np.array([grain.S / coarse.S, grain.I / coarse.I, grain.L / coarse.L])
        tried.append((stretch / np.cbrt(stretch.prod()), coarse))
    best = min(tried, key=lambda pair: np.abs(np.log(pair[0])).max(), default=None)
    if best is None or np.abs(np.log(best[0])).max() > np.log(_LARGEST_STRETCH):
        raise ValueError(
            f"grain {grain.name!r}: no hull of {faces} faces has its flatness {grain.flatness:.3f} and elongation "
            f"{grain.elongation:.3f} within {FORM_TOLERANCE}; give more `faces`"
        )
    return best[1].scaled(best[0])


def keeps_form(grain, coarse):
    """Return whether flatness and elongation of the coarse grain agree with the grain's to FORM_TOLERANCE."""
    changes = coarse.flatness - grain.flatness, coarse.elongation - grain.elongation
    return max(map(abs, changes)) <= FORM_TOLERANCE


def _coarse_hulls(grain, faces):
    """Yield the hulls of at most `faces` triangles from the methods of coarsen, in turn; None if a method fails."""
    yield _collapsed(grain, faces)
    for directions in _THINNED:
        if 4 * faces < directions < len(grain.vertices):
            yield _collapsed(make_grain(grain.name, _outermost(grain, directions)), faces)
    yield _supporting(grain, faces)


def _collapsed(grain, faces):
    """Return the hull of the collapsed mesh, or None.

    The hull may have more triangles than the collapsed mesh; then the target is lowered.
    """
    import trimesh  # imported here because it loads slowly and most commands decimate no grain

    # The mesh is scaled to size one, because the collapse works in single precision.
    mesh = trimesh.Trimesh(grain.vertices / grain.L, grain.faces, process=False)
    target = faces
    while target >= 4:
        points = mesh.simplify_quadric_decimation(face_count=target).vertices * grain.L
        try:
            coarse = make_grain(grain.name, points)
        except ValueError:  # the mesh collapsed into a plane, or to fewer than four points
            return None
        if len(coarse.faces) <= faces:
            return coarse
        target -= len(coarse.faces) - faces
    return None


def _supporting(grain, faces):
    """Return the hull of the outermost vertices in enough directions to come close to `faces` triangles, or None."""
    best, directions = None, faces // 2 + 2  # a hull of v vertices has 2 v - 4 triangles
    for _ in range(8):
        points = _outermost(grain, directions)
        if len(points) > faces // 2 + 2:
            break
        try:
            best = make_grain(grain.name, points)
        except ValueError:  # the outermost vertices of a flat grain in a few directions may be in one plane
            best = None
        directions = int(np.ceil(1.3 * directions))
    return best


def _outermost(grain, count):
    """Return the outermost vertices (k, 3) in `count` directions that are spread evenly over the grain."""
    rounded = grain.vertices / np.array([grain.S, grain.I, grain.L])
    blocks = np.array_split(spiral_directions(count), -(-count // 100))  # 100 directions at a time limit the memory
    return grain.vertices[np.unique(np.concatenate([np.argmax(block @ rounded.T, axis=1) for block in blocks]))]


def decimate(grain, faces):
    """Return the grain with at most `faces` triangles (see coarsen), scaled back to its volume."""
    coarse = coarsen(grain, faces)
    return coarse.scaled((grain.volume / coarse.volume) ** (1 / 3))
