#pragma once

// The library's public interface. Frames, units and signs: docs/notation.md. Wrong input throws
// InputError (geometry/fields.hpp).
//
//     Navigator navigator(camera, body_from_camera, {}, initial);
//     const Estimate estimate = navigator.step(image, stamp, readings);

#include "geometry/camera.hpp"              // Camera: lens model, image size
#include "geometry/image_view.hpp"          // ImageView: grey image in the caller's memory
#include "geometry/rigid_transform.hpp"     // RigidTransform
#include "geometry/stamp_filter.hpp"        // StampFilter: stamps of arrival to times of exposure
#include "geometry/time.hpp"                // Timestamp
#include "navigation/estimate.hpp"          // Estimate: result of one image
#include "navigation/hover_pilot.hpp"       // HoverPilot: navigator and hold controller in one step
#include "navigation/navigator.hpp"         // Navigator: images and readings to estimates
#include "navigation/navigator_config.hpp"  // EstimatorConfig, NavigatorConfig
#include "navigation/sensor_readings.hpp"   // SensorReadings, InitialState
#include "stabilization/hold_controller.hpp"  // HoldController, for an estimator of your own
