// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/packing_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "analysis/near_grains.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/manifest.hpp"
#include "experiments/manifest/suggest.hpp"
#include "provenance/io/read_number.hpp"

namespace shearcell {
namespace {

using std::string;
using std::string_view;

/// What a column can hold. `wall`: 0 or the first type for a grain, more for a wall grain.
enum Quantity { kX, kY, kZ, kVx, kVy, kVz, kDiameter, kId, kWall, kQuantities };
constexpr const char* kNamesInMessages[] = {"x",  "y",        "z",  "vx",  "vy",
                                            "vz", "diameter", "id", "type"};

/// Names of columns in a header and of properties in extended XYZ.
struct ColumnName {
  string_view name;
  Quantity first;
  int count;  ///< of columns
};
constexpr auto kColumnNames = std::to_array<ColumnName>({{"x", kX, 1},
                                                         {"y", kY, 1},
                                                         {"z", kZ, 1},
                                                         {"xu", kX, 1},
                                                         {"yu", kY, 1},
                                                         {"zu", kZ, 1},
                                                         {"pos", kX, 3},
                                                         {"vx", kVx, 1},
                                                         {"vy", kVy, 1},
                                                         {"vz", kVz, 1},
                                                         {"vel", kVx, 3},
                                                         {"velo", kVx, 3},
                                                         {"velocity", kVx, 3},
                                                         {"velocities", kVx, 3},
                                                         {"radius", kDiameter, 1},
                                                         {"diameter", kDiameter, 1},
                                                         {"id", kId, 1},
                                                         {"wall_side", kWall, 1}});

struct GrainRow {
  int line = 0;
  std::array<double, kQuantities> value{};
};

/// Places of the columns in a line; -1 if there is none.
struct Layout {
  std::array<int, kQuantities> column;
  double per_diameter = 1;    ///< 2 if the column of diameters holds radii
  double first_wall = 1;      ///< smallest value of kWall for a wall grain
  std::size_t fields = 0;     ///< of each line
  bool more_allowed = false;  ///< further fields, which are ignored
  char separator = ' ';       ///< a blank: any number of blanks and tabs

  Layout() { column.fill(-1); }
  bool has(Quantity q) const { return column[static_cast<std::size_t>(q)] >= 0; }
  /// `count` quantities are in columns from `at` on.
  void set(Quantity first, std::size_t at, int count = 1) {
    std::iota(&column[first], &column[first] + count, static_cast<int>(at));
  }
};

/// The trimmed fields of a line.
std::vector<string_view> split(string_view text, char separator) {
  const bool blank = separator == ' ';
  std::vector<string_view> fields;
  for (;;) {
    const std::size_t end = text.find_first_of(blank ? " \t" : string_view(&separator, 1));
    const string_view field = trimmed(text.substr(0, end));
    if (!blank || !field.empty()) fields.push_back(field);
    if (end == text.npos) return fields;
    text.remove_prefix(end + 1);
  }
}

string_view unquoted(string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return quoted ? text.substr(1, text.size() - 2) : text;
}

class PackingReader {
 public:
  PackingReader(string_view text, string_view file, const PackingFacts& facts)
      : rest_(text), file_(file), facts_(facts) {}

  PackingFile read() {
    if (rest_.size() > kLargestPackingFile) {
      refuse_file(fmt::format("is larger than {} MiB", kLargestPackingFile >> 20),
                  "Leave out columns that are not positions, velocities or radii.");
    }
    check_characters(rest_, file_, "Save the positions as text: extended XYZ, LAMMPS data or CSV.");
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
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
      refuse_file("is none of the formats that can be read", kFormats);
    }
    return packing();
  }

 private:
  static constexpr const char* kFormats =
      "It takes extended XYZ (its first line is the number of grains), LAMMPS data (\"500 atoms\" "
      "in its header), a LAMMPS dump, or CSV whose first line names the columns, as x_m,y_m,z_m.";

  // --- Refusing ---

  [[noreturn]] void refuse_file(const string& problem, const string& remedy) const {
    refuse(file_, {}, "", problem, "", remedy);
  }
  [[noreturn]] void refuse_at(int line, const string& problem, const string& remedy) const {
    refuse(file_, {line, 1}, "", problem, "", remedy);
  }
  [[noreturn]] void refuse_line(const string& problem, const string& remedy) const {
    refuse_at(number_, problem, remedy);
  }
  /// `part` is of the present line.
  [[noreturn]] void refuse_part(string_view part, const string& key, const string& problem,
                                const string& remedy) const {
    const auto column = static_cast<int>(part.data() - line_.data()) + 1;
    refuse(file_, {number_, column}, key, problem, printable(part), remedy);
  }

  // --- Lines and numbers ---

  bool next_line() {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    line_ = rest_.substr(0, end);
    if (line_.ends_with('\r')) line_.remove_suffix(1);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number_;
    return true;
  }

  void require_line(const string& of) {
    if (!next_line()) refuse_line("the file ends after this line", "It lacks " + of + ".");
  }

  /// A finite number in the present line; `name` is for the message.
  double number(string_view part, const char* name) const {
    const bool sign = part.size() > 1 && part.front() == '+' && part[1] != '-';
    const auto value = read_number<double>(part.substr(sign ? 1 : 0));
    if (value && std::fabs(*value) <= kLargest) return *value;
    if (value) {
      refuse_part(part, name, "is not finite, or beyond 1e100",
                  "Remove this grain, or correct its value.");
    }
    if (part.find(',') != part.npos && part.find_first_not_of("+-0123456789,eE") == part.npos) {
      string point(part);
      std::ranges::replace(point, ',', '.');
      refuse_part(part, name, "is not a number", "A number takes a decimal point: " + point + ".");
    }
    refuse_part(part, name, "is not a number", "Write it in decimal digits, as 1.5e-3.");
  }

  /// Three of the words, each `step` after the one before.
  Eigen::Vector3d vector(const std::vector<string_view>& words, std::size_t first, std::size_t step,
                         const char* name) const {
    return {number(words[first], name), number(words[first + step], name),
            number(words[first + 2 * step], name)};
  }

  // --- Columns and rows ---

  /// Enters the columns of that name from place `at` on; ignores names that are not known.
  void enter(string_view name, std::size_t at, string_view part) {
    const ColumnName* known = find_named(kColumnNames, name);
    if (known == nullptr) return;
    for (int k = 0; k < known->count; ++k) {
      if (!layout_.has(static_cast<Quantity>(known->first + k))) continue;
      refuse_part(part, "", "names a column that occurs twice", "Keep one of them.");
    }
    layout_.set(known->first, at, known->count);
    if (name == "radius") layout_.per_diameter = 2;
  }

  void require_columns(const char* remedy) const {
    const bool moves = layout_.has(kVx) || layout_.has(kVy) || layout_.has(kVz);
    for (const Quantity q : {kX, kY, kZ, kVx, kVy, kVz}) {
      if (layout_.has(q) || (q >= kVx && !moves)) continue;
      refuse_line(fmt::format("the column {} is missing", kNamesInMessages[q]), remedy);
    }
  }

  /// Reads the present line as one grain.
  void add_row(const Layout& layout, std::vector<GrainRow>& rows) {
    const std::vector<string_view> fields = split(line_, layout.separator);
    if (fields.size() < layout.fields || (fields.size() > layout.fields && !layout.more_allowed)) {
      refuse_line(fmt::format("has {} fields instead of {}", fields.size(), layout.fields),
                  layout.separator == ',' && fields.size() > layout.fields
                      ? "Numbers take a decimal point, not a comma."
                      : "Each grain is one line with a value for each column.");
    }
    GrainRow row{.line = number_};
    for (std::size_t q = 0; q < kQuantities; ++q) {
      if (layout.column[q] < 0) continue;
      const string_view part = unquoted(fields[static_cast<std::size_t>(layout.column[q])]);
      row.value[q] = number(part, kNamesInMessages[q]);
    }
    row.value[kDiameter] *= layout.per_diameter;
    if (layout.has(kWall) && row.value[kWall] >= layout.first_wall) {
      ++wall_grains_;
      return;
    }
    rows.push_back(row);
  }

  /// Reads `count` lines, and requires that nothing follows.
  void read_rows(std::uint64_t count, int stated_in) {
    for (std::uint64_t k = 0; k < count; ++k) {
      if (!next_line()) {
        refuse_line(fmt::format("the file ends after {} of the {} grains that line {} states", k,
                                count, stated_in),
                    "Write the whole file, or correct the number.");
      }
      add_row(layout_, rows_);
    }
    while (next_line()) {
      if (trimmed(line_).empty()) continue;
      refuse_line(
          fmt::format("the file goes on after the {} grains that line {} states", count, stated_in),
          "Keep one frame, or correct the number.");
    }
  }

  void set_unit(LengthUnit unit) {
    if (facts_.unit && facts_.unit != unit) {
      refuse_line(
          fmt::format("states lengths in {}", name_of(unit)),
          fmt::format("The manifest says `unit: {}`: remove that key.", name_of(*facts_.unit)));
    }
    unit_ = unit;
  }

  // --- XYZ and extended XYZ ---

  void read_xyz() {
    next_line();
    const auto count = *read_number<std::uint64_t>(trimmed(line_));
    require_line("the comment and the grains");
    std::map<string, string_view, std::less<>> keys;
    for (string_view rest = trimmed(line_); !rest.empty(); rest = trimmed(rest)) {
      const std::size_t name_end = std::min(rest.find_first_of("= \t"), rest.size());
      const string_view name = rest.substr(0, name_end);
      rest.remove_prefix(name_end);
      if (!rest.starts_with('=')) {
        rest.remove_prefix(rest.empty() ? 0 : 1);
        continue;
      }
      rest.remove_prefix(1);
      const bool quoted = rest.starts_with('"') && rest.find('"', 1) != rest.npos;
      const std::size_t end = quoted ? rest.find('"', 1) + 1 : rest.find_first_of(" \t");
      const string_view value = rest.substr(0, end);
      if (!keys.emplace(name, unquoted(value)).second) {
        refuse_part(name, "", "is a key that occurs twice", "Keep one of them.");
      }
      rest.remove_prefix(value.size());
    }
    if (const auto unit = keys.find("length_unit"); unit != keys.end()) {
      const auto known = value_of<LengthUnit>(unit->second);
      if (!known) refuse_part(unit->second, "length_unit", "is not read", "It takes m or d.");
      set_unit(*known);
    }
    if (const auto lattice = keys.find("Lattice"); lattice != keys.end()) {
      const auto origin = keys.find("Origin");
      read_lattice(lattice->second, origin == keys.end() ? string_view() : origin->second);
    }
    if (const auto properties = keys.find("Properties"); properties != keys.end()) {
      read_properties(properties->second);
    } else {
      layout_.set(kX, 1, 3);
      layout_.fields = 4;
      layout_.more_allowed = true;
    }
    require_columns("Properties holds pos:R:3, and vel:R:3 if there are velocities.");
    read_rows(count, 1);
  }

  void read_properties(string_view text) {
    const std::vector<string_view> parts = split(text, ':');
    for (std::size_t k = 0; k < parts.size(); k += 3) {
      const auto count =
          k + 2 < parts.size() ? read_number<std::uint16_t>(parts[k + 2]) : std::nullopt;
      if (!count || *count == 0) {
        refuse_part(parts[k], "Properties", "is not a column",
                    "A column is NAME:TYPE:COUNT, as in species:S:1:pos:R:3.");
      }
      const string name = lower(parts[k]);
      const ColumnName* known = find_named(kColumnNames, name);
      if (known != nullptr && known->count != *count) {
        refuse_part(parts[k + 2], "Properties",
                    fmt::format("is not the number of columns of {}", printable(name)),
                    fmt::format("It takes {}.", known->count));
      }
      enter(name, layout_.fields, parts[k]);
      layout_.fields += *count;
    }
  }

  void read_lattice(string_view text, string_view origin) {
    const std::vector<string_view> parts = split(text, ' '), corner = split(origin, ' ');
    if (parts.size() != 9 || (!corner.empty() && corner.size() != 3)) {
      refuse_line("Lattice or Origin is not complete",
                  "They take 9 and 3 numbers: the edges of the box and its corner.");
    }
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) {
      edges.row(k) = vector(parts, 3 * static_cast<std::size_t>(k), 1, "Lattice");
    }
    const Eigen::Vector3d size = edges.diagonal();
    edges.diagonal().setZero();
    require_upright(edges.cwiseAbs().maxCoeff(), size.cwiseAbs().maxCoeff());
    const Eigen::Vector3d low =
        corner.empty() ? Eigen::Vector3d(0, 0, 0) : vector(corner, 0, 1, "Origin");
    set_box({low, low + size});
  }

  // --- Boxes ---

  void require_upright(double lean, double size) const {
    if (lean <= 1e-9 * size) return;
    refuse_line(fmt::format("the box is not orthogonal: an edge leans by {:.3g}", lean),
                "A start is upright. Of a sheared cell, write the state at the end of a cycle.");
  }

  void set_box(const Eigen::AlignedBox3d& box) {
    for (const int k : {0, 1, 2}) {
      const double size = box.sizes()[k];
      if (size > 0) continue;
      refuse_line(fmt::format("the box is {:.6g} long in {}", size, kNamesInMessages[k]),
                  "Its edges are positive.");
    }
    box_ = box;
    box_line_ = number_;
  }

  // --- LAMMPS data ---

  /// Whether the first lines hold one such as "500 atoms".
  bool states_atoms() const {
    static const std::regex count("[0-9][ \\t]+atoms");
    return std::regex_search(string(rest_.substr(0, 2000)), count);
  }

  void read_data() {
    next_line();
    read_title();
    std::uint64_t count = 0;
    int stated_in = 0;
    std::vector<GrainRow> velocities;
    Layout moving;
    moving.set(kId, 0);
    moving.set(kVx, 1, 3);
    moving.fields = 4;
    moving.more_allowed = true;
    string section, style;
    while (next_line()) {
      const std::size_t comment = std::min(line_.find('#'), line_.size());
      const string_view body = trimmed(line_.substr(0, comment));
      if (body.empty()) continue;
      if (std::isalpha(static_cast<unsigned char>(body.front())) != 0) {
        section = body;
        style = trimmed(line_.substr(std::min(comment + 1, line_.size())));
      } else if (section.empty()) {
        const std::vector<string_view> words = split(body, ' ');
        if (words.size() == 2 && words[1] == "atoms") {
          count = read_number<std::uint64_t>(words[0]).value_or(0);
          stated_in = number_;
        }
        read_bounds(words);
      } else if (section == "Atoms") {
        if (layout_.fields == 0) take_style(style, split(line_, ' ').size());
        add_row(layout_, rows_);
      } else if (section == "Velocities") {
        add_row(moving, velocities);
      }
    }
    const std::uint64_t found = rows_.size() + wall_grains_;
    if (found != count) {
      refuse_at(stated_in, fmt::format("states {} atoms, and there are {}", count, found),
                "Write the whole file, or correct the number.");
    }
    take_velocities(std::move(velocities));
  }

  /// Exports of this program state the unit and the planes of the cell.
  void read_title() {
    ours_ = line_.starts_with("LAMMPS data file by shearcell");
    for (const string_view si : {"units si", "units = si"}) {
      if (line_.find(si) != line_.npos) set_unit(LengthUnit::m);
    }
    const std::size_t at = line_.find("cell ");
    if (!ours_ || at == line_.npos) return;
    const std::vector<string_view> words = split(line_.substr(at + 5), ' ');
    if (words.size() != 8) refuse_line("the cell is not complete", "Export the run again.");
    const Eigen::AlignedBox3d cell(vector(words, 0, 2, "cell"), vector(words, 1, 2, "cell"));
    require_upright(std::fabs(number(words[7], "tilt")), cell.sizes().y());
    set_box(cell);
  }

  void read_bounds(const std::vector<string_view>& words) {
    if (ours_) return;
    if (words.size() == 6 && words[3] == "xy") {
      require_upright(vector(words, 0, 1, "tilt").cwiseAbs().maxCoeff(),
                      bounds_.isEmpty() ? 0 : bounds_.sizes().maxCoeff());
    }
    if (words.size() != 4 || !words[2].ends_with("lo")) return;
    const auto axis = string_view("xyz").find(words[2].front());
    if (axis == string_view::npos) return;
    const auto k = static_cast<Eigen::Index>(axis);
    bounds_.min()[k] = number(words[0], "box");
    bounds_.max()[k] = number(words[1], "box");
    if ((bounds_.max().array() >= -kLargest).all()) set_box(bounds_);
  }

  /// `style` as LAMMPS writes it after "Atoms #", or "": then the number of fields decides.
  void take_style(string_view style, std::size_t fields) {
    const bool five = fields == 5 || fields == 8, seven = fields == 7 || fields == 10;
    if (style.empty()) style = five ? "atomic" : seven ? "sphere" : style;
    if (style == "hybrid" && seven) style = "hybrid sphere";  // write_data names no substyles
    layout_.set(kId, 0);
    layout_.more_allowed = true;  // image flags
    std::size_t x = 2;
    if (style == "atomic") {
      layout_.fields = 5;
    } else if (style == "sphere" || style.starts_with("hybrid sphere")) {
      const bool hybrid = style != "sphere";
      x = hybrid ? 2 : 4;
      layout_.fields = 7;
      layout_.set(kDiameter, hybrid ? 5 : 2);
    } else {
      refuse_line(style.empty() ? fmt::format("an atom of {} fields is not read", fields)
                                : fmt::format("the atom style {} is not read", printable(style)),
                  "Write the data file with atom_style sphere or atomic.");
    }
    layout_.set(kX, x, 3);
    layout_.set(kWall, 1);  // the type
    layout_.first_wall = ours_ ? 2 : std::numeric_limits<double>::infinity();
  }

  void take_velocities(std::vector<GrainRow> velocities) {
    if (velocities.empty()) return;
    std::map<double, GrainRow*> waiting;
    for (GrainRow& grain : rows_) waiting[grain.value[kId]] = &grain;
    for (const GrainRow& row : velocities) {
      const auto found = waiting.extract(row.value[kId]);
      if (!found && ours_) continue;  // of a wall grain
      if (!found) {
        refuse_at(row.line,
                  fmt::format("atom {:.0f} has two velocities, or no position", row.value[kId]),
                  "Write the whole file.");
      }
      std::copy_n(&row.value[kVx], 3, &found.mapped()->value[kVx]);
    }
    if (!waiting.empty()) {
      refuse_at(velocities.back().line,
                fmt::format("atom {:.0f} has no velocity", waiting.begin()->first),
                "Write a velocity for each atom, each once, or leave the section out.");
    }
    layout_.set(kVx, 0);  // known
  }

  // --- LAMMPS dumps ---

  void read_dump() {
    std::optional<std::uint64_t> count;
    int stated_in = 0;
    while (next_line()) {
      const string_view item = trimmed(line_);
      if (item.starts_with("ITEM: ATOMS")) {
        if (!count) refuse_line("the number of atoms is missing", "Write the whole dump.");
        const std::vector<string_view> names = split(line_, ' ');
        layout_.fields = names.size() - 2;
        for (std::size_t k = 2; k < names.size(); ++k) enter(lower(names[k]), k - 2, names[k]);
        require_columns("Write them: dump ... custom ... id x y z vx vy vz.");
        return read_rows(*count, stated_in);
      }
      const bool bounds = item.starts_with("ITEM: BOX BOUNDS");
      const bool leans = bounds && item.find("xy") != item.npos;
      const std::vector<string_view> kinds = split(item, ' ');  // "... ss ss pp" at the end
      require_line("the rest of the dump");
      if (item == "ITEM: UNITS" && trimmed(line_) == "si") set_unit(LengthUnit::m);
      if (item == "ITEM: NUMBER OF ATOMS") {
        count = read_number<std::uint64_t>(trimmed(line_));
        stated_in = number_;
      }
      if (!bounds) continue;
      Eigen::AlignedBox3d box;
      for (int k = 0; k < 3; ++k) {
        if (k > 0) require_line("the rest of the box");
        const std::vector<string_view> words = split(line_, ' ');
        if (words.size() != (leans ? 3U : 2U)) {
          refuse_line("is not a lower and an upper bound", "Write the whole dump.");
        }
        box.min()[k] = number(words[0], "box");
        box.max()[k] = number(words[1], "box");
        const string_view kind = kinds[kinds.size() - 3 + static_cast<std::size_t>(k)];
        follows_[static_cast<std::size_t>(k)] = kind.find_first_of("sm") != kind.npos;
        if (leans) require_upright(std::fabs(number(words[2], "tilt")), box.sizes()[k]);
      }
      set_box(box);
    }
    refuse_line("the dump ends before its atoms", "Write the whole dump.");
  }

  // --- CSV ---

  static char separator_of(string_view header) {
    const std::size_t at = header.find_first_of(",;\t");
    return at == header.npos ? ',' : header[at];
  }

  /// A column's name without its unit: "x" of "x_m", "vx" of "vx_d_per_s".
  static std::pair<string, std::optional<LengthUnit>> name_and_unit(string_view part) {
    string name = lower(trimmed(unquoted(part)));
    for (const LengthUnit unit : {LengthUnit::m, LengthUnit::d}) {
      for (const char* per : {"_per_s", ""}) {
        const string ending = fmt::format("_{}{}", name_of(unit), per);
        if (name.ends_with(ending)) {
          name.resize(name.size() - ending.size());
          return {name, unit};
        }
      }
    }
    return {name, std::nullopt};
  }

  /// The line without what numpy writes before it.
  static string_view header_of(string_view line) {
    return line.substr(std::min(line.find_first_not_of("# \t"), line.size()));
  }

  static bool names_a_column(string_view line) {
    const string_view header = header_of(line);
    return std::ranges::any_of(split(header, separator_of(header)), [](string_view part) {
      return find_named(kColumnNames, name_and_unit(part).first) != nullptr;
    });
  }

  void read_csv() {
    next_line();
    const string_view header = header_of(line_);
    layout_.separator = separator_of(header);
    const std::vector<string_view> parts = split(header, layout_.separator);
    layout_.fields = parts.size();
    std::optional<LengthUnit> unit;
    bool any = false;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const auto [name, stated] = name_and_unit(parts[k]);
      const ColumnName* known = find_named(kColumnNames, name);
      if (known == nullptr || known->count != 1) continue;
      enter(name, k, parts[k]);
      if (known->first > kDiameter) continue;  // not a length
      if (any && stated != unit) {
        refuse_part(parts[k], "", "is in another unit than the columns before",
                    "Write all lengths in _m or all in _d.");
      }
      any = true;
      unit = stated;
    }
    require_columns("The first line names the columns, as x_m,y_m,z_m.");
    if (unit) set_unit(*unit);
    while (next_line()) {
      if (!trimmed(line_).empty()) add_row(layout_, rows_);
    }
  }

  // --- The packing ---

  void require_equal_diameters() const {
    if (!layout_.has(kDiameter)) return;
    const auto diameter = [](const GrainRow& row) { return row.value[kDiameter]; };
    const auto [least, most] = std::ranges::minmax_element(rows_, {}, diameter);
    const double small = diameter(*least), large = diameter(*most);
    if (small <= 0) {
      refuse_at(least->line, fmt::format("the diameter is {:.6g}", small), "It must be positive.");
    }
    if (large <= small * (1 + kTolerance)) return;
    refuse_at(most->line,
              fmt::format("the grains have diameters from {:.6g} (line {}) to {:.6g}, {:.2g} % "
                          "larger",
                          small, least->line, large, 100 * (large / small - 1)),
              "All grains of this program are equal. Continue such a packing in LAMMPS "
              "(`shearcell export --to lammps` writes a script for it).");
  }

  /// From the unit of the file to diameters.
  double scale() const {
    const std::optional<LengthUnit> unit = unit_ ? unit_ : facts_.unit;
    if (!unit) {
      refuse_file("does not state the unit of its lengths",
                  "Write `unit: m` or `unit: d` (grain diameters) beside `file` in the manifest.");
    }
    const double expected = unit == LengthUnit::m ? facts_.diameter_m : 1;
    const double given = rows_.front().value[kDiameter];
    if (layout_.has(kDiameter) && std::fabs(given - expected) > kTolerance * expected) {
      refuse_at(
          rows_.front().line, fmt::format("the diameter is {:.6g} {}", given, name_of(*unit)),
          unit == LengthUnit::m
              ? fmt::format("The run's is {:.6g} m: set `diameter_m`, or scale the file.", expected)
              : "Lengths in d are divided by the diameter, so it is 1.");
    }
    return 1 / expected;
  }

  void sort_by_id() {
    if (!layout_.has(kId)) return;
    std::ranges::stable_sort(rows_, {}, [](const GrainRow& row) { return row.value[kId]; });
    const auto same =
        std::ranges::adjacent_find(rows_, {}, [](const GrainRow& row) { return row.value[kId]; });
    if (same == rows_.end()) return;
    refuse_at(std::next(same)->line,
              fmt::format("the id {:.17g} is that of line {}, too", same->value[kId], same->line),
              "Each grain has an id of its own.");
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
    if (rows_.empty()) refuse_line("the file holds no grains", kFormats);
    require_equal_diameters();
    sort_by_id();
    const double scale_to_d = scale();
    PackingFile packing;
    packing.position = columns(kX, scale_to_d);
    if (layout_.has(kVx)) packing.velocity = columns(kVx, scale_to_d);
    const Eigen::Vector3d least = packing.position.rowwise().minCoeff();
    const Eigen::Vector3d most = packing.position.rowwise().maxCoeff();
    Eigen::AlignedBox3d space(least.array() - 1, most.array() + 1);
    if (box_) {
      space = {box_->min() * scale_to_d, box_->max() * scale_to_d};
      for (const int k : {0, 1}) {
        if (!follows_[static_cast<std::size_t>(k)]) continue;
        space.min()[k] = least[k];
        space.max()[k] = most[k];
      }
      packing.box = space;
    }
    const double longest = space.sizes().maxCoeff();
    if (longest > kLongestCell) {
      refuse_file(fmt::format("the packing is {:.3g} d long", longest),
                  fmt::format("At most {:g} d: is the unit of its lengths right?", kLongestCell));
    }
    if (box_) require_inside(space, packing.position);
    check_overlaps(space, packing.position);
    return packing;
  }

  /// In x and y; z is periodic and gets wrapped.
  void require_inside(const Eigen::AlignedBox3d& box, Eigen::Matrix3Xd& position) const {
    const double depth = box.sizes().z();
    if (depth < kShallowestCell) {
      refuse_at(box_line_, fmt::format("the box is {:.3g} d deep in z", depth),
                fmt::format("At least {:g} d: is the unit of its lengths right?", kShallowestCell));
    }
    for (Eigen::Index i = 0; i < position.cols(); ++i) {
      const auto& row = rows_[static_cast<std::size_t>(i)];
      for (const int k : {0, 1, 2}) {
        const double at = position(k, i), further = k == 2 ? kLongestCell : 0;
        if (at >= box.min()[k] - further && at <= box.max()[k] + further) continue;
        refuse_at(
            row.line,
            fmt::format("the grain is outside of the box: {} = {:.6g} d is not from {:.6g} to "
                        "{:.6g} d",
                        kNamesInMessages[k], at, box.min()[k], box.max()[k]),
            "Only z is periodic: wrap x and y into the box, or write a larger box.");
      }
      double& z = position(2, i);
      if (z < box.min().z() || z >= box.max().z()) {
        z -= depth * std::floor((z - box.min().z()) / depth);
      }
    }
  }

  /// Stops at the first pair, so that many grains at one place do not take long.
  void check_overlaps(const Eigen::AlignedBox3d& space, const Eigen::Matrix3Xd& position) const {
    const Eigen::Vector3d size = space.sizes();
    Cell cell;
    cell.width = size.x();
    cell.top = size.y();
    cell.depth = box_ ? size.z() : size.z() + kShallowestCell;  // no images without a box
    const Eigen::Matrix3Xd sites = position.colwise() - space.min();
    for_each_pair(cell, wall_pose(cell, 0, 0), sites, 1 - facts_.largest_overlap,
                  [&](std::int32_t i, std::int32_t j, const Eigen::Vector3d& r) {
                    const int first = rows_[static_cast<std::size_t>(i)].line;
                    const int second = rows_[static_cast<std::size_t>(j)].line;
                    const double overlap = 1 - r.norm();
                    if (overlap <= facts_.largest_overlap) return;
                    refuse_at(
                        std::max(first, second),
                        overlap == 1 ? fmt::format("the grain is at the place of that of line {}",
                                                   std::min(first, second))
                                     : fmt::format("the grain overlaps that of line {} by {:.3g} d",
                                                   std::min(first, second), overlap),
                        fmt::format("At most {:g} d (`max_overlap_diameters`): are the unit of "
                                    "the lengths and the diameter right? If so, let the grains "
                                    "relax in the program that made them.",
                                    facts_.largest_overlap));
                  });
  }

  static constexpr double kLargest = 1e100;   // so that products of two are finite
  static constexpr double kTolerance = 1e-5;  // relative; files may have six digits

  string_view rest_;
  string_view file_;
  PackingFacts facts_;
  string_view line_;
  int number_ = 0;
  bool ours_ = false;  ///< LAMMPS data of this program
  std::optional<LengthUnit> unit_;
  Layout layout_;
  std::vector<GrainRow> rows_;
  std::uint64_t wall_grains_ = 0;
  std::optional<Eigen::AlignedBox3d> box_;
  int box_line_ = 0;
  /// Axes along which LAMMPS shrinks the box to the grains; a dump has the box of an earlier step.
  std::array<bool, 3> follows_{};
  Eigen::AlignedBox3d bounds_;  ///< of LAMMPS data; empty along axes that are not read yet
};

}  // namespace

PackingFile read_packing(string_view text, string_view file, const PackingFacts& facts) {
  return PackingReader(text, file, facts).read();
}

}  // namespace shearcell
