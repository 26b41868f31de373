// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/lammps/lammps_deck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>

#include "provenance/io/child_process.hpp"
#include "provenance/io/file.hpp"

namespace shearcell {
namespace {

// Atom types of the data file.
enum Type { kGrain = 1, kSide, kBottom, kTop, kWall };

int type_of(WallSide side) {
  return side == WallSide::bottom ? kBottom : side == WallSide::top ? kTop : kSide;
}

template <typename... Arguments>
void add(std::string& text, fmt::format_string<Arguments...> line, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(text), line, std::forward<Arguments>(arguments)...);
  text += '\n';
}

class Deck {
 public:
  explicit Deck(const LammpsTask& task)
      : task_(task),
        cell_(task.cell),
        scene_(task.scene),
        area_(cell_.width * cell_.depth),
        bottom_moves_(cell_.moving == MovingWall::bottom),
        shears_(task.drive.amplitude != 0),
        holds_(task.drive.pause_steps > 0 && task.drive.pause_walls == PauseWalls::held) {}

  std::string text() {
    atoms();
    pose();
    motion();
    forces();
    steps();
    return std::move(text_);
  }

 private:
  bool has(WallSide side) const {
    return std::any_of(
        cell_.wall_grains.begin(), cell_.wall_grains.end(),
        [side](const WallGrain& grain) { return type_of(grain.side) == type_of(side); });
  }

  // What an explicit drag of rate b must add to a mass to be taken implicitly.
  double added(double drag) const { return task_.added_mass ? 0.5 * drag * scene_.time_step : 0; }

  void atoms() {
    add(text_, "# by shearcell: lengths in d, masses in m, times in s");
    add(text_, "units lj\natom_style sphere\natom_modify map array\nboundary s s p");
    add(text_, "newton off\ncomm_modify vel yes\nread_data scene.data");
    add(text_, "reset_timestep {}", task_.state.step);
    add(text_, "group grains type {}\ngroup wall type {}\ngroup free type {} {}", +kGrain, +kWall,
        +kGrain, +kWall);
    add(text_, "group planted type {} {} {}\ngroup sides type {}", +kSide, +kBottom, +kTop, +kSide);
    add(text_, "group bottom type {}\ngroup top type {}", +kBottom, +kTop);
    add(text_, "set group grains mass {:.17g}", 1 + added(scene_.drag_rate));
    add(text_, "set group wall mass {:.17g}", area_ * (scene_.wall_mass + added(scene_.wall_drag)));
    add(text_, "pair_style gran/hooke {:.17g} 0 0 0 0 0\npair_coeff * *", scene_.stiffness);
    add(text_, "neighbor 0.15 bin\nneigh_modify delay 0 every 1 check yes");
    add(text_, "neigh_modify exclude group planted planted\nneigh_modify exclude group wall all");
  }

  bool fluid_moves() const { return shears_ && fluid_share(scene_.fluid) != 0; }

  // Tilt and heights at the present step, from the integer step and the moving wall's atom.
  void pose() {
    const auto cycle = task_.drive.steps_per_cycle + task_.drive.pause_steps;
    const double turn = static_cast<double>(task_.drive.steps_per_cycle);
    const std::string height = fmt::format("y[{}]", task_.state.position.cols() + 1);
    add(text_, "variable bottom equal {}",
        bottom_moves_ ? height : fmt::format("{:.17g}", cell_.bottom));
    add(text_, "variable top equal {}", bottom_moves_ ? fmt::format("{:.17g}", cell_.top) : height);
    add(text_, "variable rise equal v_{}-({:.17g})", bottom_moves_ ? "bottom" : "top",
        bottom_moves_ ? cell_.bottom : cell_.top);
    if (shears_ || holds_) add(text_, "variable phase equal step%{}", cycle);
    if (!shears_) return;
    add(text_, "variable theta equal {:.17g}*sin(2*PI*v_phase/{})*(v_phase<{})",
        task_.drive.amplitude, turn, turn);
    add(text_, "variable turn equal -v_theta\nvariable shear equal tan(v_theta)");
    add(text_, "variable side_x atom (y-v_top)*v_shear");
    add(text_, "variable bottom_x equal (v_bottom-v_top)*v_shear");
    if (!fluid_moves()) return;
    add(text_, "variable rate equal {:.17g}*2*PI/{:.17g}*cos(2*PI*v_phase/{})*(v_phase<{})",
        task_.drive.amplitude, turn * scene_.time_step, turn, turn);
    add(text_, "variable flow atom {:.17g}*(y-v_top)*v_rate/cos(v_theta)^2",
        scene_.drag_rate * fluid_share(scene_.fluid));
  }

  // Displaces a wall's grains, which the data file holds as in the untilted cell.
  void carry(const char* group, const char* x, const char* y) {
    add(text_, "fix {0} {0} move variable v_{1} v_{2} v_zero NULL NULL NULL", group, x, y);
    add(text_, "displace_atoms {} move v_{} v_{} 0 units box", group, x, y);
  }

  // The wall's atom moves first, because the wall grains follow its height.
  void motion() {
    add(text_, "fix step free nve\nvariable zero equal 0");
    if (has(WallSide::left) && shears_) carry("sides", "side_x", "zero");
    if (has(WallSide::bottom) && (shears_ || bottom_moves_)) {
      carry("bottom", shears_ ? "bottom_x" : "zero", bottom_moves_ ? "rise" : "zero");
    }
    if (has(WallSide::top) && !bottom_moves_) carry("top", "zero", "rise");
  }

  // A side plane turns about its end at the top wall.
  void side_plane(const char* name, double x, int normal) {
    add(text_, "region {} plane {:.17g} {:.17g} 0 {} 0 0 side in units box{}{}", name, x, cell_.top,
        normal, shears_ ? fmt::format(" rotate v_turn {:.17g} {:.17g} 0 0 0 1", x, cell_.top) : "",
        shears_ && !bottom_moves_ ? " move NULL v_rise NULL" : "");
    add(text_, "fix {0} grains wall/region {0} harmonic {1:.17g} 1 0.5", name,
        scene_.stiffness / 2);
  }

  // `wall/region` would work for these too, but reports the force on the wall for the first step
  // only.
  void flat_plane(const char* name, const char* face) {
    add(text_, "fix {0}_plane grains wall/harmonic {1} v_{0} {2:.17g} 1 0.5 units box", name, face,
        scene_.stiffness / 2);
  }

  void forces() {
    side_plane("left_plane", 0, 1);
    side_plane("right_plane", cell_.width, -1);
    flat_plane("bottom", "ylo");
    flat_plane("top", "yhi");
    if (scene_.gravity != 0) {  // m g, whatever the mass is raised to
      add(text_, "fix weight grains gravity {:.17g} vector 0 -1 0",
          scene_.gravity / (1 + added(scene_.drag_rate)));
    }
    if (scene_.drag_rate != 0) {
      add(text_, "fix drag grains viscous {:.17g}", scene_.drag_rate);
      if (fluid_moves()) add(text_, "fix flow grains addforce v_flow 0 0");
    }
    const char* moving = bottom_moves_ ? "bottom" : "top";
    const auto grains = static_cast<std::size_t>(task_.state.position.cols());
    const double load = scene_.pressure * area_ + carried_weight(scene_, cell_, grains);
    std::string force =
        fmt::format("{:.17g}+f_{}_plane[1]", (bottom_moves_ ? 1 : -1) * load, moving);
    if (has(bottom_moves_ ? WallSide::bottom : WallSide::top)) {
      force += fmt::format("+fcm({},y)", moving);
    }
    if (holds_) {
      // The force that, with the drag, stops the wall within one step.
      const double mass = area_ * (scene_.wall_mass + added(scene_.wall_drag));
      const double stop = area_ * scene_.wall_drag - mass / scene_.time_step;
      const auto turn = task_.drive.steps_per_cycle;
      force = fmt::format("({0})*(v_phase<{1})+{2:.17g}*vy[{3}]*(v_phase>={1})", force, turn, stop,
                          grains + 1);
    }
    add(text_, "variable push equal {}\nfix push wall addforce 0 v_push 0", force);
    if (scene_.wall_drag != 0) {
      add(text_, "fix wall_drag wall viscous {:.17g}", scene_.wall_drag * area_);
    }
  }

  // Our velocities are those of half a step before, LAMMPS's those of the step. Half a kick with
  // the forces of `run 0` is added at the start; half a kick is subtracted in each frame.
  void steps() {
    const double half = 0.5 * scene_.time_step;
    for (const char axis : {'x', 'y', 'z'}) {
      add(text_, "variable kicked_{0} atom v{0}+{1:.17g}*f{0}/mass", axis, half);
      add(text_, "variable half_{0} atom v{0}-{1:.17g}*f{0}/mass", axis, half);
    }
    // One process checks for the file, so that all processes get the same answer.
    add(text_, "variable asked atom is_file(stop)\ncompute asked wall reduce sum v_asked");
    add(text_,
        "variable stop equal c_asked\nfix stop all halt {} v_stop > 0.5 error continue "
        "message no",
        task_.check_every);
    add(text_, "thermo {}\nthermo_style custom step\nthermo_modify flush yes", task_.check_every);
    // Under mpirun each process gets equally many grains, however far the wall grains reach.
    add(text_, "balance 1.05 shift xyz 20 1.02 weight group 1 planted 0.1");
    add(text_, "timestep {:.17g}\nrun 0 post no", scene_.time_step);
    add(text_, "velocity free set v_kicked_x v_kicked_y v_kicked_z units box");
    add(text_, "variable next equal (floor(step/{0})+1)*{0}", task_.stride);
    add(text_, "label next");
    add(text_, "variable goal string $(v_next*(v_next<{0})+{0}*(v_next>={0}):%.0f)", task_.end);
    add(text_, "run ${{goal}} upto pre no post no");
    add(text_,
        "write_dump free custom frame.new id xu yu zu v_half_x v_half_y v_half_z modify "
        "format float %.17g");
    add(text_, "shell mv frame.new frame.$(step:%.0f)");
    add(text_, "if \"$(step:%.0f) == ${{goal}} && ${{goal}} < {}\" then \"jump SELF next\"",
        task_.end);
  }

  const LammpsTask& task_;
  const Cell& cell_;
  const Scene& scene_;
  double area_;
  bool bottom_moves_;
  bool shears_;
  bool holds_;  // the moving wall, during a pause
  std::string text_;
};

void add_atom(std::string& text, Eigen::Index id, int type, const Eigen::Vector3d& p) {
  constexpr double density = 6 / std::numbers::pi;  // mass 1
  add(text, "{} {} 1 {:.17g} {:.17g} {:.17g} {:.17g}", id, type, density, p.x(), p.y(), p.z());
}

void add_velocity(std::string& text, Eigen::Index id, const Eigen::Vector3d& v) {
  add(text, "{} {:.17g} {:.17g} {:.17g} 0 0 0", id, v.x(), v.y(), v.z());
}

// Reads numbers from a text that may be damaged.
class Numbers {
 public:
  Numbers(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  /// Skips the text up to the end of the line that begins with `heading`.
  void skip_past(std::string_view heading) {
    const auto at = text_.find(heading);
    const auto end = at == text_.npos ? at : text_.find('\n', at);
    if (end == text_.npos) refuse();
    text_.remove_prefix(end + 1);
  }

  template <typename Number>
  Number next() {
    const auto start = text_.find_first_not_of(" \n");
    if (start == text_.npos) refuse();
    text_.remove_prefix(start);
    Number number{};
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), number);
    if (error != std::errc() || !std::isfinite(static_cast<double>(number))) refuse();
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    return number;
  }

  [[noreturn]] void refuse() const {
    throw ProgramError(file_ + ": not a complete state of the grains");
  }

 private:
  std::string_view text_;
  std::string file_;
};

}  // namespace

std::string lammps_data(const LammpsTask& task) {
  const State& state = task.state;
  const Eigen::Index grains = state.position.cols();
  const auto planted = static_cast<Eigen::Index>(task.cell.wall_grains.size());
  const Eigen::Vector3d wall(task.cell.width / 2, state.wall_height, task.cell.depth / 2);
  double low = std::min(state.wall_height, task.cell.bottom);
  double high = std::max(state.wall_height, task.cell.top);
  for (const WallGrain& grain : task.cell.wall_grains) {
    low = std::min(low, grain.position.y());
    high = std::max(high, grain.position.y());
  }
  // The box must hold all atoms; LAMMPS shrinks it to them when the run begins.
  const double reach = high - low + 2;
  std::string text;
  add(text, "by shearcell: lengths in d, masses in m, times in s, velocities at step - 1/2\n");
  add(text, "{} atoms\n{} atom types\n", grains + 1 + planted, +kWall);
  add(text, "{:.17g} {:.17g} xlo xhi\n{:.17g} {:.17g} ylo yhi\n0 {:.17g} zlo zhi\n", -reach,
      task.cell.width + reach, low - 2, high + 2, task.cell.depth);
  add(text, "Atoms # sphere\n");
  for (Eigen::Index i = 0; i < grains; ++i) add_atom(text, i + 1, kGrain, state.position.col(i));
  add_atom(text, grains + 1, kWall, wall);
  Eigen::Index id = grains + 2;
  for (const WallGrain& grain : task.cell.wall_grains) {
    add_atom(text, id++, type_of(grain.side), grain.position);
  }
  add(text, "\nVelocities\n");
  for (Eigen::Index i = 0; i < grains; ++i) add_velocity(text, i + 1, state.velocity.col(i));
  add_velocity(text, grains + 1, {0, state.wall_velocity, 0});
  for (id = grains + 2; id < grains + 2 + planted; ++id) add_velocity(text, id, {0, 0, 0});
  return text;
}

std::string lammps_deck(const LammpsTask& task) {
  return Deck(task).text();
}

State read_lammps_frame(const std::filesystem::path& file, std::size_t grains) {
  const std::string text = read_plain(file, kLargestFile).value_or("");
  Numbers numbers(text, file.string());
  State state;
  numbers.skip_past("ITEM: TIMESTEP");
  state.step = numbers.next<std::uint64_t>();
  numbers.skip_past("ITEM: NUMBER OF ATOMS");
  if (numbers.next<std::size_t>() != grains + 1) numbers.refuse();
  numbers.skip_past("ITEM: ATOMS");
  const auto columns = static_cast<Eigen::Index>(grains);
  state.position.resize(3, columns);
  state.velocity.resize(3, columns);
  std::vector<bool> seen(grains + 1, false);
  for (std::size_t row = 0; row <= grains; ++row) {
    const auto id = numbers.next<std::size_t>();
    if (id < 1 || id > grains + 1 || seen[id - 1]) numbers.refuse();
    seen[id - 1] = true;
    Eigen::Matrix<double, 6, 1> v;
    for (double& value : v) value = numbers.next<double>();
    if (id == grains + 1) {
      state.wall_height = v(1);
      state.wall_velocity = v(4);
    } else {
      state.position.col(static_cast<Eigen::Index>(id - 1)) = v.head<3>();
      state.velocity.col(static_cast<Eigen::Index>(id - 1)) = v.tail<3>();
    }
  }
  return state;
}

}  // namespace shearcell
