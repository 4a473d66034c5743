#pragma once
/// Named surface materials: a closed set of models, chosen at run time because one scene mixes them.
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "dcem/em/surface/effective_roughness.hpp"

namespace dcem {

/// Perfect electric conductor: R_te = −1, R_tm = +1, nothing passes.
struct PerfectConductor {
  friend bool operator==(const PerfectConductor&, const PerfectConductor&) = default;
};

/// An engineering surface with one amplitude at every angle: R_te = −ρ, R_tm = +ρ (the phase of a perfect conductor,
/// so ρ = 1 is one), and T = 10^(−loss/20) for both polarizations without a phase beyond that of the straight path.
struct ConstantReflection {
  double reflection_amplitude = 1.0;          ///< ρ in 0…1, of the field: ρ = 0.8 loses 1.94 dB
  std::optional<double> penetration_loss_db;  ///< of one crossing, ≥ 0; absent: opaque

  friend bool operator==(const ConstantReflection&, const ConstantReflection&) = default;
};

/// A homogeneous non-magnetic medium, the same numbers at every frequency.
struct Dielectric {
  double relative_permittivity = 1.0;   ///< ε' ≥ 1
  double conductivity_s_per_m = 0.0;    ///< σ ≥ 0
  std::optional<double> thickness_m{};  ///< > 0: a slab; absent: a half space, opaque

  friend bool operator==(const Dielectric&, const Dielectric&) = default;
};

/// A material of the table of ITU-R P.2040 (em/surface/itu_p2040.hpp), by its canonical name, e.g. "concrete".
struct ItuMaterial {
  std::string name;
  std::optional<double> thickness_m{};  ///< > 0: a slab; absent: a half space, opaque

  friend bool operator==(const ItuMaterial&, const ItuMaterial&) = default;
};

/// One layer of a wall: a medium with its thickness, which must be there.
using MaterialLayer = std::variant<Dielectric, ItuMaterial>;

/// Layers one behind the other, between air and air (em/surface/multilayer.hpp). Surfaces are two-sided sheets without
/// a front: whichever side a wave comes from, it meets the first layer first. The transmission does not depend on that
/// order, nor does the reflected power where nothing is lost.
struct Multilayer {
  std::vector<MaterialLayer> layers;  ///< at least one

  friend bool operator==(const Multilayer&, const Multilayer&) = default;
};

/// Leaves and twigs: no surface that reflects, but a loss for every metre inside. A closed shell of it is a tree or a
/// hedge; paths go straight through, and what they lose is counted on their length inside.
struct Foliage {
  std::optional<double> attenuation_db_per_m{};  ///< ≥ 0; absent: by frequency (em/medium/foliage.hpp)

  friend bool operator==(const Foliage&, const Foliage&) = default;
};

class UserSurfaceModel;

/// A model of the caller's own (em/surface/user_surface.hpp).
struct UserSurface {
  std::shared_ptr<const UserSurfaceModel> model;  ///< must be there
  bool transmits = false;                         ///< paths may cross the surface

  friend bool operator==(const UserSurface&, const UserSurface&) = default;
};

using MaterialModel =
    std::variant<PerfectConductor, ConstantReflection, Dielectric, ItuMaterial, Multilayer, Foliage, UserSurface>;

struct Material {
  std::string name;
  MaterialModel model;
  /// Standard deviation of the surface height, ≥ 0; 0: smooth. It reduces what is reflected (em/surface/roughness.hpp,
  /// Ament), with every model; what passes is not changed.
  double roughness_rms_m = 0.0;
  /// Diffuse scattering; the mirror keeps √(1 − S²). Not together with a roughness: both would take the same power.
  Scattering scattering{};

  friend bool operator==(const Material&, const Material&) = default;
};

namespace detail {

bool model_transmits(const ItuMaterial& model);
bool model_transmits(const Multilayer& model);

}  // namespace detail

/// Whether paths may cross a surface of this material. A constant surface: if it has a penetration loss. A dielectric
/// and an ITU material: if it has a thickness. A multilayer: always, but for layers of metal. A perfect conductor
/// never, and the ITU's "metal" never either, whatever its thickness: its skin depth is 5 µm at 1 GHz and 0.5 µm at 100
/// GHz, so that no wall or car body lets anything through that a double could hold.
bool transmits(const Material& material);

bool is_foliage(const Material& material);

/// Whether a surface of this material scatters at all.
bool scatters(const Material& material);

/// Names of the ITU materials that a material is made of, each once: one for an ITU material, those of the layers of a
/// multilayer, none for the other models. Their tables limit the frequencies at which it may be used.
std::vector<std::string> itu_names(const Material& material);

/// Throws std::invalid_argument, naming the material, when a number is not finite or out of range: amplitude outside
/// 0…1, loss < 0, ε' < 1, σ < 0, thickness ≤ 0, ρ² + 10^(−loss/10) > 1, roughness < 0, a name that no table of the ITU
/// holds, no layer at all or one without a thickness, a scattering that validate() refuses, scattering and roughness
/// both.
void validate(const Material& material);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/em/surface/material_bodies.hpp"
#endif
