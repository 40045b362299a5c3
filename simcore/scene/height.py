"""Checks that the grains of a packing have space in its domain."""

from simcore.scene.domain import Domain


def check_height(domain: Domain, mass: float, density: float) -> None:
    """Raise ValueError if grains of this mass [kg] and density [kg/m³] would be higher than it even without pores."""
    solid = mass / (density * domain.area)
    if solid > domain.height:
        raise ValueError(
            f"domain.height: {mass:.3g} kg of grains would fill a {domain.type} domain {domain.width * 1e3:g} mm wide "
            f"to {solid * 1e3:.0f} mm without a pore, above its {domain.height * 1e3:g} mm; make "
            "domain.height or domain.width larger, or reduce amount"
        )
