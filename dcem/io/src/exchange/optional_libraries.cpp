#include "dcem/io/optional_libraries.hpp"

#include "dcem/io/src/exchange/column_file.hpp"
#include "dcem/io/src/exchange/mat_writer.hpp"
#include "dcem/io/src/geo/utm.hpp"

namespace dcem::io {

std::string exchange_libraries() {
  return (can_write_mat() ? mat_library() : "no matio") + ", " + (can_write_hdf5() ? column_library() : "no HDF5") +
         ", " + utm_library();
}

}  // namespace dcem::io
