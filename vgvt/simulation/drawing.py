"""What the rig looks like: shapes without mass on the bodies of its MuJoCo model.

Instruments and shaker are drawn at a size that can be seen, not at their own.
"""

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from vgvt.scenario.mirror import expanded_items
from vgvt.scenario.planform import edge_lines_m
from vgvt.simulation.airframe import ROOT
from vgvt.simulation.assembly import Plan
from vgvt.simulation.chain import Chain
from vgvt.simulation.rig import ARMATURE, FRAME_SITE, STINGER, SUSPENSION, TRANSDUCER, numbered

Vector = NDArray[np.float64]
Colour = tuple[float, float, float, float]

WING: Colour = (0.73, 0.79, 0.87, 1.0)
BODY: Colour = (0.56, 0.65, 0.77, 1.0)
ITEM: Colour = (0.33, 0.36, 0.41, 1.0)
SENSOR: Colour = (0.95, 0.45, 0.05, 1.0)
FREE_NODE: Colour = (0.20, 0.24, 0.30, 1.0)
GAUGE: Colour = (0.05, 0.55, 0.30, 1.0)
SHAKER: Colour = (0.16, 0.17, 0.20, 1.0)
METAL: Colour = (0.62, 0.64, 0.67, 1.0)
ROD: Colour = (0.75, 0.10, 0.10, 1.0)
FLOOR = (0.93, 0.94, 0.95)
JOINT = (0.80, 0.82, 0.84)
BACKGROUND = (0.97, 0.98, 1.0)

# Corners of a section, along the chord and across it in half-thicknesses; upper side, then lower side.
_UPPER = np.array([(0.0, 0.0), (0.03, 0.45), (0.12, 0.8), (0.3, 1.0), (0.55, 0.82), (0.8, 0.42), (1.0, 0.06)])
_SECTION = np.vstack([_UPPER, (_UPPER * [1.0, -1.0])[:0:-1]])
_THICKNESS = 0.10
# Elements of effects may be tied to far-off points, and damping to many joints: only these are drawn.
_SEEN_TENDONS = {SUSPENSION: METAL, STINGER: ROD}


def draw_rig(spec: mujoco.MjSpec, layout: Plan, run: int) -> None:
    """Give the rig of a run (from ``driven_spec``) its looks; masses, joints and springs stay as they are."""
    span = span_m(layout)
    for chain in layout.parts.chains.values():
        _draw_beam(spec, layout, chain, 0.03 * span)
    _draw_body(spec, layout)
    _draw_items(spec, layout)
    _draw_points(spec, layout, run, span / 110)
    _draw_fittings(spec, layout, span / 160)
    size = _shaker_size_m(layout, span)
    floors = [_draw_shaker(spec, size, k) for k in range(len(layout.drives) if layout.strike is None else 0)]
    floor = min(floors, default=float(layout.drive.position_m[2]) - 0.3 * span)
    _draw_frame(spec, span)
    _draw_room(spec, floor, span)
    stingers = {numbered(STINGER, k): ROD for k in range(len(layout.drives))}
    for tendon in spec.tendons:
        tendon.rgba = (_SEEN_TENDONS | stingers).get(tendon.name, (0.0, 0.0, 0.0, 0.0))
        tendon.width = span / (450 if tendon.name in stingers else 900)


def span_m(layout: Plan) -> float:
    """The largest extent of the airframe along one of its axes."""
    points = [np.array(list(layout.parts.origin_m.values()))]
    points += [chain.table.axis.position_m for chain in layout.parts.chains.values()]
    return float(np.ptp(np.vstack(points), axis=0).max())


def _geom(body: mujoco.MjsBody, kind: mujoco.mjtGeom, colour: Colour, **settings: object) -> None:
    """A shape that weighs nothing and touches nothing."""
    body.add_geom(type=kind, rgba=colour, mass=0.0, contype=0, conaffinity=0, group=0, **settings)


def _mesh(
    spec: mujoco.MjSpec, body: mujoco.MjsBody, name: str, vertices: Vector, faces: Vector, colour: Colour
) -> None:
    mesh = spec.add_mesh(name=name)
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL  # a thin plate has hardly a volume
    mesh.uservert = vertices.ravel()
    mesh.userface = faces.ravel().astype(int)
    _geom(body, mujoco.mjtGeom.mjGEOM_MESH, colour, meshname=name)


def _draw_beam(spec: mujoco.MjSpec, layout: Plan, chain: Chain, bare_width_m: float) -> None:
    """Each rigid link carries its piece of the surface; the stub's rides on the parent."""
    arcs = [0.0, *(link.start_arc_m for link in chain.links), chain.table.length_m]
    carriers = [layout.parts.holder(chain), *(link.name for link in chain.links)]
    for k, (carrier, start, stop) in enumerate(zip(carriers, arcs, arcs[1:], strict=False)):
        if stop - start < 1e-6:
            continue
        inside = chain.table.axis.arc_length_m
        cuts = np.array([start, *inside[(inside > start) & (inside < stop)], stop])
        rings = _sections(chain, cuts, bare_width_m) - layout.parts.origin_m[carrier]
        _mesh(spec, spec.body(carrier), f"{chain.name}/skin-{k}", rings.reshape(-1, 3), _loft(len(cuts)), WING)


def _sections(chain: Chain, arc_m: Vector, bare_width_m: float) -> Vector:
    """Section corners (cuts, corners, 3) at some arc lengths; a beam without edges is drawn as a bar."""
    table, axis = chain.table, chain.table.axis
    sides = edge_lines_m(table.beam)
    forward, aft = (
        np.column_stack([np.interp(arc_m, axis.arc_length_m, side[:, k]) for k in range(3)]) for side in sides
    )
    frames = [table.frame(arc) for arc in arc_m]
    normal, across = np.array([f[1] for f in frames]), np.array([f[2] for f in frames])
    chord = np.linalg.norm(aft - forward, axis=1)
    bare = chord < 0.1 * bare_width_m
    forward = np.where(bare[:, None], table.point_m(arc_m) - 0.5 * bare_width_m * across, forward)
    aft = np.where(bare[:, None], table.point_m(arc_m) + 0.5 * bare_width_m * across, aft)
    half = np.where(bare, 0.5 * bare_width_m, 0.5 * _THICKNESS * chord)
    along = forward[:, None] + _SECTION[None, :, :1] * (aft - forward)[:, None]
    return np.asarray(along + _SECTION[None, :, 1:] * (half[:, None] * normal)[:, None])


def _loft(rings: int) -> Vector:
    """Triangles (T, 3) of the tube through rings of section corners, and of its two ends."""
    n = len(_SECTION)
    here = np.arange(n)
    after = (here + 1) % n
    triangles = []
    for ring in range(rings - 1):
        a, b = ring * n, (ring + 1) * n
        triangles += [
            np.column_stack([a + here, a + after, b + after]),
            np.column_stack([a + here, b + after, b + here]),
        ]
    cap = np.column_stack([np.zeros(n - 2, dtype=int), here[1:-1], here[2:]])
    last = (rings - 1) * n
    sides = np.vstack([*triangles, cap[:, ::-1], last + cap])
    # Left and right beams wind the other way round: drawn from both sides, either looks right.
    return np.vstack([sides, sides[:, ::-1]])


def _draw_body(spec: mujoco.MjSpec, layout: Plan) -> None:
    """The centre body as a prism over its outline, chamfered towards its middle."""
    outline = np.array(layout.scenario.airframe.body.outline_m).reshape(-1, 2)
    if len(outline) < 3 or np.ptp(outline, axis=0).min() < 0.01:
        return
    n, middle = len(outline), outline.mean(axis=0)
    half = 0.085 * np.ptp(outline, axis=0).min()
    levels = ((1.0, 0.0), (0.86, 0.75), (0.55, 1.0), (0.0, 1.0))
    rings = [
        np.column_stack([middle + s * (outline - middle), np.full(n, sign * h * half)])
        for sign in (1, -1)
        for s, h in levels
    ]
    height = layout.scenario.airframe.body.centre_of_gravity_m[2]
    vertices = np.vstack(rings) + np.array([0.0, 0.0, height]) - layout.parts.origin_m[ROOT]
    here = np.arange(n)
    after = (here + 1) % n
    faces = []
    for ring in (0, 1, 2, 4, 5, 6):
        a, b = ring * n, (ring + 1) * n
        faces += [np.column_stack([a + here, a + after, b + after]), np.column_stack([a + here, b + after, b + here])]
    sides = np.vstack(faces)
    _mesh(spec, spec.body(ROOT), "body/skin", vertices, np.vstack([sides, sides[:, ::-1]]), BODY)


def _draw_fittings(spec: mujoco.MjSpec, layout: Plan, radius_m: float) -> None:
    """The rigid arms that roots and the hook sit on where they are off the axis of what carries them."""
    parts, capsule = layout.parts, mujoco.mjtGeom.mjGEOM_CAPSULE
    places = [(ROOT, np.array(layout.scenario.suspension.hook_m))]
    places += [(chain.parent, chain.table.point_m(0.0)) for chain in parts.chains.values()]
    for part, end in places:
        table = parts.chains[part].table if part in parts.chains else None
        start = parts.origin_m[ROOT] if table is None else table.point_m(table.nearest_arc_m(end))
        carrier = parts.carrier(part, end)
        if np.linalg.norm(end - start) > radius_m:
            ends = [*(start - parts.origin_m[carrier]), *(end - parts.origin_m[carrier])]
            _geom(spec.body(carrier), capsule, BODY, fromto=ends, size=[radius_m, 0.0, 0.0])


def _draw_items(spec: mujoco.MjSpec, layout: Plan) -> None:
    """Lumped masses as balls of aluminium's density."""
    for item in expanded_items(layout.parts.airframe):
        position = np.array(item.position_m)
        carrier = layout.parts.carrier(item.attached_to, position)
        radius = (3 * item.mass_kg / (4 * np.pi * 2700.0)) ** (1 / 3)
        place = position - layout.parts.origin_m[carrier]
        _geom(spec.body(carrier), mujoco.mjtGeom.mjGEOM_SPHERE, ITEM, pos=place, size=[radius, 0.0, 0.0])


def _draw_points(spec: mujoco.MjSpec, layout: Plan, run: int, size_m: float) -> None:
    """Accelerometers of the run as cubes, the grid's other nodes as dots, and the force gauge."""
    here = layout.run_points(run)
    taken = {point.dof.node for point in here}
    lift = np.array([0.0, 0.0, 0.3 * size_m])
    for point in layout.grid:
        if point.dof.node not in taken:
            place = point.position_m - layout.parts.origin_m[point.carrier]
            sphere = mujoco.mjtGeom.mjGEOM_SPHERE
            _geom(spec.body(point.carrier), sphere, FREE_NODE, pos=place + lift, size=[0.4 * size_m, 0, 0])
    for point in here:
        cube = mujoco.mjtGeom.mjGEOM_BOX
        body = spec.body(f"accelerometer-{point.dof.node}")
        _geom(body, cube, SENSOR, pos=size_m * np.sign(point.axis) * np.array([0, 0, 0.9]), size=[0.8 * size_m] * 3)
    gauge = mujoco.mjtGeom.mjGEOM_CYLINDER
    for k in range(len(layout.drives) if layout.strike is None else 0):
        shape = {"pos": [0, 0, -0.8 * size_m], "size": [0.7 * size_m, 0.8 * size_m, 0]}
        _geom(spec.body(numbered(TRANSDUCER, k)), gauge, GAUGE, **shape)
    if layout.strike is not None:
        # Where the hammer hits: its tip, on the side that it comes from.
        place = layout.strike.position_m - layout.parts.origin_m[layout.strike.carrier] - size_m * layout.strike.axis
        ball = mujoco.mjtGeom.mjGEOM_SPHERE
        _geom(spec.body(layout.strike.carrier), ball, GAUGE, pos=place, size=[0.9 * size_m, 0, 0])


def _shaker_size_m(layout: Plan, span: float) -> float:
    """Radius of a shaker's body: one that suits the aircraft and leaves its neighbours room."""
    feet = [p.position_m for p in layout.drives]
    apart = [float(np.linalg.norm(a - b)) for i, a in enumerate(feet) for b in feet[:i]]
    return min([span / 24, *(0.35 * distance for distance in apart)])


def _draw_shaker(spec: mujoco.MjSpec, size: float, exciter: int) -> float:
    """Armature, shaker and its stand; returns the height of the floor, m."""
    name = numbered(ARMATURE, exciter)
    armature, push = spec.body(name), np.array(spec.joint(name).axis)
    foot = np.array(armature.pos)
    cylinder = mujoco.mjtGeom.mjGEOM_CYLINDER
    neck, depth = 0.45 * size, 2.0 * size

    def rod(body: mujoco.MjsBody, start: Vector, stop: Vector, radius: float, colour: Colour) -> None:
        _geom(body, cylinder, colour, fromto=[*start, *stop], size=[radius, 0.0, 0.0])

    nothing = np.zeros(3)
    rod(armature, nothing, -2 * neck * push, 0.25 * size, METAL)
    rod(spec.worldbody, foot - neck * push, foot - (neck + depth) * push, size, SHAKER)
    rod(spec.worldbody, foot - (neck - 0.06 * size) * push, foot - (neck + 0.1 * size) * push, 0.7 * size, METAL)
    middle = foot - (neck + 0.6 * depth) * push
    floor = float((foot - (neck + depth) * push)[2] - 0.5 * size)
    across = np.cross(push, [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    box = mujoco.mjtGeom.mjGEOM_BOX
    rod(spec.worldbody, middle - 1.3 * size * across, middle + 1.3 * size * across, 0.2 * size, METAL)
    for side in (-1.25, 1.25):
        top = middle + side * size * across
        centre = [top[0], top[1], (top[2] + floor) / 2]
        _geom(spec.worldbody, box, METAL, pos=centre, size=[0.4 * size, 0.1 * size, (top[2] - floor) / 2 + 0.2 * size])
    _geom(
        spec.worldbody,
        box,
        METAL,
        pos=[middle[0], middle[1], floor + 0.06 * size],
        size=[size, 1.5 * size, 0.06 * size],
    )
    return floor


def _draw_frame(spec: mujoco.MjSpec, span: float) -> None:
    """The beam overhead that the spring hangs from."""
    top = np.array(spec.site(FRAME_SITE).pos)
    half = span / 90
    girder = mujoco.mjtGeom.mjGEOM_BOX
    _geom(spec.worldbody, girder, METAL, pos=top + np.array([0.0, 0.0, half]), size=[half, span / 9, half])


def _draw_room(spec: mujoco.MjSpec, floor_m: float, span: float) -> None:
    """A tiled floor, a pale background and light from above, all in proportion to the aircraft."""
    tiles = spec.add_texture(name="tiles", type=mujoco.mjtTexture.mjTEXTURE_2D, width=512, height=512)
    tiles.builtin, tiles.mark = mujoco.mjtBuiltin.mjBUILTIN_FLAT, mujoco.mjtMark.mjMARK_EDGE
    tiles.rgb1 = tiles.rgb2 = FLOOR
    tiles.markrgb = JOINT
    floor = spec.add_material(name="floor", texuniform=True, texrepeat=[2.0, 2.0])
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "tiles"
    plane = mujoco.mjtGeom.mjGEOM_PLANE
    _geom(spec.worldbody, plane, (1.0, 1.0, 1.0, 1.0), pos=[0.0, 0.0, floor_m], size=[0.0, 0.0, 1.0], material="floor")
    sky = spec.add_texture(name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, width=64, height=384)
    sky.builtin = mujoco.mjtBuiltin.mjBUILTIN_FLAT
    sky.rgb1 = sky.rgb2 = BACKGROUND
    # Nearly plumb: under a slanting light the shadow map speckles the floor, the more the smaller the aircraft.
    light = spec.worldbody.add_light(
        pos=[0.0, 0.0, 1.4 * span], dir=[0.05, 0.05, -1.0], diffuse=[0.22] * 3, specular=[0.1] * 3
    )
    light.type = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    light.castshadow = True
    head = spec.visual.headlight
    head.ambient, head.diffuse, head.specular = [0.56] * 3, [0.34] * 3, [0.04] * 3
