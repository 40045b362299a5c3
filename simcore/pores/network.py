"""Permeability along z by a network of pores and throats: SNOW (PoreSpy, Gostick 2017) and Stokes flow (OpenPNM).

A pore is a truncated pyramid as wide as the sphere of its volume, a throat a cuboid as wide as the largest sphere that
passes it, as in OpenPNM's example on extracted networks. Nothing is fitted to a bed or to a lattice.

The methods have no periodic sides. A periodic box is therefore extended by wrapped copies, one median grain wide, and
only the flow through the box itself counts. The sides of the extended box are walls.
"""

import numpy as np

# Layers that PoreSpy adds at an end, whose voxels become the pores at which the pressure is given.
END_LAYERS = 3


def network_permeability(image, margin):
    """Return the permeability of a PoreImage along z [m²]; 0 if no path of pores connects its ends.

    margin [m]: width of the copies at the sides of a periodic box. ValueError if the voxels are too large for any pore.
    """
    import openpnm
    import porespy

    edge = float(np.cbrt(image.spacing.prod()))  # the spacings differ by less than one part in the number of voxels
    pores, pad = extended(image.inside, image, margin)
    porespy.settings.tqdm["disable"] = True
    too_coarse = ValueError(
        f"pore network: PoreSpy finds no pore on voxels of {1e3 * edge:.3g} mm; choose a smaller --voxel"
    )
    if not pores.any():
        raise too_coarse
    try:
        extracted = porespy.networks.snow2(
            pores, boundary_width=[0, 0, END_LAYERS], voxel_size=edge, parallel_kw=None
        ).network
    except IndexError:  # what PoreSpy raises if it finds no pore
        raise too_coarse from None
    network = openpnm.io.network_from_porespy(extracted)
    health = openpnm.utils.check_network_health(network)
    openpnm.topotools.trim(network, pores=health["disconnected_pores"])
    if not network.Np or not network["pore.zmin"].any() or not network["pore.zmax"].any():
        return 0.0
    network["pore.diameter"] = network["pore.equivalent_diameter"]
    network["throat.diameter"] = network["throat.inscribed_diameter"]
    models = openpnm.models
    network.add_model(
        propname="throat.hydraulic_size_factors", model=models.geometry.hydraulic_size_factors.pyramids_and_cuboids
    )
    fluid = openpnm.phase.Phase(network=network)
    fluid["pore.viscosity"] = 1.0  # the permeability does not depend on it
    fluid.add_model(
        propname="throat.hydraulic_conductance", model=models.physics.hydraulic_conductance.generic_hydraulic
    )
    flow = openpnm.algorithms.StokesFlow(network=network, phase=fluid)
    flow.set_value_BC(pores=network.pores("zmin"), values=1.0)
    flow.set_value_BC(pores=network.pores("zmax"), values=0.0)
    flow.run(verbose=False, solver=openpnm.solvers.ScipySpsolve())
    rates = []
    for end in ("zmin", "zmax"):
        at_end = network.pores(end)
        column = network["pore.coords"][at_end][:, :2] / edge - pad
        in_box = ((column >= 0.0) & (column < image.pores.shape[:2])).all(axis=1)
        rates.append(abs(flow.rate(pores=at_end[in_box], mode="group")[0]))
    return float(np.mean(rates)) * image.height / image.area


def extended(pores, image, margin):
    """Return the voxels with wrapped copies at the sides of a periodic box, and how many voxels wide the copies are.

    pores: (nx, ny, n) of this PoreImage; margin [m]: the width, at most that of the box.
    """
    if not image.periodic:
        return pores, 0
    pad = min(int(np.ceil(margin / image.spacing[0])), pores.shape[0])
    return np.pad(pores, ((pad, pad), (pad, pad), (0, 0)), mode="wrap"), pad
