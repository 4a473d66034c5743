#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dcem/io/antenna_files.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/antenna/pattern_cuts.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

/// Gain of a half-wave dipole as these files count it, dBi.
constexpr double dbd_in_dbi = 2.15;
constexpr NumberRange any_gain{-100.0, 100.0}, any_attenuation_db{0.0, 200.0}, any_value{-200.0, 100.0};
constexpr NumberRange any_cut_angle_deg{-360.0, 360.0};

std::string upper_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  return result;
}

/// Lines of a file, with what an error needs.
class Lines {
 public:
  Lines(std::string name, std::string_view text) : name_(std::move(name)), lines_(text) {}

  /// The next line that is not blank; false at the end, which old files mark with a control character.
  bool next() {
    while (lines_.next()) {
      if (!line().empty() && line() != "\x1A") return true;
    }
    return false;
  }
  std::string_view line() const { return trimmed(lines_.line()); }
  std::size_t number() const { return lines_.number(); }
  const std::string& name() const { return name_; }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(name_, number(), what); }

  double number(const std::string& key, std::string_view text, const NumberRange& range) const {
    const std::optional<double> value = parse_number(trimmed(text));
    if (!value || !range.holds(*value)) fail(key + ": found " + in_quotes(text) + "; expected " + range.text());
    return *value;
  }

 private:
  std::string name_;
  LineReader lines_;
};

class MsiReader {
 public:
  MsiReader(std::string name, std::string_view text) : lines_(std::move(name), text) {}

  PatternTable read() {
    while (lines_.next()) {
      std::string_view rest = lines_.line();
      const std::string key = upper_case(take_word(rest));
      if (key == "GAIN") read_gain(rest);
      if (key == "HORIZONTAL") read_cut(key, rest, horizontal_);
      if (key == "VERTICAL") read_cut(key, rest, vertical_);
      if ((horizontal_ || vertical_) && parse_number(key)) {
        lines_.fail("found " + in_quotes(lines_.line()) + "; expected as many points as HORIZONTAL and VERTICAL say");
      }
    }
    require(gain_dbi_.has_value(), "GAIN");
    require(horizontal_.has_value(), "HORIZONTAL");
    require(vertical_.has_value(), "VERTICAL");
    return table_from_cuts(*gain_dbi_, *horizontal_, *vertical_);
  }

 private:
  void require(bool there, const std::string& key) const {
    if (there) return;
    throw InputError(lines_.name(), "no line " + key +
                                        "; expected an MSI file with GAIN, HORIZONTAL and VERTICAL, or " +
                                        "an NSMA WG16.99.050 file with PATCUT");
  }

  /// "12.5", "12.5 dBd", "14.65 dBi"; without a unit dBd.
  void read_gain(std::string_view text) {
    if (gain_dbi_) lines_.fail("GAIN: there twice; expected it once");
    text = trimmed(text);
    const std::string unit = upper_case(text.substr(text.size() - std::min<std::size_t>(text.size(), 3)));
    const bool has_unit = unit == "DBD" || unit == "DBI";
    if (has_unit) text.remove_suffix(3);
    gain_dbi_ = lines_.number("GAIN", text, any_gain) + (unit == "DBI" ? 0.0 : dbd_in_dbi);
  }

  void read_cut(const std::string& key, std::string_view rest, std::optional<PatternCut>& cut) {
    if (cut) lines_.fail(key + ": there twice; expected it once");
    const std::optional<long long> count = parse_integer(trimmed(rest));
    if (!count || *count < 1 || *count > 1'000'000) {
      lines_.fail(key + ": found " + in_quotes(trimmed(rest)) + "; expected the number of its points");
    }
    std::vector<PatternCut::Point> points;
    while (static_cast<long long>(points.size()) < *count) {
      if (!lines_.next()) {
        throw InputError(lines_.name(), key + ": ends after " + std::to_string(points.size()) + " points; expected " +
                                            std::to_string(*count));
      }
      points.push_back(read_point(key));
    }
    cut.emplace(lines_.name(), key, std::move(points));
  }

  PatternCut::Point read_point(const std::string& key) const {
    std::string_view rest = lines_.line();
    const std::string_view angle = take_word(rest), attenuation = take_word(rest);
    if (attenuation.empty() || !trimmed(rest).empty()) {
      lines_.fail(key + ": found " + in_quotes(lines_.line()) + "; expected an angle and an attenuation");
    }
    return {lines_.number(key + ": angle", angle, any_cut_angle_deg),
            lines_.number(key + ": attenuation", attenuation, any_attenuation_db), lines_.number()};
  }

  Lines lines_;
  std::optional<double> gain_dbi_;
  std::optional<PatternCut> horizontal_, vertical_;
};

class NsmaReader {
 public:
  NsmaReader(std::string name, std::string_view text) : lines_(std::move(name), text) {}

  static bool recognizes(std::string_view text) {
    for (LineReader lines(text); lines.next();) {
      const std::string line = upper_case(trimmed(lines.line()).substr(0, 7));
      if (line == "PATCUT:" || line == "REVNUM:") return true;
    }
    return false;
  }

  PatternTable read() {
    while (lines_.next()) {
      const std::size_t colon = lines_.line().find(':');
      colon == std::string_view::npos ? add_point() : read_field(colon);
    }
    const double gain_dbi = in_dbi(gain_unit_, require(gain_, "MDGAIN"));
    const auto [horizontal, vertical] = choose_cuts();
    return table_from_cuts(gain_dbi, cut_of(*horizontal, 1.0, gain_dbi), cut_of(*vertical, -1.0, gain_dbi));
  }

 private:
  /// A cut as it stands in the file.
  struct Cut {
    std::string plane;         ///< AZ, H, EL or V
    std::string polarization;  ///< of the antenna; empty where the source's is another
    std::optional<long long> declared_points;
    std::vector<std::pair<PatternCut::Point, double>> points;  ///< the second is the value in the file's unit
    std::size_t line = 0;

    bool is_horizontal() const { return plane == "AZ" || plane == "H"; }
  };

  double require(const std::optional<double>& value, const std::string& key) const {
    if (!value) throw InputError(lines_.name(), "no line " + key + "; expected " + key + ":,number");
    return *value;
  }

  static double in_dbi(const std::string& unit, double gain) { return unit == "DBD" ? gain + dbd_in_dbi : gain; }

  void read_field(std::size_t colon) {
    const std::string key = upper_case(trimmed(lines_.line().substr(0, colon)));
    std::string_view value = trimmed(lines_.line().substr(colon + 1));
    if (value.starts_with(',')) value.remove_prefix(1);
    value = trimmed(value.substr(0, value.find(',')));
    if (key == "GUNITS") read_units(upper_case(value));
    if (key == "MDGAIN") gain_ = lines_.number(key, value, any_gain);
    if (key == "NOFREQ" && parse_integer(value) != 1) {
      lines_.fail("NOFREQ: found " + in_quotes(value) + "; expected patterns at 1 frequency");
    }
    if (key == "PATCUT") start_cut(upper_case(value));
    if (key == "POLARI" || key == "NUPOIN") read_cut_field(key, value);
  }

  void read_units(const std::string& units) {
    const std::size_t slash = std::min(units.find('/'), units.size());
    gain_unit_ = trimmed(std::string_view(units).substr(0, slash));
    if (slash < units.size()) point_unit_ = trimmed(std::string_view(units).substr(slash + 1));
    const bool known = (gain_unit_ == "DBI" || gain_unit_ == "DBD") &&
                       (point_unit_ == "DBR" || point_unit_ == "DBI" || point_unit_ == "DBD");
    if (!known) lines_.fail("GUNITS: found " + in_quotes(units) + "; expected DBI or DBD / DBR, DBI or DBD");
  }

  void start_cut(const std::string& plane) {
    if (plane != "AZ" && plane != "H" && plane != "EL" && plane != "V") {
      lines_.fail("PATCUT: found " + in_quotes(plane) + "; expected AZ, H, EL or V");
    }
    cuts_.push_back({plane, "", {}, {}, lines_.number()});
  }

  void read_cut_field(const std::string& key, std::string_view value) {
    if (cuts_.empty()) lines_.fail(key + ": before the first PATCUT; expected it behind one");
    if (key == "NUPOIN") {
      cuts_.back().declared_points = parse_integer(value);
      if (!cuts_.back().declared_points) lines_.fail("NUPOIN: found " + in_quotes(value) + "; expected a whole number");
      return;
    }
    const std::string pair = upper_case(value);
    const std::size_t middle = pair.find_first_of("/-");
    if (middle == std::string::npos) lines_.fail("POLARI: found " + in_quotes(value) + "; expected a pair like V/V");
    if (pair.substr(0, middle) == pair.substr(middle + 1)) cuts_.back().polarization = pair.substr(0, middle);
  }

  /// "angle,value" or "angle,value,phase", with or without a comma at the end.
  void add_point() {
    if (cuts_.empty()) lines_.fail("found " + in_quotes(lines_.line()) + "; expected a line FIELD:,value");
    const std::string_view line = lines_.line();
    const std::size_t comma = line.find(',');
    if (comma == std::string_view::npos) lines_.fail("found " + in_quotes(line) + "; expected angle,value");
    const std::string_view rest = line.substr(comma + 1);
    const double angle_deg = lines_.number("angle", line.substr(0, comma), any_cut_angle_deg);
    const double value = lines_.number("value", rest.substr(0, rest.find(',')), any_value);
    cuts_.back().points.push_back({{angle_deg, 0.0, lines_.number()}, value});
  }

  /// The first two cuts of one polarization that are a horizontal and a vertical one.
  std::pair<const Cut*, const Cut*> choose_cuts() const {
    for (const Cut& first : cuts_) {
      if (first.polarization.empty()) continue;
      for (const Cut& second : cuts_) {
        if (second.polarization != first.polarization || second.is_horizontal() == first.is_horizontal()) continue;
        return first.is_horizontal() ? std::pair(&first, &second) : std::pair(&second, &first);
      }
    }
    throw InputError(lines_.name(),
                     "no pair of cuts; expected PATCUT AZ or H and PATCUT EL or V with the same POLARI, like V/V");
  }

  PatternCut cut_of(const Cut& cut, double sense, double gain_dbi) const {
    const std::string name = "PATCUT " + cut.plane;
    if (cut.declared_points && *cut.declared_points != static_cast<long long>(cut.points.size())) {
      throw InputError(lines_.name(), cut.line,
                       name + ": " + std::to_string(cut.points.size()) + " points; expected " +
                           std::to_string(*cut.declared_points) + " as NUPOIN says");
    }
    std::vector<PatternCut::Point> points;
    for (const auto& [point, value] : cut.points) {
      const double attenuation_db = point_unit_ == "DBR" ? -value : gain_dbi - in_dbi(point_unit_, value);
      if (point_unit_ == "DBR" && attenuation_db < 0.0) {
        throw InputError(lines_.name(), point.line,
                         "value: found '" + number_text(value) + "'; expected at most 0 where GUNITS says DBR");
      }
      points.push_back({sense * point.angle_deg, attenuation_db, point.line});
    }
    return {lines_.name(), name, std::move(points)};
  }

  Lines lines_;
  std::string gain_unit_ = "DBI", point_unit_ = "DBR";
  std::optional<double> gain_;
  std::vector<Cut> cuts_;
};

}  // namespace

PatternTable read_msi(const std::filesystem::path& file) {
  const std::string text = read_text_file(file, "expected an MSI or NSMA antenna file");
  if (NsmaReader::recognizes(text)) return NsmaReader(file.string(), text).read();
  return MsiReader(file.string(), text).read();
}

}  // namespace dcem::io
