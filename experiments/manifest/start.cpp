// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/manifest/start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <filesystem>
#include <vector>

#include "core/diagnostics.hpp"
#include "core/simulation.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/manifest/document.hpp"
#include "experiments/manifest/schema.hpp"
#include "provenance/json_text.hpp"
#include "provenance/sha256.hpp"

namespace shearcell {
namespace {

/// Whether `swept` and `others` have equal values for each key that both contain.
bool agree(const nlohmann::json& swept, const nlohmann::json& others) {
  return std::ranges::all_of(swept.items(), [&](const auto& entry) {
    const auto other = others.find(entry.key());
    return other == others.end() || *other == entry.value();
  });
}

/// Throws ManifestError if the variant's cell, grains or units differ from the recorded run's.
void require_same_cell(const Manifest& manifest, const Scale& scale, const Variant& variant,
                       const Stage& recorded) {
  Parameters had;
  try {
    had = read_stage(recorded.resolved).parameters;
  } catch (const UnreadableRecord& problem) {
    refuse(manifest.file, scale.start.at, "start",
           fmt::format("this version of the program cannot read run {:.8}: {}", recorded.id,
                       problem.what()),
           "", "Use the version of the program that computed this run, or choose another run.");
  }
  for (const Field& field : schema()) {
    const bool of_packing = field.identity.stage == StageKind::prepare &&
                            field.identity.distinguishes_runs() &&
                            !field.name.starts_with("settle_");
    if (!of_packing || field.identity.settles) continue;
    const nlohmann::json mine = field.get(variant.parameters), its = field.get(had);
    if (mine == its) continue;
    refuse(manifest.file, scale.start.at, std::string(field.name),
           fmt::format("differs from the value of run {:.8}, which gives the initial state",
                       recorded.id),
           value_text(mine), fmt::format("Write {}.", value_text(its)));
  }
}

/// Advice on how to make the cell `width` [d] wide and deep. It states the nominal packing fraction
/// that the manifest needs. If this fraction is out of range, the advice is to use another file of
/// grain positions. (A higher fraction makes the cell narrower.)
std::string remedy_for_width(const Parameters& p, double width) {
  Geometry shape = geometry(p);
  const Range& range = find_field("nominal_packing_fraction")->range;
  const auto excess = [&](double fraction) {
    shape.nominal_packing_fraction = fraction;
    return cell_width(shape) - width;
  };
  if (excess(range.min) < 0 || excess(range.max) > 0)
    return "No allowed nominal_packing_fraction gives a cell of this width. Use another file.";
  const auto [low, high] = boost::math::tools::bisect(excess, range.min, range.max,
                                                      boost::math::tools::eps_tolerance<double>());
  return fmt::format(
      "Write `nominal_packing_fraction: {:.10g}`. The cell then fits the file, if "
      "height_over_width is not changed.",
      0.5 * (low + high));
}

/// Places the grains between the wall planes of the cell. Throws ManifestError if the box or the
/// grains do not fit the width and depth of the cell.
///
/// Without a box, grains may overlap a side wall by the larger of `usual_overlap` and the deepest
/// overlap of two grains in the file. A packing that is under load or has not relaxed also overlaps
/// its walls, and its deepest contact can be at a wall. Deeper overlaps mean that the cell is
/// narrower than the packing.
State state_in(const Cell& cell, const PackingFile& grains, const std::string& path,
               const Parameters& p) {
  constexpr double tolerance = 1e-6;  // relative to the width
  constexpr double usual_overlap = 0.05;
  const Eigen::AlignedBox3d box =
      grains.box.value_or(Eigen::AlignedBox3d(grains.position.rowwise().minCoeff().array() - 0.5,
                                              grains.position.rowwise().maxCoeff().array() + 0.5));
  const Eigen::Vector3d low = box.min(), high = box.max(), size = box.sizes();
  for (const int axis : {0, 2}) {
    const double room = axis == 0 ? cell.width : cell.depth;
    // Without a box, grains may cross the periodic boundary in z.
    const double beyond = grains.box  ? 0
                          : axis == 2 ? 1
                                      : 2 * std::max(usual_overlap, grains.largest_overlap);
    const double over = size[axis] - room - beyond;
    const bool fits = grains.box ? std::fabs(over) <= tolerance * room : over <= tolerance * room;
    if (fits) continue;
    refuse(path, {}, "",
           fmt::format("the {} are {:.9g} d {}, but the cell of the manifest is {:.9g} d",
                       grains.box ? "box and grains" : "grains together", size[axis],
                       axis == 0 ? "wide (x)" : "deep (z)", room),
           "",
           fmt::format("Are the lengths in {}? If not, write the unit in the file (columns x_mm, "
                       "y_mm, z_mm; or length_unit=mm) or in the manifest (`unit: mm`). If the "
                       "unit is right: {}",
                       name_of(grains.unit), remedy_for_width(p, size[axis])));
  }
  const bool from_below = cell.moving == MovingWall::top;  // the bottom plane is fixed
  const Eigen::Vector3d shift = {grains.box ? -low.x() : 0.5 * (cell.width - low.x() - high.x()),
                                 from_below ? cell.bottom - low.y() : cell.top - high.y(),
                                 -low.z()};
  State state;
  state.position = grains.position.colwise() + shift;
  state.velocity =
      grains.velocity ? *grains.velocity : Eigen::Matrix3Xd::Zero(3, grains.position.cols());
  state.wall_height = from_below ? cell.bottom + size.y() : cell.top - size.y();
  return state;
}

}  // namespace

const Stage& recorded_run(const Manifest& manifest, const Scale& scale, const Variant& variant,
                          std::span<const Stage> known) {
  const Start& start = scale.start;
  const std::string scale_of_start = start.scale.empty() ? scale.name : start.scale;
  if (start.experiment == manifest.experiment &&
      scale_name(scale_of_start) == scale_name(scale.name)) {
    refuse(manifest.file, start.at, "start", "must name another experiment or scale", "",
           "Choose another `experiment` for this manifest.");
  }
  const auto is_it = [&](const Membership& m) {
    return m.newest && m.place.experiment == start.experiment &&
           scale_name(m.place.scale) == scale_name(scale_of_start) &&
           m.place.seed == variant.parameters.start_seed &&
           has_values(m.place.swept, start.variant);
  };
  std::vector<const Stage*> found;
  for (const Stage& stage : known) {
    if (stage.kind != name_of(StageKind::shear)) continue;
    const bool fits = start.run.empty() ? std::ranges::any_of(stage.memberships, is_it)
                                        : stage.id.starts_with(start.run);
    if (fits) found.push_back(&stage);
  }
  if (found.size() > 1 && start.run.empty()) {
    std::vector<const Stage*> agreeing = found;
    std::erase_if(agreeing, [&](const Stage* stage) {
      return std::ranges::none_of(stage->memberships, [&](const Membership& m) {
        return is_it(m) && agree(variant.swept, m.place.swept);
      });
    });
    if (!agreeing.empty() || start.variant.empty()) found = std::move(agreeing);
  }
  const std::string what =
      start.run.empty()
          ? fmt::format("run of {}{} with seed {}{}", start.experiment, at_scale(scale_of_start),
                        variant.parameters.start_seed,
                        start.variant.empty() ? "" : " and " + words_of(start.variant))
          : fmt::format("shear whose id begins with {}", start.run);
  if (found.size() != 1) {
    refuse(manifest.file, start.at, "start",
           fmt::format("the store has {} {}", found.empty() ? "no" : "more than one", what), "",
           found.empty()
               ? "Compute this run first, or use --store to open the store that contains it."
           : start.run.empty() ? "Select one: `variant: \"KEY=VALUE\"`. Put commas between pairs."
                               : "Give more digits of the id.");
  }
  const double cycle = static_cast<double>(variant.parameters.start_cycle);
  const double newest = found.front()->cycle;
  const std::vector<Ask> asks = asks_of(found.front()->memberships);
  const bool recorded = asks.empty() || std::ranges::any_of(asks, [&](const Ask& ask) {
                          return std::fmod(cycle, static_cast<double>(ask.checkpoint_every)) == 0 ||
                                 cycle == static_cast<double>(ask.target_cycles);
                        });
  if (newest < cycle || (newest > cycle && !recorded)) {
    refuse(
        manifest.file, start.at, "start",
        fmt::format("run {:.8} has no checkpoint at cycle {}", found.front()->id, cycle), "",
        fmt::format(
            "The newest checkpoint is at cycle {}. Extend the run, name another cycle, or run its "
            "manifest again with `checkpoints: {{every_cycles: 1}}`.",
            newest));
  }
  require_same_cell(manifest, scale, variant, *found.front());
  return *found.front();
}

PackingText read_packing_file(const Manifest& manifest, const Scale& scale) {
  namespace fs = std::filesystem;
  // A manifest from /dev/stdin or /dev/fd/N has no folder.
  const bool unnamed = manifest.file.starts_with("/dev/fd/") || manifest.file == "/dev/stdin";
  const fs::path path = fs::path(unnamed ? "" : manifest.file).parent_path() / scale.start.file;
  PackingText packing{path.string(), read_text(path, kLargestPackingFile), {}};
  packing.file = {sha256_hex(packing.text), scale.start.unit, scale.settle_at.line > 0};
  return packing;
}

PlacedGrains placed(const PackingText& packing, const Parameters& p, std::uint64_t seed,
                    const Poll& poll) {
  // The packing must pass the run's first overlap check. The limit of this check is
  // kLargestOverlapLimit if the grains settle first, and max_overlap_diameters otherwise.
  double limit = p.max_overlap_diameters;
  if (packing.file.settles) limit = std::max(limit, 0.9 * kLargestOverlapLimit);
  const PackingFile grains = read_packing(packing.text, packing.path,
                                          {.unit = packing.file.unit,
                                           .diameter_m = p.diameter_m,
                                           .largest_overlap = limit,
                                           .grains = p.grains});
  PlacedGrains made{make_cell(geometry(p), seed, poll), {}, describe(grains)};
  made.state = state_in(made.cell, grains, packing.path, p);
  const Eigen::RowVectorXd x = made.state.position.row(0);
  const double width = x.maxCoeff() - x.minCoeff() + 1;
  if (!grains.box && width <= made.cell.width - 1 && width >= kShallowestCell) {
    made.warning = fmt::format(
        "{}: the grains together are {:.6g} d wide (x), but the cell of the manifest is {:.6g} d. "
        "The cell has room for more grains. {}",
        packing.path, width, made.cell.width, remedy_for_width(p, width));
  }
  Contact deepest{};
  const WallPose pose = wall_pose(made.cell, 0, made.state.wall_height);
  for_each_contact(made.cell, made.state.position, pose, [&](const Contact& contact) {
    if (contact.overlap > deepest.overlap) deepest = contact;
  });
  if (deepest.overlap > limit) {
    const bool image = deepest.kind == Contact::Kind::grain;
    const Eigen::RowVectorXd z = made.state.position.row(2);
    refuse(
        packing.path, {}, "",
        fmt::format("a grain overlaps {} by {:.3g} d, more than {:g} d",
                    image ? "a periodic image of another grain" : "a wall", deepest.overlap, limit),
        "",
        image
            ? fmt::format("The cell of the manifest is {:.6g} d deep (z). {}", made.cell.depth,
                          remedy_for_width(p, z.maxCoeff() - z.minCoeff() + 1))
            : fmt::format(
                  "Rough walls have wall grains, whose positions depend on the seed. Use the "
                  "seed of the packing, a file with room for wall grains, or `walls: smooth`{}.",
                  packing.file.settles ? "" : " or, to let the grains settle first, `settle: {}`"));
  }
  return made;
}

}  // namespace shearcell
