#include "every_header.hpp"

bool second_unit_agrees(double (*function)(double));

bool second_unit_agrees(double (*function)(double)) {
  return function == &dcem::power_ratio_to_db;
}
