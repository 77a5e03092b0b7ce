"""The package as a user of Python meets it: the same answers as the program, arrays of the stated shapes."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import weavelock

ROOT = Path(__file__).resolve().parents[2]
PLAIN = ROOT / "fixtures/examples/plain-2x2.toml"


def test_the_plain_window_is_locked_and_verified():
    answer = weavelock.check(PLAIN)
    assert answer["verdict"] == "locked" and answer["parts"] == 4
    assert weavelock.verify(answer)["valid"]
    answer["certificate"]["forces"][0]["size"] *= 2
    assert not weavelock.verify(answer)["valid"]


def test_arrays_have_the_stated_shapes():
    asm = weavelock.load(PLAIN)
    assert len(asm.parts) == 4 and asm.poses().shape == (4, 3, 4) and asm.mm_per_unit == 20.0
    vertices, faces = asm.vertices(asm.parts[0]), asm.faces(asm.parts[0])
    assert vertices.shape[1] == faces.shape[1] == 3 and faces.max() < len(vertices)
    a, b, normals, points = asm.contact_rows()
    assert len(a) == len(b) == len(normals) == len(points) == weavelock.check(PLAIN)["rows"]
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0)
    with pytest.raises(KeyError):
        asm.vertices("nobody")


def test_the_certificate_balances_on_the_rows_themselves():
    """The proof again, with nothing but NumPy: forces along their normals cancel on every free part."""
    asm, answer = weavelock.load(PLAIN), weavelock.check(PLAIN)
    total = {part: np.zeros(6) for part in asm.parts}
    for f in answer["certificate"]["forces"]:
        force = f["size"] * np.array(f["normal"])
        wrench = np.concatenate([force, np.cross(f["point"], force)])
        total[f["a"]] -= wrench
        total[f["b"]] += wrench
    still = answer["certificate"]["still"]
    assert all(np.abs(w).max() < 1e-9 for part, w in total.items() if part not in still)


CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
SIDES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
FACES = np.array([t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))])


def test_arrays_go_in(tmp_path):
    low, high = (CUBE, FACES), (CUBE + [0, 0, 1], FACES)
    spec = weavelock.from_meshes({"low": low, "high": high}, tmp_path, held=["low"])
    answer = weavelock.check(spec)
    assert answer["verdict"] == "free" and answer["contacts"] > 0
    assert weavelock.plan(spec)["outcome"] == "assembled"
    back = weavelock.load(spec)
    # Corners may come back in another order; the solid is the same.
    assert {*map(tuple, back.vertices("high"))} == {*map(tuple, CUBE + [0, 0, 1])} and back.held == ["low"]
    with pytest.raises(ValueError):
        weavelock.from_meshes({"flat": (CUBE[:, :2], FACES)}, tmp_path)


def test_bad_input_says_where(tmp_path):
    bad = tmp_path / "bad.toml"
    bad.write_text("name = 3\n")
    with pytest.raises(ValueError, match="bad.toml"):
        weavelock.check(bad)
    with pytest.raises(ValueError, match="hint|Usage"):
        weavelock.ask("no-such-verb")


def test_weaves_are_given_as_lists():
    assert weavelock.weave([2, 2, 1])["family"] == "twill"
    assert weavelock.repeats([1, 1, 1], most=2)["minimal_repeat"] == 2
    assert weavelock.chirality([3, 1, 1])["tile"] in ("left", "right")


def test_other_threads_go_on():
    seen, done = [], threading.Event()

    def count():
        while not done.wait(0.005):
            seen.append(time.monotonic())

    thread = threading.Thread(target=count)
    thread.start()
    weavelock.release(PLAIN)
    done.set()
    thread.join()
    assert len(seen) > 10, "the interpreter stood still"


@pytest.mark.skipif(os.name != "posix", reason="signals as on POSIX")
def test_an_interrupt_is_heard():
    # A shell ignores it for what runs in its background, and this may.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        interrupted()
    finally:
        signal.signal(signal.SIGINT, before)


def interrupted():
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        for _ in range(1000):
            weavelock.release(PLAIN)
    assert time.monotonic() - started < 5
    # Nothing works on: the search ended at its next step.
    time.sleep(2)
    before = time.process_time()
    time.sleep(1)
    assert time.process_time() - before < 0.3


def test_answers_are_those_of_the_program():
    assert json.loads(json.dumps(weavelock.ask("check", PLAIN))) == weavelock.check(PLAIN)


def test_the_notebook_runs(monkeypatch):
    """Every cell, in order, from the notebook's own folder; the last one says that the certificate is of full rank."""
    notebook = ROOT / "python/examples/notebook.ipynb"
    monkeypatch.chdir(notebook.parent)
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    sources = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    names = {}
    for source in sources:
        exec(compile(source, "notebook.ipynb", "exec"), names)
    assert names["answer"]["verdict"] == "locked"
    rank = np.linalg.matrix_rank(names["rows"])
    assert rank == names["rows"].shape[1]


def test_the_stubs_say_what_the_functions_are():
    pytest.importorskip("mypy.stubtest", reason="not run: no mypy here")
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "weavelock"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
