"""Every answer against its own JSON Schema, by a library that knows nothing of the program."""

from pathlib import Path

import pytest
import weavelock

jsonschema = pytest.importorskip("jsonschema", reason="not run: needs the package jsonschema")

ROOT = Path(__file__).resolve().parents[2]
FIXTURES = ROOT / "fixtures"
LOCKED = FIXTURES / "assemblies/woven/plain-window.toml"
UNIT = FIXTURES / "assemblies/woven/plain-unit.toml"
TWILL = FIXTURES / "assemblies/woven/twill-unit.toml"
TAIL = FIXTURES / "assemblies/dovetail-open.toml"
CASE = FIXTURES / "assemblies/knob-in-case.toml"
PUZZLE = FIXTURES / "puzzles/piston.xmpuzzle"

# What is asked; {} stands for a folder of its own.
ASKED = [
    ["check", LOCKED],
    ["check", UNIT],
    ["check", CASE],
    ["check", PUZZLE],
    ["plan", LOCKED],
    ["plan", TAIL, "--table"],
    ["plan", PUZZLE],
    ["plan", TWILL, "--clearance", "0.2 mm", "--prefer", "air,above"],
    ["play", LOCKED, "--clearance", "0.2 mm"],
    ["release", TAIL],
    ["blocking", LOCKED],
    ["blocking", TAIL, "--direction", "0,0,1"],
    ["blocking", TAIL, "--finite"],
    ["flex", LOCKED],
    ["flex", TWILL],
    ["repeats", "[2,2,1]"],
    ["repeats", "[1,1,1]", "--swatch", "n,2n"],
    ["chirality", LOCKED],
    ["chirality", "[7,1,3]"],
    ["weave", "[2,2,1]"],
    ["weave", "[4,2,2]"],
    ["fab", LOCKED, "--out", "{}/plain"],
    ["processes"],
    ["draw", TAIL, "--out", "{}/a.png"],
    ["draw", LOCKED, "--what", "step=1", "--out", "{}/b.png"],
    ["export", TAIL, "--out", "{}/a.glb"],
    ["atlas", "--max-n", "3", "--out", "{}/atlas"],
    ["new", "{}/new.toml", "--defaults"],
    ["report", TAIL, "--out", "{}/a.html"],
    ["run", TAIL, "--out", "{}/all"],
]


@pytest.fixture(scope="module")
def schemas():
    found = weavelock.ask("schema")
    for schema in found.values():
        jsonschema.Draft202012Validator.check_schema(schema)
    return found


@pytest.mark.parametrize("words", ASKED, ids=lambda words: " ".join(Path(str(w)).name for w in words))
def test_an_answer_fits_its_schema(schemas, words, tmp_path):
    answer = weavelock.ask(*(str(w).replace("{}", str(tmp_path)) for w in words))
    schema = schemas[words[0]]
    jsonschema.Draft202012Validator(schema).validate(answer)
    known = schema.get("properties", {})
    unknown = [key for key in answer if known and key not in known]
    assert not unknown, f"the schema of {words[0]} lacks {unknown}"


@pytest.mark.parametrize("verb", ["check", "plan", "flex"])
def test_what_verify_says_fits_too(schemas, verb):
    answer = weavelock.ask(verb, str(LOCKED))
    jsonschema.Draft202012Validator(schemas["verify"]).validate(weavelock.verify(answer))


def test_every_verb_has_a_schema_and_was_asked(schemas):
    assert {words[0] for words in ASKED} | {"verify", "spec"} == set(schemas)


def test_a_wrong_answer_does_not_fit(schemas):
    answer = weavelock.check(TAIL)
    broken = [{**answer, "verdict": "maybe"}, {**answer, "parts": "two"}]
    broken.append({k: v for k, v in answer.items() if k != "verdict"})
    for wrong in broken:
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.Draft202012Validator(schemas["check"]).validate(wrong)


def test_specs_that_are_read_fit_the_schema_of_specs(schemas):
    tomllib = pytest.importorskip("tomllib", reason="not run: needs Python 3.11")
    specs = [f for f in FIXTURES.rglob("*.toml") if "bad" not in f.parts]
    assert len(specs) > 40
    valid = jsonschema.Draft202012Validator(schemas["spec"])
    for spec in specs:
        valid.validate(tomllib.loads(spec.read_text()))
    with pytest.raises(jsonschema.ValidationError):
        valid.validate({"weave": {"abc": [1, 1, 1]}, "swatch": {"wefts": "two", "warps": 2}})
