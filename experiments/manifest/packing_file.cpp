// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/packing_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <regex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/near_grains.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/io/read_number.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

using std::string;
using std::string_view;

constexpr LengthUnit kUnits[] = {LengthUnit::m, LengthUnit::d, LengthUnit::mm, LengthUnit::cm,
                                 LengthUnit::um};

/// What a column can contain. In a kWall column, 0 (in a LAMMPS data file: type 1) marks a grain,
/// and a larger value marks a wall grain.
enum Quantity { kX, kY, kZ, kVx, kVy, kVz, kDiameter, kId, kWall, kQuantities };
constexpr const char* kNamesInMessages[] = {"x",  "y",        "z",  "vx",  "vy",
                                            "vz", "diameter", "id", "type"};

/// What a column with one of these names contains. If several columns could contain the same
/// quantity, those with the lowest rank are read.
struct Meaning {
  string_view names;        ///< in lower case; if count = 1, name k gives quantity first + k - 1
  int first = kQuantities;  ///< first quantity of the column; kQuantities: unknown
  int count = 1;            ///< number of values in the column
  double factor = 1;        ///< 2 for radii
  enum { listed, second_best, probable } rank = listed;
  std::optional<LengthUnit> unit = {};  ///< unit given in the column's name
};
constexpr Meaning kMeanings[] = {{"x y z", kX},
                                 {"xu yu zu", kX, 1, 1, Meaning::second_best},
                                 {"pos", kX, 3},
                                 {"vx vy vz", kVx},
                                 {"vel velo velocity velocities", kVx, 3},
                                 {"radius", kDiameter, 1, 2},
                                 {"diameter", kDiameter},
                                 {"id", kId},
                                 {"wall_side", kWall}};

// The structs below hold what is found in a file. Each string_view is a constant or a part of the
// file's text. The position of this part in the text gives the line number for messages.

struct Column {
  string_view name;             ///< "" for a column without a name
  int count = 1;                ///< number of values
  string_view count_text = {};  ///< the count as written in extended XYZ
};

struct GrainTable {
  string_view header = {};  ///< the line with the names of the columns
  const char* remedy = "";  ///< remedy in the message about missing columns
  std::vector<Column> columns = {};
  const char* more = nullptr;  ///< what additional values in a row are; null: they are an error
  char separator = ' ';        ///< ' ' means any number of blanks and tabs
  double first_wall = 1;       ///< a row is a wall grain if its value of kWall is at least this
  std::vector<string_view> rows = {};
};

struct Box {
  string_view line;            ///< last line with a part of the box
  Eigen::AlignedBox3d planes;  ///< empty along axes without bounds
  double lean = 0;             ///< largest component of an edge perpendicular to its axis
  /// Axes along which LAMMPS fits the box to the grains. A dump's box may be outdated along them.
  std::array<bool, 3> follows{};
};

struct Use {
  int quantity;
  std::size_t field;
  double factor = 1;
};

struct GrainRow {
  string_view line;
  std::array<double, kQuantities> value{};
};

bool holds(const std::vector<Use>& uses, int quantity) {
  return std::ranges::count(uses, quantity, &Use::quantity) > 0;
}

string_view unquoted(string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return quoted ? trimmed(text.substr(1, text.size() - 2)) : text;
}

/// The end of the first field. If the field begins with a quote, separators in quotes are ignored.
std::size_t field_end(string_view text, string_view separators) {
  std::size_t from = std::min(text.find_first_not_of(' '), text.size());
  while (from < text.size() && text[from] == '"') {  // "" in quotes is one quote
    from = std::min(text.find('"', from + 1), text.size() - 1) + 1;
  }
  return text.find_first_of(separators, from);
}

std::vector<string_view> split(string_view text, char separator) {
  const bool blank = separator == ' ';
  std::vector<string_view> fields;
  for (;;) {
    const std::size_t end =
        blank ? text.find_first_of(" \t") : field_end(text, string_view(&separator, 1));
    const string_view field = trimmed(text.substr(0, end));
    if (!blank || !field.empty()) fields.push_back(field);
    if (end == text.npos) return fields;
    text.remove_prefix(end + 1);
  }
}

/// The unit with this name in lower case, or nothing. The micro sign is not the Greek letter.
std::optional<LengthUnit> unit_of(string_view name) {
  if (name == "\u00b5m" || name == "\u03bcm") return LengthUnit::um;
  static const std::regex metres("(milli|centi|micro)?met(er|re)s?");
  const string text(name.substr(0, 64));
  if (std::smatch found; std::regex_match(text, found, metres)) {
    const string prefix = found[1];
    return prefix.empty()      ? LengthUnit::m
           : prefix == "milli" ? LengthUnit::mm
           : prefix == "centi" ? LengthUnit::cm
                               : LengthUnit::um;
  }
  if (name == "si") return LengthUnit::m;
  return name == "cgs" ? LengthUnit::cm : value_of<LengthUnit>(name);
}

/// `units`: whether listed names may end in a unit, as in x_m. `count`: the number of values in the
/// column. A name that is not listed can still be recognized as a diameter, which is only checked,
/// or as a position or velocity, which is refused: earlier versions ignored such velocities, so
/// reading them now would change packings with known ids. For the same reason, columns such as x_mm
/// or "x [m]" are only read if there is no x, x_m or x_d.
Meaning meaning_of(string_view column, bool units, int count = 1) {
  // A prefix that LAMMPS uses, the stem of the name, and a unit or an index.
  static const std::regex parts(
      "([cf]_|d2?_(?=...)|v_(?!(?:[xyzmd]|.m)(?:\\W|_|$)))?(.+?)"
      "((?:[ _]|[ _]*[\\[(])(d|[mcu]?m|\u00b5m|\u03bcm)(_per_s|/s)?[\\])]?|"
      "[ _]*[\\[({/:.].*|[ _](m|d|si|lj|.?.m)([ _]?(per|p)?[ _]?s)?)?");
  static const string grain = "(?:particle|grain|sphere|atom|bead|ball)?";
  static const string other = "(?!max|min|cut|.*(?:curvature|gyration|ratio))";
  static const std::regex radius(grain + "(?:r|rads?)|rp|" + other + ".*(?:radius|radii).*");
  static const std::regex diameter(grain + "(?:d|dias?|sizes?|sigma)|dp|durchmesser|" +
                                   "shape[xyz]|" + other + ".*diam(?!o).*");
  static const std::regex velocity(
      "(?!.*(ang|rot|omega|spin|vir|vor))"
      "((v|mom|speed)[xyz0-9]?|[pu][xyz\\[]|v(cm|el|lin|avg)?[xyz]u?|vel.*|[xyz](v|vel|dot)|"
      "d([xyzr]|pos)dt|.*(veloc|momenta|momentum).*)");
  static const std::regex position(
      "(pos|positions?|coords?|coordinates?|points?)[xyz0-9\\[]?|[xyz](su?|pos|coord)");
  const string name = lower(column);
  std::smatch found;
  if (name.size() > 64 || !std::regex_match(name, found, parts)) return {};  // limits recursion
  string stem = found[2];
  const auto unit = unit_of(found.str(4));
  const bool may_be_listed = found.length(1) == 0 && (found.length(3) == 0 || (units && unit));
  for (Meaning meaning : kMeanings) {
    const std::vector<string_view> names = split(meaning.names, ' ');
    const auto at = std::ranges::find(names, stem) - names.begin();
    if (!may_be_listed || at == std::ssize(names)) continue;
    meaning.unit = unit;
    if (unit && (!found.str(3).starts_with('_') || found.length(4) > 1)) {
      meaning.rank = Meaning::second_best;
    }
    if (meaning.count == 1) meaning.first += static_cast<int>(at);
    return meaning;
  }
  const string suffix = found[3];
  const bool component = count == 3 || (suffix.size() > 1 && suffix.size() < 4 &&
                                        string_view("0123xyz").find(suffix[1]) != string::npos);
  Meaning meaning;
  meaning.rank = Meaning::probable;
  meaning.unit = unit;
  for (string text : {stem, component ? stem + '[' : stem, stem + suffix}) {
    std::erase_if(text, [](unsigned char c) { return std::isalnum(c) == 0 && c != '['; });
    // Columns such as c_p[1] are a stress of each atom, or displacements, in files of LAMMPS.
    const bool tensor = found.length(1) > 0 && text.size() == 2 && text[1] == '[';
    if (std::regex_match(text, radius)) meaning.factor = 2;
    meaning.first = meaning.factor > 1 || std::regex_match(text, diameter) ? kDiameter
                    : std::regex_match(text, velocity) && !tensor          ? kVx
                    : std::regex_match(text, position)                     ? kX
                                                                           : kQuantities;
    if (meaning.first != kQuantities) break;
  }
  return meaning;
}

/// Whether a name, such as a key, concerns the box, a unit or the kind of the coordinates.
bool concerns_geometry(string_view name) {
  static const std::regex geometry(
      "(^|[^a-z]|super)lattice|(^|[^a-z]|sim|super)box|origin($|[^a-z])|"
      "(^|[^a-z]|unit|super|sim)cell(?!_height_d$|_?id)|^properties$|"
      "^columns$|^(l|len|length|size)_?[xyz]$|^[xyz]_?(lo|hi|min|max|len|length|size)($|[^a-z])|"
      "^(fractional|scaled|reduced)|^(coords?|coordinates?)($|_?(type|system|mode|style|format))|"
      "^(?!energy|force|stress|pressure|mass|charge|temp|formula|angle|density|freq|dipole|virial)"
      "(.*[^a-z])?"
      "(length|distance|position|velocity|time)?units?"
      "($|_?(of|length|distance|position|velocity|time|system|style))");
  return std::regex_search(lower(name.substr(0, 64)), geometry);  // limits the recursion
}

/// Whether the text has as many numbers in a row as the edges and angles of a box: 6 or 9.
bool may_be_box(string text) {
  std::ranges::replace_if(
      text, [](char c) { return string_view(",;\"'{}[]()").find(c) != string::npos; }, ' ');
  text += " end";
  std::size_t row = 0;
  for (const string_view word : split(text, ' ')) {
    const bool number = read_number<double>(word).has_value();
    if (!number && (row == 6 || row == 9)) return true;
    row = number ? row + 1 : 0;
  }
  return false;
}

class PackingReader {
 public:
  PackingReader(string_view text, string_view file, const PackingFacts& facts)
      : text_(text), file_(file), facts_(facts) {}

  PackingFile read() {
    if (text_.size() > kLargestPackingFile) {
      refuse_file(fmt::format("is larger than {} MiB", kLargestPackingFile >> 20),
                  "Leave out columns that are not positions, velocities or radii.");
    }
    check_characters(text_, file_, "Save the positions as text: extended XYZ, LAMMPS data or CSV.");
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
    rest_ = text_;
    if (trimmed(rest_).empty()) refuse_file("is empty", kFormats);
    const string_view first = rest_.substr(0, rest_.find('\n'));
    if (read_number<std::uint64_t>(trimmed(first))) {
      read_xyz();
    } else if (first.starts_with("ITEM:")) {
      read_dump();
    } else if (states_atoms()) {
      read_data();
    } else if (file_.ends_with(".csv") || names_a_column(first)) {
      read_csv();
    } else {
      refuse_file("is not in a format that can be read", kFormats);
    }
    return packing();
  }

 private:
  static constexpr const char* kEdges = "gives the box by edge vectors, which cannot be read";
  static constexpr const char* kStyles = "Write the data file with atom_style sphere or atomic.";
  static constexpr const char* kBounds = "Write the box as xlo xhi, ylo yhi and zlo zhi.";
  static constexpr const char* kFormats =
      "Use extended XYZ (its first line is the number of grains), LAMMPS data (with \"500 atoms\" "
      "in its header), a LAMMPS dump, or CSV whose first line names the columns, such as "
      "x_m,y_m,z_m.";

  Position place(string_view part) const {
    const string_view before =
        text_.substr(0, static_cast<std::size_t>(part.data() - text_.data()));
    return {1 + static_cast<int>(std::ranges::count(before, '\n')),
            static_cast<int>(before.size() - (before.rfind('\n') + 1)) + 1};
  }
  int line_of(const GrainRow& row) const { return place(row.line).line; }

  [[noreturn]] void refuse_file(const string& problem, const string& remedy) const {
    refuse(file_, {}, "", problem, "", remedy);
  }
  /// Refuses the file because of the line that contains `in`.
  [[noreturn]] void refuse_line(string_view in, const string& problem, const string& remedy) const {
    refuse(file_, {place(in).line, 1}, "", problem, "", remedy);
  }
  [[noreturn]] void refuse_part(string_view part, const string& key, const string& problem,
                                const string& remedy) const {
    refuse(file_, place(part), key, problem, printable(part), remedy);
  }

  bool next_line() {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line_ = rest_.substr(0, end);
    if (line_.ends_with('\r')) line_.remove_suffix(1);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return true;
  }

  void require_line(const string& of) {
    if (!next_line()) refuse_line(line_, "the file ends after this line", "It lacks " + of + ".");
  }

  double number(string_view part, const char* name) const {
    const bool sign = part.size() > 1 && part.front() == '+' && part[1] != '-';
    const auto value = read_number<double>(part.substr(sign ? 1 : 0));
    if (value && std::fabs(*value) <= kLargest) return *value;
    if (value) {
      refuse_part(part, name, "is not finite, or is larger than 1e100",
                  "Remove this grain, or correct the value.");
    }
    if (part.find(',') != part.npos && part.find_first_not_of("+-0123456789,eE") == part.npos) {
      string point(part);
      std::ranges::replace(point, ',', '.');
      refuse_part(part, name, "is not a number", "Write a decimal point: " + point + ".");
    }
    refuse_part(part, name, "is not a number",
                "Write the number in decimal digits, such as 1.5e-3.");
  }

  Eigen::VectorXd numbers(std::span<const string_view> words, const char* name) const {
    Eigen::VectorXd all(static_cast<Eigen::Index>(words.size()));
    std::ranges::transform(words, all.begin(), [&](auto word) { return number(word, name); });
    return all;
  }

  /// Reads the rest of the file, one grain in each line. `count` is the number of grains that the
  /// file announces, if it does, in the line that contains `stated_in`.
  void read_rows(std::optional<std::uint64_t> count = {}, string_view stated_in = {}) {
    while (next_line()) {
      if (!trimmed(line_).empty()) grains_.rows.push_back(line_);
    }
    const std::size_t found = grains_.rows.size();
    if (!count || found == *count) return;
    const int at = place(stated_in).line;
    if (found < *count) {
      refuse_line(line_,
                  fmt::format("the file ends after {} of the {} grains announced in line {}", found,
                              *count, at),
                  "Use a complete file, or correct the number of grains.");
    }
    refuse_line(
        grains_.rows[*count],
        fmt::format("the file continues after the {} grains announced in line {}", *count, at),
        "Keep one frame, or correct the number of grains.");
  }

  Box& box() {
    if (!box_) box_.emplace();
    box_->line = line_;
    return *box_;
  }

  void set_planes(Eigen::Index axis, string_view low, string_view high) {
    box().planes.min()[axis] = number(low, "box");
    box().planes.max()[axis] = number(high, "box");
  }

  void set_lean(double by) { box().lean = std::max(box().lean, std::fabs(by)); }

  static std::vector<Column> columns_of(string_view header, char separator = ' ') {
    std::vector<Column> columns;
    for (const string_view name : split(header, separator)) columns.push_back({unquoted(name)});
    return columns;
  }

  void leave(string_view name) {
    constexpr std::size_t most = 100;
    if (name.empty() || not_read_.size() == most) return;
    if (std::ranges::count(not_read_, printable(name)) == 0) not_read_.push_back(printable(name));
  }

  /// The place of the mark that closes the first mark of the text; brackets may be nested.
  static std::size_t close_of(string_view text, char close) {
    if (text.front() == close) return text.find(close, 1);
    int depth = 0;
    for (std::size_t k = 0; k < std::min<std::size_t>(text.size(), 4096); ++k) {  // limits the time
      depth += text[k] == text.front() ? 1 : text[k] == close ? -1 : 0;
      if (depth == 0) return k;
    }
    return text.npos;
  }

  /// The pairs KEY=VALUE of a comment, and the text between pairs as values without key. Blanks may
  /// be around `=`, and quotes or brackets around VALUE.
  static std::vector<std::pair<string_view, string_view>> pairs_of(string_view rest) {
    const auto cut = [&](std::size_t size) {
      const string_view front = rest.substr(0, size);
      rest.remove_prefix(front.size());
      return front;
    };
    std::vector<std::pair<string_view, string_view>> pairs;
    while (!rest.empty()) {
      const string_view key = cut(rest.find_first_of("= \t,;\"'"));
      cut(rest.find_first_not_of(" \t,;\"'"));
      if (!rest.starts_with('=')) {
        if (key.empty()) continue;
        const bool follows = !pairs.empty() && pairs.back().first.empty();
        const char* from = follows ? pairs.back().second.data() : key.data();
        if (follows) pairs.pop_back();
        pairs.emplace_back("", string_view(from, key.data() + key.size()));
        continue;
      }
      cut(1);
      const bool blank = !cut(rest.find_first_not_of(" \t")).empty();
      const std::size_t mark = rest.empty() ? rest.npos : string_view("\"'{[(").find(rest.front());
      const std::size_t end = mark == rest.npos ? mark : close_of(rest, "\"'}])"[mark]);
      const string_view word =
          rest.substr(0, end == rest.npos ? rest.find_first_of(" \t,;") : end + 1);
      const bool of_next = blank && end == rest.npos && word.find('=') != word.npos;  // "a= b=1"
      pairs.emplace_back(key, of_next ? string_view() : cut(word.size()));
    }
    return pairs;
  }

  void read_xyz() {
    next_line();
    const string_view counted_in = line_;
    require_line("the comment and the grains");
    grains_ = {.header = line_,
               .remedy = "Properties must contain pos:R:3, and vel:R:3 if there are velocities.",
               .columns = columns_of("species x y z"),
               .more = "further columns"};
    static constexpr string_view keys[] = {"Lattice", "Origin", "Properties", "length_unit",
                                           "velocity_unit"};
    static const std::regex other(
        "pbc|.*(stress|virial|strain|force|field|gravity|polari|moment|magmom).*",
        std::regex::icase);
    std::map<string_view, string_view> values;
    for (const auto& [key, value] : pairs_of(line_)) {
      const bool box =
          may_be_box(string(value)) && !std::regex_match(string(key.substr(0, 64)), other);
      // ASE writes unit_cell=conventional beside the lattice.
      const bool word = key == "unit_cell" && value.find_first_of("0123456789") == value.npos;
      if (word || (!box && !concerns_geometry(key))) {
        if (key != "pbc" || value != "\"F F T\"") leave(key.empty() ? "comment" : key);
        continue;
      }
      const bool blanks = value.data() != key.data() + key.size() + 1;
      if (std::ranges::count(keys, key) == 0 || (blanks && !key.ends_with("unit"))) {
        refuse_part(
            key.empty() ? value : key, "", "cannot be read in this form",
            fmt::format("Use one of the keys {}, without blanks around `=`, or remove this part.",
                        fmt::join(keys, ", ")));
      }
      const bool quoted = value.size() > 1 && (value.front() == '"' || value.front() == '\'');
      if (!values.emplace(key, quoted ? value.substr(1, value.size() - 2) : value).second) {
        refuse_part(key, "", "is a key that occurs twice", "Keep one of them.");
      }
    }
    take_text("unit");
    for (const char* key : {"length_unit", "velocity_unit"}) {
      const string_view unit = values[key];
      if (unit.data() == nullptr) continue;
      take_unit(key, unit.substr(0, unit.size() - (unit.ends_with("/s") ? 2 : 0)));
    }
    if (values.contains("Lattice") || values.contains("Origin")) {
      read_lattice(values["Lattice"], values["Origin"]);
    }
    if (values.contains("Properties")) read_properties(values["Properties"]);
    read_rows(read_number<std::uint64_t>(trimmed(counted_in)), counted_in);
  }

  void read_properties(string_view text) {
    grains_.columns.clear();
    grains_.more = nullptr;
    const std::vector<string_view> parts = split(text, ':');
    for (std::size_t k = 0; k < parts.size(); k += 3) {
      const auto count =
          k + 2 < parts.size() ? read_number<std::uint16_t>(parts[k + 2]) : std::nullopt;
      if (!count || *count == 0) {
        refuse_part(parts[k], "Properties", "is not a column",
                    "A column is NAME:TYPE:COUNT, as in species:S:1:pos:R:3.");
      }
      grains_.columns.push_back({parts[k], *count, parts[k + 2]});
    }
  }

  void read_lattice(string_view text, string_view origin) {
    const std::vector<string_view> parts = split(text, ' '), corner = split(origin, ' ');
    if (parts.size() != 9 || (!corner.empty() && corner.size() != 3)) {
      refuse_line(line_, "Lattice or Origin is not complete",
                  "Lattice needs 9 numbers: the edges of the box. Origin needs 3 numbers: the "
                  "lower corner of the box.");
    }
    Eigen::Matrix3d edges = numbers(parts, "Lattice").reshaped(3, 3);
    const Eigen::Vector3d size = edges.diagonal();
    Eigen::Vector3d low(0, 0, 0);
    if (!corner.empty()) low = numbers(corner, "Origin");
    edges.diagonal().setZero();
    set_lean(edges.cwiseAbs().maxCoeff());
    box_->planes = {low, low + size};
  }

  /// Whether one of the first lines gives a number of atoms, for example "500 atoms".
  bool states_atoms() const {
    static const std::regex count("[0-9][ \\t]+atoms");
    return std::regex_search(string(rest_.substr(0, 2000)), count);
  }

  void read_data() {
    next_line();
    const bool ours = read_title();
    std::uint64_t count = 0;
    string_view stated_in = line_;
    grains_ = {.header = line_, .columns = columns_of("x y z")};
    moving_ = {.columns = columns_of("id vx vy vz"), .more = "angular velocities"};
    string section, style;
    while (next_line()) {
      if (section.empty()) take_text("units");
      const std::size_t comment = std::min(line_.find('#'), line_.size());
      const string_view body = trimmed(line_.substr(0, comment));
      if (body.empty()) continue;
      if (std::isalpha(static_cast<unsigned char>(body.front())) != 0) {
        section = body;
        style = trimmed(line_.substr(std::min(comment + 1, line_.size())));
        if (section != "Atoms" && section != "Velocities") leave_of_data(body);
      } else if (section.empty()) {
        const std::vector<string_view> words = split(body, ' ');
        if (words.size() == 2 && words[1] == "atoms") {
          count = read_number<std::uint64_t>(words[0]).value_or(0);
          stated_in = line_;
        } else if (!ours) {
          read_bounds(body, words);
        }
      } else if (section == "Atoms") {
        if (grains_.rows.empty()) take_style(style, split(body, ' ').size(), ours);
        grains_.rows.push_back(body);
      } else if (section == "Velocities") {
        moving_.rows.push_back(body);
      }
    }
    if (grains_.rows.size() != count) {
      refuse_line(stated_in,
                  fmt::format("declares {} atoms, but the file has {}", count, grains_.rows.size()),
                  "Use a complete file, or correct the number of atoms.");
    }
  }

  /// Reads the units from the title and, in an export of this program, the planes of the cell.
  /// Returns whether the file is such an export.
  bool read_title() {
    take_text("units");
    const std::size_t at = line_.find("cell ");
    if (!line_.starts_with("LAMMPS data file by shearcell") || at == line_.npos) return false;
    const std::vector<string_view> words = split(line_.substr(at + 5), ' ');
    if (words.size() != 8) refuse_line(line_, "the cell is not complete", "Export the run again.");
    for (const int k : {0, 1, 2}) set_planes(k, words[2U * k], words[2U * k + 1]);
    set_lean(number(words[7], "tilt"));
    return true;
  }

  /// Reads a line of the header.
  void read_bounds(string_view line, const std::vector<string_view>& words) {
    const string_view low = words.size() == 4 && words[2].ends_with("lo") ? words[2] : "";
    const std::size_t axis = low.empty() ? low.npos : string_view("xyz").find(low.front());
    if (words.back().ends_with("vec")) refuse_part(words.back(), "", kEdges, kBounds);
    if (words.size() == 6 && words[3] == "xy") {
      set_lean(numbers(std::span(words).first(3), "tilt").cwiseAbs().maxCoeff());
    } else if (axis != string_view::npos) {
      set_planes(static_cast<Eigen::Index>(axis), words[0], words[1]);
    } else if (words.size() > 1 && read_number<double>(words[1])) {
      refuse_part(line, "", "cannot be read in this form", kBounds);
    } else if (words[0] != "0" && words.back() != "types") {
      leave_of_data(line);
    }
  }

  /// Refuses or leaves a line of the header, or a section.
  void leave_of_data(string_view part) {
    static const std::regex shapes("(.* )?(ellipsoids|lines|triangles|bodies)");
    static const std::regex tables("atoms|vel.*");
    const string text = lower(part.substr(0, 64));
    if (std::regex_match(text, shapes)) {
      refuse_part(part, "", "describes grains that are not spheres", kStyles);
    }
    const bool table = std::regex_match(text, tables);
    if (table || concerns_geometry(part)) {
      refuse_part(part, "", "cannot be read in this form",
                  table ? "Name the section Atoms or Velocities, or remove it." : kBounds);
    }
    leave(part);
  }

  /// Sets the columns by the atom style that LAMMPS writes after "Atoms #". If the file gives no
  /// style, the number of fields decides.
  void take_style(string_view style, std::size_t fields, bool ours) {
    const bool five = fields == 5 || fields == 8, seven = fields == 7 || fields == 10;
    if (style.empty()) style = five ? "atomic" : seven ? "sphere" : style;
    if (style == "hybrid" && seven) style = "hybrid sphere";  // write_data omits substyles
    const char* columns = style == "atomic"                    ? "id type x y z"
                          : style == "sphere"                  ? "id type diameter density x y z"
                          : style.starts_with("hybrid sphere") ? "id type x y z diameter density"
                                                               : nullptr;
    if (columns == nullptr) {
      refuse_line(line_,
                  style.empty() ? fmt::format("atoms with {} fields cannot be read", fields)
                                : fmt::format("the atom style {} cannot be read", printable(style)),
                  kStyles);
    }
    grains_.columns = columns_of(columns);
    grains_.more = "image flags";
    if (ours) grains_.columns[1].name = "wall_side";  // type 1: grain; larger: wall grain
    grains_.first_wall = 2;
  }

  void read_dump() {
    std::optional<std::uint64_t> count;
    string_view stated_in;
    while (next_line()) {
      const string_view item = trimmed(line_);
      if (item.starts_with("ITEM: ATOMS")) {
        if (!count) refuse_line(line_, "the number of atoms is missing", "Use a complete dump.");
        grains_ = {
            .header = line_,
            .remedy =
                "Write these columns: dump ... custom ... id x y z vx vy vz. Scaled coordinates, "
                "such as xs, cannot be read.",
            .columns = columns_of(item.substr(string_view("ITEM: ATOMS").size()))};
        return read_rows(count, stated_in);
      }
      if (!item.starts_with("ITEM:")) continue;
      const string_view name = trimmed(item.substr(string_view("ITEM:").size()));
      if (item.starts_with("ITEM: BOX BOUNDS")) {
        read_dump_box(item);
      } else if (name == "UNITS") {
        require_line("the rest of the dump");
        take_unit("units", trimmed(line_));
      } else if (name == "NUMBER OF ATOMS") {
        require_line("the rest of the dump");
        count = read_number<std::uint64_t>(trimmed(line_));
        stated_in = line_;
      } else if (concerns_geometry(name)) {
        refuse_part(name, "", "cannot be read in this form",
                    "Use ITEM: BOX BOUNDS and ITEM: UNITS as LAMMPS writes them, or remove this "
                    "section.");
      } else if (!name.starts_with("TIME")) {
        leave(name);
      }
    }
    refuse_line(line_, "the dump ends before its atoms", "Use a complete dump.");
  }

  /// Reads the three lines of the box after the line with `item`.
  void read_dump_box(string_view item) {
    if (item.find("abc") != item.npos) {
      refuse_part(item, "", kEdges, "Write the dump without `dump_modify triclinic/general yes`.");
    }
    const bool leans = item.find("xy") != item.npos;
    const std::vector<string_view> words_of_item = split(item, ' ');
    const auto kinds = std::span(words_of_item).last(3);  // "ss ss pp"
    const bool ours = kinds[0] != "pp" && kinds[1] != "pp" && kinds[2] == "pp";
    if (kinds[2] != "BOUNDS" && !ours) leave(fmt::format("boundary {}", fmt::join(kinds, " ")));
    for (const int k : {0, 1, 2}) {
      require_line("the rest of the box");
      const std::vector<string_view> words = split(line_, ' ');
      if (words.size() != (leans ? 3U : 2U)) {
        refuse_line(line_, "does not give a lower and an upper bound", "Use a complete dump.");
      }
      set_planes(k, words[0], words[1]);
      box_->follows[k] = kinds[k].find_first_of("sm") != string_view::npos;
      if (leans) set_lean(number(words[2], "tilt"));
    }
  }

  static char separator_of(string_view header) {
    const std::size_t at = field_end(header, ",;\t");
    return at == header.npos ? ',' : header[at];
  }

  /// The line without the # and the blanks that numpy writes at the beginning.
  static string_view header_of(string_view line) {
    return line.substr(std::min(line.find_first_not_of("# \t"), line.size()));
  }

  static bool names_a_column(string_view line) {
    const string_view header = header_of(line.substr(0, 2000));
    return std::ranges::any_of(columns_of(header, separator_of(header)), [](const Column& column) {
      return !meaning_of(column.name, true).names.empty();
    });
  }

  void read_csv() {
    next_line();
    const string_view header = header_of(line_);
    grains_ = {.header = line_,
               .remedy =
                   "The first line must name the columns, such as x_m,y_m,z_m. The unit can "
                   "be m, d, mm, cm or um.",
               .columns = columns_of(header, separator_of(header)),
               .separator = separator_of(header)};
    units_in_names_ = true;
    read_rows();
  }

  /// Reads the unit from the text in line_, such as "lengths in mm". Scaled coordinates are refused
  /// like an unknown unit.
  void take_text(const char* key) {
    static const std::regex unit(
        "\\b(?:(?:units?|coord\\w{0,9})\\b"
        "(?:[\\s=:\"'\\[(]|of|in|are|is|lengths?|distances?|positions?){1,12}|"
        "in\\s{1,9}(?!(?:real|metal|micro|nano|electron|si|lj|cgs)\\b))"
        "(real|metal|micro|nano|electron|si|lj|cgs|m|d|(?:[cmunp]|\xC2\xB5|\xCE\xBC)m|fractional|"
        "scaled|reduced(?!\\s{1,9}unit)|(?:milli|centi|micro|nano)?met(?:er|re)s?|angstroms?)\\b"
        "(?!\\s*=|-|/|\\^)|"
        "\\b(?:fractional|scaled|reduced)\\s{1,9}coord|"
        "\\b(?:(?:lattice|length|box|position)_?)?scale(?:_?factor)?=[0-9.]+(?![\\w.])",
        std::regex::icase);
    const string text(line_.substr(0, 20'000));
    for (std::sregex_iterator at(text.begin(), text.end(), unit), end; at != end; ++at) {
      static const std::regex quantity("(veloc|diam|radi|mass|time|stress)\\w{0,9}\\s{0,9}$",
                                       std::regex::icase);
      const auto begin = static_cast<std::size_t>(at->position(0));
      const std::size_t from = begin - std::min<std::size_t>(begin, 32);
      if (std::regex_search(text.substr(from, begin - from), quantity)) continue;
      const std::size_t group = (*at)[1].matched ? 1 : 0;
      take_unit(key, line_.substr(static_cast<std::size_t>(at->position(group)),
                                  static_cast<std::size_t>(at->length(group))));
    }
  }

  /// Sets the unit of lengths from the value of a key. The value "lj" sets no unit.
  void take_unit(const char* key, string_view text) {
    const string name = lower(text);
    if (name == "lj") return;
    const std::optional<LengthUnit> unit = unit_of(name);
    if (!unit) {
      refuse_part(text, key, "cannot be read",
                  fmt::format("Lengths must be in one of {}, si, cgs, or lj (the unit that the "
                              "manifest states).",
                              fmt::join(kNames<LengthUnit>, ", ")));
    }
    set_unit(*unit, text);
  }

  /// The unit that the file gives, else that of the manifest.
  std::optional<LengthUnit> stated_unit() const { return unit_ ? unit_ : facts_.unit; }

  /// Sets the unit of lengths. `in`: text from the line that gives the unit.
  void set_unit(LengthUnit unit, string_view in) {
    const std::optional<LengthUnit> other = stated_unit();
    if (other && *other != unit) {
      refuse_line(
          in, fmt::format("gives lengths in {}", name_of(unit)),
          unit_ ? fmt::format("The file also has lengths in {}. Write all lengths in one unit.",
                              name_of(*other))
                : fmt::format("The manifest sets `unit: {}`. Remove that key.", name_of(*other)));
    }
    unit_ = unit;
  }

  void interpret_box() {
    if (!box_) return;
    const auto missing = (box_->planes.max().array() < -kLargest).count();
    if (missing == 3 && box_->lean == 0) return box_.reset();
    if (missing > 0) {
      refuse_line(box_->line, "the box is not complete", "Write xlo xhi, ylo yhi and zlo zhi.");
    }
    const Eigen::Vector3d size = box_->planes.sizes();
    if (box_->lean > 1e-9 * size.cwiseAbs().maxCoeff()) {
      refuse_line(box_->line,
                  fmt::format("the box is not orthogonal: an edge leans by {:.3g}", box_->lean),
                  "Use a rectangular box. A sheared cell is rectangular at the end of a cycle.");
    }
    for (const int k : {0, 1, 2}) {
      if (size[k] > 0) continue;
      refuse_line(box_->line,
                  fmt::format("the box has length {:.6g} along {}", size[k], kNamesInMessages[k]),
                  "The edges must be positive.");
    }
  }

  /// Decides which columns are read. The names of other columns go to not_read_.
  std::vector<Use> interpret(const GrainTable& table) {
    constexpr std::size_t most = 1000;
    if (table.columns.size() > most) {
      refuse_line(table.header, fmt::format("has {} columns", table.columns.size()),
                  fmt::format("At most {} columns can be read. Leave out some columns.", most));
    }
    std::vector<Use> uses;
    std::optional<std::optional<LengthUnit>> unit;  // of the columns read so far
    std::vector<bool> used(table.columns.size());
    for (const auto rank : {Meaning::listed, Meaning::second_best, Meaning::probable}) {
      const std::vector<Use> better = uses;
      std::size_t field = 0;
      for (std::size_t k = 0; k < used.size(); ++k) {
        const Column& column = table.columns[k];
        const auto at = std::exchange(field, field + static_cast<std::size_t>(column.count));
        Meaning meaning = meaning_of(column.name, units_in_names_, column.count);
        if (meaning.count > 1 && column.count_text.empty()) meaning.rank = Meaning::probable;
        if (meaning.first == kQuantities || meaning.rank != rank) continue;
        if (holds(better, meaning.first)) continue;
        used[k] = true;
        use(meaning, column, at, uses);
        if (meaning.first > kDiameter) continue;  // not a length
        if (!meaning.unit) meaning.unit = stated_unit();
        if (unit && meaning.unit != *unit) {
          refuse_part(column.name, "", "is in another unit than the earlier columns",
                      "Write all lengths in m (x_m) or all in d (x_d).");
        }
        unit = meaning.unit;
      }
    }
    if (unit && *unit) set_unit(**unit, table.header);
    for (std::size_t k = 0; k < used.size(); ++k) {
      const string_view name = table.columns[k].name;
      if (!used[k] && (lower(name) == "unit" || lower(name) == "units")) {
        refuse_part(name, "", "is a unit that cannot be read", grains_.remedy);
      }
      if (!used[k]) leave(name.empty() ? fmt::format("column {}", k + 1) : string(name));
    }
    return uses;
  }

  void use(const Meaning& meaning, const Column& column, std::size_t at, std::vector<Use>& uses) {
    if (meaning.rank == Meaning::probable && meaning.first != kDiameter) {
      refuse_part(
          column.name, "", "cannot be read under this name",
          meaning.first == kX
              ? grains_.remedy
              : "Name the columns x, y, z, vx, vy, vz (in extended XYZ pos:R:3 and vel:R:3), or "
                "remove this column. Velocities must be in units of length per second. In CSV, "
                "the names can give this unit: vx_m_per_s or vx_d_per_s.");
    }
    if (meaning.count != column.count) {
      refuse_part(
          column.count_text, "Properties",
          fmt::format("is not the right number of columns for {}", printable(lower(column.name))),
          fmt::format("Write {}.", meaning.count));
    }
    for (int k = 0; k < meaning.count; ++k) {
      if (meaning.first != kDiameter && holds(uses, meaning.first + k)) {
        refuse_part(column.name, "", "is a column that occurs twice", "Keep one of them.");
      }
      uses.push_back({meaning.first + k, at + static_cast<std::size_t>(k), meaning.factor});
    }
    if (meaning.rank != Meaning::probable) return;
    about_diameter_ =
        fmt::format(" The column {} is read as {}. If this is wrong, rename or remove the column.",
                    printable(column.name), meaning.factor > 1 ? "radii" : "diameters");
  }

  void require_columns() const {
    const bool moves = holds(uses_, kVx) || holds(uses_, kVy) || holds(uses_, kVz);
    for (const int q : {kX, kY, kZ, kVx, kVy, kVz}) {
      if (holds(uses_, q) || (q >= kVx && !moves)) continue;
      refuse_line(grains_.header, fmt::format("the column {} is missing", kNamesInMessages[q]),
                  grains_.remedy);
    }
  }

  /// Reads the rows of a table; wall grains are counted, not returned.
  std::vector<GrainRow> rows_of(const GrainTable& table, const std::vector<Use>& uses) {
    std::size_t columns = 0;
    for (const Column& column : table.columns) columns += static_cast<std::size_t>(column.count);
    std::vector<GrainRow> rows;
    for (const string_view line : table.rows) {
      const std::vector<string_view> fields = split(line, table.separator);
      const bool more = fields.size() > columns;
      if (fields.size() < columns || (more && table.more == nullptr)) {
        refuse_line(line, fmt::format("has {} fields instead of {}", fields.size(), columns),
                    table.separator == ',' && more
                        ? "Write numbers with a decimal point, not a comma."
                        : "Each grain is one line with a value for each column.");
      }
      if (more) leave(table.more);
      GrainRow row{.line = line};
      for (const Use& use : uses) {
        const auto q = static_cast<std::size_t>(use.quantity);
        const double value = use.factor * number(unquoted(fields[use.field]), kNamesInMessages[q]);
        const double other = std::exchange(row.value[q], value);
        if (other == 0 || std::fabs(value - other) <= kTolerance * std::fabs(other)) continue;
        refuse_line(
            line, fmt::format("gives two diameters, {:.6g} and {:.6g}", other, value),
            "The grains must be spheres. Keep one column of radii or diameters." + about_diameter_);
      }
      if (holds(uses, kWall) && row.value[kWall] >= table.first_wall) {
        ++wall_grains_;
      } else {
        rows.push_back(row);
      }
    }
    return rows;
  }

  /// Sets the velocity of each grain to the velocity with the same id in the table of velocities.
  void join_velocities() {
    std::map<double, GrainRow*> waiting;
    for (GrainRow& grain : rows_) waiting[grain.value[kId]] = &grain;
    for (const GrainRow& row : rows_of(moving_, interpret(moving_))) {
      const auto found = waiting.extract(row.value[kId]);
      if (!found && wall_grains_ > 0) continue;  // a velocity of a wall grain
      if (!found) {
        refuse_line(row.line,
                    fmt::format("atom {:.0f} has two velocities, or no position", row.value[kId]),
                    "Use a complete file.");
      }
      std::copy_n(&row.value[kVx], 3, &found.mapped()->value[kVx]);
    }
    if (waiting.empty()) return;
    refuse_line(moving_.rows.back(),
                fmt::format("atom {:.0f} has no velocity", waiting.begin()->first),
                "Write one velocity for each atom, or leave out the section Velocities.");
  }

  void require_equal_diameters() const {
    if (!holds(uses_, kDiameter)) return;
    const auto diameter = [](const GrainRow& row) { return row.value[kDiameter]; };
    const auto [least, most] = std::ranges::minmax_element(rows_, {}, diameter);
    const double small = diameter(*least), large = diameter(*most);
    if (small <= 0) {
      refuse_line(least->line, fmt::format("the diameter is {:.6g}", small),
                  "It must be positive." + about_diameter_);
    }
    if (large <= small * (1 + kTolerance)) return;
    refuse_line(
        most->line,
        fmt::format(
            "the grains have diameters from {:.6g} (line {}) to {:.6g}, which is {:.2g} % larger",
            small, line_of(*least), large, 100 * (large / small - 1)),
        "This program needs equal grains. Continue this packing in LAMMPS (`shearcell export --to "
        "lammps` writes a script for LAMMPS)." +
            about_diameter_);
  }

  /// The factor that converts lengths of the file to grain diameters.
  double scale() {
    unit_ = stated_unit();
    if (!unit_) {
      refuse_file("does not give the unit of its lengths",
                  "Write `unit: m` or `unit: d` (grain diameters) beside `file` in the manifest.");
    }
    const double diameter = facts_.diameter_m, expected = diameter / metres(*unit_, diameter);
    const double given = rows_.front().value[kDiameter];
    const auto fits = [&](LengthUnit unit) {
      return std::fabs(given * metres(unit, diameter) - diameter) <= kTolerance * diameter;
    };
    if (fits(*unit_) || !holds(uses_, kDiameter)) return 1 / expected;
    const auto* other = std::ranges::find_if(kUnits, fits);
    const string remedy =
        other != std::end(kUnits)
            ? fmt::format("The number would fit the unit {}. Is the unit right?", name_of(*other))
        : unit_ == LengthUnit::d
            ? "Lengths in d are divided by the diameter, so the diameter must be 1."
            : fmt::format("The manifest has {:.6g} {}. Set `diameter_m`, or scale the file.",
                          expected, name_of(*unit_));
    refuse_line(rows_.front().line,
                fmt::format("the diameter is {:.6g} {}", given, name_of(*unit_)),
                remedy + about_diameter_);
  }

  void sort_by_id() {
    if (!holds(uses_, kId)) return;
    std::ranges::stable_sort(rows_, {}, [](const GrainRow& row) { return row.value[kId]; });
    const auto same =
        std::ranges::adjacent_find(rows_, {}, [](const GrainRow& row) { return row.value[kId]; });
    if (same == rows_.end()) return;
    refuse_line(std::next(same)->line,
                fmt::format("the id {:.17g} is also in line {}", same->value[kId], line_of(*same)),
                "Give each grain a different id.");
  }

  Eigen::Matrix3Xd columns(Quantity first, double scale) const {
    Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Eigen::Map<const Eigen::Vector3d> row(&rows_[i].value[first]);
      all.col(static_cast<Eigen::Index>(i)) = row * scale;
    }
    return all;
  }

  PackingFile packing() {
    interpret_box();
    std::vector<string> aside = std::exchange(not_read_, {});  // to be listed after unread columns
    uses_ = interpret(grains_);
    require_columns();
    rows_ = rows_of(grains_, uses_);
    if (rows_.empty()) refuse_line(line_, "the file has no grains", kFormats);
    if (facts_.grains > 0 && rows_.size() != facts_.grains) {
      refuse_file(fmt::format("has {}, but the manifest asks for {}",
                              counted(rows_.size(), "grain"), facts_.grains),
                  fmt::format("Write `grains: {}`.", rows_.size()));
    }
    if (!moving_.rows.empty()) join_velocities();
    for (const string& name : aside) leave(name);
    if (wall_grains_ > 0) leave(counted(wall_grains_, "wall grain"));
    require_equal_diameters();
    sort_by_id();
    const double scale_to_d = scale();
    PackingFile packing;
    packing.position = columns(kX, scale_to_d);
    packing.unit = *unit_;
    packing.not_read = not_read_;
    if (holds(uses_, kVx) || !moving_.rows.empty()) packing.velocity = columns(kVx, scale_to_d);
    const Eigen::Vector3d least = packing.position.rowwise().minCoeff();
    const Eigen::Vector3d most = packing.position.rowwise().maxCoeff();
    Eigen::AlignedBox3d space(least.array() - 1, most.array() + 1);
    if (box_) {
      space = {box_->planes.min() * scale_to_d, box_->planes.max() * scale_to_d};
      for (const int k : {0, 1}) {
        if (!box_->follows[static_cast<std::size_t>(k)]) continue;
        space.min()[k] = least[k];
        space.max()[k] = most[k];
      }
      packing.box = space;
    }
    const double longest = space.sizes().maxCoeff();
    if (longest > kLongestCell) {
      refuse_file(
          fmt::format("the packing is {:.3g} d long", longest),
          fmt::format("At most {:g} d are allowed. Is the unit of lengths right?", kLongestCell));
    }
    if (box_) require_inside(space, packing.position);
    packing.largest_overlap = check_overlaps(space, packing.position);
    return packing;
  }

  /// Reports a grain outside of the box in x or y as an error. Wraps z into the periodic box.
  void require_inside(const Eigen::AlignedBox3d& box, Eigen::Matrix3Xd& position) const {
    const double depth = box.sizes().z();
    if (depth < kShallowestCell) {
      refuse_line(box_->line, fmt::format("the box is {:.3g} d deep in z", depth),
                  fmt::format("At least {:g} d are needed. Is the unit of lengths right?",
                              kShallowestCell));
    }
    for (Eigen::Index i = 0; i < position.cols(); ++i) {
      const auto& row = rows_[static_cast<std::size_t>(i)];
      for (const int k : {0, 1, 2}) {
        const double at = position(k, i), further = k == 2 ? kLongestCell : 0;
        if (at >= box.min()[k] - further && at <= box.max()[k] + further) continue;
        refuse_line(
            row.line,
            fmt::format(
                "the grain is outside of the box: {} = {:.6g} d is not between {:.6g} and {:.6g} d",
                kNamesInMessages[k], at, box.min()[k], box.max()[k]),
            "Only z is periodic; x and y have walls. Write a box that contains all grains. In "
            "extended XYZ, Origin is the lower corner of the box (default 0 0 0).");
      }
      double& z = position(2, i);
      if (z < box.min().z() || z >= box.max().z()) {
        z -= depth * std::floor((z - box.min().z()) / depth);
      }
    }
  }

  /// Returns PackingFile::largest_overlap. Rejects the file at the first pair that overlaps too
  /// much, because a search for all such pairs could be slow.
  double check_overlaps(const Eigen::AlignedBox3d& space, const Eigen::Matrix3Xd& position) const {
    const Eigen::Vector3d size = space.sizes();
    Cell cell;
    cell.width = size.x();
    cell.top = size.y();
    const bool fits = facts_.depth >= std::max(kShallowestCell, (1 - kTolerance) * (size.z() - 2));
    // No images touch at the last of these depths.
    cell.depth = box_ ? size.z() : fits ? facts_.depth : size.z() + kShallowestCell;
    const Eigen::Matrix3Xd sites = position.colwise() - space.min();
    double largest = 0;
    for_each_pair(
        cell, wall_pose(cell, 0, 0), sites, 1,
        [&](std::int32_t i, std::int32_t j, const Eigen::Vector3d& r) {
          const double overlap = 1 - r.norm();
          const Eigen::Vector3d inside = sites.col(i) - sites.col(j);
          const bool image = !box_ && std::fabs(inside.z()) > 0.5 * cell.depth;
          if (!image) largest = std::max(largest, overlap);
          if (overlap <= facts_.largest_overlap) return;
          const GrainRow* first = &rows_[static_cast<std::size_t>(i)];
          const GrainRow* second = &rows_[static_cast<std::size_t>(j)];
          if (first->line.data() > second->line.data()) std::swap(first, second);
          const string other = fmt::format("{}the grain in line {}",
                                           image ? "a periodic image of " : "", line_of(*first));
          refuse_line(
              second->line,
              overlap == 1 ? fmt::format("the grain has the same position as {}", other)
                           : fmt::format("the grain overlaps {} by {:.3g} d", other, overlap),
              image ? fmt::format("The cell of the manifest is only {:.6g} d deep (z). ",
                                  cell.depth) +
                          facts_.remedy_for_width(std::fabs(inside.z()) +
                                                  std::sqrt(1 - inside.head<2>().squaredNorm()))
                    : fmt::format("At most {:g} d are allowed (`max_overlap_diameters`). Are the "
                                  "unit of the lengths and the diameter right? If so, let the "
                                  "grains relax in the program that made the file.",
                                  facts_.largest_overlap));
        });
    return largest;
  }

  static constexpr double kLargest = 1e100;   // products of two values are finite
  static constexpr double kTolerance = 1e-5;  // relative; files may have only six digits

  string_view text_;
  string_view file_;
  PackingFacts facts_;
  string_view rest_;  ///< the text after line_
  string_view line_;

  std::optional<Box> box_;
  GrainTable grains_, moving_;
  bool units_in_names_ = false;  ///< whether names of columns contain units
  std::vector<string> not_read_;

  std::optional<LengthUnit> unit_;
  std::vector<Use> uses_;
  string about_diameter_;  ///< appended to remedies for wrong diameters
  std::vector<GrainRow> rows_;
  std::size_t wall_grains_ = 0;
};

}  // namespace

double metres(LengthUnit unit, double diameter_m) {
  static constexpr std::array<double, std::size(kUnits)> length = {1, 0, 1e-3, 1e-2, 1e-6};
  return unit == LengthUnit::d ? diameter_m : length[static_cast<std::size_t>(unit)];
}

std::optional<LengthUnit> likelier_unit(LengthUnit unit, double diameter_m, double length,
                                        double expected) {
  const auto off = [&](LengthUnit other) {
    const double factor = metres(other, diameter_m) / metres(unit, diameter_m);
    return std::fabs(std::log(length * factor / expected));
  };
  const LengthUnit best = std::ranges::min(kUnits, {}, off);
  return off(best) < 0.5 * off(unit) ? std::optional(best) : std::nullopt;
}

PackingFile read_packing(string_view text, string_view file, const PackingFacts& facts) {
  return PackingReader(text, file, facts).read();
}

string describe(const PackingFile& packing) {
  string box = "no box";
  if (packing.box) {
    const Eigen::Vector3d size = packing.box->sizes();
    box = fmt::format("box {:.6g} x {:.6g} x {:.6g} d", size.x(), size.y(), size.z());
  }
  const auto count = static_cast<std::size_t>(packing.position.cols());
  return fmt::format("{}, {}, {}{}{}", counted(count, "grain"), box,
                     packing.velocity ? "velocities" : "no velocities",
                     packing.not_read.empty() ? "" : "; not read: ", some_of(packing.not_read, 12));
}

}  // namespace shearcell
