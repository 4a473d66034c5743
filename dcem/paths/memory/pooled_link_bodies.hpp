#pragma once
/// Bodies of pooled_link.hpp.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/spread_work.hpp"
#include "dcem/paths/memory/key_table.hpp"
#include "dcem/paths/memory/pooled_link.hpp"

namespace dcem {

DCEM_INLINE void PooledLink::forget() {
  pool_.reset();
  next_.reset();
  triples_.reset();
  next_triples_.reset();
  slots_ = {};
  triple_slots_ = {};
}

DCEM_INLINE void PooledLink::begin(const PoolSource& source, std::shared_ptr<const Place> place) {
  if (next_ && &next_->place() == place.get()) return;
  next_triples_ =
      place->beams() != nullptr ? std::make_unique<TriplePool>(place, source.reached, source.orders) : nullptr;
  next_ = std::make_unique<CandidatePool>(std::move(place), source.reached, source.orders);
}

DCEM_INLINE void PooledLink::go_on(const PoolSource& source) {
  if (next_->steps_left() > 0) {
    next_->go_on(source.scene, source.outlines);
  } else {
    next_triples_->go_on(source.scene, source.outlines, source.lanes);
  }
}

DCEM_INLINE void PooledLink::prepare(const PoolSource& source, std::shared_ptr<const Place> place, int frames,
                                     int spent) {
  begin(source, std::move(place));
  const int share = even_share(work_left(), spent, frames);
  while (work_left() > 0 && fits(next_work(), spent, share)) {
    spent += next_work();
    go_on(source);
  }
}

DCEM_INLINE void PooledLink::enter(const PoolSource& source, std::shared_ptr<const Place> place) {
  begin(source, std::move(place));
  while (work_left() > 0) go_on(source);
  std::unique_ptr<CandidatePool> next = std::move(next_);
  KeyTable known(slots_.size());
  for (std::uint32_t number = 0; number < slots_.size(); ++number) {
    if (slots_[number].is_known || slots_[number].is_open) known.add(pool_->key(number), number);
  }
  std::vector<Slot> slots(next->size());
  for (std::size_t number = 0; number < slots.size(); ++number) {
    if (const auto before = known.find(next->key(number))) slots[number] = slots_[*before];
    // What is hidden from one place may be seen from the other.
    if (slots[number].is_masked) slots[number].refused_until_m = 0.0;
  }
  slots_ = std::move(slots);
  pool_ = std::move(next);
  enter_triples();
}

DCEM_INLINE void PooledLink::renew(const PoolSource& source, const std::shared_ptr<const Place>& place) {
  if (!pool_->is_outdated() || place->beams() != nullptr) return;  // those of three elements would be found, too
  begin(source, place);
  go_on(source);
  if (work_left() == 0) enter(source, place);
}

DCEM_INLINE void PooledLink::note_step(const Vec3& receiver_m) {
  if (before_m_) step_m_ = glm::distance(*before_m_, receiver_m);
  way_m_ += 1.000001 * step_m_ + 1e-9;
  before_m_ = receiver_m;
}

DCEM_INLINE void PooledLink::enter_triples() {
  const std::unique_ptr<TriplePool> before = std::exchange(triples_, std::move(next_triples_));
  const std::vector<Slot> known = std::exchange(triple_slots_, {});
  if (!triples_) return;
  const std::span<const Triple> all = triples_->candidates();
  triple_slots_.resize(all.size());
  const std::span<const Triple> old = before ? before->candidates() : std::span<const Triple>{};
  for (std::size_t now = 0, then = 0; now < all.size(); ++now) {
    while (then < old.size() && old[then] < all[now]) ++then;
    if (then == old.size()) break;
    if (old[then] != all[now]) continue;
    triple_slots_[now] = known[then];
    if (known[then].is_masked) triple_slots_[now].refused_until_m = 0.0;
  }
}

DCEM_INLINE bool PooledLink::hides(const Scene& scene, const FacetOutlines& outlines, const Sight& sight,
                                   std::size_t at, const WayReach& moved_m) const {
  const SequenceElement element = way_.elements[at];
  const double nearer = element.is_edge() ? sight.nearer_on(scene, outlines, element.edge())
                                          : sight.nearer_on(scene, outlines, element.mirror());
  return sight.map().hides(way_.points_m[at], nearer, moved_m[at]);
}

}  // namespace dcem
