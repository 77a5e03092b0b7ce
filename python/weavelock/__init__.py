"""Decides whether an assembly of solid parts locks, proves it, plans how it goes together, makes its parts.

Every verb of the program is a function here; it returns the JSON answer as a dict (``weavelock schema`` describes
each). ``load`` gives the assembly itself with NumPy arrays. Bad input raises ValueError with file, place and a hint.
"""

from __future__ import annotations

import json as _json
import os as _os
import tempfile as _tempfile
from pathlib import Path as _Path

import numpy as _np

from ._weavelock import Assembly, ask as _ask, load

__all__ = [
    "Assembly", "ask", "blocking", "chirality", "check", "fab", "flex", "load", "from_meshes", "plan", "play",
    "release", "repeats", "verify", "weave",
]


def ask(*words: object) -> dict:
    """The answer of ``weavelock WORDS... --json``. Any verb and option works: ``ask("atlas", "--max-n", 4)``."""
    return _json.loads(_ask([_os.fspath(w) if isinstance(w, _os.PathLike) else str(w) for w in words])[1])


def _options(**named: object) -> list[str]:
    words: list[str] = []
    for name, value in named.items():
        if value is None or value is False:
            continue
        words.append("--" + name.replace("_", "-"))
        if value is not True:
            words.append(",".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value))
    return words


def check(file, *, fix=None, refine=False) -> dict:
    """Is it locked? By translations, by rigid motions; with a certificate or a motion."""
    return ask("check", file, *_options(fix=fix, refine=refine))


def plan(file, *, of=None, clearance=None) -> dict:
    """How does it come apart, and together? ``clearance`` as "0.2 mm"."""
    return ask("plan", file, *_options(of=of, clearance=clearance))


def play(file, clearance, *, of=None) -> dict:
    """How far parts made with this clearance shift and tilt."""
    return ask("play", file, *_options(clearance=clearance, of=of))


def release(file, *, process=None) -> dict:
    """How much clearance releases the lock."""
    return ask("release", file, *_options(process=process))


def flex(file, *, clearance=None, minimal=False, work=None) -> dict:
    """The fewest parts that must be flexible, with the bound's proof."""
    return ask("flex", file, *_options(clearance=clearance, minimal=minimal, work=work))


def blocking(file, *words) -> dict:
    """Which part stops which; further words as on the command line."""
    return ask("blocking", file, *words)


def repeats(weave, *, swatch=None, phases=None, most=None, clearance=None) -> dict:
    """The smallest repetition of the unit tile of ``[a, b, c]`` that locks."""
    return ask("repeats", _abc(weave), *_options(swatch=swatch, phases=phases, most=most, clearance=clearance))


def chirality(subject) -> dict:
    """Hands of tile, strands and assembly, of a file or ``[a, b, c]``."""
    return ask("chirality", _abc(subject))


def weave(subject) -> dict:
    """Period, floats, family of a draft; whether it hangs together."""
    return ask("weave", _abc(subject))


def fab(file, out, *, process=None, force=False, clearance=None, bed=None) -> dict:
    """Writes the fabricator's package into the folder ``out``."""
    return ask("fab", file, *_options(out=_os.fspath(out), process=process, force=force, clearance=clearance, bed=bed))


def verify(answer) -> dict:
    """Re-checks an answer (a dict from above, or the file that holds it) without the solver that made it."""
    if not isinstance(answer, dict):
        return ask("verify", answer)
    with _tempfile.TemporaryDirectory() as folder:
        file = _Path(folder, "answer.json")
        file.write_text(_json.dumps(answer), encoding="utf-8")
        return ask("verify", file)


def from_meshes(parts, folder, *, name="meshes", held=(), tolerance="0.001 mm", unit="mm") -> _Path:
    """Writes ``{id: (vertices, faces)}`` into ``folder`` (OBJ files and a spec); gives the spec's path for the verbs.

    Vertices: (n, 3) floats. Faces: (m, 3) indices from 0, counter-clockwise seen from outside; meshes are closed.
    """
    folder = _Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    lines = [f"name = {_json.dumps(name)}", "", "[contact]", f"tolerance = {_json.dumps(tolerance)}", ""]
    lines += ["[size]", f"unit = {_json.dumps(unit)}", ""]
    for k, (part, (vertices, faces)) in enumerate(parts.items()):
        points = _np.asarray(vertices, dtype=float)
        corners = _np.asarray(faces, dtype=int)
        if points.ndim != 2 or points.shape[1] != 3 or corners.ndim != 2 or corners.shape[1] != 3:
            raise ValueError(f"{part}: vertices are (n, 3) and faces (m, 3), not {points.shape} and {corners.shape}")
        text = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
        text += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in corners.tolist()]
        (folder / f"part-{k}.obj").write_text("\n".join(text) + "\n", encoding="ascii")
        lines += ["[[part]]", f"id = {_json.dumps(part)}", f'mesh = "part-{k}.obj"']
        lines += ["held = true", ""] if part in held else [""]
    spec = folder / "assembly.toml"
    spec.write_text("\n".join(lines), encoding="utf-8")
    return spec


def _abc(subject) -> str:
    if isinstance(subject, (list, tuple)):
        return "[" + ",".join(map(str, subject)) + "]"
    return _os.fspath(subject) if isinstance(subject, _os.PathLike) else str(subject)
