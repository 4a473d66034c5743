/// Slots: bodies that objects of one shape take in turn. Who stands where is told by each frame, and what changed is
/// told exactly.
#include <doctest/doctest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/scene/scene.hpp"

namespace test_body_pool {

using namespace dcem;

namespace {

using Ids = std::vector<BodyId>;

BodyId body(std::size_t index) {
  return BodyId(index);
}

/// Body 1: the object `bus`. Bodies 2, 3, 4: slots for cars.
struct Street {
  Scene scene;

  Street() {
    scene.add_material({"metal", PerfectConductor{}});
    scene.add_object("bus", make_box(Vec3(12, 2.5, 3), "metal"), LinearMotion{{Vec3(0, 10, 0)}, Vec3(1, 0, 0), 0.0});
    scene.add_body_pool(3, make_box(Vec3(4, 2, 1.5), "metal"));
  }

  Frame empty() const { return scene.frame_at(0.0); }
};

BodyState standing(std::string name, const Vec3& position_m, const Vec3& velocity_mps = Vec3(0.0)) {
  return {true, {Pose{position_m}, {velocity_mps, Vec3(0.0)}}, std::move(name)};
}

Frame with(Frame frame, std::size_t index, BodyState state) {
  frame.bodies[index] = std::move(state);
  return frame;
}

/// Everything that apply() may change, so that two instants can be compared.
struct Snapshot {
  std::vector<BodyState> states;
  std::vector<Aabb<double>> boxes;
  std::vector<bool> present;
  std::vector<std::optional<BodyId>> found;

  explicit Snapshot(const Scene& scene) : boxes(scene.triangle_boxes().begin(), scene.triangle_boxes().end()) {
    for (std::size_t index = 0; index < scene.bodies().size(); ++index) states.push_back(scene.body_state(body(index)));
    for (const WorldFacet& facet : scene.facets()) present.push_back(facet.present);
    for (const char* name : {"", "bus", "a", "b", "c", "d", "a/b"}) found.push_back(scene.find_body(name));
  }
  friend bool operator==(const Snapshot&, const Snapshot&) = default;
};

void check_refused(Street& street, const Frame& frame, const std::string& named = {}) {
  const Snapshot before(street.scene);
  try {
    street.scene.apply(frame);
    FAIL_CHECK("the frame was not refused");
  } catch (const std::invalid_argument& error) {
    CHECK(std::string(error.what()).find(named) != std::string::npos);
  }
  CHECK((Snapshot(street.scene) == before));
}

}  // namespace

TEST_CASE("slots are empty until a frame fills them: no facet, no box, no name") {
  Street street;
  CHECK(street.scene.slot_count() == 3);
  CHECK(street.scene.bodies().size() == 5);
  for (const std::size_t index : {2U, 3U, 4U}) {
    CHECK(street.scene.body(body(index)).is_slot);
    CHECK_FALSE(street.scene.body_state(body(index)).present);
    CHECK(street.scene.body_name(body(index)).empty());
    CHECK_FALSE(street.empty().bodies[index].present);
    const auto [first, last] = street.scene.triangle_range(body(index));
    CHECK(last - first == 12);
    for (std::uint32_t triangle = first; triangle < last; ++triangle) {
      CHECK(street.scene.triangle_boxes()[triangle].empty());
      CHECK_FALSE(street.scene.facet(street.scene.facet_of_triangle(triangle)).present);
    }
  }
  CHECK_FALSE(street.scene.body(body(1)).is_slot);
  CHECK(street.scene.body_name(body(1)) == "bus");
  CHECK(street.scene.body_name(body(0)).empty());
  CHECK_FALSE(street.scene.find_body("").has_value());
  const ChangeSet changes = street.scene.apply(street.empty());
  CHECK(changes.moved.empty());
  CHECK(changes.replaced.empty());
}

TEST_CASE("slots need a known material, count up, and none at all may be asked for") {
  Street street;
  CHECK_THROWS_AS(street.scene.add_body_pool(2, make_box(Vec3(1.0), "wood")), std::invalid_argument);
  CHECK(street.scene.slot_count() == 3);
  CHECK(street.scene.bodies().size() == 5);
  street.scene.add_body_pool(0, make_box(Vec3(1.0), "metal"));
  CHECK(street.scene.bodies().size() == 5);
  street.scene.add_body_pool(2, make_box(Vec3(1.0), "metal"));
  CHECK(street.scene.slot_count() == 5);
  CHECK(street.scene.bodies().size() == 7);
}

TEST_CASE("an object enters, drives, and leaves") {
  Street street;
  Scene& scene = street.scene;
  const Frame in = with(street.empty(), 3, standing("a", Vec3(5, 0, 0)));
  ChangeSet changes = scene.apply(in);
  CHECK(changes.moved == Ids{body(3)});
  CHECK(changes.replaced == Ids{body(3)});
  CHECK(scene.find_body("a") == body(3));
  CHECK(scene.body_name(body(3)) == "a");
  const auto [first, last] = scene.triangle_range(body(3));
  Aabb<double> bounds;
  for (std::uint32_t triangle = first; triangle < last; ++triangle) bounds.extend(scene.triangle_boxes()[triangle]);
  CHECK(bounds == Aabb<double>{Vec3(3, -1, 0), Vec3(7, 1, 1.5)});

  changes = scene.apply(with(in, 3, standing("a", Vec3(6, 0, 0))));
  CHECK(changes.moved == Ids{body(3)});
  CHECK(changes.replaced.empty());

  changes = scene.apply(with(in, 3, standing("a", Vec3(6, 0, 0), Vec3(10, 0, 0))));  // only the velocity is another
  CHECK(changes.moved.empty());
  CHECK(changes.replaced.empty());
  CHECK(scene.body_state(body(3)).placement.velocity.linear_mps == Vec3(10, 0, 0));

  changes = scene.apply(street.empty());
  CHECK(changes.moved == Ids{body(3)});
  CHECK(changes.replaced == Ids{body(3)});
  CHECK_FALSE(scene.find_body("a").has_value());
  CHECK(scene.body_name(body(3)).empty());
  CHECK(scene.apply(street.empty()).moved.empty());
}

TEST_CASE("another object at the same slot and pose: replaced, not moved") {
  Street street;
  street.scene.apply(with(street.empty(), 2, standing("a", Vec3(5, 0, 0))));
  const ChangeSet changes = street.scene.apply(with(street.empty(), 2, standing("b", Vec3(5, 0, 0))));
  CHECK(changes.moved.empty());
  CHECK(changes.replaced == Ids{body(2)});
  CHECK_FALSE(street.scene.find_body("a").has_value());
  CHECK(street.scene.find_body("b") == body(2));
}

TEST_CASE("objects change slots in one frame, in pairs and in a ring") {
  Street street;
  Scene& scene = street.scene;
  const Frame frame =
      with(with(with(street.empty(), 2, standing("a", Vec3(10, 0, 0))), 3, standing("b", Vec3(20, 0, 0))), 4,
           standing("c", Vec3(30, 0, 0)));
  scene.apply(frame);
  const Frame pair = with(with(frame, 2, standing("b", Vec3(20, 0, 0))), 3, standing("a", Vec3(10, 0, 0)));
  ChangeSet changes = scene.apply(pair);
  CHECK(changes.moved == Ids{body(2), body(3)});
  CHECK(changes.replaced == Ids{body(2), body(3)});
  CHECK(scene.find_body("a") == body(3));
  CHECK(scene.find_body("b") == body(2));
  CHECK(scene.find_body("c") == body(4));
  const Frame ring = with(with(with(frame, 2, standing("c", Vec3(30, 0, 0))), 3, standing("b", Vec3(20, 0, 0))), 4,
                          standing("a", Vec3(10, 0, 0)));
  scene.apply(ring);
  CHECK(scene.find_body("a") == body(4));
  CHECK(scene.find_body("b") == body(3));
  CHECK(scene.find_body("c") == body(2));
  // One goes to the other's slot, which leaves; in both directions of the numbers.
  scene.apply(with(with(with(frame, 2, standing("a", Vec3(0.0))), 3, {false, {}, ""}), 4, {false, {}, ""}));
  CHECK(scene.find_body("a") == body(2));
  CHECK_FALSE(scene.find_body("c").has_value());
  scene.apply(with(street.empty(), 4, standing("a", Vec3(0.0))));
  CHECK(scene.find_body("a") == body(4));
}

TEST_CASE("a frame in which a name is no good is refused and changes nothing") {
  for (const bool filled : {false, true}) {
    CAPTURE(filled);
    Street street;
    const Frame base = filled ? with(street.empty(), 2, standing("a", Vec3(5, 0, 0))) : street.empty();
    street.scene.apply(base);
    const auto moved_bus = [&](Frame frame) { return with(frame, 1, {true, {Pose{Vec3(7, 7, 0)}, {}}, ""}); };
    const auto refused = [&](const Frame& frame, const std::string& named = {}) {
      check_refused(street, moved_bus(frame), named);
    };
    refused(with(with(base, 2, standing("a", Vec3(0.0))), 4, standing("a", Vec3(9, 0, 0))), "'a'");  // twice
    refused(with(base, 4, standing("bus", Vec3(9, 0, 0))), "'bus'");                                 // an object's id
    refused(with(base, 4, standing("a/b", Vec3(9, 0, 0))), "'a/b'");                                 // a slash
    refused(with(base, 4, standing("", Vec3(9, 0, 0))));              // there without a name
    refused(with(base, 4, {false, {Pose{Vec3(9, 0, 0)}, {}}, "d"}));  // away with a name
    refused(with(base, 2, {false, {Pose{Vec3(5, 0, 0)}, {}}, "a"}));  // gone, its name left behind
    check_refused(street, with(base, 1, {true, {}, "d"}));            // an object is no slot
    const double nan = std::numeric_limits<double>::quiet_NaN();
    refused(with(base, 3, standing("d", Vec3(nan, 0, 0))), "'d'");
    refused(with(base, 3, standing("d", Vec3(0.0), Vec3(nan, 0, 0))), "'d'");
    Frame shorter = base;
    shorter.bodies.pop_back();
    check_refused(street, shorter);
    CHECK(street.scene.apply(base).moved.empty());
  }
}

TEST_CASE("a name that came into the scene later is refused to an object, and one that has gone is free again") {
  Street street;
  street.scene.apply(with(street.empty(), 2, standing("a", Vec3(5, 0, 0))));
  CHECK_THROWS_AS(street.scene.add_object("a", make_box(Vec3(1.0), "metal"), {}), std::invalid_argument);
  street.scene.apply(street.empty());
  const BodyId added = street.scene.add_object("a", make_box(Vec3(1.0), "metal"), {});
  CHECK(street.scene.find_body("a") == added);
  CHECK_THROWS_AS(street.scene.apply(with(street.scene.frame_at(0.0), 2, standing("a", Vec3(5, 0, 0)))),
                  std::invalid_argument);
}

TEST_CASE("objects with motions of their own come and go as well, and keep their names while away") {
  Street street;
  Frame away = street.empty();
  away.bodies[1].present = false;
  const ChangeSet changes = street.scene.apply(away);
  CHECK(changes.moved == Ids{body(1)});
  CHECK(changes.replaced.empty());
  CHECK(street.scene.find_body("bus") == body(1));
  CHECK(street.scene.body_name(body(1)) == "bus");
  // Another pose while it is away is no change that anybody could see.
  CHECK(street.scene.apply(with(away, 1, {false, {Pose{Vec3(99, 0, 0)}, {}}, ""})).moved.empty());
  CHECK(street.scene.apply(with(away, 1, {true, {Pose{Vec3(99, 0, 0)}, {}}, ""})).moved == Ids{body(1)});
}

TEST_CASE("a device rides on whoever bears the name, wherever that one stands in the frame asked for") {
  Street street;
  Scene& scene = street.scene;
  Device device = device_at("rider", Vec3(0.0));
  device.attachment = Attachment{"a", Vec3(0, 0, 2), false};
  scene.add_receiver(device);
  const Frame none = street.empty();
  const Frame at_two = with(none, 2, standing("a", Vec3(5, 0, 0), Vec3(3, 0, 0)));
  const Frame at_four = with(with(none, 4, standing("a", Vec3(50, 0, 0))), 2, standing("b", Vec3(5, 0, 0)));
  const auto check_all = [&] {
    CHECK_FALSE(scene.device_state(device, none).present);
    const DeviceState two = scene.device_state(device, at_two), four = scene.device_state(device, at_four);
    CHECK(two.present);
    CHECK(two.position_m == Vec3(5, 0, 2));
    CHECK(two.velocity_mps == Vec3(3, 0, 0));
    CHECK(two.ignored_body == body(2));
    CHECK(four.present);
    CHECK(four.position_m == Vec3(50, 0, 2));
    CHECK(four.ignored_body == body(4));
  };
  check_all();
  for (const Frame& current : {at_two, at_four, none, at_four, at_two}) {
    scene.apply(current);
    check_all();
  }
  device.attachment->sees_own_body = true;
  CHECK_FALSE(scene.device_state(device, at_two).ignored_body.has_value());
}

TEST_CASE("a device may wait for an object only where there are slots") {
  Scene bare;
  Device device = device_at("rider", Vec3(0.0));
  device.attachment = Attachment{"nobody", Vec3(0.0), false};
  CHECK_THROWS_AS(bare.add_receiver(device), std::invalid_argument);
  Street street;
  street.scene.add_receiver(device);
  CHECK_FALSE(street.scene.device_state(device, street.empty()).present);
}

TEST_CASE("a pose that comes back brings back the same bits, whoever stands there") {
  Street street;
  const Placement turned{{Vec3(0.1, 0.2, 0.3), 0.7, 0.1, -0.2}, {}};
  street.scene.apply(with(street.empty(), 2, {true, turned, "a"}));
  const std::vector<Vec3> first(street.scene.vertices_m().begin(), street.scene.vertices_m().end());
  street.scene.apply(with(street.empty(), 2, standing("a", Vec3(900, 0, 0))));
  street.scene.apply(street.empty());
  street.scene.apply(with(street.empty(), 2, {true, turned, "b"}));
  const std::vector<Vec3> again(street.scene.vertices_m().begin(), street.scene.vertices_m().end());
  CHECK(first == again);
}

}  // namespace test_body_pool
