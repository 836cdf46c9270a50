#include "tests/fuzz/fuzz_target.hpp"

namespace stillkite::fuzz {

std::vector<Target> targets() {
  std::vector<Target> out;
  for (const auto part : {live_targets(), import_targets()}) {
    out.insert(out.end(), part.begin(), part.end());
  }
  return out;
}

}  // namespace stillkite::fuzz
