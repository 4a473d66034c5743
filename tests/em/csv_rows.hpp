#pragma once
/// Rows of numbers from the tables of the reference data.
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/shared_data.hpp"

namespace dcem::test {

/// The rows of a comma-separated table whose cells are all numbers; comments, headings and rows with text are left out.
inline std::vector<std::vector<double>> number_rows(const std::string& relative_path) {
  std::vector<std::vector<double>> rows;
  std::ifstream file(shared_path(relative_path));
  for (std::string line; std::getline(file, line);) {
    std::vector<double> row;
    std::istringstream cells(line);
    bool all_numbers = true;
    for (std::string cell; std::getline(cells, cell, ',');) {
      std::istringstream text(cell);
      double value = 0.0;
      all_numbers = all_numbers && (text >> value) && (text >> std::ws).eof();
      row.push_back(value);
    }
    if (all_numbers && !row.empty()) rows.push_back(row);
  }
  return rows;
}

}  // namespace dcem::test
