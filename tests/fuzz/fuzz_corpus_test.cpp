// Each reader accepts or rejects its corpus, the inputs of earlier findings included.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/fuzz_target.hpp"

namespace stillkite::fuzz {
namespace {

namespace fs = std::filesystem;

const fs::path kCorpus = fs::path(STILLKITE_SOURCE_DIR) / "tests/fuzz/corpus";

std::vector<std::string> inputs_of(const Target& target) {
  std::vector<std::string> out = target.seeds();
  if (!fs::exists(kCorpus / target.name)) return out;
  for (const fs::directory_entry& entry : fs::directory_iterator(kCorpus / target.name)) {
    std::ifstream stream(entry.path(), std::ios::binary);
    out.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  }
  return out;
}

class FuzzCorpus : public testing::TestWithParam<Target> {};

TEST_P(FuzzCorpus, HasNoFinding) {
  const std::vector<std::string> inputs = inputs_of(GetParam());
  ASSERT_FALSE(inputs.empty());
  for (const std::string& input : inputs) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(input.data());
    // copies without spare capacity, so that the address sanitizer finds an access beyond the end
    for (const std::size_t size : {input.size(), input.size() / 2, std::size_t{0}}) {
      const std::vector<std::uint8_t> copy(bytes, bytes + size);
      EXPECT_NO_THROW(GetParam().read(copy)) << testing::PrintToString(input);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, FuzzCorpus, testing::ValuesIn(targets()),
                         [](const auto& target) { return std::string(target.param.name); });

TEST(FuzzCorpus, FoldersAreThoseOfTargets) {
  const std::vector<Target> all = targets();
  for (const fs::directory_entry& entry : fs::directory_iterator(kCorpus)) {
    EXPECT_NE(std::ranges::find(all, entry.path().filename().string(), &Target::name), all.end())
        << entry.path();
  }
}

}  // namespace
}  // namespace stillkite::fuzz
