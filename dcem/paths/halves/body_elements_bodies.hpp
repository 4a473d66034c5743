#pragma once
/// Bodies of body_elements.hpp.
#include <algorithm>

#include "dcem/core/build_mode.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/paths/halves/body_elements.hpp"

namespace dcem {

DCEM_INLINE void BodyElements::lay_out(const Scene& scene, const SeenLayer& layer, const Vec3& end_m,
                                       const Vec3& origin_m) {
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
    for (std::size_t lane = 0; edge < layer.edges.size() && scene.wedge(layer.edges[edge]).body == part.body; ++edge) {
      if (lane == 0) packs_.emplace_back();
      packs_.back().edges[lane] = layer.edges[edge];
      packs_.back().used |= 1U << lane;
      const Wedge& wedge = scene.wedge(layer.edges[edge]).edge;
      set_part(packs_.back().parts, lane, whole_edge(0, wedge, end_m), wedge.start_m - origin_m, edge_direction(wedge));
      lane = (lane + 1) % simd_lanes;
    }
    part.pack_count = static_cast<std::uint32_t>(packs_.size()) - part.first_pack;
  }
}

DCEM_INLINE void BodyReach::find(const FacetOutlines& outlines, std::size_t count,
                                 const std::function<MirrorCone(std::size_t)>& cone_at, ThreadPool* pool) {
  constexpr std::size_t block = 128;
  found_.resize((count + block - 1) / block);
  const auto look = [&](std::size_t number, unsigned) {
    found_[number].clear();
    for (std::size_t at = number * block; at < std::min(count, (number + 1) * block); ++at) {
      const auto [cone, mirror] = cone_at(at);
      outlines.for_each_body_in(cone, [&, place = mirror](BodyId body) {
        found_[number].push_back({body.value, place});
      });
    }
  };
  for (std::size_t number = 0; pool == nullptr && number < found_.size(); ++number) look(number, 0);
  if (pool != nullptr) pool->for_each(found_.size(), look);
  list(outlines.bodies().size());
}

/// Counted body by body first, so that each list has its place.
DCEM_INLINE void BodyReach::list(std::size_t bodies) {
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

}  // namespace dcem
