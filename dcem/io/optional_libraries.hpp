#pragma once
/// What the libraries that DCEM can do without bring to this build. A scenario that asks for more is refused.
#include <string>
#include <string_view>

namespace dcem::io {

/// Whether `paths.mat` can be written.
bool can_write_mat();

/// What is said where a file is wanted that this build cannot write, and what was expected.
inline constexpr std::string_view no_mat = "this build writes no MAT files";
inline constexpr std::string_view mat_expected = "matio (libmatio-dev) when DCEM was built";

/// Whether `paths.h5` can be written.
bool can_write_hdf5();

inline constexpr std::string_view no_hdf5 = "this build writes no HDF5 files";
inline constexpr std::string_view hdf5_expected = "HDF5 (libhdf5-dev) when DCEM was built";

/// One line for `dcem --version`: "matio 1.5.23, no HDF5, GeographicLib 2.1.2".
std::string exchange_libraries();

}  // namespace dcem::io
