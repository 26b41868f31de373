// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/shipped.hpp"

#include <algorithm>
#include <iterator>

#include "analysis/plots.hpp"
#include "core/named.hpp"
#include "experiments/manifest/shipped_texts.hpp"
#include "experiments/manifest/variants.hpp"

namespace shearcell {

std::vector<Figure> stated_figures(const Manifest& manifest) {
  const auto names = [labels = manifest.labels](const std::vector<nlohmann::json>& variants) {
    return variant_names(variants, labels);
  };
  const std::vector<PlotSpec> plots(manifest.plots.begin(), manifest.plots.end());
  const std::vector<ClaimSpec> claims(manifest.claims.begin(), manifest.claims.end());
  std::vector<Figure> figures = own_figures(plots, claims, names, manifest.question);
  for (Figure& figure : figures) figure.of = manifest.of;
  return figures;
}

std::span<const Manifest> shipped_manifests() {
  static const std::vector<Manifest> all = [] {
    std::vector<Manifest> manifests;
    for (const auto& [file, text] : shipped_texts) {
      Manifest& manifest = manifests.emplace_back(read_manifest(text, file, true));
      for (PlotSpec& plot : manifest.plots) plot.listed = true;
      for (ClaimSpec& claim : manifest.claims) claim.listed = true;
    }
    return manifests;
  }();
  return all;
}

std::span<const Figure> all_figures() {
  static const std::vector<Figure> all = [] {
    std::vector<Figure> figures(computed_figures().begin(), computed_figures().end());
    for (const Manifest& manifest : shipped_manifests()) {
      std::ranges::move(stated_figures(manifest), std::back_inserter(figures));
    }
    return figures;
  }();
  return all;
}

const Figure* find_figure(std::string_view name) {
  return find_named(all_figures(), name);
}

}  // namespace shearcell
