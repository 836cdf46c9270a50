#include "navigation/dense_flow.hpp"

namespace stillkite {
namespace {

std::variant<DenseLucasKanade, OpenCvFlow> make_flow(const DenseFlowConfig& config) {
  switch (config.method) {
    case DenseFlowMethod::lucas_kanade:
      break;
    case DenseFlowMethod::farneback:
      return OpenCvFlow({.method = OpenCvFlowMethod::farneback});
    case DenseFlowMethod::dis_ultrafast:
      return OpenCvFlow({.method = OpenCvFlowMethod::dis_ultrafast});
    case DenseFlowMethod::dis_fast:
      return OpenCvFlow({.method = OpenCvFlowMethod::dis_fast});
    case DenseFlowMethod::dis_medium:
      return OpenCvFlow({.method = OpenCvFlowMethod::dis_medium});
  }
  return DenseLucasKanade(config.lucas_kanade);
}

}  // namespace

DenseFlow::DenseFlow(const DenseFlowConfig& config) : flow_(make_flow(config)) {}

}  // namespace stillkite
