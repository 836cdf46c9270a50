#include "geometry/fields.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "geometry/camera.hpp"

namespace stillkite {
namespace {

struct Inner {
  double gain = 0.5;

  static void fields(auto& self, auto&& field) { field("gain", self.gain, kPositive, "loop gain"); }
};

struct Outer {
  int window_px = 15;
  bool robust = true;
  Inner inner;

  static void fields(auto& self, auto&& field) {
    field("window_px", self.window_px, Range{3, 99}, "side of the window");
    field("robust", self.robust, "robust loss");
    field("inner", self.inner, "control loop");
  }
};

// Collects the full path of each leaf, including nested structs.
struct PathLister {
  std::string prefix;
  std::vector<std::string>& paths;

  template <typename T>
  void operator()(std::string_view name, const T& value, const auto&...) const {
    const std::string path = prefix + std::string(name);
    if constexpr (requires { T::fields(value, *this); }) {
      T::fields(value, PathLister{path + ".", paths});
    } else {
      paths.push_back(path);
    }
  }
};

// Sets every number to the minimum of its range.
struct Minimizer {
  template <typename T>
  void operator()(std::string_view, T& value, const Range& range, std::string_view) const {
    value = static_cast<T>(range.min);
  }
  template <typename T>
  void operator()(std::string_view, T& value, std::string_view) const {
    if constexpr (requires { T::fields(value, *this); }) T::fields(value, *this);
  }
};

TEST(Fields, OneListReadsAndEnumerates) {
  const Outer constant;
  std::vector<std::string> paths;
  Outer::fields(constant, PathLister{"", paths});
  EXPECT_EQ(paths, (std::vector<std::string>{"window_px", "robust", "inner.gain"}));

  Outer changed;
  Outer::fields(changed, Minimizer{});
  EXPECT_EQ(changed.window_px, 3);
  EXPECT_EQ(changed.inner.gain, 0.0);
  EXPECT_TRUE(changed.robust);
}

TEST(Range, IncludesClosedBoundsOnly) {
  constexpr Range kRange{.min = 3, .max = 99};
  EXPECT_TRUE(kRange.contains(3));
  EXPECT_TRUE(kRange.contains(99));
  EXPECT_FALSE(kRange.contains(2.999));
  EXPECT_FALSE(kRange.contains(99.001));
  EXPECT_FALSE(kPositive.contains(0.0));
  EXPECT_TRUE(kPositive.contains(1e-300));
  EXPECT_TRUE(kNonNegative.contains(0.0));
}

TEST(Range, ContainsNoNan) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(kAny.contains(nan));
  EXPECT_FALSE(kPositive.contains(nan));
}

TEST(EnumNames, NamesEachValue) {
  EXPECT_EQ(name_of(DistortionModel::none), "none");
  EXPECT_EQ(name_of(DistortionModel::radial_tangential), "radial-tangential");
  EXPECT_EQ(name_of(DistortionModel::equidistant), "equidistant");
  EXPECT_EQ(name_of(static_cast<DistortionModel>(99)), "?");
}

}  // namespace
}  // namespace stillkite
