/// Links by range, by pairs, between devices that transmit and receive, and between devices of the caller's: each is,
/// to the last bit, what it is among all links, whatever is remembered and for any number of threads.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/sim/link_choice.hpp"
#include "dcem/sim/receiver_part.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/support/memory_trial.hpp"

namespace test_link_choice {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr std::size_t vehicles = 6, frames = 7;

/// A street with two houses and vehicles that come close to each other and part again.
Scene street() {
  Scene scene;
  scene.add_material({"brick", ItuMaterial{"brick", std::nullopt}});
  scene.add_material({"metal", PerfectConductor{}});
  TriangleMesh houses;
  add_quad(houses, {Vec3(-80, -40, 0), {80, -40, 0}, {80, 40, 0}, {-80, 40, 0}}, "brick");
  for (const double y_m : {-14.0, 14.0}) {
    const Vec3 low_m(-25, y_m - 4, 0), high_m(25, y_m + 4, 9);
    for (const double side_m : {low_m.y, high_m.y}) {
      add_quad(houses, {Vec3(low_m.x, side_m, 0), {high_m.x, side_m, 0}, {high_m.x, side_m, 9}, {low_m.x, side_m, 9}},
               "brick");
    }
    for (const double side_m : {low_m.x, high_m.x}) {
      add_quad(houses, {Vec3(side_m, low_m.y, 0), {side_m, high_m.y, 0}, {side_m, high_m.y, 9}, {side_m, low_m.y, 9}},
               "brick");
    }
    add_quad(houses,
             {Vec3(low_m.x, low_m.y, 9), {high_m.x, low_m.y, 9}, {high_m.x, high_m.y, 9}, {low_m.x, high_m.y, 9}},
             "brick");
  }
  scene.set_scenery(houses);
  for (std::size_t index = 0; index < vehicles; ++index) {
    const double row = static_cast<double>(index % 2), at = static_cast<double>(index);
    const double ahead = row > 0.5 ? -1.0 : 1.0;
    const Vec3 from_m(-40.0 * ahead + 4.0 * at, 3.0 * ahead, 0.05);
    scene.add_object("car" + std::to_string(index), make_box(Vec3(4.4, 1.8, 1.5), "metal"),
                     straight_way(frames, from_m, from_m + Vec3(70.0 * ahead, 0, 0)));
  }
  return scene;
}

Device on_car(std::size_t index) {
  return riding_device("car" + std::to_string(index), "car" + std::to_string(index), Vec3(0, 0, 1.7));
}

/// Every car carries a device that transmits and receives; a mast and a walker do one of both.
Scene busy_street() {
  Scene scene = street();
  scene.add_transmitter(device_at("mast", Vec3(-30, 9, 12), 30.0));
  for (std::size_t index = 0; index < vehicles; ++index) scene.add_transceiver(on_car(index));
  scene.add_receiver(moving_device("walker", straight_way(frames, Vec3(-20, 6, 1.5), Vec3(-10, 6, 1.5))));
  return scene;
}

/// The same devices, each of them a transmitter and a receiver for itself: links in both directions. With an ending,
/// receivers have names of their own.
Scene street_of_all_links(const std::string& ending = "") {
  Scene scene = street();
  scene.add_transmitter(device_at("mast", Vec3(-30, 9, 12), 30.0));
  for (std::size_t index = 0; index < vehicles; ++index) {
    scene.add_transmitter(on_car(index));
    Device receiver = on_car(index);
    receiver.id += ending;
    scene.add_receiver(std::move(receiver));
  }
  scene.add_receiver(moving_device("walker", straight_way(frames, Vec3(-20, 6, 1.5), Vec3(-10, 6, 1.5))));
  return scene;
}

using Ends = std::pair<std::string, std::string>;

std::map<Ends, std::string> by_ends(const Scene& scene, const std::vector<LinkResult>& links) {
  std::map<Ends, std::string> texts;
  for (const LinkResult& link : links) {
    LinkResult alone = link;
    const Ends ends{scene.transmitters()[link.transmitter].id, scene.receivers()[link.receiver].id};
    const bool is_new = texts.emplace(ends, bits(scene, alone)).second;
    CHECK(is_new);
  }
  return texts;
}

double distance_m(const Scene& scene, const Frame& frame, const Ends& ends) {
  const auto place_m = [&](std::span<const Device> devices, const std::string& id) {
    const auto found = std::ranges::find(devices, id, &Device::id);
    REQUIRE(found != devices.end());
    return scene.device_state(*found, frame).position_m;
  };
  return glm::length(place_m(scene.transmitters(), ends.first) - place_m(scene.receivers(), ends.second));
}

bool is_car(const std::string& id) {
  return id.starts_with("car");
}

/// Which of all links are wanted, by their ends and how far these are apart.
template <typename IsWanted>
void check_against_all_links(const LinkSettings& links, MemoryOrders orders, const IsWanted& is_wanted) {
  SimulationSettings settings = memory_settings(orders);
  Simulator all(street_of_all_links(), with_cache(settings, CacheMode::off));
  settings.links = links;
  Simulator from_scratch(busy_street(), with_cache(settings, CacheMode::off));
  Simulator remembering(busy_street(), with_cache(settings, CacheMode::exact));
  settings.threads = 2;
  Simulator threaded(busy_street(), with_cache(settings, CacheMode::exact));
  std::size_t chosen = 0, left_out = 0;
  for (std::size_t index = 0; index < frames; ++index) {
    const Frame frame = all.scene().frame_at(static_cast<double>(index), index);
    std::map<Ends, std::string> expected = by_ends(all.scene(), all.advance(frame).links);
    left_out += std::erase_if(
        expected, [&](const auto& link) { return !is_wanted(link.first, distance_m(all.scene(), frame, link.first)); });
    chosen += expected.size();
    for (Simulator* simulator : {&from_scratch, &remembering, &threaded}) {
      const std::vector<LinkResult> found = simulator->advance(frame).links;
      CHECK(by_ends(simulator->scene(), found) == expected);
      CHECK(std::ranges::is_sorted(found, {},
                                   [](const LinkResult& link) { return std::pair(link.transmitter, link.receiver); }));
    }
  }
  CHECK(chosen > 10);
  CHECK(left_out > 10);
}

bool once_a_pair(const Ends& ends) {
  return !is_car(ends.first) || !is_car(ends.second) || ends.first < ends.second;
}

}  // namespace

TEST_CASE("two devices that transmit and receive have one link, from the lesser id") {
  check_against_all_links({}, {1, 0, 1, 2}, [](const Ends& ends, double) { return once_a_pair(ends); });
}

TEST_CASE("links within a range are those of all links that are no longer, to the last bit") {
  for (const int interactions : {1, 2}) {
    check_against_all_links({25.0, std::nullopt}, {1, 0, 1, interactions},
                            [](const Ends& ends, double apart_m) { return once_a_pair(ends) && apart_m <= 25.0; });
  }
}

TEST_CASE("links by pairs are those, and with a range those of them that are no longer") {
  const std::vector<Ends> pairs{
      {"car1", "car0"}, {"mast", "walker"}, {"car2", "car5"}, {"mast", "car3"}, {"car4", "walker"}};
  const std::set<Ends> named{
      {"car0", "car1"}, {"mast", "walker"}, {"car2", "car5"}, {"mast", "car3"}, {"car4", "walker"}};
  check_against_all_links({std::nullopt, pairs}, {1, 0, 1, 2},
                          [&](const Ends& ends, double) { return named.contains(ends); });
  check_against_all_links({30.0, pairs}, {1, 0, 0, 1},
                          [&](const Ends& ends, double apart_m) { return named.contains(ends) && apart_m <= 30.0; });
}

TEST_CASE("parts of a run have each link once, with the bits that it has in the run as a whole") {
  const std::vector<Ends> pairs{{"car1", "car0"}, {"mast", "walker"}, {"car2", "car5"}, {"mast", "car3"}};
  for (const LinkSettings& links : {LinkSettings{}, LinkSettings{40.0}, LinkSettings{std::nullopt, pairs}}) {
    SimulationSettings settings = memory_settings({1, 0, 1, 2});
    settings.links = links;
    Simulator whole(busy_street(), with_cache(settings, CacheMode::off));
    constexpr std::uint32_t parts = 3;
    std::vector<Simulator> own;
    for (std::uint32_t part = 0; part < parts; ++part) {
      settings.links.receivers = ReceiverPart{part, parts};
      settings.threads = 1 + part % 2;
      own.emplace_back(busy_street(), with_cache(settings, part == 0 ? CacheMode::off : CacheMode::exact));
    }
    std::size_t parts_with_links = 0;
    for (std::size_t index = 0; index < frames; ++index) {
      const Frame frame = whole.scene().frame_at(static_cast<double>(index), index);
      std::vector<LinkResult> together;
      for (Simulator& part : own) {
        const std::vector<LinkResult> links_of_part = part.advance(frame).links;
        parts_with_links += links_of_part.empty() ? 0 : 1;
        together.insert(together.end(), links_of_part.begin(), links_of_part.end());
      }
      std::ranges::sort(together, {},
                        [](const LinkResult& link) { return std::pair(link.transmitter, link.receiver); });
      CHECK(bits(whole.scene(), together) == bits(whole.scene(), whole.advance(frame).links));
    }
    CHECK(parts_with_links >= 2 * frames);
  }
}

TEST_CASE("receivers of one part are near each other where links have a range, and parts have about as many links") {
  RandomStream random(3);
  std::vector<std::optional<Vec3>> places_m;
  std::vector<std::vector<std::uint32_t>> all;
  std::size_t links = 0;
  for (std::size_t index = 0; index < 4000; ++index) {
    places_m.emplace_back(Vec3(4000.0 * random.uniform() - 1000.0, 4000.0 * random.uniform(), 1.5));
    all.emplace_back(static_cast<std::size_t>(12.0 * random.uniform()), 0U);
    links += all.back().size();
  }
  places_m[5].reset();
  links -= all[5].size();
  all[5].clear();
  constexpr std::uint32_t parts = 16;
  std::vector<int> owners(places_m.size(), 0);
  double area_m2 = 0.0;
  for (std::uint32_t part = 0; part < parts; ++part) {
    auto own = all;
    keep_part({part, parts}, 100.0, places_m, own);
    std::size_t count = 0;
    Aabb<double> box;
    for (std::size_t index = 0; index < own.size(); ++index) {
      if (own[index].empty()) continue;
      CHECK(own[index] == all[index]);
      ++owners[index];
      count += own[index].size();
      box.extend(*places_m[index]);
    }
    CHECK(std::abs(static_cast<double>(count) - static_cast<double>(links) / parts) <= 12.0);
    area_m2 += (box.max.x - box.min.x) * (box.max.y - box.min.y);
  }
  for (std::size_t index = 0; index < all.size(); ++index) CHECK(owners[index] == (all[index].empty() ? 0 : 1));
  // Dealt out, the box of each part would be the whole square: sixteen times its area in all.
  CHECK(area_m2 < 3.0 * 4000.0 * 4000.0);
}

TEST_CASE("what is sampled remembers links that come and go by range, and reports only valid ones") {
  SimulationSettings settings = memory_settings({1, 0, 1, 2});
  settings.propagation.discovery = Discovery::sampled;
  settings.propagation.rays = 500;
  settings.links.range_m = 25.0;
  Simulator one(busy_street(), with_cache(settings, CacheMode::seed));
  settings.threads = 2;
  Simulator two(busy_street(), with_cache(settings, CacheMode::seed));
  for (std::size_t index = 0; index < frames; ++index) {
    const FrameResult frame = one.advance_to(static_cast<double>(index), index);
    CHECK(bits(one.scene(), frame.links) == bits(two.scene(), two.advance_to(static_cast<double>(index), index).links));
    for (const LinkResult& link : frame.links) {
      for (const PathContribution& path : link.paths) {
        CHECK(one.solve_path(link.transmitter, link.receiver, sequence_of(path.path)).has_value());
      }
    }
  }
}

TEST_CASE("a pair of a device that is not there is an error") {
  SimulationSettings settings = memory_settings({});
  settings.links.pairs = std::vector<Ends>{{"mast", "nobody"}};
  CHECK_THROWS_WITH_AS(Simulator(busy_street(), settings), "links: pairs: there is no receiver 'nobody'",
                       std::invalid_argument);
  settings.links = {0.0, std::nullopt};
  CHECK_THROWS_AS(Simulator(busy_street(), settings), std::invalid_argument);
  settings.links = {std::nullopt, std::nullopt, ReceiverPart{2, 2}};
  CHECK_THROWS_AS(Simulator(busy_street(), settings), std::invalid_argument);
}

TEST_CASE("candidates by cells are all pairs within the range, its ends included") {
  RandomStream random(7);
  const auto coordinate_m = [&] { return 10.0 * std::floor(random.uniform() * 40.0 - 20.0); };
  Scene scene;
  std::vector<std::optional<Vec3>> places_m;
  for (std::size_t index = 0; index < 300; ++index) {
    // On a lattice, so that many pairs are apart by the range exactly.
    places_m.emplace_back(Vec3(coordinate_m(), coordinate_m(), 10.0 * std::floor(random.uniform() * 3.0)));
    scene.add_transmitter(device_at("t" + std::to_string(index), *places_m.back()));
    scene.add_receiver(device_at("r" + std::to_string(index), *places_m.back()));
  }
  places_m[17].reset();
  for (const double range_m : {10.0, 30.0, 50.0, 1000.0}) {
    LinkChoice choice(scene, {range_m, std::nullopt});
    choice.place(places_m);
    for (std::size_t receiver = 0; receiver < 300; ++receiver) {
      const Vec3 here_m = scene.device_state_now(scene.receivers()[receiver], 0.0).position_m;
      std::vector<std::uint32_t> expected;
      for (std::uint32_t transmitter = 0; transmitter < 300; ++transmitter) {
        const auto& there_m = places_m[transmitter];
        if (there_m && glm::length(*there_m - here_m) <= range_m) expected.push_back(transmitter);
      }
      CHECK(choice.transmitters_of(receiver, here_m) == expected);
    }
  }
}

TEST_CASE("links between devices of the caller's are those that the scene would have with them") {
  const SimulationSettings settings = memory_settings({1, 0, 1, 2});
  Simulator own(street_of_all_links(), with_cache(settings, CacheMode::off));
  const FrameResult expected = own.advance_to(3.0);
  Simulator other(street(), settings);
  other.advance_to(3.0);
  const std::vector<Device> from(own.scene().transmitters().begin(), own.scene().transmitters().end());
  const std::vector<Device> to(own.scene().receivers().begin(), own.scene().receivers().end());
  std::vector<LinkRequest> requests;
  std::vector<LinkResult> wanted;
  for (const LinkResult& link : expected.links) {
    if ((link.transmitter + 2 * link.receiver) % 3 != 0) continue;
    requests.push_back({link.transmitter, link.receiver});
    wanted.push_back(link);
  }
  std::reverse(requests.begin(), requests.end());
  requests.push_back(requests.front());  // each once
  const std::vector<LinkResult> found = other.solve(from, to, requests);
  CHECK(requests.size() > 8);
  CHECK(bits(own.scene(), found) == bits(own.scene(), wanted));
  CHECK(other.solve(from, to, {}).empty());
  const std::vector<LinkRequest> nobody{{0, to.size()}};
  CHECK_THROWS_AS(other.solve(from, to, nobody), std::invalid_argument);
}

TEST_CASE("what a device sees as a transmitter it sees as a receiver") {
  for (const MemoryOrders orders : {MemoryOrders{1, 0, 1, 2}, MemoryOrders{2, 0, 1, 3}}) {
    for (const CacheMode cache : {CacheMode::off, CacheMode::exact}) {
      const SimulationSettings settings = with_cache(memory_settings(orders), cache);
      Simulator one(street_of_all_links(), settings), two(street_of_all_links("_receives"), settings);
      std::size_t links = 0;
      for (std::size_t index = 0; index < frames; ++index) {
        const Frame frame = one.scene().frame_at(static_cast<double>(index), index);
        const std::vector<LinkResult> of_one = one.advance(frame).links;
        std::vector<LinkResult> of_two = two.advance(frame).links;
        std::erase_if(of_two, [&](const LinkResult& link) {  // named apart, a device has a link to itself
          return one.scene().transmitters()[link.transmitter].id == one.scene().receivers()[link.receiver].id;
        });
        CHECK(bits(one.scene(), of_one) == bits(two.scene(), of_two));
        links += of_one.size();
      }
      CHECK(links == frames * ((vehicles + 1) * (vehicles + 1) - vehicles));
    }
  }
}

}  // namespace test_link_choice
