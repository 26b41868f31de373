// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/stability/stability.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "experiments/manifest/suggest.hpp"

namespace shearcell {
namespace {

using Clock = std::chrono::steady_clock;
using stability::HardCase;
using stability::Outcome;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Outcome outcome_of(const HardCase& hard, bool quick) {
  try {
    return hard.run(quick);
  } catch (const std::exception& error) {
    return {false, std::string("threw: ") + error.what()};
  } catch (...) {
    return {false, "threw what is no std::exception"};
  }
}

// One character for the verdict, then the text.
[[noreturn]] void compute_and_exit(const HardCase& hard, bool quick, int to_parent) {
  const Outcome outcome = outcome_of(hard, quick);
  const std::string message = (outcome.as_expected ? '+' : '-') + outcome.text;
  for (std::size_t done = 0; done < message.size();) {
    const ssize_t n = write(to_parent, message.data() + done, message.size() - done);
    if (n < 0 && errno != EINTR) _exit(1);
    if (n > 0) done += static_cast<std::size_t>(n);
  }
  _exit(0);
}

// What the child writes until it closes its end; false when that took too long.
bool read_all(int from_child, double seconds, std::string& message) {
  const auto start = Clock::now();
  std::array<char, 4096> part{};
  for (;;) {
    const double left = seconds - seconds_since(start);
    if (left <= 0) return false;
    pollfd waiting{from_child, POLLIN, 0};
    if (poll(&waiting, 1, 1 + static_cast<int>(std::min(left, 1.0) * 1000)) <= 0) continue;
    const ssize_t n = read(from_child, part.data(), part.size());
    if (n == 0) return true;
    if (n > 0) message.append(part.data(), static_cast<std::size_t>(n));
    if (n < 0 && errno != EINTR) return true;
  }
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

Outcome compute_apart(const HardCase& hard, bool quick, double seconds) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) {
    throw std::system_error(errno, std::generic_category(), "pipe for a hard case");
  }
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) {
    const int why = errno;
    close(ends[0]);
    close(ends[1]);
    throw std::system_error(why, std::generic_category(), "process for a hard case");
  }
  if (child == 0) {
    close(ends[0]);
    compute_and_exit(hard, quick, ends[1]);
  }
  close(ends[1]);
  std::string message;
  const bool ended = read_all(ends[0], seconds, message);
  close(ends[0]);
  if (!ended) kill(child, SIGKILL);
  const int status = wait_for(child);
  if (!ended) return {false, fmt::format("hangs: no end within {:g} s", seconds)};
  if (WIFSIGNALED(status)) {
    return {false,
            fmt::format("crashed: {} (signal {})", strsignal(WTERMSIG(status)), WTERMSIG(status))};
  }
  if (status != 0 || message.empty()) return {false, "ended without an outcome"};
  return {message[0] == '+', message.substr(1)};
}

}  // namespace

namespace stability {

const Cases& hard_cases() {
  static const Cases cases = [] {
    Cases all;
    for (const auto group : {stability_limit_cases, time_step_cases, stiffness_cases, load_cases,
                             drive_cases, placement_cases, cell_cases, crystal_cases, long_cases}) {
      const Cases some = group();
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }();
  return cases;
}

}  // namespace stability

StabilityResult map_case(const HardCase& hard, bool quick, double seconds) {
  const auto start = Clock::now();
  const Outcome outcome = compute_apart(hard, quick, seconds);
  return {hard.name,    hard.done,           hard.expected,
          outcome.text, outcome.as_expected, seconds_since(start)};
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
  const auto wanted = [&](const HardCase& hard) {
    return options.only.empty() ||
           std::any_of(options.only.begin(), options.only.end(),
                       [&](const std::string& name) { return hard.name.starts_with(name); });
  };
  std::vector<StabilityResult> results;
  for (const HardCase& hard : stability::hard_cases()) {
    if (!wanted(hard)) continue;
    if (options.report) options.report(hard.name + ": " + hard.done);
    results.push_back(map_case(hard, options.quick, options.seconds_per_case));
  }
  return results;
}

}  // namespace shearcell
