// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/plot.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include "analysis/error.hpp"

namespace shearcell {
namespace {

constexpr const char* style =
    "set terminal svg size 600,430 enhanced font 'Helvetica,14' background '#ffffff'\n"
    "set encoding utf8\n"
    "set datafile separator ','\n"
    "set border 15 lw 1.2\n"
    "set xtics in mirror scale 0.9,0.5\n"
    "set ytics in mirror scale 0.9,0.5\n"
    "set mxtics 2\n"
    "set mytics 2\n"
    // Ranges end a little outside the data, not at the next tick, so that no point or bar is cut.
    "set autoscale noextend\n"
    "set offsets graph 0.03, graph 0.03, graph 0.05, graph 0.05\n"
    // Above the frame, the one place where no data can be.
    "set key above horizontal center noautotitle Left reverse samplen 1.5 width 2\n"
    "set bars 0.5\n";

// Without data there is nothing that gnuplot could draw; the axes still say what is missing.
constexpr const char* empty_plot =
    "set label 'no data' at graph 0.5, graph 0.5 center\n"
    "plot [0:1] [0:1] NaN notitle\n";

/// What one process wrote to its standard error, and how it ended.
struct Outcome {
  int status = 0;
  std::string messages;
};

/// A name goes into a script and into file names, so it may hold only what means nothing to either.
void require_plain_name(const std::string& name) {
  const bool plain = !name.empty() && name.front() != '-' &&
                     name.find_first_not_of(
                         "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                         "0123456789_-") == std::string::npos;
  if (!plain) throw AnalysisError("'" + name + "' cannot name a figure's files");
}

class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0) {
      throw AnalysisError(std::string("cannot make a pipe: ") + std::strerror(errno));
    }
  }
  ~Pipe() {
    close(ends_[0]);
    close_writer();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int writer() const { return ends_[1]; }
  void close_writer() {
    if (ends_[1] >= 0) close(ends_[1]);
    ends_[1] = -1;
  }
  std::string read_all() {
    std::string text;
    std::array<char, 4096> buffer;
    while (true) {
      const ssize_t got = read(ends_[0], buffer.data(), buffer.size());
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return text;
      text.append(buffer.data(), static_cast<std::size_t>(got));
    }
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

/// Runs gnuplot in `folder` on a script there. -d keeps a user's own defaults out of the figure.
Outcome run_gnuplot(const std::filesystem::path& folder, const std::string& script) {
  Pipe messages;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, messages.writer(), STDERR_FILENO);
  posix_spawn_file_actions_adddup2(&actions, messages.writer(), STDOUT_FILENO);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  std::string program = "gnuplot";
  std::string defaults = "-d";
  std::string argument = script;
  const std::array<char*, 4> arguments = {program.data(), defaults.data(), argument.data(),
                                          nullptr};
  pid_t child = 0;
  const int failure =
      posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT) {
    throw AnalysisError("gnuplot is not installed (Debian package gnuplot-nox); the data are in " +
                        folder.string());
  }
  if (failure != 0) {
    throw AnalysisError(std::string("cannot start gnuplot: ") + std::strerror(failure));
  }
  messages.close_writer();
  Outcome outcome;
  outcome.messages = messages.read_all();
  while (waitpid(child, &outcome.status, 0) < 0) {
    if (errno != EINTR) throw AnalysisError("gnuplot was lost while it ran");
  }
  return outcome;
}

}  // namespace

std::filesystem::path draw_svg(const FigureTable& table, const std::filesystem::path& folder) {
  require_plain_name(table.name);
  const std::filesystem::path svg = folder / (table.name + ".svg");
  const std::filesystem::path script = folder / (table.name + ".gp");
  if (!std::filesystem::exists(folder / (table.name + ".csv"))) {
    throw AnalysisError("there is no " + table.name + ".csv in " + folder.string() + " to draw");
  }
  std::ofstream file(script, std::ios::binary | std::ios::trunc);
  file << style << "set output '" << table.name << ".svg'\n"
       << "data = '" << table.name << ".csv'\n"
       << table.plot << (table.rows.empty() ? empty_plot : "") << "set output\n";
  file.close();
  if (!file) throw AnalysisError("cannot write " + script.string());

  const Outcome outcome = run_gnuplot(folder, script.filename().string());
  const bool drawn = WIFEXITED(outcome.status) && WEXITSTATUS(outcome.status) == 0 &&
                     std::filesystem::exists(svg) && std::filesystem::file_size(svg) > 0;
  if (!drawn) {
    std::filesystem::remove(svg);
    throw AnalysisError("gnuplot could not draw " + table.name + ":\n" + outcome.messages);
  }
  return svg;
}

}  // namespace shearcell
