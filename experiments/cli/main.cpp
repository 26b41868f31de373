// SPDX-License-Identifier: GPL-3.0-or-later
// The program: reads the command line and turns errors into messages and exit codes.
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>

#include "core/filling.hpp"
#include "core/watchdog.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/manifest/suggest.hpp"
#include "experiments/runner/host.hpp"
#include "provenance/errors.hpp"
#include "provenance/io/file.hpp"
#include "provenance/json_text.hpp"
#include "provenance/lineage.hpp"

namespace shearcell::cli {
namespace {

constexpr const char* kDescription =
    R"(Discrete element experiments on cyclically sheared frictionless grains:
YAML manifests expand into seeded runs, a store keeps every checkpoint, and figures are drawn
from the store alone.)";

constexpr const char* kBegin =
    R"(shearcell computes experiments on sheared grains. Give a command:
  shearcell new mine                        # writes mine.yaml, a manifest with comments
  shearcell run mine.yaml --scale smoke     # computes it in seconds
  shearcell --help                          # lists all commands
)";

constexpr const char* kFooter =
    R"(Examples:
  shearcell plan experiments/drag.yaml --scale desk
  shearcell run experiments/drag.yaml --scale smoke
  shearcell figures S2 --out figures
  shearcell resume

Exit codes: 0 done; 1 the machine failed (disk full, store locked, out of memory, output
lost); 2 usage or manifest error; 3 a run failed numerically or does not fit into memory;
4 the store is damaged; 85 interrupted, resumable.)";

const std::vector<std::pair<const char*, std::vector<AddCommand*>>> kCommands = {
    {"Compute", {add_new, add_plan, add_run, add_submit}},
    {"Look", {add_status, add_show, add_log, add_table, add_figures, add_report}},
    {"Keep", {add_verify, add_rebuild, add_prune, add_regenerate}},
    {"Share", {add_merge, add_export}},
    {"This program", {add_doctor, add_bench, add_manual}}};

struct HelpFormatter : CLI::Formatter {
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    const std::string help = CLI::Formatter::make_help(app, std::move(name), mode);
    const auto width = terminal_columns(stdout);
    return width ? filled(help, *width) : help;
  }
};

std::string version_text() {
  const nlohmann::json facts = host_facts();
  const Maker maker = maker_of(facts);
  return fmt::format("shearcell {}\n{}, {} build, {}\nflags: {}\nlibraries: {}", maker.version,
                     text_at(facts["build"], "compiler"), text_at(facts["build"], "type"),
                     text_at(facts, "simd"), maker.flags, fmt::join(maker.libraries, ", "));
}

constexpr const char* kNoMemory =
    "out of memory; close other programs, raise the limit (ulimit -v), or use fewer threads, "
    "fewer runs at a time or fewer grains";

// Ends the program at once. The store stays intact, as after a kill. Throwing an exception would
// need memory, and an exception in a thread would abort the program.
[[noreturn]] void end_without_memory() {
  for (const char* text : {"shearcell: ", kNoMemory, "\n"}) {
    (void)!write(STDERR_FILENO, text, std::strlen(text));
  }
  std::_Exit(kOtherError);
}

template <class... Errors>
bool is_any(const std::exception& error) {
  return ((dynamic_cast<const Errors*>(&error) != nullptr) || ...);
}

ExitCode exit_code_of(const std::exception& error) {
  if (is_any<UsageError, NotOurs, GeometryError>(error)) return kUsageError;
  if (is_any<NumericalFailure>(error)) return kRunFailed;
  if (is_any<StoreDamaged>(error)) return kStoreDamaged;
  return kOtherError;
}

std::string message_of(const std::exception& error) {
  if (is_any<std::bad_alloc>(error)) return kNoMemory;
  const auto* of_system = dynamic_cast<const std::system_error*>(&error);
  if (of_system != nullptr && of_system->code() == std::errc::resource_unavailable_try_again) {
    return "memory or threads ran out; raise their limits (ulimit -v and ulimit -u)";
  }
  const auto* of_path = dynamic_cast<const std::filesystem::filesystem_error*>(&error);
  if (of_path == nullptr) return error.what();
  return fmt::format("{}: {}", of_path->path1().string(), of_path->code().message());
}

int complain(int code, const char* what) {
  print_stderr("shearcell: {}\n", what);
  return code;
}

/// Returns the error message for an unknown command or argument. Suggests the most similar word.
std::string describe_extras(const CLI::App& app) {
  const CLI::App* at = &app;
  while (at->remaining().empty() && !at->get_subcommands().empty()) {
    at = at->get_subcommands().front();
  }
  const std::vector<std::string> words = at->remaining();
  const std::string first = words.empty() ? "" : words.front();
  std::vector<std::string> known;
  for (const CLI::App* command : at->get_subcommands({})) known.push_back(command->get_name());
  if (at == &app && !first.starts_with('-')) {
    return fmt::format(
        "There is no command {}; {}", first,
        did_you_mean(first, std::vector<std::string_view>(known.begin(), known.end())));
  }
  for (const CLI::Option* option : at->get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  const std::vector<std::string_view> names(known.begin(), known.end());
  return with_nearest(
      fmt::format("The following arguments were not expected: {}", fmt::join(words, " ")), first,
      names);
}

// Corrects inherited settings. If a standard stream were closed, the next opened file would get the
// descriptor of that stream. If SIGCHLD were ignored, waiting for a child process would fail.
void make_surroundings_usual() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) != -1) continue;
    // open() returns the lowest free descriptor, which is that of the closed stream. With
    // this access mode, reading standard input fails, and so does writing to the other two streams.
    (void)!open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
  std::signal(SIGCHLD, SIG_DFL);
}

// Returns `code`, or an error code if `code` is 0 and standard output could not be written.
int after_output(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  return complain(code == kDone ? kOtherError : code,
                  "standard output was not written completely: it is closed, or its disk is full");
}

int run(int argc, char** argv) {
  Context context;
  // CLI11's envname() is not used, since each subcommand would override --store with the variable.
  const char* store = std::getenv("SHEARCELL_STORE");
  if (store != nullptr && *store != '\0') context.store = store;
  CLI::App app{kDescription, "shearcell"};
  app.formatter(std::make_shared<HelpFormatter>());  // set first, since new commands copy it
  app.footer(kFooter);
  app.set_version_flag("--version", version_text());
  app.require_subcommand(0, 1);  // minimum 0, so that describe_extras() reports unknown commands
  for (const auto& [group, commands] : kCommands) {
    for (AddCommand* const add : commands) add(app, context);
    for (CLI::App* command : app.get_subcommands({})) {
      if (command->get_group() == "Subcommands") command->group(group);
    }
  }
  try {
    app.parse(argc, argv);
    if (!app.get_subcommands().empty()) return context.exit_code;
    print_stderr("{}", kBegin);
    return kUsageError;
  } catch (const CLI::ExtrasError&) {
    print_stderr("{}\nRun with --help for more information.\n", describe_extras(app));
    return kUsageError;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUsageError;
  } catch (const nlohmann::json::exception& error) {
    // These come only from records of the store, since all other JSON is checked first.
    const std::string why = fmt::format(
        "{}: a record in the store is malformed ({}); run `shearcell verify`, and restore the "
        "store from a backup",
        context.store, error.what());
    return complain(kStoreDamaged, why.c_str());
  } catch (const std::exception& error) {
    // An exit code that was set earlier takes precedence over the code of this error.
    const bool known = context.exit_code != kDone;
    return complain(known ? context.exit_code : exit_code_of(error), message_of(error).c_str());
  }
}

}  // namespace
}  // namespace shearcell::cli

int main(int argc, char** argv) {
  std::set_new_handler(shearcell::cli::end_without_memory);
  shearcell::cli::make_surroundings_usual();
  return shearcell::cli::after_output(shearcell::cli::run(argc, argv));
}
