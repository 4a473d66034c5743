#pragma once
/// Bodies of beam_lists.hpp.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/halves/beam_lists.hpp"

namespace dcem {

namespace detail {

/// How many of the things that are left take half of the time that is left, if they take what they usually do.
inline std::size_t half_of(double left_us, double usual_us, std::size_t left) {
  const double some = std::ceil(0.5 * left_us / usual_us);
  return some < static_cast<double>(left) ? static_cast<std::size_t>(some) : left;
}

}  // namespace detail

DCEM_INLINE void BeamLists::find_all(const BeamSource& source) {
  note_mirrors(source, 0, source.half.layers().size());
  has_bodies_ = true;
  found_ = {};
  tables_ = {};
  const BeamFinder finder(source, mirrors_);
  for (const HalfLayer& layer : half_->layers()) finder.find_parts(layer, BeamFinder::many_pieces, found_[0]);
  if (source.over_mirrors) finder.look_through(0, mirrors_.size(), true, BeamFinder::few_pieces, found_[0]);
  tables_[of_scenery].lay_out(source.scene, source.lanes, found_[0], mirrors_);
}

DCEM_INLINE void BeamLists::find_from(const BeamSource& source, const Place& place, std::span<const char> moved) {
  note_mirrors(source, 0, 1);
  found_ = {};
  tables_ = {};
  const BeamFinder finder(source, mirrors_);
  finder.find_parts(half_->layers()[0], BeamFinder::few_pieces, found_[0]);
  finder.take_from(place, found_[0]);
  tables_[of_scenery].lay_out(source.scene, source.lanes, found_[0], mirrors_);
  found_[0] = {};
  find_bodies(source, moved);
}

DCEM_INLINE void BeamLists::find_scenery(const BeamSource& source) {
  double all_of_it_us = std::numeric_limits<double>::infinity();
  begin_scenery(source);
  go_on(source, all_of_it_us);
}

DCEM_INLINE void BeamLists::begin_scenery(const BeamSource& source) {
  note_mirrors(source, 0, 1);
  has_bodies_ = source.outlines.bodies().empty();
  found_ = {};
  tables_ = {};
  looked_through_ = looked_over_ = 0;
  lit_over_ = {};
  BeamFinder(source, mirrors_).find_parts(half_->layers()[0], BeamFinder::many_pieces, found_[0]);
}

DCEM_INLINE bool BeamLists::go_on(const BeamSource& source, double& work_us) {
  constexpr double usual_us = 70.0;  // for a mirror
  const std::size_t all = source.over_mirrors ? mirrors_.size() : 0;
  while (looked_through_ < all && work_us > 0.0) {
    work_us -= look_through_more(source, detail::half_of(work_us, usual_us, all - looked_through_));
  }
  if (looked_through_ < all) return false;
  tables_[of_scenery].lay_out(source.scene, source.lanes, found_[0], mirrors_);
  found_[0] = {};
  return true;
}

/// Through so many mirrors. What it took goes by the facets that are seen: one in a thousand mirrors, the ground, takes
/// two hundred times as long as most.
DCEM_INLINE double BeamLists::look_through_more(const BeamSource& source, std::size_t mirrors) {
  constexpr double mirror_us = 40.0, facet_us = 1.4;
  const std::size_t before = found_[0].pairs.size(), last = looked_through_ + mirrors;
  BeamFinder(source, mirrors_).look_through(looked_through_, last, false, source.most_pieces, found_[0]);
  looked_through_ = last;
  return mirror_us * static_cast<double>(mirrors) + facet_us * static_cast<double>(found_[0].pairs.size() - before);
}

DCEM_INLINE bool BeamLists::go_on_over_edges(const BeamSource& source, double& work_us) {
  constexpr double usual_us = 400.0;     // for a part
  constexpr std::size_t some = 256;      // parts, of which it is told how many will be lit
  constexpr std::size_t at_once = 1024;  // before that is asked again
  const std::size_t all = tables_[of_scenery].parts().size();
  while (looked_over_ < all && work_us > 0.0) {
    work_us -= look_over_more(source, std::min(at_once, detail::half_of(work_us, usual_us, all - looked_over_)));
    const std::size_t foreseen = looked_over_ < some ? 0 : lit_over_.size() / looked_over_ * all;
    if (std::max(foreseen, lit_over_.size()) > most_lit_over) {
      lit_over_ = {};
      return true;
    }
  }
  if (looked_over_ < all) return false;
  tables_[of_scenery].list_parts_before(source.scene, lit_over_);
  lit_over_ = {};
  return true;
}

/// Over so many parts, and what else is of the last edge.
DCEM_INLINE double BeamLists::look_over_more(const BeamSource& source, std::size_t parts) {
  constexpr double part_us = 250.0, facet_us = 0.47;
  const std::span<const EdgePart> all = tables_[of_scenery].parts();
  const std::size_t before = lit_over_.size(), first = looked_over_;
  std::size_t last = first + parts;
  while (last < all.size() && all[last].edge == all[last - 1].edge) ++last;
  BeamFinder(source, mirrors_).look_over_edges(all, first, last, lit_over_);
  looked_over_ = last;
  return part_us * static_cast<double>(last - first) + facet_us * static_cast<double>(lit_over_.size() - before);
}

/// Notes the mirrors of some layers: that of the scenery comes first, and stays while the others change.
DCEM_INLINE void BeamLists::note_mirrors(const BeamSource& source, std::size_t first_layer, std::size_t layers) {
  half_ = &source.half;
  lanes_ = &source.lanes;
  position_m_ = half_->position_m() - source.lanes.origin_m();
  const std::size_t kept = first_layer == 0 ? 0 : half_->layers()[0].mirrors.size();
  if (kept == 0) mirror_of_.assign(source.scene.facets().size(), nothing);
  for (std::size_t at = kept; at < mirrors_.size() && kept > 0; ++at) mirror_of_[mirrors_[at].facet.value] = nothing;
  mirrors_.erase(mirrors_.begin() + static_cast<std::ptrdiff_t>(kept), mirrors_.end());
  for (const HalfLayer& layer : half_->layers().subspan(first_layer, layers)) {
    for (std::size_t at = 0; at < layer.mirrors.size(); ++at) {
      mirror_of_[layer.mirrors[at].value] = static_cast<std::uint32_t>(mirrors_.size());
      mirrors_.push_back({layer.mirrors[at], layer.images_m[at] - source.lanes.origin_m(), layer.cones[at]});
    }
  }
}

DCEM_INLINE void BeamLists::find_bodies(const BeamSource& source, std::span<const char> moved, bool follows) {
  std::vector<FacetId> before;
  for (const BeamMirror& mirror : mirrors_) before.push_back(mirror.facet);
  note_mirrors(source, 1, source.half.layers().size() - 1);
  has_bodies_ = true;
  if (follows) {
    keep_standing(source, moved, before);
  } else {
    found_[of_others] = find_others(source, moved);
  }
  found_[of_moved] = find_moved(source, moved);
  for (const std::size_t table : {of_moved, of_others}) {
    tables_[table].lay_out(source.scene, source.lanes, found_[table], mirrors_);
  }
}

/// What is reached over a body that has moved.
DCEM_INLINE BeamFinds BeamLists::find_moved(const BeamSource& source, std::span<const char> moved) const {
  BeamFinds finds;
  const BeamFinder finder(source, mirrors_);
  finder.find_parts(half_->layers()[of_moved], BeamFinder::few_pieces, finds);
  if (!source.over_mirrors) return finds;
  const std::size_t standing = half_->layers()[0].mirrors.size(),
                    last = standing + half_->layers()[of_moved].mirrors.size();
  const BodyChoice choice{half_->ignored_body(), moved, true};
  finder.reach_bodies(0, standing, choice, finds);
  finder.reach_bodies(last, mirrors_.size(), choice, finds);
  finder.look_through(standing, last, true, BeamFinder::few_pieces, finds);
  return finds;
}

/// What is reached over other bodies, and over none that has moved.
DCEM_INLINE BeamFinds BeamLists::find_others(const BeamSource& source, std::span<const char> moved) const {
  BeamFinds finds;
  const BeamFinder finder(source, mirrors_);
  finder.find_parts(half_->layers()[of_others], BeamFinder::few_pieces, finds);
  if (!source.over_mirrors) return finds;
  const std::size_t standing = half_->layers()[0].mirrors.size(),
                    first = standing + half_->layers()[of_moved].mirrors.size();
  const BodyChoice choice{half_->ignored_body(), moved, false};
  finder.reach_bodies(0, standing, choice, finds);
  finder.reach_bodies(first, mirrors_.size(), choice, finds);
  finder.look_through(first, mirrors_.size(), false, BeamFinder::few_pieces, finds);
  return finds;
}

/// Keeps what was listed over bodies and concerns none that has moved now; the mirrors have other places.
DCEM_INLINE void BeamLists::keep_standing(const BeamSource& source, std::span<const char> moved,
                                          std::span<const FacetId> before) {
  const auto has_moved = [&](BodyId body) { return moved.empty() ? body != BodyId(0) : moved[body.value] != 0; };
  const auto place_now = [&](std::uint32_t mirror) {
    return has_moved(source.scene.facet(before[mirror]).body) ? nothing : mirror_of_[before[mirror].value];
  };
  const auto of_edge = [&](std::uint32_t edge) { return source.scene.wedge(WedgeId(edge)).body; };
  BeamFinds kept;
  for (const std::size_t table : {of_others, of_moved}) {
    const BeamFinds& old = found_[table];
    for (const auto& [seen, mirror] : old.pairs) {
      const std::uint32_t place = place_now(mirror);
      if (place != nothing && !has_moved(source.scene.facet(FacetId(seen)).body)) kept.pairs.push_back({seen, place});
    }
    for (const EdgePart& part : old.parts) {
      if (!has_moved(of_edge(part.edge))) kept.parts.push_back(part);
    }
    for (std::size_t at = 0; at < old.lit.size(); ++at) {
      const std::uint32_t place = place_now(old.lit[at].edge);
      if (place == nothing || has_moved(of_edge(old.lit_edges[at]))) continue;
      kept.lit.push_back(old.lit[at]);
      kept.lit.back().edge = place;
      kept.lit_edges.push_back(old.lit_edges[at]);
    }
  }
  found_[of_others] = std::move(kept);
}

}  // namespace dcem
