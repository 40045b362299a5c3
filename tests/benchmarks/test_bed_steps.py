"""Steps of a whole bed, compared with those of its grains."""

from benchmarks.studies.bed_steps import steps_at_rest


def test_a_bed_needs_more_steps_than_its_stiffest_grain():
    """Among fixed neighbours a grain has at most the largest eigenvalue of the bed, because its matrix is a block."""
    of_bed, of_grain = steps_at_rest(0.3, 0.8, 1)
    assert 1.0 < of_bed / of_grain < 1.5
    assert of_bed < 14.0  # the bed came to rest with so many
