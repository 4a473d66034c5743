#pragma once
/// Embree 3 following motion, in each of the ways that it offers. Included where Embree was found (DCEM_HAS_EMBREE).
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "bench/embree_scene.hpp"
#include "dcem/geometry/pose.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem::bench {

enum class EmbreeUpkeep {
  rebuild,     ///< everything is one geometry, its tree is built anew
  refit,       ///< everything is one geometry, its boxes are made tight again
  two_levels,  ///< each body is a geometry; those that moved are refit, and the tree over the geometries is built anew
  instances    ///< one car, placed by a matrix for every body; the city is an instance too
};

/// Everything robust and triangles. `prepare` does what any user of a tree does, `update` is what is timed.
class MovingEmbree {
 public:
  /// Builds. The bodies from 1 on must all be the same mesh for EmbreeUpkeep::instances.
  MovingEmbree(const Scene& scene, EmbreeUpkeep upkeep, unsigned threads)
      : scene_(&scene), upkeep_(upkeep), embree_({.quality = scene_quality(upkeep), .threads = threads}) {
    if (upkeep != EmbreeUpkeep::rebuild) {
      rtcSetSceneFlags(embree_.handle(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
    }
    if (upkeep == EmbreeUpkeep::instances) {
      add_instances();
    } else if (upkeep == EmbreeUpkeep::two_levels) {
      for (std::size_t body = 0; body < scene.bodies().size(); ++body) add_body(BodyId(body));
    } else {
      add({scene.vertices_m(), scene.triangles()}, upkeep == EmbreeUpkeep::refit);
    }
    embree_.commit();
  }
  ~MovingEmbree() {
    for (const RTCScene scene : instanced_) rtcReleaseScene(scene);
  }
  MovingEmbree(const MovingEmbree&) = delete;
  MovingEmbree& operator=(const MovingEmbree&) = delete;

  /// Writes the vertices or the matrices of what has moved.
  void prepare(std::span<const BodyId> moved) {
    touched_.clear();
    for (const BodyId body : moved) {
      if (upkeep_ == EmbreeUpkeep::instances) {
        matrices_[body.value] = matrix(scene_->body_state(body).placement.pose);
      } else {
        const auto& [to, skip] = vertices_[upkeep_ == EmbreeUpkeep::two_levels ? body.value : 0];
        const std::size_t first = scene_->world().first(body).vertex;
        EmbreeScene::write_vertices(to + 3 * (first - skip), vertices_of(body));
      }
      if (upkeep_ == EmbreeUpkeep::two_levels || upkeep_ == EmbreeUpkeep::instances) touched_.push_back(body.value);
    }
    if (touched_.empty() && !moved.empty()) touched_.push_back(0);
  }

  void update() {
    for (const std::uint32_t index : touched_) {
      const RTCGeometry geometry = geometries_[index];
      if (upkeep_ == EmbreeUpkeep::instances) {
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrices_[index].data());
      } else {
        rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
      }
      rtcCommitGeometry(geometry);
    }
    embree_.commit();
  }

  const EmbreeScene& tree() const { return embree_; }

 private:
  using Matrix = std::array<float, 12>;

  /// Only a scene of low quality has two levels and heeds the quality of its geometries.
  static RTCBuildQuality scene_quality(EmbreeUpkeep upkeep) {
    const bool low = upkeep == EmbreeUpkeep::refit || upkeep == EmbreeUpkeep::two_levels;
    return low ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
  }
  std::span<const Vec3> vertices_of(BodyId body) const {
    return scene_->vertices_m().subspan(scene_->world().first(body).vertex, scene_->body(body).mesh.vertices_m.size());
  }

  void add(const TriangleView& mesh, bool refit, std::size_t first_vertex = 0) {
    const RTCGeometry geometry = embree_.add(mesh);
    rtcSetGeometryBuildQuality(geometry, refit ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_MEDIUM);
    vertices_.push_back(
        {static_cast<float*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0)), first_vertex});
    embree_.attach(geometry);
    geometries_.push_back(geometry);
  }
  void add_body(BodyId body) {
    add({vertices_of(body), scene_->body(body).mesh.triangles}, body.value != 0, scene_->world().first(body).vertex);
  }

  void add_instances() {
    const RTCDevice device = rtcGetSceneDevice(embree_.handle());
    for (std::size_t body = 0; body < scene_->bodies().size(); ++body) {
      if (body < 2) add_instanced(device, BodyId(body));
      const RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(instance, instanced_.back());
      matrices_.push_back(matrix(scene_->body_state(BodyId(body)).placement.pose));
      rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrices_.back().data());
      embree_.attach(instance);
      geometries_.push_back(instance);
    }
    rtcReleaseDevice(device);
  }
  void add_instanced(RTCDevice device, BodyId body) {
    const SurfaceMesh& mesh = scene_->body(body).mesh;
    const RTCGeometry geometry = embree_.add({mesh.vertices_m, mesh.triangles});
    instanced_.push_back(rtcNewScene(device));
    rtcSetSceneFlags(instanced_.back(), RTC_SCENE_FLAG_ROBUST);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(instanced_.back(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(instanced_.back());
  }
  static Matrix matrix(const Pose& pose) {
    const Mat3 rotation = rotation_matrix(pose);
    Matrix result;
    for (int axis = 0; axis < 3; ++axis) {
      for (int column = 0; column < 3; ++column) {
        result[static_cast<std::size_t>(3 * column + axis)] = static_cast<float>(rotation[column][axis]);
      }
      result[static_cast<std::size_t>(9 + axis)] = static_cast<float>(pose.position_m[axis]);
    }
    return result;
  }

  struct Vertices {
    float* to;
    std::size_t first;  ///< number of the first one in the scene
  };

  const Scene* scene_;
  EmbreeUpkeep upkeep_;
  EmbreeScene embree_;
  std::vector<RTCGeometry> geometries_;  ///< one, or one per body
  std::vector<Vertices> vertices_;       ///< of each geometry
  std::vector<Matrix> matrices_;
  std::vector<RTCScene> instanced_;
  std::vector<std::uint32_t> touched_;
};

}  // namespace dcem::bench
