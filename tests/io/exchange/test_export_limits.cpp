/// What files for other programs refuse before anything is computed.
#include <doctest/doctest.h>

#include <string>

#include "dcem/io/optional_libraries.hpp"
#include "dcem/io/result_writer.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_export_limits {

using namespace dcem;
using dcem::test::TemporaryFolder;

namespace {

std::string refused(const io::OutputSettings& output, std::size_t frames, std::size_t receivers) {
  Scene scene;
  scene.add_transmitter(device_at("tx", {0, 0, 5}, 20.0));
  for (std::size_t number = 0; number < receivers; ++number) {
    scene.add_receiver(device_at("rx" + std::to_string(number), {1, static_cast<double>(number), 1.5}));
  }
  io::ResultFacts facts{Discovery::exact, 30e9};
  facts.frames = frames;
  const TemporaryFolder folder;
  io::OutputFolder out(folder / "out");
  try {
    const io::ResultWriter writer(out, scene, scene.receivers(), facts, output);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("an array that no MAT file can hold is refused at once, with the size and a way out") {
  io::OutputSettings output;
  output.exchange.mat = true;
  CHECK(refused(output, 33'000'000, 1).empty());
  const std::string told = refused(output, 34'000'000, 1);  // `transfer` takes 64 bytes a place
  CHECK(told.find("output.mat: one array of this run's paths needs 2176 MB; expected at most 2147 MB") == 0);
  CHECK(told.find("output.npz") != std::string::npos);
}

TEST_CASE("formats with a file for everything refuse what needs too many") {
  io::OutputSettings output;
  output.exchange.p2m = true;
  CHECK(refused(output, 100'000, 1).empty());
  CHECK(refused(output, 100'001, 1).find("output.p2m: frames and transmitters need 100001 files; expected at most") ==
        0);
  output.exchange.p2m = false;
  output.exchange.deepmimo = true;
  CHECK(refused(output, 10'000, 1).find("output.deepmimo: frames and transmitters need 110000 files") == 0);
}

TEST_CASE("a frame that is not among those of the run has no picture") {
  io::OutputSettings output;
  output.exchange.gltf = true;
  output.exchange.gltf_settings.frame = 3;
  CHECK(refused(output, 4, 1).empty());
  CHECK(refused(output, 3, 1) == "output.gltf.frame: 3 is not among the frames of this run; expected one from 0 to 2");
}

}  // namespace test_export_limits
