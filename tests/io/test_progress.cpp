#include "dcem/io/progress.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "dcem/io/text_table.hpp"

namespace test_progress {

using dcem::io::format_duration;
using dcem::io::progress_line;
using dcem::io::ProgressBar;
using dcem::io::ProgressMode;

TEST_CASE("a duration reads as a clock") {
  CHECK(format_duration(0.0) == "0:00");
  CHECK(format_duration(7.4) == "0:07");
  CHECK(format_duration(59.6) == "1:00");
  CHECK(format_duration(754.0) == "12:34");
  CHECK(format_duration(3599.7) == "1:00:00");
  CHECK(format_duration(36305.0) == "10:05:05");
  CHECK(format_duration(-1.0) == "0:00");
}

TEST_CASE("the time left is what the rest takes at the pace so far") {
  CHECK(progress_line("map", 0, 100, 3.0) == "map  [....................]   0 %  0/100  --:-- left");
  CHECK(progress_line("map", 25, 100, 30.0) == "map  [#####...............]  25 %  25/100  1:30 left");
  CHECK(progress_line("map", 100, 100, 30.0) == "map  [####################] 100 %  100/100  0:00 left");
}

TEST_CASE("100 % stands there only when all is done") {
  CHECK(progress_line("map", 99'999, 100'000, 1.0).find(" 99 %") != std::string::npos);
  CHECK(progress_line("map", 0, 0, 1.0).find("100 %") != std::string::npos);
  // More than was announced: no time left can be told, and nothing wraps around.
  CHECK(progress_line("map", 120, 100, 1.0) == "map  [####################] 100 %  120/100  --:-- left");
}

TEST_CASE("a line never wraps on a console of 80 columns") {
  const std::string label(200, 'x');
  CHECK(dcem::io::character_count(progress_line(label, 5, 1'000'000'000, 1.0)) == 79);
  std::string greek;
  for (int i = 0; i < 100; ++i) greek += "λ";
  CHECK(dcem::io::character_count(progress_line(greek, 5, 10, 1.0)) == 79);
  CHECK(progress_line("", 1ULL << 63U, ~0ULL, 1e300).size() <= 90);
}

TEST_CASE("a bar shows nothing where it was not asked for or where no terminal is") {
  std::ostringstream stream;
  for (const ProgressMode mode : {ProgressMode::never, ProgressMode::automatic}) {
    ProgressBar bar("map", 10, mode, stream);
    bar.advance(10);
    bar.finish();
    CHECK(bar.done() == 10);
  }
  CHECK(stream.str().empty());
}

TEST_CASE("a bar ends in one clean line") {
  std::ostringstream stream;
  {
    ProgressBar bar("map", 10, ProgressMode::always, stream);
    bar.advance(4);
    bar.advance(6);
    bar.finish();
    bar.finish();
  }
  const std::string text = stream.str();
  CHECK(std::count(text.begin(), text.end(), '\n') == 1);
  CHECK(text.back() == '\n');
  std::string last = text.substr(text.rfind('\r') + 1);
  const std::string drawn = text.substr(1, text.find('\r', 1) - 1);
  CHECK(last.size() == drawn.size() + 1);  // blanks cover the longer line before
  last.erase(last.find_last_not_of(" \n") + 1);
  CHECK(last == "map: 10 of 10 in 0:00");
}

TEST_CASE("work that was cut short says how far it came") {
  std::ostringstream stream;
  { ProgressBar(std::string("map"), 10, ProgressMode::always, stream).advance(4); }
  CHECK(stream.str().find("map: stopped at 4 of 10 after 0:00") != std::string::npos);
}

TEST_CASE("many threads: every piece counts, and the line is drawn at most ten times a second") {
  std::ostringstream stream;
  const auto start = std::chrono::steady_clock::now();
  {
    ProgressBar bar("map", 400'000, ProgressMode::always, stream);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&bar] {
        for (int i = 0; i < 100'000; ++i) bar.advance();
      });
    }
    for (std::thread& thread : threads) thread.join();
    CHECK(bar.done() == 400'000);
  }
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string text = stream.str();
  // One at the start, one per tenth of a second, one at the end.
  CHECK(static_cast<double>(std::count(text.begin(), text.end(), '\r')) <= 10.0 * elapsed_s + 2.0);
}

TEST_CASE("for programs progress is one object a line") {
  CHECK(dcem::io::progress_json("frames", 3, 100, 1.5) ==
        R"({"stage":"frames","done":3,"total":100,"elapsed_s":1.500,"remaining_s":48.500})");
  CHECK(dcem::io::progress_json("frames", 0, 100, 1.5) ==
        R"({"stage":"frames","done":0,"total":100,"elapsed_s":1.500,"remaining_s":null})");
  CHECK(dcem::io::progress_json("search", 7, {}, 0.0) ==
        R"({"stage":"search","done":7,"total":null,"elapsed_s":0.000,"remaining_s":null})");
  std::ostringstream stream;
  {
    ProgressBar bar("frames", 5, ProgressMode::json, stream);
    CHECK(stream.str().starts_with(R"({"stage":"frames","done":0,"total":5,)"));  // before anything is done
    bar.advance(2);
    CHECK(stream.str().find(R"("done":2,"total":5,)") != std::string::npos);  // the first piece is told at once
    bar.advance(3);
  }
  const std::string text = stream.str();
  CHECK(text.find('\r') == std::string::npos);
  CHECK(text.find(R"({"stage":"frames","done":5,"total":5,)", text.rfind('{')) != std::string::npos);
  CHECK(text.ends_with("}\n"));
  CHECK(std::count(text.begin(), text.end(), '\n') == 3);  // what is told at once is not told again at the end
  CHECK(dcem::io::warning_json("a \"b\"\n\xff") == "{\"warning\":\"a \\\"b\\\"\\n\xef\xbf\xbd\"}");
}

TEST_CASE("a stage of unknown length is shown from its start, and gone at its end") {
  std::ostringstream people, programs, nobody;
  {
    const dcem::io::ProgressStage shown("reading", ProgressMode::always, people);
    const dcem::io::ProgressStage told("reading", ProgressMode::json, programs);
    const dcem::io::ProgressStage hidden("reading", ProgressMode::never, nobody);
    CHECK(people.str() == "\rreading ...  0:00");
    CHECK(programs.str().starts_with(R"({"stage":"reading","done":0,"total":1,)"));
  }
  CHECK(people.str().ends_with("\r" + std::string(17, ' ') + "\r"));
  CHECK(programs.str().ends_with(",\"remaining_s\":0.000}\n"));
  const std::string lines = programs.str();
  CHECK(std::count(lines.begin(), lines.end(), '\n') == 2);
  CHECK(nobody.str().empty());
}

}  // namespace test_progress
