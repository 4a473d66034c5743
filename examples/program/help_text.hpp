#pragma once
/// `--help` in lines that fit a terminal.
#include <CLI/CLI.hpp>
#include <string>

namespace dcem::program {

/// Lays out descriptions in a column of their own, broken between words.
class HelpText : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override;
  std::string make_subcommand(const CLI::App* command) const override;
};

}  // namespace dcem::program
