/// `paths.npz`, read back with a reader of its own and compared with the paths of the frames.
#include <doctest/doctest.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "dcem/io/result_writer.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_path_arrays {

using namespace dcem;
using dcem::test::TemporaryFolder;

namespace {

using Shape = std::vector<std::size_t>;

/// An array as a reader of NPY finds it.
struct Array {
  std::string type;
  Shape shape;
  std::string bytes;

  template <typename Value>
  std::vector<Value> as() const {
    std::vector<Value> values(bytes.size() / sizeof(Value));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(Value));
    return values;
  }
};

std::string between(const std::string& text, const std::string& before, const std::string& after) {
  const std::size_t begin = text.find(before);
  REQUIRE(begin != std::string::npos);
  const std::size_t end = text.find(after, begin + before.size());
  REQUIRE(end != std::string::npos);
  return text.substr(begin + before.size(), end - begin - before.size());
}

Array parsed(const std::string& bytes) {
  REQUIRE(bytes.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t length = static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  const std::string header = bytes.substr(10, length);
  REQUIRE(between(header, "'fortran_order': ", ",") == "False");
  Array array{between(header, "'descr': '", "'"), {}, bytes.substr(10 + length)};
  std::string numbers = between(header, "'shape': (", ")");
  while (!numbers.empty()) {
    const std::size_t comma = std::min(numbers.find(','), numbers.size());
    if (comma > 0 && numbers.substr(0, comma) != " ") array.shape.push_back(std::stoul(numbers.substr(0, comma)));
    numbers.erase(0, comma + 1);
  }
  return array;
}

std::map<std::string, Array> arrays_of(const std::filesystem::path& file) {
  zip_t* archive = zip_open(file.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, nullptr);
  REQUIRE(archive != nullptr);
  std::map<std::string, Array> arrays;
  for (zip_int64_t index = 0; index < zip_get_num_entries(archive, 0); ++index) {
    zip_stat_t facts;
    REQUIRE(zip_stat_index(archive, static_cast<zip_uint64_t>(index), 0, &facts) == 0);
    std::string bytes(facts.size, '\0');
    zip_file_t* entry = zip_fopen_index(archive, static_cast<zip_uint64_t>(index), 0);
    REQUIRE(zip_fread(entry, bytes.data(), facts.size) == static_cast<zip_int64_t>(facts.size));
    zip_fclose(entry);
    const std::string name = facts.name;
    arrays[name.substr(0, name.rfind(".npy"))] = parsed(bytes);
  }
  zip_discard(archive);
  return arrays;
}

/// A car of glass that passes between two masts and a street: paths come and go, reflected, through it, over its edges.
Scene street(PolarizationKind polarization) {
  Scene scene;
  scene.add_material({"floor", ConstantReflection{0.5, std::nullopt}});
  scene.add_material({"glass", ConstantReflection{0.5, 6.0}});
  TriangleMesh floor;
  add_quad(floor, {Vec3(-50, -50, 0), Vec3(50, -50, 0), Vec3(50, 50, 0), Vec3(-50, 50, 0)}, "floor");
  scene.set_scenery(floor);
  scene.add_object("car", make_box({4, 2, 1.5}, "glass"), LinearMotion{{Vec3(-4, 3, 0.01)}, Vec3(5, 0, 0), 0.0});
  scene.add_transmitter(device_at("west", {-9, 8, 3}, 20.0));
  scene.add_transmitter(device_at("east", {6, -7, 1}, 30.0));
  for (int number = 0; number < 3; ++number) {
    Device device = device_at("ue" + std::to_string(number), {2.0 * number, 9.0 - 8.0 * number, 1.2});
    device.antenna.polarization.kind = polarization;
    scene.add_receiver(device);
  }
  return scene;
}

struct Run {
  std::vector<FrameResult> frames;
  std::map<std::string, Array> arrays;
};

Run run(PolarizationKind polarization = PolarizationKind::vertical, unsigned threads = 1) {
  SimulationSettings settings;
  settings.propagation.discovery = Discovery::exact;
  settings.threads = threads;
  Simulator simulator(street(polarization), settings);
  const TemporaryFolder folder;
  io::OutputFolder out(folder / "out");
  io::OutputSettings output;
  output.links = false;
  output.npz = true;
  io::ResultFacts facts{Discovery::exact, settings.frequency_hz};
  facts.frames = 4;
  io::ResultWriter writer(out, simulator.scene(), simulator.scene().receivers(), facts, output);
  Run run;
  for (std::size_t frame = 0; frame < 4; ++frame) {
    run.frames.push_back(simulator.advance_to(0.5 * static_cast<double>(frame), frame));
    writer.write(run.frames.back());
  }
  writer.finish();
  out.commit();
  run.arrays = arrays_of(folder / "out" / "paths.npz");
  return run;
}

constexpr std::size_t frames = 4, receivers = 3, transmitters = 2;

std::size_t longest_list(const Run& run) {
  std::size_t longest = 0;
  for (const FrameResult& frame : run.frames) {
    for (const LinkResult& link : frame.links) longest = std::max(longest, link.paths.size());
  }
  return longest;
}

std::size_t most_interactions(const Run& run) {
  std::size_t most = 0;
  for (const FrameResult& frame : run.frames) {
    for (const LinkResult& link : frame.links) {
      for (const PathContribution& path : link.paths) most = std::max(most, path.path.interactions.size());
    }
  }
  return most;
}

/// Calls visit(path or null, place) for every place of the arrays, `place` counted over [F, R, T, P].
template <typename Visit>
void each_place(const Run& run, Visit&& visit) {
  const std::size_t longest = longest_list(run);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    std::vector<const LinkResult*> links(receivers * transmitters, nullptr);
    for (const LinkResult& link : run.frames[frame].links)
      links[link.receiver * transmitters + link.transmitter] = &link;
    for (std::size_t link = 0; link < links.size(); ++link) {
      REQUIRE(links[link] != nullptr);
      for (std::size_t slot = 0; slot < longest; ++slot) {
        const std::vector<PathContribution>& paths = links[link]->paths;
        visit(slot < paths.size() ? &paths[slot] : nullptr, (frame * links.size() + link) * longest + slot);
      }
    }
  }
}

}  // namespace

TEST_CASE("the arrays have the contract's names, types and shapes") {
  const Run result = run();
  const std::size_t p = longest_list(result), d = most_interactions(result);
  REQUIRE(p > 4);
  REQUIRE(d == 5);  // two reflections, an edge, into the car and out again
  const Shape list{frames, receivers, transmitters, p};
  struct Expected {
    std::string name, type;
    Shape shape;
  };
  const std::vector<Expected> expected{{"valid", "|b1", list},
                                       {"a", "<c16", list},
                                       {"transfer", "<c16", {frames, receivers, transmitters, p, 2, 2}},
                                       {"tau", "<f8", list},
                                       {"theta_t", "<f8", list},
                                       {"phi_t", "<f8", list},
                                       {"theta_r", "<f8", list},
                                       {"phi_r", "<f8", list},
                                       {"doppler", "<f8", list},
                                       {"interactions", "<u4", {d, frames, receivers, transmitters, p}},
                                       {"vertices", "<f8", {d, frames, receivers, transmitters, p, 3}},
                                       {"time_s", "<f8", {frames}},
                                       {"tx_id", "<U4", {transmitters}},
                                       {"rx_id", "<U3", {receivers}},
                                       {"frequency_hz", "<f8", {}}};
  CHECK(result.arrays.size() == expected.size());
  for (const Expected& one : expected) {
    CAPTURE(one.name);
    REQUIRE(result.arrays.contains(one.name));
    const Array& array = result.arrays.at(one.name);
    CHECK(array.type == one.type);
    CHECK(array.shape == one.shape);
  }
  CHECK(result.arrays.at("time_s").as<double>() == std::vector<double>{0.0, 0.5, 1.0, 1.5});
  CHECK(result.arrays.at("frequency_hz").as<double>() == std::vector<double>{30e9});
}

TEST_CASE("every path stands at its frame, receiver, transmitter and place, in SI units, and the rest is padding") {
  const Run result = run();
  const auto& arrays = result.arrays;
  const auto valid = arrays.at("valid").as<char>();
  const auto a = arrays.at("a").as<std::complex<double>>(), transfer = arrays.at("transfer").as<std::complex<double>>();
  std::map<std::string, std::vector<double>> fields;
  for (const char* name : {"tau", "theta_t", "phi_t", "theta_r", "phi_r", "doppler"}) {
    fields[name] = arrays.at(name).as<double>();
  }
  std::size_t padded = 0;
  each_place(result, [&](const PathContribution* path, std::size_t place) {
    CHECK(valid[place] == (path != nullptr ? 1 : 0));
    CHECK(a[place] == (path != nullptr ? path->amplitude : 0.0));
    CHECK(fields["tau"][place] == (path != nullptr ? path->delay_s : -1.0));
    CHECK(fields["theta_t"][place] == (path != nullptr ? path->departure.zenith_rad : 0.0));
    CHECK(fields["phi_t"][place] == (path != nullptr ? path->departure.azimuth_rad : 0.0));
    CHECK(fields["theta_r"][place] == (path != nullptr ? path->arrival.zenith_rad : 0.0));
    CHECK(fields["phi_r"][place] == (path != nullptr ? path->arrival.azimuth_rad : 0.0));
    CHECK(fields["doppler"][place] == (path != nullptr ? path->doppler_hz : 0.0));
    for (std::size_t entry = 0; entry < 4; ++entry) {
      CHECK(transfer[4 * place + entry] == (path != nullptr ? path->transfer(entry / 2, entry % 2) : 0.0));
    }
    padded += path == nullptr ? 1 : 0;
  });
  CHECK(padded > 0);
}

TEST_CASE("interactions have Sionna's codes from the transmitter on, with their points in metres") {
  const Run result = run();
  const auto codes = result.arrays.at("interactions").as<std::uint32_t>();
  const auto points = result.arrays.at("vertices").as<double>();
  const std::size_t places = frames * receivers * transmitters * longest_list(result);
  const std::map<char, std::uint32_t> sionna{{'R', 1}, {'S', 2}, {'T', 4}, {'D', 8}};
  std::map<std::uint32_t, std::size_t> seen;
  each_place(result, [&](const PathContribution* path, std::size_t place) {
    const std::size_t touches = path != nullptr ? path->path.interactions.size() : 0;
    for (std::size_t depth = 0; depth < most_interactions(result); ++depth) {
      const std::size_t at = depth * places + place;
      const Vec3 point_m(points[3 * at], points[3 * at + 1], points[3 * at + 2]);
      ++seen[codes[at]];
      if (depth < touches) {
        CHECK(codes[at] == sionna.at(static_cast<char>(path->path.interactions[depth].kind)));
        CHECK(point_m == path->path.interactions[depth].point_m);
      } else {
        CHECK(codes[at] == 0);
        CHECK(point_m == Vec3(0.0));
      }
    }
  });
  for (const std::uint32_t code : {0u, 1u, 4u, 8u}) CHECK(seen[code] > 0);
  CHECK(seen.size() == 4);
}

TEST_CASE("between dual-polarized antennas a is not a number, and the transfer is there") {
  const Run result = run(PolarizationKind::dual);
  const auto a = result.arrays.at("a").as<std::complex<double>>();
  const auto transfer = result.arrays.at("transfer").as<std::complex<double>>();
  each_place(result, [&](const PathContribution* path, std::size_t place) {
    CHECK((std::isnan(a[place].real()) && std::isnan(a[place].imag())) == (path != nullptr));
    if (path != nullptr) CHECK(transfer[4 * place] == path->transfer(0, 0));
  });
}

TEST_CASE("the number of threads changes no byte of the arrays") {
  const Run one = run(PolarizationKind::vertical, 1), four = run(PolarizationKind::vertical, 4);
  for (const auto& [name, array] : one.arrays) CHECK(four.arrays.at(name).bytes == array.bytes);
}

TEST_CASE("a tile of a rough surface is a path of kind 2 without a field") {
  const Scene scene = street(PolarizationKind::vertical);
  FrameResult frame;
  LinkResult link;
  link.transmitter = 1;
  link.receiver = 2;
  link.paths.resize(1);
  link.paths[0].path.length_m = 5.0;
  link.paths[0].amplitude = {0.5, 0.0};
  link.paths[0].delay_s = 5e-9;
  link.diffuse.tiles.resize(1);
  link.diffuse.tiles[0].sample = {1e-9, 4e-9, 12.0, {0.1, 0.2}, {0.3, 0.4}};
  link.diffuse.tiles[0].path = {{{InteractionKind::scattering, FacetId(0), {1, 2, 0}}}, 4.0};
  frame.links = {link};
  const TemporaryFolder folder;
  io::OutputFolder out(folder / "out");
  io::OutputSettings output;
  output.npz = true;
  io::ResultFacts facts{Discovery::exact, 30e9};
  facts.diffuse = facts.diffuse_paths = true;
  io::ResultWriter writer(out, scene, scene.receivers(), facts, output);
  writer.write(frame);
  writer.finish();
  out.commit();
  const auto arrays = arrays_of(folder / "out" / "paths.npz");
  CHECK(arrays.at("tau").shape == Shape{1, 3, 2, 2});
  const std::size_t first = (2 * transmitters + 1) * 2;  // the shorter of the two: the tile
  CHECK(arrays.at("tau").as<double>()[first] == 4e-9);
  CHECK(arrays.at("tau").as<double>()[first + 1] == 5e-9);
  CHECK(arrays.at("valid").as<char>()[first] == 1);
  CHECK(arrays.at("interactions").as<std::uint32_t>()[first] == 2);
  CHECK(arrays.at("a").as<std::complex<double>>()[first] == 0.0);
  CHECK(arrays.at("transfer").as<std::complex<double>>()[4 * first] == 0.0);
  CHECK(arrays.at("doppler").as<double>()[first] == 12.0);
  CHECK(arrays.at("phi_r").as<double>()[first] == 0.3);
}

TEST_CASE("without a path each axis still has the length 1, and every place is padding") {
  const Scene scene = street(PolarizationKind::vertical);
  const TemporaryFolder folder;
  io::OutputFolder out(folder / "out");
  io::OutputSettings output;
  output.npz = true;
  io::ResultWriter writer(out, scene, scene.receivers(), io::ResultFacts{Discovery::exact, 30e9}, output);
  writer.write(FrameResult{});
  writer.finish();
  out.commit();
  const auto arrays = arrays_of(folder / "out" / "paths.npz");
  CHECK(arrays.at("vertices").shape == Shape{1, 1, 3, 2, 1, 3});
  CHECK(arrays.at("tau").as<double>() == std::vector<double>(6, -1.0));
  CHECK(arrays.at("valid").as<char>() == std::vector<char>(6, 0));
}

TEST_CASE("arrays beyond 16 GB are refused with what they would need, before and while the frames come") {
  const Scene scene = street(PolarizationKind::vertical);
  const TemporaryFolder folder;
  io::OutputSettings output;
  output.npz = true;
  double limit_bytes = 1e15;  // more than the 16 GB
  const auto message_of = [&](std::size_t frame_count, const FrameResult& frame) -> std::string {
    io::OutputFolder out(folder / "out");
    io::ResultFacts facts{Discovery::exact, 30e9};
    facts.frames = frame_count;
    facts.memory_limit_bytes = limit_bytes;
    try {
      io::ResultWriter writer(out, scene, scene.receivers(), facts, output);
      writer.write(frame);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "nothing was refused";
  };
  FrameResult frame;
  frame.links.resize(1);
  // 6 links of one path with one interaction: 129 + 28 bytes each, 942 bytes a frame.
  const std::string expectation = " GB as arrays; expected at most 16 GB (fewer frames, receivers or paths)";
  CHECK(message_of(20'000'000, frame) == "output.npz: the paths of this run need 19" + expectation);
  CHECK(message_of(16'000'000, frame) == "nothing was refused");
  frame.links[0].paths.resize(2);
  CHECK(message_of(16'000'000, frame) == "output.npz: the paths of this run need 30" + expectation);
  limit_bytes = 1e6;
  CHECK(message_of(1000, frame) ==
        "output.npz: the paths of this run need 1884 kB as arrays; expected at most 1000 kB, the limit of memory "
        "(fewer frames, receivers or paths)");
  CHECK(message_of(500, frame) == "nothing was refused");
  CHECK_FALSE(std::filesystem::exists(folder / "out"));
}

}  // namespace test_path_arrays
