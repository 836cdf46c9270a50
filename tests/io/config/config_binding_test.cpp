#include "io/config/config_binding.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "io/config/config_printing.hpp"

namespace stillkite {
namespace {

enum class Shape { round, square };

}  // namespace

template <>
struct EnumNames<Shape> {
  static constexpr auto value = std::to_array<std::pair<Shape, std::string_view>>(
      {{Shape::round, "round"}, {Shape::square, "square"}});
};

namespace {

struct Inner {
  double gain = 0.5;
  Shape shape = Shape::round;
  bool operator==(const Inner&) const = default;

  static void fields(auto& self, auto&& field) {
    field("gain", self.gain, Range{.min = 0, .max = 1}, "loop gain");
    field("shape", self.shape, "shape of the object");
  }
};

struct Sample {
  bool on = false;
  int count = 3;
  double length_m = 0.1;
  std::string name = "a b";
  std::filesystem::path file = "/tmp/x";
  std::vector<double> list{1, 2.5};
  std::array<double, 3> triple{1, 2, 3};
  std::optional<double> maybe{};
  std::optional<Inner> maybe_inner{};
  Inner inner{};
  bool operator==(const Sample&) const = default;

  static void fields(auto& self, auto&& field) {
    field("on", self.on, "flag");
    field("count", self.count, Range{1, 99}, "count");
    field("length_m", self.length_m, kPositive, "length");
    field("name", self.name, "text");
    field("file", self.file, "path");
    field("list", self.list, "numbers");
    field("triple", self.triple, "three numbers");
    field("maybe", self.maybe, kNonNegative, "number or null");
    field("maybe_inner", self.maybe_inner, "group or null");
    field("inner", self.inner, "group");
  }
};

Sample parse_sample(const std::string& text) {
  return bind_config<Sample>(parse_yaml(text, "a.yaml", "/base"));
}

std::string sample_error(const std::string& text) {
  try {
    (void)parse_sample(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ConfigBinding, KeepsDefaultsOfAbsentKeys) {
  EXPECT_EQ(parse_sample("{}"), Sample{});
}

TEST(ConfigBinding, ReadsEveryKindOfField) {
  const Sample sample = parse_sample(
      "on: true\ncount: 7\nlength_m: 2e-3\nname: 'x: y'\nfile: sub/f.csv\nlist: [4]\n"
      "triple: [-1, +2, .5]\nmaybe: 8\nmaybe_inner: {gain: 1}\ninner:\n  shape: square\n");
  const Sample expected{.on = true,
                        .count = 7,
                        .length_m = 2e-3,
                        .name = "x: y",
                        .file = "/base/sub/f.csv",
                        .list = {4},
                        .triple = {-1, 2, 0.5},
                        .maybe = 8,
                        .maybe_inner = Inner{.gain = 1},
                        .inner = {.shape = Shape::square}};
  EXPECT_EQ(sample, expected);
}

TEST(ConfigBinding, PrintedConfigReadsBackEqual) {
  Sample sample{.on = true,
                .count = 42,
                .length_m = 1.0 / 3.0,
                .name = "quote \" back \\ tab \t null",
                .file = "/a b/c",
                .list = {},
                .triple = {1e-300, 0.1, 7},
                .maybe = 0.0};
  EXPECT_EQ(parse_sample(print_config(sample)), sample);
  sample.maybe_inner = Inner{.gain = 0.25, .shape = Shape::square};
  sample.name = "null";
  EXPECT_EQ(parse_sample(print_config(sample)), sample);
  EXPECT_EQ(parse_sample(print_config(Sample{})), Sample{});
}

TEST(ConfigBinding, PrintsDescriptionRangeAndEnumNames) {
  const std::string text = print_config(Sample{});
  EXPECT_NE(text.find("count: 3  # count; in [1, 99]\n"), std::string::npos) << text;
  EXPECT_NE(text.find("length_m: 0.1  # length; in (0, inf)\n"), std::string::npos) << text;
  EXPECT_NE(text.find("  shape: round  # shape of the object: round | square\n"),
            std::string::npos);
  EXPECT_NE(text.find("maybe_inner: null  # group or null\n#  gain: 0.5"), std::string::npos);
}

TEST(ConfigBinding, ErrorsNameLocationKeyValueAndRemedy) {
  EXPECT_EQ(sample_error("on: true\ncoutn: 3\n"),
            "a.yaml:2:1: coutn: unknown key, did you mean 'count'?; known keys: on, count, "
            "length_m, name, file, list, triple, maybe, maybe_inner, inner");
  EXPECT_EQ(sample_error("inner:\n  gain: 1.5\n"),
            "a.yaml:2:3: inner.gain: 1.5 is out of range, allowed: [0, 1]");
  EXPECT_EQ(sample_error("inner: {zzz: 1}"),
            "a.yaml:1:9: inner.zzz: unknown key; known keys of inner: gain, shape");
  EXPECT_EQ(sample_error("inner: {shape: sqare}"),
            "a.yaml:1:9: inner.shape: 'sqare' is not one of round, square, did you mean 'square'?");
  EXPECT_EQ(sample_error("length_m: 0"),
            "a.yaml:1:1: length_m: 0 is out of range, allowed: (0, inf)");
  EXPECT_EQ(sample_error("count: 3.5"), "a.yaml:1:1: count: '3.5' is not an integer");
  EXPECT_EQ(sample_error("count: 99999999999"),
            "a.yaml:1:1: count: 99999999999 is out of range, allowed: [1, 99]");
  EXPECT_EQ(sample_error("length_m: .nan"), "a.yaml:1:1: length_m: '.nan' is not a finite number");
  EXPECT_EQ(sample_error("length_m: '1'"), "a.yaml:1:1: length_m: '1' is not a finite number");
  EXPECT_EQ(sample_error("on: yes"), "a.yaml:1:1: on: 'yes' is neither true nor false");
  EXPECT_EQ(sample_error("on:"), "a.yaml:1:1: on: expected true or false, found null");
  EXPECT_EQ(sample_error("triple: [1, 2]"),
            "a.yaml:1:1: triple: expected a list of 3 numbers, found 2");
  EXPECT_EQ(sample_error("list: 3"),
            "a.yaml:1:1: list: expected a list of numbers, for example [1, 2]");
  for (const char* second : {"---\n", "--- # more\n", "...\n"}) {
    EXPECT_EQ(sample_error(std::string("on: true\n") + second + "on: false\n"),
              "a.yaml: more than one YAML document (---); keep one")
        << second;
  }
  EXPECT_EQ(sample_error("on: true\non: false\n"), "a.yaml:2:1: key 'on' is given twice; keep one");
  EXPECT_EQ(sample_error("inner: 3"), "a.yaml:1:1: inner: expected a group of keys: gain, shape");
  EXPECT_EQ(sample_error("a: b: c"), "a.yaml:1:5: invalid YAML: illegal map value");
}

TEST(ConfigBinding, ChecksOverridesLikeFileValues) {
  ConfigNode root = parse_yaml("inner:\n  gain: 0.1\n  shape: square\nmaybe: 3\n", "a.yaml", "/");
  apply_override(root, "inner.gain=0.75");
  apply_override(root, "list=[1, 2]");
  apply_override(root, "name=a: [b");
  apply_override(root, "maybe=");
  apply_override(root, "file=here.csv");
  const Sample sample = bind_config<Sample>(root);
  EXPECT_EQ(sample.inner, (Inner{.gain = 0.75, .shape = Shape::square}));
  EXPECT_EQ(sample.list, (std::vector<double>{1, 2}));
  EXPECT_EQ(sample.name, "a: [b");
  EXPECT_FALSE(sample.maybe.has_value());
  EXPECT_EQ(sample.file, std::filesystem::current_path() / "here.csv");

  apply_override(root, "inner.gian=1");
  try {
    (void)bind_config<Sample>(root);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "--set inner.gian=1: inner.gian: unknown key, did you mean 'gain'?; known keys of "
                 "inner: gain, shape");
  }
  EXPECT_THROW(apply_override(root, "no_equals_sign"), InputError);
  EXPECT_THROW(apply_override(root, "=1"), InputError);
}

TEST(ConfigBinding, ExpandsEnvironmentVariablesInPaths) {
  ASSERT_EQ(setenv("STILLKITE_TEST_FOLDER", "/data", 1), 0);
  EXPECT_EQ(parse_sample("file: ${STILLKITE_TEST_FOLDER}/a/../b.csv").file, "/data/b.csv");
  EXPECT_EQ(parse_sample("{file: ${STILLKITE_TEST_FOLDER}/b.csv}").file, "/data/b.csv");
  EXPECT_EQ(sample_error("file: ${STILLKITE_NO_SUCH}/x"),
            "a.yaml:1:1: file: environment variable STILLKITE_NO_SUCH in "
            "'${STILLKITE_NO_SUCH}/x' is not set; export it or write the full path");
}

TEST(ConfigBinding, RejectsRecursiveAndExpandingDocuments) {
  EXPECT_THROW((void)parse_sample("a: &x [*x]"), InputError);
  std::string bomb = "a0: &a0 [1,1,1,1,1,1,1,1,1,1]\n";
  for (int i = 1; i < 9; ++i) {
    bomb += fmt::format("a{0}: &a{0} [*a{1},*a{1},*a{1},*a{1},*a{1},*a{1},*a{1},*a{1},*a{1}]\n", i,
                        i - 1);
  }
  EXPECT_THROW((void)parse_sample(bomb), InputError);
  EXPECT_THROW((void)parse_sample(std::string(100000, '[')), InputError);
}

TEST(ConfigBinding, RejectsASecondDocument) {
  const auto parse = [](const std::string& text) { return parse_yaml(text, "c.yaml", "."); };
  EXPECT_NO_THROW(parse("%YAML:1.0\n---\na: 1\n"));
  EXPECT_NO_THROW(parse("# first\n---\na: 1\n"));
  EXPECT_THROW(parse("a: 1\n---\na: 2\n"), InputError);
}

}  // namespace
}  // namespace stillkite
