"""Puts an assembly into Blender: a mesh object for each part, its plan as keyframes, a camera and a light.

    blender --python blender.py -- plain.toml                          # look at it, play it
    blender --background --python blender.py -- plain.toml plain.blend # save the scene
    python blender.py plain.toml plain.png                             # with the package `bpy`: render the last frame

One Blender unit is one millimetre. Runs in Blender's own Python, where the package must be installed. Without Blender
it prints what it would do.
"""

import sys

import numpy as np
import weavelock

try:
    import bpy
    from mathutils import Matrix, Vector
except ImportError:
    bpy = None

FRAMES_A_STEP = 30
# A turn is keyed this often, in radians: between keys a point of the part strays from its arc by angle^2 / 8 of the radius.
KEYED_EVERY = np.radians(5)
COLOURS = ["E69F00", "56B4E9", "009E73", "F0E442", "0072B2", "D55E00", "CC79A7", "999999"]


def colour(k):
    """A material; the values are sRGB, Blender wants them linear."""
    made = bpy.data.materials.new(f"weavelock {k}")
    srgb = [int(COLOURS[k % len(COLOURS)][i : i + 2], 16) / 255 for i in (0, 2, 4)]
    made.use_nodes = True
    linear = [((c + 0.055) / 1.055) ** 2.4 for c in srgb]
    made.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*linear, 1)
    made.diffuse_color = (*linear, 1)
    return made


def objects(asm):
    """A mesh object for each part, in mm."""
    made = {}
    for k, (part, pose) in enumerate(zip(asm.parts, asm.poses())):
        points = asm.vertices(part) @ pose[:, :3].T + pose[:, 3]
        mesh = bpy.data.meshes.new(part)
        mesh.from_pydata((points * asm.mm_per_unit).tolist(), [], asm.faces(part).tolist())
        mesh.materials.append(colour(k))
        made[part] = bpy.data.objects.new(part, mesh)
        made[part].rotation_mode = "QUATERNION"
        bpy.context.scene.collection.objects.link(made[part])
    return made


def rigid(motion, mm, share=1.0):
    """A translation or screw, followed to a share of its way, as a 4 x 4 matrix in mm."""
    out = np.eye(4)
    if motion["kind"] == "translation":
        out[:3, 3] = np.array(motion["direction"]) * motion["distance_mm"] * share
        return out
    axis, angle, point = np.array(motion["axis"]), motion["angle"] * share, np.array(motion["point"]) * mm
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    out[:3, :3] = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    out[:3, 3] = point - out[:3, :3] @ point + axis * motion["advance_mm"] * share
    return out


def shares(motion):
    """Shares of a motion's way at which it is keyed."""
    turn = abs(motion.get("angle", 0.0))
    return np.linspace(0, 1, 1 + max(1, int(np.ceil(turn / KEYED_EVERY))))


def movers(step):
    """Who moves how."""
    return step["motions"] if step["kind"] == "several" else [step]


def keyed(thing, matrix, frame):
    """Puts an object there at that frame; of the two quaternions of a turn the one nearer to the last."""
    before = thing.rotation_quaternion.copy()
    thing.matrix_basis = Matrix(matrix.tolist())
    thing.rotation_quaternion.make_compatible(before)
    thing.keyframe_insert("location", frame=frame)
    thing.keyframe_insert("rotation_quaternion", frame=frame)


def curves(thing):
    """The animation curves of an object; from Blender 4.4 on they lie in layers."""
    action = thing.animation_data and thing.animation_data.action
    if not action:
        return []
    if hasattr(action, "layers"):
        bags = [b for layer in action.layers for strip in layer.strips for b in strip.channelbags]
        return [curve for bag in bags for curve in bag.fcurves]
    return list(action.fcurves)


def animate(made, plan, mm):
    """The plan from frame 0 on, parts straight from key to key."""
    at = {part: np.eye(4) for part in made}
    for k, step in enumerate(plan["steps"]):
        for mover in movers(step):
            for part in mover["parts"]:
                for share in shares(mover):
                    keyed(made[part], rigid(mover, mm, share) @ at[part], (k + share) * FRAMES_A_STEP)
                at[part] = rigid(mover, mm) @ at[part]
    for curve in (c for thing in made.values() for c in curves(thing)):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 0, max(1, len(plan["steps"]) * FRAMES_A_STEP)


def staged(made):
    """Camera and sun that show all parts in place, and millimetres."""
    scene = bpy.context.scene
    scene.unit_settings.scale_length, scene.unit_settings.length_unit = 0.001, "MILLIMETERS"
    corners = np.array([list(thing.matrix_basis @ v.co) for thing in made.values() for v in thing.data.vertices])
    middle, size = (corners.min(0) + corners.max(0)) / 2, float(np.linalg.norm(np.ptp(corners, 0)))
    eye = Vector(middle) + Vector((0.8, -1.6, 1.2)) * size
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.clip_end = 100 * size
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 3
    for thing in (camera, sun):
        scene.collection.objects.link(thing)
        thing.location = eye
        thing.rotation_euler = (Vector(middle) - eye).to_track_quat("-Z", "Y").to_euler()
    sun.rotation_euler.z += 0.6
    scene.camera = camera
    scene.world = scene.world or bpy.data.worlds.new("world")
    scene.world.color = (0.5, 0.5, 0.5)


def kept(out):
    """Saves the scene, or renders its last frame on the processor."""
    scene = bpy.context.scene
    if out.endswith(".blend"):
        bpy.ops.wm.save_as_mainfile(filepath=out)
        return
    scene.frame_set(scene.frame_end)
    scene.render.engine, scene.cycles.samples = "CYCLES", 32
    scene.render.resolution_x, scene.render.resolution_y = 960, 720
    scene.render.filepath = out
    bpy.ops.render.render(write_still=True)


def main(file, out=None):
    asm, plan = weavelock.load(file), weavelock.plan(file)
    print(f"{asm!r}: {plan['outcome']}, {len(plan['steps'])} moves")
    if bpy is None:
        for k, step in enumerate(plan["steps"]):
            print(f"{k + 1}: {', '.join(step['parts'])} by {step['kind']}")
        return
    made = objects(asm)
    staged(made)
    animate(made, plan, asm.mm_per_unit)
    if out:
        kept(out)


if __name__ == "__main__":
    main(*(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]))
