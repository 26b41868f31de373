// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/lammps/lammps_deck.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <sstream>

#include "core/drive.hpp"
#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"
#include "provenance/io/read_number.hpp"

namespace shearcell {
namespace {

constexpr const char* kSides[] = {"left", "right", "bottom", "top"};

class Deck {
 public:
  explicit Deck(const LammpsTask& task)
      : task_(task),
        cell_(task.cell),
        scene_(task.scene),
        d_(task.units.diameter_m),
        m_(task.units.mass_kg),
        area_(cell_.width * cell_.depth),
        pose_(wall_pose(cell_, tilt(task.drive, task.state.step).theta, task.state.wall_height)),
        wall_(task.state.position.cols() + static_cast<Eigen::Index>(cell_.wall_grains.size()) + 1),
        bottom_moves_(cell_.moving == MovingWall::bottom),
        shears_(task.drive.amplitude != 0),
        holds_(task.drive.pause_steps > 0 && task.drive.pause_walls == PauseWalls::held) {}

  std::string for_engine() {
    scene("lj", "scene.data");
    stopping();
    begin();
    frames();
    return std::move(text_);
  }

  std::string for_users(std::string_view data, std::string_view name) {
    for_users_ = true;
    scene("si", data);
    watching(name);
    begin();
    to_the_end(name);
    return std::move(text_);
  }

 private:
  template <typename... Arguments>
  void add(fmt::format_string<Arguments...> lines, Arguments&&... arguments) {
    text_ += fmt::format(lines, std::forward<Arguments>(arguments)...) + '\n';
  }

  void scene(std::string_view units, std::string_view data) {
    atoms(units, data);
    contacts();
    pose();
    motion();
    forces();
  }

  bool has(WallSide side) const {
    return std::ranges::find(cell_.wall_grains, side, &WallGrain::side) != cell_.wall_grains.end();
  }

  // A grain's mass is increased by this factor, 1 + b dt/2m, which makes LAMMPS's explicit drag
  // equal to an implicit drag b.
  double raised() const { return for_users_ ? 1 : 1 + 0.5 * scene_.drag_rate * scene_.time_step; }

  void atoms(std::string_view units, std::string_view data) {
    add("units {}\natom_style sphere\natom_modify map array\nboundary s s p", units);
    add("newton off\ncomm_modify vel yes");
    add("\n# Grains (type 1), wall grains (2 left, 3 right, 4 bottom, 5 top), and an atom");
    add("# (type 6) that represents the moving wall and touches nothing.");
    add("read_data {} extra/atom/types 1", data);
    // LAMMPS creates no atom outside the box, so the wall's atom is created at x and y of a grain.
    const Eigen::Vector3d start = task_.state.position.col(0) * d_;
    add("create_atoms 6 single {:.17g} {:.17g} {:.17g} units box", start.x(), start.y(),
        cell_.depth / 2 * d_);
    add("# -var finer 2 halves the time step. Stable time steps are below 0.7*sqrt(m/k).");
    add("variable finer index 1\ntimestep $({:.17g}/v_finer:%.17g)", scene_.time_step);
    add("reset_timestep $({}*v_finer:%.0f)", task_.state.step);
    add("group grains type 1\ngroup wall type 6\ngroup free type 1 6");
    add("group planted type 2 3 4 5\ngroup sides type 2 3\ngroup bottom type 4\ngroup top type 5");
    add("set group wall y {:.17g} diameter {:.17g}", task_.state.wall_height * d_, d_);
    add("velocity wall set 0 {:.17g} 0 units box", task_.state.wall_velocity * d_);
    add(R"(# A mass raised by drag*dt/2 makes LAMMPS's explicit drag equal to implicit drag.
set group wall mass $({:.17g}+{:.17g}*dt/2:%.17g)
set group grains mass {:.17g}
# Wall grains are heavy, so that contact laws with damping treat them as immovable.
set group planted mass {:.17g}

# Change diameters and masses of grains here, for example:
# set atom 1*50 diameter {:.3g} density {:.6g})",
        area_ * scene_.wall_mass * m_, area_ * scene_.wall_drag * m_, raised() * m_, 1e6 * m_,
        0.8 * d_, m_ / (std::numbers::pi / 6 * d_ * d_ * d_));
  }

  void contacts() {
    const double k = scene_.stiffness * m_;
    if (for_users_) {
      add(R"(
# The contact law of grains, wall grains and planes, in the syntax of pair_style granular. For a
# damping of 50/s, and a friction of 0.5 with a tangential spring, write:
# hooke {0:.6g} 50 tangential linear_history {1:.6g} 1 0.5 damping mass_velocity
variable law index "hooke {0:.17g} 0 tangential linear_nohistory 0 0 damping mass_velocity"
pair_style granular
pair_coeff * * ${{law}})",
          k, k * 2 / 7);
    } else {
      add("pair_style gran/hooke {:.17g} 0 0 0 0 0\npair_coeff * *", k);
    }
    add("neighbor {:.17g} bin\nneigh_modify delay 0 every 1 check yes", 0.15 * d_);
    add("neigh_modify exclude group planted planted\nneigh_modify exclude group wall all");
  }

  bool fluid_moves() const { return shears_ && fluid_share(scene_.fluid) != 0; }

  // Defines LAMMPS variables for the heights and the tilt of the walls. The height of the moving
  // wall is the y coordinate of the atom that represents this wall.
  void pose() {
    const auto cycle = cycle_steps(task_.drive);
    const double turn = static_cast<double>(task_.drive.steps_per_cycle);
    const std::string height = fmt::format("y[{}]", wall_);
    add("\n# Heights of the planes, and the tilt of the side walls.");
    add("variable bottom equal {}",
        bottom_moves_ ? height : fmt::format("{:.17g}", cell_.bottom * d_));
    add("variable top equal {}", bottom_moves_ ? fmt::format("{:.17g}", cell_.top * d_) : height);
    add("variable rise equal {}-({:.17g})", height, task_.state.wall_height * d_);
    add("variable rising equal vy[{}]", wall_);
    if (shears_ || holds_) add("variable phase equal (step/v_finer)%{}", cycle);
    if (!shears_) return;
    add("variable theta equal {:.17g}*sin(2*PI*v_phase/{})*(v_phase<{})", task_.drive.amplitude,
        turn, turn);
    add("variable turn equal {:.17g}-v_theta\nvariable shear equal tan(v_theta)",
        tilt(task_.drive, task_.state.step).theta);
    add("variable rate equal {:.17g}*2*PI/{:.17g}*cos(2*PI*v_phase/{})*(v_phase<{})",
        task_.drive.amplitude, turn * scene_.time_step, turn, turn);
    add("variable shear_rate equal v_rate/cos(v_theta)^2");
  }

  // Moves the wall grains of a group. `x` and `vx` are LAMMPS variables of the motion along x: `x`
  // is the displacement from the position in the data file, and `vx` is the velocity. If `rises`,
  // the grains also follow the moving wall in y.
  void carry(const char* group, const char* x, const char* vx, bool rises) {
    add("fix {0} {0} move variable v_{1} v_{2} v_zero v_{3} v_{4} v_zero", group, x,
        rises ? "rise" : "zero", vx, rises ? "rising" : "zero");
  }

  // `fix step` comes first. It moves the atom that represents the moving wall, and the wall grains
  // follow the height of this atom.
  void motion() {
    add("\n# Velocity Verlet for grains and the moving wall. Wall grains follow their walls.");
    add("fix step free nve/sphere\nvariable zero equal 0");
    const double top = pose_.top * d_, shear = pose_.tan_theta;
    // The side walls tilt about the top. If the top rises, all points of the side walls also move
    // along x with the velocity -v_rising tan(theta).
    const char* against = bottom_moves_ ? "" : "-v_rising*v_shear";
    if ((has(WallSide::left) || has(WallSide::right)) && shears_) {
      add("variable side_x atom (y-v_top)*v_shear-(y-({:.17g}))*({:.17g})", top, shear);
      add("variable side_vx atom (y-v_top)*v_shear_rate{}", against);
      carry("sides", "side_x", "side_vx", false);
    }
    if (shears_) {
      add("variable bottom_x equal (v_bottom-v_top)*v_shear-({:.17g})",
          (pose_.bottom - pose_.top) * d_ * shear);
      add("variable bottom_vx equal (v_bottom-v_top)*v_shear_rate{}",
          bottom_moves_ ? "+v_rising*v_shear" : against);
    }
    if (has(WallSide::bottom) && (shears_ || bottom_moves_)) {
      carry("bottom", shears_ ? "bottom_x" : "zero", shears_ ? "bottom_vx" : "zero", bottom_moves_);
    }
    if (has(WallSide::top) && !bottom_moves_) carry("top", "zero", "zero", true);
  }

  // Side planes rotate about their upper ends. LAMMPS moves a region relative to its first pose.
  // In the script for users, all planes use fix wall/gran/region. In the script for the engine, the
  // side planes use fix wall/region, which reports the force on a plane only for the first step.
  // The bottom and top planes use fix wall/harmonic, because the force on the moving plane is
  // needed at each step.
  void plane(std::size_t side) {
    const auto [point, normal] = wall_planes(cell_, pose_)[side];
    const double x = point[0] * d_, y = point[1] * d_, k = scene_.stiffness * m_;
    const bool upright = side < 2, moves = side == (bottom_moves_ ? 2 : 3);
    if (upright || for_users_) {
      add("region {0}_plane plane {1:.17g} {2:.17g} 0 {3:.17g} {4:.17g} 0 side in units box "
          "move {5} {6} NULL{7}",
          kSides[side], x, y, normal[0], normal[1], side == 2 && shears_ ? "v_bottom_x" : "NULL",
          moves || (upright && !bottom_moves_) ? "v_rise" : "NULL",
          upright && shears_ ? fmt::format(" rotate v_turn {:.17g} {:.17g} 0 0 0 1", x, y) : "");
    }
    if (for_users_) {
      add("fix {0}_plane grains wall/gran/region granular ${{law}} region {0}_plane{1}",
          kSides[side], moves ? " contacts" : "");
      if (moves) add("compute plane grains reduce sum f_{}_plane[3]", kSides[side]);
    } else if (upright) {
      add("fix {0}_plane grains wall/region {0}_plane harmonic {1:.17g} 1 {2:.17g}", kSides[side],
          k / 2, d_ / 2);
    } else {
      add("fix {0}_plane grains wall/harmonic {1} v_{0} {2:.17g} 1 {3:.17g} units box",
          kSides[side], side == 2 ? "ylo" : "yhi", k / 2, d_ / 2);
    }
  }

  void forces() {
    add("\n# The planes of the four walls.");
    for (std::size_t side = 0; side < 4; ++side) plane(side);
    if (for_users_) {
      add(R"(# A grain that passes a plane ends the run.
region cell intersect 4 left_plane right_plane bottom_plane top_plane
variable outside equal count(grains)-count(grains,cell)
fix outside all halt 100 v_outside > 0)");
    }
    if (scene_.gravity != 0) {
      add("\n# The weight m g.\nfix weight grains gravity {:.17g} vector 0 -1 0",
          scene_.gravity * d_ / raised());
    }
    if (scene_.drag_rate != 0 && for_users_) {
      add(R"(
# The drag b of the fluid, proportional to the diameter (Stokes). It is implicit: the forces so far
# are divided by 1 + b dt/2m. Add other forces before it.
compute radius grains property/atom radius
variable b atom {:.17g}*c_radius/{:.17g}
variable part atom 1/(1+v_b*dt/(2*mass))
variable flow atom {}
variable drag_x atom v_part*(fx-v_b*(vx-v_flow))-fx
variable drag_y atom v_part*(fy-v_b*vy)-fy
variable drag_z atom v_part*(fz-v_b*vz)-fz
fix drag grains addforce v_drag_x v_drag_y v_drag_z)",
          scene_.drag_rate * m_, 0.5 * d_,
          fluid_moves() ? fmt::format("{:.17g}*(y-v_top)*v_shear_rate", fluid_share(scene_.fluid))
                        : "0");
    } else if (scene_.drag_rate != 0) {
      add("fix drag grains viscous {:.17g}", scene_.drag_rate * m_);
      if (fluid_moves()) {
        add("variable flow atom {:.17g}*(y-v_top)*v_shear_rate\nfix flow grains addforce v_flow 0 "
            "0",
            scene_.drag_rate * fluid_share(scene_.fluid) * m_);
      }
    }
    const double load = inwards(cell_) * scene_.pressure * area_ * m_ * d_;
    const double carried = carried_weight(scene_, cell_, 1) * d_;  // per unit of mass
    const auto grains = static_cast<double>(task_.state.position.cols());
    const char* moving = bottom_moves_ ? "bottom" : "top";
    std::string force =
        for_users_ ? fmt::format("{:.17g}+{:.17g}*mass(grains)-c_plane", load, carried)
                   : fmt::format("{:.17g}+f_{}_plane[1]", load + grains * carried * m_, moving);
    if (has(moving_side(cell_))) force += fmt::format("+fcm({},y)", moving);
    if (holds_) {
      // In a pause, this force and the drag stop the wall within one step.
      force = fmt::format("({0})*(v_phase<{1})+({2:.17g}-mass(wall)/dt)*vy[{3}]*(v_phase>={1})",
                          force, task_.drive.steps_per_cycle, scene_.wall_drag * area_ * m_, wall_);
    }
    add("\n# Forces on the moving wall: load, contacts with its plane and its wall grains, drag.");
    add("variable push equal {}\nfix push wall addforce 0 v_push 0", force);
    if (scene_.wall_drag != 0) {
      add("fix wall_drag wall viscous {:.17g}", scene_.wall_drag * area_ * m_);
    }
  }

  void begin() {
    add("\n# The velocities in the data file are from half a step earlier: add f/m dt/2.");
    add("# With mpirun, all processes get about the same number of grains.");
    for (const char axis : {'x', 'y', 'z'}) {
      add("variable kicked_{0} atom v{0}+{1:.17g}*f{0}/mass", axis, 0.5 * scene_.time_step);
    }
    add("balance 1.05 shift xyz 20 1.02 weight group 1 planted 0.1");
    add("run 0 post no");
    add("velocity free set v_kicked_x v_kicked_y v_kicked_z units box");
  }

  void stopping() {
    // One process looks for the file `stop`, so that all processes get the same answer.
    add("variable asked atom is_file(stop)\ncompute asked wall reduce sum v_asked");
    add("variable stop equal c_asked\nfix stop all halt {} v_stop > 0.5 error continue message no",
        task_.check_every);
    add("thermo {}\nthermo_style custom step\nthermo_modify flush yes", task_.check_every);
  }

  // The time of a frame's velocities must be half a step before the time of its positions. In
  // LAMMPS, both times are equal, so f/m dt/2 is subtracted from the velocities of LAMMPS.
  void frames() {
    for (const char axis : {'x', 'y', 'z'}) {
      add("variable half_{0} atom v{0}-{1:.17g}*f{0}/mass", axis, 0.5 * scene_.time_step);
    }
    add("variable next equal (floor(step/{0})+1)*{0}", task_.stride);
    add("label next");
    add("variable goal string $(v_next*(v_next<{0})+{0}*(v_next>={0}):%.0f)", task_.end);
    add("run ${{goal}} upto pre no post no");
    add("write_dump free custom frame.new id xu yu zu v_half_x v_half_y v_half_z modify "
        "format float %.17g");
    add("shell mv frame.new frame.$(step:%.0f)");
    add("if \"$(step:%.0f) == ${{goal}} && ${{goal}} < {}\" then \"jump SELF next\"", task_.end);
  }

  // Defines the output and the number of steps. By default, the steps cover one shear cycle, or one
  // second without shear. These lines must come before the first `run`. Otherwise LAMMPS would need
  // a second setup, and would then compute the drag from the velocities that begin() has changed.
  void watching(std::string_view name) {
    const auto steps = shears_ ? cycle_steps(task_.drive)
                               : static_cast<std::uint64_t>(std::nearbyint(1 / scene_.time_step));
    add(R"(
# Number of steps, and steps between written positions: lmp -in in.{0} -var steps 1000
variable steps index $({1}*v_finer:%.0f)
variable every index $({2}*v_finer:%.0f)
compute ke grains ke
thermo ${{every}}
thermo_style custom step time c_ke v_bottom v_top{3}
dump frames all custom ${{every}} {0}.lammpstrj id type diameter x y z vx vy vz omegax omegay omegaz
dump_modify frames sort id format float %.12g)",
        name, steps, std::max<std::uint64_t>(1, steps / 20), shears_ ? " v_theta" : "");
  }

  void to_the_end(std::string_view name) {
    add(R"(run ${{steps}} pre no

# Writes the grains at the end. The box shrinks to the planes, without the wall grains, so add runs
# before this line. A manifest can start from the file if all grains are equal and the cell upright.
undump frames
change_box all triclinic boundary f f p x final $({0}:%.17g) $({0}+{1:.17g}:%.17g) &
 y final $(v_bottom:%.17g) $(v_top:%.17g) xy final $(-({0}):%.17g) units box
write_dump grains custom {2}_end.dump id diameter x y z vx vy vz modify units yes sort id &
 format float %.17g)",
        shears_ ? "(v_bottom-v_top)*v_shear" : "0", cell_.width * d_, name);
  }

  const LammpsTask& task_;
  const Cell& cell_;
  const Scene& scene_;
  double d_, m_;       // units of length and mass in the script
  double area_;        // area of the moving wall [d^2]
  WallPose pose_;      // at the beginning
  Eigen::Index wall_;  // id of the moving wall's atom
  bool for_users_ = false;
  bool bottom_moves_;
  bool shears_;
  bool holds_;  // whether the moving wall is held during pauses
  std::string text_;
};

}  // namespace

std::string lammps_data(const Particles& all, std::string_view title) {
  // The box includes all particles and all planes, also tilted planes.
  Eigen::Matrix3Xd corners(3, 4);
  corners << all.origin, all.origin + all.edges.col(0), all.origin + all.edges.col(1),
      all.origin + all.edges.rowwise().sum();
  const Eigen::Vector3d low =
      all.position.rowwise().minCoeff().cwiseMin(corners.rowwise().minCoeff()).array() - all.radius;
  const Eigen::Vector3d high =
      all.position.rowwise().maxCoeff().cwiseMax(corners.rowwise().maxCoeff()).array() + all.radius;
  std::string text;
  fmt::format_to(std::back_inserter(text), "{}\n\n{} atoms\n5 atom types\n\n", title,
                 all.particles());
  fmt::format_to(std::back_inserter(text),
                 "{:.17g} {:.17g} xlo xhi\n{:.17g} {:.17g} ylo yhi\n0 {:.17g} zlo zhi\n", low.x(),
                 high.x(), low.y(), high.y(), all.edges(2, 2));
  text += "\nAtoms # sphere\n\n";
  const double density = all.mass / (4.0 / 3.0 * std::numbers::pi * std::pow(all.radius, 3));
  for (std::size_t i = 0; i < all.particles(); ++i) {
    const auto r = all.position.col(static_cast<Eigen::Index>(i));
    fmt::format_to(std::back_inserter(text), "{} {} {:.17g} {:.17g} {:.17g} 0 0 {}\n", i + 1,
                   all.type[i] + 1, 2 * all.radius, density, fmt::join(r, " "), all.image[i]);
  }
  text += "\nVelocities\n\n";
  for (std::size_t i = 0; i < all.particles(); ++i) {
    const auto v = all.velocity.col(static_cast<Eigen::Index>(i));
    fmt::format_to(std::back_inserter(text), "{} {:.17g} 0 0 0\n", i + 1, fmt::join(v, " "));
  }
  return text;
}

std::string lammps_deck(const LammpsTask& task) {
  return Deck(task).for_engine();
}

std::string lammps_script(const LammpsTask& task, std::string_view data, std::string_view name) {
  return Deck(task).for_users(data, name);
}

State read_lammps_frame(const std::filesystem::path& file, std::size_t grains) {
  std::istringstream text(read_plain(file, kLargestFile).value_or(""));
  const auto require = [&](bool sound) {
    if (!sound) throw ProgramError(file.string() + ": this is not a complete state of the grains");
  };
  // Three sections of 2, 2 and 4 lines give the step, the number of atoms and the box; then follows
  // the line with the names of the columns.
  std::array<std::string, 9> head;
  for (std::string& line : head) std::getline(text, line);
  State state;
  state.step = read_number<std::uint64_t>(head[1]).value_or(0);
  require(head[8].starts_with("ITEM: ATOMS") && read_number<std::size_t>(head[3]) == grains + 1);
  const auto columns = static_cast<Eigen::Index>(grains);
  state.position.resize(3, columns);
  state.velocity.resize(3, columns);
  std::vector<bool> seen(grains + 1, false);
  for (std::size_t row = 0; row <= grains; ++row) {
    Eigen::Index id = 0;
    Eigen::Matrix<double, 6, 1> v;
    text >> id;
    for (double& value : v) text >> value;
    const auto place = static_cast<std::size_t>(std::min(id - 1, columns));
    require(text && id >= 1 && v.allFinite() && !seen[place]);
    seen[place] = true;
    if (id > columns) {  // the moving wall
      state.wall_height = v(1);
      state.wall_velocity = v(4);
    } else {
      state.position.col(id - 1) = v.head<3>();
      state.velocity.col(id - 1) = v.tail<3>();
    }
  }
  return state;
}

}  // namespace shearcell
