"""The stage of a step that finds contacts: kernels for each kind of scene, for pairs and for walls.

The kernels do not depend on the force law: `simcore.dem.step.step` selects them by constants. Each kernel writes to the
arrays whether a pair or a wall touches, its overlap, direction and point. The kernels for pairs treat the contacts from
`begin` to `end`. The kernels take the parts of State one by one, because a parallel loop of numba can use a tuple only
if the tuple is an argument of the function.
"""

from numba import get_thread_id, prange

from simcore.compilation import loops
from simcore.dem.contact.find_contact import (
    check_ellipsoids,
    check_mixed,
    check_polyhedra,
    check_potentials,
    check_spheres,
    search_ellipsoids,
    search_mixed,
    search_polyhedra,
    search_potentials,
)
from simcore.dem.contact.find_contact import find_inflated as find_inflated_contact
from simcore.dem.contact.patch.patch import find_patch
from simcore.dem.contact.walls import (
    cylinder_convex,
    cylinder_ellipsoid,
    cylinder_patch,
    cylinder_sphere,
    floor_convex,
    floor_ellipsoid,
    floor_patch,
    floor_sphere,
)
from simcore.dem.shapes.polyhedra import is_polyhedron
from simcore.dem.state.bodies import FLOOR
from simcore.dem.state.touches import partner_offset


@loops
def find_spheres(bodies, contacts, drive, begin, end, has):
    """Find the contacts of spheres; no pair is ever pending."""
    for p in prange(begin, end):
        check_spheres(bodies, contacts, p, drive.width, has.periodic)


@loops
def find_ellipsoids(shapes, bodies, contacts, drive, begin, end, has):
    """Find the contacts of ellipsoids by their common normal: first from remembered contacts, then by search.

    The search has its own loop, as in the kernels below: it is rare and slow, and stays out of the fast loop.
    """
    for p in prange(begin, end):
        check_ellipsoids(shapes, bodies, contacts, p, drive.width, has.periodic)
    for p in prange(begin, end):
        if contacts.pending[p] != 0:
            search_ellipsoids(shapes, bodies, contacts, p, drive.width, has.periodic)


@loops
def find_potentials(shapes, bodies, contacts, drive, begin, end, has):
    """Find the contacts of ellipsoids by their potentials."""
    for p in prange(begin, end):
        check_potentials(shapes, bodies, contacts, p, drive.width, has.periodic)
    for p in prange(begin, end):
        if contacts.pending[p] != 0:
            search_potentials(shapes, bodies, contacts, p, drive.width, has.periodic)


@loops
def find_polyhedra(shapes, bodies, contacts, drive, begin, end, has):
    """Find the contacts of convex polyhedra."""
    for p in prange(begin, end):
        check_polyhedra(shapes, bodies, contacts, p, drive.width, has.periodic)
    for p in prange(begin, end):
        if contacts.pending[p] != 0:
            search_polyhedra(shapes, bodies, contacts, p, drive.width, has.periodic)


@loops
def find_mixed(shapes, bodies, contacts, drive, begin, end, has):
    """Find the contacts of ellipsoids and convex polyhedra, by the kinds of the two bodies."""
    for p in prange(begin, end):
        check_mixed(shapes, bodies, contacts, p, drive.width, has.periodic)
    for p in prange(begin, end):
        if contacts.pending[p] != 0:
            search_mixed(shapes, bodies, contacts, p, drive.width, has.periodic)


@loops
def find_inflated(shapes, bodies, contacts, drive, begin, end, has):
    """Find the touching contacts of convex polyhedra again, as the program of Rettinger et al. (2022) finds them."""
    for p in prange(begin, end):
        if contacts.touching[p] != 0:
            find_inflated_contact(shapes, bodies, contacts, p, drive.width, has.periodic)


@loops
def find_patches(shapes, bodies, contacts, workspace, drive, begin, end, has):
    """Find the patches of the touching contacts between two polyhedra."""
    for p in prange(begin, end):
        if contacts.touching[p] != 0:
            i, j = contacts.body_a[p], contacts.body_b[p]
            if is_polyhedron(shapes, bodies, i) and is_polyhedron(shapes, bodies, j):
                offset = partner_offset(bodies, contacts, p, drive.width, has.periodic)
                find_patch(shapes, bodies, contacts, p, offset, workspace, get_thread_id())


@loops
def find_walls_of_spheres(bodies, walls, drive):
    """Find the contacts of spheres with the walls."""
    for w in prange(len(walls.body)):
        if walls.wall[w] == FLOOR:
            floor_sphere(bodies, walls, w)
        else:
            cylinder_sphere(bodies, walls, w, drive.wall_radius)


@loops
def find_walls_of_ellipsoids(bodies, walls, drive):
    """Find the contacts of ellipsoids with the walls."""
    for w in prange(len(walls.body)):
        if walls.wall[w] == FLOOR:
            floor_ellipsoid(bodies, walls, w)
        else:
            cylinder_ellipsoid(bodies, walls, w, drive.wall_radius)


@loops
def find_walls_of_polyhedra(shapes, bodies, walls, drive):
    """Find the contacts of convex polyhedra with the walls."""
    for w in prange(len(walls.body)):
        if walls.wall[w] == FLOOR:
            floor_convex(shapes, bodies, walls, w)
        else:
            cylinder_convex(shapes, bodies, walls, w, drive.wall_radius)


@loops
def find_walls_of_mixed(shapes, bodies, walls, drive):
    """Find the contacts of ellipsoids and convex polyhedra with the walls."""
    for w in prange(len(walls.body)):
        hull = is_polyhedron(shapes, bodies, walls.body[w])
        if walls.wall[w] == FLOOR and hull:
            floor_convex(shapes, bodies, walls, w)
        elif walls.wall[w] == FLOOR:
            floor_ellipsoid(bodies, walls, w)
        elif hull:
            cylinder_convex(shapes, bodies, walls, w, drive.wall_radius)
        else:
            cylinder_ellipsoid(bodies, walls, w, drive.wall_radius)


@loops
def find_wall_patches(shapes, bodies, walls, workspace, drive):
    """Find the patches of the polyhedra that touch a wall."""
    for w in prange(len(walls.body)):
        if walls.touching[w] != 0 and is_polyhedron(shapes, bodies, walls.body[w]):
            if walls.wall[w] == FLOOR:
                floor_patch(shapes, bodies, walls, w, workspace, get_thread_id())
            else:
                cylinder_patch(shapes, bodies, walls, w, drive.wall_radius)
