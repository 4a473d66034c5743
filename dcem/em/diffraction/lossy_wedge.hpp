#pragma once
/// Which of the published ways a lossy wedge is computed.
#include <cstdint>

namespace dcem {

/// How the reflection of lossy faces enters the coefficient. All agree for a perfect conductor.
enum class LossyWedge : std::uint8_t {
  holm_reciprocal,  ///< Holm 2000, El-Sallabi & Vainikainen 2005, with angles as in `reciprocal`: best in the shadow
  reciprocal,       ///< azimuths min(φ, φ') and min(nπ − φ, nπ − φ')
  luebbers84        ///< azimuth φ' at the face nearer to the source, nπ − φ at the other; not reciprocal
};

}  // namespace dcem
