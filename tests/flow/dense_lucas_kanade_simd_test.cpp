#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <opencv2/core.hpp>

#include "flow/dense_lucas_kanade.hpp"
#include "tests/flow/analytic_image.hpp"

namespace stillkite {
namespace {

const Eigen::Affine2d kStill = Eigen::Affine2d::Identity();
const Eigen::Affine2d kMotion(Eigen::Translation2d(2.3, -1.4) * Eigen::Rotation2Dd(0.01));

// Restricts run-time dispatch to one instruction set while it lives.
struct OnlyTarget {
  explicit OnlyTarget(std::int64_t target) { set(target); }
  ~OnlyTarget() { set(0); }
  OnlyTarget(const OnlyTarget&) = delete;
  OnlyTarget& operator=(const OnlyTarget&) = delete;

 private:
  static void set(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

TEST(dense_lucas_kanade_simd, every_instruction_set_gives_the_scalar_flow) {
  const cv::Size size(217, 150);  // no multiple of any vector's length
  const cv::Mat previous = analytic_frame(size, kStill);
  const cv::Mat current = analytic_frame(size, kMotion);
  DenseLucasKanade flow({});
  cv::Mat scalar_flow, scalar_information;
  {
    const OnlyTarget scalar(HWY_STATIC_TARGET);
    const FlowField& field = flow(previous, current);
    field.flow_px.copyTo(scalar_flow);
    field.information.copyTo(scalar_information);
  }
  int targets = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const OnlyTarget only(target);
    const FlowField& field = flow(previous, current);
    EXPECT_LT(cv::norm(field.flow_px, scalar_flow, cv::NORM_INF), 1e-3) << hwy::TargetName(target);
    EXPECT_LT(cv::norm(field.information, scalar_information, cv::NORM_INF),
              1e-4 * cv::norm(scalar_information, cv::NORM_INF))
        << hwy::TargetName(target);
    ++targets;
  }
  EXPECT_GE(targets, 1);
}

// Counts the matrices that are made while it lives.
class CountingAllocator : public cv::MatAllocator {
 public:
  CountingAllocator() { cv::Mat::setDefaultAllocator(this); }
  ~CountingAllocator() override { cv::Mat::setDefaultAllocator(nullptr); }
  CountingAllocator(const CountingAllocator&) = delete;
  CountingAllocator& operator=(const CountingAllocator&) = delete;

  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, size_t* step,
                         cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    ++made_;
    return standard_->allocate(dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag access,
                cv::UMatUsageFlags usage) const override {
    return standard_->allocate(data, access, usage);
  }
  void deallocate(cv::UMatData* data) const override { standard_->deallocate(data); }

  [[nodiscard]] int made() const { return made_; }

 private:
  cv::MatAllocator* standard_ = cv::Mat::getStdAllocator();
  mutable int made_ = 0;
};

TEST(dense_lucas_kanade_simd, later_frames_make_no_matrix) {
  const cv::Size size(217, 150);
  const cv::Mat previous = analytic_frame(size, kStill);
  const cv::Mat current = analytic_frame(size, kMotion);
  const CountingAllocator allocator;
  DenseLucasKanade flow({});
  flow(previous, current);
  const int first = allocator.made();
  EXPECT_GT(first, 0);
  flow(previous, current);
  flow(previous, current, Eigen::Matrix3d::Identity());
  EXPECT_EQ(allocator.made(), first);
}

}  // namespace
}  // namespace stillkite
