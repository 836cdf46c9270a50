#include "app/evaluation_json.hpp"

#include <nlohmann/json.hpp>
#include <string>

namespace stillkite {
namespace {

using nlohmann::json;

json number_or_null(const std::optional<double>& value) {
  return value ? json(*value) : json();
}

json axes(const Eigen::Vector3d& value) {
  return {value.x(), value.y(), value.z()};
}

void add_trajectory(json& result, const std::optional<TrajectoryError>& error) {
  const auto length = [&](double PositionError::*member) {
    return error && error->position ? json((*error->position).*member) : json();
  };
  const auto angle = [&](double TrajectoryError::*member) {
    return error ? json((*error).*member) : json();
  };
  result["position_rmse_m"] = length(&PositionError::rmse_m);
  result["position_max_m"] = length(&PositionError::max_m);
  const bool has_end = error && error->position && error->position->end;
  result["end_error_horizontal_m"] = has_end ? json(error->position->end->horizontal_m) : json();
  result["end_error_vertical_m"] = has_end ? json(error->position->end->vertical_m) : json();
  result["tilt_rmse_rad"] = angle(&TrajectoryError::tilt_rmse_rad);
  result["yaw_rmse_rad"] = angle(&TrajectoryError::yaw_rmse_rad);
}

void add_vector(json& result, const std::string& name, const std::string& unit,
                const std::optional<VectorError>& error) {
  json correlation;
  if (error) {
    for (const auto& axis : error->correlation) correlation.push_back(number_or_null(axis));
  }
  result[name + "_rmse_" + unit] = error ? axes(error->rmse) : json();
  result[name + "_median_abs_error_" + unit] = error ? axes(error->median_abs) : json();
  result[name + "_correlation"] = correlation;
}

json relative_json(const std::optional<RelativeError>& error) {
  if (!error) return {};
  return {{"count", error->count},
          {"mean_length_m", error->mean_length_m},
          {"translation_rmse_m", error->translation_rmse_m},
          {"rotation_rmse_rad", error->rotation_rmse_rad}};
}

json consistency_json(const std::optional<Consistency>& consistency) {
  if (!consistency) return {};
  return {{"mean", consistency->mean},
          {"degrees_of_freedom", consistency->degrees_of_freedom},
          {"samples", consistency->samples},
          {"mean_low", consistency->mean_low},
          {"mean_high", consistency->mean_high},
          {"share_inside", consistency->share_inside}};
}

// Relative poses to the reference frame; policy flow has none.
json reference_json(const std::optional<ReferenceError>& error) {
  const auto figure = [&](const auto& value) { return error ? number_or_null(value) : json(); };
  const ReferenceError of = error.value_or(ReferenceError{});
  return {{"rotation_median_deg", figure(std::optional(of.rotation_median_deg))},
          {"direction_median_deg", figure(of.direction_median_deg)},
          {"displacement_rmse_m", figure(of.displacement_rmse_m)},
          {"rotations", of.rotations},
          {"directions", of.directions}};
}

}  // namespace

json evaluation_json(const Evaluation& evaluation) {
  json result{{"matched", evaluation.matched}, {"path_length_m", evaluation.path_length_m}};
  add_trajectory(result, evaluation.trajectory);
  result["drift_percent"] = number_or_null(evaluation.drift_percent);
  add_vector(result, "velocity", "m_s", evaluation.velocity);
  add_vector(result, "angular_rate", "rad_s", evaluation.angular_rate);
  result["relative"] = {{"per_frame", relative_json(evaluation.per_frame)},
                        {"per_tenth_of_path", relative_json(evaluation.per_tenth)}};
  const ReferenceError reference = evaluation.reference.value_or(ReferenceError{});
  result["reference"] = reference_json(evaluation.reference);
  result["nees"] = {{"position", consistency_json(evaluation.nees.position)},
                    {"attitude", consistency_json(evaluation.nees.attitude)},
                    {"velocity", consistency_json(evaluation.nees.velocity)},
                    {"angular_rate", consistency_json(evaluation.nees.angular_rate)},
                    {"reference_rotation", consistency_json(reference.rotation_nees)},
                    {"reference_direction", consistency_json(reference.direction_nees)}};
  return result;
}

}  // namespace stillkite
