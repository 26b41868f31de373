// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/stability/stability.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <system_error>
#include <thread>

#include "experiments/manifest/suggest.hpp"
#include "provenance/io/clock.hpp"
#include "provenance/io/file.hpp"

namespace shearcell::stability {

// The child writes '+' or '-' and the text to a temporary file.
Answer compute_apart(const HardCase& hard, double seconds) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "outcome";
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) {
    throw std::system_error(errno, std::generic_category(), "process for a hard case");
  }
  if (child == 0) {
    Answer outcome;
    try {
      outcome = hard.run();
    } catch (const std::exception& error) {
      outcome = {false, std::string("threw: ") + error.what()};
    }
    std::ofstream(file) << (outcome.as_expected ? '+' : '-') << outcome.text;
    _exit(0);
  }
  const Stopwatch watch;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (watch.seconds() > seconds) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
      return {false, fmt::format("hangs: no end within {:g} s", seconds)};
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (WIFSIGNALED(status)) {
    return {false,
            fmt::format("crashed: {} (signal {})", strsignal(WTERMSIG(status)), WTERMSIG(status))};
  }
  const std::string message = read_plain(file, std::size_t{1} << 24).value_or("");
  if (status != 0 || message.empty()) return {false, "ended without an outcome"};
  return {message[0] == '+', message.substr(1)};
}

Cases hard_cases(bool quick) {
  Cases all;
  add_time_step_cases(all);
  add_load_cases(all, quick);
  add_motion_cases(all);
  add_crystal_cases(all, quick);
  return all;
}

std::string unknown_case(const std::string& name) {
  const Cases cases = hard_cases(true);
  std::vector<std::string_view> names;
  for (const HardCase& hard : cases) {
    if (hard.name.starts_with(name)) return "";
    names.push_back(hard.name);
  }
  return with_nearest(fmt::format("no hard case is named '{}'", name), name, names);
}

std::vector<Result> map_stability(const Options& options) {
  std::vector<Result> results;
  for (const HardCase& hard : hard_cases(options.quick)) {
    const auto named = [&](const std::string& name) { return hard.name.starts_with(name); };
    if (!options.only.empty() && std::ranges::none_of(options.only, named)) continue;
    options.report(hard.name + ": " + hard.done);
    const Stopwatch watch;
    const Answer outcome = compute_apart(hard, options.seconds_per_case);
    results.push_back({hard, outcome, watch.seconds()});
  }
  return results;
}

}  // namespace shearcell::stability
