#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <ostream>

#include "tests/support/last_command.hpp"

namespace {

/// Where an assertion fails, tells what the last program has said.
class CommandReporter : public doctest::IReporter {
 public:
  explicit CommandReporter(const doctest::ContextOptions& options) : out_(*options.cout) {}

  void log_assert(const doctest::AssertData& assertion) override {
    const dcem::test::LastCommand& last = dcem::test::last_command();
    if (!assertion.m_failed || last.line.empty()) return;
    out_ << "  last command: " << last.line << "\n  exit code " << last.exit_code << ", it said: " << last.error
         << '\n';
  }
  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats&) override {}
  void test_case_start(const doctest::TestCaseData&) override { dcem::test::last_command() = {}; }
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_end(const doctest::CurrentTestCaseStats&) override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}

 private:
  std::ostream& out_;
};

}  // namespace

REGISTER_LISTENER("commands", 1, CommandReporter);
