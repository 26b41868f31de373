// SPDX-License-Identifier: GPL-3.0-or-later
// The program: reads the command line and turns errors into messages and exit codes.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "experiments/cli/command.hpp"
#include "experiments/runner/host.hpp"
#include "experiments/runner/terminal.hpp"

namespace shearcell::cli {
namespace {

constexpr const char* kDescription =
    "Discrete element experiments on cyclically sheared frictionless grains:\n"
    "YAML manifests expand into seeded runs, a store keeps every checkpoint, and figures are "
    "drawn\n"
    "from the store alone.";

constexpr const char* kFooter =
    "Examples:\n"
    "  shearcell plan experiments/drag.yaml --scale desk\n"
    "  shearcell run experiments/drag.yaml --scale smoke\n"
    "  shearcell figures S2 --out figures\n"
    "  shearcell resume\n"
    "\n"
    "Exit codes: 0 done; 2 usage or manifest error; 3 a run failed numerically;\n"
    "4 the store is damaged; 85 interrupted, resumable.";

std::string version_text() {
  const nlohmann::json facts = host_facts();
  const nlohmann::json& build = facts["build"];
  const auto word = [&](const char* key) { return build[key].get<std::string>(); };
  std::string libraries;
  for (const auto& [name, version] : facts["libraries"].items()) {
    libraries +=
        fmt::format("{}{} {}", libraries.empty() ? "" : ", ", name, version.get<std::string>());
  }
  return fmt::format("shearcell {} ({})\n{}, {} build, {}\nflags: {}\nlibraries: {}",
                     word("version"), word("commit"), word("compiler"), word("type"),
                     facts["simd"].get<std::string>(), word("flags"), libraries);
}

int complain(int code, const char* what) {
  fmt::print(stderr, "shearcell: {}\n", for_terminal(what));
  return code;
}

int run(int argc, char** argv) {
  Context context;
  // Not the option's own envname: CLI11 reads that for every subcommand, and so over what was
  // parsed.
  const char* store = std::getenv("SHEARCELL_STORE");
  if (store != nullptr && *store != '\0') context.store = store;
  CLI::App app{kDescription, "shearcell"};
  app.footer(kFooter);
  app.set_version_flag("--version", version_text());
  app.require_subcommand(0, 1);  // so that a word that is none is named
  for (const auto add : {add_plan,   add_run,     add_status,  add_log,        add_show,
                         add_verify, add_rebuild, add_prune,   add_regenerate, add_submit,
                         add_work,   add_merge,   add_figures, add_report,     add_export,
                         add_bench,  add_new,     add_doctor,  add_completion, add_manual}) {
    add(app, context);
  }
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) throw CLI::RequiredError("A subcommand");
    return context.exit_code;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUsageError;
  } catch (const nlohmann::json::exception& error) {
    const std::string why = fmt::format(
        "{}: a record is not as this program writes it ({}); run `shearcell verify`, and restore "
        "the store from a backup",
        context.store, error.what());
    return complain(exit_code_of(error), why.c_str());
  } catch (const std::exception& error) {
    return complain(exit_code_of(error), error.what());
  }
}

}  // namespace
}  // namespace shearcell::cli

int main(int argc, char** argv) {
  return shearcell::cli::run(argc, argv);
}
