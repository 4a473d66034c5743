#pragma once
/// Checks the frames of a simulation against solutions that share nothing with it but the scene and the formulas.
///
/// 0. The links are those of the devices that are there, and no path is listed twice or above the declared orders.
/// 1. Every reported path is solved again on its own, from its surfaces, with every triangle asked in turn: no tree, no
///    memory of frames before. It must be the same path to the last bit.
/// 2. Where the scene allows exhaustive search, sampled paths are compared with all paths there are: one that is not
///    among them is invalid, and the share of those found is the recall. Paths found by exhaustive search are compared
///    with those that rays find: rays must find nothing else.
/// 3. Where the cache is exact, every link is solved from scratch: it must be the same to the last bit.
#include <memory>

#include "dcem/sim/settings.hpp"
#include "dcem/sim/verify/verification_report.hpp"
#include "dcem/world/frame.hpp"

namespace dcem {

class Scene;
struct FrameResult;

/// Follows a simulation frame by frame.
class Verifier {
 public:
  /// With the scene and the settings of the simulation.
  Verifier(const Scene& scene, const SimulationSettings& settings);
  ~Verifier();
  Verifier(Verifier&&) noexcept;
  Verifier& operator=(Verifier&&) noexcept;

  /// Checks a frame that the simulation has solved.
  void check(const Frame& frame, const FrameResult& result);

  const VerificationReport& report() const;

 private:
  struct Body;
  std::unique_ptr<Body> body_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/sim/verify/verifier_bodies.hpp"
#endif
