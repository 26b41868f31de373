// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/packing_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <ranges>
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

/// What a column can contain. In a kWall column, 0 (in a LAMMPS data file: type 1) marks a grain,
/// and a larger value marks a wall grain.
enum Quantity { kX, kY, kZ, kVx, kVy, kVz, kDiameter, kId, kWall, kQuantities };
constexpr const char* kColumns[] = {"x", "y", "z", "vx", "vy", "vz"};

/// The first bytes of compressed files, and the commands that decompress them.
constexpr std::pair<string_view, const char*> kCompressed[] = {{"\x1f\x8b", "gzip -dc"},
                                                               {"BZh9", "bzip2 -dc"},
                                                               {"\xfd\x37zXZ", "xz -dc"},
                                                               {"\x28\xb5\x2f\xfd", "zstd -dc"},
                                                               {"PK\3\4", "unzip -p"}};

/// What a column with one of these names contains. If several columns could contain the same
/// quantity, those with the lowest rank are read.
struct Meaning {
  /// In lower case. If count = 1, the first name means the quantity `first`, the second name means
  /// the next quantity, and so on. If count = 3, each name means three quantities: `first` and the
  /// next two.
  string_view names = {};
  int first = kQuantities;  ///< first quantity of the column; kQuantities: unknown
  int count = 1;            ///< number of values of the column in each row
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
  string_view name;  ///< "" for a column without a name
  int count = 1;     ///< number of values of the column in each row
};

struct GrainTable {
  string_view header = {};  ///< the line with the names of the columns
  std::vector<Column> columns = {};
  const char* more = nullptr;  ///< name for extra values in a row; null: extra values are an error
  char separator = ' ';        ///< ' ' means any number of blanks and tabs
  double first_wall = 1;       ///< a row is a wall grain if its value of kWall is at least this
  std::vector<string_view> rows = {};
};

/// A heading, and the lines up to the next heading.
struct Section {
  string_view heading;
  std::vector<string_view> lines = {};
};

struct Box {
  string_view line;            ///< the last line that was read for the box, or a part of this line
  Eigen::AlignedBox3d planes;  ///< empty along axes without bounds
  double lean = 0;             ///< largest off-axis component of an edge; 0 if orthogonal
};

struct Use {
  int quantity;
  std::size_t field;
  string_view column;
  double factor;
  int rank;
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

std::vector<string_view> split(string_view text, char separator = ' ') {
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

/// The unit with this name in lower case, or nothing. The unit um may also be written with
/// the micro sign (U+00B5) or the Greek letter mu (U+03BC).
std::optional<LengthUnit> unit_of(string_view name) {
  if (name == "\u00b5m" || name == "\u03bcm") return LengthUnit::um;
  if (name == "si") return LengthUnit::m;
  return name == "cgs" ? LengthUnit::cm : value_of<LengthUnit>(name);
}

/// `units`: whether a name in kMeanings may end in a unit, as in x_m. A name that is not in
/// kMeanings may still be recognized as a diameter, a position or a velocity. Such a diameter is
/// compared with the diameter of the run. A file with such a position or velocity is refused.
///
/// A file must give the same packing in all versions of this program, because the packing's id does
/// not change. Earlier versions ignored a velocity whose name is not in kMeanings. If this version
/// read the velocity, the packing would differ. Earlier versions also ignored columns such as x_mm
/// or "x [m]". This version reads them only in files that earlier versions refused: files that have
/// none of the columns x, x_m and x_d.
Meaning meaning_of(const Column& column, bool units) {
  static const std::regex with_unit(
      "(.+?)([ _]|[ _]*[\\[(])(d|[mcu]?m|\u00b5m|\u03bcm)(_per_s|/s)?[\\])]?");
  // LAMMPS or a user may write a prefix before a name, and an index or a unit after the name.
  static const string before = "([cfv]_|d2?_)?(particle|grain|sphere|atom|bead|ball)?[ _]?(";
  static const string after = ")([ _]*[\\[({/:.].*|[ _](m|d|si|lj|.?.m)([ _]?(per|p)?[ _]?s)?)?";
  static const string size = "(?!.*(max|min|cut|curvature|gyration|ratio)).*";
  static const string index = "[ _]?(p|i|0|50|eq|eff|mean)";  // d_p, R0, d50
  static const std::regex radius(before + "r|rads?|r" + index + after + "|" + size +
                                 "radi(us|i).*");
  static const std::regex diameter(before + "d|d" + index + "|dias?|sizes?|sigma|shape[ _]?[xyz]" +
                                   after + "|" + size + "diam(?!o).*");
  static const std::regex velocity(
      "(?!.*(ang|rot|omega|spin|vir|vor))"
      "(" +
      before + "(v|mom|speed)[ _]?[xyz0-9]?|v(cm|el|lin|avg)?[xyz]u?|[xyz](v|vel|dot)" + after +
      "|[pu][ _]?([xyz]|[:.\\[(][0-3xyz][\\])]?)|d([xyzr]|pos)/?dt|"
      "(.*[^a-z])?(vel.*|v[xyz]([^a-z].*)?)|.*(veloc|momenta|momentum).*)");
  static const std::regex position(
      before + "(pos|positions?|coords?|coordinates?|points?)[ _]?[xyz0-9]?|[xyz](su?|pos|coord)" +
      after);
  const string full = lower(column.name);
  string name = full;
  if (name.size() > 64) return {};  // limits the recursion
  std::optional<LengthUnit> unit;
  bool usual = true;
  if (std::smatch parts; units && std::regex_match(name, parts, with_unit)) {
    unit = unit_of(parts.str(3));
    usual = parts[2] == "_" && parts.length(3) == 1;
    name = parts.str(1);
  }
  for (Meaning meaning : kMeanings) {
    const std::vector<string_view> names = split(meaning.names);
    const auto at = std::ranges::find(names, name) - names.begin();
    if (at == std::ssize(names)) continue;
    meaning.unit = unit;
    if (!usual) meaning.rank = Meaning::second_best;
    if (meaning.count > column.count && column.count == 1) meaning.rank = Meaning::probable;
    if (meaning.count == 1) meaning.first += static_cast<int>(at);
    return meaning;
  }
  if (column.count == 3) name += "[0]";
  const auto is = [&](const std::regex& kind) {
    return std::regex_match(name, kind) || std::regex_match(full, kind);
  };
  return {.first = is(radius) || is(diameter) ? kDiameter
                   : is(velocity)             ? kVx
                   : is(position)             ? kX
                                              : kQuantities,
          .factor = is(radius) ? 2.0 : 1.0,
          .rank = Meaning::probable,
          .unit = unit};
}

/// Whether a part of a file concerns the box, a unit, the velocities, the shape of the grains or
/// the kind of the coordinates. `name`: the name of the part, such as a key or the heading of a
/// section.
bool concerns_grains(string_view name) {
  static const std::regex concerns(
      "(^|[^a-z]|super)lattice|(^|[^a-z]|sim|super)box|origin($|[^a-z])|"
      "(^|[^a-z])(domain|bounds|tilt)($|[^a-z])|"
      "(^|[^a-z]|unit|super|sim)cell(?!_height_d$|_?id)|^properties$|"
      "^columns$|^(l|len|length|size)_?[xyz]$|^[xyz]_?(lo|hi|min|max|len|length|size)($|[^a-z])|"
      "^(fractional|scaled|reduced)|^(coords?|coordinates?)($|_?(type|system|mode|style|format))|"
      "^(?!energy|force|stress|pressure|mass|charge|temp|formula|angle|density|freq|dipole|virial)"
      "(.*[^a-z])?"
      "(length|distance|position|velocity|time)?units?"
      "($|_?(of|length|distance|position|velocity|time|system|style))|"
      "^atoms$|^vel|(^| )(ellipsoids|lines|triangles|bodies)$");
  return std::regex_search(lower(name.substr(0, 64)), concerns);  // limits the recursion
}

/// Whether the text has exactly 6 or 9 consecutive numbers. A box may be written as 6 numbers (the
/// lengths and angles of the edges) or as 9 (the components of the edges).
bool may_be_box(string text) {
  std::ranges::replace_if(
      text, [](char c) { return string_view(",;\"'{}[]()").find(c) != string::npos; }, ' ');
  text += " end";
  std::size_t row = 0;
  for (const string_view word : split(text)) {
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
    for (const auto& [beginning, command] : kCompressed) {
      if (!text_.starts_with(beginning)) continue;
      refuse_file("is compressed", fmt::format("Decompress it with `{} {} > NEW_FILE`, and write "
                                               "the name of the new file in the manifest.",
                                               command, file_));
    }
    check_characters(text_, file_, "Save the positions as text: extended XYZ, LAMMPS data or CSV.");
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
    if (trimmed(text_).empty()) refuse_file("is empty", kFormats);
    for (string_view rest = text_; !rest.empty();) {
      const string_view line = rest.substr(0, rest.find('\n'));
      lines_.push_back(line.substr(0, line.size() - (line.ends_with('\r') ? 1 : 0)));
      rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    }
    static const std::regex states_atoms("[0-9][ \\t]+atoms");
    const string_view first = lines_.front();
    if (read_number<std::uint64_t>(trimmed(first))) {
      read_xyz();
    } else if (first.starts_with("ITEM:")) {
      read_dump();
    } else if (std::regex_search(string(text_.substr(0, 2000)), states_atoms)) {
      read_data();
    } else {
      read_csv();
    }
    return packing();
  }

 private:
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
  /// `in`: the line with the problem, or a part of this line.
  [[noreturn]] void refuse_line(string_view in, const string& problem, const string& remedy) const {
    refuse(file_, {place(in).line, 1}, "", problem, "", remedy);
  }
  [[noreturn]] void refuse_part(string_view part, string_view key, const string& problem,
                                const string& remedy) const {
    refuse(file_, place(part), string(key), problem, printable(part), remedy);
  }

  double number(string_view part, string_view name) const {
    const bool sign = part.size() > 1 && part.front() == '+' && part[1] != '-';
    const auto value = read_number<double>(part.substr(sign ? 1 : 0));
    if (value && std::fabs(*value) <= kLargest) return *value;
    refuse_part(part, name, "is not a number between -1e100 and 1e100",
                "Write the number with a decimal point, such as 1.5e-3.");
  }

  Eigen::VectorXd numbers(std::span<const string_view> words, string_view name) const {
    Eigen::VectorXd all(static_cast<Eigen::Index>(words.size()));
    std::ranges::transform(words, all.begin(), [&](auto word) { return number(word, name); });
    return all;
  }

  /// The lines that are not blank, without comments.
  static std::vector<string_view> rows(std::span<const string_view> lines, char comment = '\0') {
    std::vector<string_view> found;
    for (string_view line : lines) {
      line = line.substr(0, line.find(comment));
      if (!trimmed(line).empty()) found.push_back(line);
    }
    return found;
  }

  /// The sections of the file. The first line always counts as a heading.
  std::vector<Section> sections(bool (*is_heading)(string_view line)) const {
    std::vector<Section> all;
    for (const string_view line : lines_) {
      if (all.empty() || is_heading(trimmed(line))) {
        all.push_back({trimmed(line)});
      } else {
        all.back().lines.push_back(line);
      }
    }
    return all;
  }

  void require_count(string_view stated) const {
    if (read_number<std::uint64_t>(stated) == grains_.rows.size()) return;
    refuse_part(stated, "",
                fmt::format("is not the number of rows in this file, {}", grains_.rows.size()),
                "Use a complete file of one frame, or correct the number of grains.");
  }

  Box& box(string_view line) {
    if (!box_) box_.emplace();
    box_->line = line;
    return *box_;
  }

  void set_planes(Eigen::Index axis, string_view low, string_view high) {
    Eigen::AlignedBox3d& planes = box(low).planes;
    planes.min()[axis] = number(low, "box");
    planes.max()[axis] = number(high, "box");
  }

  void set_lean(string_view line, double by) {
    double& lean = box(line).lean;
    lean = std::max(lean, std::fabs(by));
  }

  static std::vector<Column> columns_of(string_view header, char separator = ' ') {
    std::vector<Column> columns;
    for (const string_view name : split(header, separator)) columns.push_back({unquoted(name)});
    return columns;
  }

  /// Lists a part of the file as not read.
  void leave(string_view name) {
    constexpr std::size_t most = 100;
    if (name.empty() || not_read_.size() == most) return;
    if (std::ranges::count(not_read_, printable(name)) == 0) not_read_.push_back(printable(name));
  }

  [[noreturn]] void refuse_form(string_view part) const {
    refuse_part(part, "", "cannot be read in this form", remedy_ + " Or remove this part.");
  }

  /// Lists a part of the file as not read, or refuses the part if it may concern the grains.
  void leave_or_refuse(string_view part) {
    if (concerns_grains(part)) refuse_form(part);
    leave(part);
  }

  /// The pairs KEY=VALUE of a comment, and the words between pairs as values without key. Blanks
  /// may be around `=`, and quotes or brackets around VALUE.
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
        if (!key.empty()) pairs.emplace_back("", key);
        continue;
      }
      cut(1);
      const bool blank = !cut(rest.find_first_not_of(" \t")).empty();
      const std::size_t mark = rest.empty() ? rest.npos : string_view("\"'{[(").find(rest.front());
      const std::size_t end = mark == rest.npos ? mark : rest.find("\"'}])"[mark], 1);
      const string_view word =
          rest.substr(0, end == rest.npos ? rest.find_first_of(" \t,;") : end + 1);
      const bool of_next = blank && end == rest.npos && word.find('=') != word.npos;  // "a= b=1"
      pairs.emplace_back(key, of_next ? string_view() : cut(word.size()));
    }
    return pairs;
  }

  void read_xyz() {
    remedy_ =
        "Use the keys Lattice (9 numbers), Origin (3 numbers), Properties (NAME:TYPE:COUNT of each "
        "column, with pos:R:3, and vel:R:3 if there are velocities), length_unit and "
        "velocity_unit, without blanks around `=`.";
    const string_view comment = lines_[std::min<std::size_t>(1, lines_.size() - 1)];
    grains_ = {.header = comment,
               .columns = columns_of("species x y z"),
               .more = "further columns",
               .rows = rows(std::span(lines_).subspan(std::min<std::size_t>(2, lines_.size())))};
    static constexpr string_view keys[] = {"Lattice", "Origin", "Properties", "length_unit",
                                           "velocity_unit"};
    static const std::regex other(
        "pbc|.*(stress|virial|strain|force|field|gravity|polari|moment|magmom).*",
        std::regex::icase);
    std::map<string_view, string_view> values;
    string words;
    for (const auto& [key, value] : pairs_of(comment)) {
      if (key.empty()) words.append(" ").append(value);
      const bool box =
          may_be_box(string(value)) && !std::regex_match(string(key.substr(0, 64)), other);
      // ASE writes unit_cell=conventional beside the lattice.
      const bool word = key == "unit_cell" && value.find_first_of("0123456789") == value.npos;
      if (word || (!box && !concerns_grains(key))) {
        if (key != "pbc" || value != "\"F F T\"") leave(key);
        continue;
      }
      const bool blanks = value.data() != key.data() + key.size() + 1;
      if (std::ranges::count(keys, key) == 0 || (blanks && !key.ends_with("unit"))) {
        refuse_form(key);
      }
      const bool quoted = value.size() > 1 && (value.front() == '"' || value.front() == '\'');
      if (!values.emplace(key, quoted ? value.substr(1, value.size() - 2) : value).second) {
        refuse_part(key, "", "is a key that occurs twice", "Keep one of them.");
      }
    }
    if (may_be_box(words)) refuse_form(comment);
    if (!words.empty()) leave("comment");
    take_units_of_text(comment);
    for (const char* key : {"length_unit", "velocity_unit"}) {
      const string_view unit = values[key];
      if (unit.data() == nullptr) continue;
      take_unit(unit.substr(0, unit.size() - (unit.ends_with("/s") ? 2 : 0)));
    }
    if (values.contains("Lattice") || values.contains("Origin")) {
      read_lattice(values["Lattice"], values["Origin"]);
    }
    if (values.contains("Properties")) read_properties(values["Properties"]);
    require_count(trimmed(lines_.front()));
  }

  void read_properties(string_view text) {
    grains_.columns.clear();
    grains_.more = nullptr;
    const std::vector<string_view> parts = split(text, ':');
    for (std::size_t k = 0; k < parts.size(); k += 3) {
      const auto count =
          k + 2 < parts.size() ? read_number<std::uint16_t>(parts[k + 2]) : std::nullopt;
      if (!count || *count == 0) refuse_form(parts[k]);
      const bool atomic = parts[k] == "Z" && parts[k + 1] == "I";  // quippy writes this column
      grains_.columns.push_back({atomic ? "atomic number" : parts[k], *count});
    }
  }

  void read_lattice(string_view text, string_view origin) {
    const std::vector<string_view> parts = split(text), corner = split(origin);
    if (parts.size() != 9 || (!corner.empty() && corner.size() != 3)) {
      refuse_form(grains_.header);
    }
    Eigen::Matrix3d edges = numbers(parts, "Lattice").reshaped(3, 3);
    const Eigen::Vector3d size = edges.diagonal();
    Eigen::Vector3d low(0, 0, 0);
    if (!corner.empty()) low = numbers(corner, "Origin");
    edges.diagonal().setZero();
    set_lean(grains_.header, edges.cwiseAbs().maxCoeff());
    box_->planes = {low, low + size};
  }

  void read_data() {
    remedy_ =
        "Write the box as xlo xhi, ylo yhi and zlo zhi, and the sections Atoms (atom_style sphere "
        "or atomic) and Velocities.";
    const std::vector<Section> all = sections([](string_view line) {
      return !line.empty() && std::isalpha(static_cast<unsigned char>(line.front())) != 0;
    });
    const Section& header = all.front();
    grains_.header = header.heading;
    moving_ = {.columns = columns_of("id vx vy vz"), .more = "angular velocities"};
    const bool ours = read_title(header.heading);
    for (const string_view line : header.lines) take_units_of_text(line);
    string_view count = header.heading;
    for (const string_view line : rows(header.lines, '#')) {
      const std::vector<string_view> words = split(line);
      if (words.size() == 2 && words[1] == "atoms") {
        count = words[0];
      } else if (!ours) {
        read_bounds(trimmed(line), words);
      }
    }
    for (const Section& section : all | std::views::drop(1)) {
      const std::size_t mark = std::min(section.heading.find('#'), section.heading.size());
      const string_view name = trimmed(section.heading.substr(0, mark));
      if (name == "Atoms") {
        grains_.rows = rows(section.lines, '#');
        if (grains_.rows.empty()) continue;
        const std::size_t after = std::min(mark + 1, section.heading.size());
        take_style(trimmed(section.heading.substr(after)), ours);
      } else if (name == "Velocities") {
        moving_.rows = rows(section.lines, '#');
      } else {
        leave_or_refuse(name);
      }
    }
    require_count(count);
  }

  /// Reads the units from the title and, in an export of this program, the planes of the cell.
  /// Returns whether the file is such an export.
  bool read_title(string_view title) {
    take_units_of_text(title);
    const std::size_t at = title.find("cell ");
    if (!title.starts_with("LAMMPS data file by shearcell") || at == title.npos) return false;
    const std::vector<string_view> words = split(title.substr(at + 5));
    if (words.size() != 8) refuse_form(title);
    for (const int k : {0, 1, 2}) set_planes(k, words[2U * k], words[2U * k + 1]);
    set_lean(title, number(words[7], "tilt"));
    return true;
  }

  void read_bounds(string_view line, const std::vector<string_view>& words) {
    const string_view low = words.size() == 4 && words[2].ends_with("lo") ? words[2] : "";
    const std::size_t axis = low.empty() ? low.npos : string_view("xyz").find(low.front());
    if (words.size() == 6 && words[3] == "xy") {
      set_lean(line, numbers(std::span(words).first(3), "tilt").cwiseAbs().maxCoeff());
    } else if (axis != string_view::npos) {
      set_planes(static_cast<Eigen::Index>(axis), words[0], words[1]);
    } else if (words.size() > 1 && read_number<double>(words[1])) {
      refuse_form(line);
    } else if (words[0] != "0" && words.back() != "types") {
      leave_or_refuse(line);
    }
  }

  /// Sets the columns by the atom style that LAMMPS writes after "Atoms #". If the file gives no
  /// style, the number of fields decides.
  void take_style(string_view style, bool ours) {
    const std::size_t fields = split(grains_.rows.front()).size();
    const bool five = fields == 5 || fields == 8, seven = fields == 7 || fields == 10;
    if (style.empty()) style = five ? "atomic" : seven ? "sphere" : style;
    if (style == "hybrid" && seven) style = "hybrid sphere";  // write_data omits substyles
    const char* columns = style == "atomic"                    ? "id type x y z"
                          : style == "sphere"                  ? "id type diameter density x y z"
                          : style.starts_with("hybrid sphere") ? "id type x y z diameter density"
                                                               : nullptr;
    if (columns == nullptr) {
      refuse_line(grains_.rows.front(),
                  fmt::format("atoms of style '{}' with {} fields cannot be read", printable(style),
                              fields),
                  remedy_);
    }
    grains_.columns = columns_of(columns);
    grains_.more = "image flags";
    if (ours) grains_.columns[1].name = "wall_side";  // type 1: grain; type > 1: wall grain
    grains_.first_wall = 2;
  }

  void read_dump() {
    remedy_ =
        "Write ITEM: BOX BOUNDS and ITEM: UNITS as in LAMMPS. Write the columns id x y z vx vy vz. "
        "The coordinates must not be scaled.";
    string_view count = lines_.front();
    for (const Section& section :
         sections([](string_view line) { return line.starts_with("ITEM:"); })) {
      const string_view name = trimmed(section.heading.substr(string_view("ITEM:").size()));
      const std::vector<string_view> lines = rows(section.lines);
      const string_view value = trimmed(lines.empty() ? section.heading : lines.front());
      if (!grains_.rows.empty()) refuse_form(section.heading);  // a second frame
      if (name.starts_with("ATOMS")) {
        grains_.header = section.heading;
        grains_.columns = columns_of(name.substr(string_view("ATOMS").size()));
        grains_.rows = lines;
      } else if (name.starts_with("BOX BOUNDS")) {
        read_dump_box(section.heading, lines);
      } else if (name == "UNITS") {
        take_unit(value);
      } else if (name == "NUMBER OF ATOMS") {
        count = value;
      } else if (!name.starts_with("TIME")) {
        leave_or_refuse(name);
      }
    }
    require_count(count);
  }

  void read_dump_box(string_view item, const std::vector<string_view>& lines) {
    const std::vector<string_view> words_of_item = split(item);
    const auto kinds = std::span(words_of_item).last(3);  // "ss ss pp"
    const bool ours = kinds[0] != "pp" && kinds[1] != "pp" && kinds[2] == "pp";
    if (kinds[2] != "BOUNDS" && !ours) leave(fmt::format("boundary {}", fmt::join(kinds, " ")));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::vector<string_view> words = k < lines.size() ? split(lines[k]) : split("");
      if (words.size() != 2 && words.size() != 3) refuse_form(item);
      set_planes(static_cast<Eigen::Index>(k), words[0], words[1]);
      if (words.size() == 3) set_lean(lines[k], number(words[2], "tilt"));
    }
  }

  static char separator_of(string_view header) {
    const std::size_t at = field_end(header, ",;\t");
    return at == header.npos ? ' ' : header[at];
  }

  /// The line without the # and the blanks that numpy writes at the beginning.
  static string_view header_of(string_view line) {
    return line.substr(std::min(line.find_first_not_of("# \t"), line.size()));
  }

  void read_csv() {
    remedy_ = string(kFormats) +
              " Velocities are vx_m_per_s and so on. The unit can be m, d, mm, cm or um.";
    const string_view stated = unquoted(lines_.front());  // Excel reads and writes a line `sep=;`
    const bool is_stated = lower(stated.substr(0, 4)) == "sep=" && lines_.size() > 1;
    const string_view line = lines_[is_stated ? 1 : 0], header = header_of(line);
    const char separator = is_stated && stated.size() == 5 ? stated[4] : separator_of(header);
    grains_ = {.header = line,
               .columns = columns_of(header, separator),
               .separator = separator,
               .rows = rows(std::span(lines_).subspan(is_stated ? 2 : 1))};
    units_in_names_ = true;
  }

  /// Reads the unit from a text such as "lengths in mm". Scaled coordinates are refused like an
  /// unknown unit.
  void take_units_of_text(string_view line) {
    static const std::regex unit(
        "\\b(?:(?:units?|lengths?|distances?|pos(?:itions?)?|coord\\w{0,9}|[xyz](?=\\s{0,9}[\\[(]))"
        "\\b"
        "(?:[\\s=:\"'\\[(]|of|in|are|is|lengths?|distances?|positions?){1,12}|"
        "in\\s{1,9}(?!(?:real|metal|micro|nano|electron|si|lj|cgs|aa?)\\b))"
        "(real|metal|micro|nano|electron|si|lj|cgs|m|d|(?:[ckmunp]|\xC2\xB5|\xCE\xBC)m|fractional|"
        "scaled|reduced(?!\\s{1,9}unit)|(?:milli|centi|micro|nano|kilo)?met(?:er|re)s?|microns?|"
        "a\\.u\\.|aa?|ang|au|inch(?:es)?|f(?:ee)?t|mils?|pixels?|voxels?|"
        "[0-9.]{1,20}(?:e|\\^)[-+]?[0-9]{1,4}\\s{0,9}[cmunp]?m)(?!\\w)"
        "(?!\\s*=|\\s{1,9}dimension|[-/^:])|"
        // No packing of this program is in one of these units, wherever a text names them.
        "(?:^|[^*/\\w]|\\b(?:[xyz]|lengths?|pos\\w{0,9}|coord\\w{0,9})/"
        ")((?:a|\xC3[\x85\xA5])ng?str(?:o|\xC3\xB6)ms?|\xC3\x85|"
        "\xE2\x84\xAB|bohrs?|atomic units?)(?![\\w^*\xC2\xE2-])|"
        "\\b(?:fractional|scaled|reduced)\\s{1,9}coord|"
        "\\b(?:(?:lattice|length|box|position)_?)?scale(?:_?factor)?=[0-9.]+(?![\\w.])",
        std::regex::icase);
    const string text(line.substr(0, 20'000));
    for (std::sregex_iterator at(text.begin(), text.end(), unit), end; at != end; ++at) {
      const std::size_t group = (*at)[1].matched ? 1 : (*at)[2].matched ? 2 : 0;
      if (at->str(group) == "a") continue;  // the article; the unit is written A
      take_unit(line.substr(static_cast<std::size_t>(at->position(group)),
                            static_cast<std::size_t>(at->length(group))));
    }
  }

  /// Sets the unit of lengths to `text`, the unit in the file. The value "lj" sets no unit.
  void take_unit(string_view text) {
    const string name = lower(text);
    if (name == "lj") return;
    const std::optional<LengthUnit> unit = unit_of(name);
    if (!unit) {
      refuse_part(text, "units", "cannot be read",
                  fmt::format("The unit of lengths must be one of {}, si, cgs, lj. With lj, the "
                              "manifest must give the unit.",
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
      refuse_line(in,
                  fmt::format("gives lengths in {}, but {} has lengths in {}", name_of(unit),
                              unit_ ? "another part of the file" : "the manifest", name_of(*other)),
                  "Write all lengths in one unit, and state it in the file or as `unit` in the "
                  "manifest.");
    }
    unit_ = unit;
  }

  void interpret_box() {
    if (!box_) return;
    const Eigen::Vector3d size = box_->planes.sizes();
    if ((size.array() <= 0).any()) {
      refuse_line(box_->line,
                  fmt::format("the box is not complete, or has an edge that is not positive: "
                              "{:.6g} x {:.6g} x {:.6g}",
                              size.x(), size.y(), size.z()),
                  remedy_);
    }
    if (box_->lean > 1e-9 * size.maxCoeff()) {
      refuse_line(box_->line,
                  fmt::format("the box is not orthogonal: an edge leans by {:.3g}", box_->lean),
                  "Use a rectangular box. A sheared cell is rectangular at the end of a cycle.");
    }
  }

  /// Decides which columns are read. The names of other columns go to not_read_.
  std::vector<Use> interpret(const GrainTable& table) {
    constexpr std::size_t most = 1000;
    // Narrower than concerns_grains(): a column `lattice` may be a measure of each grain.
    static const std::regex of_box("(.*[^a-z])?(box|tilt|units?)([^a-z].*)?|l_?[xyz]");
    if (table.columns.size() > most) {
      refuse_line(table.header, fmt::format("has {} columns", table.columns.size()),
                  fmt::format("At most {} columns can be read. Leave out some columns.", most));
    }
    struct Candidate {
      Column column;
      Meaning meaning;
      std::size_t field;  ///< index of the column's first field within a row
    };
    std::vector<Candidate> candidates;
    std::size_t fields = 0;
    for (const Column& column : table.columns) {
      candidates.push_back({column, meaning_of(column, units_in_names_), fields});
      fields += static_cast<std::size_t>(column.count);
    }
    std::ranges::stable_sort(candidates, {}, [](const auto& one) { return one.meaning.rank; });
    std::vector<Use> uses;
    std::optional<std::optional<LengthUnit>> unit;  // of the columns read so far
    for (auto& [column, meaning, field] : candidates) {
      const auto other = std::ranges::find(uses, meaning.first, &Use::quantity);
      if (meaning.first == kQuantities || (other != uses.end() && other->rank < meaning.rank)) {
        if (column.name.empty()) leave(fmt::format("column {}", field + 1));
        if (std::regex_match(lower(column.name.substr(0, 64)), of_box)) refuse_form(column.name);
        leave(column.name);
        continue;
      }
      if (meaning.rank == Meaning::probable && meaning.first != kDiameter) {
        refuse_part(column.name, "", "is not a valid name for a position or velocity",
                    remedy_ + " Or remove this column.");
      }
      if (meaning.count != column.count) {
        refuse_part(column.name, "", fmt::format("has {} values in each row", column.count),
                    fmt::format("It must have {}.", meaning.count));
      }
      for (int k = 0; k < meaning.count; ++k) {
        if (meaning.first != kDiameter && holds(uses, meaning.first + k)) {
          refuse_part(column.name, "", "is a column that occurs twice", "Keep one of them.");
        }
        uses.push_back({meaning.first + k, field + static_cast<std::size_t>(k), column.name,
                        meaning.factor, meaning.rank});
      }
      if (meaning.first > kDiameter) continue;  // not a length
      if (!meaning.unit) meaning.unit = stated_unit();
      if (unit && meaning.unit != *unit) {
        refuse_part(column.name, "", "is in another unit than the earlier columns",
                    "Write all lengths in m (x_m) or all in d (x_d).");
      }
      unit = meaning.unit;
    }
    if (unit && *unit) set_unit(**unit, table.header);
    return uses;
  }

  void require_columns() const {
    const bool moves = holds(uses_, kVx) || holds(uses_, kVy) || holds(uses_, kVz);
    for (const int q : {kX, kY, kZ, kVx, kVy, kVz}) {
      if (holds(uses_, q) || (q >= kVx && !moves)) continue;
      refuse_line(grains_.header, fmt::format("the column {} is missing", kColumns[q]), remedy_);
    }
  }

  /// The diameter of the run's grains in the unit of the file.
  double diameter() const { return facts_.diameter_m / metres(unit_.value(), facts_.diameter_m); }

  /// Reads the rows of a table. Sorts them by id if they have ids. Each diameter must be the
  /// diameter of the run's grains.
  std::vector<GrainRow> rows_of(const GrainTable& table, const std::vector<Use>& uses) {
    std::size_t columns = 0;
    for (const Column& column : table.columns) columns += static_cast<std::size_t>(column.count);
    std::vector<GrainRow> rows;
    for (const string_view line : table.rows) {
      const std::vector<string_view> fields = split(line, table.separator);
      const bool more = fields.size() > columns;
      if (fields.size() < columns || (more && table.more == nullptr)) {
        refuse_line(line, fmt::format("has {} fields instead of {}", fields.size(), columns),
                    "Each grain is one line with a value for each column. Write numbers with a "
                    "decimal point, not a comma.");
      }
      if (more) leave(table.more);
      GrainRow& row = rows.emplace_back(GrainRow{.line = line});
      for (const Use& use : uses) {
        const auto q = static_cast<std::size_t>(use.quantity);
        const string_view field = unquoted(fields[use.field]);
        row.value[q] = use.factor * number(field, use.column);
        if (use.quantity != kDiameter) continue;
        if (std::fabs(row.value[q] - diameter()) <= kTolerance * diameter()) continue;
        refuse_part(field, use.column,
                    fmt::format("is not the {} of the manifest's grains, {:.6g} {}",
                                use.factor > 1 ? "radius" : "diameter", diameter() / use.factor,
                                name_of(unit_.value())),
                    "This program needs equal grains. Check the unit. If it is right, set "
                    "`diameter_m` or scale the lengths in the file. If the column holds something "
                    "other than diameters or radii, remove the column. To shear unequal grains, "
                    "use LAMMPS (`shearcell export --to lammps`).");
      }
    }
    if (!holds(uses, kId)) return rows;
    const auto id = [](const GrainRow& row) { return row.value[kId]; };
    std::ranges::stable_sort(rows, {}, id);
    const auto same = std::ranges::adjacent_find(rows, {}, id);
    if (same == rows.end()) return rows;
    refuse_line(std::next(same)->line,
                fmt::format("the id {:.17g} is also in line {}", id(*same), line_of(*same)),
                "Give each grain a different id.");
  }

  /// Sets the velocity of each atom to the velocity with the same id in the table of velocities.
  void join_velocities() {
    const std::vector<GrainRow> moving = rows_of(moving_, interpret(moving_));
    const auto id = [](const GrainRow& row) { return row.value[kId]; };
    const auto [atom, other] = std::ranges::mismatch(rows_, moving, {}, id, id);
    if (atom != rows_.end() || other != moving.end()) {
      refuse_line(other == moving.end() ? atom->line : other->line,
                  "the sections Atoms and Velocities do not have the same ids",
                  "Write one velocity for each atom, or leave out the section Velocities.");
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      std::copy_n(&moving[i].value[kVx], 3, &rows_[i].value[kVx]);
    }
  }

  Eigen::Matrix3Xd columns(Quantity first) const {
    Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Eigen::Map<const Eigen::Vector3d> row(&rows_[i].value[first]);
      all.col(static_cast<Eigen::Index>(i)) = row * (1 / diameter());
    }
    return all;
  }

  PackingFile packing() {
    interpret_box();
    std::vector<string> aside = std::exchange(not_read_, {});  // list unread columns first
    uses_ = interpret(grains_);
    require_columns();
    unit_ = stated_unit();
    if (!unit_) {
      refuse_file("does not give the unit of its lengths",
                  "Write `unit: m` or `unit: d` (grain diameters) beside `file` in the manifest.");
    }
    rows_ = rows_of(grains_, uses_);
    if (!moving_.rows.empty()) join_velocities();
    const std::size_t wall_grains = std::erase_if(
        rows_, [&](const GrainRow& row) { return row.value[kWall] >= grains_.first_wall; });
    if (rows_.empty()) refuse_line(grains_.header, "the file has no grains", kFormats);
    if (facts_.grains > 0 && rows_.size() != facts_.grains) {
      refuse_file(fmt::format("has {}, but the manifest asks for {}",
                              counted(rows_.size(), "grain"), facts_.grains),
                  fmt::format("Write `grains: {}`.", rows_.size()));
    }
    for (const string& name : aside) leave(name);
    if (wall_grains > 0) leave(counted(wall_grains, "wall grain"));
    PackingFile packing;
    packing.position = columns(kX);
    packing.unit = *unit_;
    packing.not_read = not_read_;
    if (holds(uses_, kVx) || !moving_.rows.empty()) packing.velocity = columns(kVx);
    const Eigen::AlignedBox3d extent(packing.position.rowwise().minCoeff().array() - 1,
                                     packing.position.rowwise().maxCoeff().array() + 1);
    Eigen::AlignedBox3d space = extent;
    if (box_) {
      const double scale = 1 / diameter();
      space = {box_->planes.min() * scale, box_->planes.max() * scale};
      packing.box = space;
    }
    const Eigen::Vector3d size = space.merged(extent).sizes();
    if (size.maxCoeff() > kLongestCell || (box_ && space.sizes().z() < kShallowestCell)) {
      refuse_file(
          fmt::format("box and grains together are {:.3g} x {:.3g} x {:.3g} d large", size.x(),
                      size.y(), size.z()),
          fmt::format("At most {:g} d are allowed along each axis, and a box needs at least "
                      "{:g} d along z. Is the unit of lengths right?",
                      kLongestCell, kShallowestCell));
    }
    if (box_) require_inside(space, packing.position);
    packing.largest_overlap = check_overlaps(space, packing.position);
    return packing;
  }

  /// Reports a grain outside of the box in x or y as an error. Wraps z into the periodic box.
  void require_inside(const Eigen::AlignedBox3d& box, Eigen::Matrix3Xd& position) const {
    const double depth = box.sizes().z();
    for (Eigen::Index i = 0; i < position.cols(); ++i) {
      const auto& row = rows_[static_cast<std::size_t>(i)];
      for (const int k : {0, 1}) {
        const double at = position(k, i);
        if (at >= box.min()[k] && at <= box.max()[k]) continue;
        refuse_line(
            row.line,
            fmt::format(
                "the grain is outside of the box: {} = {:.6g} d is not between {:.6g} and {:.6g} d",
                kColumns[k], at, box.min()[k], box.max()[k]),
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
    // A Cell is periodic in z, but a packing without a box is not. The additional depth prevents
    // contacts across the periodic boundary.
    cell.depth = size.z() + (box_ ? 0 : kShallowestCell);
    const Eigen::Matrix3Xd sites = position.colwise() - space.min();
    double largest = 0;
    for_each_pair(cell, wall_pose(cell, 0, 0), sites, 1,
                  [&](std::int32_t i, std::int32_t j, const Eigen::Vector3d& r) {
                    largest = std::max(largest, 1 - r.norm());
                    if (largest <= facts_.largest_overlap) return;
                    const GrainRow* first = &rows_[static_cast<std::size_t>(i)];
                    const GrainRow* second = &rows_[static_cast<std::size_t>(j)];
                    if (first->line.data() > second->line.data()) std::swap(first, second);
                    refuse_line(
                        second->line,
                        fmt::format("the grain overlaps the grain in line {} by {:.3g} d",
                                    line_of(*first), largest),
                        fmt::format("At most {:g} d are allowed (`max_overlap_diameters`). Check "
                                    "`diameter_m` and the unit of the lengths. If both are right, "
                                    "let the grains relax in the program that made the file.",
                                    facts_.largest_overlap));
                  });
    return largest;
  }

  static constexpr double kLargest = 1e100;   // products of two values are finite
  static constexpr double kTolerance = 1e-5;  // relative; files may have only six digits

  string_view text_;
  string_view file_;
  const PackingFacts& facts_;
  std::vector<string_view> lines_;

  string remedy_;  ///< for messages: how to write box, columns and units in this format
  std::optional<Box> box_;
  GrainTable grains_, moving_;
  bool units_in_names_ = false;  ///< whether names of columns contain units
  std::vector<string> not_read_;

  std::optional<LengthUnit> unit_;
  std::vector<Use> uses_;
  std::vector<GrainRow> rows_;
};

}  // namespace

double metres(LengthUnit unit, double diameter_m) {
  static constexpr double length[] = {1, 0, 1e-3, 1e-2, 1e-6};  // in the order of LengthUnit
  return unit == LengthUnit::d ? diameter_m : length[static_cast<std::size_t>(unit)];
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
