"""Checks of a Simulation at its start and while it runs; the errors say which body is wrong, and how to mend it."""

import numpy as np

from simcore.dem.overlaps import deepest_overlap, half_thickness

DEEPEST_AT_START = 0.1  # overlap in half thicknesses of the thinner body, above which contacts would throw bodies apart
DEEP = 0.5  # the same while bodies move: beyond, their form no longer decides how they touch
FARTHEST = 1e9  # [m]; candidate pairs beyond are not found
# Share of the energy of motion and springs by which it may grow between two checks. An impact with patches
# multiplied it by up to 2.56 (results/reference/tilted_impacts.csv); an unstable step does so many times over.
GAIN, GAIN_OF_POLYHEDRA = 0.1, 2.0
LIFT = 0.01  # share of their half thickness by which all bodies may be lifted


def check_start(bodies, contacts, floor, box):
    """Raise ValueError if a body is below the floor, outside the cylinder, or deep in another one.

    contacts: TouchingContacts; floor: whether there is one; box: Box of the scene.
    """
    below = np.flatnonzero(bodies.position[:, 2] <= 0.0) if floor else []
    if len(below):
        raise ValueError(
            f"Simulation: the centre of mass of body {below[0]} is at z = {bodies.position[below[0], 2]:g} m, but "
            "the floor is at z = 0. Place it higher, or give floor=False."
        )
    outside = np.flatnonzero(np.hypot(*bodies.position[:, :2].T) >= box.wall_radius)
    if len(outside):
        distance = np.hypot(*bodies.position[outside[0], :2])
        raise ValueError(
            f"Simulation: the centre of mass of body {outside[0]} is {distance:g} m from the z axis, but "
            f"cylinder_radius is {box.wall_radius:g} m. Place the body nearer to the axis, or give a larger "
            "cylinder_radius."
        )
    half = half_thickness(bodies)
    thinner = np.where(contacts.body < 0, np.inf, half[np.maximum(contacts.body, 0)]).min(axis=1)
    deep = np.flatnonzero(contacts.overlap > DEEPEST_AT_START * thinner)
    if not len(deep):
        return
    (a, b), overlap = contacts.body[deep[0]], contacts.overlap[deep[0]]
    if a == b:
        raise ValueError(
            f"Simulation: body {a} overlaps its own periodic image by {overlap:.3g} m, because width is only "
            f"{box.width:g} m. Give a width that is larger than every body."
        )
    partner = {-1: "the floor", -2: "the cylinder"}.get(int(b), f"body {b}")
    remedy = " A body that is wider than the cylinder needs a larger cylinder_radius." if b == -2 else ""
    raise ValueError(
        f"Simulation: body {a} overlaps {partner} by {overlap:.3g} m at the start; the contact would throw them apart. "
        f"Let bodies overlap by less than a tenth of half the thickness of the thinner one.{remedy}"
    )


def check_place(position, width):
    """Raise ValueError if a body starts beyond FARTHEST, or more than FARTHEST periods `width` [m] from the origin."""
    limit = FARTHEST * min(1.0, width or 1.0)
    far = np.flatnonzero(~(np.abs(position) < limit).all(axis=1))
    if len(far):
        raise ValueError(
            f"Simulation: position of body {far[0]} is {position[far[0]]} m, but contacts are only found within "
            f"{limit:g} m of the origin. Place the bodies nearer to it."
        )


def check_width(thickness, width):
    """Raise ValueError if a body is thicker than the period `width` [m]; thickness (n,): half of each [m]."""
    widest = int(np.argmax(thickness))
    if width is not None and 2.0 * thickness[widest] > width:
        raise ValueError(
            f"Simulation: body {widest} overlaps its own periodic image, because width is only {width:g} m, but the "
            f"body is {2.0 * thickness[widest]:.3g} m thick. Give a width that is larger than every body."
        )


def steps_until_passed(bodies, thickness, dt):
    """Return the number of steps of dt [s] after which overlaps must be checked so that no body passes another one.

    A body reaches the sum of its half thickness and that of the thinnest body. In the returned steps the two fastest
    bodies, if they move against each other, come nearer by half of this sum, so that a check finds a deep overlap
    unless they only graze each other. FloatingPointError if they come nearer by the whole sum in one step. thickness
    (n,): half of each body [m].
    """
    speed = np.linalg.norm(bodies.velocity, axis=1) + np.linalg.norm(bodies.angular_velocity, axis=1) * bodies.radius
    others = np.full(len(speed), speed.max())
    if len(speed) > 1:
        others[np.argmax(speed)] = np.partition(speed, -2)[-2]
    reach, moved = thickness + thickness.min(), (speed + others) * dt
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        steps = reach / (2.0 * moved)
        shorter = 10.0 / steps
    fastest = int(np.argmin(steps))
    if steps[fastest] < 0.5:
        raise FloatingPointError(
            f"Simulation: body {fastest} and another one come nearer by {moved[fastest]:.3g} m in a step, but half of "
            f"its thickness and half that of the thinnest body are {reach[fastest]:.3g} m together, so that bodies may "
            f"pass through each other unnoticed. Give a contact_time that is {shorter[fastest]:.0f} times shorter."
        )
    return int(np.clip(np.nan_to_num(steps[fastest], nan=1.0), 1.0, 1e9))


def check_finite(bodies, step):
    """Raise FloatingPointError if a body is not at a finite position, or is too far away."""
    wrong = np.flatnonzero(~(np.abs(bodies.position) < FARTHEST).all(axis=1))
    if len(wrong):
        raise FloatingPointError(
            f"Simulation: the position of body {wrong[0]} is not finite, or beyond {FARTHEST:g} m, after step {step}. "
            "Give more steps_per_contact_time or a smaller velocity, or place the bodies so that they do not overlap."
        )


def check_overlaps(bodies, candidates, time):
    """Raise FloatingPointError if a body overlaps another one, or a wall, by more than DEEP of its half thickness."""
    thickness = half_thickness(bodies)
    overlap, (thin, other), ratio = deepest_overlap(candidates, thickness, np.arange(len(thickness)))
    if ratio > DEEP:
        partner = "a wall" if other < 0 else f"body {other}"
        raise FloatingPointError(
            f"Simulation: body {thin} overlaps {partner} by {overlap:.3g} m at {time:g} s, but it is only "
            f"{2 * thickness[thin]:.3g} m thick. The contact is too soft for this speed or weight. Give a contact_time "
            f"that is {10 * ratio:.0f} times shorter for an impact, or {np.sqrt(10 * ratio):.1f} times for a weight."
        )


def check_gain(bodies, before, now, drive, law, share):
    """Return the energies `now`; FloatingPointError if they exceed those `before` by more than is allowed.

    before, now: energy of motion and springs and energy of height of each body, (n,) and (n,) [J]; before may be None.
    share: GAIN or GAIN_OF_POLYHEDRA. Contacts only dissipate, but for this and the error of the step, which is a share
    of stiffness times step².
    """
    if before is None:
        return now
    (moving_before, height_before), (moving, height) = before, now
    gained = moving.sum() + height.sum() - moving_before.sum() - height_before.sum()
    lift = LIFT * abs(drive.gravity) * (bodies.mass * half_thickness(bodies)).sum()
    rounding = 1e-9 * (np.abs(height_before).sum() + moving_before.sum())
    allowed = (share + law.stiffness * drive.dt**2) * moving_before.sum() + lift + rounding
    if not gained <= allowed:
        raise FloatingPointError(
            f"Simulation: the bodies have gained {gained:.3g} J of energy, the most of it body {np.argmax(moving)}. "
            "The time step is too long for its contacts: a body with many contacts, or with corners far from its "
            "centre, needs more steps than one between two others. Give more steps_per_contact_time; 40 is the "
            "default. Polyhedra with patches also gain energy in impacts if restitution is above 0.3; then give "
            "polyhedron_contact='point'."
        )
    return now


def read_only(values):
    """Return an array that cannot be changed, since changing a copy would have no effect on the bodies."""
    values.flags.writeable = False
    return values
