"""Checks that the grains of a packing have space in its domain."""

from simcore.scene.domain import Domain


def check_height(domain: Domain, mass: float, density: float) -> None:
    """Raise ValueError if grains of this mass [kg] and density [kg/m³] would be higher than it even without pores."""
    solid = mass / (density * domain.area)
    if solid > domain.height:
        raise ValueError(
            f"domain.height: {mass:.3g} kg of grains would fill a {domain.type} domain {domain.width * 1e3:g} mm wide "
            f"to {in_mm(solid)} mm without a pore, above its {domain.height * 1e3:g} mm; make "
            "domain.height or domain.width larger, or reduce amount"
        )


def in_mm(length: float) -> str:
    """Return a length [m] in mm as text: in whole ones, or below 10 mm with two digits."""
    return f"{1e3 * length:.0f}" if 1e3 * length >= 9.5 else f"{1e3 * length:.2g}"
