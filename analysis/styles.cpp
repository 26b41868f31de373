// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/styles.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "analysis/published.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

json values_of(const json& variant, std::span<const std::string> keys) {
  json values = json::array();
  for (const std::string& key : keys) values.push_back(variant.value(key, json()));
  return values;
}

/// `count`: number of different sets of values. `rank`: index of one variant's set when sorted.
struct Rank {
  std::size_t rank = 0;
  std::size_t count = 0;
};
Rank rank_of(const json& variant, std::span<const json> variants,
             std::span<const std::string> keys) {
  std::set<json> all;
  for (const json& one : variants) all.insert(values_of(one, keys));
  const auto below = std::distance(all.begin(), all.lower_bound(values_of(variant, keys)));
  return {static_cast<std::size_t>(below), all.size()};
}

}  // namespace

Look amplitude_look(double amplitude_rad, std::size_t k) {
  constexpr std::array<std::size_t, 5> colours = {3, 6, 2, 0, 1};  // indices into safe_colours
  static_assert(colours.size() == published_amplitudes.size());
  const PublishedAmplitude& nearest = published_nearest(amplitude_rad);
  const auto place = static_cast<std::size_t>(&nearest - published_amplitudes.data());
  const bool published = std::abs(nearest.amplitude_rad - amplitude_rad) < 1e-6;
  const std::size_t colour = published ? colours[place] : k;
  return {safe_colours[colour % safe_colours.size()], curve_symbol(published ? place : k)};
}

Looks::Looks(const Frame& frame) : variants_(frame.variants) {
  if (variants_.empty()) {
    for (const FrameRun& run : frame.runs) variants_.push_back(run.place.swept);
  }
  keys_ = varied_keys(variants_, "experiment");
}

Look Looks::of(RunGroup curve, const json& key) const {
  const json& swept = curve.front()->place.swept;
  const bool one_variant =
      std::ranges::all_of(curve, [&](const FrameRun* run) { return run->place.swept == swept; });
  std::vector<std::string> keys = keys_;
  if (!one_variant) {
    keys.clear();
    for (const auto& [name, value] : key.items()) keys.push_back(name);
  }
  const json& variant = one_variant ? swept : key;
  const std::span all(keys);
  Rank first = rank_of(variant, variants_, all.first(std::min<std::size_t>(1, all.size())));
  Rank rest = rank_of(variant, variants_, all.subspan(std::min<std::size_t>(1, all.size())));
  // Colour and symbol change together if only one key varies, or if the keys have more values than
  // there are colours or symbols. 7 colours and 10 symbols then give 70 combinations.
  std::size_t dashes = rest.rank;
  if (rest.count <= 1 || first.count > safe_colours.size() || rest.count > curve_symbols) {
    first.rank = rest.rank = first.rank * std::max<std::size_t>(1, rest.count) + rest.rank;
    dashes = first.rank / safe_colours.size();
  }
  Look look = {safe_colours[first.rank % safe_colours.size()], curve_symbol(rest.rank),
               dashes % 2 == 1 ? Join::dashes : Join::line};
  const bool by_amplitude = !keys.empty() && keys.front() == "amplitude_rad";
  const auto is_published = [](const json& one) {
    const json amplitude = one.value("amplitude_rad", json());
    return amplitude.is_number() &&
           std::ranges::any_of(published_amplitudes, [&](const PublishedAmplitude& other) {
             return std::abs(other.amplitude_rad - amplitude.get<double>()) < 1e-6;
           });
  };
  if (by_amplitude && std::ranges::all_of(variants_, is_published)) {
    look.colour = amplitude_look(variant.at("amplitude_rad").get<double>(), 0).colour;
  }
  return look;
}

}  // namespace shearcell
