// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/terminal.hpp"

#include <locale.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <cwchar>
#include <memory>

#include "experiments/manifest/document.hpp"
#include "provenance/io/clock.hpp"

namespace shearcell {
namespace {

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

struct Character {
  std::size_t bytes = 1;
  std::size_t columns = 1;
};

/// The first character of a UTF-8 text that is not empty, whatever the program's locale.
Character first_character(std::string_view text) {
  static const locale_t utf8 = newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
  const locale_t before = utf8 == nullptr ? nullptr : uselocale(utf8);
  wchar_t character = 0;
  std::mbstate_t state{};
  const std::size_t bytes = std::mbrtowc(&character, text.data(), text.size(), &state);
  const int columns = wcwidth(character);
  if (before != nullptr) uselocale(before);
  if (bytes == 0 || bytes > text.size()) return {};
  return {bytes, columns < 0 ? 1 : static_cast<std::size_t>(columns)};
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
  return isatty(fileno(stream)) != 0 && environment("TERM") != "dumb";
}

bool shows_colours(std::FILE* stream) {
  return moves_cursor(stream) && environment("NO_COLOR").empty();
}

std::size_t columns_of(std::string_view text) {
  std::size_t columns = 0;
  while (!text.empty()) {
    const Character first = first_character(text);
    columns += first.columns;
    text.remove_prefix(first.bytes);
  }
  return columns;
}

std::string_view first_columns(std::string_view text, std::size_t count) {
  std::size_t end = 0;
  while (end < text.size()) {
    const Character next = first_character(text.substr(end));
    if (next.columns > count) break;
    count -= next.columns;
    end += next.bytes;
  }
  return text.substr(0, end);
}

void write_stderr(std::string_view text) noexcept {
  (void)!std::fwrite(text.data(), 1, text.size(), stderr);
}

std::function<void(std::size_t, std::size_t)> terminal_counter(std::string what) {
  if (isatty(STDERR_FILENO) == 0) {
    // Shared by all copies.
    return [what = std::move(what), said = std::make_shared<Stopwatch>()](std::size_t done,
                                                                          std::size_t total) {
      if (said->seconds() < 10) return;
      said->restart();
      write_stderr(fmt::format("{} {} of {}\n", what, done, total));
    };
  }
  return [what = std::move(what)](std::size_t done, std::size_t total) {
    write_stderr(fmt::format("\r{} {} of {}{}", what, done, total, done == total ? "\n" : ""));
  };
}

}  // namespace shearcell
