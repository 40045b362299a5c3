"""Pictures of the page "How a time step works", drawn from the code of the step itself on a small bed.

`python -m docs.generate.pictures explanation/NAME.png` draws them. The bed is examples/polyhedra.yaml, 150 pebbles.
"""

import functools
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from simcore.compilation import set_threads
from simcore.dem.contact.patch.workspace import make_workspace
from simcore.dem.forces.spring_dashpot import contact_law, implicit_law
from simcore.dem.shapes.polyhedra import SPHERE, collect_shapes, unit_sphere
from simcore.dem.state.bodies import make_bodies
from simcore.dem.state.contacts import Box, State
from simcore.dem.state.features import Features
from simcore.dem.step.candidate_pairs import list_candidates
from simcore.dem.step.step import STAGES, Drive, make_advance
from simcore.grains.sources import load_grains
from simcore.packing.packed import SHAKING
from simcore.packing.process import Process
from simcore.packing.stepper import Stepper
from simcore.paths import ROOT
from simcore.report.figures.interval import plane_outline
from simcore.scene.setup import set_up
from simcore.scene.shapes import Base
from simcore.scene.specification import read_specification
from simcore.verification.outside.solids import solid_mesh

DARK, ORANGE, LIGHT, GRAIN = "#20313b", "#b3541e", "#7f9aa0", "#e8dcc4"
STEPS_WATCHED = 300
PLATE = 0.01  # [m], width of the plate that is tilted on another


class Bed(NamedTuple):
    """A finished bed: the process that made it, still at rest, and its Packed."""

    process: Process
    packed: object


@functools.cache
def bed() -> Bed:
    """Pack the bed of the pictures."""
    set_threads(1)
    setup = set_up(read_specification(ROOT / "examples" / "polyhedra.yaml"), load_grains)
    process = Process(setup.scene, setup.bases, setup.draw, report=lambda line: None)
    return Bed(process, process.run())


def candidate_pairs():
    """Draw a vertical cut through the bed with its candidate pairs, and how many pairs there are of each kind."""
    process, packed = bed()
    bodies, contacts = process.bodies, packed.contacts
    cut = 0.5 * process.scene.domain.width
    outlines = {i: _section(process, i, cut) for i in range(len(bodies.mass))}
    outlines = {i: outline for i, outline in outlines.items() if outline is not None}
    figure = Figure(figsize=(10.0, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1.5, 1.0])
    for outline in outlines.values():
        left.fill(*(1e3 * outline.T), facecolor=GRAIN, edgecolor=DARK, lw=0.8)
    middles = {i: 1e3 * outline.mean(axis=0) for i, outline in outlines.items()}
    inside = (contacts.image == 0).all(axis=1)
    for a, b, touching in zip(contacts.body_a[inside], contacts.body_b[inside], contacts.touching[inside], strict=True):
        if a in middles and b in middles:
            style = {"color": ORANGE, "lw": 1.8} if touching else {"color": LIGHT, "lw": 0.8, "ls": "--"}
            left.plot(*np.transpose([middles[a], middles[b]]), **style)
    left.plot([], [], color=ORANGE, lw=1.8, label="pair that touches")
    left.plot([], [], color=LIGHT, lw=0.8, ls="--", label="candidate pair with a gap")
    left.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=2, fontsize="small", frameon=False)
    left.set(aspect="equal", xlabel="x [mm]", ylabel="height [mm]")
    n = len(bodies.mass)
    counts = [n * (n - 1) // 2, len(contacts.body_a), int(contacts.touching.sum())]
    bars = right.barh(["all pairs", "candidate pairs", "pairs that touch"], counts, color=[GRAIN, LIGHT, ORANGE])
    right.bar_label(bars, padding=4)
    right.set(xscale="log", xlabel="number of pairs in the bed [-]", xlim=(100, 4e4))
    right.invert_yaxis()
    return figure


def remembered_contacts():
    """Draw which share of the touching pairs keeps its facet from one step to the next, while the bed is shaken."""
    process = bed().process
    contacts, counts = process.contacts, []
    drive = process.stepper.drive(SHAKING, process.dt)
    for step in range(STEPS_WATCHED):
        touching, facet = contacts.touching.copy() > 0, contacts.facet.copy()
        apart, at = ~touching, contacts.apart_at.copy()
        process.stepper.step(process.bodies, process.candidates, drive, step, 1)
        both = touching & (contacts.touching > 0)
        same = (contacts.facet == facet).all(axis=1)
        idle = apart & (contacts.touching == 0)
        unchanged = (contacts.apart_at == at).all(axis=1)
        counts.append((same[both].mean(), unchanged[idle].mean()))
    kept, not_searched = np.transpose(counts)
    milliseconds = 1e3 * process.dt * (1.0 + np.arange(STEPS_WATCHED))
    figure = Figure(figsize=(8.0, 3.4), layout="constrained")
    axes = figure.subplots()
    axes.plot(milliseconds, 100 * kept, color=ORANGE, lw=1.0, label="touching pairs that keep their facet")
    axes.plot(milliseconds, 100 * not_searched, color=DARK, lw=1.0, label="pairs apart whose last gap still suffices")
    axes.set(xlabel="time of shaking [ms]", ylabel="share of the pairs in a step [%]", ylim=(None, 101))
    axes.legend(loc="lower left", fontsize="small")
    return figure


def patch():
    """Draw where a plate presses on a wider one while it is tilted: patch contact and deepest point."""
    figure = Figure(figsize=(10.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    depth, shown = 4e-7, 3e-5
    tilt = np.linspace(-2e-4, 2e-4, 160)
    right.plot(1e3 * tilt, [1e3 * _pressing_point(angle, depth) for angle in tilt], color=ORANGE, label="patch contact")
    right.plot(1e3 * tilt, np.sign(tilt) * 500.0 * PLATE, color=DARK, ls="--", label="deepest point")
    right.set(xlabel="tilt of the plate [mrad]", ylabel="where it presses, x [mm]")
    right.legend(loc="upper left", fontsize="small")
    x = np.array([-0.5, 0.5]) * PLATE
    underside = 0.5 * shown * PLATE - depth - shown * x
    left.fill_between(1e3 * x, 1e6 * underside, 0.0, color=GRAIN, label="overlap, the patch")
    left.plot(
        1e3 * x, 1e6 * underside, color=ORANGE, lw=2.0, label=f"underside of the plate, tilt {1e3 * shown:g} mrad"
    )
    left.plot([-10.0, 10.0], [0.0, 0.0], color=DARK, lw=1.0, label="top of the plate below")
    left.plot(1e3 * _pressing_point(shown, depth), 0.0, "o", color=ORANGE, ms=8, label="patch contact")
    left.plot(500.0 * PLATE, 0.0, "D", color=DARK, ms=7, label="deepest point")
    left.set(xlabel="x [mm]", ylabel="height [µm]", ylim=(-0.75, 0.1), xlim=(-7.0, 7.0))
    left.legend(loc="lower center", fontsize="x-small", ncols=2)
    return figure


def force():
    """Draw the forces of an oblique impact of a sphere on the floor, over its contact time."""
    figure = Figure(figsize=(10.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    exact = np.linspace(0.0, 1.0, 400)
    left.plot(exact, _closed_form(exact), color=LIGHT, lw=3.0, label="closed form")
    for dashpot, steps, color, marker in (("explicit", 40, DARK, "."), ("implicit", 10, ORANGE, "o")):
        time, normal, tangential = _impact(dashpot, steps)
        left.plot(time, normal, marker, color=color, ms=5, label=f"{dashpot} dashpot, {steps} steps")
        if dashpot == "explicit":
            right.plot(time, np.abs(tangential), color=DARK, label="friction force")
            right.plot(time, 0.5 * np.abs(normal), color=ORANGE, ls="--", label="its limit, 0.5 × normal force")
    left.axhline(0.0, color="0.7", lw=0.8)
    left.set(ylabel="normal force / (m v / T) [-]")
    right.set(ylabel="tangential force / (m v / T) [-]", ylim=(0.0, None))
    for axes in (left, right):
        axes.set_xlabel("time since the first touch / contact time [-]")
        axes.legend(fontsize="small")
    return figure


def motion():
    """Draw how the bed comes to rest: speed of the fastest grain and unbalanced force at every check."""
    time, phase, observed = zip(*bed().packed.checks, strict=True)
    time, shaken = np.array(time), np.array(phase) == SHAKING
    figure = Figure(figsize=(8.0, 3.8), layout="constrained")
    axes = figure.subplots()
    axes.semilogy(time, [one.max_speed for one in observed], color=DARK, label="speed of the fastest grain [m/s]")
    axes.semilogy(time, [one.unbalanced_force for one in observed], color=ORANGE, ls="--", label="unbalanced force [-]")
    axes.axvspan(0.0, time[shaken].max(), color="0.93", zorder=0)
    axes.annotate("fall and shaking", (0.02, 0.95), xycoords="axes fraction", fontsize="small")
    axes.annotate("damping", (time[shaken].max() + 0.005, 0.95), xycoords=("data", "axes fraction"), fontsize="small")
    axes.set(xlabel="simulated time [s]", ylabel="value at a check", ylim=(None, 10.0))
    axes.legend(fontsize="small", loc="lower left")
    return figure


FIGURES = {
    "explanation/candidate_pairs.png": candidate_pairs,
    "explanation/remembered_contacts.png": remembered_contacts,
    "explanation/patch.png": patch,
    "explanation/force.png": force,
    "explanation/motion.png": motion,
}


def _section(process, i, cut):
    """Return the outline (n, 2) [m] of grain i in the plane y = cut, in order, or None if the plane misses it."""
    bodies, base = process.bodies, process.bases[process.bodies.shape[i]]
    points = (base.vertices * bodies.scale[i]) @ bodies.rotation[i].T + bodies.position[i]
    return plane_outline(points, base.faces, cut)


def _pressing_point(angle, depth):
    """Return the x [m] at which a tilted plate presses on a wider, level one; the overlap is `depth` [m]."""
    base = Base("cube", *solid_mesh("cube", 2.0), 8.0, np.full(3, 1.0 / 3.0))
    scene = bed().process.scene
    stepper = Stepper(scene, [base])
    scale = np.array([[1.0, 1.0, 0.25], [0.5, 0.5, 0.25]]) * PLATE
    x, z = scale[1, [0, 2]]
    above = x * np.sin(abs(angle)) + z * np.cos(angle) - depth
    middle = 0.5 * scene.domain.width
    position = np.array([[middle, middle, PLATE], [middle, middle, PLATE + scale[0, 2] + above]])
    orientation = np.array([[1.0, 0.0, 0.0, 0.0], [np.cos(0.5 * angle), 0.0, np.sin(0.5 * angle), 0.0]])
    still = np.zeros((2, 3))
    bodies = make_bodies(
        [base], np.zeros(2, int), scale, position, orientation, still, still, 2650.0, features=stepper.features
    )
    candidates = list_candidates(bodies, stepper.shapes, stepper.box, 1e-4, stepper.features, None)
    stepper.step(bodies, candidates, stepper.drive(SHAKING, 0.0), 0, 1)
    return candidates.contacts.point[0, 0]


def _impact(dashpot, steps):
    """Return times, normal and tangential forces of one impact at 45°, in units of T, m v / T; v, m and T are one.

    The sphere starts half a step above the floor.
    """
    dt, radius = 1.0 / steps, 1e3
    law = contact_law(0.1, 1.0, 0.22, 0.5)
    law = implicit_law(law, dt) if dashpot == "implicit" else law
    features = Features(SPHERE, True, True, implicit=dashpot == "implicit")
    advance, base = make_advance(features), unit_sphere()
    shapes, box = collect_shapes([base]), Box(0.0)
    density = 1.0 / (4.0 / 3.0 * np.pi * radius**3)
    bodies = make_bodies(
        [base], np.zeros(1, int), np.full((1, 3), radius), np.array([[0.0, 0.0, radius + 0.5 * dt]]),
        np.array([[1.0, 0.0, 0.0, 0.0]]), np.array([[1.0, 0.0, -1.0]]), np.zeros((1, 3)), density, features=features,
    )  # fmt: skip
    candidates = list_candidates(bodies, shapes, box, radius, features, None)
    state = State(shapes, bodies, *candidates, make_workspace(shapes, 1))
    drive, clock = Drive(dt, 0.0, 0.0, 0.0, 1.0, 0.0, np.inf), np.zeros(len(STAGES), np.int64)
    rows = []
    for step in range(steps + 1):
        advance(state, law, drive, clock, step, 1)
        if candidates.walls.touching[0]:
            rows.append(((step - 0.5) * dt, *candidates.walls.force[0, [2, 0]]))
    return np.transpose(rows)


def _closed_form(time):
    """Return the normal force of an impact without a time step, in the units of `_impact`."""
    law = contact_law(0.1, 1.0, 0.22, 0.5)
    beta, omega = 0.5 * law.damping, np.pi
    overlap = np.exp(-beta * time) * np.sin(omega * time) / omega
    rate = np.exp(-beta * time) * (np.cos(omega * time) - beta / omega * np.sin(omega * time))
    return law.stiffness * overlap + law.damping * rate
