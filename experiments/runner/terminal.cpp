// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "experiments/manifest/document.hpp"
#include "provenance/io/clock.hpp"

namespace shearcell {
namespace {

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// Of the bytes of UTF-8, all but those that continue a character.
bool begins_character(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
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

std::string for_terminal(std::string_view text) {
  std::string shown;
  for (;;) {
    const std::size_t end = text.find('\n');
    shown += without_controls(text.substr(0, end));
    if (end == std::string_view::npos) return shown;
    shown += '\n';
    text.remove_prefix(end + 1);
  }
}

std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, begins_character));
}

std::string_view first_characters(std::string_view text, std::size_t count) {
  std::size_t end = 0;
  for (; end < text.size(); ++end) {
    if (begins_character(text[end]) && count-- == 0) break;
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
