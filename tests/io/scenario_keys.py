#!/usr/bin/env python3
"""The keys of scenarios, by the schema that the program prints.

    scenario_keys.py program PROGRAM SOURCE_DIR   the program refuses every slip that the schema's keys allow to make;
                                                  defaults are what a scenario without the keys gets; the reader's source
                                                  and the reference page have the same keys
    scenario_keys.py schema PROGRAM SOURCE_DIR    an independent validator admits every scenario of the repository and
                                                  refuses the same slips; skips (77) where python3-jsonschema is missing
"""
import copy
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

failures = []


def check(holds, message):
    if not holds:
        failures.append(message)


def read_scenario(path):
    """With comments, which json does not know; no text in the repository's scenarios holds // or /*."""
    text = path.read_text(encoding="utf-8")
    return json.loads(re.sub(r"(?<!:)//[^\n]*|/\*.*?\*/", "", text, flags=re.S))


# --- The schema, as far as it is used here --------------------------------------------------------------------------

TYPES = {dict: "object", list: "array", str: "string", bool: "boolean", int: "number", float: "number", type(None): "null"}


def forms_of(schema, node):
    """The alternatives of a node, references resolved."""
    if "anyOf" in node:
        return [form for option in node["anyOf"] for form in forms_of(schema, option)]
    if "$ref" in node:
        return [schema["$defs"][node["$ref"].split("/")[-1]]]
    return [node]


def types_of(form):
    if "enum" in form:
        return {TYPES[type(word)] for word in form["enum"]}
    if "const" in form:
        return {TYPES[type(form["const"])]}
    return {{"integer": "number"}.get(form["type"], form["type"])}


def form_for(schema, node, value):
    """The alternative that a valid value takes."""
    return next(form for form in forms_of(schema, node) if TYPES[type(value)] in types_of(form))


def walk(schema, node, value, path=()):
    """(path, form, value) of a valid value and everything in it."""
    form = form_for(schema, node, value)
    yield path, form, value, node
    if isinstance(value, dict):
        for key, member in value.items():
            yield from walk(schema, form.get("properties", {}).get(key) or form["additionalProperties"], member, path + (key,))
    if isinstance(value, list):
        for index, element in enumerate(value):
            yield from walk(schema, form["items"], element, path + (index,))


def path_text(path):
    text = ""
    for step in path:
        text += f"[{step}]" if isinstance(step, int) else ("." if text else "") + step
    return text


# --- Slips ----------------------------------------------------------------------------------------------------------

def outside(form):
    """Numbers just outside the range of a form."""
    whole = form["type"] == "integer"
    low = form.get("minimum")
    yield form["exclusiveMinimum"] if low is None else low - 1 if whole else math.nextafter(low, -math.inf)
    yield form["maximum"] + 1 if whole else math.nextafter(form["maximum"], math.inf)
    if whole:
        yield form["minimum"] + 0.5


def wrong_values(schema, node, form, value):
    """Values that may not stand in the place of a valid one."""
    allowed = set().union(*(types_of(other) for other in forms_of(schema, node)))
    for other in (True, 7.5, "no such word", [], {}, None):
        if TYPES[type(other)] not in allowed:
            yield other
    if "enum" in form:
        yield "no such word"
    elif "const" in form:
        yield not form["const"]
    elif form["type"] == "string":
        yield ""
        yield from ["two\nlines"] if "pattern" in form else []
    elif form["type"] in ("number", "integer"):
        yield from outside(form)
    elif form["type"] == "array":
        yield from [[]] if "minItems" in form else []
        yield from [value[:-1], value + value[-1:]] if "maxItems" in form else []


def put(scenario, path, value):
    changed = copy.deepcopy(scenario)
    owner = changed
    for step in path[:-1]:
        owner = owner[step]
    owner[path[-1]] = value
    return changed


def without(scenario, path):
    changed = copy.deepcopy(scenario)
    owner = changed
    for step in path[:-1]:
        owner = owner[step]
    del owner[path[-1]]
    return changed


def slips_of_block(scenario, path, form, value):
    """(what, where the message must point, scenario)"""
    yield "unknown key", path + ("no_such_key",), put(scenario, path + ("no_such_key",), 1)
    for key in form.get("required", []):
        yield f"no {key}", path, without(scenario, path + (key,))
    for choice in form.get("allOf", []):
        keys = [option["required"][0] for option in choice["oneOf"]]
        there = next(key for key in keys if key in value)
        yield f"none of {keys}", path, without(scenario, path + (there,))
        for key in keys:
            if key != there:
                yield f"{there} and {key}", path, put(scenario, path + (key,), form["properties"][key].get("examples", [{}])[0])


def slips(schema, scenario):
    for path, form, value, node in walk(schema, schema, scenario):
        if "properties" in form:
            yield from slips_of_block(scenario, path, form, value)
        if path:
            for wrong in wrong_values(schema, node, form, value):
                yield f"{json.dumps(wrong)}", path, put(scenario, path, wrong)


def keys_of(schema):
    blocks = {"": schema, **schema["$defs"]}
    return {(name, key) for name, block in blocks.items() for key in block["properties"]}


def keys_in(schema, scenario):
    names = {id(block): name for name, block in {"": schema, **schema["$defs"]}.items()}
    return {(names[id(form)], key) for _, form, value, _ in walk(schema, schema, scenario) if "properties" in form
            for key in value}


# --- The program ----------------------------------------------------------------------------------------------------

class Program:
    def __init__(self, program, source):
        self.program, self.folder = program, Path(tempfile.mkdtemp())
        for name in ("good", "good_traffic", "good_antenna"):
            shutil.copytree(source / "tests/invalid_input" / name, self.folder / name)
        shutil.copytree(source / "tests/io/every_key", self.folder / "every_key")

    def text(self, *arguments):
        return subprocess.run([self.program, *arguments], capture_output=True, text=True, check=True).stdout

    def run(self, name, scenario, command="run"):
        file = self.folder / "every_key" / f"{name}.json"
        file.write_text(json.dumps(scenario))
        out = self.folder / name
        result = subprocess.run([self.program, command, str(file), "-o", str(out), "--quiet", "--threads", "1"],
                                capture_output=True, text=True)
        file.unlink()
        return result, out


def check_refused(program, number, what, path, scenario):
    result, out = program.run(f"slip_{number}", scenario)
    place = path_text(path)
    what = f"{place}: {what}"
    if result.returncode != 2:
        check(False, f"{what}: exit status {result.returncode}: {result.stderr}")
        return
    check(result.stderr.count("\n") == 1, f"{what}: not one line: {result.stderr}")
    check(not out.exists(), f"{what}: left an output folder")
    check(place in result.stderr, f"{what}: the message names another place: {result.stderr}")
    check("; expected " in result.stderr, f"{what}: the message does not say what was expected: {result.stderr}")


def check_unknown_keys_are_answered(program, schema, scenario):
    """Whoever mistypes a key is told all that may stand there."""
    for number, (path, form, _, _) in enumerate(walk(schema, schema, scenario)):
        if "properties" not in form:
            continue
        result, _ = program.run(f"unknown_{number}", put(scenario, path + ("no_such_key",), 1))
        said = set(re.split(r"[ ,;\n]+", result.stderr.rpartition("; expected ")[2]))
        missing = {key for key, value in form["properties"].items() if value.get("const") is not False} - said
        check(not missing, f"{path_text(path)}: an unknown key is not answered with {missing}: {result.stderr}")


def with_defaults(schema, scenario):
    """The same scenario with each key that it leaves out written as the schema says its default."""
    full = copy.deepcopy(scenario)
    for path, form, value, _ in list(walk(schema, schema, scenario)):
        owner = full
        for step in path:
            owner = owner[step]
        for key, rule in form.get("properties", {}).items():
            if "default" in rule and key not in value:
                owner[key] = rule["default"]
    return full


def box(name, material, motion):
    return {"id": name, "box_m": [0.4, 0.3, 1.8], "material": material, "motion": motion}


def plain_scenario(more):
    """As few keys as a scenario can have that leaves most of the others to their defaults."""
    return {"format": "dcem-scenario/1", "scene": {"obj": "../good/room.obj"}, "frequency_hz": 28e9,
            "itu": {}, "time": {}, "tree": {},
            "materials": {"rough": {"relative_permittivity": 5, "scattering": 0.5, "scattering_pattern": "backscattering"},
                          "mirror": {"relative_permittivity": 4}, "dull": {"relative_permittivity": 4, "scattering": 0.3},
                          "smooth": {"relative_permittivity": 3},
                          "plaster": {"layers": [{"relative_permittivity": 3, "thickness_m": 0.1}]}},
            "objects": [{"id": "plate", "obj": "plate.obj", "motion": {"position_m": [2, 2.5, 1.2]}},
                        box("a", "rough", {"position_m": [1, 4, 0]}), box("b", "smooth", {"position_m": [3, 1, 0]}),
                        box("c", "mirror", {"waypoints": [{"t_s": 0, "position_m": [1.5, 3, 0]}]}),
                        box("d", "dull", {"position_m": [2.5, 3.5, 0]})],
            "transmitters": [{"id": "tx", "motion": {"position_m": [0.5, 0.5, 2.5]}, "power_dbm": 20,
                              "antenna": {"array": {"rows": 2}}},
                             {"id": "list", "positions_m": [[1.5, 0.5, 2.4]], "power_w": 1, "antenna": {"array": {"columns": 2}}}],
            "receivers": [{"id": "rx", "motion": {"position_m": [3.5, 4.5, 1.5]}},
                          {"id": "area", "grid": {"origin_m": [0.5, 0.5, 1], "spacing_m": [1, 1], "count": [2, 3]}}],
            "noise": {"bandwidth_hz": 1e6}, **more}


def drop_what_does_not_go(full):
    """Keys that do not go with those of plain_scenario, not even with their defaults."""
    def drop(owner, *keys):
        for key in keys:
            owner.pop(key, None)

    for device in full["transmitters"] + full["receivers"]:
        drop(device, "sees_own_body")
    for thing in full["objects"]:
        drop(thing, *(("up", "unit_m") if "box_m" in thing else ()))
        drop(thing["motion"], *(("yaw_deg", "pitch_deg", "roll_deg") if "waypoints" in thing["motion"] else ()))
    lobes = ("scattering_lobe", "scattering_back_lobe", "scattering_forward_share")
    drop(full["materials"]["rough"], "roughness_rms_m")
    drop(full["materials"]["smooth"], "scattering", "scattering_pattern", *lobes)
    drop(full["materials"]["mirror"], "roughness_rms_m", *lobes)
    drop(full["materials"]["dull"], "roughness_rms_m", *lobes)
    drop(full["materials"]["plaster"], "conductivity_s_per_m", "roughness_rms_m", *lobes)


def check_defaults(program, schema):
    """A key left out, and the same key with what is said to be its default, give the same files."""
    for name, command, more in (
            ("plain", "run", {"propagation": {"max_transmissions": 0}, "output": {}}),
            ("blocks", "run", {"propagation": {"max_reflections": 1, "discovery": "sampled", "diffraction": {}, "diffuse": {}, "atmosphere": {},
                                               "path_loss": {"model": "close_in"}},
                               "output": {"pdp": {}, "doppler": {}, "paths": True}}),
            ("map", "map", {"propagation": {"max_reflections": 1}})):
        short = plain_scenario(more)
        full = with_defaults(schema, short)
        drop_what_does_not_go(full)
        files = []
        for kind, scenario in (("short", short), ("full", full)):
            result, out = program.run(f"{name}_{kind}", scenario, command)
            check(result.returncode == 0, f"defaults ({name}, {kind}): {result.stderr}")
            files.append(results_in(out))
        check(files[0] == files[1] and files[0], f"defaults ({name}): with what the schema says, other results")


def results_in(folder):
    """The files of a run, of its summary the settings alone: the rest is timing."""
    found = {file.name: file.read_bytes() for file in sorted(folder.glob("*"))}
    for name in [name for name in found if name.endswith("summary.json")]:
        found[name] = json.loads(found[name])["settings"]
    return found


def check_mtl(program, schema):
    """The keys of MTL files go by the same rules."""
    folder = program.folder / "mtl"
    folder.mkdir()
    (folder / "room.obj").write_text("mtllib room.mtl\nusemtl wall\nv 0 0 0\nv 9 0 0\nv 9 9 0\nf 1 2 3\n")
    scenario = plain_scenario({})
    scenario["scene"]["obj"] = "../mtl/room.obj"
    keys = schema["$defs"]["materials._"]["properties"]
    for key, rule in keys.items():
        for form in forms_of(schema, rule):
            wrong = ["word"] + [repr(value) for value in outside(form)] if form.get("type") in ("number", "integer") else []
            for value in wrong + (["no_such_word"] if "enum" in form else []):
                model = "" if key == "model" else "em_model pec\n"
                more = "em_scattering 0.5\n" if key == "scattering_pattern" else ""
                (folder / "room.mtl").write_text(f"newmtl wall\n{model}{more}em_{key} {value}\n")
                result, _ = program.run("mtl_case", scenario)
                said = "found '" if any(types_of(other) == {"number"} for other in forms_of(schema, rule)) else "unknown"
                check(result.returncode == 2 and f"em_{key}: {said}" in result.stderr,
                      f"em_{key} {value}: exit status {result.returncode}: {result.stderr}")
    (folder / "room.mtl").write_text("newmtl wall\nem_no_such_key 1\n")
    result, _ = program.run("mtl_case", scenario)
    missing = {key for key in keys if key != "layers" and f"em_{key}" not in result.stderr}
    check(result.returncode == 2 and not missing, f"em_no_such_key: {result.stderr}")


ACCESS = re.compile(r'\b(?:at|find|has|chosen|number|integer|count|boolean|member|order|find_object|find_unless_null|is_given|given)'
                    r'\((?:[a-z_*]+, )?"([a-z0-9$_]+)"')


def check_commands(program):
    def outcome(*arguments):
        result = subprocess.run([program.program, *arguments], capture_output=True, text=True)
        return result.returncode, result.stdout, result.stderr

    code, text, _ = outcome("keys")
    check(code == 0 and "propagation.rays" in text and "output.kml" in text, f"keys: {text}")
    code, text, _ = outcome("keys", "tile_budget")
    check(code == 0 and "propagation.diffuse.tile_budget" in text and "rays" not in text, f"keys tile_budget: {text}")
    code, text, error = outcome("keys", "no_such_word")
    check((code, text, error.count("\n")) == (2, "", 1) and "'no_such_word'" in error, f"keys no_such_word: {error}")
    check(outcome("keys", "--markdown", "rays")[0] == 2, "keys --markdown rays: taken")
    check(outcome("schema", "rays")[0] == 2, "schema rays: taken")


def check_page(program, source, schema):
    """Each key on the page is read by the source, and each key that the source asks for is on the page."""
    page = (source / "docs/scenario_reference.md").read_text(encoding="utf-8")
    check(page == program.text("keys", "--markdown"),
          "docs/scenario_reference.md is not what `dcem keys --markdown` prints; write it anew")
    schema_file = source / "data/dcem-scenario-1.schema.json"
    check(schema_file.read_text(encoding="utf-8") == program.text("schema"),
          "data/dcem-scenario-1.schema.json is not what `dcem schema` prints; write it anew")
    on_page = set(re.findall(r"^\| `([^`]+)` \|.*\|$", page, re.M))
    readers = [file.read_text(encoding="utf-8") for file in (source / "dcem/io/src/scenario").glob("*.cpp")]
    literals = {word for text in readers for word in re.findall(r'"([a-z0-9$_]+)"', text)}
    asked_for = {key for text in readers for key in ACCESS.findall(text)} - {"place", "power", "form", "shape", "file", "medium"}
    check(len(asked_for) > 60, f"only {len(asked_for)} keys found in the source of the reader: the pattern misses them")
    # Of a choice one key may be what is left when it is none of the others.
    left = {option["required"][0] for block in schema["$defs"].values() for choice in block.get("allOf", [])
            for option in choice["oneOf"]}
    check(on_page - left <= literals, f"on the page, but not in the reader: {sorted(on_page - left - literals)}")
    check(asked_for <= on_page, f"in the reader, but not on the page: {sorted(asked_for - on_page)}")


# --- The two tests --------------------------------------------------------------------------------------------------

def every_key(source, schema):
    scenarios = [read_scenario(source / "tests/io/every_key" / name) for name in ("drive.json", "traffic.json", "equipped.json")]
    missing = keys_of(schema) - set().union(*(keys_in(schema, scenario) for scenario in scenarios))
    check(not missing, f"in no scenario of tests/io/every_key: {sorted(missing)}")
    return scenarios


def test_program(program, source):
    schema = json.loads(program.text("schema"))
    scenarios = every_key(source, schema)
    for number, scenario in enumerate(scenarios):
        result, _ = program.run(f"good_{number}", scenario)
        check(result.returncode == 0, f"a good scenario is refused: {result.stderr}")
        check_unknown_keys_are_answered(program, schema, scenario)
    cases = [case for scenario in scenarios for case in slips(schema, scenario)]
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda numbered: check_refused(program, numbered[0], *numbered[1]), enumerate(cases)))
    check_defaults(program, schema)
    check_mtl(program, schema)
    check_page(program, source, schema)
    check_commands(program)
    check(len(cases) > 1000, f"only {len(cases)} slips were tried")
    print(f"{len(cases)} slips, {len(keys_of(schema))} keys")


def check_examples(schema, validator_of):
    """Examples and defaults are values that may stand there; what has no keys of its own has an example."""
    for block, key in sorted(keys_of(schema)):
        rule = (schema["$defs"][block] if block else schema)["properties"][key]
        values = rule.get("examples", []) + ([rule["default"]] if "default" in rule else [])
        has_keys = "$ref" in json.dumps(rule)
        check(has_keys or "examples" in rule, f"{block}.{key}: no example")
        for value in values:
            check(validator_of({**rule, "$defs": schema["$defs"]}).is_valid(value), f"{block}.{key}: {value} may not stand there")


def find_validator():
    """The validator of python3-jsonschema, if need be with the system's Python; skips where there is none."""
    try:
        import jsonschema
        return jsonschema.Draft202012Validator
    except ImportError:
        other = "/usr/bin/python3"
        if os.path.exists(other) and os.path.realpath(sys.executable) != os.path.realpath(other):
            os.execv(other, [other, *sys.argv])
        print("skipped: no Python with jsonschema (apt install python3-jsonschema)")
        sys.exit(77)


def test_schema(program, source, validator_of):
    schema = json.loads(program.text("schema"))
    validator_of.check_schema(schema)
    validator = validator_of(schema)
    shipped = [file for folder in ("data", "bench", "examples") for file in sorted((source / folder).rglob("*.json"))
               if '"dcem-scenario/1"' in file.read_text(encoding="utf-8") and not file.name.endswith(".schema.json")]
    for file in shipped:
        error = next(validator.iter_errors(read_scenario(file)), None)
        check(error is None, f"{file}: {error}")
    check(len(shipped) >= 15, f"only {len(shipped)} scenarios are shipped")
    count = 0
    for scenario in every_key(source, schema):
        check(validator.is_valid(scenario), f"a good scenario is refused: {next(validator.iter_errors(scenario), None)}")
        for what, path, wrong in slips(schema, scenario):
            check(not validator.is_valid(wrong), f"{path_text(path)}: {what}: admitted")
            count += 1
    check_examples(schema, validator_of)
    # Cases that are written by hand: no program made them from the schema.
    by_hand = refused = 0
    for file in sorted((source / "tests/invalid_input/cases").glob("*/scenario.json")):
        try:
            scenario = read_scenario(file)
        except ValueError:
            continue
        refuses = not validator.is_valid(scenario)
        by_hand, refused = by_hand + 1, refused + refuses
        if re.match(r"key_unknown|type_|.*_key_unknown$", file.parent.name) and not file.parent.name.startswith("mtl_"):
            check(refuses, f"{file}: admitted")
    check(refused > 70, f"of {by_hand} invalid scenarios the schema refuses only {refused}")
    print(f"{len(shipped)} scenarios admitted, {count} slips refused, and {refused} of {by_hand} invalid ones written by hand")


def main():
    if len(sys.argv) != 4 or sys.argv[1] not in ("program", "schema"):
        sys.exit(__doc__)
    source = Path(sys.argv[3]).resolve()
    judge = [] if sys.argv[1] == "program" else [find_validator()]
    if not judge and re.search(r"\bno [A-Z]?\w+", subprocess.run([sys.argv[2], "--version"], capture_output=True, text=True, check=True).stdout):
        print("skipped: a build without optional libraries refuses keys that it cannot serve")
        sys.exit(77)
    program = Program(os.path.realpath(sys.argv[2]), source)
    try:
        (test_schema if judge else test_program)(program, source, *judge)
    finally:
        shutil.rmtree(program.folder)
    print("\n".join(failure.strip() for failure in failures[:40]))
    sys.exit(f"{len(failures)} failures" if failures else 0)


if __name__ == "__main__":
    main()
