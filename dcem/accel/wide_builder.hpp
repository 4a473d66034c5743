#pragma once
/// Builds a wide tree: patches, a binary tree by surface-area heuristic, collapsed to eight children a node.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "dcem/accel/build_item.hpp"
#include "dcem/accel/patches.hpp"
#include "dcem/accel/sah_builder.hpp"
#include "dcem/accel/wide_arrays.hpp"
#include "dcem/accel/wide_collapse.hpp"

namespace dcem {

/// How a wide tree is built.
struct WideSettings {
  /// Bins, sweeps and costs of the binary tree; leaf sizes are set here and ignored there.
  SahSettings sah;
  /// Relative costs of nodes and blocks, by which the binary tree is collapsed.
  WideCosts costs;
  /// Two triangles become one patch where the fourth corner is no further from the plane of the others than this times
  /// the shared edge (no unit). Default 1e-3; negative switches pairing off.
  double pair_flatness = 1e-3;
  /// A group of at most this many patches owns a subtree that moves as a whole; a larger one, such as a city, is mixed
  /// with its surroundings (number). Default 512.
  std::uint32_t unit_limit = 512;
};

/// Fills the arrays of one tree.
class WideBuilder {
 public:
  explicit WideBuilder(const WideSettings& settings) : settings_(settings) {
    settings_.sah.leaf_limit = settings_.sah.leaf_maximum = 1;
    require_valid_settings(settings_.sah);
  }

  /// `group_first` as in Bvh::build_grouped. Boxes and corners of `arrays` are set.
  void build(WideArrays& arrays, const TriangleView& mesh, std::span<const std::uint32_t> group_first) {
    arrays_ = &arrays;
    place_origin();
    detail::PatchBuilder pairing(mesh, settings_.pair_flatness);
    std::vector<BuildItem<double>> items;
    kinds_.clear();
    patches_.clear();
    arrays.unit_root.assign(group_first.size(), WideChild{});
    arrays.take_node();  // the root is node 0, before the nodes of any unit
    for (std::uint32_t group = 0; group < group_first.size(); ++group) {
      const auto last =
          group + 1 < group_first.size() ? group_first[group + 1] : static_cast<std::uint32_t>(mesh.size());
      const std::size_t first_patch = patches_.size();
      pairing.append(group_first[group], last, patches_);
      if (patches_.size() > first_patch) add_group(group, first_patch, items);
    }
    if (!items.empty()) plant_root(items);
  }

 private:
  /// An item of the tree over all: a patch, or a unit.
  struct Kind {
    std::uint32_t group;
    std::uint32_t patch;  ///< in patches_; no_patch for a unit
  };
  static constexpr std::uint32_t no_patch = 0xffffffffU;

  void place_origin() {
    Aabb<double> all;
    for (const Aabb<double>& box : arrays_->boxes) all.extend(box);
    arrays_->origin_m = all.empty() ? Vec3(0.0) : all.center();
  }

  void add_group(std::uint32_t group, std::size_t first_patch, std::vector<BuildItem<double>>& items) {
    const std::size_t count = patches_.size() - first_patch;
    if (count > settings_.unit_limit) {
      for (std::size_t patch = first_patch; patch < patches_.size(); ++patch) {
        items.emplace_back(arrays_->box_of_patch(patches_[patch]), static_cast<std::uint32_t>(kinds_.size()));
        kinds_.push_back({group, static_cast<std::uint32_t>(patch)});
      }
      return;
    }
    std::vector<BuildItem<double>> own;
    const auto first_kind = static_cast<std::uint32_t>(kinds_.size());
    for (std::size_t patch = first_patch; patch < patches_.size(); ++patch) {
      own.emplace_back(arrays_->box_of_patch(patches_[patch]), static_cast<std::uint32_t>(kinds_.size()));
      kinds_.push_back({group, static_cast<std::uint32_t>(patch)});
    }
    static_cast<void>(first_kind);
    const auto [root, box] = plant(own);
    arrays_->unit_root[group] = root;
    (root.is_block() ? arrays_->block_unit[root.index()] : arrays_->node_unit[root.index()]) = group;
    items.emplace_back(bounds_of<double>(own), static_cast<std::uint32_t>(kinds_.size()));
    kinds_.push_back({group, no_patch});
    unit_box_.resize(arrays_->unit_root.size());
    unit_box_[group] = box;
  }

  struct Planted {
    WideChild child;
    Aabb<float> box;
  };

  Planted plant(std::span<BuildItem<double>> items) {
    const std::vector<BvhNode<double>> binary = SahBuilder<double>(settings_.sah).build(items);
    const WideCollapse collapse(binary, settings_.costs, [&](std::uint32_t position) {
      const Kind& kind = kinds_[items[position].index];
      return kind.patch == no_patch ? WideCollapse::no_kind : kind.group;
    });
    return plant_entry(binary, collapse, items, 0);
  }

  void plant_root(std::span<BuildItem<double>> items) {
    const std::vector<BvhNode<double>> binary = SahBuilder<double>(settings_.sah).build(items);
    const WideCollapse collapse(binary, settings_.costs, [&](std::uint32_t position) {
      const Kind& kind = kinds_[items[position].index];
      return kind.patch == no_patch ? WideCollapse::no_kind : kind.group;
    });
    if (collapse.is_block(0)) {
      const Planted only = plant_entry(binary, collapse, items, 0);
      arrays_->hang(only.child, WidePlace::at(0, 0), only.box);
    } else {
      fill_node(0, binary, collapse, items, 0);
    }
  }

  Planted plant_entry(std::span<const BvhNode<double>> binary, const WideCollapse& collapse,
                      std::span<const BuildItem<double>> items, std::uint32_t slot) {
    if (!collapse.is_block(slot)) {
      const std::uint32_t node = arrays_->take_node();
      fill_node(node, binary, collapse, items, slot);
      return {WideChild::node(node), arrays_->nodes[node].box()};
    }
    const BvhNode<double>& held = binary[slot];
    const Kind* kind = held.is_leaf() ? &kinds_[items[held.first].index] : nullptr;
    if (kind != nullptr && kind->patch == no_patch) return {arrays_->unit_root[kind->group], unit_box_[kind->group]};
    members_.clear();
    collect(binary, items, slot);
    const std::uint32_t block = arrays_->add_block(kinds_[members_.front()].group);
    for (std::uint32_t lane = 0; lane < members_.size(); ++lane) {
      const Patch& patch = patches_[kinds_[members_[lane]].patch];
      arrays_->patches[block * simd_lanes + lane] = patch;
      for (const std::uint32_t triangle : patch.triangles()) {
        arrays_->patch_of_triangle[triangle] = block * simd_lanes + lane;
      }
    }
    return {WideChild::block(block), arrays_->write_block(block)};
  }

  void fill_node(std::uint32_t node, std::span<const BvhNode<double>> binary, const WideCollapse& collapse,
                 std::span<const BuildItem<double>> items, std::uint32_t slot) {
    std::vector<std::uint32_t> entries;
    collapse.for_each_entry(slot, [&](std::uint32_t entry) { entries.push_back(entry); });
    // Any-hit queries take the lanes as they come: the largest box is the most likely to be in the way.
    std::stable_sort(entries.begin(), entries.end(), [&](std::uint32_t one, std::uint32_t other) {
      return binary[one].box.half_area() > binary[other].box.half_area();
    });
    for (std::uint32_t lane = 0; lane < entries.size(); ++lane) {
      const Planted planted = plant_entry(binary, collapse, items, entries[lane]);
      arrays_->hang(planted.child, WidePlace::at(node, lane), planted.box);
    }
  }

  void collect(std::span<const BvhNode<double>> binary, std::span<const BuildItem<double>> items, std::uint32_t slot) {
    if (!binary[slot].is_leaf()) {
      collect(binary, items, binary[slot].left());
      collect(binary, items, binary[slot].right());
      return;
    }
    members_.push_back(items[binary[slot].first].index);
  }

  WideSettings settings_;
  WideArrays* arrays_ = nullptr;
  std::vector<Patch> patches_;
  std::vector<Kind> kinds_;  ///< by item
  std::vector<Aabb<float>> unit_box_;
  std::vector<std::uint32_t> members_;
};

}  // namespace dcem
