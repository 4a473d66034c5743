#!/usr/bin/env python3
"""Files for other programs, read by readers that are not DCEM's, against paths.jsonl and links.csv of the same run.

    read_back.py FORMAT PROGRAM SOURCE_DIR

Skips (77) where the reader of a format is not installed, or where the program writes none."""
import copy
import cmath
import csv
import datetime
import importlib
import importlib.util
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time
import urllib.parse
from pathlib import Path

SKIPPED = 77
C_MPS = 299792458.0


def skip(why):
    print("skipped: " + why)
    sys.exit(SKIPPED)


def needed(*modules):
    """The modules, if need be with the system's Python; skips where they are missing."""
    try:
        return [importlib.import_module(name) for name in modules]
    except ImportError as error:
        other = "/usr/bin/python3"
        if os.path.exists(other) and os.path.realpath(sys.executable) != os.path.realpath(other):
            os.execv(other, [other, *sys.argv])
        skip(f"no Python with {' and '.join(modules)} ({error})")


def check(holds, *what):
    if not holds:
        sys.exit("FAILED: " + " ".join(str(part) for part in what))


def equal(found, expected, *what):
    check(found == expected, *what, "is", found, "instead of", expected)


class Run:
    """A run of the program with some outputs beside the lists that they are compared with."""

    def __init__(self, program, source, outputs, change=lambda scenario: None):
        self.folder = Path(tempfile.mkdtemp())
        scenario = json.loads((source / "tests/io/exchange/drive.json").read_text(encoding="utf-8"))
        scenario["scene"]["obj"] = str(source / "data/crossing.obj")
        scenario["output"] = {"paths": True, "links": True, **outputs}
        change(scenario)
        self.scenario = scenario
        (self.folder / "drive.json").write_text(json.dumps(scenario), encoding="utf-8")
        self.result = subprocess.run([program, "run", str(self.folder / "drive.json"), "-o", str(self.out), "--quiet"],
                                     capture_output=True, text=True)

    @property
    def out(self):
        return self.folder / "out"

    def done(self, least=50):
        if self.result.returncode == 2 and "this build" in self.result.stderr:
            skip(self.result.stderr.strip())
        check(self.result.returncode == 0, self.result.stderr)
        self.lines = [json.loads(line) for line in (self.out / "paths.jsonl").read_text(encoding="utf-8").splitlines()]
        with open(self.out / "links.csv", encoding="utf-8", newline="") as file:
            self.links = list(csv.DictReader(file))
        check(sum(len(line["paths"]) for line in self.lines) > least, "too few paths to compare")
        return self

    def refused(self, *pieces):
        equal(self.result.returncode, 2, "exit code")
        equal(self.result.stderr.count("\n"), 1, "lines of", self.result.stderr)
        for piece in (*pieces, "; expected "):
            check(piece in self.result.stderr, piece, "is not in", self.result.stderr)
        check(not self.out.exists(), "a refused run left files")


def ids(scenario, kind):
    """Ids of devices as results have them."""
    names = []
    for device in scenario[kind]:
        points = device.get("positions_m")
        names += [f"{device['id']}[{k}]" for k in range(len(points))] if points else [device["id"]]
    return names


# --- MATLAB ---------------------------------------------------------------------------------------------------------

CODES = {"R": 1, "S": 2, "T": 4, "D": 8}


def dual(scenario):
    scenario["receivers"][1]["antenna"]["polarization"] = "VH"


def test_mat(program, source):
    numpy, scipy_io = needed("numpy", "scipy.io")
    for change in (lambda scenario: None, dual):
        run = Run(program, source, {"mat": True}, change).done()
        arrays = scipy_io.loadmat(run.out / "paths.mat")
        tx, rx = ids(run.scenario, "transmitters"), ids(run.scenario, "receivers")
        equal([str(cell[0][0]) for cell in arrays["tx_id"]], tx, "tx_id")
        equal([str(cell[0][0]) for cell in arrays["rx_id"]], rx, "rx_id")
        equal(arrays["frequency_hz"].tolist(), [[run.scenario["frequency_hz"]]], "frequency_hz")
        compare_arrays(numpy, arrays, run, tx, rx)
    print(f"{arrays['valid'].sum()} paths, {(run.out / 'paths.mat').stat().st_size / arrays['valid'].sum():.1f} bytes each")


def compare_arrays(numpy, arrays, run, tx, rx):
    depth = max(len(path["kinds"]) for line in run.lines for path in line["paths"])
    longest = max(len(line["paths"]) for line in run.lines)
    frames = run.scenario["time"]["frames"]
    shape = (frames, len(rx), len(tx), longest)
    equal(arrays["valid"].shape, shape, "shape of valid")
    equal(arrays["transfer"].shape, shape + (2, 2), "shape of transfer")
    equal(arrays["vertices"].shape, (depth,) + shape + (3,), "shape of vertices")
    equal(arrays["interactions"].dtype, numpy.uint32, "type of interactions")
    equal(int(arrays["valid"].sum()), sum(len(line["paths"]) for line in run.lines), "paths in all")
    for line in run.lines:
        link = (line["frame"], rx.index(line["rx"]), tx.index(line["tx"]))
        equal(arrays["time_s"][line["frame"], 0], line["time_s"], "time_s")
        for slot, path in enumerate(line["paths"]):
            compare_path(numpy, arrays, link + (slot,), path)


def compare_path(numpy, arrays, place, path):
    for name, value in {"tau": path["delay_s"], "doppler": path["doppler_hz"],
                        "theta_t": path["departure"]["zenith_rad"], "phi_t": path["departure"]["azimuth_rad"],
                        "theta_r": path["arrival"]["zenith_rad"], "phi_r": path["arrival"]["azimuth_rad"]}.items():
        equal(arrays[name][place], value, name, place)
    a = arrays["a"][place]
    if path["amplitude"] is None:
        check(numpy.isnan(a), "a at a dual antenna is", a)
    else:
        equal(a, complex(*path["amplitude"]), "a", place)
    for i in range(2):
        for j in range(2):
            equal(arrays["transfer"][place + (i, j)], complex(*path["transfer"][i][j]), "transfer", place)
    for depth, kind in enumerate(path["kinds"]):
        equal(arrays["interactions"][(depth,) + place], CODES[kind], "interactions", place)
        equal(arrays["vertices"][(depth,) + place].tolist(), path["points_m"][depth], "vertices", place)


# --- ns-3, by the format that its qd-channel reads --------------------------------------------------------------------

def qd_blocks(file):
    """Of each frame a list of rays, each (delay, gain, phase, zenith and azimuth of departure, of arrival), as
    qd-channel-model.cc takes the file apart."""
    lines = iter(file.read_text(encoding="ascii").splitlines())
    blocks = []
    for line in lines:
        count = int(line)
        columns = [[float(field) for field in next(lines).split(",")] for _ in range(7)] if count else []
        for column in columns:
            equal(len(column), count, "numbers in a line of", file.name)
        blocks.append(list(zip(*columns)))
    return blocks


def test_qd(program, source):
    run = Run(program, source, {"qd": True}).done()
    folder = run.out / "qd"
    nodes = list(dict.fromkeys(ids(run.scenario, "transmitters") + ids(run.scenario, "receivers")))
    settings = dict(line.split("\t") for line in (folder / "Input/paraCfgCurrent.txt").read_text().splitlines())
    times = sorted({line["time_s"] for line in run.lines})
    equal(int(settings["numberOfTimeDivisions"]), len(times), "numberOfTimeDivisions")
    equal(int(settings["numberOfNodes"]), len(nodes), "numberOfNodes")
    equal(float(settings["carrierFrequency"]), run.scenario["frequency_hz"], "carrierFrequency")
    check(abs(float(settings["totalTimeDuration"]) - 0.7 * len(times)) < 1e-9, "totalTimeDuration")
    compare_nodes(run, folder, nodes)
    files = {}
    rays = 0
    for line in run.lines:
        name = f"Tx{nodes.index(line['tx'])}Rx{nodes.index(line['rx'])}.txt"
        file = folder / "Output/Ns3/QdFiles" / name
        blocks = files.setdefault(name, qd_blocks(file))
        equal(len(blocks), len(times), "blocks of", name)
        equal(len(blocks[line["frame"]]), len(line["paths"]), "rays of", name)
        for ray, path in zip(blocks[line["frame"]], line["paths"]):
            compare_ray(ray, path, run.scenario["frequency_hz"])
            rays += 1
    equal(len(list((folder / "Output/Ns3/QdFiles").iterdir())), len(files), "files")
    size = sum(file.stat().st_size for file in (folder / "Output/Ns3/QdFiles").iterdir())
    print(f"{rays} rays, {size / rays:.1f} bytes each")
    Run(program, source, {"qd": True}, dual).refused("output.qd: ", "'corner' is VH")


def compare_nodes(run, folder, nodes):
    positions = [[float(field) for field in line.split(",")] for line in
                 (folder / "Output/Ns3/NodesPosition/NodesPosition.csv").read_text().splitlines()]
    equal(len(positions), len(nodes), "positions")
    equal(positions[nodes.index("pole")], [8.6, 8.3, 6.0], "position of the pole")
    track = [[float(field) for field in line.split(",")] for line in
             (folder / f"Input/NodePosition{nodes.index('on_car1')}.dat").read_text().splitlines()]
    equal(track[0], positions[nodes.index("on_car1")], "first position of the car")
    for frame, point in enumerate(track):  # 12 m/s from -38 m on
        check(abs(point[0] - (-38 + 12 * (0.5 + 0.7 * frame))) < 1e-9 and point[1:] == [-3, 1.6], "track of the car", point)


def compare_ray(ray, path, frequency_hz):
    delay, gain, phase, zenith_t, azimuth_t, zenith_r, azimuth_r = ray
    equal(delay, path["delay_s"], "delay")
    equal(gain, path["path_gain_db"], "gain")
    field = 10 ** (gain / 20) * cmath.exp(1j * (phase - 2 * math.pi * frequency_hz * delay))  # as ns-3 does
    amplitude = complex(*path["amplitude"])
    check(abs(field - amplitude) < 1e-9 * abs(amplitude), "field", field, amplitude)
    check(0 <= phase < 2 * math.pi, "phase", phase)
    for found, direction in (((zenith_t, azimuth_t), path["departure"]), ((zenith_r, azimuth_r), path["arrival"])):
        equal(found[0], math.degrees(direction["zenith_rad"]), "zenith")
        azimuth = math.degrees(direction["azimuth_rad"])
        equal(found[1], azimuth + 360 if azimuth < 0 else azimuth, "azimuth")


# --- HDF5 -----------------------------------------------------------------------------------------------------------

COLUMNS = {
    "delay_s": lambda path: path["delay_s"],
    "amplitude_re": lambda path: path["amplitude"][0], "amplitude_im": lambda path: path["amplitude"][1],
    "doppler_hz": lambda path: path["doppler_hz"],
    "departure_azimuth_rad": lambda path: path["departure"]["azimuth_rad"],
    "departure_zenith_rad": lambda path: path["departure"]["zenith_rad"],
    "arrival_azimuth_rad": lambda path: path["arrival"]["azimuth_rad"],
    "arrival_zenith_rad": lambda path: path["arrival"]["zenith_rad"],
    "path_gain_db": lambda path: path["path_gain_db"],
    "received_power_dbm": lambda path: path["received_power_dbm"],
    "length_m": lambda path: path["length_m"],
    "kinds": lambda path: sum(CODES[kind] for kind in set(path["kinds"])),
    "interaction_count": lambda path: len(path["kinds"]),
}


def test_hdf5(program, source):
    numpy, h5py = needed("numpy", "h5py")
    for precision, columns in (("double", None), ("single", list(COLUMNS))):
        settings = {"precision": precision, **({"columns": columns} if columns else {})}
        run = Run(program, source, {"hdf5": settings}).done()
        with h5py.File(run.out / "paths.h5", "r") as file:
            check(sorted(file["paths"]) == sorted(columns or list(COLUMNS)[:8]), "columns", list(file["paths"]))
            compare_columns(numpy, file, run, numpy.float64 if precision == "double" else numpy.float32)
            paths = file["links/path_count"][:].sum()
            print(f"{precision}: {paths} paths, {len(file['paths'])} columns, "
                  f"{sum(data.dtype.itemsize for data in file['paths'].values())} bytes each")
    one, two = (Run(program, source, {"hdf5": True}).done() for _ in range(2))
    equal((one.out / "paths.h5").read_bytes(), (two.out / "paths.h5").read_bytes(), "the bytes of a second run")


def compare_columns(numpy, file, run, real):
    tx, rx = ids(run.scenario, "transmitters"), ids(run.scenario, "receivers")
    equal([name.decode() for name in file["tx_id"][:]], tx, "tx_id")
    equal([name.decode() for name in file["rx_id"][:]], rx, "rx_id")
    equal(file["frames/time_s"][:].tolist(), sorted({line["time_s"] for line in run.lines}), "time_s")
    links = {name: file["links/" + name][:].tolist() for name in ("frame", "tx", "rx", "first_path", "path_count")}
    equal(len(links["frame"]), len(run.lines), "links")
    columns = {name: data[:] for name, data in file["paths"].items()}
    for number, line in enumerate(run.lines):
        equal((links["frame"][number], tx[links["tx"][number]], rx[links["rx"][number]], links["path_count"][number]),
              (line["frame"], line["tx"], line["rx"], len(line["paths"])), "link", number)
        for slot, path in enumerate(line["paths"]):
            for name, values in columns.items():
                kind = numpy.uint8 if name in ("kinds", "interaction_count") else real
                equal(values.dtype, kind, "type of", name)
                equal(values[links["first_path"][number] + slot], kind(COLUMNS[name](path)), name)


# --- Wireless InSite ------------------------------------------------------------------------------------------------

def p2m_receivers(file):
    """Of each receiver its paths, each (numbers, what it does, points), by the public description of the format."""
    lines = iter([line for line in file.read_text(encoding="ascii").splitlines() if not line.startswith("#")])
    receivers = []
    for number in range(int(next(lines))):
        receiver, count = map(int, next(lines).split())
        equal(receiver, number + 1, "number of a receiver")
        totals = [float(field) for field in next(lines).split()] if count else []
        paths = []
        for _ in range(count):
            numbers = [float(field) for field in next(lines).split()]
            kinds = next(lines)
            points = [[float(field) for field in next(lines).split()] for _ in range(int(numbers[1]) + 2)]
            paths.append((numbers, kinds, points))
        receivers.append((totals, paths))
    check(next(lines, None) is None, "text behind the last receiver of", file)
    return receivers


def test_p2m(program, source):
    run = Run(program, source, {"p2m": True}).done()
    tx, rx = ids(run.scenario, "transmitters"), ids(run.scenario, "receivers")
    links = {(int(row["frame"]), row["tx"], row["rx"]): row for row in run.links}
    size = count = 0
    for line in run.lines:
        file = run.out / f"p2m/frame_{line['frame']:04d}/dcem.paths.t{tx.index(line['tx']) + 1:03d}_01.r002.p2m"
        equal(file.read_text().splitlines()[20][0] + file.read_text().splitlines()[21], f"#{len(rx)}", "22 lines of head")
        totals, paths = p2m_receivers(file)[rx.index(line["rx"])]
        equal(len(paths), len(line["paths"]), "paths")
        row = links[line["frame"], line["tx"], line["rx"]]
        equal(totals, [float(row[name]) for name in ("power_dbm", "mean_delay_s", "rms_delay_spread_s")], "totals")
        for number, (found, path) in enumerate(zip(paths, line["paths"]), 1):
            compare_p2m(found, path, number)
            count += 1
        size = sum(file.stat().st_size for file in (run.out / "p2m").rglob("*.p2m"))
    print(f"{count} paths, {size / count:.1f} bytes each")
    try:
        compare_p2m_of_deepmimo(Run(program, source, {"p2m": True}, few_paths).done(least=20), tx, rx)
    except ImportError as error:
        print(f"not read by the parser of DeepMIMO, which is not there: {error}")
    Run(program, source, {"p2m": True}, dual).refused("output.p2m: ", "'corner' is VH")


def few_paths(scenario):
    """That parser loses its way behind a receiver of more than 25 paths."""
    scenario["propagation"].update(max_reflections=1, max_diffractions=0)


def compare_p2m(found, path, number):
    numbers, kinds, points = found
    letters = "".join("-" + {"S": "DS"}.get(kind, kind) for kind in path["kinds"])
    equal(kinds, f"Tx{letters}-Rx", "kinds")
    equal(points[1:-1], path["points_m"], "points")
    angles = [math.degrees(path[end][name]) for end in ("arrival", "departure") for name in ("zenith_rad", "azimuth_rad")]
    equal(numbers[:2], [number, len(path["kinds"])], "path")
    equal(numbers[2], path["received_power_dbm"], "power")
    equal(numbers[4], path["delay_s"], "delay")
    equal(numbers[5:], angles, "angles")
    phase = cmath.phase(complex(*path["amplitude"]))
    check(abs(math.radians(numbers[3]) - phase) < 1e-12, "phase", numbers[3], math.degrees(phase))
    way = sum(math.dist(a, b) for a, b in zip(points, points[1:]))
    check(abs(way - path["length_m"]) < 1e-6, "length", way, path["length_m"])


def compare_p2m_of_deepmimo(run, tx, rx):
    import numpy
    from deepmimo.converters.wireless_insite import p2m_parser
    line = max(run.lines, key=lambda line: len(line["paths"]))
    file = run.out / f"p2m/frame_{line['frame']:04d}/dcem.paths.t{tx.index(line['tx']) + 1:03d}_01.r002.p2m"
    data = p2m_parser.paths_parser(str(file))
    check(len(line["paths"]) <= 25, "too many paths for that parser")
    for slot, path in enumerate(line["paths"]):
        place = (rx.index(line["rx"]), slot)
        equal(data["power"][place], numpy.float32(path["received_power_dbm"]), "power by DeepMIMO's parser")
        equal(data["delay"][place], numpy.float32(path["delay_s"]), "delay by DeepMIMO's parser")
        equal(data["aod_el"][place], numpy.float32(math.degrees(path["departure"]["zenith_rad"])), "zenith by DeepMIMO's parser")


# --- DeepMIMO -------------------------------------------------------------------------------------------------------

def one_frame(scenario):
    scenario["time"]["frames"] = 1


def test_deepmimo(program, source):
    numpy, deepmimo = needed("numpy", "deepmimo")
    for change in (one_frame, lambda scenario: None):
        run = Run(program, source, {"deepmimo": True}, change).done()
        (run.folder / "deepmimo_scenarios").mkdir()
        (run.out / "deepmimo").rename(run.folder / "deepmimo_scenarios/drive")
        os.chdir(run.folder)
        dataset = deepmimo.load("drive", max_paths=1000)
        frames = run.scenario["time"]["frames"]
        equal(len(dataset) if frames > 1 else 1, frames, "scenes")
        for number in range(frames):
            compare_dataset(numpy, dataset[number] if frames > 1 else dataset, run, number)
    size = sum(file.stat().st_size for file in (run.folder / "deepmimo_scenarios").rglob("*.npz"))
    print(f"{size / sum(len(line['paths']) for line in run.lines):.1f} bytes for each path")
    Run(program, source, {"deepmimo": True}, dual).refused("output.deepmimo: ", "'corner' is VH")


def compare_dataset(numpy, scene, run, frame):
    tx, rx = ids(run.scenario, "transmitters"), ids(run.scenario, "receivers")
    digits = {"R": "1", "D": "2", "S": "3", "T": "4"}
    equal(float(scene.rt_params["frequency"] if len(tx) == 1 else scene[0].rt_params["frequency"]),
          run.scenario["frequency_hz"], "frequency")
    for line in (line for line in run.lines if line["frame"] == frame):
        data, r = scene[tx.index(line["tx"])], rx.index(line["rx"])
        paths = sorted(line["paths"], key=lambda path: -path["path_gain_db"])
        equal(int(numpy.sum(~numpy.isnan(data["power"][r]))), len(paths), "paths")
        for slot, path in enumerate(paths):
            equal(data["power"][r, slot], path["path_gain_db"], "power")
            equal(data["delay"][r, slot], path["delay_s"], "delay")
            equal(data["aod_az"][r, slot], math.degrees(path["departure"]["azimuth_rad"]), "aod_az")
            equal(data["aod_el"][r, slot], math.degrees(path["departure"]["zenith_rad"]), "aod_el")
            equal(data["aoa_az"][r, slot], math.degrees(path["arrival"]["azimuth_rad"]), "aoa_az")
            equal(data["aoa_el"][r, slot], math.degrees(path["arrival"]["zenith_rad"]), "aoa_el")
            equal(data["inter"][r, slot], float("".join(digits[kind] for kind in path["kinds"]) or "0"), "inter")
            equal(data["inter_pos"][r, slot, :len(path["kinds"])].tolist(), path["points_m"], "inter_pos")
            field = 10 ** (data["power"][r, slot] / 20) * cmath.exp(1j * math.radians(data["phase"][r, slot]))
            check(abs(field - complex(*path["amplitude"])) < 1e-9 * abs(field), "phase")
        if line["rx"] == "corner":
            equal(data["rx_pos"][r].tolist(), [-12.0, 6.0, 1.5], "rx_pos")
        if line["tx"] == "pole":
            equal(numpy.ravel(data["tx_pos"]).tolist(), [8.6, 8.3, 6.0], "tx_pos")
    objects = scene[0].scene.objects
    equal([element.name for element in objects], ["scenery", "car1", "bus <1> & \"2\""], "objects")


# --- glTF -----------------------------------------------------------------------------------------------------------

def test_gltf(program, source):
    numpy, trimesh, pygltflib = needed("numpy", "trimesh", "pygltflib")

    def change(scenario):
        scenario["output"]["gltf"] = {"frame": 2, "max_rays": 40}

    run = Run(program, source, {}, change).done()
    file = run.out / "scene.glb"
    gltf = pygltflib.GLTF2().load_binary(str(file))
    check(len(gltf.buffers) == 1 and gltf.buffers[0].byteLength <= len(gltf.binary_blob()), "buffer")
    compare_rays(numpy, gltf, run)
    compare_bodies(numpy, trimesh.load(str(file)), run)
    print(f"{file.stat().st_size} bytes")
    Run(program, source, {}, lambda scenario: scenario["output"].update(gltf={"frame": 4})).refused("output.gltf.frame: ")


def array_of(numpy, gltf, number):
    accessor = gltf.accessors[number]
    view = gltf.bufferViews[accessor.bufferView]
    kind, width = {5126: numpy.float32, 5121: numpy.uint8, 5125: numpy.uint32}[accessor.componentType], \
        {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor.type]
    values = numpy.frombuffer(gltf.binary_blob(), kind, accessor.count * width, view.byteOffset).reshape(-1, width)
    if accessor.min:
        equal(values.min(axis=0).tolist(), accessor.min, "min")
        equal(values.max(axis=0).tolist(), accessor.max, "max")
    return values


def compare_rays(numpy, gltf, run):
    lines = [line for line in run.lines if line["frame"] == 2]
    strongest = sorted((path["received_power_dbm"] for line in lines for path in line["paths"]), reverse=True)[:40]
    nodes = {node.name: node for node in gltf.nodes}
    shown = 0
    for line in lines:
        node = nodes.get(f"{line['tx']} to {line['rx']}")
        paths = sorted((path for path in line["paths"] if path["received_power_dbm"] >= strongest[-1]),
                       key=lambda path: -path["received_power_dbm"])
        if node is None:
            equal(paths, [], "rays of", line["tx"], line["rx"])
            continue
        equal(node.extras["received_power_dbm"], [path["received_power_dbm"] for path in paths], "powers")
        primitive, = gltf.meshes[node.mesh].primitives
        equal(primitive.mode, 1, "mode")
        found = array_of(numpy, gltf, primitive.attributes.POSITION)
        colours = array_of(numpy, gltf, primitive.attributes.COLOR_0)
        tx, rx = numpy.array(nodes[line["tx"]].translation), numpy.array(nodes[line["rx"]].translation)
        equal(node.translation, tx.tolist(), "origin")
        expected = []
        for path in paths:
            points = [tx, *map(numpy.array, path["points_m"]), rx]
            for a, b in zip(points, points[1:]):
                expected += [a - tx, b - tx]
        equal(found.tolist(), numpy.array(expected).astype(numpy.float32).tolist(), "points of rays")
        equal(len(colours), len(found), "colours")
        shown += len(paths)
    equal(shown, len(strongest), "rays in all")


def compare_bodies(numpy, scene, run):
    # z up became y up: (x, y, z) is at (x, z, -y). The bus is 12 m long, heads north, and drives at 8 m/s.
    transform, geometry = scene.graph["bus <1> & \"2\""]
    corners = trimesh_points(numpy, scene, geometry, transform)
    middle_y = -34 + 8 * 1.4
    for axis, (low, high) in enumerate(((3.4 - 1.275, 3.4 + 1.275), (0, 3.2), (-middle_y - 6, -middle_y + 6))):
        check(abs(corners[:, axis].min() - low) < 1e-5 and abs(corners[:, axis].max() - high) < 1e-5, "bus", axis,
              corners[:, axis].min(), corners[:, axis].max())
    transform, geometry = scene.graph["pole"]
    check(numpy.allclose(transform[:3, 3], [8.6, 6.0, -8.3], atol=1e-6), "pole", transform)


def trimesh_points(numpy, scene, geometry, transform):
    points = scene.geometry[geometry].vertices
    return points @ transform[:3, :3].T + transform[:3, 3]


# --- Google Earth ---------------------------------------------------------------------------------------------------

KML, GX = "{http://www.opengis.net/kml/2.2}", "{http://www.google.com/kml/ext/2.2}"
# Of the elements that are used, in the order that ogckml22.xsd demands; gx:Track as kml22gx.xsd has it.
KML_CHILDREN = {
    KML + "kml": [KML + "Document"],
    KML + "Document": [KML + "name", KML + "description", KML + "Style", (KML + "Folder", KML + "Placemark")],
    KML + "Folder": [KML + "name", KML + "Placemark"],
    KML + "Style": [KML + "LineStyle", KML + "PolyStyle"],
    KML + "LineStyle": [KML + "color", KML + "width"],
    KML + "PolyStyle": [KML + "color"],
    KML + "Placemark": [KML + "name", KML + "TimeSpan", KML + "styleUrl", KML + "ExtendedData",
                        (KML + "LineString", KML + "Point", GX + "Track")],
    KML + "TimeSpan": [KML + "begin", KML + "end"],
    KML + "ExtendedData": [KML + "Data"],
    KML + "Data": [KML + "value"],
    KML + "LineString": [KML + "extrude", KML + "altitudeMode", KML + "coordinates"],
    KML + "Point": [KML + "altitudeMode", KML + "coordinates"],
    GX + "Track": [KML + "altitudeMode", KML + "when", GX + "coord", GX + "angles"],
}


def check_kml_order(element):
    groups = [group if isinstance(group, tuple) else (group,) for group in KML_CHILDREN.get(element.tag, [])]
    place = 0
    for child in element:
        while place < len(groups) and child.tag not in groups[place]:
            place += 1
        check(place < len(groups), child.tag, "may not stand there in", element.tag)
        check_kml_order(child)


def kml_schema(etree, name):
    """A schema file that the Python package pykml brings, or nothing where it is not installed."""
    package = importlib.util.find_spec("pykml")
    if package is None or not package.submodule_search_locations:
        return None
    file = Path(package.submodule_search_locations[0]) / "schemas" / name
    return etree.XMLSchema(etree.parse(str(file))) if file.exists() else None


def check_kml_schema(etree, root):
    """By Google's schema, which extends that of OGC KML 2.2; by the latter alone but for the elements of the former."""
    google, ogc = (kml_schema(etree, name) for name in ("kml22gx.xsd", "ogckml22.xsd"))
    if google is None or ogc is None:
        return False
    check(google.validate(root), google.error_log)
    plain = copy.deepcopy(root)
    for mark in list(plain.iter(KML + "Placemark", KML + "GroundOverlay")):
        if any(child.tag.startswith(GX) for child in mark):
            mark.getparent().remove(mark)
    check(ogc.validate(plain), ogc.error_log)
    return True


def second(instant):
    start = datetime.datetime(2026, 5, 4, 12, 0, 0, tzinfo=datetime.timezone.utc)
    return (datetime.datetime.fromisoformat(instant.replace("Z", "+00:00")) - start).total_seconds()


def place_near(origin, x, y):
    """By the radii of curvature at the origin: within 100 m good to some millimetres."""
    major, e2 = 6378137.0, 0.0066943799901413165
    lat = math.radians(origin[0])
    w = math.sqrt(1 - e2 * math.sin(lat) ** 2)
    meridian, prime = major * (1 - e2) / w ** 3, major / w
    return origin[0] + math.degrees(y / meridian), origin[1] + math.degrees(x / (prime * math.cos(lat)))


def place_in_utm(zone, easting, northing):
    """L. Krueger, "Konforme Abbildung des Erdellipsoids in der Ebene" (1912), to the fourth order in n; north."""
    f = 1 / 298.257223563
    n = f / (2 - f)
    a = 6378137.0 / (1 + n) * (1 + n ** 2 / 4 + n ** 4 / 64)
    beta = (n / 2 - 2 * n ** 2 / 3 + 37 * n ** 3 / 96 - n ** 4 / 360, n ** 2 / 48 + n ** 3 / 15 - 437 * n ** 4 / 1440,
            17 * n ** 3 / 480 - 37 * n ** 4 / 840, 4397 * n ** 4 / 161280)
    delta = (2 * n - 2 * n ** 2 / 3 - 2 * n ** 3 + 116 * n ** 4 / 45, 7 * n ** 2 / 3 - 8 * n ** 3 / 5 - 227 * n ** 4 / 45,
             56 * n ** 3 / 15 - 136 * n ** 4 / 35, 4279 * n ** 4 / 630)
    xi, eta = northing / (0.9996 * a), (easting - 500000) / (0.9996 * a)
    xi1 = xi - sum(b * math.sin(2 * j * xi) * math.cosh(2 * j * eta) for j, b in enumerate(beta, 1))
    eta1 = eta - sum(b * math.cos(2 * j * xi) * math.sinh(2 * j * eta) for j, b in enumerate(beta, 1))
    chi = math.asin(math.sin(xi1) / math.cosh(eta1))
    lat = chi + sum(d * math.sin(2 * j * chi) for j, d in enumerate(delta, 1))
    return math.degrees(lat), 6 * zone - 183 + math.degrees(math.atan2(math.sinh(eta1), math.cos(xi1)))



def test_kml(program, source):
    etree, = needed("lxml.etree")

    def at(geo, **settings):
        def change(scenario):
            scenario["geo"] = geo
            scenario["output"]["kml"] = {"start": "2026-05-04T12:00:00Z", **settings}
        return change

    origin = (50.868, 9.708)
    near = at({"origin_lat_deg": origin[0], "origin_lon_deg": origin[1]}, range_dbm=[-90, -50], metres_per_db=0.25)
    run = Run(program, source, {}, near).done()
    root = etree.parse(run.out / "links.kml", etree.XMLParser(resolve_entities=False)).getroot()
    check_kml_order(root)
    print("valid by the schemas of KML 2.2" if check_kml_schema(etree, root) else "no schema (pip install pykml)")
    compare_lines(run, root, lambda x, y: place_near(origin, x, y))
    compare_tracks(run, root, lambda x, y: place_near(origin, x, y))
    print(f"{len(run.links)} links, {(run.out / 'links.kml').stat().st_size / len(run.links):.0f} bytes each")
    zone = Run(program, source, {}, at({"crs": "utm32n", "offset_m": [549800.5, 5635400.25]}))
    if "knows no UTM" not in zone.result.stderr:
        zone.done()
        root = etree.parse(zone.out / "links.kml").getroot()
        compare_lines(zone, root, lambda x, y: place_in_utm(32, x + 549800.5, y + 5635400.25), low=-120, high=-40, step=0.5)
    check_overlay(etree, program, run, origin)
    Run(program, source, {"kml": True}).refused("output.kml: ", "no place on the Earth")


def check_overlay(etree, program, run, origin):
    run.scenario["receivers"].append({"id": "area", "grid": {"origin_m": [-20, -20, 1.5], "spacing_m": [2, 2], "count": [10, 5]}})
    run.scenario["propagation"].update(max_reflections=1, max_diffractions=0)
    (run.folder / "map.json").write_text(json.dumps(run.scenario), encoding="utf-8")
    subprocess.run([program, "map", str(run.folder / "map.json"), "-o", str(run.folder / "map"), "--output", "kml", "--quiet",
                    "--frames", "0:1"], check=True)
    files = sorted(file.name for file in (run.folder / "map").glob("*.kml"))
    equal(files, ["map_area_Mast Süd %3C&%3E.kml", "map_area_best_server.kml", "map_area_pole.kml", "map_area_sinr.kml"], "overlays")
    for name in files:
        root = etree.parse(run.folder / "map" / name).getroot()
        check_kml_schema(etree, root)
        overlay = root.find(KML + "GroundOverlay")
        equal([child.tag for child in overlay], [KML + "name", KML + "description", KML + "color", KML + "Icon", GX + "LatLonQuad"],
              "elements of an overlay")
        picture = urllib.parse.unquote(overlay.findtext(f"{KML}Icon/{KML}href"))
        check((run.folder / "map" / picture).read_bytes().startswith(b"\x89PNG"), picture, "is no PNG")
        corners = [[float(part) for part in point.split(",")] for point in
                   overlay.findtext(f"{GX}LatLonQuad/{KML}coordinates").split()]
        for corner, (x, y) in zip(corners, ((-21, -21), (-1, -21), (-1, -11), (-21, -11))):
            check_place(corner, place_near(origin, x, y))


def compare_lines(run, root, place, low=-90, high=-50, step=0.25):
    lines = [mark for mark in root.iter(KML + "Placemark") if mark.find(KML + "LineString") is not None]
    rows = [row for row in run.links if row["power_incoherent_dbm"]]
    equal(len(lines), len(rows), "lines")
    colours = {style.get("id"): style.findtext(f"{KML}LineStyle/{KML}color") for style in root.iter(KML + "Style")}
    times = sorted({float(row["time_s"]) for row in run.links})
    for mark, row in zip(lines, rows):
        data = {item.get("name"): item.findtext(KML + "value") for item in mark.iter(KML + "Data")}
        equal((data["tx"], data["rx"]), (row["tx"], row["rx"]), "ends")
        for name in ("power_dbm", "power_incoherent_dbm"):
            equal(data[name], row[name], name)
        begin, end = (second(mark.findtext(f"{KML}TimeSpan/{KML}{word}")) for word in ("begin", "end"))
        check(abs(begin - float(row["time_s"])) < 1e-6, "begin", begin)
        later = [time for time in times if time > float(row["time_s"])] or [times[-1] + 0.7]
        check(abs(end - later[0]) < 1e-6, "end", end)
        share = min(1, max(0, (float(row["power_incoherent_dbm"]) - low) / (high - low)))
        style = mark.findtext(KML + "styleUrl")[1:]
        check(abs(int(style[1:]) / 63 - share) <= 0.5 / 63 + 1e-9, "colour", style, "for", share)
        check(len(colours[style]) == 8, "colour", colours[style])
        height = max(0, float(row["power_incoherent_dbm"]) - low) * step
        points = [[float(part) for part in point.split(",")] for point in
                  mark.findtext(f"{KML}LineString/{KML}coordinates").split()]
        for point in points:
            check(abs(point[2] - height) <= 0.00051, "height", point, height)
        if row["tx"] == "pole":
            check_place(points[0], place(8.6, 8.3))
        if row["rx"] == "corner":
            check_place(points[1], place(-12.0, 6.0))


def check_place(point, expected):
    check(abs(point[1] - expected[0]) < 2e-9 and abs(point[0] - expected[1]) < 3e-9, "place", point, expected)


def compare_tracks(run, root, place):
    tracks = {mark.findtext(KML + "name"): mark.find(GX + "Track") for mark in root.iter(KML + "Placemark")
              if mark.find(GX + "Track") is not None}
    equal(sorted(tracks), ["bus <1> & \"2\"", "car1"], "names of tracks")
    bus = tracks["bus <1> & \"2\""]
    whens = [second(when.text) for when in bus.iter(KML + "when")]
    coords = [[float(part) for part in coord.text.split()] for coord in bus.iter(GX + "coord")]
    equal(len(whens), run.scenario["time"]["frames"], "instants of a track")
    equal(len(coords), len(whens), "points of a track")
    for when, coord in zip(whens, coords):  # 8 m/s to the north from 0.5 s on
        check_place(coord, place(3.4, -34 + 8 * (when - 0.5)))
    for angles in bus.iter(GX + "angles"):
        check(abs(math.remainder(float(angles.text.split()[0]), 360)) < 1e-4, "heading", angles.text)
    for angles in tracks["car1"].iter(GX + "angles"):
        check(abs(float(angles.text.split()[0]) - 90) < 0.01, "heading", angles.text)
    points = [mark for mark in root.iter(KML + "Placemark") if mark.find(KML + "Point") is not None]
    equal(sorted(mark.findtext(KML + "name") for mark in points), ["Mast Süd <&>", "corner", "pole", "probe[0]", "probe[1]"],
          "standing devices")


# --- Runs that are killed ---------------------------------------------------------------------------------------------

def test_resumed(program, source):
    """A run that was killed and goes on has the bytes of one that was not."""
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout
    scenario = read_scenario(source / "data/town_drive.json")
    scenario["scene"]["obj"] = str(source / "data" / scenario["scene"]["obj"])
    scenario["geo"] = {"origin_lat_deg": 50.868, "origin_lon_deg": 9.708}
    scenario["output"] = {"qd": True, "p2m": True, "deepmimo": True, "kml": True, "gltf": {"frame": 20},
                          "hdf5": "no HDF5" not in version, "mat": "no matio" not in version}
    folder = Path(tempfile.mkdtemp())
    (folder / "town.json").write_text(json.dumps(scenario), encoding="utf-8")

    def command(out):
        return [program, "run", str(folder / "town.json"), "-o", str(folder / out), "--frames", "0:30", "--quiet"]

    subprocess.run(command("whole"), check=True)
    killed = subprocess.Popen(command("killed"))
    journal = folder / "killed/run.journal"
    while killed.poll() is None and not (journal.exists() and journal.stat().st_size > 2_000_000):
        time.sleep(0.01)
    killed.kill()
    killed.wait()
    check(journal.exists(), "the run was whole before it was killed")
    left = [file.name for file in (folder / "killed").iterdir() if not file.name.startswith(".")]
    equal(left, ["run.journal"], "files of a killed run")
    subprocess.run([*command("killed"), "--resume"], check=True)
    names = sorted(str(file.relative_to(folder / "whole")) for file in (folder / "whole").rglob("*") if file.is_file())
    equal(sorted(str(file.relative_to(folder / "killed")) for file in (folder / "killed").rglob("*") if file.is_file()), names,
          "files of a resumed run")
    for name in names:
        if name != "summary.json":  # which has times
            check((folder / "whole" / name).read_bytes() == (folder / "killed" / name).read_bytes(), name, "differs")
    print(f"{len(names)} files are the same")


def read_scenario(path):
    """With comments, which json does not know; no text in the scenario holds // or /*."""
    text = path.read_text(encoding="utf-8")
    return json.loads(re.sub(r"(?<!:)//[^\n]*|/\*.*?\*/", "", text, flags=re.S))


def main():
    tests = {name[len("test_"):]: function for name, function in globals().items() if name.startswith("test_")}
    if len(sys.argv) != 4 or sys.argv[1] not in tests:
        sys.exit(__doc__)
    tests[sys.argv[1]](os.path.realpath(sys.argv[2]), Path(sys.argv[3]).resolve())


if __name__ == "__main__":
    main()
