/// What a network simulator asks: it moves its nodes itself, and wants to know, at any instant, what arrives between
/// those that may hear each other. The engine holds the world; nodes come with each question.
#include <cstdio>
#include <string>
#include <vector>

#include "dcem/dcem.hpp"
#include "dcem/io/scenario.hpp"

namespace {

/// Where the network simulator has its nodes: each drives straight on.
std::vector<dcem::Device> nodes_at(double time_s) {
  const std::vector<std::pair<dcem::Vec3, dcem::Vec3>> starts_and_velocities{{{10.0, 0.0, 1.6}, {12.0, 0.0, 0.0}},
                                                                             {{120.0, 4.0, 1.6}, {-12.0, 0.0, 0.0}},
                                                                             {{50.0, 60.0, 1.6}, {0.0, -8.0, 0.0}}};
  std::vector<dcem::Device> nodes;
  for (const auto& [start_m, velocity_mps] : starts_and_velocities) {
    dcem::Device node = dcem::device_at("node" + std::to_string(nodes.size()), start_m, 23.0);
    node.motion = dcem::LinearMotion{{start_m + time_s * velocity_mps}, velocity_mps, time_s};
    nodes.push_back(node);
  }
  return nodes;
}

/// Whom the network simulator lets hear whom: pairs that are close, once each.
std::vector<dcem::LinkRequest> close_pairs(const std::vector<dcem::Device>& nodes, double time_s, double range_m) {
  std::vector<dcem::LinkRequest> pairs;
  const auto place_m = [&](std::size_t node) { return dcem::placement_at(nodes[node].motion, time_s).pose.position_m; };
  for (std::size_t from = 0; from < nodes.size(); ++from) {
    for (std::size_t to = from + 1; to < nodes.size(); ++to) {
      if (glm::length(place_m(from) - place_m(to)) <= range_m) pairs.push_back({from, to});
    }
  }
  return pairs;
}

}  // namespace

int main() {
  const dcem::io::Scenario town = dcem::io::load_scenario(DCEM_DATA_DIR "/town_drive.json");  // its cars drive, too
  dcem::Simulator simulator(town.scene, town.settings);
  std::printf("time_s  from   to     paths  power_dbm  delay_ns\n");
  for (double time_s = 0.0; time_s < 4.0; time_s += 1.0) {
    simulator.move_to(simulator.scene().frame_at(time_s));
    const std::vector<dcem::Device> nodes = nodes_at(time_s);
    for (const dcem::LinkResult& link : simulator.solve(nodes, nodes, close_pairs(nodes, time_s, 80.0))) {
      std::printf("%5.1f   %s  %s  %5zu", time_s, nodes[link.transmitter].id.c_str(), nodes[link.receiver].id.c_str(),
                  link.paths.size());
      if (link.paths.empty()) {
        std::printf("  nothing arrives\n");
      } else {
        std::printf("  %9.2f  %8.1f\n", *link.statistics.power_dbm, 1e9 * *link.statistics.first_delay_s);
      }
    }
  }
}
