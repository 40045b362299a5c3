# ruff: noqa: E741  L, I, S are the field's names of the axes
"""What a grain is: the convex hull of what was measured, in its principal frame, and its decimation."""

from dataclasses import dataclass, replace

import numpy as np
import trimesh

from simcore.grains.form import mass_equivalent_axes, sieve_size
from simcore.grains.polyhedron import convex_hull, face_areas, facet_areas, third_moments, volume_moments


@dataclass(frozen=True, eq=False)
class Grain:
    """A convex grain: centre of mass at the origin, S along x, I along y, L along z.

    vertices (n, 3) [m] all on the hull, faces (2n - 4, 3) outward, volume [m³], second_moments (3,) the means
    <x²>, <y²>, <z²> over the volume [m²], L >= I >= S [m] full axes of the mass-equivalent ellipsoid.
    """

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    volume: float
    second_moments: np.ndarray
    L: float
    I: float
    S: float

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


def make_grain(name, points):
    """The grain that is the convex hull of points (n, 3) [m], centred and aligned with its principal axes.

    The axes point to the side with the larger third moment (y and z; x follows, right-handed), so that the
    result does not depend on how the points were turned, unless two moments are equal. ValueError as
    convex_hull, with the grain's name.
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
    return Grain(name, vertices * sign, faces, float(volume), moments, L, I, S)


def coarsen(grain, faces):
    """The grain with at most `faces` triangles: quadric edge collapse, hull, realigned; volume not restored.

    A grain that has no more comes back unchanged. The hull of a collapsed mesh may have more triangles than
    the mesh, then the target of the collapse is lowered until the hull obeys. ValueError if faces < 4.
    """
    if faces < 4:
        raise ValueError(f"grain {grain.name!r}: {faces} faces asked for, a closed body has at least 4")
    if len(grain.faces) <= faces:
        return grain
    # at size one: the collapse works in single precision
    mesh = trimesh.Trimesh(grain.vertices / grain.L, grain.faces, process=False)
    target = faces
    while True:
        points = mesh.simplify_quadric_decimation(face_count=target).vertices * grain.L
        coarse = make_grain(grain.name, points)
        if len(coarse.faces) <= faces:
            return coarse
        target -= len(coarse.faces) - faces


def decimate(grain, faces):
    """The grain with at most `faces` triangles (see coarsen), scaled back to its volume."""
    coarse = coarsen(grain, faces)
    return coarse.scaled((grain.volume / coarse.volume) ** (1 / 3))
