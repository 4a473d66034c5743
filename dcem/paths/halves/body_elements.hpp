#pragma once
/// What an end may see of bodies, body by body: few mirrors and edges each.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/thread_pool.hpp"
#include "dcem/paths/halves/edge_parts.hpp"
#include "dcem/paths/halves/sight.hpp"

namespace dcem {

class BodyElements {
 public:
  /// One body: its mirrors are a run of the layer's.
  struct Part {
    BodyId body;
    std::uint32_t first_mirror = 0, mirror_count = 0, first_pack = 0, pack_count = 0;
  };

  /// Lays out what an end sees. The numbers count from `origin_m`.
  void lay_out(const Scene& scene, const SeenLayer& layer, const Vec3& end_m, const Vec3& origin_m) {
    parts_.clear();
    packs_.clear();
    std::size_t mirror = 0, edge = 0;
    while (mirror < layer.mirrors.size() || edge < layer.edges.size()) {
      const BodyId of_mirror = mirror < layer.mirrors.size() ? scene.facet(layer.mirrors[mirror]).body : none;
      const BodyId of_edge = edge < layer.edges.size() ? scene.wedge(layer.edges[edge]).body : none;
      Part& part = parts_.emplace_back();
      part.body = of_mirror < of_edge ? of_mirror : of_edge;
      part.first_mirror = static_cast<std::uint32_t>(mirror);
      part.first_pack = static_cast<std::uint32_t>(packs_.size());
      while (mirror < layer.mirrors.size() && scene.facet(layer.mirrors[mirror]).body == part.body) ++mirror;
      part.mirror_count = static_cast<std::uint32_t>(mirror) - part.first_mirror;
      for (std::size_t lane = 0; edge < layer.edges.size() && scene.wedge(layer.edges[edge]).body == part.body;
           ++edge) {
        if (lane == 0) packs_.emplace_back();
        packs_.back().edges[lane] = layer.edges[edge];
        packs_.back().used |= 1U << lane;
        const Wedge& wedge = scene.wedge(layer.edges[edge]).edge;
        packs_.back().lanes.set(lane, whole_edge(0, wedge, end_m), wedge, origin_m);
        lane = (lane + 1) % simd_lanes;
      }
      part.pack_count = static_cast<std::uint32_t>(packs_.size()) - part.first_pack;
    }
  }

  /// By body, ascending.
  std::span<const Part> parts() const { return parts_; }

  /// Calls `visit(edge)` for the edges of a body on which the point that diffracts between the end and an apex may lie
  /// in a cone.
  template <typename Visit>
  void for_each_edge_in(const Part& part, std::span<const HalfSpace> cone, const Vec3& apex, Visit&& visit) const {
    for (const Pack& pack : std::span(packs_).subspan(part.first_pack, part.pack_count)) {
      std::uint32_t left = pack.used & pack.lanes.meeting(cone, apex, 0.0F);
      for (; left != 0; left &= left - 1) visit(pack.edges[static_cast<std::size_t>(std::countr_zero(left))]);
    }
  }

 private:
  static constexpr BodyId none{0xffffffffU};

  struct Pack {
    PartLanes lanes;
    std::array<WedgeId, simd_lanes> edges;
    std::uint32_t used = 0;
  };

  std::vector<Part> parts_;
  std::vector<Pack> packs_;
};

/// Which mirrors of the scenery may light which bodies.
class BodyReach {
 public:
  /// Of `count` cones that count from the middle of the outlines, and of the mirrors that they belong to. Many are
  /// looked at by the threads of `pool`, where there is one.
  void find(const FacetOutlines& outlines, std::size_t count, auto&& cone_of, auto&& mirror_of, ThreadPool* pool) {
    constexpr std::size_t block = 128;
    found_.resize((count + block - 1) / block);
    const auto look = [&](std::size_t number, unsigned) {
      found_[number].clear();
      for (std::size_t cone = number * block; cone < std::min(count, (number + 1) * block); ++cone) {
        outlines.for_each_body_in(cone_of(cone), [&](BodyId body) {
          found_[number].push_back({body.value, mirror_of(cone)});
        });
      }
    };
    for (std::size_t number = 0; pool == nullptr && number < found_.size(); ++number) look(number, 0);
    if (pool != nullptr) pool->for_each(found_.size(), look);
    list(outlines.bodies().size());
  }

  /// The places of the mirrors that may light a body.
  std::span<const std::uint32_t> mirrors_lighting(BodyId body) const {
    return std::span(mirrors_).subspan(first_[body.value], first_[body.value + 1] - first_[body.value]);
  }

 private:
  /// Counted body by body first, so that each list has its place.
  void list(std::size_t bodies) {
    first_.assign(bodies + 2, 0);
    std::size_t count = 0;
    for (const auto& of_block : found_) {
      for (const auto& [body, mirror] : of_block) ++first_[body + 1];
      count += of_block.size();
    }
    for (std::size_t body = 1; body < first_.size(); ++body) first_[body] += first_[body - 1];
    mirrors_.resize(count);
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (const auto& of_block : found_) {
      for (const auto& [body, mirror] : of_block) mirrors_[next[body]++] = mirror;
    }
  }

  std::vector<std::vector<std::array<std::uint32_t, 2>>> found_;  ///< body and mirror, block by block
  std::vector<std::uint32_t> first_, mirrors_;
};

}  // namespace dcem
