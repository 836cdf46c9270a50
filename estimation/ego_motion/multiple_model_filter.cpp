#include "estimation/ego_motion/multiple_model_filter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace stillkite {
namespace {

using Vector12d = Eigen::Matrix<double, 12, 1>;

// Ratios to the configured acceleration density, and to the standard deviation of a measurement
// (docs/plane_odometry.md: ablation).
constexpr std::array kAccelerationRatios = {0.2, 1.0, 5.0};
constexpr std::array kNoiseRatios = {1.0, 2.0, 4.0};

// Mean time between two changes of the model.
constexpr double kSojourn_s = 3;

}  // namespace

MultipleModelFilter::MultipleModelFilter(const MotionFilterConfig& config) {
  static_assert(kModels == kAccelerationRatios.size() * kNoiseRatios.size());
  auto* model = models_.data();
  for (const double noise_ratio : kNoiseRatios) {
    for (const double acceleration_ratio : kAccelerationRatios) {
      MotionFilterConfig of_model = config;
      of_model.acceleration_density *= acceleration_ratio;
      *model++ = {MotionFilter(of_model), noise_ratio * noise_ratio, 1.0 / kModels};
    }
  }
}

void MultipleModelFilter::for_each_filter(auto&& apply) {
  for (Model& model : models_) apply(model.filter);
  mixture_ = mix(probabilities());
}

MultipleModelFilter::Weights MultipleModelFilter::probabilities() const {
  Weights out;
  std::ranges::transform(models_, out.begin(), &Model::probability);
  return out;
}

// Mean and covariance of the models' states. Differences of the rotation within their covariance
// leave the camera axes of the angular rate as they are.
MotionFilter::State MultipleModelFilter::mix(const Weights& weights) const {
  const MotionFilter::State& base = models_.front().filter.state();
  std::array<Vector12d, kModels> differences;
  Vector12d mean = Vector12d::Zero();
  for (std::size_t i = 0; i < kModels; ++i) {
    const MotionFilter::State& state = models_[i].filter.state();
    differences[i] << state.pose.translation - base.pose.translation,
        so3_log(state.pose.rotation * base.pose.rotation.conjugate()),
        state.velocity_in_world - base.velocity_in_world,
        state.rate_in_camera - base.rate_in_camera;
    mean += weights[i] * differences[i];
  }
  MotionFilter::State out;
  out.pose = {(so3_exp(mean.segment<3>(3)) * base.pose.rotation).normalized(),
              base.pose.translation + mean.head<3>()};
  out.velocity_in_world = base.velocity_in_world + mean.segment<3>(6);
  out.rate_in_camera = base.rate_in_camera + mean.tail<3>();
  for (std::size_t i = 0; i < kModels; ++i) {
    const Vector12d difference = differences[i] - mean;
    out.covariance +=
        weights[i] * (models_[i].filter.state().covariance + difference * difference.transpose());
  }
  return out;
}

void MultipleModelFilter::initialize(const RigidTransform& pose, double velocity_sigma_m_s,
                                     double rate_sigma_rad_s) {
  for_each_filter(
      [&](MotionFilter& filter) { filter.initialize(pose, velocity_sigma_m_s, rate_sigma_rad_s); });
}

// After the time dt the model is another one, each with the same probability, with 1 - exp(-dt/T).
void MultipleModelFilter::predict(double dt_s) {
  const double change = 1 - std::exp(-dt_s / kSojourn_s);
  const Weights before = probabilities();
  std::array<MotionFilter::State, kModels> mixed;
  for (std::size_t j = 0; j < kModels; ++j) {
    Weights weights = before;
    for (double& weight : weights) weight *= change / kModels;
    weights[j] += before[j] * (1 - change);
    models_[j].probability = std::accumulate(weights.begin(), weights.end(), 0.0);
    for (double& weight : weights) weight /= models_[j].probability;
    mixed[j] = mix(weights);
  }
  for (std::size_t j = 0; j < kModels; ++j) models_[j].filter.set_state(mixed[j]);
  for_each_filter([&](MotionFilter& filter) { filter.predict(dt_s); });
}

void MultipleModelFilter::update(const RigidTransform& measured_pose, const Matrix6d& covariance,
                                 const Twist& assumed_twist, const Matrix6d& pose_by_twist) {
  Weights log_likelihoods;
  for (std::size_t i = 0; i < kModels; ++i) {
    log_likelihoods[i] = models_[i].filter.update(
        measured_pose, models_[i].noise_variance_ratio * covariance, assumed_twist, pose_by_twist);
  }
  weight(log_likelihoods);
  mixture_ = mix(probabilities());
}

// Bayes' rule; the probabilities stay where a likelihood is unknown.
void MultipleModelFilter::weight(const Weights& log_likelihoods) {
  if (!std::ranges::all_of(log_likelihoods, [](double l) { return std::isfinite(l); })) return;
  const double max = *std::ranges::max_element(log_likelihoods);
  double sum = 0;
  for (std::size_t i = 0; i < kModels; ++i) {
    models_[i].probability *= std::exp(log_likelihoods[i] - max);
    sum += models_[i].probability;
  }
  for (Model& model : models_) model.probability /= sum;
}

void MultipleModelFilter::allow_acceleration() {
  constexpr std::size_t kAccelerations = kAccelerationRatios.size();
  for (std::size_t noise = 0; noise < kModels; noise += kAccelerations) {
    const std::span<Model> models(&models_[noise], kAccelerations);
    double sum = 0;
    for (const Model& model : models) sum += model.probability;
    const double lack = sum / kAccelerations - models.back().probability;
    if (!(lack > 0)) continue;
    const double others = sum - models.back().probability;
    for (Model& model : models) model.probability *= 1 - lack / others;
    models.back().probability = sum / kAccelerations;
  }
  mixture_ = mix(probabilities());
}

double MultipleModelFilter::position_log_likelihood(const Eigen::Vector3d& position,
                                                    const Eigen::Matrix3d& covariance,
                                                    double discontinuity_sigma_m) const {
  Weights terms;
  for (std::size_t i = 0; i < kModels; ++i) {
    const auto& [filter, noise_variance_ratio, probability] = models_[i];
    Eigen::Matrix3d S =
        filter.pose_covariance().topLeftCorner<3, 3>() + noise_variance_ratio * covariance;
    S.diagonal().array() += discontinuity_sigma_m * discontinuity_sigma_m;
    const Eigen::LDLT<Eigen::Matrix3d> ldlt(S);
    const Eigen::Vector3d innovation = position - filter.pose().translation;
    terms[i] = std::log(probability) -
               0.5 * (innovation.dot(ldlt.solve(innovation)) + ldlt.vectorD().array().log().sum());
  }
  const double max = *std::ranges::max_element(terms);
  double sum = 0;
  for (const double term : terms) sum += std::exp(term - max);
  return max + std::log(sum);
}

void MultipleModelFilter::update_rate(const Eigen::Vector3d& measured_rate_rad_s,
                                      const Eigen::Matrix3d& covariance) {
  for_each_filter(
      [&](MotionFilter& filter) { filter.update_rate(measured_rate_rad_s, covariance); });
}

void MultipleModelFilter::set_pose_as_origin() {
  const RigidTransform pose = mixture_.pose;
  for_each_filter([&](MotionFilter& filter) {
    filter.transform_world(pose * filter.pose().inverse());
    filter.set_pose_as_origin();
  });
}

void MultipleModelFilter::inflate_position_covariance(double sigma_m) {
  for_each_filter([&](MotionFilter& filter) { filter.inflate_position_covariance(sigma_m); });
}

void MultipleModelFilter::reset_twist(double velocity_sigma_m_s, double rate_sigma_rad_s) {
  for_each_filter(
      [&](MotionFilter& filter) { filter.reset_twist(velocity_sigma_m_s, rate_sigma_rad_s); });
}

void MultipleModelFilter::transform_world(const RigidTransform& change) {
  for_each_filter([&](MotionFilter& filter) { filter.transform_world(change); });
}

void MultipleModelFilter::rescale_world(double factor) {
  for_each_filter([&](MotionFilter& filter) { filter.rescale_world(factor); });
}

Twist MultipleModelFilter::twist_in_camera() const {
  return {mixture_.pose.rotation.conjugate() * mixture_.velocity_in_world, mixture_.rate_in_camera};
}

Matrix6d MultipleModelFilter::twist_covariance() const {
  Matrix6d J = Matrix6d::Identity();
  J.topLeftCorner<3, 3>() = mixture_.pose.rotation.conjugate().toRotationMatrix();
  return J * mixture_.covariance.bottomRightCorner<6, 6>() * J.transpose();
}

Twist MultipleModelFilter::mean_twist_in_camera() const {
  Vector6d mean = Vector6d::Zero();
  for (const Model& model : models_) {
    mean += model.probability * model.filter.mean_twist_in_camera().vector();
  }
  return Twist::from_vector(mean);
}

Matrix6d MultipleModelFilter::mean_twist_covariance() const {
  const Vector6d mean = mean_twist_in_camera().vector();
  Matrix6d out = Matrix6d::Zero();
  for (const Model& model : models_) {
    const Vector6d difference = model.filter.mean_twist_in_camera().vector() - mean;
    out += model.probability *
           (model.filter.mean_twist_covariance() + difference * difference.transpose());
  }
  return out;
}

double MultipleModelFilter::noise_variance_ratio() const {
  double out = 0;
  for (const Model& model : models_) out += model.probability * model.noise_variance_ratio;
  return out;
}

}  // namespace stillkite
