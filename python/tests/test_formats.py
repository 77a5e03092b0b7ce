"""Files for other programs, judged by other programs: 3MF by lib3mf, glTF by the Khronos validator.

Where one of them is not installed its test is skipped, and says so.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest
import weavelock

ROOT = Path(__file__).resolve().parents[2]
FIXTURES = ROOT / "fixtures"
# A part that touches itself along an edge is among them: there a 3MF needs the edge's ends twice.
SPECS = {
    "plain": FIXTURES / "assemblies/woven/plain-window.toml",
    "twill": FIXTURES / "assemblies/woven/twill-unit.toml",
    "dovetail": FIXTURES / "assemblies/dovetail-open.toml",
    "puzzle": FIXTURES / "puzzles/piston.xmpuzzle",
    "pinched": FIXTURES / "meshes/odd-touches-itself.obj",
}


def spec(name, folder):
    if SPECS[name].suffix != ".obj":
        return SPECS[name]
    shutil.copy(SPECS[name], folder)
    text = f'[[part]]\nmesh = "{SPECS[name].name}"\n'
    (folder / f"{name}.toml").write_text(text)
    return folder / f"{name}.toml"


@pytest.mark.parametrize("name", SPECS)
def test_a_3mf_is_read_by_lib3mf_without_a_warning(name, tmp_path):
    lib3mf = pytest.importorskip("lib3mf", reason="not run: needs the package lib3mf")
    asked = spec(name, tmp_path)
    weavelock.ask("export", str(asked), "--out", str(tmp_path / "a.3mf"))
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(tmp_path / "a.3mf"))
    assert reader.GetWarningCount() == 0
    found, objects = [], model.GetMeshObjects()
    while objects.MoveNext():
        one = objects.GetCurrentMeshObject()
        assert one.IsValid() and one.IsManifoldAndOriented(), one.GetName()
        found.append(one.GetName())
    assert found == weavelock.load(asked).parts


SCRIPT = """
const { validateBytes } = require('gltf-validator');
const bytes = new Uint8Array(require('fs').readFileSync(process.argv[1]));
validateBytes(bytes).then((report) => console.log(JSON.stringify(report)));
"""


@pytest.mark.parametrize("name", [n for n in SPECS if n != "pinched"])
def test_a_glb_has_nothing_that_the_validator_of_khronos_tells(name, tmp_path):
    modules = os.environ.get("GLTF_VALIDATOR", "")
    if not shutil.which("node") or not Path(modules, "gltf-validator").is_dir():
        pytest.skip("not run: needs node, and GLTF_VALIDATOR to name the folder with gltf-validator")
    out = tmp_path / "a.glb"
    weavelock.ask("export", str(spec(name, tmp_path)), "--out", str(out))
    run = subprocess.run(
        ["node", "-e", SCRIPT, str(out)], env={**os.environ, "NODE_PATH": modules}, capture_output=True, text=True, check=True
    )
    report = json.loads(run.stdout)
    issues = report["issues"]
    assert [issues[k] for k in ("numErrors", "numWarnings", "numInfos", "numHints")] == [0, 0, 0, 0], issues["messages"]
    assert report["info"]["totalTriangleCount"] > 0
