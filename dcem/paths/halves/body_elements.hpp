#pragma once
/// What an end may see of bodies, body by body: few mirrors and edges each.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "dcem/paths/halves/edge_parts.hpp"
#include "dcem/paths/halves/sight.hpp"

namespace dcem {

class ThreadPool;

class BodyElements {
 public:
  /// One body: its mirrors are a run of the layer's.
  struct Part {
    BodyId body;
    std::uint32_t first_mirror = 0, mirror_count = 0, first_pack = 0, pack_count = 0;
  };

  /// Lays out what an end sees. The numbers count from `origin_m`.
  void lay_out(const Scene& scene, const SeenLayer& layer, const Vec3& end_m, const Vec3& origin_m);

  /// By body, ascending.
  std::span<const Part> parts() const { return parts_; }

  /// Calls `visit(edge)` for the edges of a body on which the point that diffracts between the end and an apex may lie
  /// in a cone.
  template <typename Visit>
  void for_each_edge_in(const Part& part, std::span<const HalfSpace> cone, const Vec3& apex, Visit&& visit) const {
    const ConeTarget target = edge_target(apex, 0.0F);
    for (const Pack& pack : std::span(packs_).subspan(part.first_pack, part.pack_count)) {
      std::uint32_t left = pack.used & parts_met<false>(pack.parts, cone, target);
      for (; left != 0; left &= left - 1) visit(pack.edges[static_cast<std::size_t>(std::countr_zero(left))]);
    }
  }

 private:
  static constexpr BodyId none{0xffffffffU};

  struct Pack {
    EightParts parts = no_parts();
    std::array<WedgeId, simd_lanes> edges;
    std::uint32_t used = 0;
  };

  std::vector<Part> parts_;
  std::vector<Pack> packs_;
};

/// What an image may see through its mirror, and the place of that mirror. The cone counts from the middle of the
/// outlines.
struct MirrorCone {
  std::span<const HalfSpace> cone;
  std::uint32_t mirror;
};

/// Which mirrors of the scenery may light which bodies.
class BodyReach {
 public:
  /// Of `count` cones. Many are looked at by the threads of `pool`, where there is one.
  void find(const FacetOutlines& outlines, std::size_t count, const std::function<MirrorCone(std::size_t)>& cone_at,
            ThreadPool* pool);

  /// The places of the mirrors that may light a body.
  std::span<const std::uint32_t> mirrors_lighting(BodyId body) const {
    return std::span(mirrors_).subspan(first_[body.value], first_[body.value + 1] - first_[body.value]);
  }

 private:
  void list(std::size_t bodies);

  std::vector<std::vector<std::array<std::uint32_t, 2>>> found_;  ///< body and mirror, block by block
  std::vector<std::uint32_t> first_, mirrors_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/body_elements_bodies.hpp"
#endif
