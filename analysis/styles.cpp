// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/styles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "provenance/json_text.hpp"

namespace shearcell {
namespace {

using nlohmann::json;

json values_of(const json& variant, std::span<const std::string> keys) {
  json values = json::array();
  for (const std::string& key : keys) values.push_back(variant.value(key, json()));
  return values;
}

/// Rank of `variant` if `variants` are sorted by the values of `keys`. Variants with equal values
/// have equal ranks.
struct Rank {
  std::size_t rank = 0;   ///< from 0
  std::size_t count = 0;  ///< number of different ranks
};
Rank rank_of(const json& variant, std::span<const json> variants,
             std::span<const std::string> keys) {
  std::set<json> all;
  for (const json& one : variants) all.insert(values_of(one, keys));
  const auto below = std::distance(all.begin(), all.lower_bound(values_of(variant, keys)));
  return {static_cast<std::size_t>(below), all.size()};
}

bool is_published(double amplitude_rad) {
  return std::abs(published_nearest(amplitude_rad).amplitude_rad - amplitude_rad) < 1e-6;
}

/// Whether the variant agrees with `where` in all keys that both have.
bool may_have(const json& variant, const json& where) {
  return std::ranges::all_of(where.items(), [&](const auto& stated) {
    return !variant.contains(stated.key()) || is_within(variant[stated.key()], stated.value());
  });
}

}  // namespace

Look amplitude_look(double amplitude_rad, std::size_t k) {
  constexpr std::array<std::size_t, 5> colours = {3, 6, 2, 0, 1};  // indices into safe_colours
  static_assert(colours.size() == published_amplitudes.size());
  const PublishedAmplitude& nearest = published_nearest(amplitude_rad);
  const auto place = static_cast<std::size_t>(&nearest - published_amplitudes.data());
  const bool published = is_published(amplitude_rad);
  const std::size_t colour = published ? colours[place] : k;
  return {safe_colours[colour % safe_colours.size()], curve_symbol(published ? place : k)};
}

std::vector<AmplitudeRuns> by_amplitude(std::span<const FrameRun> runs) {
  std::vector<AmplitudeRuns> all;
  for (auto& [amplitude, members] : runs_by(runs, "amplitude_rad")) {
    all.push_back({amplitude, members, formula(fmt::format("$A$ = {}", amplitude)),
                   amplitude_look(amplitude, all.size()), &published_nearest(amplitude)});
  }
  return all;
}

Looks::Looks(const Frame& frame, std::vector<StatedLook> stated, std::vector<std::string> shared)
    : variants_(frame.variants.empty() ? swept_of(pointers(frame.runs)) : frame.variants),
      keys_(varied_keys(variants_, "experiment")),
      stated_(std::move(stated)),
      shared_(std::move(shared)) {}

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
  const std::span all(keys), of_colour = all.first(std::min<std::size_t>(1, all.size()));
  std::vector<std::string> palette(safe_colours.begin(), safe_colours.end());
  std::vector<json> free = variants_;  // variants without a stated colour
  std::vector<std::string> in_panel = keys;
  std::erase_if(in_panel, [&](const auto& name) { return std::ranges::count(shared_, name) > 0; });
  StatedLook stated;
  bool single = false;  // stated.colour belongs to a single curve of the panel
  for (const StatedLook& one : stated_) {
    std::set<json> curves, colours;
    for (const json& other : variants_) {
      if (!may_have(other, one.where)) continue;
      curves.insert(values_of(other, in_panel));
      colours.insert(values_of(other, of_colour));
    }
    if (colours.size() > 1) continue;
    if (!one.colour.empty()) {
      std::erase(palette, one.colour);
      std::erase_if(free, [&](const json& other) { return may_have(other, one.where); });
    }
    const bool of_curve = std::ranges::all_of(
        curve, [&](const FrameRun* run) { return has_parameters(*run, one.where); });
    const bool alone_in_panel = of_curve && curves.size() <= 1;
    if (of_curve && stated.colour.empty() && !one.colour.empty()) {
      stated.colour = one.colour;
      single = alone_in_panel;
    }
    if (alone_in_panel && stated.point < 0) stated.point = one.point;
  }
  if (palette.empty()) palette.assign(safe_colours.begin(), safe_colours.end());
  const bool is_free = std::ranges::any_of(
      free, [&](const json& other) { return values_of(other, all) == values_of(variant, all); });
  const std::span<const json> among = is_free ? free : variants_;
  Rank first = rank_of(variant, among, of_colour);
  Rank rest = rank_of(variant, among, all.subspan(of_colour.size()));
  // Colour and symbol change together if only one key varies, or if the keys have more values than
  // there are colours or symbols. Lines of one colour are solid and dashed in turn.
  bool dashed = rest.rank % 2 == 1;
  if (rest.count <= 1 || first.count > palette.size() || rest.count > curve_symbols) {
    first.rank = rest.rank = first.rank * std::max<std::size_t>(1, rest.count) + rest.rank;
    dashed = first.rank / palette.size() % 2 == 1;
  }
  Look look = {palette[first.rank % palette.size()], curve_symbol(rest.rank),
               dashed ? Join::dashes : Join::line};
  const auto amplitude_of = [](const json& one) {
    const json value = member_of(one, "amplitude_rad");
    return value.is_number() ? value.get<double>() : std::nan("");
  };
  // Whether the palette still contains the colour of the amplitude. The colours that the manifest
  // gives were removed from the palette above.
  const auto has_own_colour = [&](const json& one) {
    return std::ranges::count(palette, amplitude_look(amplitude_of(one), 0).colour) > 0;
  };
  if (!keys.empty() && keys.front() == "amplitude_rad" && has_own_colour(variant) &&
      std::ranges::all_of(variants_, is_published, amplitude_of) &&
      std::ranges::all_of(free, has_own_colour)) {
    look.colour = amplitude_look(amplitude_of(variant), 0).colour;
  }
  if (!stated.colour.empty()) look.colour = stated.colour;
  if (single) look.join = Join::line;
  if (stated.point >= 0) look.point = stated.point;
  return look;
}

}  // namespace shearcell
