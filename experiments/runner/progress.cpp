// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/progress.hpp"

#include <fmt/format.h>

#include "experiments/runner/terminal.hpp"
#include "provenance/words.hpp"

namespace shearcell {
namespace {

std::string describe(const StageStatus& status) {
  const double rate = status.steps_per_second * static_cast<double>(status.grains) * 1e-6;
  const std::string where =
      status.target_cycles > 0
          ? fmt::format("cycle {:.2f} of {:g}", status.cycle, status.target_cycles)
          : fmt::format("step {}", status.step);
  const std::string left =
      status.seconds_left >= 0 ? format_duration(status.seconds_left) + " left" : "";
  return fmt::format("{:<18} {:6.1f} M particle-steps/s  {}", where, rate, left);
}

}  // namespace

Progress::Progress(std::size_t stages, bool quiet)
    : stages_(stages), quiet_(quiet), terminal_(moves_cursor(stderr)) {}

Progress::~Progress() {
  erase();
}

void Progress::begin(const std::string& id, const std::string& name) {
  const std::lock_guard lock(mutex_);
  running_[id] = {name, "starting", {}};
  if (!terminal_ && !quiet_) print_stderr("{}: started\n", name);
}

void Progress::update(const std::string& id, const StageStatus& status) {
  const std::lock_guard lock(mutex_);
  Shown& shown = running_[id];
  shown.text = describe(status);
  if (quiet_) return;
  if (terminal_) {
    draw();
    return;
  }
  if (shown.said.seconds() < 10) return;
  shown.said.restart();
  print_stderr("{}: {}\n", shown.name, shown.text);
}

void Progress::end(const std::string& id, const std::string& name, const std::string& how,
                   bool done) {
  const std::lock_guard lock(mutex_);
  running_.erase(id);
  if (done) ++done_;
  if (quiet_) return;
  erase();
  print_stderr("{}: {} ({} of {} stages done)\n", name, how, done_, stages_);
  if (terminal_) draw();
}

void Progress::count() {
  const std::lock_guard lock(mutex_);
  ++done_;
}

void Progress::drop(const std::string& id) {
  const std::lock_guard lock(mutex_);
  running_.erase(id);
  erase();
}

void Progress::note(const std::string& line) {
  if (!quiet_) say(line);
}

void Progress::say(const std::string& line) {
  const std::lock_guard lock(mutex_);
  erase();
  print_stderr("{}\n", line);
}

void Progress::erase() {
  for (; drawn_ > 0; --drawn_) write_stderr("\x1b[1A\x1b[2K");
}

void Progress::draw() {
  erase();
  // A longer line would wrap, and drawing over it would leave its beginning behind.
  const std::size_t longest = terminal_columns(stderr).value_or(80) - 1;
  std::multimap<std::string, std::string> lines;
  for (const auto& [id, shown] : running_) lines.emplace(shown.name, shown.text);
  for (const auto& [name, text] : lines) {
    print_stderr("{:.{}}\n", fmt::format("{:<28} {}", name, text), longest);
    ++drawn_;
  }
}

}  // namespace shearcell
