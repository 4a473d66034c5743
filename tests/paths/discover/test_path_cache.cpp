/// The memory of a receiver: sequences and nothing else, written anew in each frame, tried before anything is searched.
#include "dcem/paths/discover/path_cache.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "dcem/paths/path_finder.hpp"
#include "dcem/paths/path_id.hpp"
#include "tests/paths/small_scenes.hpp"

namespace test_path_cache {

using namespace dcem;
using namespace dcem::test;

namespace {

using Ends = std::vector<std::optional<LinkEnd>>;

FacetId facet(std::size_t index) {
  return FacetId(index);
}

Path path_over(const std::vector<std::pair<InteractionKind, std::size_t>>& interactions) {
  Path path;
  for (const auto& [kind, index] : interactions) path.interactions.push_back({kind, facet(index), Vec3(1.0)});
  path.length_m = 7.0;
  return path;
}

constexpr InteractionKind R = InteractionKind::reflection;
constexpr InteractionKind T = InteractionKind::transmission;

/// A path that is diffracted at edge `edge` of facet 6 between two reflections.
Path path_over_edge(std::size_t edge) {
  Path path = path_over({{R, 1}, {T, 8}, {InteractionKind::diffraction, 6}, {R, 2}});
  path.interactions[2].wedge = WedgeId(edge);
  return path;
}

std::vector<Sequence> listed(const SequenceTable* table) {
  REQUIRE(table != nullptr);
  std::vector<Sequence> all;
  for (std::size_t number = 0; number < table->size(); ++number) {
    all.emplace_back((*table)[number].begin(), (*table)[number].end());
  }
  return all;
}

}  // namespace

// What is handed out is lists of numbers of facets and edges: no point, no length and no gain.
static_assert(std::is_same_v<decltype(PathCache().sequences(0)), const SequenceTable*>);
static_assert(std::is_same_v<decltype((*PathCache().sequences(0))[0]), std::span<const SequenceElement>>);
static_assert(sizeof(SequenceElement) == sizeof(std::uint32_t));

TEST_CASE("the mirrors and edges of a path count from the receiver and leave out what it crosses") {
  CHECK(sequence_of({}).empty());
  CHECK(sequence_of(path_over({{T, 9}, {R, 1}, {T, 8}, {R, 2}, {R, 3}, {T, 7}})) ==
        Sequence{facet(3), facet(2), facet(1)});
  CHECK(sequence_of(path_over({{T, 9}})).empty());
  CHECK(sequence_of(path_over_edge(1)) == Sequence{facet(2), WedgeId(1), facet(1)});
  CHECK(sequence_of(path_over_edge(1)) != Sequence{facet(2), facet(1), facet(1)});
}

TEST_CASE("proposals are kept for their lifetime after the last ray that followed them, in the order they came") {
  ProposalMemory memory;
  const auto held = [&] {
    std::vector<Sequence> all;
    memory.for_each([&](auto sequence) { all.emplace_back(sequence.begin(), sequence.end()); });
    CHECK(all.size() == memory.size());
    return all;
  };
  const Sequence direct, one{facet(1)}, other{facet(2), facet(1)}, reverse{facet(1), facet(2)};
  CHECK_FALSE(memory.note(direct));
  CHECK_FALSE(memory.note(other));
  CHECK_FALSE(memory.note(one));
  CHECK(memory.note(other));
  CHECK(held() == std::vector<Sequence>{direct, other, one});
  memory.next_frame(2);
  CHECK(memory.note(one));
  CHECK_FALSE(memory.note(reverse));
  memory.next_frame(2);
  CHECK(held() == std::vector<Sequence>{direct, other, one, reverse});
  CHECK(memory.note(other));
  memory.next_frame(2);  // three frames since the direct one
  CHECK(held() == std::vector<Sequence>{other, one, reverse});
  CHECK(memory.note(reverse));
  memory.next_frame(2);
  CHECK(held() == std::vector<Sequence>{other, reverse});
  CHECK_FALSE(memory.note(one));
  memory.clear();
  CHECK(memory.size() == 0);
  CHECK_FALSE(memory.note(other));
}

TEST_CASE("what is appended again in later frames is kept once, for its lifetime after the last time") {
  ProposalMemory memory;
  for (int frame = 0; frame < 6; ++frame) {
    for (std::size_t mirror = 0; mirror < 40; ++mirror) {
      if (frame < 3 || mirror % 2 == 0) memory.append(Sequence{facet(mirror)});
    }
    memory.next_frame(2);
  }
  CHECK(memory.size() == 40);  // of the last two frames, as they came
  memory.next_frame(2);
  CHECK(memory.size() == 20);
  for (std::size_t number = 0; number < memory.size(); ++number) CHECK(memory[number][0] == facet(2 * number));
  CHECK(memory.note(Sequence{facet(4)}));
  CHECK_FALSE(memory.note(Sequence{facet(5)}));
}

TEST_CASE("a cache knows no link until one is remembered, and a link without paths is one all the same") {
  PathCache cache;
  CHECK(cache.sequences(0) == nullptr);
  cache.begin_frame(3);
  CHECK(cache.sequences(1) == nullptr);
  cache.remember(1, {});
  const std::vector<Path> paths{path_over({}), path_over({{R, 4}, {T, 5}, {R, 6}})};
  cache.remember(2, paths);
  CHECK(cache.sequences(0) == nullptr);
  CHECK(listed(cache.sequences(1)).empty());
  CHECK(listed(cache.sequences(2)) == std::vector<Sequence>{{}, {facet(6), facet(4)}});
  CHECK(cache.sequences(99) == nullptr);
  cache.begin_frame(3);
  CHECK(cache.sequences(2) == nullptr);
  CHECK(listed(cache.sequences_before(2)).size() == 2);
  CHECK(cache.sequences_before(0) == nullptr);
}

TEST_CASE("forgetting takes the sequences that lead over a facet, keeps the links, and counts") {
  PathCache cache;
  cache.begin_frame(3);
  const std::vector<Path> paths{path_over({}), path_over({{R, 4}, {T, 5}, {R, 6}}), path_over({{R, 4}}),
                                path_over({{R, 7}})};
  cache.remember(0, paths);
  cache.remember(2, paths);
  CHECK(cache.forget([](SequenceElement element) { return element == SequenceElement(FacetId(5)); }) ==
        0);  // only crossed: no part of a sequence
  CHECK(cache.forget([](SequenceElement element) { return element == SequenceElement(FacetId(4)); }) == 4);
  CHECK(listed(cache.sequences(0)) == std::vector<Sequence>{{}, {facet(7)}});
  CHECK(cache.sequences(1) == nullptr);
  CHECK(cache.clear() == 4);
  CHECK(cache.sequences(0) == nullptr);
  CHECK(cache.clear() == 0);
}

namespace {

TriangleMesh office() {
  TriangleMesh mesh;
  add_box_faces(mesh, Vec3(0.0), Vec3(9, 6, 3), "opaque");
  add_sheet(mesh, Vec3(4, 3, 1.5), Vec3(0, 2.2, 0), Vec3(0, 0, 1.2), "glass");
  add_sheet(mesh, Vec3(6, 4, 1.5), Vec3(1.2, 0.4, 0), Vec3(0, 0, 1.1), "wall");
  return mesh;
}

std::set<std::string> ids(const Scene& scene, const LinkPaths& link) {
  std::set<std::string> all;
  for (const Path& path : link.paths) all.insert(path_id(scene, path));
  return all;
}

}  // namespace

TEST_CASE("what is remembered is solved again and adds to what rays find; every path has the exhaustive path's bits") {
  TracedScene<> traced(scene_of(office()));
  PathSearchSettings settings{false, 2, 2, 400, 20, 1};
  PathSearchSettings exhaustive = settings;
  exhaustive.exhaustive = true;
  PathCache cache;
  std::size_t before = 0;
  double grown = 0.0;
  for (std::size_t frame = 0; frame < 60; ++frame) {
    CAPTURE(frame);
    const double along = 0.05 * double(frame);
    const LinkEnd receiver = traced.end(Vec3(7.3 - along, 4.9, 1.2));
    const Ends ends{traced.end(Vec3(1.7, 2.3 + along, 2.1))};
    SearchCounters seeded, alone, all;
    const auto links = find_paths(traced.tracer, settings, receiver, {"ue", frame}, ends, seeded, &cache);
    PathSearchSettings few = settings;
    few.rays = settings.rays_steady;
    const auto rays_only = find_paths(traced.tracer, frame == 0 ? settings : few, receiver, {"ue", frame}, ends, alone);
    const auto exact = find_paths(traced.tracer, exhaustive, receiver, {"ue", frame}, ends, all);
    CHECK(seeded.rays == alone.rays);
    CHECK(std::is_sorted(links[0].paths.begin(), links[0].paths.end(), reported_before));
    const auto found = ids(traced.scene, links[0]), by_rays = ids(traced.scene, rays_only[0]);
    CHECK(found.size() == links[0].paths.size());
    CHECK(std::includes(found.begin(), found.end(), by_rays.begin(), by_rays.end()));
    for (const Path& path : links[0].paths) {
      const auto twin = std::find_if(exact[0].paths.begin(), exact[0].paths.end(),
                                     [&](const Path& other) { return same_sequence(path, other); });
      REQUIRE(twin != exact[0].paths.end());
      CHECK(twin->length_m == path.length_m);
      for (std::size_t index = 0; index < path.interactions.size(); ++index) {
        CHECK(twin->interactions[index].point_m == path.interactions[index].point_m);
      }
    }
    // The books: everything remembered is solved, and what is there now was there before or is born.
    CHECK(seeded.cache.revalidated == before);
    CHECK(seeded.cache.reused + seeded.cache.expired == seeded.cache.revalidated);
    CHECK(links[0].paths.size() == before - seeded.cache.died + seeded.cache.born);
    CHECK(cache.sequences(0)->size() == links[0].paths.size());
    before = links[0].paths.size();
    grown += double(found.size()) - double(by_rays.size());
  }
  CHECK(grown > 60.0);  // memory is worth more than a path per frame here
}

TEST_CASE(
    "a remembered sequence that gives way to a coplanar duplicate, and one that is proposed again, are one path") {
  TriangleMesh mesh;
  add_sheet(mesh, Vec3(0, 0, 0), Vec3(5, 0, 0), Vec3(0, 5, 0), "opaque");
  add_sheet(mesh, Vec3(3, 0, 0), Vec3(2, 0, 0), Vec3(0, 5, 0), "alpha");  // stands for the opaque one where x > 1
  TracedScene<> traced(scene_of(mesh));
  const PathSearchSettings settings{false, 1, 0, 500, 500, 1};
  PathCache cache;
  std::size_t before = 0;
  for (std::size_t frame = 0; frame < 40; ++frame) {
    CAPTURE(frame);
    const double x_m = -2.0 + 0.1 * double(frame);  // the point of reflection jumps over the edge at 1
    SearchCounters counters;
    const auto links =
        find_paths(traced.tracer, settings, traced.end(Vec3(frame < 20 ? x_m + 1 : 3 - x_m, 0, 1)), {"ue", frame},
                   Ends{traced.end(Vec3(frame < 20 ? x_m + 1 : 3 - x_m, 1, 1))}, counters, &cache);
    CHECK(links[0].paths.size() == 2);
    CHECK(counters.cache.revalidated == before);
    CHECK(counters.cache.reused + counters.cache.expired == before);
    CHECK(links[0].paths.size() == before - counters.cache.died + counters.cache.born);
    before = links[0].paths.size();
  }
}

TEST_CASE("few rays only where every present transmitter has a history; an absent one asks for nothing") {
  TracedScene<> traced(scene_of(office()));
  const PathSearchSettings settings{false, 1, 0, 500, 50, 1};
  const LinkEnd receiver = traced.end(Vec3(7.3, 4.9, 1.2));
  const std::optional<LinkEnd> one = traced.end(Vec3(1.7, 2.3, 2.1)), two = traced.end(Vec3(8, 1, 1));
  PathCache cache;
  const auto rays = [&](const Ends& ends) {
    SearchCounters counters;
    find_paths(traced.tracer, settings, receiver, {"ue", 0}, ends, counters, &cache);
    return counters.rays;
  };
  CHECK(rays({one, std::nullopt}) >= 500);
  CHECK(rays({one, std::nullopt}) < 500);
  CHECK(rays({one, two}) >= 500);  // the second has come
  CHECK(rays({one, two}) < 500);
  CHECK(rays({std::nullopt, two}) < 500);
  CHECK(rays({one, two}) >= 500);  // the first was away
  CHECK(rays({one, two}) < 500);
  cache.clear();
  CHECK(rays({one, two}) >= 500);
}

TEST_CASE("a transmitter that goes takes its paths with it, and the books say so") {
  TracedScene<> traced(scene_of(office()));
  const PathSearchSettings settings{false, 2, 1, 500, 50, 1};
  const LinkEnd receiver = traced.end(Vec3(7.3, 4.9, 1.2));
  const std::optional<LinkEnd> one = traced.end(Vec3(1.7, 2.3, 2.1)), two = traced.end(Vec3(8, 1, 1));
  PathCache cache;
  SearchCounters first, second, third;
  const auto both = find_paths(traced.tracer, settings, receiver, {"ue", 0}, Ends{one, two}, first, &cache);
  CHECK(first.cache.revalidated == 0);
  CHECK(first.cache.born == both[0].paths.size() + both[1].paths.size());
  CHECK(first.cache.died == 0);
  const auto left = find_paths(traced.tracer, settings, receiver, {"ue", 0}, Ends{std::nullopt, two}, second, &cache);
  CHECK(left[0].paths.empty());
  CHECK(second.cache.revalidated == both[1].paths.size());
  CHECK(second.cache.died == both[0].paths.size());
  CHECK(left[1].paths.size() == both[1].paths.size() + second.cache.born);
  const auto back = find_paths(traced.tracer, settings, receiver, {"ue", 0}, Ends{one, two}, third, &cache);
  CHECK(back[0].paths.size() + back[1].paths.size() == left[1].paths.size() + third.cache.born - third.cache.died);
}

TEST_CASE("counters add up") {
  CacheCounters sum{1, 2, 3, 4, 5};
  sum += CacheCounters{10, 20, 30, 40, 50};
  CHECK(sum == CacheCounters{11, 22, 33, 44, 55});
  CHECK(CacheCounters{} == CacheCounters{0, 0, 0, 0, 0});
}

}  // namespace test_path_cache
