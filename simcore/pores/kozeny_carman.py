"""Permeability by Kozeny and Carman, and the hydraulic conductivity for water at 10 °C.

    k = n³ / (c S² (1 − n)²),   S the area of the grains over their volume.

c = 5 (Carman 1937) is the constant 180 of spheres of one size d, for which S = 6/d: k = n³ d² / (180 (1 − n)²). Ergun
(1952) fitted 150 instead. Macdonald et al. (1979) confirm 180 with many published measurements, and give a maximum
error of about ±50 %, which is the spread that is printed.
"""

CONSTANT = 5.0
SPREAD = 0.5
# Water at 10 °C and 0.1 MPa: viscosity by IAPWS R12-08, density by IAPWS-95.
VISCOSITY = 1.306e-3  # [Pa s]
DENSITY = 999.7  # [kg/m³]
GRAVITY = 9.80665  # [m/s²]
# The inertial term of Macdonald et al. (1979) for smooth grains is 1.8 ρ (1 − n) q² / (n³ d), that of friction
# 180 μ (1 − n)² q / (n³ d²). The first is a tenth of the second where q d ρ / (μ (1 − n)) is this number.
INERTIA = 10.0


def permeability(porosity, surface):
    """Return the permeability k [m²]; ValueError unless 0 < n < 1.

    surface: area of the grains over their volume [1/m].
    """
    if not 0.0 < porosity < 1.0 or not surface > 0.0:
        raise ValueError(f"permeability: the porosity {porosity:g} and the specific surface {surface:g} 1/m are no bed")
    return porosity**3 / (CONSTANT * surface**2 * (1.0 - porosity) ** 2)


def conductivity(permeability):
    """Return the hydraulic conductivity for water at 10 °C, k ρ g / μ [m/s]; permeability [m²]."""
    return permeability * DENSITY * GRAVITY / VISCOSITY


def darcy_limit(porosity, surface):
    """Return the hydraulic gradient at which inertia adds a tenth to the resistance of friction.

    Above it, the flow is slower than the conductivity predicts. The grain size is that of spheres, d = 6/S.
    """
    velocity = INERTIA * (1.0 - porosity) * VISCOSITY / (DENSITY * 6.0 / surface)
    return 1.1 * velocity / conductivity(permeability(porosity, surface))
