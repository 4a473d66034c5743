#pragma once
/// Bodies of verifier.hpp.
#include "dcem/core/build_mode.hpp"
#include "dcem/sim/detail/material_table_of.hpp"
#include "dcem/sim/verify/basic_verifier.hpp"
#include "dcem/sim/verify/verifier.hpp"

namespace dcem {

struct Verifier::Body {
  BasicVerifier<MaterialTable> verifier;
};

DCEM_INLINE Verifier::Verifier(const Scene& scene, const SimulationSettings& settings)
    : body_(new Body{{scene, settings, detail::material_table_of(scene, settings)}}) {}
DCEM_INLINE Verifier::~Verifier() = default;
DCEM_INLINE Verifier::Verifier(Verifier&&) noexcept = default;
DCEM_INLINE Verifier& Verifier::operator=(Verifier&&) noexcept = default;

DCEM_INLINE void Verifier::check(const Frame& frame, const FrameResult& result) {
  body_->verifier.check(frame, result);
}

DCEM_INLINE const VerificationReport& Verifier::report() const {
  return body_->verifier.report();
}

}  // namespace dcem
