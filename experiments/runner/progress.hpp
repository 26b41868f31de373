// SPDX-License-Identifier: GPL-3.0-or-later
// Shows the progress of a campaign on standard error.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include "experiments/runner/stage.hpp"
#include "provenance/io/clock.hpp"

namespace shearcell {

/// On a terminal: one line per running stage, redrawn in place. Elsewhere: a plain line when a
/// stage begins or ends, and for each running stage at most one every ten seconds. Thread-safe.
class Progress {
 public:
  explicit Progress(std::size_t stages, bool quiet = false);
  ~Progress();

  /// `id` tells stages apart, `name` is shown.
  void begin(const std::string& id, const std::string& name);
  void update(const std::string& id, const StageStatus& status);
  /// `done` counts it among the stages that are done.
  void end(const std::string& id, const std::string& name, const std::string& how, bool done);
  /// Counts a stage that was done before among those that are done.
  void count();
  /// This program no longer computes the stage.
  void drop(const std::string& id);
  /// A permanent line, unless progress is off.
  void note(const std::string& line);
  /// A permanent line.
  void say(const std::string& line);

 private:
  struct Shown {
    std::string name, text;
    Stopwatch said;
  };

  void erase();
  void draw();

  std::mutex mutex_;
  std::size_t stages_, done_ = 0;
  bool quiet_, terminal_;
  std::size_t drawn_ = 0;                 ///< lines on the screen that the next drawing replaces
  std::map<std::string, Shown> running_;  ///< by id
};

}  // namespace shearcell
