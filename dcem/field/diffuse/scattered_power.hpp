#pragma once
/// What a square metre of a rough surface brings to a link: em/surface/effective_roughness.hpp with both antennas, the
/// sheets that the legs cross, air and foliage.
///   P_rx/P_tx per m² = (λ/4π)²·(S·|Γ|)²·cos θ_i·f_s·G_rx·|E_i|²/(r_i·r_s)²,
/// |E_i|² with the transmitting antenna's gain and polarization. The scattered wave is taken as unpolarized: the
/// receiving antenna's gain applies to it, its polarization does not; a sheet on its way lets the mean of both
/// polarizations pass. A dual-polarized receiver gets no more than one port's gain, as the power is that in both.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "dcem/em/surface/effective_roughness.hpp"
#include "dcem/field/diffuse/scattering_limits.hpp"
#include "dcem/field/field_carrier.hpp"
#include "dcem/field/field_evaluator.hpp"
#include "dcem/field/medium_loss.hpp"
#include "dcem/field/power_sample.hpp"

namespace dcem {

template <SurfaceModel Surface, PathLossModel Loss>
class ScatteredPower {
 public:
  /// Everything named must outlive it. `limits`: of the scene's materials; none: they are worked out.
  ScatteredPower(const Scene& scene, const Surface& surface, const Loss& loss, const MediumLoss& medium,
                 double frequency_hz, std::shared_ptr<const ScatteringLimits> limits = nullptr)
      : scene_(scene),
        surface_(surface),
        loss_(loss),
        medium_(medium),
        frequency_hz_(frequency_hz),
        limits_(limits
                    ? std::move(limits)
                    : std::make_shared<const ScatteringLimits>(scattering_limits(surface, scene.materials().size()))) {}

  /// The power_ratio per m² of the surface of a path with one scattering. Zero where the surface model does not
  /// scatter.
  double power_per_m2(const Path& path, const RadioEnd& transmitter, const RadioEnd& receiver) const {
    if constexpr (ScatteringModel<Surface>) {
      const std::size_t place = scattering_place(path);
      const Geometry geometry =
          geometry_of(transmitter.position_m, path.interactions[place].point_m, receiver.position_m);
      return power_per_m2(path, place, geometry, transmitter, receiver);
    }
    return 0.0;
  }

  /// The sample of such a path that has this power.
  PowerSample sample(const Path& path, const RadioEnd& transmitter, const RadioEnd& receiver,
                     double power_ratio) const {
    const Interaction& scattering = path.interactions[scattering_place(path)];
    const Geometry geometry = geometry_of(transmitter.position_m, scattering.point_m, receiver.position_m);
    return {power_ratio, path.length_m / speed_of_light_mps, doppler_hz(scattering, geometry, transmitter, receiver),
            detail::direction_of(geometry.incident), detail::direction_of(-geometry.scattered)};
  }

  /// No less than the power_ratio per m² of any point of a facet within `radius_m` of `centre_m`, that is no nearer to
  /// the ends than `from_m` and `to_m`. What sheets, air and foliage take is not counted.
  double limit_per_m2(const WorldFacet& facet, const Vec3& centre_m, double radius_m, double from_m, double to_m,
                      const RadioEnd& transmitter, const RadioEnd& receiver) const {
    if constexpr (ScatteringModel<Surface>) {
      const Geometry centre = geometry_of(transmitter.position_m, centre_m, receiver.position_m);
      // By so much the directions at the tile may differ from those at its centre.
      const double turn_rad = radius_m / from_m + radius_m / to_m;
      const Vec3 mirrored = reflected_direction(centre.incident, facet.plane.normal);
      const double cos_incidence = slant(facet.plane, transmitter.position_m, from_m);
      const ScatteringAngles largest{cos_incidence, slant(facet.plane, receiver.position_m, to_m),
                                     cosine_within(glm::dot(mirrored, centre.scattered), turn_rad),
                                     cosine_within(-glm::dot(centre.incident, centre.scattered), turn_rad)};
      const Scattering& scattering = surface_.scattering(facet.material);
      const double amplitude_m = wavelength_m(frequency_hz_) / (4.0 * pi) * loss_.excess_amplitude(from_m + to_m);
      const double share = amplitude_m * scattering.coefficient / (from_m * to_m);
      return share * share * cos_incidence * scattering_density_limit_per_sr(scattering, largest) *
             highest_gain(transmitter.antenna) * highest_gain(receiver.antenna);
    }
    return 0.0;
  }

  /// No less than the power that a sheet lets pass, at any angle.
  double transmission_limit(const WorldFacet& sheet) const { return limits_->transmission[sheet.material.value]; }

  /// The angle within which the pattern of a surface changes; at most 1.
  double pattern_width_rad(MaterialId material) const {
    if constexpr (ScatteringModel<Surface>) return scattering_width_rad(surface_.scattering(material));
    return 1.0;
  }

  /// The angle within which what a surface reflects changes; at most 1.
  double reflection_width_rad(MaterialId material) const { return limits_->reflection_width_rad[material.value]; }
  /// The same of what a sheet lets pass.
  double transmission_width_rad(const WorldFacet& sheet) const {
    return limits_->transmission_width_rad[sheet.material.value];
  }

  /// Half of the angle that an antenna's beam is wide, if all of its power were in it: √(4π/G)/2; at most 1.
  static double beam_width_rad(const Antenna& antenna) {
    return std::min(1.0, 0.5 * std::sqrt(4.0 * pi / std::max(1.0, peak_power_gain(antenna.pattern))));
  }

  bool is_weakened_by(MaterialId foliage) const { return medium_.takes_of(foliage); }
  double frequency_hz() const { return frequency_hz_; }

 private:
  struct Geometry {
    Vec3 incident, scattered;  ///< unit propagation directions
    double from_m, to_m;
  };

  static std::size_t scattering_place(const Path& path) {
    const auto scatters = [](const Interaction& at) { return at.kind == InteractionKind::scattering; };
    return static_cast<std::size_t>(std::find_if(path.interactions.begin(), path.interactions.end(), scatters) -
                                    path.interactions.begin());
  }

  static Geometry geometry_of(const Vec3& from_m, const Vec3& point_m, const Vec3& to_m) {
    const Vec3 incident_m = point_m - from_m, scattered_m = to_m - point_m;
    const double incident_length_m = glm::length(incident_m), scattered_length_m = glm::length(scattered_m);
    return {incident_m / incident_length_m, scattered_m / scattered_length_m, incident_length_m, scattered_length_m};
  }

  double power_per_m2(const Path& path, std::size_t place, const Geometry& geometry, const RadioEnd& transmitter,
                      const RadioEnd& receiver) const {
    const WorldFacet& facet = scene_.facet(path.interactions[place].facet);
    const Scattering& scattering = surface_.scattering(facet.material);
    const Vec3& normal = facet.plane.normal;
    const double cos_incidence = std::abs(glm::dot(geometry.incident, normal));
    const Vec3 mirrored = reflected_direction(geometry.incident, normal);
    const double density_per_sr = scattering_density_per_sr(
        scattering, {cos_incidence, std::abs(glm::dot(geometry.scattered, normal)),
                     glm::dot(mirrored, geometry.scattered), -glm::dot(geometry.incident, geometry.scattered)});
    const double amplitude_m = wavelength_m(frequency_hz_) / (4.0 * pi) * loss_.excess_amplitude(path.length_m);
    const double share = amplitude_m * scattering.coefficient / (geometry.from_m * geometry.to_m);
    return share * share * cos_incidence * density_per_sr * reflected_power(path, place, geometry, transmitter) *
           passed_power(path, place, geometry) *
           norm_of(receiver.antenna.port_jones(-geometry.scattered, 0, receiver.rotation)) *
           medium_power(path, geometry);
  }

  /// What air and foliage let pass.
  double medium_power(const Path& path, const Geometry& geometry) const {
    if (medium_.takes_nothing_of(path)) return 1.0;
    return medium_.unpolarized_power(path, detail::direction_of(geometry.incident),
                                     detail::direction_of(-geometry.scattered));
  }

  /// |Γ|²·|E_i|² of a unit source with the transmitting antenna, the mean over its ports.
  double reflected_power(const Path& path, std::size_t place, const Geometry& geometry,
                         const RadioEnd& transmitter) const {
    const WorldFacet& facet = scene_.facet(path.interactions[place].facet);
    const double cos_incidence = std::min(1.0, std::abs(glm::dot(geometry.incident, facet.plane.normal)));
    const PolarizedCoefficients gamma = surface_.smooth_reflection(facet.material, cos_incidence);
    const std::vector<Vec3> directions(path.interactions.size() + 1, geometry.incident);  // up to `place` it is
    const FieldCarrier<Surface> carrier(scene_, surface_, path, directions);
    const Vec3 theta = theta_hat(geometry.incident), phi = phi_hat(geometry.incident);
    double power = 0.0;
    for (std::size_t port = 0; port < transmitter.antenna.port_count(); ++port) {
      const JonesVector jones = transmitter.antenna.port_jones(geometry.incident, port, transmitter.rotation);
      const auto arriving = carrier.carry(std::array{scaled(theta, jones[0]) + scaled(phi, jones[1])}, 0, place);
      power += norm_squared(reflect(arriving[0], geometry.incident, facet.plane.normal, gamma));
    }
    return power / static_cast<double>(transmitter.antenna.port_count());
  }

  /// What the sheets between the surface and the receiver let pass.
  double passed_power(const Path& path, std::size_t place, const Geometry& geometry) const {
    double passed = 1.0;
    for (std::size_t index = place + 1; index < path.interactions.size(); ++index) {
      const WorldFacet& facet = scene_.facet(path.interactions[index].facet);
      const double cosine = std::min(1.0, std::abs(glm::dot(geometry.scattered, facet.plane.normal)));
      const PolarizedCoefficients through = surface_.response(facet.material, cosine).transmission;
      passed *= 0.5 * (std::norm(through.te) + std::norm(through.tm));
    }
    return passed;
  }

  /// The largest cosine of the angle from the normal for points of a plane that are no nearer than `least_m`.
  static double slant(const Plane& plane, const Vec3& point_m, double least_m) {
    return std::min(1.0, std::abs(signed_distance_m(plane, point_m)) / least_m);
  }

  /// The largest cosine of an angle that may differ by `turn_rad` from the one that has `cosine`.
  static double cosine_within(double cosine, double turn_rad) {
    return std::cos(std::max(0.0, std::acos(std::clamp(cosine, -1.0, 1.0)) - turn_rad));
  }

  static double highest_gain(const Antenna& antenna) {
    return db_to_power_ratio(antenna.gain_dbi) * peak_power_gain(antenna.pattern);
  }

  static double norm_of(const JonesVector& jones) { return std::norm(jones[0]) + std::norm(jones[1]); }

  /// As of any path: [v_tx·k_i − v_rx·k_s + v·(k_s − k_i)]/λ, with the velocity v of the surface at the point.
  double doppler_hz(const Interaction& scattering, const Geometry& geometry, const RadioEnd& transmitter,
                    const RadioEnd& receiver) const {
    const Placement& body = scene_.body_state(scene_.facet(scattering.facet).body).placement;
    const Vec3 velocity_mps = velocity_at(body.velocity, body.pose.position_m, scattering.point_m);
    const double closing_mps = glm::dot(transmitter.velocity_mps, geometry.incident) -
                               glm::dot(receiver.velocity_mps, geometry.scattered) +
                               glm::dot(velocity_mps, geometry.scattered - geometry.incident);
    return closing_mps * (frequency_hz_ / speed_of_light_mps);
  }

  const Scene& scene_;
  const Surface& surface_;
  const Loss& loss_;
  const MediumLoss& medium_;
  double frequency_hz_;
  std::shared_ptr<const ScatteringLimits> limits_;
};

}  // namespace dcem
