#include "estimation/plane/plane_tiles.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimation/plane/plane_tiles.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// highway.h first
#include <hwy/contrib/math/math-inl.h>

#ifndef STILLKITE_PLANE_TILES_SHARED
#define STILLKITE_PLANE_TILES_SHARED
namespace stillkite {

/// Motion and lens parameters of the float kernels.
struct PlaneTilesInput {
  std::array<float, 9> rotation;
  std::array<float, 3> translation, normal;
  std::array<float, 6> normal_by_tilt;  // columns: d normal / d tilt
  float focal_x, focal_y, centre_x, centre_y;
  DistortionModel distortion;
  std::array<float, 8> coefficients;
  std::array<float, 6> twist;  // heights/s and rad/s, in camera
  const float* row_delay_s;    // per tile; nullptr: global shutter
  float max_radius2;           // validity limit of the lens model, on z = 1
};

}  // namespace stillkite
#endif

HWY_BEFORE_NAMESPACE();
namespace stillkite {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, TileGrid::kPadding>;
using V = hn::Vec<D>;

struct LensPoint {
  V x, y, xx, xy, yx, yy;
};

// Vectorised `distort` (geometry/camera.cpp).
LensPoint lens(const PlaneTilesInput& in, V x, V y) {
  const D d;
  const auto set = [&](float f) { return hn::Set(d, f); };
  const V fx = set(in.focal_x), fy = set(in.focal_y);
  const V cx = set(in.centre_x), cy = set(in.centre_y);
  if (in.distortion == DistortionModel::none) {
    const V zero = hn::Zero(d);
    return {hn::MulAdd(x, fx, cx), hn::MulAdd(y, fy, cy), fx, zero, zero, fy};
  }
  const auto& c = in.coefficients;
  const V r2 = hn::MulAdd(x, x, hn::Mul(y, y));
  if (in.distortion == DistortionModel::equidistant) {
    const V r = hn::Max(hn::Sqrt(r2), set(1e-6F));
    const V theta = hn::Atan(d, r);
    const V t2 = hn::Mul(theta, theta);
    const auto horner = [&](float a, float b, float e, float f) {
      V p = hn::MulAdd(t2, set(f), set(e));
      p = hn::MulAdd(t2, p, set(b));
      p = hn::MulAdd(t2, p, set(a));
      return hn::MulAdd(t2, p, set(1.0F));
    };
    const V poly = horner(c[0], c[1], c[2], c[3]);
    const V d_poly = horner(3 * c[0], 5 * c[1], 7 * c[2], 9 * c[3]);
    const V scale = hn::Div(hn::Mul(theta, poly), r);
    const V d_radius = hn::Div(d_poly, hn::Add(set(1.0F), r2));
    const V k = hn::Div(hn::Sub(d_radius, scale), hn::Mul(r, r));
    const V xy = hn::Mul(hn::Mul(x, y), k);
    return {hn::MulAdd(hn::Mul(x, scale), fx, cx),
            hn::MulAdd(hn::Mul(y, scale), fy, cy),
            hn::Mul(fx, hn::MulAdd(hn::Mul(x, x), k, scale)),
            hn::Mul(fx, xy),
            hn::Mul(fy, xy),
            hn::Mul(fy, hn::MulAdd(hn::Mul(y, y), k, scale))};
  }
  const auto cubic = [&](float a, float b, float e) {
    return hn::MulAdd(r2, hn::MulAdd(r2, set(e), set(b)), set(a));
  };
  const V one = set(1.0F);
  const V denominator = hn::MulAdd(r2, cubic(c[5], c[6], c[7]), one);
  const V radial = hn::Div(hn::MulAdd(r2, cubic(c[0], c[1], c[4]), one), denominator);
  const V d_numerator = cubic(c[0], 2 * c[1], 3 * c[4]);
  const V d_denominator = cubic(c[5], 2 * c[6], 3 * c[7]);
  const V d_radial = hn::Div(hn::NegMulAdd(radial, d_denominator, d_numerator), denominator);
  const V p1 = set(2 * c[2]), p2 = set(2 * c[3]);
  const V x2 = hn::Mul(x, x), y2 = hn::Mul(y, y), xy = hn::Mul(x, y);
  const V half = set(0.5F), two = set(2.0F), three = set(3.0F);
  const V dx = hn::MulAdd(x, radial, hn::MulAdd(p1, xy, hn::Mul(p2, hn::MulAdd(half, r2, x2))));
  const V dy = hn::MulAdd(y, radial, hn::MulAdd(p2, xy, hn::Mul(p1, hn::MulAdd(half, r2, y2))));
  const V cross = hn::MulAdd(hn::Mul(two, xy), d_radial, hn::MulAdd(p1, x, hn::Mul(p2, y)));
  const V jxx = hn::MulAdd(hn::Mul(two, x2), d_radial,
                           hn::MulAdd(p1, y, hn::MulAdd(hn::Mul(three, p2), x, radial)));
  const V jyy = hn::MulAdd(hn::Mul(two, y2), d_radial,
                           hn::MulAdd(p2, x, hn::MulAdd(hn::Mul(three, p1), y, radial)));
  return {hn::MulAdd(dx, fx, cx), hn::MulAdd(dy, fy, cy), hn::Mul(fx, jxx),
          hn::Mul(fx, cross),     hn::Mul(fy, cross),     hn::Mul(fy, jyy)};
}

void place_kernel(const PlaneTilesInput& in, const TileRays& rays, TilePlacement& out,
                  TileJacobian& jacobian) {
  const D d;
  const auto set = [&](float f) { return hn::Set(d, f); };
  const V r00 = set(in.rotation[0]), r01 = set(in.rotation[1]), r02 = set(in.rotation[2]);
  const V r10 = set(in.rotation[3]), r11 = set(in.rotation[4]), r12 = set(in.rotation[5]);
  const V r20 = set(in.rotation[6]), r21 = set(in.rotation[7]), r22 = set(in.rotation[8]);
  const V tx = set(in.translation[0]), ty = set(in.translation[1]), tz = set(in.translation[2]);
  const V nx = set(in.normal[0]), ny = set(in.normal[1]), nz = set(in.normal[2]);
  const V zero = hn::Zero(d);
  const auto n = static_cast<std::size_t>(jacobian.count);
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const V x = hn::LoadU(d, &rays.x[i]);
    const V y = hn::LoadU(d, &rays.y[i]);
    // b' = R b + rho t, rho the inverse depth in inverse heights
    const V inverse_depth = hn::MulAdd(nx, x, hn::MulAdd(ny, y, nz));
    const auto ground = hn::Gt(inverse_depth, zero);
    const V rho = hn::IfThenElseZero(ground, inverse_depth);
    V qx = hn::MulAdd(r00, x, hn::MulAdd(r01, y, hn::MulAdd(tx, rho, r02)));
    V qy = hn::MulAdd(r10, x, hn::MulAdd(r11, y, hn::MulAdd(ty, rho, r12)));
    V qz = hn::MulAdd(r20, x, hn::MulAdd(r21, y, hn::MulAdd(tz, rho, r22)));
    if (in.row_delay_s != nullptr) {
      // camera motion until the row is exposed: b' - t (v rho + w x b')
      const V t = hn::LoadU(d, in.row_delay_s + i);
      const V wx = set(in.twist[3]), wy = set(in.twist[4]), wz = set(in.twist[5]);
      const V dx = hn::MulAdd(set(in.twist[0]), rho, hn::MulSub(wy, qz, hn::Mul(wz, qy)));
      const V dy = hn::MulAdd(set(in.twist[1]), rho, hn::MulSub(wz, qx, hn::Mul(wx, qz)));
      const V dz = hn::MulAdd(set(in.twist[2]), rho, hn::MulSub(wx, qy, hn::Mul(wy, qx)));
      qx = hn::NegMulAdd(t, dx, qx);
      qy = hn::NegMulAdd(t, dy, qy);
      qz = hn::NegMulAdd(t, dz, qz);
    }
    const auto in_front =
        hn::And(hn::Gt(qz, set(0.05F)), hn::Gt(hn::LoadU(d, &rays.usable[i]), zero));
    const V iz = hn::Div(set(1.0F), hn::IfThenElse(in_front, qz, set(1.0F)));
    const V mx = hn::Mul(qx, iz);
    const V my = hn::Mul(qy, iz);
    const V radius2 = hn::MulAdd(mx, mx, hn::Mul(my, my));
    const auto visible = hn::And(in_front, hn::Lt(radius2, set(in.max_radius2)));
    const LensPoint p = lens(in, mx, my);
    const V outside = set(TilePlacement::kOutside_px);
    hn::StoreU(hn::IfThenElse(visible, p.x, outside), d, &out.x_px[i]);
    hn::StoreU(hn::IfThenElse(visible, p.y, outside), d, &out.y_px[i]);

    // d pixel / d q
    const V px0 = hn::Mul(p.xx, iz), px1 = hn::Mul(p.xy, iz);
    const V py0 = hn::Mul(p.yx, iz), py1 = hn::Mul(p.yy, iz);
    const V px2 = hn::Neg(hn::MulAdd(px0, mx, hn::Mul(px1, my)));
    const V py2 = hn::Neg(hn::MulAdd(py0, mx, hn::Mul(py1, my)));
    const auto write = [&](int parameter, V jx, V jy) {
      float* row = jacobian.rows.data() + 2 * static_cast<std::size_t>(parameter) * n + i;
      hn::StoreU(hn::IfThenElseZero(visible, jx), d, row);
      hn::StoreU(hn::IfThenElseZero(visible, jy), d, row + n);
    };
    write(0, hn::Mul(rho, px0), hn::Mul(rho, py0));
    write(1, hn::Mul(rho, px1), hn::Mul(rho, py1));
    write(2, hn::Mul(rho, px2), hn::Mul(rho, py2));
    // dq = w x q
    write(3, hn::MulSub(px2, qy, hn::Mul(px1, qz)), hn::MulSub(py2, qy, hn::Mul(py1, qz)));
    write(4, hn::MulSub(px0, qz, hn::Mul(px2, qx)), hn::MulSub(py0, qz, hn::Mul(py2, qx)));
    write(5, hn::MulSub(px1, qx, hn::Mul(px0, qy)), hn::MulSub(py1, qx, hn::Mul(py0, qy)));
    // dq = t (dn . b)
    const V along_x = hn::MulAdd(px0, tx, hn::MulAdd(px1, ty, hn::Mul(px2, tz)));
    const V along_y = hn::MulAdd(py0, tx, hn::MulAdd(py1, ty, hn::Mul(py2, tz)));
    for (int k = 0; k < 2; ++k) {
      const float* dn = in.normal_by_tilt.data() + 3 * k;
      const V change = hn::IfThenElseZero(
          ground, hn::MulAdd(set(dn[0]), x, hn::MulAdd(set(dn[1]), y, set(dn[2]))));
      write(6 + k, hn::Mul(along_x, change), hn::Mul(along_y, change));
    }

    // deformation d pixel' / d pixel through bearing and lens
    const V gx = hn::IfThenElseZero(ground, nx), gy = hn::IfThenElseZero(ground, ny);
    const V qx_x = hn::MulAdd(tx, gx, r00), qx_y = hn::MulAdd(tx, gy, r01);
    const V qy_x = hn::MulAdd(ty, gx, r10), qy_y = hn::MulAdd(ty, gy, r11);
    const V qz_x = hn::MulAdd(tz, gx, r20), qz_y = hn::MulAdd(tz, gy, r21);
    const V hxx = hn::MulAdd(px0, qx_x, hn::MulAdd(px1, qy_x, hn::Mul(px2, qz_x)));
    const V hxy = hn::MulAdd(px0, qx_y, hn::MulAdd(px1, qy_y, hn::Mul(px2, qz_y)));
    const V hyx = hn::MulAdd(py0, qx_x, hn::MulAdd(py1, qy_x, hn::Mul(py2, qz_x)));
    const V hyy = hn::MulAdd(py0, qx_y, hn::MulAdd(py1, qy_y, hn::Mul(py2, qz_y)));
    const V dxx = hn::LoadU(d, &rays.dxx[i]), dxy = hn::LoadU(d, &rays.dxy[i]);
    const V dyx = hn::LoadU(d, &rays.dyx[i]), dyy = hn::LoadU(d, &rays.dyy[i]);
    hn::StoreU(hn::MulAdd(hxx, dxx, hn::Mul(hxy, dyx)), d, &out.axx[i]);
    hn::StoreU(hn::MulAdd(hxx, dxy, hn::Mul(hxy, dyy)), d, &out.axy[i]);
    hn::StoreU(hn::MulAdd(hyx, dxx, hn::Mul(hyy, dyx)), d, &out.ayx[i]);
    hn::StoreU(hn::MulAdd(hyx, dxy, hn::Mul(hyy, dyy)), d, &out.ayy[i]);
  }
}

NormalEquations accumulate_kernel(const TileJacobian& jacobian, const TileMeasurements& m,
                                  const std::vector<float>& weights) {
  constexpr int kN = TileJacobian::kParameters;
  const D d;
  V information[kN * (kN + 1) / 2];
  V gradient[kN];
  for (V& v : information) v = hn::Zero(d);
  for (V& v : gradient) v = hn::Zero(d);
  const auto n = static_cast<std::size_t>(jacobian.count);
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const V w = hn::LoadU(d, &weights[i]);
    const V gxx = hn::Mul(w, hn::LoadU(d, &m.gxx[i]));
    const V gxy = hn::Mul(w, hn::LoadU(d, &m.gxy[i]));
    const V gyy = hn::Mul(w, hn::LoadU(d, &m.gyy[i]));
    const V gx = hn::Mul(w, hn::LoadU(d, &m.gx[i]));
    const V gy = hn::Mul(w, hn::LoadU(d, &m.gy[i]));
    V jx[kN], jy[kN];
    for (int a = 0; a < kN; ++a) {
      jx[a] = hn::LoadU(d, jacobian.x(a) + i);
      jy[a] = hn::LoadU(d, jacobian.y(a) + i);
    }
    for (int a = 0, k = 0; a < kN; ++a) {
      const V ax = hn::MulAdd(gxx, jx[a], hn::Mul(gxy, jy[a]));
      const V ay = hn::MulAdd(gxy, jx[a], hn::Mul(gyy, jy[a]));
      for (int b = a; b < kN; ++b, ++k) {
        information[k] = hn::MulAdd(ax, jx[b], hn::MulAdd(ay, jy[b], information[k]));
      }
      gradient[a] = hn::MulAdd(gx, jx[a], hn::MulAdd(gy, jy[a], gradient[a]));
    }
  }
  NormalEquations sum;
  for (int a = 0, k = 0; a < kN; ++a) {
    sum.gradient[a] = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, gradient[a])));
    for (int b = a; b < kN; ++b, ++k) {
      sum.information(a, b) = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, information[k])));
      sum.information(b, a) = sum.information(a, b);
    }
  }
  return sum;
}

void residual_kernel(const TileJacobian& jacobian, const TileMeasurements& m,
                     const std::array<float, 8>& step, float floor, std::vector<float>& chi2) {
  const D d;
  const V f = hn::Set(d, floor);
  const auto n = static_cast<std::size_t>(jacobian.count);
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    V ux = hn::Zero(d), uy = hn::Zero(d);
    for (int a = 0; a < TileJacobian::kParameters; ++a) {
      const V s = hn::Set(d, step[static_cast<std::size_t>(a)]);
      ux = hn::MulAdd(s, hn::LoadU(d, jacobian.x(a) + i), ux);
      uy = hn::MulAdd(s, hn::LoadU(d, jacobian.y(a) + i), uy);
    }
    const V gxx = hn::LoadU(d, &m.gxx[i]);
    const V gxy = hn::LoadU(d, &m.gxy[i]);
    const V gyy = hn::LoadU(d, &m.gyy[i]);
    const V ex = hn::NegMulAdd(gxx, ux, hn::NegMulAdd(gxy, uy, hn::LoadU(d, &m.gx[i])));
    const V ey = hn::NegMulAdd(gxy, ux, hn::NegMulAdd(gyy, uy, hn::LoadU(d, &m.gy[i])));
    const V hxx = hn::Add(gxx, f), hyy = hn::Add(gyy, f);
    const V determinant = hn::NegMulAdd(gxy, gxy, hn::Mul(hxx, hyy));
    const V numerator = hn::MulAdd(
        hyy, hn::Mul(ex, ex),
        hn::MulSub(hxx, hn::Mul(ey, ey), hn::Mul(hn::Set(d, 2.0F), hn::Mul(gxy, hn::Mul(ex, ey)))));
    hn::StoreU(hn::Div(numerator, determinant), d, &chi2[i]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace stillkite
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stillkite {
namespace {

PlaneTilesInput input_of(const Camera& camera, const TileRays& rays, const PlaneMotion& motion,
                         const TiltAxes& tilt_axes, const TileTimes* times) {
  PlaneTilesInput in{};
  if (times != nullptr) {
    for (int i = 0; i < 6; ++i) in.twist[i] = static_cast<float>(times->twist[i]);
    in.row_delay_s = times->row_delay_s.data();
  }
  const Eigen::Matrix3d R = motion.rotation.toRotationMatrix();
  for (int i = 0; i < 9; ++i) in.rotation[i] = static_cast<float>(R(i / 3, i % 3));
  for (int i = 0; i < 3; ++i) {
    in.translation[i] = static_cast<float>(motion.translation[i]);
    in.normal[i] = static_cast<float>(motion.normal[i]);
  }
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector3d change = tilt_axes.col(k).cross(motion.normal);
    for (int i = 0; i < 3; ++i) in.normal_by_tilt[3 * k + i] = static_cast<float>(change[i]);
  }
  in.focal_x = static_cast<float>(camera.focal_x_px);
  in.focal_y = static_cast<float>(camera.focal_y_px);
  in.centre_x = static_cast<float>(camera.centre_x_px);
  in.centre_y = static_cast<float>(camera.centre_y_px);
  in.distortion = camera.distortion;
  for (int i = 0; i < 8; ++i) in.coefficients[i] = static_cast<float>(camera.coefficients[i]);
  float tile_radius2 = 0;
  for (std::size_t i = 0; i < rays.x.size(); ++i) {
    if (rays.usable[i] > 0) {
      tile_radius2 = std::max(tile_radius2, rays.x[i] * rays.x[i] + rays.y[i] * rays.y[i]);
    }
  }
  in.max_radius2 = 1.1F * tile_radius2;
  return in;
}

}  // namespace

HWY_EXPORT(place_kernel);
HWY_EXPORT(accumulate_kernel);
HWY_EXPORT(residual_kernel);

TileRays make_tile_rays(const Camera& camera, const TileGrid& grid) {
  TileRays rays;
  const auto n = static_cast<std::size_t>(grid.count);
  for (auto* v : {&rays.x, &rays.y, &rays.dxx, &rays.dxy, &rays.dyx, &rays.dyy, &rays.usable}) {
    v->assign(n, 0.0F);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (grid.centre_x_px[i] < 0) continue;  // padding
    const auto point = undistort(camera, {grid.centre_x_px[i], grid.centre_y_px[i]});
    if (!point) continue;
    const Eigen::Matrix2d by_pixel = distort(camera, *point).jacobian.inverse();
    rays.x[i] = static_cast<float>(point->x());
    rays.y[i] = static_cast<float>(point->y());
    rays.dxx[i] = static_cast<float>(by_pixel(0, 0));
    rays.dxy[i] = static_cast<float>(by_pixel(0, 1));
    rays.dyx[i] = static_cast<float>(by_pixel(1, 0));
    rays.dyy[i] = static_cast<float>(by_pixel(1, 1));
    rays.usable[i] = 1.0F;
  }
  return rays;
}

void place_tiles(const Camera& camera, const TileRays& rays, const PlaneMotion& motion,
                 const TiltAxes& tilt_axes, TilePlacement& placement, TileJacobian& jacobian,
                 const TileTimes* times) {
  const auto count = static_cast<int>(rays.x.size());
  placement.resize(count);
  jacobian.count = count;
  jacobian.rows.resize(2 * TileJacobian::kParameters * rays.x.size());
  HWY_DYNAMIC_DISPATCH(place_kernel)
  (input_of(camera, rays, motion, tilt_axes, times), rays, placement, jacobian);
}

NormalEquations accumulate(const TileJacobian& jacobian, const TileMeasurements& measurements,
                           const std::vector<float>& weights) {
  return HWY_DYNAMIC_DISPATCH(accumulate_kernel)(jacobian, measurements, weights);
}

void squared_residuals(const TileJacobian& jacobian, const TileMeasurements& measurements,
                       const PlaneMotionStep& step, float floor, std::vector<float>& chi2) {
  std::array<float, 8> s{};
  for (int i = 0; i < 8; ++i) s[i] = static_cast<float>(step[i]);
  chi2.resize(static_cast<std::size_t>(jacobian.count));
  HWY_DYNAMIC_DISPATCH(residual_kernel)(jacobian, measurements, s, floor, chi2);
}

}  // namespace stillkite
#endif
