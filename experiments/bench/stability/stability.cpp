// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/stability/stability.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>

#include "experiments/manifest/suggest.hpp"
#include "provenance/io/clock.hpp"

namespace shearcell {
namespace {

using stability::HardCase;
using stability::Outcome;

Outcome outcome_of(const HardCase& hard, bool quick) {
  try {
    return hard.run(quick);
  } catch (const std::exception& error) {
    return {false, std::string("threw: ") + error.what()};
  }
}

// The child writes '+' or '-' and the text to a temporary file.
Outcome compute_apart(const HardCase& hard, bool quick, double seconds) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), std::fclose);
  std::fflush(nullptr);
  const pid_t child = file ? fork() : -1;
  if (child < 0) {
    throw std::system_error(errno, std::generic_category(), "process for a hard case");
  }
  if (child == 0) {
    const Outcome outcome = outcome_of(hard, quick);
    std::fputs(((outcome.as_expected ? '+' : '-') + outcome.text).c_str(), file.get());
    std::fflush(file.get());
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
  std::string message;
  std::array<char, 4096> part{};
  std::rewind(file.get());
  while (const std::size_t n = std::fread(part.data(), 1, part.size(), file.get())) {
    message.append(part.data(), n);
  }
  if (status != 0 || message.empty()) return {false, "ended without an outcome"};
  return {message[0] == '+', message.substr(1)};
}

}  // namespace

namespace stability {

const Cases& hard_cases() {
  static const Cases cases = [] {
    Cases all;
    for (const auto group : {time_step_cases, load_cases, motion_cases, crystal_cases}) {
      const Cases some = group();
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }();
  return cases;
}

}  // namespace stability

StabilityResult map_case(const HardCase& hard, bool quick, double seconds) {
  const Stopwatch watch;
  const Outcome outcome = compute_apart(hard, quick, seconds);
  return {hard.name, hard.done, hard.expected, outcome.text, outcome.as_expected, watch.seconds()};
}

std::string unknown_case(const std::string& name) {
  std::vector<std::string_view> names;
  for (const HardCase& hard : stability::hard_cases()) {
    if (hard.name.starts_with(name)) return "";
    names.push_back(hard.name);
  }
  const std::string near = suggest_name(name, names).name;
  return fmt::format("no hard case is named '{}'{}", name,
                     near.empty() ? "" : fmt::format("; did you mean '{}'?", near));
}

std::vector<StabilityResult> map_stability(const StabilityOptions& options) {
  for (const std::string& name : options.only) {
    if (const std::string why = unknown_case(name); !why.empty()) throw std::invalid_argument(why);
  }
  std::vector<StabilityResult> results;
  for (const HardCase& hard : stability::hard_cases()) {
    const auto named = [&](const std::string& name) { return hard.name.starts_with(name); };
    if (!options.only.empty() && std::ranges::none_of(options.only, named)) continue;
    if (options.report) options.report(hard.name + ": " + hard.done);
    results.push_back(map_case(hard, options.quick, options.seconds_per_case));
  }
  return results;
}

}  // namespace shearcell
