// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>
#include <utf8proc.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <vector>

#include "provenance/io/clock.hpp"

namespace shearcell {
namespace {

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

struct Extent {
  std::size_t bytes = 0;
  std::size_t columns = 0;
};

/// Size of the longest beginning of a UTF-8 text that fits into `limit` columns. A byte that is not
/// UTF-8 counts as one column.
Extent fitting(std::string_view text, std::size_t limit) {
  Extent size;
  while (size.bytes < text.size()) {
    const auto* rest = reinterpret_cast<const utf8proc_uint8_t*>(text.data()) + size.bytes;
    utf8proc_int32_t character = 0;
    const auto bytes = utf8proc_iterate(rest, std::ssize(text.substr(size.bytes)), &character);
    const int columns = bytes > 0 ? utf8proc_charwidth(character) : 1;
    if (static_cast<std::size_t>(columns) > limit - size.columns) break;
    size.bytes += static_cast<std::size_t>(std::max<std::ptrdiff_t>(bytes, 1));
    size.columns += static_cast<std::size_t>(columns);
  }
  return size;
}

}  // namespace

std::optional<std::size_t> terminal_columns(std::FILE* stream) {
  const int file = fileno(stream);
  if (isatty(file) == 0) return std::nullopt;
  winsize size{};
  if (ioctl(file, TIOCGWINSZ, &size) != 0 || size.ws_col < 20) return 80;
  return std::size_t{size.ws_col};
}

bool moves_cursor(std::FILE* stream) {
  const std::string_view kind = environment("TERM");
  return isatty(fileno(stream)) != 0 && !kind.empty() && kind != "dumb";
}

bool shows_colours(std::FILE* stream) {
  return moves_cursor(stream) && environment("NO_COLOR").empty();
}

std::size_t columns_of(std::string_view text) {
  return fitting(text, SIZE_MAX).columns;
}

std::string_view first_columns(std::string_view text, std::size_t count) {
  return text.substr(0, fitting(text, count).bytes);
}

std::string filled(std::string_view help, std::size_t width) {
  constexpr std::size_t kNarrowest = 24;  // minimum width of wrapped lines
  std::vector<std::string> paragraphs;
  std::istringstream lines{std::string(help)};
  bool goes_on = false;  // whether the next line may continue the paragraph
  for (std::string line; std::getline(lines, line);) {
    const bool heading = line.starts_with("Usage:") || (line.size() < 20 && line.ends_with(':'));
    const bool plain = !line.empty() && line[0] != ' ' && !heading;
    if (plain && goes_on) {
      paragraphs.back() += " " + line;
    } else {
      paragraphs.push_back(line);
    }
    goes_on = plain;
  }
  std::string text;
  for (const std::string& paragraph : paragraphs) {
    const std::size_t begin = paragraph.find_first_not_of(' ');
    std::size_t indent = begin == paragraph.npos ? 0 : begin;
    // If two or more blanks separate the text into two columns, wrapped lines are indented to the
    // beginning of the second column.
    const std::size_t blanks = indent > 0 ? paragraph.find("  ", indent) : paragraph.npos;
    if (blanks != paragraph.npos) indent = paragraph.find_first_not_of(' ', blanks);
    if (indent + kNarrowest > width) indent = std::min(begin, width / 2);
    std::string line = paragraph;
    while (columns_of(line) > width) {
      const std::size_t longest = first_columns(line, width + 1).size();
      std::size_t end = line.rfind(' ', longest - 1);
      if (end == line.npos || line.find_first_not_of(' ') > end) end = line.find(' ', longest);
      if (end == line.npos || end <= indent) break;  // one long word
      text += line.substr(0, line.find_last_not_of(' ', end) + 1) + '\n';
      line = std::string(indent, ' ') + line.substr(line.find_first_not_of(' ', end));
    }
    text += line + '\n';
  }
  return text;
}

void write_stderr(std::string_view text) noexcept {
  (void)!std::fwrite(text.data(), 1, text.size(), stderr);
}

std::function<void(std::size_t, std::size_t)> terminal_counter(std::string what) {
  // The function may be copied. All copies share the stopwatch.
  return [what = std::move(what), redraws = moves_cursor(stderr),
          said = std::make_shared<Stopwatch>()](std::size_t done, std::size_t total) {
    const std::string text = fmt::format("{} {} of {}", what, done, total);
    if (redraws) return write_stderr("\r" + text + (done == total ? "\n" : ""));
    if (said->seconds() < 10) return;
    said->restart();
    write_stderr(text + "\n");
  };
}

}  // namespace shearcell
