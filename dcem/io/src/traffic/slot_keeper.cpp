#include "dcem/io/src/traffic/slot_keeper.hpp"

namespace dcem::io {

SlotKeeper::SlotKeeper(const std::vector<Traffic::Type>& types) {
  for (const Traffic::Type& type : types) {
    first_bodies_.push_back(type.first_body);
    slots_.emplace_back(type.slots);
  }
}

std::optional<std::vector<std::size_t>> SlotKeeper::next_frame(const std::vector<DrivingVehicle>& vehicles) {
  ++frame_;
  std::vector<std::size_t> entering, bodies(vehicles.size());
  for (std::size_t index = 0; index < vehicles.size(); ++index) {
    const auto found = spots_.find(vehicles[index].id);
    if (found == spots_.end() || found->second.type != vehicles[index].type) {
      entering.push_back(index);
      continue;
    }
    const Spot& spot = found->second;
    slots_[spot.type][spot.slot].frame_seen = frame_;
    bodies[index] = first_bodies_[spot.type] + spot.slot;
  }
  clear_left_slots();
  for (const std::size_t index : entering) {
    const std::size_t type = vehicles[index].type;
    const std::optional<std::size_t> free = free_slot_index(type);
    if (!free) return std::nullopt;
    Slot& slot = slots_[type][*free];
    slot.occupant = vehicles[index].id;
    slot.frame_seen = frame_;
    spots_[slot.occupant] = {type, *free};
    bodies[index] = first_bodies_[type] + *free;
  }
  return bodies;
}

void SlotKeeper::clear_left_slots() {
  for (std::vector<Slot>& slots : slots_) {
    for (Slot& slot : slots) {
      if (slot.occupant.empty() || slot.frame_seen == frame_) continue;
      spots_.erase(slot.occupant);
      slot.occupant.clear();
      slot.frame_freed = frame_;
    }
  }
}

/// The lowest that has rested; else the lowest that was left just now.
std::optional<std::size_t> SlotKeeper::free_slot_index(std::size_t type) const {
  std::optional<std::size_t> just_left;
  const std::vector<Slot>& slots = slots_[type];
  for (std::size_t index = 0; index < slots.size(); ++index) {
    if (!slots[index].occupant.empty()) continue;
    if (slots[index].frame_freed != frame_) return index;
    if (!just_left) just_left = index;
  }
  return just_left;
}

}  // namespace dcem::io
