// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/error.hpp"
#include "analysis/measures.hpp"
#include "provenance/checkpoint.hpp"
#include "provenance/errors.hpp"
#include "tests/fuzz/seeds.hpp"
#include "tests/fuzz/targets.hpp"

namespace shearcell::fuzz {
namespace {

constexpr Eigen::Index kAnalysed = 64;  // grains; the Voronoi cells of more take long

/// What can be read can be written, and is the same then.
void check_round_trip(const Checkpoint& checkpoint) {
  require(state_hash(decode_checkpoint(encode_checkpoint(checkpoint))) == state_hash(checkpoint),
          "a checkpoint that is read, written and read again is the same");
}

void run(Input input) {
  const std::span<const std::byte> bytes = std::as_bytes(input);
  try {
    decode_checkpoint(bytes);
  } catch (const StoreDamaged&) {
  }
  try {
    const Checkpoint checkpoint = decode_checkpoint(sealed(bytes));
    if (checkpoint.state.position.cols() > kAnalysed ||
        checkpoint.cell.wall_grains.size() > kAnalysed) {
      return;
    }
    check_round_trip(checkpoint);
    require_plausible(checkpoint);
    analyse(checkpoint);
  } catch (const StoreDamaged&) {
  } catch (const AnalysisError&) {
  }
}

}  // namespace

const Target checkpoint_target{"checkpoint", run, checkpoint_seeds};

}  // namespace shearcell::fuzz
