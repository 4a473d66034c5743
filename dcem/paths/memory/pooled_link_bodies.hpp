#pragma once
/// Bodies of pooled_link.hpp.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/memory/key_table.hpp"
#include "dcem/paths/memory/pooled_link.hpp"

namespace dcem {

DCEM_INLINE void PooledLink::forget() {
  of_place_ = next_ = {};
  made_.reset();
  made_triples_.reset();
  has_news_ = false;
  slots_ = {};
  triple_slots_ = {};
}

DCEM_INLINE void PooledLink::begin(const PoolSource& source, std::shared_ptr<const Place> place, bool old) {
  const bool is_begun = next_.pool && &next_.pool->place() == place.get();
  if (is_begun && work_left() == 0) return;
  const PlacePools* const known = source.known.find(*place, source.transmitter);
  if (known != nullptr && (!known->pool->is_outdated() || (old && !is_begun))) {
    next_ = *known;
    made_.reset();
    made_triples_.reset();
    return;
  }
  if (is_begun) return;
  made_triples_ =
      place->beams() == nullptr ? nullptr : std::make_shared<TriplePool>(place, source.reached, source.orders);
  made_ = std::make_shared<CandidatePool>(std::move(place), source.reached, source.orders);
  next_ = {made_, made_triples_};
  allowance_ = {};
}

DCEM_INLINE void PooledLink::go_on(const PoolSource& source) {
  if (made_->steps_left() > 0) {
    made_->go_on(source.scene, source.outlines);
  } else {
    made_triples_->go_on(source.scene, source.outlines, source.lanes);
  }
}

DCEM_INLINE void PooledLink::prepare(const PoolSource& source, std::shared_ptr<const Place> place,
                                     const WorkAhead& work) {
  begin(source, std::move(place), false);
  allowance_.spend(work.spent);
  allowance_.next_frame(work_left(), work.frames);
  while (work_left() > 0 && allowance_.covers(next_work(), work.early)) {
    allowance_.spend(next_work());
    go_on(source);
  }
}

DCEM_INLINE void PooledLink::enter(const PoolSource& source, std::shared_ptr<const Place> place) {
  begin(source, std::move(place), true);
  while (work_left() > 0) go_on(source);
  has_news_ = made_ != nullptr;
  made_.reset();
  made_triples_.reset();
  KeyTable known(slots_.size());
  for (std::uint32_t number = 0; number < slots_.size(); ++number) {
    if (slots_[number].is_known || slots_[number].is_open) known.add(of_place_.pool->key(number), number);
  }
  std::vector<Slot> slots(next_.pool->size());
  for (std::size_t number = 0; number < slots.size(); ++number) {
    if (const auto before = known.find(next_.pool->key(number))) slots[number] = slots_[*before];
    // What is hidden from one place may be seen from the other.
    if (slots[number].is_masked) slots[number].until_m = 0.0;
  }
  slots_ = std::move(slots);
  const PlacePools before = std::exchange(of_place_, std::exchange(next_, {}));
  enter_triples(before.triples.get());
}

DCEM_INLINE void PooledLink::renew(const PoolSource& source, const std::shared_ptr<const Place>& place) {
  const bool finds_triples = place->beams() != nullptr;  // for which it does not pay
  if (finds_triples || !of_place_.pool->is_outdated()) return;
  begin(source, place, false);
  if (work_left() > 0) go_on(source);
  if (work_left() == 0) enter(source, place);
}

DCEM_INLINE void PooledLink::go_on_to(const Vec3& receiver_m) {
  if (receiver_way_.go_on(receiver_m)) return;
  for (std::vector<Slot>* const slots : {&slots_, &triple_slots_}) {
    for (Slot& slot : *slots) slot.forget_course();
  }
}

DCEM_INLINE void PooledLink::enter_triples(const TriplePool* before) {
  const std::vector<Slot> known = std::exchange(triple_slots_, {});
  if (!of_place_.triples) return;
  const std::span<const Triple> all = of_place_.triples->candidates();
  triple_slots_.resize(all.size());
  const std::span<const Triple> old = before != nullptr ? before->candidates() : std::span<const Triple>{};
  for (std::size_t now = 0, then = 0; now < all.size(); ++now) {
    while (then < old.size() && old[then] < all[now]) ++then;
    if (then == old.size()) break;
    if (old[then] != all[now]) continue;
    triple_slots_[now] = known[then];
    if (known[then].is_masked) triple_slots_[now].until_m = 0.0;
  }
}

DCEM_INLINE bool PooledLink::hides(const Scene& scene, const FacetOutlines& outlines, const Sight& sight,
                                   std::size_t at, const WayReach& reach) const {
  const SequenceElement element = way_.elements[at];
  const double nearer = element.is_edge() ? sight.nearer_on(scene, outlines, element.edge())
                                          : sight.nearer_on(scene, outlines, element.mirror());
  return sight.map().hides(way_.points_m[at], nearer, spread_over(scene, element, reach[at]));
}

}  // namespace dcem
