#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "dcem/io/import.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/import/import_draft.hpp"
#include "dcem/io/src/import/osm_heights.hpp"
#include "dcem/io/src/import/osm_pbf.hpp"
#include "dcem/io/src/import/start_devices.hpp"

namespace dcem::io {

namespace {

using NodeRing = std::vector<std::int64_t>;

std::string tag(const OsmTags& tags, const char* key) {
  const auto found = tags.find(key);
  return found == tags.end() ? std::string() : found->second;
}

/// Joins ways at their ends to closed rings. What does not close is left in `ways`.
std::vector<NodeRing> close_rings(std::vector<NodeRing>& ways) {
  std::vector<NodeRing> rings;
  std::vector<NodeRing> open;
  while (!ways.empty()) {
    NodeRing line = std::move(ways.back());
    ways.pop_back();
    while (line.front() != line.back()) {
      const auto next = std::find_if(ways.begin(), ways.end(), [&](const NodeRing& way) {
        return way.front() == line.back() || way.back() == line.back();
      });
      if (next == ways.end()) break;
      if (next->front() != line.back()) std::reverse(next->begin(), next->end());
      line.insert(line.end(), next->begin() + 1, next->end());
      ways.erase(next);
    }
    (line.front() == line.back() ? rings : open).push_back(std::move(line));
  }
  ways = std::move(open);
  return rings;
}

class OsmImport {
 public:
  OsmImport(const std::filesystem::path& source, const std::filesystem::path& folder, const ImportSettings& settings)
      : source_(source), folder_(folder), settings_(settings) {
    draft_.importer = "osm";
    draft_.sources.push_back(source);
  }

  ImportReport run() {
    data_ = read();
    for (const OsmWay& way : data_.ways) way_of_.emplace(way.id, &way);
    draft_.report.read["nodes"] = data_.nodes.size();
    draft_.report.read["ways"] = data_.ways.size();
    draft_.report.read["relations"] = data_.relations.size();
    find_origin();
    draft_.geo = geo_json(zone_, origin_m_, source_, "nodes");
    for (const OsmRelation& relation : data_.relations) add_relation(relation);
    for (const OsmWay& way : data_.ways) add_way(way);
    const std::vector<TownPart> parts = build_town(std::move(town_), low_m_, high_m_, settings_, source_, draft_);
    draft_.scenario["propagation"] = town_propagation_json();
    const Vec2 middle_m = glm::round(0.5 * (low_m_ + high_m_));
    draft_.scenario["transmitters"] = nlohmann::ordered_json::array({mast_json(draft_, parts, middle_m)});
    draft_.scenario["receivers"] = nlohmann::ordered_json::array(
        {{{"id", "point"}, {"positions_m", open_points_json(draft_, parts, middle_m, 8)}}});
    draft_.report.notes.push_back(
        "One mast and points in the open were chosen for a start: edit transmitters and receivers.");
    return write_import(std::move(draft_), folder_, settings_);
  }

 private:
  OsmData read() const {
    if (source_.extension() != ".pbf") return read_osm_xml(source_);
    if (can_read_pbf()) return read_osm_pbf(source_);
    throw InputError(source_.string(),
                     "this build cannot read PBF; expected libosmium (libosmium2-dev) when DCEM was built, "
                     "or the map as XML");
  }

  /// The middle of what is kept, to whole metres.
  void find_origin() {
    GeoPoint low{90.0, 180.0}, high{-90.0, -180.0};
    for (const auto& [id, point] : data_.nodes) {
      low = {std::min(low.latitude_deg, point.latitude_deg), std::min(low.longitude_deg, point.longitude_deg)};
      high = {std::max(high.latitude_deg, point.latitude_deg), std::max(high.longitude_deg, point.longitude_deg)};
    }
    if (data_.nodes.empty()) throw InputError(source_.string(), "holds no node; expected OpenStreetMap data");
    constexpr double widest_deg = 5.0;
    if (high.longitude_deg - low.longitude_deg > widest_deg || high.latitude_deg - low.latitude_deg > widest_deg) {
      throw InputError(source_.string(), "reaches over more than 5 degrees; expected a town");
    }
    const GeoPoint middle{0.5 * (low.latitude_deg + high.latitude_deg), 0.5 * (low.longitude_deg + high.longitude_deg)};
    zone_ = utm_zone(middle);
    origin_m_ = glm::round(utm_m(middle, zone_));
  }

  /// Nothing where a node is not in the file.
  std::optional<Ring> plane_ring(const NodeRing& nodes) const {
    Ring ring;
    for (const std::int64_t node : nodes) {
      const auto found = data_.nodes.find(node);
      if (found == data_.nodes.end()) return std::nullopt;
      ring.push_back(utm_m(found->second, zone_) - origin_m_);
    }
    return ring;
  }

  void add_way(const OsmWay& way) {
    if (taken_.contains(way.id) || !is_kept(way.tags)) return;
    if (way.nodes.size() < 2 || way.nodes.front() != way.nodes.back()) {
      // Two corners, or a line: no outline.
      ++draft_.report.skipped["outlines that are not closed"];
      return;
    }
    add_outline(way.tags, "way_" + std::to_string(way.id), {way.nodes}, {});
  }

  /// A multipolygon: its own tags, or in the old style those of its outer way.
  void add_relation(const OsmRelation& relation) {
    const std::string type = tag(relation.tags, "type");
    if (type == "building") return skip_outline_with_parts(relation);
    if (type != "multipolygon") return;
    std::vector<NodeRing> outers, inners;
    const OsmTags* tags = is_kept(relation.tags) ? &relation.tags : nullptr;
    std::vector<std::int64_t> outer_ids;
    bool is_whole = true;
    for (const OsmRelation::Member& member : relation.members) {
      const auto way = way_of_.find(member.way);
      if (way == way_of_.end() || way->second->nodes.size() < 2) {
        is_whole = false;
        continue;
      }
      (member.role == "inner" ? inners : outers).push_back(way->second->nodes);
      if (member.role == "inner") continue;
      outer_ids.push_back(member.way);
      if (tags == nullptr && is_kept(way->second->tags)) tags = &way->second->tags;
    }
    if (tags == nullptr) return;
    taken_.insert(outer_ids.begin(), outer_ids.end());
    ++draft_.report.read["multipolygons"];
    const std::vector<NodeRing> outer_rings = close_rings(outers), inner_rings = close_rings(inners);
    if (!is_whole || !outers.empty() || !inners.empty()) {
      ++draft_.report.skipped["multipolygons that are not closed or not all in the file"];
      return;
    }
    add_outline(*tags, "relation_" + std::to_string(relation.id), outer_rings, inner_rings);
  }

  /// A building told in parts: they stand for it, and the outline around them does not.
  void skip_outline_with_parts(const OsmRelation& relation) {
    const auto has_role = [&](const char* role) {
      return std::any_of(relation.members.begin(), relation.members.end(),
                         [&](const OsmRelation::Member& member) { return member.role == role; });
    };
    if (!has_role("part")) return;
    for (const OsmRelation::Member& member : relation.members) {
      if (member.role != "outline" || !taken_.insert(member.way).second) continue;
      ++draft_.report.skipped["outlines of buildings told in parts"];
    }
  }

  void add_outline(const OsmTags& tags, const std::string& id, const std::vector<NodeRing>& outers,
                   const std::vector<NodeRing>& inners) {
    if (tag(tags, "location") == "underground" || tag(tags, "layer").starts_with('-')) {
      ++draft_.report.skipped["outlines under the ground"];
      return;
    }
    FoundHouse found{id, {}, {}};
    for (const auto& [nodes, rings] : {std::pair{&outers, &found.outers}, std::pair{&inners, &found.inners}}) {
      for (const NodeRing& ring : *nodes) {
        std::optional<Ring> corners = plane_ring(ring);
        if (!corners) {
          ++draft_.report.skipped["outlines with nodes that are not in the file"];
          return;
        }
        rings->push_back(std::move(*corners));
      }
    }
    for (const Ring& ring : found.outers) {
      for (const Vec2& corner : ring) {
        low_m_ = glm::min(low_m_, corner);
        high_m_ = glm::max(high_m_, corner);
      }
    }
    keep(tags, std::move(found));
  }

  void keep(const OsmTags& tags, FoundHouse&& found) {
    const bool is_house = tags.contains("building") || tags.contains("building:part");
    if (!is_house) {
      found.height_m = tree_height_m(tags, settings_, draft_.report);
      found.wall = found.roof = "foliage";
      town_.forests.push_back(std::move(found));
      return;
    }
    apply_tags(tags, settings_, found, draft_.report);
    if (tags.contains("min_height") || tags.contains("building:min_level")) {
      ++draft_.report.repaired["parts above the ground, let down to it"];
    }
    town_.houses.push_back(std::move(found));
  }

  std::filesystem::path source_, folder_;
  const ImportSettings& settings_;
  ImportDraft draft_;
  OsmData data_;
  std::unordered_map<std::int64_t, const OsmWay*> way_of_;
  std::unordered_set<std::int64_t> taken_;  ///< ways that a relation has spoken for
  UtmZone zone_;
  Vec2 origin_m_{0.0};
  Vec2 low_m_{1e7}, high_m_{-1e7};
  FoundTown town_;
};

}  // namespace

ImportReport import_osm(const std::filesystem::path& map, const std::filesystem::path& folder,
                        const ImportSettings& settings) {
  check_settings(settings, map);
  require_outlines(map);
  if (!knows_utm()) {
    throw InputError(map.string(),
                     "this build cannot project longitudes and latitudes; expected GeographicLib "
                     "(libgeographiclib-dev) when DCEM was built");
  }
  return OsmImport(map, folder, settings).run();
}

}  // namespace dcem::io
