// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/bench/accuracy/packings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>

#include "core/threads.hpp"

namespace shearcell::accuracy {

Parameters small_cell(bool quick) {
  Parameters parameters;
  parameters.grains = quick ? 300 : 600;
  return parameters;
}

std::vector<Packing> packings(const Options& options, std::size_t seeds) {
  std::vector<Packing> all(seeds);
  in_parallel(seeds, options.jobs,
              [&](std::size_t s) { all[s] = settled(small_cell(options.quick), s + 1); });
  return all;
}

void in_parallel(std::size_t count, std::size_t jobs,
                 const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex mutex;
  {
    const auto some = [&](std::size_t) {
      try {
        for (std::size_t n = next++; n < count; n = next++) work(n);
      } catch (...) {
        next = count;
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
      }
    };
    const auto threads = start_threads(std::min<std::size_t>(jobs, count), some);
    some(0);
  }
  if (failure) std::rethrow_exception(failure);
}

double seconds_per_cycle(const Parameters& p, double time_step, double engine_rate) {
  return p.period_s / time_step * static_cast<double>(p.grains) / (1e6 * engine_rate);
}

std::string short_number(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "";
}

std::string with_error(const RunStatistics& of, int digits) {
  return fmt::format("{:.{}f} +- {:.{}f}", of.mean.value_or(std::nan("")), digits,
                     of.standard_error.value_or(std::nan("")), digits);
}

}  // namespace shearcell::accuracy
