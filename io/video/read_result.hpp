#pragma once

#include "flow/frame.hpp"

namespace stillkite {

/// Result of reading the next image.
struct ReadResult {
  enum class Status {
    frame,
    undecodable,  ///< damaged image or unsupported pixel format
    end,
  };
  Status status = Status::end;
  Frame frame{};  ///< without its index
  bool interlaced = false;
};

}  // namespace stillkite
