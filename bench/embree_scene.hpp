#pragma once
/// Embree 3 as a rival in the same process: the same triangles, the same rays. Included where Embree was found
/// (DCEM_HAS_EMBREE).
#include <embree3/rtcore.h>
#include <immintrin.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "dcem/accel/wide/build/quads.hpp"
#include "dcem/geometry/ray.hpp"

namespace dcem::bench {

/// What Embree is told about a scene.
struct EmbreeSettings {
  bool robust = true;
  bool quads = false;  ///< pairs as quadrilaterals, the other triangles as quadrilaterals with a corner twice
  RTCBuildQuality quality = RTC_BUILD_QUALITY_MEDIUM;
  unsigned threads = 1;
};

inline RTCRay embree_ray(const Ray<double>& ray) {
  RTCRay result{};
  result.org_x = static_cast<float>(ray.origin.x);
  result.org_y = static_cast<float>(ray.origin.y);
  result.org_z = static_cast<float>(ray.origin.z);
  result.dir_x = static_cast<float>(ray.direction.x);
  result.dir_y = static_cast<float>(ray.direction.y);
  result.dir_z = static_cast<float>(ray.direction.z);
  result.tnear = static_cast<float>(ray.t_min);
  result.tfar = static_cast<float>(ray.t_max);
  result.mask = std::numeric_limits<unsigned>::max();
  return result;
}

inline RTCRayHit embree_query(const Ray<double>& ray) {
  RTCRayHit query{};
  query.ray = embree_ray(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

/// Parameter of a hit, infinity where there is none.
inline double t_of(const RTCRayHit& query) {
  return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<double>::infinity()
                                                     : static_cast<double>(query.ray.tfar);
}
inline double t_of(const RTCRayHit16& packet, std::size_t lane) {
  return packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<double>::infinity()
                                                            : static_cast<double>(packet.ray.tfar[lane]);
}

/// Rays in sixteens; the last one is filled up with its last ray.
inline std::vector<RTCRayHit16> embree_packets(std::span<const Ray<double>> rays) {
  std::vector<RTCRayHit16> packets((rays.size() + 15) / 16);
  for (std::size_t index = 0; index < 16 * packets.size(); ++index) {
    const RTCRay ray = embree_ray(rays[std::min(index, rays.size() - 1)]);
    RTCRayHit16& packet = packets[index / 16];
    const std::size_t lane = index % 16;
    packet.ray.org_x[lane] = ray.org_x, packet.ray.org_y[lane] = ray.org_y, packet.ray.org_z[lane] = ray.org_z;
    packet.ray.dir_x[lane] = ray.dir_x, packet.ray.dir_y[lane] = ray.dir_y, packet.ray.dir_z[lane] = ray.dir_z;
    packet.ray.tnear[lane] = ray.tnear, packet.ray.tfar[lane] = ray.tfar;
    packet.ray.mask[lane] = ray.mask, packet.ray.flags[lane] = 0, packet.ray.time[lane] = 0.0F;
    packet.hit.geomID[lane] = packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  }
  return packets;
}

/// A device with a scene of one or more geometries. Flushes denormal numbers to zero, as Embree's manual asks.
class EmbreeScene {
 public:
  explicit EmbreeScene(const EmbreeSettings& settings) : settings_(settings) {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    device_ = rtcNewDevice(settings.threads == 1 ? "threads=1" : "");
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, settings.robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene_, settings.quality);
  }
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Adds triangles (or, with `quads`, the quads made of them) as one geometry.
  RTCGeometry add(const TriangleView& mesh, std::span<const Quad> quads = {}) {
    const bool as_quads = settings_.quads;
    const RTCGeometry geometry =
        rtcNewGeometry(device_, as_quads ? RTC_GEOMETRY_TYPE_QUAD : RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices_m.size()));
    write_vertices(vertices, mesh.vertices_m);
    const std::size_t corners = as_quads ? 4 : 3;
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, as_quads ? RTC_FORMAT_UINT4 : RTC_FORMAT_UINT3,
                                corners * sizeof(std::uint32_t), as_quads ? quads.size() : mesh.size()));
    if (as_quads) {
      for (const Quad& quad : quads) {
        for (std::size_t corner = 0; corner < 4; ++corner) {
          *indices++ = quad.corner[quad.is_pair() || corner < 3 ? corner : 2];
        }
      }
    } else {
      for (const auto& triangle : mesh.triangles) indices = std::copy(triangle.begin(), triangle.end(), indices);
    }
    return geometry;
  }
  void attach(RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);  // the scene keeps it
  }
  void commit() { rtcCommitScene(scene_); }
  RTCScene handle() const { return scene_; }

  static void write_vertices(float* to, std::span<const Vec3> vertices_m) {
    for (const Vec3& vertex : vertices_m) {
      for (int axis = 0; axis < 3; ++axis) *to++ = static_cast<float>(vertex[axis]);
    }
  }

  /// Queries that are prepared, answered in place.
  void intersect(RTCRayHit& query) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &query);
  }
  void occlude(RTCRay& query) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_, &context, &query);
  }
  /// Sixteen at a time, coherent ones.
  void intersect(RTCRayHit16& packet) const {
    RTCIntersectContext context = coherent();
    rtcIntersect16(all_lanes.data(), scene_, &context, &packet);
  }
  void occlude(RTCRay16& packet) const {
    RTCIntersectContext context = coherent();
    rtcOccluded16(all_lanes.data(), scene_, &context, &packet);
  }

  /// Parameter of the closest hit, infinity where there is none.
  double closest_hit(const Ray<double>& ray) const {
    RTCRayHit query = embree_query(ray);
    intersect(query);
    return t_of(query);
  }
  bool occluded(const Ray<double>& ray) const {
    RTCRay query = embree_ray(ray);
    occlude(query);
    return query.tfar < 0.0F;
  }

 private:
  /// Embree reads it as one register of 64 bytes.
  alignas(64) static constexpr std::array<int, 16> all_lanes{-1, -1, -1, -1, -1, -1, -1, -1,
                                                             -1, -1, -1, -1, -1, -1, -1, -1};

  static RTCIntersectContext coherent() {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return context;
  }

  EmbreeSettings settings_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

}  // namespace dcem::bench
