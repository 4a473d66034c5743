/// Two translation units include every header: a function that is neither inline nor a template would be defined twice
/// and the program would not link. Both see the same definition, so its address is the same in both.
#include "every_header.hpp"

bool second_unit_agrees(double (*function)(double));

int main() {
  return second_unit_agrees(&dcem::power_ratio_to_db) ? 0 : 1;
}
