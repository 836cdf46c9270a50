// Entry point of libFuzzer for the target STILLKITE_FUZZ_TARGET.
#include <algorithm>

#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stillkite::fuzz;
  static const Target target = [] {
    const std::vector<Target> all = targets();
    return *std::ranges::find(all, STILLKITE_FUZZ_TARGET, &Target::name);
  }();
  target.read({data, size});
  return 0;
}
