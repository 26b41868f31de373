// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that is measured on one checkpoint.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "analysis/crystal.hpp"
#include "analysis/mechanics.hpp"
#include "provenance/checkpoint.hpp"

namespace shearcell {

/// A function measured on one packing, as g(r): values at ascending x.
struct MeasuredCurve {
  std::vector<double> x, y;
};

/// Of one packing. Means over no grain at all are not a number.
struct Measures {
  std::size_t grains = 0;               ///< N
  std::size_t interior_grains = 0;      ///< N_inves, at least 1.5 d from the wall surfaces
  double phi = 0;                       ///< Eq. S4 over interior grains
  double phi_uncorrected = 0;           ///< phi_u, Eq. S2 over interior grains
  double crystalline_percent = 0;       ///< of interior grains [%]
  double fcc_percent = 0;               ///< of interior grains [%]
  double hcp_percent = 0;               ///< of interior grains [%]
  double mean_overlap = 0;              ///< Eq. S3 over all pairs of grains [d]
  double contacts_per_grain = 0;        ///< with grains and wall grains, over all grains
  std::size_t crystallites = 0;         ///< of interior grains
  std::size_t largest_crystallite = 0;  ///< grains in it
  /// phi after a rest (protocols/rest.hpp); not a number unless a figure asked for it.
  double phi_at_rest = std::numeric_limits<double>::quiet_NaN();
  std::optional<Mechanics> mechanics;  ///< of a checkpoint, where asked for
  MechanicalUnits units;
  /// What else was asked for (derived_measures.hpp), by the names of the measures.
  std::map<std::string, double, std::less<>> numbers;
  std::map<std::string, MeasuredCurve, std::less<>> curves;
  std::optional<CrystalliteMap> crystallite_map;
};

/// A member of Mechanics.
struct MechanicalMember {
  std::string_view cached_as;  ///< the name that cached results give it, with its unit there
  double Mechanics::*value;
  double MechanicalUnits::*unit;  ///< turns it into SI; null for a number that has none
};

/// One of Measures::numbers.
struct NumberOf {
  /// The DerivedMeasure that has it; "drive" and "ledger" are not taken from an Analysis
  /// (experiments/figures/more_measures.hpp).
  std::string_view derived;
  std::uint64_t cycles_back = 0;  ///< to the earlier checkpoint that it needs too; 0 for none
};

/// A scalar of Measures, by the name that tables, plots and exports give it.
struct ScalarMeasure {
  std::string_view name;  ///< with its unit, unless it is a count or a pure number
  std::string_view unit;  ///< "1" for none
  std::string_view meaning;
  std::variant<double Measures::*, std::size_t Measures::*, MechanicalMember, NumberOf> member;

  /// Name of the DerivedMeasure that it is cached in.
  std::string_view derived() const;
  std::uint64_t cycles_back() const;  ///< as NumberOf::cycles_back
  /// In `unit`; not a number where it is unknown.
  double of(const Measures& measures) const;
};
/// N is a parameter of the run, so it is not a measure; cached results have it all the same.
std::span<const ScalarMeasure> all_scalar_measures();
std::span<const ScalarMeasure> cached_scalar_measures();
/// The one of that name, or null.
const ScalarMeasure* find_measure(std::string_view name);

/// A function of Measures, by the name that tables and plots give it.
struct CurveMeasure {
  std::string_view name;  ///< with its unit, unless it is a pure number
  std::string_view unit;  ///< "1" for none
  std::string_view meaning;
  std::string_view x, x_unit;
  std::string_view derived;               ///< the DerivedMeasure that has it
  double MechanicalUnits::*si = nullptr;  ///< turns it into its unit; null for a pure number

  /// In `unit`; empty where it was not measured.
  MeasuredCurve of(const Measures& measures) const;
};
std::span<const CurveMeasure> all_curve_measures();
/// The one of that name, or null.
const CurveMeasure* find_curve_measure(std::string_view name);

/// One entry per grain, by grain id.
struct GrainMeasures {
  std::vector<double> cell_volume;      ///< [d^3]
  std::vector<double> cell_surface;     ///< [d^2]
  std::vector<double> largest_overlap;  ///< delta_max,i [d]
  std::vector<std::int32_t> contacts;   ///< with grains and wall grains
  std::vector<double> phi_local;
  std::vector<double> q6;
  std::vector<double> pressure;        ///< [k/d]; of a checkpoint
  std::vector<Structure> structure;    ///< of every grain, near the walls too
  std::vector<std::uint8_t> interior;  ///< 1 or 0
  Crystallites crystallites;           ///< of crystalline interior grains
};

struct Analysis {
  Measures measures;
  GrainMeasures grains;
  CrystalliteMap crystallites;  ///< where they are
};

/// Measures of a packing and of each of its grains; mechanics of a checkpoint only. Throws
/// AnalysisError as voronoi() does, and for a cell less than 1 d deep, which no engine takes.
Analysis analyse(const Cell& cell, const WallPose& pose, const Eigen::Matrix3Xd& positions);
Analysis analyse(const Checkpoint& checkpoint);

/// Share of the interior grains for which `holds` [%]; not a number without any.
template <class Predicate>
double percent_of_interior(const GrainMeasures& grains, const Predicate& holds) {
  double count = 0, found = 0;
  for (std::size_t i = 0; i < grains.interior.size(); ++i) {
    if (grains.interior[i] == 0) continue;
    ++count;
    found += holds(i) ? 1 : 0;
  }
  return 100 * found / count;
}

/// 1 for crystalline interior grains, else 0.
std::vector<std::uint8_t> crystalline_interior(const GrainMeasures& grains);

/// Of the cells of interior grains [d^2]; 0 without any.
double mean_surface(const GrainMeasures& grains);

}  // namespace shearcell
