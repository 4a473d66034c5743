#include "dcem/io/frame_source.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "dcem/core/error.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/src/traffic/slot_keeper.hpp"
#include "dcem/io/src/traffic/trace_motion.hpp"

namespace dcem::io {

namespace {

/// The first of the frames [first, last) that is not before an instant; `last` where all are.
std::size_t first_frame_from(const TimeSettings& time, std::size_t first, std::size_t last, double time_s) {
  while (first < last) {
    const std::size_t middle = first + (last - first) / 2;
    if (time.time_s(middle) < time_s) {
      first = middle + 1;
    } else {
      last = middle;
    }
  }
  return first;
}

}  // namespace

/// Plays the trace frame by frame.
class FrameSource::Player {
 public:
  explicit Player(const Traffic& traffic) : file_(traffic.trace.string()), motion_(traffic), keeper_(traffic.types) {}

  std::size_t next_index() const { return next_index_; }

  /// Goes on by one frame.
  void advance(double time_s) {
    vehicles_ = &motion_.at(time_s);
    auto bodies = keeper_.next_frame(*vehicles_);
    if (!bodies)
      throw InputError(file_, "differs from when the scenario was loaded; expected a file that stays as it is");
    bodies_ = std::move(*bodies);
    ++next_index_;
  }

  void put_into(Frame& frame) const {
    for (std::size_t index = 0; index < bodies_.size(); ++index) {
      const DrivingVehicle& vehicle = (*vehicles_)[index];
      DCEM_ASSERT(bodies_[index] < frame.bodies.size());
      frame.bodies[bodies_[index]] = {true, vehicle.placement, vehicle.id};
    }
  }

 private:
  std::string file_;
  TraceMotion motion_;
  SlotKeeper keeper_;
  std::size_t next_index_ = 0;
  const std::vector<DrivingVehicle>* vehicles_ = nullptr;  ///< in `motion_`
  std::vector<std::size_t> bodies_;                        ///< one per vehicle
};

FrameSource::FrameSource(const Scenario& scenario)
    : time_(scenario.time), player_(scenario.traffic ? std::make_unique<Player>(*scenario.traffic) : nullptr) {}

FrameSource::~FrameSource() = default;
FrameSource::FrameSource(FrameSource&&) noexcept = default;
FrameSource& FrameSource::operator=(FrameSource&&) noexcept = default;

Frame FrameSource::frame(const Scene& scene, std::size_t index) {
  if (index >= time_.frames) throw std::invalid_argument("frame source: the index is beyond the last frame");
  Frame frame = scene.frame_at(time_.time_s(index), index);
  if (!player_) return frame;
  if (index + 1 < player_->next_index()) throw std::invalid_argument("frame source: the index decreases");
  while (player_->next_index() <= index) player_->advance(time_.time_s(player_->next_index()));
  player_->put_into(frame);
  return frame;
}

void require_attached_devices(const Scenario& scenario, std::size_t first_frame, std::size_t last_frame) {
  if (!scenario.traffic) return;
  const auto meets = [&](const Traffic::Interval& interval) {
    const std::size_t frame =
        first_frame_from(scenario.time, first_frame, last_frame, interval.first_s - trace_tolerance_s);
    return frame < last_frame && scenario.time_s(frame) <= interval.last_s + trace_tolerance_s;
  };
  for (const Traffic::Rider& rider : scenario.traffic->riders) {
    const auto& intervals = scenario.traffic->presence.at(rider.vehicle);
    if (std::any_of(intervals.begin(), intervals.end(), meets)) continue;
    throw InputError(rider.place, rider.key + ": vehicle " + in_quotes(rider.vehicle) +
                                      " is in none of the frames asked for; expected frames between " +
                                      number_text(intervals.front().first_s) + " s and " +
                                      number_text(intervals.back().last_s) + " s");
  }
}

}  // namespace dcem::io
