/// One question, one answer: whatever the number of threads, the order of the devices, the tree or what was solved
/// before.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "dcem/sim/verify/brute_force_simulator.hpp"
#include "tests/laws/moving_room.hpp"

namespace test_determinism {

using namespace dcem;
using namespace dcem::test;
using namespace moving_room;

TEST_CASE("determinism: 1, 2 and 5 threads, and twice in a row, give the same bits and the same counts of work") {
  for (const Way& way : all_ways) {
    std::vector<std::uint64_t> work;
    const Bytes expected = run<WideIndex>(ordered_scene(), way, 1, all_frames, &work);
    CHECK(expected.size() == all_frames.size() * transmitters * receivers);
    for (const unsigned threads : {1U, 2U, 5U}) {
      std::vector<std::uint64_t> other_work;
      CHECK(run<WideIndex>(ordered_scene(), way, threads, all_frames, &other_work) == expected);
      CHECK(other_work == work);
    }
  }
}

TEST_CASE("determinism: the order of transmitters and receivers changes no bit of any link") {
  Dice dice(93);
  for (const Way& way : all_ways) {
    const Bytes expected = run<WideIndex>(ordered_scene(), way, 1, all_frames);
    for (int trial = 0; trial < 3; ++trial) {
      std::vector<std::size_t> sending = counted(transmitters), receiving = counted(receivers);
      dice.shuffle(sending);
      dice.shuffle(receiving);
      CHECK(run<WideIndex>(moving_scene(sending, receiving), way, 2, all_frames) == expected);
    }
  }
}

TEST_CASE("determinism: a subset of the devices gives the same links") {
  for (const Way& way : {without_memory[1], seeded}) {
    const Bytes expected = run<WideIndex>(ordered_scene(), way, 1, all_frames);
    const Bytes some = run<WideIndex>(moving_scene({2}, {5, 1}), way, 1, all_frames);
    CHECK(some.size() == 2 * all_frames.size());
    for (const auto& [key, bytes] : some) CHECK(expected.at(key) == bytes);
  }
}

TEST_CASE("determinism: without a memory a frame does not depend on the frames before it") {
  for (const Way& way : without_memory) {
    const Bytes expected = run<WideIndex>(ordered_scene(), way, 1, all_frames);
    Bytes backwards = run<WideIndex>(ordered_scene(), way, 1, {3, 1, 2, 0});
    CHECK(backwards == expected);
    Bytes single;
    for (const std::size_t frame : all_frames) single.merge(run<WideIndex>(ordered_scene(), way, 1, {frame}));
    CHECK(single == expected);
  }
}

TEST_CASE("determinism: an object that came to a place is as one that always stood there") {
  const auto without_doppler = [](const FrameResult& frame, const Scene& scene) {
    Bytes bytes;
    for (const LinkResult& link : frame.links) {
      std::string& text = bytes[scene.transmitters()[link.transmitter].id + scene.receivers()[link.receiver].id];
      for (PathContribution path : link.paths) {
        path.doppler_hz = 0.0;
        text += path_id(scene, path.path);
        append_bits(text, all_numbers(path));
      }
    }
    return bytes;
  };
  for (const Way& way : without_memory) {
    Simulator moving(ordered_scene(), settings_of(way));
    for (const std::size_t frame : all_frames) {
      const double time_s = 0.23 * static_cast<double>(frame);
      Simulator standing(moving_scene(counted(transmitters), counted(receivers), time_s), settings_of(way));
      CHECK(without_doppler(moving.advance_to(time_s, frame), moving.scene()) ==
            without_doppler(standing.advance_to(time_s, frame), standing.scene()));
    }
  }
}

TEST_CASE("determinism: the tree changes the work and nothing else") {
  for (const Way& way : all_ways) {
    const Bytes expected = run<BruteForceIndex>(ordered_scene(), way, 1, all_frames);
    CHECK(run<WideIndex>(ordered_scene(), way, 1, all_frames) == expected);
  }
}

}  // namespace test_determinism
