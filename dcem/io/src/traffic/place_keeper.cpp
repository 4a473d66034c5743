#include "dcem/io/src/traffic/place_keeper.hpp"

namespace dcem::io {

PlaceKeeper::PlaceKeeper(const std::vector<Traffic::Type>& types) {
  for (const Traffic::Type& type : types) {
    first_bodies_.push_back(type.first_body);
    places_.emplace_back(type.places);
  }
}

std::optional<std::vector<std::size_t>> PlaceKeeper::next_frame(const std::vector<DrivingVehicle>& vehicles) {
  ++frame_;
  std::vector<std::size_t> entering, bodies(vehicles.size());
  for (std::size_t index = 0; index < vehicles.size(); ++index) {
    const auto found = spots_.find(vehicles[index].id);
    if (found == spots_.end() || found->second.type != vehicles[index].type) {
      entering.push_back(index);
      continue;
    }
    const Spot& spot = found->second;
    places_[spot.type][spot.place].frame_seen = frame_;
    bodies[index] = first_bodies_[spot.type] + spot.place;
  }
  clear_left_places();
  for (const std::size_t index : entering) {
    const std::size_t type = vehicles[index].type;
    const std::optional<std::size_t> free = free_place(type);
    if (!free) return std::nullopt;
    Place& place = places_[type][*free];
    place.occupant = vehicles[index].id;
    place.frame_seen = frame_;
    spots_[place.occupant] = {type, *free};
    bodies[index] = first_bodies_[type] + *free;
  }
  return bodies;
}

void PlaceKeeper::clear_left_places() {
  for (std::vector<Place>& places : places_) {
    for (Place& place : places) {
      if (place.occupant.empty() || place.frame_seen == frame_) continue;
      spots_.erase(place.occupant);
      place.occupant.clear();
      place.frame_freed = frame_;
    }
  }
}

/// The lowest that has rested; else the lowest that was left just now.
std::optional<std::size_t> PlaceKeeper::free_place(std::size_t type) const {
  std::optional<std::size_t> just_left;
  const std::vector<Place>& places = places_[type];
  for (std::size_t index = 0; index < places.size(); ++index) {
    if (!places[index].occupant.empty()) continue;
    if (places[index].frame_freed != frame_) return index;
    if (!just_left) just_left = index;
  }
  return just_left;
}

}  // namespace dcem::io
