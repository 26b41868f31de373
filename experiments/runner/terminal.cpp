// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace shearcell {
namespace {

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

std::optional<std::size_t> terminal_columns(std::FILE* stream) {
  const int file = fileno(stream);
  if (isatty(file) == 0) return std::nullopt;
  winsize size{};
  if (ioctl(file, TIOCGWINSZ, &size) != 0 || size.ws_col < 20) return 80;
  return std::size_t{size.ws_col};
}

bool shows_colours(std::FILE* stream) {
  return isatty(fileno(stream)) != 0 && environment("NO_COLOR").empty() &&
         environment("TERM") != "dumb";
}

std::string for_terminal(std::string_view text) {
  std::string shown;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 'a');
    // U+0080 to U+009F are control characters too, two bytes each in UTF-8.
    const bool high = byte == 0xc2 && next >= 0x80 && next < 0xa0;
    const bool low = byte < 0x20 || byte == 0x7f;
    if (high || (low && text[i] != '\n')) {
      shown += fmt::format("\\x{:02x}", high ? next : byte);
      i += high ? 1 : 0;
    } else {
      shown += text[i];
    }
  }
  return shown;
}

}  // namespace shearcell
