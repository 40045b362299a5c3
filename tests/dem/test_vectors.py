"""Vectors of three numbers, compared with numpy, to the bit where the order of the sums is the same."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simcore.dem import vectors
from simcore.dem.vectors import Vec

PAIRS = 200
UNITS = [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.6, 0.0, -0.8)]


@pytest.fixture(scope="module")
def pairs():
    rng = np.random.default_rng(1)
    return rng.standard_normal((PAIRS, 2, 3)) * 10.0 ** rng.uniform(-8, 8, (PAIRS, 2, 1))


def test_sums_and_multiples_are_those_of_numpy_to_the_bit(pairs):
    for a, b in pairs:
        u, v, factor = Vec(*a), Vec(*b), b[0]
        assert vectors.plus(u, v) == tuple(a + b) and vectors.minus(u, v) == tuple(a - b)
        assert vectors.scaled(factor, u) == tuple(factor * a) and vectors.over(u, factor) == tuple(a / factor)
        assert vectors.plus_scaled(u, factor, v) == tuple(a + factor * b)
        assert vectors.minus_scaled(u, factor, v) == tuple(a - factor * b)
        assert vectors.negative(u) == tuple(-a)


def test_products_are_those_of_numpy(pairs):
    for a, b in pairs:
        u, v, size = Vec(*a), Vec(*b), np.linalg.norm(a) * np.linalg.norm(b)
        assert abs(vectors.dot(u, v) - a @ b) <= 1e-15 * size
        assert np.abs(np.array(vectors.cross(u, v)) - np.cross(a, b)).max() <= 1e-15 * size
        third = Vec(*(a - 2.0 * b)[::-1])
        volume = np.linalg.det([a, b, third])
        assert abs(vectors.triple(u, v, third) - volume) <= 1e-14 * size * np.linalg.norm(third)
        assert vectors.squared(u) == vectors.dot(u, u) and vectors.length(u) == np.sqrt(vectors.squared(u))


def test_the_part_across_a_unit_vector_is_perpendicular_to_it(pairs):
    for a, b in pairs:
        unit, size = vectors.direction_of(Vec(*b)), np.linalg.norm(a)
        part = vectors.across(Vec(*a), unit)
        assert abs(vectors.dot(part, unit)) <= 1e-15 * size
        assert vectors.beside(Vec(*a), unit) == vectors.length(part)
        assert abs(size**2 - (np.dot(a, unit) ** 2 + vectors.squared(part))) <= 1e-14 * size**2


def test_zero_has_the_direction_of_x():
    assert vectors.direction_of(vectors.ZERO) == (1.0, 0.0, 0.0)


@pytest.mark.parametrize("axis", UNITS)
def test_a_basis_is_right_handed_and_a_sideways_vector_perpendicular(axis, pairs):
    for unit in (Vec(*axis), *(vectors.direction_of(Vec(*a)) for a, _ in pairs)):
        frame = np.array([*vectors.basis(unit), unit])
        assert np.abs(frame @ frame.T - np.eye(3)).max() < 1e-15 and np.linalg.det(frame) > 0.0
        side = vectors.sideways(unit)
        assert vectors.dot(side, unit) == 0.0 and vectors.length(side) > 0.8  # √(2/3) at least


def test_axes_of_a_body_and_of_the_world_are_each_other_s_inverse():
    rotation = Rotation.random(5, rng=np.random.default_rng(2)).as_matrix()
    v = Vec(0.3, -1.2, 0.7)
    for i, matrix in enumerate(rotation):
        assert np.abs(np.array(vectors.out_of_axes(rotation, i, v)) - matrix @ v).max() < 1e-15
        assert np.abs(np.array(vectors.into_axes(rotation, i, v)) - matrix.T @ v).max() < 1e-15


def test_rows_are_read_and_written():
    array = np.arange(12.0).reshape(4, 3)
    assert vectors.read(array, 2) == (6.0, 7.0, 8.0)
    vectors.write(array, 1, Vec(-1.0, -2.0, -3.0))
    assert array[1].tolist() == [-1.0, -2.0, -3.0] and array[[0, 2, 3]].ravel().tolist() == [0, 1, 2, *range(6, 12)]
