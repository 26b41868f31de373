// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/verdict.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace shearcell {
namespace {

nlohmann::json rounded(const std::optional<double>& value) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return std::stod(fmt::format("{:.6g}", *value));
}

}  // namespace

const char* name_of(Ruling ruling) {
  switch (ruling) {
    case Ruling::pass:
      return "pass";
    case Ruling::fail:
      return "fail";
    case Ruling::too_few_runs:
      break;
  }
  return "too few runs to tell";
}

Verdict below_if(bool enough, std::string claim, std::string quantity, std::optional<double> value,
                 double limit, std::string note) {
  Verdict verdict{std::move(claim),     std::move(quantity), value, limit,
                  Ruling::too_few_runs, std::move(note)};
  if (value && !std::isfinite(*value)) verdict.value.reset();
  if (enough && verdict.value)
    verdict.ruling = *verdict.value < limit ? Ruling::pass : Ruling::fail;
  return verdict;
}

Verdict below(std::string claim, std::string quantity, std::optional<double> value, double limit,
              std::string note) {
  return below_if(true, std::move(claim), std::move(quantity), value, limit, std::move(note));
}

Ruling overall(std::span<const Verdict> verdicts) {
  Ruling result = verdicts.empty() ? Ruling::too_few_runs : Ruling::pass;
  for (const Verdict& verdict : verdicts) {
    if (verdict.ruling == Ruling::fail) return Ruling::fail;
    if (verdict.ruling == Ruling::too_few_runs) result = Ruling::too_few_runs;
  }
  return result;
}

nlohmann::json to_json(std::span<const Verdict> verdicts) {
  nlohmann::json claims = nlohmann::json::array();
  for (const Verdict& verdict : verdicts) {
    claims.push_back({{"claim", verdict.claim},
                      {"quantity", verdict.quantity},
                      {"value", rounded(verdict.value)},
                      {"limit", rounded(verdict.limit)},
                      {"verdict", name_of(verdict.ruling)},
                      {"note", verdict.note}});
  }
  return {{"verdict", name_of(overall(verdicts))}, {"claims", claims}};
}

}  // namespace shearcell
