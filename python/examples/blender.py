"""Puts an assembly into Blender, a mesh object for each part, its plan as keyframes.

    blender --python blender.py -- plain.toml

Runs in Blender's own Python, where the package must be installed. Without Blender it prints what it would do.
"""

import sys

import numpy as np
import weavelock

try:
    import bpy
    from mathutils import Matrix
except ImportError:
    bpy = None

FRAMES_A_STEP = 30


def objects(asm):
    """A mesh object for each part, in mm."""
    made = {}
    for part, pose in zip(asm.parts, asm.poses()):
        points = asm.vertices(part) @ pose[:, :3].T + pose[:, 3]
        mesh = bpy.data.meshes.new(part)
        mesh.from_pydata((points * asm.mm_per_unit).tolist(), [], asm.faces(part).tolist())
        made[part] = bpy.data.objects.new(part, mesh)
        bpy.context.collection.objects.link(made[part])
    return made


def rigid(motion, mm):
    """The end of a translation or screw as a 4 x 4 matrix in mm."""
    out = np.eye(4)
    if motion["kind"] == "translation":
        out[:3, 3] = np.array(motion["direction"]) * motion["distance_mm"]
        return out
    axis, angle, point = np.array(motion["axis"]), motion["angle"], np.array(motion["point"]) * mm
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    out[:3, :3] = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    out[:3, 3] = point - out[:3, :3] @ point + axis * motion["advance_mm"]
    return out


def movers(step):
    """Who moves how."""
    return step["motions"] if step["kind"] == "several" else [step]


def main(file):
    asm, plan = weavelock.load(file), weavelock.plan(file)
    print(f"{asm!r}: {plan['outcome']}, {len(plan['steps'])} moves")
    if bpy is None:
        for k, step in enumerate(plan["steps"]):
            print(f"{k + 1}: {', '.join(step['parts'])} by {step['kind']}")
        return
    made = objects(asm)
    at = {part: np.eye(4) for part in made}
    for k, step in enumerate(plan["steps"]):
        for mover in movers(step):
            for part in mover["parts"]:
                made[part].keyframe_insert("location", frame=k * FRAMES_A_STEP)
                made[part].keyframe_insert("rotation_euler", frame=k * FRAMES_A_STEP)
                at[part] = rigid(mover, asm.mm_per_unit) @ at[part]
                made[part].matrix_world = Matrix(at[part].tolist())
                made[part].keyframe_insert("location", frame=(k + 1) * FRAMES_A_STEP)
                made[part].keyframe_insert("rotation_euler", frame=(k + 1) * FRAMES_A_STEP)


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1] if "--" in sys.argv else sys.argv[-1])
