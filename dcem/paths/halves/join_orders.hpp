#pragma once
/// How many elements joined sequences have.

namespace dcem {

/// The most mirrors and edges of a sequence, and the most of both together.
struct JoinOrders {
  int reflections = 2, diffractions = 1, interactions = 2;
};

}  // namespace dcem
