#include "command_options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "dcem/core/instruction_set.hpp"
#include "dcem/io/known_names.hpp"
#include "dcem/io/picture_format.hpp"

namespace dcem::program {
namespace {

const std::map<std::string, io::ProgressMode> progress_modes{{"auto", io::ProgressMode::automatic},
                                                             {"always", io::ProgressMode::always},
                                                             {"never", io::ProgressMode::never},
                                                             {"json", io::ProgressMode::json}};
const std::map<std::string, io::UpAxis> up_axes{{"y", io::UpAxis::y}, {"z", io::UpAxis::z}};
const std::map<std::string, InstructionSet> instruction_sets{
    {"baseline", InstructionSet::baseline}, {"avx2", InstructionSet::avx2}, {"avx512", InstructionSet::avx512}};
const std::vector<std::string> run_outputs{"paths", "links", "pdp",      "cfr", "doppler", "npz",   "mat", "hdf5",
                                           "qd",    "p2m",   "deepmimo", "kml", "gltf",    "plots", "html"};
const std::vector<std::string> map_outputs{"csv", "png", "npz", "asc", "svg", "pdf", "kml", "html"};

// An option that takes one of a few words.
template <typename Value>
CLI::Option* add_choice(CLI::App& command, const std::string& name, const std::string& does,
                        const std::map<std::string, Value>& choices, Value& chosen) {
  std::vector<std::string> words;
  for (const auto& choice : choices) words.push_back(choice.first);
  return command
      .add_option_function<std::string>(
          name, [&](const std::string& word) { chosen = choices.at(word); }, does)
      ->check(CLI::IsMember(words));
}

void choose_instructions(const std::string& word) {
  try {
    select_instruction_set(instruction_sets.at(word));
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what(), "a level that this processor has");
  }
}

const std::vector<std::string> picture_formats{"png", "svg", "pdf"};

std::string comma_list(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

/// An option or an argument that is the name of a file or folder: an empty one is a slip, as of a variable of the shell
/// that is not set, and must not stand for a default.
template <typename Names>
CLI::Option* add_name(CLI::App& command, const std::string& name, Names& names, const std::string& does) {
  const auto check = [name](const std::string& text) {
    if (text.empty()) throw UsageError(name + ": an empty name", "the name of a file or folder");
    return std::string();
  };
  return command.add_option(name, names, does)->check(check);
}

/// Reads the whole text as a number; otherwise says why that does not go.
template <typename Number>
std::errc parse_all(std::string_view text, Number& number) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc{} && end != text.data() + text.size()) return std::errc::invalid_argument;
  return error;
}

/// An option with a whole number. In which range it must be, the reader of scenarios says.
template <typename Number>
CLI::Option* add_whole_number(CLI::App& command, const std::string& name, std::optional<Number>& number,
                              const std::string& does) {
  const auto take = [name, &number](const std::string& text) {
    const std::errc error = parse_all(text, number.emplace());
    if (error == std::errc{}) return;
    const bool is_long = error == std::errc::result_out_of_range;
    throw UsageError(name + ": found '" + text + "'",
                     is_long ? "a whole number of at most 18 digits" : "a whole number");
  };
  return command.add_option_function<std::string>(name, take, does);
}

/// A number of bytes, or with K, M or G behind it of so many times 1024, 1024² or 1024³ of them.
double parse_bytes(const std::string& text) {
  constexpr double most = 1e18;
  double bytes = 0.0;
  std::size_t digits = 0;
  for (; digits < text.size() && text[digits] >= '0' && text[digits] <= '9'; ++digits) {
    bytes = 10.0 * bytes + (text[digits] - '0');
  }
  const std::map<std::string, double> suffixes{
      {"", 1.0}, {"K", 1024.0}, {"M", 1024.0 * 1024.0}, {"G", 1024.0 * 1024.0 * 1024.0}};
  const auto suffix = suffixes.find(text.substr(digits));
  if (suffix != suffixes.end()) bytes *= suffix->second;
  if (digits > 0 && suffix != suffixes.end() && bytes >= 1.0 && bytes <= most) return bytes;
  throw UsageError("--memory-limit " + text + ": no amount of memory",
                   "a number of bytes from 1, with K, M or G of 1024, 1024^2 or 1024^3 bytes, as in 512M");
}

/// Part i of N, from 0.
ReceiverPart parse_shard(const std::string& text) {
  constexpr std::uint32_t most = 1'000'000;
  ReceiverPart part{0, 0};
  const char* const end = text.data() + text.size();
  const auto number = std::from_chars(text.data(), end, part.part);
  const bool has_slash = number.ec == std::errc{} && number.ptr != end && *number.ptr == '/';
  const auto count = has_slash ? std::from_chars(number.ptr + 1, end, part.of) : number;
  if (has_slash && count.ec == std::errc{} && count.ptr == end && part.part < part.of && part.of <= most) return part;
  throw UsageError("--shard " + text + ": no part of a run", "i/N with 0 <= i < N <= " + std::to_string(most));
}

/// HZ[,HZ…]; none twice.
std::vector<double> parse_frequencies(const std::string& text) {
  std::vector<double> all_hz;
  for (const std::string& word : words_of(text)) {
    double frequency_hz = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), frequency_hz);
    const bool is_number = error == std::errc{} && end == word.data() + word.size() && std::isfinite(frequency_hz);
    if (!is_number || std::ranges::count(all_hz, frequency_hz) > 0) {
      throw UsageError("--frequency " + text + ": no frequencies", "numbers in Hz, none twice, as in 5.89e9,30e9");
    }
    all_hz.push_back(frequency_hz);
  }
  return all_hz;
}

void choose_frequencies(const std::string& text, ScenarioOptions& options) {
  options.frequencies_hz = parse_frequencies(text);
  if (options.frequencies_hz.size() > 1) return;
  options.overrides.frequency_hz = options.frequencies_hz.at(0);
  options.frequencies_hz.clear();
}

void add_resources(CLI::App& command, std::optional<unsigned>& threads, std::optional<double>& memory_limit_bytes) {
  const auto take = [&threads](const std::string& text) {
    unsigned count = 0;
    if (parse_all(text, count) != std::errc{} || count < 1 || count > 4096) {
      throw UsageError("--threads: found '" + text + "'", "a whole number from 1 to 4096");
    }
    threads = count;
  };
  command
      .add_option_function<std::string>(
          "--threads", take, "Number of threads, from 1 to 4096 (default: all cores); never changes a result")
      ->type_name("N");
  command
      .add_option_function<std::string>(
          "--memory-limit", [&](const std::string& text) { memory_limit_bytes = parse_bytes(text); },
          "Refuse what is foreseen to take more (K, M and G: 1024 each; default: the machine's memory): grids, lists, "
          "links "
          "and maps before anything is computed, paths.npz as soon as its paths are too many; not every byte is "
          "foreseen. Half of it may hold what receivers see from frame to frame; beyond, that is worked out anew")
      ->type_name("BYTES");
}

void add_progress(CLI::App& command, io::ProgressMode& mode, bool& quiet) {
  CLI::Option* progress =
      add_choice(command, "--progress",
                 "Progress on the error stream: a bar, auto (on a terminal), always or never; or json, lines "
                 "with stage, done, total, elapsed_s, remaining_s",
                 progress_modes, mode);
  progress->type_name("WHEN");
  command.add_flag("--quiet", quiet, "No table, no progress and no warnings")->excludes(progress);
}

void add_common_options(CLI::App& command, ScenarioOptions& options) {
  add_name(command, "scenario", options.scenario, "The scenario file (JSON)")->required()->type_name("SCENARIO.json");
  add_resources(command, options.threads, options.memory_limit_bytes);
  command.add_option("--frames", options.frames, "Only the frames A to B - 1")->type_name("A:B");
  command
      .add_option_function<std::string>(
          "--frequency", [&](const std::string& text) { choose_frequencies(text, options); },
          "Carrier frequency in place of the scenario's; of several, results in a folder for each (5.89GHz, 30GHz)")
      ->type_name("HZ[,HZ...]");
  command.add_option("--discovery", options.overrides.discovery, "How paths are found: exact or sampled")
      ->check(CLI::IsMember({"exact", "sampled"}))
      ->type_name("MODE");
  add_whole_number(command, "--rays", options.overrides.rays, "Rays per receiver; for sampled discovery alone")
      ->type_name("N");
  add_whole_number(command, "--seed", options.overrides.seed,
                   "Turns the sphere of rays, and draws seeded phases; for sampled discovery and diffuse power alone")
      ->type_name("S");
  command
      .add_option_function<std::string>("--instructions", choose_instructions,
                                        "Instructions that trace rays and join paths (default: the best that the "
                                        "processor has); never changes a result")
      ->check(CLI::IsMember({"baseline", "avx2", "avx512"}))
      ->type_name("LEVEL");
  add_progress(command, options.progress, options.quiet);
}

void add_cache_option(CLI::App& command, ScenarioOptions& options) {
  command
      .add_option("--cache", options.overrides.cache,
                  "What is remembered between frames: off, seed (with sampled discovery) or exact")
      ->check(CLI::IsMember({"off", "seed", "exact"}))
      ->type_name("MODE");
}

void add_folder_option(CLI::App& command, std::string& folder, const std::string& absent) {
  add_name(command, "-o", folder, "Folder for the results (default: " + absent + ")")->type_name("DIR");
}

/// One of the words of an option that takes some, divided by commas; they stand in the help and in completions.
std::string list_type(const std::vector<std::string>& words) {
  std::string type = "KEY[,KEY...]:{";
  for (const std::string& word : words) type += (type.back() == '{' ? "" : ",") + word;
  return type + '}';
}

}  // namespace

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
    end = list.find(',', begin);
    words.push_back(CLI::detail::trim_copy(list.substr(begin, end == std::string::npos ? end : end - begin)));
  }
  return words;
}

namespace {

/// Throws UsageError for a word that is none of the known ones, or that is there twice.
void require_outputs(const std::string& list, const std::vector<std::string>& known, const std::string& command) {
  const std::vector<std::string> words = words_of(list);
  for (const std::string& word : words) {
    if (std::ranges::find(known, word) == known.end()) {
      throw UsageError("--output: '" + word + "' is no file of 'dcem " + command + "'" + io::name_hint(word, known),
                       "some of " + comma_list(known));
    }
    if (std::ranges::count(words, word) > 1) {
      throw UsageError("--output " + list + ": '" + word + "' is there twice", "each word once");
    }
  }
}

}  // namespace

void add_run_options(CLI::App& command, ScenarioOptions& options) {
  add_common_options(command, options);
  add_cache_option(command, options);
  add_folder_option(command, options.folder, "out/<scenario name>");
  const auto choose = [&](const std::string& list) {
    require_outputs(list, run_outputs, "run");
    options.overrides.output = list;
  };
  command
      .add_option_function<std::string>("--output", choose,
                                        "Result files, in place of those that the scenario asks for")
      ->type_name(list_type(run_outputs));
  command
      .add_option_function<std::string>(
          "--shard", [&](const std::string& text) { options.shard = parse_shard(text); },
          "Only part i of N, from 0: the links of some of the receivers; 'dcem merge' makes one result of all parts")
      ->type_name("i/N");
  command.add_flag("--resume", options.resume,
                   "Go on with a run that was ended; scenario and options must be those of that run");
}

void add_merge_options(CLI::App& command, MergeOptions& options) {
  add_name(command, "shards", options.shards, "The folders of 'dcem run --shard i/N', one for each i, in any order")
      ->required()
      ->type_name("SHARD...");
  add_folder_option(command, options.folder, "out/<scenario name>");
  add_name(command, "--scenario", options.scenario,
           "Where the scenario of the parts is now (default: where it was when they were run)")
      ->type_name("SCENARIO.json");
  add_resources(command, options.threads, options.memory_limit_bytes);
  add_progress(command, options.progress, options.quiet);
}

void add_map_options(CLI::App& command, ScenarioOptions& options) {
  add_common_options(command, options);
  add_folder_option(command, options.folder, "out/<scenario name>");
  const auto choose = [&](const std::string& list) {
    require_outputs(list, map_outputs, "map");
    options.map_output = list;
  };
  command
      .add_option_function<std::string>("--output", choose,
                                        "Files of each map, in place of those that the scenario asks for")
      ->type_name(list_type(map_outputs));
}

void add_verify_options(CLI::App& command, ScenarioOptions& options) {
  add_common_options(command, options);
  add_cache_option(command, options);
}

/// Adds an option for a number above 0, up to `most`, which reads `most_text`.
template <typename Number>
CLI::Option* add_number_above_zero(CLI::App& command, const std::string& name, const std::string& does, Number& value,
                                   double most, const std::string& most_text) {
  const auto take = [&value, name, most, most_text](const std::string& text) {
    double number = 0.0;
    const bool is_number = CLI::detail::lexical_cast(text, number) && number > 0.0 && number <= most;
    if (!is_number) throw UsageError(name + ": found " + text, "a number above 0, at most " + most_text);
    value = number;
  };
  return command.add_option_function<std::string>(name, take, does);
}

void add_inspect_options(CLI::App& command, InspectOptions& options) {
  add_name(command, "scene", options.obj, "The scene (OBJ)")->required()->type_name("SCENE.obj");
  command.add_flag("--json", options.json, "JSON instead of tables");
  add_choice(command, "--up", "The file's axis that points up: y or z (default: z)", up_axes, options.settings.obj.up)
      ->type_name("AXIS");
  add_number_above_zero(command, "--unit-m", "Length of one file unit in metres (default: 1)",
                        options.settings.obj.unit_m, 1e6, "1e6 m")
      ->type_name("X");
  add_number_above_zero(command, "--frequency-hz", "Evaluate the materials at this frequency",
                        options.settings.frequency_hz, 1e15, "1e15 Hz")
      ->type_name("F");
}

void add_compare_options(CLI::App& command, CompareOptions& options) {
  add_name(command, "first", options.first, "A map (CSV)")->required()->type_name("A.csv");
  add_name(command, "second", options.second, "The map it is compared with (CSV)")->required()->type_name("B.csv");
  add_folder_option(command, options.folder, "out/compare");
  command
      .add_option_function<std::string>(
          "--output",
          [&](const std::string& list) {
            require_outputs(list, picture_formats, "compare");
            options.formats = words_of(list);
          },
          "Formats of the pictures (default: svg)")
      ->type_name(list_type(picture_formats));
  command.add_option("--column", options.column, "The power to compare (default: power_incoherent_dbm)")
      ->type_name("NAME");
  command.add_option("--second-column", options.second_column, "Its name in the second file, where that differs")
      ->type_name("NAME");
}

namespace {

/// In which range it must be, the importer says.
template <typename Number>
CLI::Option* add_number(CLI::App& command, const std::string& name, const std::string& does, Number& number) {
  const auto take = [name, &number](const std::string& text) {
    double value = 0.0;
    if (parse_all(text, value) != std::errc{} || !std::isfinite(value)) {
      throw UsageError(name + ": found '" + text + "'", "a number");
    }
    number = value;
  };
  return command.add_option_function<std::string>(name, take, does);
}

void add_length_option(CLI::App& command, const std::string& name, const std::string& does, double& value,
                       const std::string& unit = "M") {
  add_number(command, name, does, value)->type_name(unit);
}

void add_import_sizes(CLI::App& command, io::ImportSettings& settings) {
  add_length_option(command, "--default-height-m", "Height of buildings that do not say theirs (default: 9)",
                    settings.default_height_m);
  add_length_option(command, "--level-height-m", "Height of a storey (default: 3)", settings.level_height_m);
  add_length_option(command, "--tree-height-m", "Height of forests that do not say theirs (default: 12)",
                    settings.tree_height_m);
  add_length_option(command, "--ground-margin-m", "Ground around everything (default: 50)", settings.ground_margin_m);
  add_length_option(command, "--snap-tolerance-m", "Houses no further apart touch (default: 0.1)",
                    settings.snap_tolerance_m);
  add_length_option(command, "--smallest-house-sqm", "Smaller footprints are left out (default: 1)",
                    settings.smallest_house_m2, "M2");
  add_number(command, "--frequency-hz",
             "Carrier frequency of the scenario (default: 5.9e9; gemv2: that of its links; sionna: 3.5e9)",
             settings.frequency_hz)
      ->type_name("F");
}

}  // namespace

void add_import_options(CLI::App& command, ImportOptions& options) {
  command
      .add_option(
          "kind", options.kind,
          "What it is: sumo (a .sumocfg or .net.xml), gemv2 (a folder), sionna (a scene of Mitsuba, .xml) or osm "
          "(.osm, .osm.gz, .pbf)")
      ->required()
      ->check(CLI::IsMember({"sumo", "gemv2", "sionna", "osm"}))
      ->type_name("KIND");
  add_name(command, "source", options.source, "The file or folder to import")->required()->type_name("FILE");
  add_name(command, "-o", options.folder, "Folder for the scene and the scenario")->required()->type_name("DIR");
  add_name(command, "--poly", options.polygons, "sumo: polygons of buildings (.poly.xml)")->type_name("FILE");
  add_name(command, "--fcd", options.trace, "sumo: the trace of vehicles; the scenario refers to it")
      ->type_name("FILE");
  add_name(command, "--additional", options.additional,
           "sumo: further files, with types of vehicles or polygons; may stand several times")
      ->type_name("FILE");
  command
      .add_option(
          "--touching", options.touching,
          "Houses that touch share no wall: union makes one of those of the same height, snap leaves each its roof")
      ->check(CLI::IsMember({"union", "snap"}))
      ->type_name("MODE");
  add_import_sizes(command, options.settings);
  command
      .add_option_function<std::string>(
          "--terrain",
          [&](const std::string& file) {
            if (file.empty()) throw UsageError("--terrain: an empty name", "the name of a file");
            options.settings.terrain = file;
          },
          "Heights of the ground, an ASCII grid of ESRI in UTM (default: flat); not for sionna")
      ->type_name("FILE");
  command.add_flag("--quiet", options.quiet, "No report on the screen; report.json has it");
  command.parse_complete_callback([&command, &options] {
    for (const CLI::Option* option : command.get_options([](const CLI::Option* one) { return one->count() > 0; })) {
      options.given.push_back(option->get_name());
    }
  });
}

void add_keys_options(CLI::App& command, KeysOptions& options) {
  command.add_option("word", options.word, "Only keys whose path or meaning holds this")->type_name("WORD");
  command.add_flag("--markdown", options.markdown, "All of them as a page in Markdown")->excludes("word");
}

}  // namespace dcem::program
