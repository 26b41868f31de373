// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string_view>

namespace shearcell {
namespace {

class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0) {
      throw std::runtime_error(std::string("cannot make a pipe: ") + std::strerror(errno));
    }
  }
  ~Pipe() {
    close(ends_[0]);
    close_writer();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int reader() const { return ends_[0]; }
  int writer() const { return ends_[1]; }
  void close_writer() {
    if (ends_[1] >= 0) close(ends_[1]);
    ends_[1] = -1;
  }
  /// Appends what is there, or waits for it. False at the end.
  bool read_some(std::string& text) const {
    std::array<char, 4096> buffer;
    const ssize_t got = read(ends_[0], buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) return true;
    if (got <= 0) return false;
    text.append(buffer.data(), static_cast<std::size_t>(got));
    return true;
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

/// Reads both to their ends, whichever has something, so that neither can fill up and block.
void read_all(const Pipe& first, std::string& first_text, const Pipe& second,
              std::string& second_text) {
  std::array<pollfd, 2> ends{pollfd{first.reader(), POLLIN, 0}, pollfd{second.reader(), POLLIN, 0}};
  while (ends[0].fd >= 0 || ends[1].fd >= 0) {
    if (poll(ends.data(), ends.size(), -1) < 0 && errno != EINTR) return;
    if (ends[0].revents != 0 && !first.read_some(first_text)) ends[0].fd = -1;
    if (ends[1].revents != 0 && !second.read_some(second_text)) ends[1].fd = -1;
  }
}

std::string_view name_of_variable(std::string_view text) {
  return text.substr(0, text.find('='));
}

std::vector<std::string> environment_with(const std::vector<std::string>& variables) {
  std::vector<std::string> all = variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const bool replaced = std::any_of(variables.begin(), variables.end(), [&](const auto& other) {
      return name_of_variable(other) == name_of_variable(*variable);
    });
    if (!replaced) all.emplace_back(*variable);
  }
  return all;
}

}  // namespace

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

bool ProgramOutcome::succeeded() const {
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::optional<ProgramOutcome> run_program(std::vector<std::string> words,
                                          const std::filesystem::path& folder,
                                          const std::vector<std::string>& variables) {
  Pipe output, messages;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output.writer(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, messages.writer(), STDERR_FILENO);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  std::vector<std::string> environment = environment_with(variables);
  pid_t child = 0;
  const int failure = posix_spawnp(&child, words.front().c_str(), &actions, nullptr,
                                   pointers_to(words).data(), pointers_to(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT) return std::nullopt;
  if (failure != 0) {
    throw std::runtime_error("cannot start " + words.front() + ": " + std::strerror(failure));
  }
  output.close_writer();
  messages.close_writer();
  ProgramOutcome outcome;
  read_all(output, outcome.output, messages, outcome.messages);
  while (waitpid(child, &outcome.status, 0) < 0) {
    if (errno != EINTR) throw std::runtime_error(words.front() + " was lost while it ran");
  }
  return outcome;
}

}  // namespace shearcell
