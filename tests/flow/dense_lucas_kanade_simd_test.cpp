#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <opencv2/core.hpp>

#include "flow/dense_lucas_kanade.hpp"
#include "tests/flow/analytic_image.hpp"

namespace stillkite {
namespace {

const Eigen::Affine2d kIdentity = Eigen::Affine2d::Identity();
const Eigen::Affine2d kMotion(Eigen::Translation2d(2.3, -1.4) * Eigen::Rotation2Dd(0.01));

// Restricts run-time dispatch to one instruction set within its scope.
struct ScopedTarget {
  explicit ScopedTarget(std::int64_t target) { set(target); }
  ~ScopedTarget() { set(0); }
  ScopedTarget(const ScopedTarget&) = delete;
  ScopedTarget& operator=(const ScopedTarget&) = delete;

 private:
  static void set(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

TEST(DenseLucasKanadeSimd, AllInstructionSetsMatchScalarFlow) {
  const cv::Size size(217, 150);  // no multiple of a SIMD vector length
  const cv::Mat previous = analytic_frame(size, kIdentity);
  const cv::Mat current = analytic_frame(size, kMotion);
  DenseLucasKanade flow({});
  cv::Mat scalar_flow, scalar_information;
  {
    const ScopedTarget scalar(HWY_STATIC_TARGET);
    const FlowField& field = flow(previous, current);
    field.flow_px.copyTo(scalar_flow);
    field.information.copyTo(scalar_information);
  }
  int targets = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    const ScopedTarget scoped_target(target);
    const FlowField& field = flow(previous, current);
    EXPECT_LT(cv::norm(field.flow_px, scalar_flow, cv::NORM_INF), 1e-3) << hwy::TargetName(target);
    EXPECT_LT(cv::norm(field.information, scalar_information, cv::NORM_INF),
              1e-4 * cv::norm(scalar_information, cv::NORM_INF))
        << hwy::TargetName(target);
    ++targets;
  }
  EXPECT_GE(targets, 1);
}

// Counts matrix allocations within its scope.
class CountingAllocator : public cv::MatAllocator {
 public:
  CountingAllocator() { cv::Mat::setDefaultAllocator(this); }
  ~CountingAllocator() override { cv::Mat::setDefaultAllocator(standard_); }
  CountingAllocator(const CountingAllocator&) = delete;
  CountingAllocator& operator=(const CountingAllocator&) = delete;

  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, size_t* step,
                         cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    ++allocations_;
    return standard_->allocate(dims, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag access,
                cv::UMatUsageFlags usage) const override {
    return standard_->allocate(data, access, usage);
  }
  void deallocate(cv::UMatData* data) const override { standard_->deallocate(data); }

  [[nodiscard]] int allocations() const { return allocations_; }

 private:
  cv::MatAllocator* standard_ = cv::Mat::getStdAllocator();
  mutable int allocations_ = 0;
};

TEST(DenseLucasKanadeSimd, AllocatesNoMatrixAfterFirstFrame) {
  const cv::Size size(217, 150);
  const cv::Mat previous = analytic_frame(size, kIdentity);
  const cv::Mat current = analytic_frame(size, kMotion);
  const CountingAllocator allocator;
  DenseLucasKanade flow({});
  flow(previous, current);
  const int first = allocator.allocations();
  EXPECT_GT(first, 0);
  flow(previous, current);
  flow(previous, current, Eigen::Matrix3d::Identity());
  EXPECT_EQ(allocator.allocations(), first);
}

}  // namespace
}  // namespace stillkite
