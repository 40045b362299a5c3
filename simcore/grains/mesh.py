# ruff: noqa: E741  L, I, S are the field's names of the axes
"""What a grain is: the convex hull of what was measured, in its principal frame, and its decimation."""

from dataclasses import dataclass, replace

import numpy as np
import trimesh

from simcore.grains.form import mass_equivalent_axes, sieve_size
from simcore.grains.polyhedron import convex_hull, face_areas, facet_areas, third_moments, volume_moments
from simcore.grains.spiral import spiral_directions

# Largest change of flatness and elongation by decimation.
FORM_TOLERANCE = 0.015
# A hull of fewer than this share of the faces asked for has lost more of the shape than it had to.
_LEAST_SHARE = 0.5
# Where the collapse of all triangles fails, it starts from the outermost vertices in so many directions.
_THINNED = (1500, 600)
# Largest stretch of an axis that gives a coarse hull the axes of its grain back.
_LARGEST_STRETCH = 1.1


@dataclass(frozen=True, eq=False)
class Grain:
    """A convex grain: centre of mass at the origin, S along x, I along y, L along z.

    vertices (n, 3) [m] all on the hull, faces (2n - 4, 3) outward, volume [m³], second_moments (3,) the means
    <x²>, <y²>, <z²> over the volume [m²], L >= I >= S [m] full axes of the mass-equivalent ellipsoid.
    hull_ratio: volume of the hull over the volume of the measured body, 1 for a convex one, nan where only points
    were measured. notes: sentences about how the grain was read that its user should see, without its name.
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
        """FL = S/I."""
        return self.S / self.I

    @property
    def elongation(self):
        """EL = I/L."""
        return self.I / self.L

    @property
    def sphericity(self):
        """Surface of the sphere of equal volume over the surface of the grain (Wadell); 1 for a sphere."""
        surface = face_areas(self.vertices, self.faces)[0].sum()
        return float(np.pi ** (1 / 3) * (6 * self.volume) ** (2 / 3) / surface)

    @property
    def facet_share(self):
        """Share of the surface in the ten largest facets, triangles within 5° of a facet's seed merged.

        It falls as the faces become more: compare grains of like face counts only.
        """
        areas = facet_areas(self.vertices, self.faces)
        return float(areas[:10].sum() / areas.sum())

    def scaled(self, scale):
        """The grain stretched along its axes by scale (3,) or a number.

        Diagonal scaling keeps the principal axes and scales S, I, L, so all follows without a new hull.
        ValueError if S <= I <= L no longer holds.
        """
        scale = np.broadcast_to(np.asarray(scale, float), 3)
        moments = self.second_moments * scale**2
        if not (np.all(scale > 0) and np.all(np.diff(moments) >= -1e-12 * moments[:2])):
            raise ValueError(f"grain {self.name!r} scaled by {scale}: x, y, z no longer are S <= I <= L")
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
    """The grain that is the convex hull of points (n, 3) [m], centred and aligned with its principal axes.

    The axes point to the side with the larger third moment (y and z; x follows, right-handed), so that the
    result does not depend on how the points were turned, unless two moments are equal. solid_volume: volume of the
    measured body [m³], nan if unknown; notes: as of Grain. ValueError as convex_hull, with the grain's name.
    """
    try:
        vertices, faces = convex_hull(points)
    except ValueError as error:
        raise ValueError(f"grain {name!r}: {error}") from None
    volume, centre, products = volume_moments(vertices, faces)
    moments, axes = np.linalg.eigh(products)  # ascending: S, I, L
    vertices = (vertices - centre) @ axes
    skew = third_moments(vertices, faces) / moments**1.5
    # the skew of a shape that is its own mirror image is round-off: keep to the input's directions there
    sign = np.sign(axes[np.abs(axes).argmax(0), range(3)])
    sign = np.where(np.abs(skew) > 1e-9, np.sign(skew), sign)
    sign[0] = sign[1] * sign[2] * np.sign(np.linalg.det(axes))
    L, I, S = (float(a) for a in mass_equivalent_axes(moments))
    ratio = float(volume / solid_volume)
    return Grain(name, vertices * sign, faces, float(volume), moments, L, I, S, ratio, tuple(notes))


def coarsen(grain, faces):
    """The grain with at most `faces` triangles and its form: hull of fewer vertices, realigned; volume not restored.

    A grain that has no more comes back unchanged. The triangles of the hull are collapsed at the least quadric error.
    Slivers, as of dense scans and of latitude-longitude grids, lead the collapse astray; then it starts from fewer
    vertices that are spread evenly, and at last the outermost vertices in evenly spread directions are taken as they
    are. The first hull counts whose flatness and elongation are the grain's to FORM_TOLERANCE. Where there is none,
    that which needs the least stretch along its axes to have the grain's form is stretched. ValueError if faces < 4,
    or if the stretch would be above 10 %.
    """
    if faces < 4:
        raise ValueError(f"grain {grain.name!r}: {faces} faces asked for, a closed body has at least 4")
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
            f"{grain.elongation:.3f} to {FORM_TOLERANCE}; give more `faces`"
        )
    return best[1].scaled(best[0])


def keeps_form(grain, coarse):
    """Whether flatness and elongation of the coarse grain are the grain's, to FORM_TOLERANCE."""
    changes = coarse.flatness - grain.flatness, coarse.elongation - grain.elongation
    return max(map(abs, changes)) <= FORM_TOLERANCE


def _coarse_hulls(grain, faces):
    """Hulls of at most `faces` triangles by one way after the other; None where a way fails."""
    yield _collapsed(grain, faces)
    for directions in _THINNED:
        if 4 * faces < directions < len(grain.vertices):
            yield _collapsed(make_grain(grain.name, _outermost(grain, directions)), faces)
    yield _supporting(grain, faces)


def _collapsed(grain, faces):
    """Hull of the collapsed mesh. It may have more triangles than the mesh, then the target is lowered."""
    # at size one: the collapse works in single precision
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
    """Hull of the outermost vertices in as many directions as it takes to come near to `faces` triangles."""
    best, directions = None, faces // 2 + 2  # a hull of v vertices has 2 v - 4 triangles
    for _ in range(8):
        points = _outermost(grain, directions)
        if len(points) > faces // 2 + 2:
            break
        try:
            best = make_grain(grain.name, points)
        except ValueError:  # a few directions of a flat grain may meet in one plane
            best = None
        directions = int(np.ceil(1.3 * directions))
    return best


def _outermost(grain, count):
    """The vertices (k, 3) that lie outermost in `count` directions, which are spread evenly over the grain."""
    rounded = grain.vertices / np.array([grain.S, grain.I, grain.L])
    blocks = np.array_split(spiral_directions(count), -(-count // 100))  # 100 directions at a time: little memory
    return grain.vertices[np.unique(np.concatenate([np.argmax(block @ rounded.T, axis=1) for block in blocks]))]


def decimate(grain, faces):
    """The grain with at most `faces` triangles (see coarsen), scaled back to its volume."""
    coarse = coarsen(grain, faces)
    return coarse.scaled((grain.volume / coarse.volume) ** (1 / 3))
