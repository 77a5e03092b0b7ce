"""The Blender script, run: with Blender's module where that is installed, and without it."""

import os
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import weavelock

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
ROOT = EXAMPLES.parents[1]


def test_the_blender_script_tells_its_moves_without_blender():
    tail = ROOT / "fixtures/assemblies/dovetail-open.toml"
    block = "import sys; sys.modules['bpy'] = None; import runpy; runpy.run_path(sys.argv[1], run_name='__main__')"
    words = [sys.executable, "-c", block, str(EXAMPLES / "blender.py"), "--", str(tail)]
    out = subprocess.run(words, capture_output=True, text=True, check=True, env=os.environ).stdout
    assert "assembled, 1 moves" in out and "1: tail by translation" in out


# A turn is keyed every 5 degrees: the chord of such an arc leaves it by 5 degrees squared over 8 of the radius.
CHORD = np.radians(5) ** 2 / 8
# Blender keeps poses in f32.
F32 = 1e-6

TURNED = {
    "outcome": "assembled",
    "steps": [
        {
            "kind": "several",
            "motions": [
                {"parts": ["tail"], "kind": "screw", "point": [1, 2, 3], "axis": [0, 0.6, 0.8], "angle": 2.5, "advance_mm": 4.0},
                {"parts": ["socket"], "kind": "translation", "direction": [1, 0, 0], "distance_mm": 9.0},
            ],
        },
        {"parts": ["tail", "socket"], "kind": "screw", "point": [0, 0, 0], "axis": [1, 0, 0], "angle": -6.0, "advance_mm": -2.0},
    ],
}


@pytest.mark.parametrize("plan", [None, TURNED], ids=["its own plan", "screws"])
def test_parts_stand_in_blender_where_the_plan_says(plan, monkeypatch):
    bpy = pytest.importorskip("bpy", reason="not run: needs the package bpy, Blender as a module")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if plan:
        monkeypatch.setattr(weavelock, "plan", lambda file: plan)
    tail = str(ROOT / "fixtures/assemblies/dovetail-open.toml")
    script = runpy.run_path(str(EXAMPLES / "blender.py"))
    script["main"](tail)
    asm, steps, scene = weavelock.load(tail), weavelock.plan(tail)["steps"], bpy.context.scene
    frames = script["FRAMES_A_STEP"]
    radius = max(np.abs(asm.vertices(part)).max() for part in asm.parts) * asm.mm_per_unit
    at = {part: np.eye(4) for part in asm.parts}
    for k, step in enumerate(steps):
        for share in np.linspace(0, 1, 13):
            frame = (k + share) * frames
            scene.frame_set(int(frame), subframe=frame - int(frame))
            for mover in script["movers"](step):
                for part in mover["parts"]:
                    meant = script["rigid"](mover, asm.mm_per_unit, share) @ at[part]
                    off = np.abs(meant - np.array(bpy.data.objects[part].matrix_world)).max()
                    assert off < (F32 * radius if share in (0, 1) else F32 * radius + CHORD * radius), (k, share, part)
        for mover in script["movers"](step):
            for part in mover["parts"]:
                at[part] = script["rigid"](mover, asm.mm_per_unit) @ at[part]
    assert scene.frame_end == len(steps) * frames and scene.camera is not None
