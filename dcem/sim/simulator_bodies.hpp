#pragma once
/// Bodies of simulator.hpp.
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/material_table_of.hpp"
#include "dcem/sim/simulator.hpp"

namespace dcem {

struct Simulator::Body {
  Body(Scene scene, const SimulationSettings& settings, MaterialTable surface)
      : simulator(std::move(scene), settings, std::move(surface)) {}

  BasicSimulator<MaterialTable, WideIndex> simulator;
};

DCEM_INLINE Simulator::Simulator(Scene scene, const SimulationSettings& settings) {
  MaterialTable surface = detail::material_table_of(scene, settings);
  body_ = std::make_unique<Body>(std::move(scene), settings, std::move(surface));
}
DCEM_INLINE Simulator::~Simulator() = default;
DCEM_INLINE Simulator::Simulator(Simulator&&) noexcept = default;
DCEM_INLINE Simulator& Simulator::operator=(Simulator&&) noexcept = default;

DCEM_INLINE const Scene& Simulator::scene() const {
  return body_->simulator.scene();
}
DCEM_INLINE const SimulationSettings& Simulator::settings() const {
  return body_->simulator.settings();
}
DCEM_INLINE SearchPlan Simulator::plan() const {
  return body_->simulator.plan();
}
DCEM_INLINE Discovery Simulator::discovery() const {
  return body_->simulator.discovery();
}
DCEM_INLINE CacheMode Simulator::cache() const {
  return body_->simulator.cache();
}
DCEM_INLINE const WideIndex& Simulator::index() const {
  return body_->simulator.index();
}
DCEM_INLINE ThreadPool& Simulator::pool() const {
  return body_->simulator.pool();
}

DCEM_INLINE FrameResult Simulator::advance(const Frame& frame) {
  return body_->simulator.advance(frame);
}
DCEM_INLINE FrameResult Simulator::advance_to(double time_s, std::size_t index) {
  return body_->simulator.advance_to(time_s, index);
}
DCEM_INLINE void Simulator::give_back(FrameResult&& spent) {
  body_->simulator.give_back(std::move(spent));
}
DCEM_INLINE TreeUpdateReport Simulator::pass(const Frame& frame, const WorkCounters& spent) {
  return body_->simulator.pass(frame, spent);
}
DCEM_INLINE std::vector<LinkResult> Simulator::solve(std::span<const Device> receivers, WorkCounters* work) const {
  return body_->simulator.solve(receivers, work);
}

DCEM_INLINE std::vector<LinkResult> Simulator::solve(std::span<const Device> transmitters,
                                                     std::span<const Device> receivers,
                                                     std::span<const LinkRequest> requests, WorkCounters* work) const {
  return body_->simulator.solve(transmitters, receivers, requests, work);
}
DCEM_INLINE std::vector<double> Simulator::estimated_chains(const Device& receiver) const {
  return body_->simulator.estimated_chains(receiver);
}
DCEM_INLINE std::vector<ShellAtPoint> Simulator::shells_at(const Vec3& point_m) const {
  return body_->simulator.shells_at(point_m);
}
DCEM_INLINE bool Simulator::is_present(const Device& device) const {
  return body_->simulator.is_present(device);
}
DCEM_INLINE TreeUpdateReport Simulator::move_to(const Frame& frame) {
  return body_->simulator.move_to(frame);
}
DCEM_INLINE std::optional<PathContribution> Simulator::solve_path(std::size_t transmitter, std::size_t receiver,
                                                                  const Sequence& sequence) const {
  return body_->simulator.solve_path(transmitter, receiver, sequence);
}
DCEM_INLINE std::vector<RadioMap> Simulator::radio_maps(const ReceiverGrid& grid,
                                                        const std::function<void(std::size_t)>& progress,
                                                        WorkCounters* work) const {
  return body_->simulator.radio_maps(grid, progress, work);
}
DCEM_INLINE std::vector<RadioMap> Simulator::radio_maps(const ReceiverList& list,
                                                        const std::function<void(std::size_t)>& progress,
                                                        WorkCounters* work) const {
  return body_->simulator.radio_maps(list, progress, work);
}

}  // namespace dcem
