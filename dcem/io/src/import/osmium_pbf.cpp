// OpenStreetMap's PBF by libosmium (https://osmcode.org/libosmium).
#include <osmium/io/pbf_input.hpp>
#include <osmium/io/reader.hpp>
#include <osmium/osm.hpp>
#include <osmium/version.hpp>

#include "dcem/io/input_error.hpp"
#include "dcem/io/src/import/osm_pbf.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

OsmTags kept_tags(const osmium::TagList& list) {
  OsmTags tags;
  for (const osmium::Tag& tag : list) {
    if (is_kept_key(tag.key())) tags.emplace(tag.key(), tag.value());
  }
  return tags;
}

void add_way(const osmium::Way& way, OsmData& data) {
  OsmWay kept{way.id(), {}, kept_tags(way.tags())};
  for (const osmium::NodeRef& node : way.nodes()) kept.nodes.push_back(node.ref());
  data.ways.push_back(std::move(kept));
}

void add_relation(const osmium::Relation& relation, OsmData& data) {
  OsmRelation kept{relation.id(), {}, kept_tags(relation.tags())};
  for (const osmium::RelationMember& member : relation.members()) {
    if (member.type() == osmium::item_type::way) kept.members.push_back({member.ref(), member.role()});
  }
  if (!kept.members.empty()) data.relations.push_back(std::move(kept));
}

void add_entity(const osmium::OSMEntity& entity, OsmData& data) {
  if (entity.type() == osmium::item_type::node) {
    const auto& node = static_cast<const osmium::Node&>(entity);
    if (!node.location().valid()) return;
    data.nodes[node.id()] = {node.location().lat(), node.location().lon()};
  } else if (entity.type() == osmium::item_type::way) {
    add_way(static_cast<const osmium::Way&>(entity), data);
  } else if (entity.type() == osmium::item_type::relation) {
    add_relation(static_cast<const osmium::Relation&>(entity), data);
  }
}

}  // namespace

bool can_read_pbf() {
  return true;
}

std::string pbf_library() {
  return "libosmium " LIBOSMIUM_VERSION_STRING;
}

OsmData read_osm_pbf(const std::filesystem::path& file) {
  // Of a file that it opens itself libosmium leaves the descriptor open where the PBF is damaged.
  const std::string bytes = read_text_file(file, "expected OpenStreetMap's PBF");
  OsmData data;
  try {
    osmium::io::Reader reader(osmium::io::File(bytes.data(), bytes.size(), "pbf"));
    while (const osmium::memory::Buffer buffer = reader.read()) {
      for (const auto& entity : buffer.select<osmium::OSMEntity>()) add_entity(entity, data);
    }
    reader.close();
  } catch (const std::exception& error) {
    throw InputError(file.string(), "damaged PBF (" + printable(error.what()) + "); expected OpenStreetMap's PBF");
  }
  return data;
}

}  // namespace dcem::io
