// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/runner/host.hpp"

#include <sys/utsname.h>

#include <Eigen/Core>
#include <fstream>
#include <string>

#include "core/kernel.hpp"
#include "core/machine.hpp"
#include "experiments/runner/build_facts.hpp"

namespace shearcell {
namespace {

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown";
}

}  // namespace

nlohmann::json host_facts() {
  utsname system{};
  uname(&system);
  return {
      {"host", system.nodename},
      {"system", std::string(system.sysname) + " " + system.release + " " + system.machine},
      {"cpu", cpu_model()},
      {"cores", usable_cores()},
      {"simd", kernels_here().front()->name},
      {"build",
       {{"version", kBuildVersion},
        {"commit", kBuildCommit},
        {"compiler", kBuildCompiler},
        {"flags", kBuildFlags},
        {"type", kBuildType}}},
      {"libraries",
       {{"eigen", std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) +
                      "." + std::to_string(EIGEN_MINOR_VERSION)},
        {"hdf5", kHdf5Version},
        {"sqlite", kSqliteVersion},
        {"yaml-cpp", kYamlCppVersion},
        {"cgal", kCgalVersion}}}};
}

}  // namespace shearcell
