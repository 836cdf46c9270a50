#include "app/variants.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

std::string problem_with(const std::string& list) {
  try {
    (void)parse_variants(list);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

using Overrides = std::vector<std::string>;

TEST(Variants, DefaultToAllPolicies) {
  const auto variants = parse_variants(std::nullopt);
  ASSERT_EQ(variants.size(), EnumNames<Policy>::value.size());
  EXPECT_EQ(variants[0].name, "flow");
  EXPECT_EQ(variants[0].overrides, Overrides{"estimator.policy=flow"});
  EXPECT_EQ(variants[1].name, "reference");
}

TEST(Variants, ParseKeysPerName) {
  const auto variants = parse_variants("flow, own:a=1,b.c={x: [1,2], y: 3} ,reference:d=2");
  ASSERT_EQ(variants.size(), 3U);
  EXPECT_EQ(variants[1].name, "own");
  EXPECT_EQ(variants[1].overrides, (Overrides{"a=1", "b.c={x: [1,2], y: 3}"}));
  EXPECT_EQ(variants[2].overrides, (Overrides{"estimator.policy=reference", "d=2"}));
}

TEST(Variants, RejectInvalidNamesWithRemedy) {
  EXPECT_NE(problem_with("flow,refrence").find("did you mean 'reference'?); use flow, "),
            std::string::npos);
  EXPECT_NE(problem_with("flow,flow").find("duplicate name"), std::string::npos);
  EXPECT_NE(problem_with("flow,a:x=1,a:x=2").find("'a' is a duplicate name"), std::string::npos);
  EXPECT_NE(problem_with("").find("not a valid name"), std::string::npos);
  EXPECT_NE(problem_with("flow,").find("not a valid name"), std::string::npos);
  EXPECT_NE(problem_with("../up:x=1").find("not a valid name"), std::string::npos);
  EXPECT_NE(problem_with("x=1,flow").find("precedes any name"), std::string::npos);
  EXPECT_NE(problem_with("own:").find("no key=value"), std::string::npos);
}

TEST(Variants, OverrideCommonKeys) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "flight.yaml";
  std::ofstream(file) << "{source: {path: flight.mp4}, initial: {height_m: 20}}\n";
  const auto variants =
      load_variants(file, {"initial.height_m=30"},
                    parse_variants("flow,reference,low:initial.height_m=5,estimator.mode=paper"));
  ASSERT_EQ(variants.size(), 3U);
  EXPECT_EQ(variants[0].config.estimator.policy, Policy::flow);
  EXPECT_EQ(variants[1].config.estimator.policy, Policy::reference);
  EXPECT_EQ(variants[1].config.initial.height_m, 30);
  EXPECT_EQ(variants[2].config.initial.height_m, 5);
  EXPECT_EQ(variants[2].config.estimator.mode, Mode::paper);
  EXPECT_EQ(variants[2].config.source.path, variants[0].config.source.path);
  for (const char* wrong : {"own:no.such=1", "own:source.path=b.mp4", "own:truth={}"}) {
    EXPECT_THROW((void)load_variants(file, {}, parse_variants(wrong)), InputError) << wrong;
  }
  EXPECT_THROW((void)load_variants(file, {}, parse_variants("flow:estimator.policy=reference")),
               InputError);
}

}  // namespace
}  // namespace stillkite
