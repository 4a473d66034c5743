#pragma once
/// Names inside an SVG. Private to dcem::io.
#include <string>
#include <string_view>

namespace dcem::io {

/// The same SVG with its `id`s numbered in the order in which they stand. Cairo numbers some of them by what a program
/// has drawn before, so that the same picture would have other bytes the second time.
std::string with_own_names(std::string_view svg);

}  // namespace dcem::io
