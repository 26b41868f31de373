// SPDX-License-Identifier: GPL-3.0-or-later
// One packing for three programs: `bench_peers prepare DIR N SIMD` writes it for LAMMPS and
// LIGGGHTS, `ours DIR N SIMD` times the same steps here (processor time), `compare DIR N SIMD`
// compares the positions of every dump in DIR with ours. peers.sh runs them. SIMD is avx-512, avx2,
// neon, scalar, or best.
//
// The scene: the rough cell of Table I, pressed, then upright with all walls fixed (a moving wall
// of huge mass), random velocities, no gravity.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>

#include "core/random.hpp"
#include "core/simulation.hpp"
#include "experiments/bench/packing.hpp"
#include "experiments/manifest/conversion.hpp"
#include "experiments/runner/host.hpp"
#include "provenance/io/clock.hpp"

namespace shearcell {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kAccuracySteps = 200;
constexpr std::uint64_t kSpeedSteps = 2000;

// Velocities are those of the whole step.
using Kicked = bench::Packing;

Kicked prepare(std::size_t grains) {
  Parameters parameters;
  parameters.grains = grains;
  parameters.gravity_m_per_s2 = 0;
  Kicked kicked = bench::pressed_packing(parameters, 1);
  kicked.state.wall_velocity = 0;
  for (Eigen::Index i = 0; i < kicked.state.position.cols(); ++i) {
    const auto a = uniform_pair({static_cast<std::uint32_t>(i), 0, 0, 9}, 1);
    const auto b = uniform_pair({static_cast<std::uint32_t>(i), 1, 0, 9}, 1);
    kicked.state.velocity.col(i) = Eigen::Vector3d(a[0] - 0.5, a[1] - 0.5, b[0] - 0.5) * 10;
    // LAMMPS needs every position inside its box.
    double& z = kicked.state.position(2, i);
    z -= kicked.cell.depth * std::floor(z / kicked.cell.depth);
  }
  kicked.scene.pressure = 0;
  kicked.scene.wall_mass = 1e30;
  return kicked;
}

// The implementation with this name in lower case, or the fastest one for "best".
const Kernels* kernels_named(const std::string& simd) {
  for (const Kernels* kernels : kernels_here()) {
    std::string name = kernels->name;
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (simd == "best" || simd == name) return kernels;
  }
  throw std::runtime_error("this machine has no " + simd);
}

// The leapfrog needs velocities half a step earlier.
Simulation simulate(const Kicked& kicked, double drag_rate, const Kernels* kernels) {
  Scene scene = kicked.scene;
  scene.drag_rate = drag_rate;
  State state = kicked.state;
  SimulationSettings settings;
  settings.kernels = kernels;
  Simulation start(kicked.cell, scene, state, settings);
  state.velocity -=
      0.5 * scene.time_step * (start.forces().on_grain - drag_rate * kicked.state.velocity);
  return Simulation(kicked.cell, scene, state, settings);
}

void write_data(const Kicked& kicked, const fs::path& folder) {
  const WallPose pose = wall_pose(kicked.cell, 0, kicked.state.wall_height);
  const Eigen::Matrix3Xd walls = wall_grain_positions(kicked.cell, pose);
  const Eigen::Index grains = kicked.state.position.cols();
  std::ofstream data(folder / "scene.data");
  data << "one packing, lengths in d, masses in m, times in s\n\n"
       << grains + walls.cols() << " atoms\n2 atom types\n\n"
       << fmt::format("{} {} xlo xhi\n{} {} ylo yhi\n0 {:.17g} zlo zhi\n\nAtoms\n\n", -2,
                      kicked.cell.width + 2, kicked.cell.bottom - 2, kicked.cell.top + 2,
                      kicked.cell.depth);
  const double density = 6 / std::numbers::pi;  // mass 1
  for (Eigen::Index i = 0; i < grains + walls.cols(); ++i) {
    const Eigen::Vector3d p = i < grains ? kicked.state.position.col(i) : walls.col(i - grains);
    data << fmt::format("{} {} 1 {:.17g} {:.17g} {:.17g} {:.17g}\n", i + 1, i < grains ? 1 : 2,
                        density, p.x(), p.y(), p.z());
  }
  data << "\nVelocities\n\n";
  for (Eigen::Index i = 0; i < grains + walls.cols(); ++i) {
    const Eigen::Vector3d v =
        i < grains ? Eigen::Vector3d(kicked.state.velocity.col(i)) : Eigen::Vector3d::Zero();
    data << fmt::format("{} {:.17g} {:.17g} {:.17g} 0 0 0\n", i + 1, v.x(), v.y(), v.z());
  }
}

// An input deck; drag as b/m, and how many steps. The command line gives the neighbour skin [d] and
// the dump's name (-var skin 0.1 -var name LAMMPS).
void write_input(const Kicked& kicked, const fs::path& folder, const std::string& name,
                 double drag_rate, std::uint64_t steps) {
  const double k = kicked.scene.stiffness;
  std::ofstream in(folder / (name + ".in"));
  in << "units lj\natom_style sphere\nboundary f f p\nnewton on\ncomm_modify vel yes\n"
     << "read_data scene.data\ngroup grains type 1\ngroup walls type 2\n"
     << fmt::format("pair_style gran/hooke {:.17g} 0 0 0 0 0\npair_coeff * *\n", k)
     << "neigh_modify exclude group walls walls delay 0 every 1 check yes\nneighbor ${skin} bin\n"
     << fmt::format(
            "fix left grains wall/gran hooke {0:.17g} 0 0 0 0 0 xplane 0 {1:.17g}\n"
            "fix base grains wall/gran hooke {0:.17g} 0 0 0 0 0 yplane {2:.17g} {3:.17g}\n",
            k, kicked.cell.width, kicked.state.wall_height, kicked.cell.top)
     << "fix move grains nve/sphere\n";
  if (drag_rate > 0) in << fmt::format("fix drag grains viscous {:.17g}\n", drag_rate);
  in << fmt::format("timestep {:.17g}\nthermo 1000000\nrun {}\n", kicked.scene.time_step, steps)
     << "dump out grains custom 1 ${name}.dump id xu yu zu\n"
     << "dump_modify out sort id format float %.17g\nrun 0\n";
}

// The same for LIGGGHTS, whose contact laws take their constants from named properties.
void write_liggghts(const Kicked& kicked, const fs::path& folder, const std::string& name,
                    double drag_rate, std::uint64_t steps) {
  std::ofstream in(folder / (name + ".in"));
  in << "units si\natom_style granular\nboundary f f p\nnewton off\ncommunicate single vel yes\n"
     << "read_data scene.data\ngroup grains type 1\ngroup walls type 2\nneighbor ${skin} bin\n"
     << "neigh_modify delay 0 every 1 check yes exclude group walls walls\n";
  for (const char* property : {"kn", "kt", "gamman", "gammat"}) {
    const double value = std::string(property) == "kn" ? kicked.scene.stiffness : 0;
    in << fmt::format(
        "fix {0} all property/global {0} peratomtypepair 2 {1:.17g} {1:.17g} "
        "{1:.17g} {1:.17g}\n",
        property, value);
  }
  const std::string law = "gran model hooke/stiffness tangential off";
  in << "pair_style " << law << "\npair_coeff * *\n";
  const auto plane = [&](const char* fix, const char* axis, double at) {
    in << fmt::format("fix {} grains wall/{} primitive type 2 {} {:.17g}\n", fix, law, axis, at);
  };
  plane("left", "xplane", 0);
  plane("right", "xplane", kicked.cell.width);
  plane("bottom", "yplane", kicked.state.wall_height);
  plane("top", "yplane", kicked.cell.top);
  in << "fix move grains nve/sphere\n";
  if (drag_rate > 0) in << fmt::format("fix drag grains viscous {:.17g}\n", drag_rate);
  in << fmt::format("timestep {:.17g}\nthermo 1000000\nrun {}\n", kicked.scene.time_step, steps)
     << "dump out grains custom 1 ${name}.dump id x y z\n"
     << "dump_modify out sort id format \"%d %.17g %.17g %.17g\"\nrun 0\n";
}

Eigen::Matrix3Xd read_dump(const fs::path& file, Eigen::Index grains) {
  std::ifstream dump(file);
  std::string line;
  while (std::getline(dump, line) && line.rfind("ITEM: ATOMS", 0) != 0) {
  }
  Eigen::Matrix3Xd positions(3, grains);
  for (Eigen::Index i = 0; i < grains; ++i) {
    long id = 0;
    if (!(dump >> id >> positions(0, i) >> positions(1, i) >> positions(2, i)) || id != i + 1) {
      throw std::runtime_error(file.string() + ": not the positions of all grains");
    }
  }
  return positions;
}

double farthest(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b, double depth) {
  Eigen::Matrix3Xd difference = a - b;
  for (double& dz : difference.row(2).reshaped()) dz -= depth * std::round(dz / depth);
  return difference.colwise().norm().maxCoeff();
}

void compare(const Kicked& kicked, const fs::path& folder, const Kernels* kernels) {
  Simulation simulation = simulate(kicked, 0, kernels);
  simulation.advance(Drive{}, kAccuracySteps);
  std::set<fs::path> dumps;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".dump") dumps.insert(entry.path());
  }
  if (dumps.empty()) throw std::runtime_error(folder.string() + " has no dumps to compare");
  fmt::print("largest distance from ours after {} steps without drag [d] (must be below 1e-9)\n",
             kAccuracySteps);
  bool agree = true;
  for (const fs::path& dump : dumps) {
    const double distance =
        farthest(simulation.state().position, read_dump(dump, kicked.state.position.cols()),
                 kicked.cell.depth);
    fmt::print("  {:<22} {:.3g}\n", dump.stem().string(), distance);
    agree = agree && distance < 1e-9;
  }
  if (!agree) throw std::runtime_error("the trajectories disagree");
}

void time_ours(const Kicked& kicked, const Kernels* kernels) {
  Simulation simulation = simulate(kicked, 64, kernels);
  const double start = thread_seconds();
  simulation.advance(Drive{}, kSpeedSteps);
  const auto work = 1e-6 * static_cast<double>(kSpeedSteps * simulation.grains());
  fmt::print("{:.4f}\n", work / (thread_seconds() - start));
}

int run(int argc, char** argv) {
  if (argc != 5) throw std::runtime_error("usage: bench_peers prepare|ours|compare DIR N SIMD");
  const std::string what = argv[1];
  const fs::path folder = argv[2];
  const Kicked kicked = prepare(std::stoul(argv[3]));
  const Kernels* kernels = kernels_named(argv[4]);
  if (what == "prepare") {
    const nlohmann::json host = host_facts();
    const nlohmann::json& build = host["build"];
    fmt::print("{}\nshearcell: {}, {}, {}\n", host["cpu"].get<std::string>(),
               build["compiler"].get<std::string>(), build["flags"].get<std::string>(),
               kernels->name);
    write_data(kicked, folder);
    write_input(kicked, folder, "free", 0, kAccuracySteps);
    write_input(kicked, folder, "speed", 64, kSpeedSteps);
    write_liggghts(kicked, folder, "liggghts-free", 0, kAccuracySteps);
    write_liggghts(kicked, folder, "liggghts-speed", 64, kSpeedSteps);
  } else if (what == "ours") {
    time_ours(kicked, kernels);
  } else {
    compare(kicked, folder, kernels);
  }
  return 0;
}

}  // namespace
}  // namespace shearcell

int main(int argc, char** argv) {
  try {
    return shearcell::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_peers: {}\n", error.what());
    return 1;
  }
}
