// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/cli/exit_code.hpp"

#include <nlohmann/json.hpp>

#include "core/filling.hpp"
#include "core/watchdog.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/plain_file.hpp"

namespace shearcell::cli {

namespace {

template <class... Errors>
bool is_any(const std::exception& error) {
  return ((dynamic_cast<const Errors*>(&error) != nullptr) || ...);
}

}  // namespace

ExitCode exit_code_of(const std::exception& error) {
  if (is_any<UsageError, NotOurs, GeometryError>(error)) return kUsageError;
  if (is_any<NumericalFailure>(error)) return kRunFailed;
  // JSON of manifests and options is checked where it is read; the rest are records of a store.
  if (is_any<StoreDamaged, nlohmann::json::exception>(error)) return kStoreDamaged;
  return kOtherError;
}

}  // namespace shearcell::cli
