#pragma once
/// The folder of reference data that stands beside the repository (scenes, measured lists, tables). It is no part of
/// the project: without it a test says that it skips. Where it was there when the build was configured, nothing may
/// skip.
#include <doctest/doctest.h>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace dcem::test {

/// Whether the folder of reference data is here.
inline bool shared_available() {
  return std::filesystem::is_directory(DCEM_SHARED_DIR);
}

/// The path of a file or folder in the reference data, for example `shared_path("scenes/munich.obj")`.
/// Throws std::runtime_error, which fails the test, when it is not there.
inline std::string shared_path(const std::string& relative_path) {
  const std::filesystem::path path = std::filesystem::path(DCEM_SHARED_DIR) / relative_path;
  if (!std::filesystem::exists(path)) throw std::runtime_error("reference data lacks " + path.string());
  return path.string();
}

}  // namespace dcem::test

#ifdef DCEM_REQUIRE_SHARED
#define DCEM_SKIP_WITHOUT_SHARED() FAIL("the reference data was at " DCEM_SHARED_DIR " and is gone: no test may skip")
#else
#define DCEM_SKIP_WITHOUT_SHARED() MESSAGE("skipped: no reference data at " DCEM_SHARED_DIR)
#endif

/// The first line of a test case that reads reference data: ends it where there is none.
#define DCEM_NEEDS_SHARED()              \
  if (!dcem::test::shared_available()) { \
    DCEM_SKIP_WITHOUT_SHARED();          \
    return;                              \
  }                                      \
  static_assert(true, "asks for a semicolon")
