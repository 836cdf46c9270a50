#include "io/results/estimate_json.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace stillkite {
namespace {

TEST(EstimateJson, HasTheColumnsOfTheTableWithoutUnits) {
  NavigationEstimate estimate;
  estimate.stamp = {1'234'567'890'123'456'789};
  estimate.scale = ScaleSource::range;
  estimate.world_from_body.translation = {1.5, 0, 2};
  estimate.quality.condition = std::numeric_limits<double>::infinity();
  const std::string line = estimate_json(estimate);
  EXPECT_EQ(line.back(), '\n');
  const nlohmann::json parsed = nlohmann::json::parse(line);
  EXPECT_EQ(parsed["schema"], kEstimateSchema);
  EXPECT_EQ(parsed["timestamp"], 1'234'567'890'123'456'789);
  EXPECT_EQ(parsed["x"], 1.5);
  EXPECT_EQ(parsed["scale"], "range");
  EXPECT_EQ(parsed["verdict"], "first_frame");
  EXPECT_TRUE(parsed["condition"].is_null());
  EXPECT_TRUE(parsed["reference_stamp"].is_null());
}

TEST(EstimateJson, PositionWithoutScaleIsNull) {
  const nlohmann::json parsed = nlohmann::json::parse(estimate_json(NavigationEstimate{}));
  EXPECT_TRUE(parsed["x"].is_null());
  EXPECT_TRUE(parsed["x_in_heights"].is_number());
}

}  // namespace
}  // namespace stillkite
