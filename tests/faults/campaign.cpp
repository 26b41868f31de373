// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/faults/campaign.hpp"

#include <sys/wait.h>

#include <stdexcept>
#include <utility>

#include "provenance/errors.hpp"
#include "tests/experiments/temporary_store.hpp"
#include "tests/support/spawn.hpp"

namespace shearcell::test {

namespace fs = std::filesystem;

namespace {

bool is_write(const std::string& operation) {
  return operation.find(" write ") != std::string::npos ||
         operation.find(" pwrite") != std::string::npos;
}

bool is_read(const std::string& operation) {
  return operation.find(" read ") != std::string::npos ||
         operation.find(" pread") != std::string::npos ||
         operation.find(" openat ") != std::string::npos;
}

}  // namespace

std::string small_manifest(const std::string& more, std::size_t cycles) {
  return "experiment: small\n"
         "question: Does the store survive?\n"
         "figures: [S2]\n"
         "base:\n"
         "  grains: 60\n"
         "  walls: smooth\n"
         "  period_s: 0.05\n"
         "  steps_per_cycle: 500\n"
         "  amplitude_rad: 0.01\n"
         "  settle_time_step_s: 1.0e-4\n"
         "  cycles: " +
         std::to_string(cycles) +
         "\n"
         "sweep: {grid: {fluid: [still, cell]}}\n" +
         more;
}

pid_t start_program(const fs::path& folder, const Words& words, const Fault& fault, bool reads) {
  Words all = {"-u", "SHEARCELL_STORE"};
  if (!fault.kind.empty()) {
    all.insert(all.end(),
               {"LD_PRELOAD=" SHEARCELL_FAULT_LAYER, "FAULT_FOLDER=" + (folder / "store").string(),
                "FAULT_KIND=" + fault.kind, "FAULT_AT=" + std::to_string(fault.at)});
    if (fault.at == 0) all.push_back("FAULT_COUNT=" + (folder / "operations").string());
    if (reads) all.emplace_back("FAULT_READS=1");
  }
  all.emplace_back(SHEARCELL_PROGRAM);
  all.insert(all.end(), words.begin(), words.end());
  all.insert(all.end(), {"--store", (folder / "store").string()});
  return spawn(std::move(all), folder, folder / "printed", folder / "said");
}

int wait_for_exit(pid_t program) {
  int status = 0;
  waitpid(program, &status, 0);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

pid_t start_campaign(const fs::path& folder, const Fault& fault) {
  return start_program(folder, {"run", (folder / "small.yaml").string(), "-q", "-j", "1"}, fault);
}

std::vector<std::string> list_operations(const fs::path& folder, const Words& words, bool reads) {
  if (wait_for_exit(start_program(folder, words, {0, "none"}, reads)) != 0) {
    throw std::runtime_error("it fails without a fault: " + read_bytes(folder / "said"));
  }
  std::vector<std::string> lines;
  std::ifstream file(folder / "operations");
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

std::vector<Fault> fault_points(const std::vector<std::string>& operations) {
  std::vector<Fault> all;
  for (std::size_t i = 0; i < operations.size(); ++i) {
    for (const char* kind : {"kill", "enospc", "eio", "torn", "lost"}) {
      const bool of_writes = std::string(kind) == "torn" || std::string(kind) == "lost";
      if (of_writes ? !is_write(operations[i])
                    : is_read(operations[i]) && std::string(kind) != "eio") {
        continue;
      }
      all.push_back({static_cast<long>(i + 1), kind});
    }
  }
  return all;
}

std::vector<std::string> check_left_behind(const fs::path& folder, bool could_write) {
  const fs::path store_folder = folder / "store";
  std::vector<std::string> wrong;
  try {
    const Store store(store_folder, Access::read);
    const VerifyReport report = store.verify();
    for (const Finding& finding : report.findings) {
      if (finding.severity == Finding::Severity::error) {
        wrong.push_back(finding.subject + ": " + finding.message);
      }
    }
    for (const Stage& run : store.stages()) {
      if (could_write && run.state == StageState::running)
        wrong.push_back(run.id + " has no holder");
      for (const CheckpointRecord& record : store.checkpoints(run.id)) {
        store.load_checkpoint(record);  // throws when it is missing or wrong
      }
    }
  } catch (const std::exception& error) {
    // A crash during the creation of the store leaves none.
    if (fs::exists(store_folder / "store.sqlite")) wrong.emplace_back(error.what());
  }
  return wrong;
}

}  // namespace shearcell::test
