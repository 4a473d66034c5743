#pragma once
/// For tests of pictures with axes and text, which a build without Cairo does not draw.
#include <doctest/doctest.h>

#include "dcem/io/picture_format.hpp"

#define DCEM_NEEDS_DRAWING()                        \
  if (!dcem::io::can_draw()) {                      \
    MESSAGE("skipped: this build draws no charts"); \
    return;                                         \
  }                                                 \
  static_assert(true, "asks for a semicolon")
